//! The Python package: its own tests, and a plant in Python against the shear's PLC.

use std::path::{Path, PathBuf};
use std::process::Command;

use onescan_operator::replay::Replay;
use onescan_scenario::Scenario;
use onescan_scenario::compose::Member;
use onescan_server::client::JoinRequest;
use onescan_server::formation::Formation;
use onescan_server::signal::SignalType;
use onescan_tests::run::run;
use onescan_tests::{at_ms, client, port, span_ms};
use serde_json::Value;

use crate::typed::{copied_shear, digests, edit, onescan};

fn package() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../clients/python")
}

#[test]
fn the_package_passes_its_own_tests() {
    let mut python = Command::new("python3");
    python.args(["-B", "-m", "unittest", "discover", "-s", "tests"]).current_dir(package());
    let output = python.env("PYTHONPATH", package().join("src")).output().expect("python3 is on the machine");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

/// The plant's outputs of each turn, the initial ones first, from the CSV of a run.
fn outputs(csv: &str, signals: &[(&str, SignalType)]) -> Vec<Vec<u8>> {
    let mut lines = csv.lines();
    let head: Vec<_> = lines.next().expect("a head").split(',').collect();
    let columns: Vec<_> = signals
        .iter()
        .map(|(name, ty)| (head.iter().position(|known| known == name).expect("recorded"), *ty))
        .collect();
    let bytes = |line: &str| {
        let values: Vec<_> = line.split(',').collect();
        let mut bytes = Vec::new();
        for (column, ty) in &columns {
            match *ty {
                SignalType::BOOL => bytes.push(u8::from(values[*column] == "1")),
                _ => bytes.extend(values[*column].parse::<f64>().expect("a number").to_le_bytes()),
            }
        }
        bytes
    };
    lines.map(bytes).collect()
}

#[test]
fn a_plant_in_python_shows_its_token_under_tls() {
    let shear = copied_shear();
    let plant = package().join("examples/shear.py");
    let command = format!("[\"python3\", \"-B\", \"{}\", \"--server\", \"{{server}}\"]", plant.display());
    let external = format!("kind = \"external\"\ncommand = {command}");
    edit(shear.path(), "scenario.toml", "kind = \"plant\"\nscene = \"plant.toml\"", &external);
    let run = |more: &[&str]| {
        let words = ["run", ".", "--until", "1s", "--format", "json"];
        let mut command = onescan(shear.path());
        let output = command.args(words).args(more).env("PYTHONPATH", package().join("src")).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        digests(&[serde_json::from_slice::<Value>(&output.stdout).expect("JSON")])
    };
    let (place, _) = crate::access::access(&[], &[]);
    assert_eq!(run(&["--access", place.path().to_str().unwrap()]), run(&[]));
}

#[test]
fn a_plant_in_python_is_as_good_as_its_recording() {
    let shear = copied_shear();
    let plant = package().join("examples/shear.py");
    let external = format!(
        "kind = \"external\"\ncommand = [\"python3\", \"-B\", \"{}\", \"--server\", \"{{server}}\"]",
        plant.display()
    );
    edit(shear.path(), "scenario.toml", "kind = \"plant\"\nscene = \"plant.toml\"", &external);
    let words =
        ["run", ".", "--until", "3s", "--runs", "2", "--record", "record", "--record-also", "csv", "--format", "json"];
    let mut command = onescan(shear.path());
    let output = command.args(words).env("PYTHONPATH", package().join("src")).output().expect("the program starts");
    let said = String::from_utf8(output.stdout).expect("text");
    assert!(output.status.success(), "{said} {}", String::from_utf8_lossy(&output.stderr));
    let reports: Vec<Value> = said.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
    let digests = digests(&reports);
    assert_eq!(digests[0], digests[1], "Python, too, gives the same bits again");

    let signals = [
        ("Sensor_1", SignalType::BOOL),
        ("Sensor_2", SignalType::BOOL),
        ("Position_1", SignalType::LREAL),
        ("Position_2", SignalType::LREAL),
    ];
    let csv = std::fs::read_to_string(shear.path().join("record/run-1/trajectory.csv")).unwrap();
    let writes = signals.iter().map(|(name, ty)| port(name, *ty)).collect();
    let request = JoinRequest { name: client("plant"), period: span_ms(10), reads: Vec::new(), writes };
    let scenario = Scenario::load(shear.path()).unwrap();
    let mut formation = Formation::new(scenario.plan().clone());
    formation.join(Box::new(Replay::new(request, outputs(&csv, &signals)))).unwrap();
    let Member::Plc(plc) = scenario.member(&client("plc")).unwrap() else { panic!("it is a soft PLC") };
    formation.join(plc).unwrap();
    let replayed = run(formation.start().unwrap(), at_ms(3_000));
    assert_eq!(replayed.digest.expect("a digest").to_string(), digests[0]);
    assert!(csv.lines().count() == 302 && csv.contains(",1,"), "the blade has moved");
}

/// A shear in Python that cannot save its state, and that writes to a file how the session ended.
const FORGETFUL: &str = "\
import sys
import shear
class Forgetful(shear.Shear):
    def save(self):
        raise ValueError('it has forgotten \\x1b[2J everything')
end = Forgetful('plant').take_part(sys.argv[1])
open('end.txt', 'w').write(end['status'])
";

#[test]
fn a_plant_that_cannot_be_saved_stays_to_the_end() {
    let shear = copied_shear();
    std::fs::write(shear.path().join("forgetful.py"), FORGETFUL).unwrap();
    let external = "kind = \"external\"\ncommand = [\"python3\", \"-B\", \"forgetful.py\", \"{server}\"]";
    edit(shear.path(), "scenario.toml", "kind = \"plant\"\nscene = \"plant.toml\"", external);
    let paths = std::env::join_paths([package().join("src"), package().join("examples")]).unwrap();
    let words = ["run", ".", "--until", "1s", "--save-at", "500ms", "--save", "shear.checkpoint"];
    let output = onescan(shear.path()).args(words).env("PYTHONPATH", paths).output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(3), "{said}");
    assert!(
        said.contains("cannot save the session: client `plant`: it does not: it has forgotten \\u{1b}[2J everything"),
        "{said}"
    );
    assert!(said.contains("the session goes on") && !said.contains('\u{1b}'), "{said}");
    assert_eq!(std::fs::read_to_string(shear.path().join("end.txt")).unwrap(), "completed");
    assert!(!shear.path().join("shear.checkpoint").exists());
}
