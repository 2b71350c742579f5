//! `[report]` of a scenario: what a shift comes to, for people, as JSON, as a page, and from a recording.

use std::path::Path;

use serde_json::Value;

use crate::typed::{Said, copied, copied_shear, digests, edit, scenario, typed};

/// The filling machine for 20 s with a stop, as JSON.
fn stopped_machine(words: &[&str]) -> (Vec<Value>, Said) {
    let all = [&["run", ".", "--case", "stop-and-start", "--until", "20s", "--format", "json"], words].concat();
    let said = typed(&scenario("filling-machine"), &all);
    assert_eq!(said.code, Some(0), "{said:?}");
    (said.out.lines().map(|line| serde_json::from_str(line).expect("JSON lines")).collect(), said)
}

/// All from the line of the report on: what was before has the time on the wall.
fn report_of(text: &str) -> &str {
    &text[text.find("  report of").expect("a report")..]
}

#[test]
fn a_shift_is_reported_for_people() {
    let machine = scenario("filling-machine");
    let said = typed(&machine, &["run", ".", "--case", "stop-and-start", "--until", "20s"]);
    assert_eq!(said.code, Some(0), "{said:?}");
    insta::assert_snapshot!(report_of(&said.out));
}

#[test]
fn a_shift_is_reported_for_machines() {
    let (mut reports, _) = stopped_machine(&[]);
    let report = &mut reports[0]["report"];
    for count in report["counts"].as_array_mut().expect("counts") {
        // A hundred windows, in one line.
        count["throughput"]["counts"] = count["throughput"]["counts"].to_string().into();
    }
    insta::assert_snapshot!(serde_json::to_string_pretty(report).expect("JSON"));
}

#[test]
fn a_scenario_without_a_report_has_none() {
    let said = typed(&scenario("gantry-robot"), &["run", ".", "--until", "100ms", "--format", "json"]);
    let report: Value = serde_json::from_str(&said.out).expect("JSON");
    assert_eq!(report.get("report"), None);
}

#[test]
fn a_report_changes_no_digest() {
    let without = copied("filling-machine");
    let text = std::fs::read_to_string(without.path().join("scenario.toml")).expect("a file");
    let (begin, end) = (text.find("[report]").expect("a report"), text.find("[plot]").expect("a plot"));
    std::fs::write(without.path().join("scenario.toml"), format!("{}{}", &text[..begin], &text[end..]))
        .expect("a file");
    let words = ["run", ".", "--case", "stop-and-start", "--until", "20s", "--format", "json"];
    let plain: Value = serde_json::from_str(&typed(without.path(), &words).out).expect("JSON");
    assert_eq!(plain.get("report"), None);
    let (with, _) = stopped_machine(&[]);
    assert_eq!(digests(&with), digests(&[plain]));
}

#[test]
fn equal_runs_have_equal_reports_however_they_are_run() {
    let (twice, _) = stopped_machine(&["--runs", "2"]);
    let (tcp, _) = stopped_machine(&["--transport", "tcp"]);
    let written = |report: &Value| serde_json::to_string(&report["report"]).expect("JSON");
    assert_eq!(written(&twice[0]), written(&twice[1]));
    assert_eq!(written(&twice[0]), written(&tcp[0]));
}

#[test]
fn a_run_from_a_checkpoint_is_reported_from_there_on() {
    let folder = tempfile::tempdir().unwrap();
    let saved = folder.path().join("half.checkpoint");
    let saved = saved.to_str().unwrap();
    let (whole, _) = stopped_machine(&["--save-at", "12s", "--save", saved]);
    let (rest, _) = stopped_machine(&["--resume", saved]);
    assert_eq!(digests(&whole), digests(&rest));
    let (whole, rest) = (&whole[0]["report"], &rest[0]["report"]);
    assert_eq!((&rest["from_ns"], &rest["to_ns"]), (&12_000_000_000_u64.into(), &20_000_000_000_u64.into()));
    // What came in until then is counted in the whole run only.
    let count = |report: &Value| report["counts"][0]["count"].as_u64().expect("a count");
    assert!(count(rest) > 0 && count(rest) < count(whole), "{rest}");
    assert_eq!(rest["down_time"]["causes"][2]["count"], 0, "the stop was before");
}

#[test]
fn free_wheeling_runs_are_reported_too() {
    let words = ["run", ".", "--mode", "freewheel", "--until", "1s", "--format", "json"];
    let said = typed(&scenario("shear"), &words);
    let report: Value = serde_json::from_str(&said.out).expect("JSON");
    assert_eq!(report["report"]["counts"][0]["name"], "strokes", "{said:?}");
}

#[test]
fn a_recording_is_reported_as_its_run() {
    let folder = tempfile::tempdir().unwrap();
    let record = folder.path().to_str().unwrap();
    let (runs, _) = stopped_machine(&["--record", record]);
    let words = ["report", record, "--format", "json", "--html", "page.html"];
    let said = typed(folder.path(), &words);
    assert_eq!(said.code, Some(0), "{said:?}");
    let recorded: Value = serde_json::from_str(&said.out).expect("JSON");
    assert_eq!(recorded["report"], runs[0]["report"]);
    assert_eq!((&recorded["case"], &recorded["steps"]), (&"stop-and-start".into(), &2000.into()));
    let run: Value = serde_json::from_slice(&std::fs::read(folder.path().join("run-1/run.json")).unwrap()).unwrap();
    assert_eq!(run["report"], runs[0]["report"]);
    let page = std::fs::read_to_string(folder.path().join("page.html")).expect("a page");
    assert!(page.contains("from hand-over to hand-over") && page.contains("down time"), "{page}");
    let people = typed(folder.path(), &["report", "run-1"]);
    assert_eq!(people.code, Some(0), "{people:?}");
}

#[test]
fn a_recording_of_another_file_than_scenario_toml_is_found() {
    let folder = tempfile::tempdir().unwrap();
    let record = folder.path().to_str().unwrap();
    let said = typed(&scenario("filling-machine"), &["run", "distortion.toml", "--until", "1s", "--record", record]);
    assert_eq!(said.code, Some(0), "{said:?}");
    assert_eq!(typed(folder.path(), &["report", "."]).code, Some(0));
}

#[test]
fn a_recording_without_a_signal_that_is_needed_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let record = folder.path().to_str().unwrap();
    let words = ["run", ".", "--until", "1s", "--record", record, "--record-signals", "Sensor_*"];
    assert_eq!(typed(&scenario("shear"), &words).code, Some(0));
    let said = typed(folder.path(), &["report", "run-1"]);
    assert_eq!((said.code, said.out.as_str()), (Some(2), ""));
    insta::assert_snapshot!(said.err);
}

#[test]
fn a_question_that_comes_later_is_answered_from_the_recording() {
    let folder = tempfile::tempdir().unwrap();
    let record = folder.path().join("out");
    let said = typed(&scenario("gantry-robot"), &["run", ".", "--until", "1s", "--record", record.to_str().unwrap()]);
    assert_eq!(said.code, Some(0), "{said:?}");
    let none = typed(folder.path(), &["report", "out"]);
    assert_eq!(none.code, Some(2), "{none:?}");
    assert!(none.err.contains("--scenario"), "{none:?}");
    let asked = copied("gantry-robot");
    let text = std::fs::read_to_string(asked.path().join("scenario.toml")).expect("a file");
    let alarm = "\n[[report.alarm]]\nname = \"x\"\nwhen = \"X_Position > 0 mm\"\n";
    std::fs::write(asked.path().join("scenario.toml"), format!("{text}{alarm}")).expect("a file");
    let said = typed(folder.path(), &["report", "out", "--scenario", asked.path().to_str().unwrap()]);
    assert_eq!(said.code, Some(0), "{said:?}");
}

/// What is said of a scenario whose report is wrong.
fn refused(folder: &Path) -> String {
    let said = typed(folder, &["run", ".", "--until", "100ms"]);
    assert_eq!((said.code, said.out.as_str()), (Some(2), ""), "{said:?}");
    said.err
}

#[test]
fn what_is_wrong_is_said_with_its_place() {
    let wrong = [
        ("counter = \"AlignedCount\"", "counter = \"AlignedCout\""),
        ("counter = \"AlignedCount\"", "counter = \"Sensor_1\""),
        ("not (Sensor_1 iff Sensor_2)", "not (Sensor_1 iff Sensor_3)"),
        ("from = \"Actuator_1_Down\"", "form = \"Actuator_1_Down\""),
        ("from = \"Actuator_1_Down\"", "from = \"rose(Actuator_1_Down)\""),
        ("name = \"levelled\"", "name = \"strokes\""),
    ];
    let reported = wrong.map(|(from, to)| {
        let folder = copied_shear();
        edit(folder.path(), "scenario.toml", from, to);
        refused(folder.path())
    });
    insta::assert_snapshot!(reported.join("\n"));
}

#[test]
fn a_page_has_tables_and_pictures() {
    let page = || {
        let folder = tempfile::tempdir().unwrap();
        let page = folder.path().join("page.html");
        let words = ["run", ".", "--case", "distorted", "--until", "24s", "--html", page.to_str().unwrap()];
        assert_eq!(typed(&scenario("filling-machine"), &words).code, Some(0));
        let text = std::fs::read_to_string(page).expect("a page");
        text.lines().filter(|line| !line.contains("class=\"made\"")).collect::<Vec<_>>().join("\n")
    };
    let (one, other) = (page(), page());
    assert!(one == other, "equal runs have equal pages");
    for part in ["throughput", "cycle times", "down time", "alarms, one by one", "OEE", "packages filled"] {
        assert!(one.contains(part), "{part}");
    }
}
