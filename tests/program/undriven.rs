//! Inputs of a PLC that nobody drives: reported by every command that sees signals and programs.

use std::path::Path;

use crate::typed::{copied_shear, edit, scenario, typed, utf8};

const MESSAGE: &str = "nobody drives the input `Shear.Sensor_Two`: it stays FALSE";
const MEND: &str = "did you mean the signal `Sensor_2`? Give both the same name, or name the input under `bind`";

/// The shear with an input renamed in its program, which is the one mistake that neither a type nor a name shows.
fn renamed() -> tempfile::TempDir {
    let folder = copied_shear();
    edit(folder.path(), "plc/shear.st", "Sensor_2", "Sensor_Two");
    edit(folder.path(), "plc/alignment.st", "Sensor_2", "Sensor_B");
    folder
}

#[test]
fn a_renamed_input_is_reported_with_its_place_and_the_signal_that_may_be_meant() {
    let folder = renamed();
    let run = typed(folder.path(), &["run", ".", "--until", "100ms", "--runs", "2"]);
    assert_eq!(run.err.matches(MESSAGE).count(), 1, "once, not once per run: {run:?}");
    assert!(run.err.contains("plc/shear.st:") && run.err.contains("W0716") && run.err.contains(MEND), "{run:?}");
    let wiring = typed(folder.path(), &["wiring", "."]);
    assert!(wiring.out.contains("inputs of PLCs that nobody drives (2)"), "{wiring:?}");
    assert!(wiring.out.contains(MESSAGE) && wiring.out.contains(MEND), "{wiring:?}");
    assert_eq!(wiring.code, Some(0), "{wiring:?}");
    let check = typed(folder.path(), &["check", ".", "--format", "json"]);
    let found: Vec<serde_json::Value> = check.out.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let undriven = found.iter().filter(|found| found["code"] == "W0716").map(|found| found["message"].clone());
    let other = "nobody drives the input `Alignment.Sensor_B`: it stays FALSE";
    assert_eq!(undriven.collect::<Vec<_>>(), [MESSAGE, other], "{check:?}");
    let beside = typed(folder.path().parent().unwrap(), &["check", utf8(folder.path())]);
    assert!(beside.out.ends_with("in 2 files\n"), "places are named as those of other findings: {beside:?}");
    assert_eq!(check.code, Some(0), "a warning alone lets a check pass: {check:?}");
    assert_eq!(typed(folder.path(), &["check", ".", "--deny-warnings"]).code, Some(1));
}

#[test]
fn what_is_bound_set_or_connected_is_driven() {
    let folder = renamed();
    let bind = "kind = \"soft-plc\"\nbind = { Sensor_2 = \"Shear.Sensor_Two Alignment.Sensor_B\" }\n";
    edit(folder.path(), "scenario.toml", "kind = \"soft-plc\"\n", bind);
    let wiring = typed(folder.path(), &["wiring", "."]);
    assert!(!wiring.out.contains("nobody drives"), "{wiring:?}");
}

#[test]
fn no_scenario_of_the_project_has_one() {
    let mut found = Vec::new();
    let mut folders: Vec<_> = std::fs::read_dir(scenario("")).unwrap().map(|entry| entry.unwrap().path()).collect();
    folders.sort();
    for folder in folders.iter().filter(|folder| folder.join("scenario.toml").is_file()) {
        for file in scenarios_in(folder) {
            let wiring = typed(folder, &["wiring", &file, "--format", "json"]);
            let Ok(map) = serde_json::from_str::<serde_json::Value>(&wiring.out) else { continue };
            let undriven = map["undriven"].as_array().cloned().unwrap_or_default();
            found.extend(undriven.iter().map(|input| format!("{}: {file}: {input}", folder.display())));
        }
    }
    assert!(found.is_empty(), "{found:#?}");
}

/// The files of a folder that are scenarios.
fn scenarios_in(folder: &Path) -> Vec<String> {
    let names = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<String> =
        names.filter(|name| Path::new(name).extension().is_some_and(|end| end == "toml")).collect();
    names.retain(|name| std::fs::read_to_string(folder.join(name)).unwrap().contains("[clients.plc"));
    names.sort();
    names
}

/// What a run refuses, a check says before it.
#[test]
fn a_check_reports_tasks_of_programs_that_are_not_there() {
    let folder = copied_shear();
    assert_eq!(typed(folder.path(), &["check", "."]).code, Some(0));
    edit(folder.path(), "scenario.toml", "programs = [\"Shear\"", "programs = [\"Shaer\"");
    let check = typed(folder.path(), &["check", "."]);
    assert_ne!(check.code, Some(0), "{check:?}");
    assert!(check.err.contains("runs program `Shaer`, which is not declared"), "{check:?}");
}
