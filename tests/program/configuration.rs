//! A soft PLC whose sources say themselves what runs when (IEC 61131-3 2.7).

use std::path::Path;

use crate::typed::{copied_shear, edit, typed};

const TASKS: &str = "tasks = [{ name = \"main\", interval = \"10ms\", programs = [\"Shear\", \"Alignment\"] }]";

const CONFIGURATION: &str = "CONFIGURATION Line
    RESOURCE Station ON Soft
        TASK cycle (INTERVAL := T#10ms);
        PROGRAM S WITH cycle : Shear;
        PROGRAM A WITH cycle : Alignment;
    END_RESOURCE
END_CONFIGURATION
";

/// A shear with its tasks in the sources, and these in the scenario.
fn configured(tasks: &str, configuration: &str) -> tempfile::TempDir {
    let folder = copied_shear();
    edit(folder.path(), "scenario.toml", TASKS, tasks);
    edit(folder.path(), "scenario.toml", "\"plc/alignment.st\"", "\"plc/alignment.st\", \"plc/line.st\"");
    std::fs::write(folder.path().join("plc/line.st"), configuration).expect("a file");
    folder
}

fn trajectory(folder: &Path) -> String {
    let words = ["run", ".", "--until", "2s", "--record-also", "csv", "--record", "record", "--overwrite"];
    let said = typed(folder, &words);
    assert_eq!(said.code, Some(0), "{said:?}");
    std::fs::read_to_string(folder.join("record/run-1/trajectory.csv")).expect("a record")
}

#[test]
fn tasks_of_the_sources_run_as_those_of_a_scenario_do() {
    let folder = copied_shear();
    assert_eq!(trajectory(configured("", CONFIGURATION).path()), trajectory(folder.path()));
    // Programs without a task run at every step, which is the same here.
    let free = CONFIGURATION.replace(" WITH cycle", "").replace("        TASK cycle (INTERVAL := T#10ms);\n", "");
    assert_eq!(trajectory(configured("", &free).path()), trajectory(folder.path()));
}

#[test]
fn tasks_of_the_scenario_replace_those_of_the_sources() {
    let slow = CONFIGURATION.replace("T#10ms", "T#500ms");
    let own = "tasks = [{ name = \"own\", interval = \"10ms\", programs = [\"S\", \"A\"] }]";
    assert_eq!(trajectory(configured(own, &slow).path()), trajectory(copied_shear().path()));
}

fn said_of(tasks: &str, configuration: &str) -> String {
    let folder = configured(tasks, configuration);
    let said = typed(folder.path(), &["run", ".", "--until", "50ms"]);
    assert_eq!((said.code, said.out.as_str()), (Some(2), ""), "{said:?}");
    said.err
}

/// Asserts what an error says, wherever its lines are broken.
fn assert_reported(said: &str, wanted: &str) {
    assert!(crate::typed::flat(said).contains(wanted), "{said}");
}

#[test]
fn without_tasks_anywhere_the_plc_does_not_run() {
    assert_reported(&said_of("", ""), "nothing says when the programs of `plc` run");
}

#[test]
fn a_task_of_the_scenario_names_instances() {
    assert_reported(&said_of(TASKS, CONFIGURATION), "runs program `Shear`, which is not declared");
}

#[test]
fn an_interval_shorter_than_the_step_is_an_error() {
    assert_reported(
        &said_of("", &CONFIGURATION.replace("T#10ms", "T#4ms")),
        "which is not a multiple of the session's step",
    );
}

#[test]
fn a_trigger_that_is_not_a_bool_is_an_error() {
    let tasks = "tasks = [{ name = \"event\", single = \"S.Strokes\", programs = [\"S\", \"A\"] }]";
    assert_reported(&said_of(tasks, CONFIGURATION), "is triggered by `S.Strokes`: it is DINT, not BOOL");
}
