//! `onescan mutate`: small mistakes in a program, detected by what the cases come to.

use std::collections::BTreeMap;
use std::path::Path;

use serde_json::Value;

use crate::typed::{copied_shear, edit, scenario, typed};

/// The mutants and the statement behind them.
fn reported(folder: &Path, words: &[&str]) -> (Vec<Value>, Value) {
    let said = typed(folder, &[&["mutate", ".", "--format", "json"], words].concat());
    let mut lines: Vec<Value> = said.out.lines().map(|line| serde_json::from_str(line).expect("JSON lines")).collect();
    let statement = lines.pop().unwrap_or_else(|| panic!("{words:?}: {said:?}"));
    (lines, statement)
}

fn count(mutants: &[Value], verdict: &str) -> usize {
    mutants.iter().filter(|mutant| mutant["verdict"] == verdict).count()
}

/// The table of the shear by one of its cases, and the same however many run at a time.
#[test]
fn what_is_said_does_not_depend_on_the_number_at_a_time() {
    let words = ["mutate", ".", "--case", "sensor-lost", "--jobs"];
    let [alone, three] = ["1", "3"].map(|jobs| typed(&scenario("shear"), &[&words[..], &[jobs]].concat()));
    assert_eq!((alone.code, alone.err.as_str()), (Some(0), ""));
    insta::assert_snapshot!(alone.out);
    assert_eq!(three.out, alone.out);
}

/// What the cases of three machines expect, a mistake in their programs does not keep to.
#[test]
fn the_cases_of_the_machines_notice_the_mistakes_in_their_programs() {
    let mut mutants = 0;
    for (name, client) in [("shear", "plc"), ("gantry-robot", "plc"), ("filling-machine", "plc")] {
        let words = ["--client", client, "--at-least", "95"];
        let (_, statement) = reported(&scenario(name), &words);
        assert!(statement["score_pct"].as_f64().expect("a number") >= 95.0, "{name}: {statement}");
        mutants += statement["mutants"].as_u64().expect("a number");
    }
    assert!(mutants >= 300, "{mutants}");
}

/// What is said of a mutant is what comes of the program with the mistake in it.
#[test]
fn a_mutant_does_what_the_program_with_the_mistake_does() {
    let folder = copied_shear();
    let (mutants, statement) = reported(folder.path(), &[]);
    assert_eq!(statement["mutants"].as_u64(), Some(mutants.len() as u64), "none was refused");
    let mut seen: BTreeMap<&str, usize> = BTreeMap::new();
    for mutant in mutants.iter().step_by(4) {
        let text = |key: &str| mutant[key].as_str().expect("a text");
        let number = |key: &str| mutant[key].as_u64().expect("a number") as usize;
        let folder = copied_shear();
        let path = folder.path().join(text("file"));
        let program = std::fs::read_to_string(&path).expect("a source");
        let before: usize = program.split_inclusive('\n').take(number("line") - 1).map(str::len).sum();
        let line = &program[before..];
        let column: usize = line.chars().take(number("column") - 1).map(char::len_utf8).sum();
        let at = before + column;
        assert!(program[at..].starts_with(text("was")), "{mutant}");
        let wrong = format!("{}{}{}", &program[..at], text("is"), &program[at + text("was").len()..]);
        std::fs::write(&path, wrong).expect("a source");
        // The case that noticed it does not do what is expected; none of a survivor fails.
        let words = match text("verdict") {
            "killed" => vec!["run", ".", "--case", text("case"), "--format", "json"],
            _ => vec!["run", ".", "--format", "json"],
        };
        let run = typed(folder.path(), &words);
        let killed = text("verdict") == "killed";
        assert_eq!(run.code != Some(0), killed, "{mutant}: {run:?}");
        if let Some(by) = mutant["by"].as_str().filter(|by| !by.starts_with("client")) {
            let report: Value = serde_json::from_str(&run.out).expect("a report");
            let all = report["expectations"].as_array().expect("a list");
            assert!(all.iter().any(|one| one["name"] == by && one["verdict"] == "violated"), "{mutant}");
        }
        *seen.entry(text("verdict")).or_default() += 1;
    }
    assert!(seen["killed"] > 5, "{seen:?}");
}

/// An expectation more, a mutant less; a line that no case executes, and a change that no signal shows.
#[test]
fn each_verdict_is_given_for_its_reason() {
    let folder = copied_shear();
    let more = "    IF AlignedCount > 1000 THEN\n        AlignedCount := 0;\n    END_IF;\n    unseen := unseen + 1;\nEND_PROGRAM";
    edit(folder.path(), "plc/alignment.st", "END_PROGRAM", more);
    edit(folder.path(), "plc/alignment.st", "a, b, c : R_TRIG;", "a, b, c : R_TRIG; unseen : DINT;");
    let of_alignment = |mutants: Vec<Value>| -> Vec<Value> {
        mutants.into_iter().filter(|mutant| mutant["file"] == "plc/alignment.st").collect()
    };
    let (mutants, _) = reported(folder.path(), &["--case", "sensor-lost"]);
    let mutants = of_alignment(mutants);
    let verdict = |was: &str, is: &str| {
        let found = mutants.iter().find(|mutant| mutant["was"] == was && mutant["is"] == is);
        found.unwrap_or_else(|| panic!("{was} {is}"))["verdict"].as_str().expect("a text")
    };
    assert_eq!(verdict("AlignedCount := 0", ""), "unreached");
    assert_eq!(verdict("unseen := unseen + 1", ""), "equivalent");
    assert_eq!(verdict("Aligned := c.Q", ""), "survived");
    // An expectation of the check, and it may not be wrong any more.
    let more = "[[expect]]\nname = \"the blade is seen to be level\"\nformula = \"always ((rose(Sensor_1) and \
                rose(Sensor_2)) implies eventually[0,20ms] Aligned)\"\n\n[[expect]]\nname = \"strokes go on\"";
    edit(folder.path(), "scenario.toml", "[[expect]]\nname = \"strokes go on\"", more);
    let (with, _) = reported(folder.path(), &["--case", "sensor-lost"]);
    let with = of_alignment(with);
    let noticed = with.iter().find(|mutant| mutant["was"] == "Aligned := c.Q").expect("a mutant");
    assert_eq!(noticed["by"], "the blade is seen to be level");
    assert!(count(&with, "survived") < count(&mutants, "survived"));
}

/// A program that does not end is noticed, and ends the trial.
#[test]
fn a_loop_without_end_is_noticed() {
    let folder = copied_shear();
    edit(folder.path(), "plc/alignment.st", "a, b, c : R_TRIG;", "a, b, c : R_TRIG; i : DINT;");
    edit(
        folder.path(),
        "plc/alignment.st",
        "END_PROGRAM",
        "    WHILE i < 3 DO i := i + 1; END_WHILE;\n    i := 0;\nEND_PROGRAM",
    );
    let (mutants, _) = reported(folder.path(), &["--kind", "statement", "--case", "default"]);
    let endless = mutants.iter().find(|mutant| mutant["was"] == "i := i + 1").expect("a mutant");
    assert_eq!(endless["verdict"], "killed");
    insta::assert_snapshot!(endless["by"].as_str().expect("a failure"));
}

#[test]
fn so_many_are_to_be_noticed() {
    let code =
        |percent: &str| typed(&scenario("shear"), &["mutate", ".", "--kind", "timer", "--at-least", percent]).code;
    assert_eq!([code("1"), code("0")], [Some(0), Some(0)]);
    let folder = copied_shear();
    let unmet = |words: &[&str]| {
        let said = typed(folder.path(), &[&["mutate", "."], words].concat());
        (said.code, said.err)
    };
    let client = unmet(&["--client", "plk"]);
    let case = unmet(&["--case", "defualt"]);
    let kind = unmet(&["--kind", "operators"]);
    assert_eq!([client.0, case.0, kind.0], [Some(2); 3]);
    edit(folder.path(), "plc/alignment.st", "a, b, c : R_TRIG;", "a, b, c : R_TRIG; zero : DINT;");
    edit(folder.path(), "plc/alignment.st", "END_PROGRAM", "    AlignedCount := AlignedCount / zero;\nEND_PROGRAM");
    let fails = unmet(&[]);
    assert_eq!(fails.0, Some(2));
    let name = folder.path().file_name().and_then(|name| name.to_str()).expect("a name");
    insta::assert_snapshot!([client.1, case.1, kind.1, fails.1].join("\n").replace(name, "shear"));
}
