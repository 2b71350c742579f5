//! `onescan instrument --target openplc`: one file that MatIEC compiles, and the mapping that goes with it.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::typed::{Said, copied, scenario, typed};

fn instrumented(name: &str, more: &[&str]) -> (tempfile::TempDir, Said) {
    let folder = tempfile::tempdir().expect("a folder");
    let project = scenario(name).display().to_string();
    let mut words = vec!["instrument", &project, "--target", "openplc", "-o", "out"];
    words.extend_from_slice(more);
    let said = typed(folder.path(), &words);
    (folder, said)
}

fn read(folder: &Path, name: &str) -> String {
    std::fs::read_to_string(folder.join("out").join(name)).expect("a file")
}

/// `iec2c` and its library, if it is on the PATH.
fn compiler() -> Option<(PathBuf, PathBuf)> {
    let path = std::env::var_os("PATH")?;
    let found = std::env::split_paths(&path).find(|folder| folder.join("iec2c").is_file())?;
    let named = std::env::var_os("ONESCAN_MATIEC_LIB").map(PathBuf::from);
    Some((found.join("iec2c"), named.unwrap_or_else(|| found.join("lib"))))
}

/// As OpenPLC v3 calls it.
fn compiles(folder: &Path) -> Option<()> {
    let (iec2c, library) = compiler()?;
    let output = Command::new(iec2c)
        .args(["-f", "-l", "-p", "-r", "-R", "-a", "-I"])
        .arg(library)
        .arg("sdsp.st")
        .current_dir(folder.join("out"))
        .output()
        .expect("it starts");
    let said = Said::from(output);
    assert_eq!(said.code, Some(0), "{}{}", said.out, said.err);
    Some(())
}

#[test]
fn the_shear_becomes_one_file_and_its_mapping() {
    let (folder, said) = instrumented("shear", &[]);
    assert_eq!(said.code, Some(0), "{}{}", said.out, said.err);
    let mut names: Vec<_> = std::fs::read_dir(folder.path().join("out"))
        .expect("a folder")
        .map(|entry| entry.expect("an entry").file_name().into_string().expect("a name"))
        .collect();
    names.sort();
    assert_eq!(names, ["gateway.toml", "sdsp.st"]);
    insta::assert_snapshot!("openplc_shear_gateway", read(folder.path(), "gateway.toml"));
    let text = read(folder.path(), "sdsp.st");
    let configuration = text.split_once("CONFIGURATION ").expect("a configuration").1;
    insta::assert_snapshot!("openplc_shear_configuration", configuration);
    let alignment = text.split_once("PROGRAM Alignment").expect("a program").1.split_once("END_PROGRAM");
    insta::assert_snapshot!("openplc_shear_alignment", alignment.expect("its end").0);
}

#[test]
fn what_becomes_of_every_scenario_compiles() {
    for (name, more) in [("shear", &[][..]), ("filling-machine", &["--client", "plc"][..]), ("gantry-robot", &[])] {
        let (folder, said) = instrumented(name, more);
        assert_eq!(said.code, Some(0), "{name}: {}{}", said.out, said.err);
        if compiles(folder.path()).is_none() {
            eprintln!("skipped: `iec2c`, the compiler of MatIEC, is not on the PATH");
        }
    }
}

#[test]
fn what_matiec_has_not_is_refused_with_its_place() {
    let folder = tempfile::tempdir().expect("a folder");
    let text = "VAR_GLOBAL\n    Limit : INT;\nEND_VAR\n\nPROGRAM Main\nVAR\n    Probe : MC_TouchProbe;\n    Span : LTIME;\n\
                END_VAR\n    Limit := Limit + 1;\nEND_PROGRAM\n";
    std::fs::write(folder.path().join("main.st"), text).expect("a file");
    let said = typed(folder.path(), &["instrument", "main.st", "--target", "openplc", "-o", "out"]);
    assert_eq!(said.code, Some(2));
    assert!(said.out.contains("main.st:7:13") && said.out.contains("`MC_TouchProbe` is not replaced"), "{}", said.out);
    assert!(!folder.path().join("out").exists());
    std::fs::write(folder.path().join("main.st"), text.replace("    Probe : MC_TouchProbe;\n", "")).expect("a file");
    let said = typed(folder.path(), &["instrument", "main.st", "--target", "openplc", "-o", "out"]);
    assert_eq!(said.code, Some(2));
    assert!(said.out.contains("the type LTIME cannot be had in MatIEC"), "{}", said.out);
    let (_, said) = instrumented("filling-machine", &[]);
    assert!(said.err.contains("say which: `--client panel` or `--client plc`"), "{}", said.err);
}

#[test]
fn addresses_are_chosen_or_given() {
    let (folder, said) = instrumented("shear", &["--cycle", "1ms", "--words-at", "%MD100"]);
    assert_eq!(said.code, Some(0), "{}{}", said.out, said.err);
    let text = read(folder.path(), "sdsp.st");
    assert!(text.contains("TASK SDSP_Cycle(INTERVAL := T#1ms, PRIORITY := 0);"));
    assert!(text.contains("SDSP_Session AT %MD100 : UDINT;"));
    assert!(read(folder.path(), "gateway.toml").contains("SDSP_Session = \"hr:2248\""));
    // A word and a signal that the project itself puts somewhere stay there, and nothing else comes to lie there.
    let own = copied("shear");
    let source = own.path().join("plc/shear.st");
    let text = std::fs::read_to_string(&source).expect("a file");
    let globals = "VAR_GLOBAL\n    SDSP_Grant AT %MD7 : UDINT;\n    Lamp AT %QX512.0 : BOOL;\nEND_VAR\n\n";
    std::fs::write(&source, format!("{globals}{text}")).expect("a file");
    let said = typed(own.path(), &["instrument", ".", "--target", "openplc", "-o", "out"]);
    assert_eq!(said.code, Some(0), "{}{}", said.out, said.err);
    let text = read(own.path(), "sdsp.st");
    assert!(text.contains("SDSP_Grant AT %MD7 : UDINT;") && text.contains("Lamp AT %QX512.0 : BOOL;"), "{text}");
    assert_eq!(text.matches("%MD7 ").count() + text.matches("%QX512.0 ").count(), 2);
    assert!(read(own.path(), "gateway.toml").contains("SDSP_Grant = \"hr:2062\""));
    let said = typed(own.path(), &["instrument", ".", "--target", "iec", "--cycle", "1ms", "-o", "out"]);
    assert!(said.err.contains("`--cycle` is for targets whose tasks and addresses are written"), "{}", said.err);
}

/// The rest of the file stays where a configuration puts a word at an address.
#[test]
fn a_word_in_a_configuration_stays_where_it_is() {
    let folder = tempfile::tempdir().expect("a folder");
    let text = "PROGRAM Counting
VAR_INPUT go : BOOL; END_VAR
VAR_EXTERNAL total : INT; END_VAR
    IF go THEN total := total + 1; END_IF;
END_PROGRAM
CONFIGURATION C
    VAR_GLOBAL SDSP_Session AT %MD100 : UDINT; total : INT; END_VAR
    RESOURCE R ON PLC
        VAR_GLOBAL other : INT; END_VAR
        TASK T(INTERVAL := T#10ms, PRIORITY := 1);
        PROGRAM p1 WITH T : Counting;
    END_RESOURCE
END_CONFIGURATION
";
    std::fs::write(folder.path().join("p.st"), text).expect("a file");
    let said = typed(folder.path(), &["instrument", "p.st", "--target", "openplc", "-o", "out"]);
    assert_eq!(said.code, Some(0), "{}{}", said.out, said.err);
    let text = read(folder.path(), "sdsp.st");
    assert_eq!(text.matches("SDSP_Session AT %MD100 : UDINT;").count(), 1, "{text}");
    assert!(text.contains("total : INT;") && text.contains("other : INT;"), "{text}");
    assert_eq!(compiles(folder.path()), compiler().map(|_| ()));
}

/// The page that an engineer types, as far as no PLC is needed.
#[test]
fn the_walk_of_the_page_is_as_written() {
    let page = include_str!("../../docs/openplc.md");
    let commands = page.lines().filter(|line| line.starts_with("onescan "));
    let folder = tempfile::tempdir().expect("a folder");
    let link = folder.path().join("scenarios");
    std::fs::create_dir_all(&link).expect("a folder");
    let shear = copied("shear");
    std::fs::rename(shear.path(), link.join("shear")).expect("the same disk");
    let mut typed_lines = 0;
    for line in commands.filter(|line| !line.starts_with("onescan run")) {
        let words: Vec<&str> = line.split('#').next().unwrap_or("").split_whitespace().skip(1).collect();
        let said = typed(folder.path(), &words);
        assert_eq!(said.code, Some(0), "{line}: {}{}", said.out, said.err);
        typed_lines += 1;
    }
    assert!(typed_lines >= 2, "the page shows how");
}
