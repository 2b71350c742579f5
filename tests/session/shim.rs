//! The shear with an instrumented PLC: a gateway in between, and the same digest.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use onescan_iec::input::kind::SourceKind;
use onescan_iec::{Input, Task, TaskPlan, TimeSpan};
use onescan_iec_project::instrument::{Options, instrument};
use onescan_iec_run::{Application, SoftPlc};
use onescan_scenario::Scenario;
use onescan_scenario::compose::Member;
use onescan_server::client::{Client, JoinRequest};
use onescan_server::signal::SignalDecl;
use onescan_soft_plc::bind;
use onescan_tests::run::{in_process, run};
use onescan_tests::{at_ms, client};

use crate::granted::Granted;

pub(crate) fn shear_folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/shear")
}

pub(crate) fn member(scenario: &Scenario, name: &str) -> Box<dyn Client> {
    match scenario.member(&client(name)).expect("it has this client") {
        Member::Plant(client) | Member::Plc(client) | Member::Gateway(client) => client,
        Member::External(_) | Member::Seated { .. } => panic!("no client of the shear is external"),
    }
}

fn gateway(plc_folder: &Path, signals: &[SignalDecl], request: JoinRequest) -> Granted {
    let task = |name: &str, interval_ms: u64, priority: u32, programs: &[&str]| Task {
        name: name.to_owned(),
        interval: TimeSpan::from_millis(interval_ms),
        priority,
        programs: programs.iter().map(|program| (*program).to_owned()).collect(),
        ..Task::default()
    };
    let tasks = vec![task("main", 10, 0, &["Shear", "Alignment"])];
    let sources = ["shear.st", "alignment.st"].map(|name| {
        Input::from_text(name, SourceKind::Text, std::fs::read_to_string(plc_folder.join(name)).expect("a source"))
    });
    let project = instrument(&sources, &Options { tasks: Some(tasks), ..Options::default() }).expect("it is right");
    let files = project.files.into_iter().map(|file| (file.name, file.text.expect("a text")));
    let application = Application::from_sources(files).expect("it compiles");
    let own =
        TaskPlan::new(vec![task("sdsp", 1, 0, &["SDSP_Scheduler"]), task("programs", 2, 1, &["Shear", "Alignment"])]);
    let plc = SoftPlc::new(&application, &own).expect("the plan suits");
    let bindings = bind(&application, &client("plc"), signals, &BTreeMap::new()).expect("all signals have a variable");
    Granted::new(plc, bindings, request, "")
}

/// The digest of the scenario in a folder with its own PLC, and with the instrumented one.
fn digests(folder: &Path) -> [String; 2] {
    let scenario = Scenario::load(folder).expect("it is a scenario");
    let digest = |plc: Box<dyn Client>| {
        let lockstep = in_process(scenario.plan().clone(), [member(&scenario, "plant"), plc]);
        run(lockstep, at_ms(3_000)).digest.expect("it ran").to_string()
    };
    let plain = digest(member(&scenario, "plc"));
    let request = member(&scenario, "plc").join();
    [plain, digest(Box::new(gateway(&folder.join("plc"), scenario.plan().signals(), request)))]
}

#[test]
fn the_instrumented_shear_has_the_digest_of_the_shear() {
    let [plain, instrumented] = digests(&shear_folder());
    assert_eq!(instrumented, plain);
}

#[test]
fn the_shear_as_a_chart_has_the_same_digest_instrumented() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::create_dir(folder.path().join("plc")).expect("a folder");
    for file in ["scenario.toml", "plant.toml", "plc/alignment.st"] {
        std::fs::copy(shear_folder().join(file), folder.path().join(file)).expect("a copy");
    }
    let chart = include_str!("shear_chart.st");
    std::fs::write(folder.path().join("plc/shear.st"), chart).expect("a file");
    let [plain, instrumented] = digests(folder.path());
    assert_eq!(instrumented, plain);
    assert_ne!(plain, digests(&shear_folder())[0], "it is the chart that ran");
    insta::assert_snapshot!(plain);
}
