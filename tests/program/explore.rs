//! `onescan explore`: the race of the shear found in every edge that has it, and what is exhausted where there is none.

use std::path::Path;

use serde_json::Value;

use crate::typed::{copied_shear, digests, edit, typed};

fn lines(text: &str) -> Vec<Value> {
    text.lines().map(|line| serde_json::from_str(line).expect("JSON lines")).collect()
}

/// Paper [SDSP], Fig. 6: the smallest cause of the lost alignment.
#[test]
fn the_race_is_one_edge_late_by_one_scan() {
    let folder = copied_shear();
    let said = typed(folder.path(), &["explore", "race.toml", "--until", "6s", "--cases", "found.toml"]);
    assert_eq!((said.code, said.err.as_str()), (Some(1), ""));
    insta::assert_snapshot!(said.out);
    let json = lines(&typed(folder.path(), &["explore", "race.toml", "--until", "6s", "--format", "json"]).out);
    assert_eq!(json[1]["schedules"], 2, "{json:?}");
    // The finding is a case that runs by itself, to the same digest.
    std::fs::rename(folder.path().join("found.toml"), folder.path().join("cases.toml")).expect("a file");
    let run = typed(folder.path(), &["run", "race.toml", "--case", "timing-1", "--format", "json"]);
    assert_eq!(digests(&lines(&run.out)), [json[0]["digest"].as_str().expect("a digest")], "{run:?}");
    assert_eq!(run.code, Some(1), "it violates what is expected");
}

#[test]
fn ten_rising_edges_break_it_and_ten_falling_ones_do_not() {
    let folder = copied_shear();
    let said = typed(folder.path(), &["explore", "race.toml", "--until", "6s", "--all", "--format", "json"]);
    let json = lines(&said.out);
    let (findings, statement) = json.split_at(json.len() - 1);
    assert_eq!(statement[0]["schedules"], 41);
    assert_eq!((&statement[0]["edges"], &statement[0]["exhausted"]), (&20.into(), &1.into()));
    let deviations: Vec<&Value> = findings.iter().map(|finding| &finding["deviations"][0]).collect();
    assert!(deviations.iter().all(|deviation| deviation["rises"] == true), "{deviations:?}");
    assert_eq!(deviations.len(), 20, "ten edges, each late by one and by two");
    let cases: Vec<&str> = findings.iter().map(|finding| finding["case"].as_str().expect("a case")).collect();
    std::fs::write(folder.path().join("cases.toml"), format!("version = 1\n{}", cases.concat())).expect("a file");
    for (number, finding) in findings.iter().enumerate() {
        let case = format!("timing-{}", number + 1);
        let run = typed(folder.path(), &["run", "race.toml", "--case", &case, "--format", "json"]);
        assert_eq!(digests(&lines(&run.out)), [finding["digest"].as_str().expect("a digest")], "{case}");
    }
}

/// The alignment check, mended: edges that are so many scans apart count as one.
fn mended(folder: &Path, scans: u64) {
    let check = format!(
        "    IF a.Q THEN since_a := 0; ELSIF since_a < 9 THEN since_a := since_a + 1; END_IF;\n\
         \x20   IF b.Q THEN since_b := 0; ELSIF since_b < 9 THEN since_b := since_b + 1; END_IF;\n\
         \x20   c(CLK := (a.Q AND since_b <= {scans}) OR (b.Q AND since_a <= {scans}));\n"
    );
    edit(folder, "plc/alignment.st", "    c(CLK := a.Q AND b.Q);\n", &check);
    edit(folder, "plc/alignment.st", "a, b, c : R_TRIG;", "a, b, c : R_TRIG; since_a, since_b : INT := 9;");
    let window = format!("always ((a or b) implies (once[0,{scans}0ms] c or eventually[0,{scans}0ms] c))");
    edit(folder, "race.toml", "always ((a or b) implies c)", &window);
}

#[test]
fn what_was_exhausted_is_stated_and_no_more() {
    let folder = copied_shear();
    mended(folder.path(), 2);
    let explore = |words: &[&str]| typed(folder.path(), &[&["explore", "race.toml", "--until", "6s"], words].concat());
    let one = explore(&[]);
    assert_eq!((one.code, one.err.as_str()), (Some(0), ""));
    // Two late strokes add up: the sides start apart by one scan, and come back apart by three.
    let two = explore(&["--bound", "2"]);
    assert_eq!(two.code, Some(1));
    let limited = explore(&["--runs", "30"]);
    assert_eq!(limited.code, Some(0));
    insta::assert_snapshot!([one.out, two.out, limited.out].join("\n"));
}

#[test]
fn all_801_schedules_of_two_deviations_hold_on_a_check_that_takes_four_scans() {
    let folder = copied_shear();
    mended(folder.path(), 4);
    let words = ["explore", "race.toml", "--until", "6s", "--bound", "2"];
    let said = typed(folder.path(), &words);
    let all = "race: all 801 schedules with at most 2 of 20 edges late by 1 to 2 steps hold";
    assert!(said.out.starts_with(&format!("{all}, ")) && said.out.ends_with(" of them by equal states\n"), "{said:?}");
    assert_eq!(said.code, Some(0));
    let unmerged = typed(folder.path(), &[&words[..], &["--no-merge"]].concat());
    assert_eq!(unmerged.out, format!("{all}\n"));
}

/// What is found does not depend on states that are known.
#[test]
fn equal_states_find_the_same_on_the_shear_and_the_filling_machine() {
    let folder = copied_shear();
    mended(folder.path(), 2);
    let machine = crate::typed::copied("filling-machine");
    for (folder, scenario, words) in [
        (folder.path(), "race.toml", ["--until", "3s", "--bound", "2"]),
        (machine.path(), ".", ["--until", "9s", "--bound", "1"]),
    ] {
        let explored = |more: &[&str]| {
            let asked = ["explore", scenario, "--all", "--format", "json"];
            lines(&typed(folder, &[&asked[..], &words[..], more].concat()).out)
        };
        let (mut merged, mut whole) = (explored(&[]), explored(&["--no-merge"]));
        let (statement, unmerged) = (merged.pop().expect("a statement"), whole.pop().expect("a statement"));
        assert_eq!(merged, whole);
        assert_eq!(statement["schedules"], unmerged["schedules"]);
        assert!(statement["joined"].as_u64() > Some(0) && unmerged["joined"] == 0, "{statement}");
    }
}

#[test]
fn what_cannot_be_explored_is_reported() {
    let reported = |from: &str, to: &str| {
        let folder = copied_shear();
        edit(folder.path(), "race.toml", from, to);
        let said = typed(folder.path(), &["explore", "race.toml"]);
        assert_eq!((said.code, said.out.as_str()), (Some(2), ""), "{said:?}");
        format!("{from} -> {to}\n{}", said.err)
    };
    let late = "late = [{ signals = [\"Sensor_1\", \"Sensor_2\"], by = \"20ms\" }]";
    let all = [
        reported(late, ""),
        reported("\"Sensor_1\", \"Sensor_2\"], by", "\"Sensor_1\", \"Sensor_3\"], by"),
        reported("\"Sensor_1\", \"Sensor_2\"], by", "\"Sensor_1\", \"Sensor_1\"], by"),
        reported("by = \"20ms\"", "by = \"5ms\""),
        reported("by = \"20ms\"", "by = \"soon\""),
        reported(
            "[[expect]]\nname = \"the blade is seen to be aligned\"\nformula = \"always ((a or b) implies c)\"\n",
            "",
        ),
    ];
    insta::assert_snapshot!(all.join("\n"));
}

/// A search tries each number of steps: a lateness without bound would take all memory there is.
#[test]
fn a_lateness_has_a_bound() {
    let folder = copied_shear();
    let path = folder.path().join("scenario.toml");
    let text = std::fs::read_to_string(&path).unwrap();
    for (table, said_is) in [
        ("late = [{ signals = [\"Sensor_1\"], by = \"100000000s\" }]", "is more than 10000 steps"),
        ("start = [{ client = \"plc\", by = \"100000000s\" }]", "is more than 10000 steps"),
    ] {
        std::fs::write(&path, format!("{text}\n[timing]\n{table}\n")).unwrap();
        let said = typed(folder.path(), &["explore", "."]);
        assert!(said.code == Some(2) && said.err.contains(said_is), "{said:?}");
    }
}
