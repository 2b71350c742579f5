//! A scenario of as many signals and soft PLCs as are wanted.

use std::fmt::Write as _;
use std::path::Path;

/// Writes a scenario of `clients` soft PLCs that write `signals` BOOLs together into `folder`; in each cycle every PLC changes
/// one of its own.
pub fn write(folder: &Path, signals: usize, clients: usize) {
    let mut scenario = "version = 1\nstep = \"1ms\"\nuntil = \"10ms\"\n[signals]\n".to_owned();
    let mut plcs = String::new();
    for client in 0..clients {
        let names = || (0..signals / clients).map(move |number| format!("s{client}_{number:06}"));
        let mut program = format!("PROGRAM P{client}\nVAR_OUTPUT\n");
        for name in names() {
            // A string takes all.
            let _ = writeln!(program, "  {name} : BOOL;");
            let _ = writeln!(scenario, "{name} = {{ type = \"BOOL\", writer = \"plc{client}\" }}");
        }
        let _ = write!(program, "END_VAR\ns{client}_000000 := NOT s{client}_000000;\nEND_PROGRAM\n");
        std::fs::write(folder.join(format!("p{client}.st")), program).expect("a folder that can be written");
        let task = format!("{{ name = \"t\", interval = \"1ms\", programs = [\"P{client}\"] }}");
        let _ = writeln!(
            plcs,
            "[clients.plc{client}]\nkind = \"soft-plc\"\nsources = [\"p{client}.st\"]\ntasks = [{task}]"
        );
    }
    std::fs::write(folder.join("scenario.toml"), scenario + &plcs).expect("a folder that can be written");
}
