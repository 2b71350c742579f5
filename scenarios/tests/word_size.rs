//! The word size of a PLC: the soft PLC of a run and the soft controller that stands in for a real one read it alike.

use onescan_base::{TimeSpan, VirtualTime};
use onescan_iec_run::{Application, SoftPlc};
use onescan_scenario::Scenario;
use onescan_scenario::mode::Mode;
use onescan_server::signal::ClientName;

const SOURCE: &str =
    "PROGRAM P VAR d : DINT := 2000000000; END_VAR VAR_OUTPUT wide : LINT; END_VAR wide := d * 2; END_PROGRAM";

/// What the program gives in the scenario's own soft PLC, and in the soft controller while nothing is simulated.
fn given(settings: &str) -> [i64; 2] {
    let folder = tempfile::tempdir().expect("a folder");
    let text = format!(
        "version = 1\nstep = \"10ms\"\nuntil = \"100ms\"\nsignals.wide = {{ type = \"LINT\", writer = \"plc\" }}\n\
         clients.plc = {{ kind = \"soft-plc\", sources = [\"a.st\"], dialect = \"codesys\"{settings}, \
           tasks = [{{ name = \"main\", interval = \"10ms\", programs = [\"P\"] }}] }}\n"
    );
    std::fs::write(folder.path().join("scenario.toml"), text).expect("written");
    std::fs::write(folder.path().join("a.st"), SOURCE).expect("written");
    let scenario = Scenario::load(folder.path()).unwrap_or_else(|error| panic!("{error}"));
    let name = ClientName::new("plc").expect("a name");
    let compiled = scenario.compiled_plc(&name).unwrap_or_else(|error| panic!("{error}")).expect("a soft PLC");
    let served = scenario.instrumented(&name, Mode::Lockstep).unwrap_or_else(|error| panic!("{error}"));
    [&compiled.application, &served.application].map(scanned)
}

fn scanned(application: &Application) -> i64 {
    let plan = application.single_task(TimeSpan::millis::<10>());
    let mut plc = SoftPlc::new(application, &plan).expect("the plan suits");
    if let Ok(simulated) = plc.variable("SDSP_Simulated") {
        simulated.store(&[0], plc.memory_mut());
    }
    plc.scan(VirtualTime::from_nanos(10_000_000)).expect("no fault");
    let wide = plc.variable("P.wide").expect("it is there").bytes(plc.memory());
    i64::from_le_bytes(wide.try_into().expect("eight bytes"))
}

#[test]
fn a_run_and_a_controller_read_it_alike() {
    assert_eq!(given(""), [4_000_000_000; 2]);
    assert_eq!(given(", word_size_bits = 64"), [4_000_000_000; 2]);
    assert_eq!(given(", word_size_bits = 32"), [-294_967_296; 2]);
}
