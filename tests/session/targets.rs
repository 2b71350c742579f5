//! Every scenario for every target: what is emitted parses, comes back byte for byte, and has the scenario's digest
//! under the scheduler; or the target says why it cannot carry the project.

use std::path::{Path, PathBuf};

use onescan_iec::input::kind::{FileKind, SourceKind};
use onescan_iec::{Input, Severity};
use onescan_iec_project::instrument::{File, InstrumentError, Options, Project, Target, instrument, remove};
use onescan_iec_run::SoftPlc;
use onescan_scenario::{Mode, Scenario, ScenarioError};
use onescan_server::client::Client;
use onescan_tests::run::{in_process, run};
use onescan_tests::{at_ms, client};

use crate::granted::Granted;
use crate::shim::{member, shear_folder};

const TARGETS: [Target; 4] = [Target::Iec, Target::TwinCat, Target::Codesys, Target::Scl];

const LATHE: [&str; 21] = [
    "lathe/main.xml",
    "lathe/modes.xml",
    "lathe/sequence.xml",
    "lathe/conditions.xml",
    "lathe/setpoints.xml",
    "lathe/veneer_watch.xml",
    "lathe/command_pulses.st",
    "lathe/commands.st",
    "lathe/axes.st",
    "lathe/moving_axis.st",
    "lathe/torque_axis.st",
    "lathe/turning_axis.st",
    "lathe/execute_pulse.st",
    "lathe/joystick.st",
    "lathe/supervision.st",
    "lathe/receive.st",
    "lathe/send.st",
    "lathe/position_to_real.st",
    "lathe/position.st",
    "lathe/globals.st",
    "lathe/types.st",
];

/// A scenario, and the sources of its PLC.
struct Given {
    folder: PathBuf,
    sources: &'static [&'static str],
    /// The PLC.
    plc: &'static str,
    /// The clients beside it.
    others: &'static [&'static str],
}

fn scenarios() -> Vec<Given> {
    let folder = |name: &str| Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios").join(name);
    vec![
        Given {
            folder: folder("shear"),
            sources: &["plc/shear.st", "plc/alignment.st"],
            plc: "plc",
            others: &["plant"],
        },
        Given {
            folder: folder("filling-machine"),
            sources: &["plc/machine.st", "plc/grip_arm.st"],
            plc: "plc",
            others: &["plant", "panel"],
        },
        Given {
            folder: folder("gantry-robot"),
            sources: &["plc/robot.st", "plc/servo.st"],
            plc: "plc",
            others: &["plant"],
        },
        // A chart in PLCopen XML beside text, and networks.
        Given {
            folder: folder("arc-furnace"),
            sources: &["functions/globals.st", "functions/heat.xml", "functions/interlocks.st", "functions/alarms.st"],
            plc: "functions",
            others: &["operator", "plant", "process"],
        },
        Given {
            folder: folder("peeling-line"),
            sources: &LATHE,
            plc: "lathe",
            others: &["operator", "plant", "charger"],
        },
    ]
}

/// The shear in SCL, as a scenario of its own.
fn shear_in_scl(folder: &Path) -> Given {
    let read = |name: &str| std::fs::read_to_string(shear_folder().join(name)).expect("a file");
    std::fs::create_dir(folder.join("plc")).expect("a folder");
    let scenario = read("scenario.toml")
        .replace("\"plc/shear.st\", \"plc/alignment.st\"", "\"plc/shear.scl\"")
        .replace("\"Shear\", \"Alignment\"", "\"Main\"")
        .replace("[clients.plc.gateway]", "[clients.plc.bind]\n\"*\" = \"IO.*\"\n\n[clients.plc.gateway]");
    std::fs::write(folder.join("scenario.toml"), scenario).expect("a file");
    std::fs::write(folder.join("plant.toml"), read("plant.toml")).expect("a file");
    std::fs::write(folder.join("plc/shear.scl"), include_str!("shear.scl")).expect("a file");
    Given { folder: folder.to_owned(), sources: &["plc/shear.scl"], plc: "plc", others: &["plant"] }
}

/// Files as they are read.
fn inputs<'f>(files: impl IntoIterator<Item = (&'f str, &'f str)>) -> Vec<Input> {
    let read = |(name, text): (&str, &str)| match FileKind::of(Path::new(name)) {
        Some(FileKind::Source(kind)) => Input::from_text(name, kind, text),
        _ => Input::from_text(name, SourceKind::Text, text),
    };
    files.into_iter().map(read).collect()
}

fn texts<'f>(files: impl IntoIterator<Item = &'f File>) -> Vec<(&'f str, &'f str)> {
    let texts = files.into_iter().filter_map(|file| Some((file.name.as_str(), file.text.as_deref()?)));
    texts.collect()
}

/// Instruments, instruments again and takes the shim off.
fn round_trip(given: &Given, target: Target) -> Result<Project, InstrumentError> {
    let read = |name: &str| std::fs::read_to_string(given.folder.join(name)).expect("a source");
    let before: Vec<_> = given.sources.iter().map(|name| (*name, read(name))).collect();
    let before: Vec<(&str, &str)> = before.iter().map(|(name, text)| (*name, text.as_str())).collect();
    let options = Options { target, ..Options::default() };
    let project = instrument(&inputs(before.iter().copied()), &options)?;
    let emitted = texts(&project.files);
    let found = onescan_iec::inspect(inputs(texts(project.program())), None);
    assert!(found.iter().all(|each| each.severity != Severity::Error), "{target:?}: {found}");
    let twice = instrument(&inputs(emitted.iter().copied()), &options)?;
    assert_eq!(texts(&twice.files), emitted, "{target:?}");
    let back = remove(&inputs(emitted.iter().copied()))?;
    assert_eq!(texts(&back.files), before, "{target:?}");
    Ok(project)
}

/// The digest of a scenario with its own PLC, and with the instrumented one.
fn digests(given: &Given, target: Target, prefix: &'static str) -> [String; 2] {
    let scenario = Scenario::load(&given.folder).expect("it is a scenario");
    let digest = |plc: Box<dyn Client>| {
        let others = given.others.iter().map(|name| member(&scenario, name));
        let lockstep = in_process(scenario.plan().clone(), others.chain([plc]));
        run(lockstep, at_ms(3_000)).digest.expect("it ran").to_string()
    };
    let request = member(&scenario, given.plc).join();
    let plain = digest(member(&scenario, given.plc));
    let emitted = scenario.instrumented_for(target, &client(given.plc), Mode::Lockstep);
    let emitted = emitted.unwrap_or_else(|error: ScenarioError| panic!("{target:?}: {error}"));
    let plc = SoftPlc::new(&emitted.application, &emitted.plan).expect("the plan suits");
    [plain, digest(Box::new(Granted::new(plc, emitted.bindings, request, prefix)))]
}

#[test]
fn every_target_carries_a_scenario_or_says_why_not() {
    let folder = tempfile::tempdir().expect("a folder");
    let scl = shear_in_scl(folder.path());
    let mut outcomes = Vec::new();
    for given in scenarios().iter().chain([&scl]) {
        let name = given.folder.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
        let name = if std::ptr::eq(given, &raw const scl) { "shear in SCL".to_owned() } else { name };
        for target in TARGETS {
            let outcome = match round_trip(given, target) {
                Err(refused) => refused.to_string().replace('\n', " "),
                Ok(project) => {
                    let [plain, emitted] = digests(given, target, if target == Target::Scl { "SDSP." } else { "" });
                    assert_eq!(emitted, plain, "{name}, {target:?}");
                    let reported = project.warnings.iter().count();
                    format!("{} files, {reported} findings, the digest of the original", project.files.len())
                }
            };
            outcomes.push(format!("{name}, {target:?}: {outcome}"));
        }
    }
    insta::assert_snapshot!(outcomes.join("\n"));
}

/// What is reported of languages and vendors does not hide that it is the same machine.
#[test]
fn the_shear_in_scl_is_the_shear() {
    let folder = tempfile::tempdir().expect("a folder");
    let [scl, _] = digests(&shear_in_scl(folder.path()), Target::Scl, "SDSP.");
    let [st, _] = digests(&scenarios()[0], Target::Iec, "");
    assert_eq!(scl, st);
}
