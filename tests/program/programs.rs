//! Cases and campaigns with other programs in PLCs: a file or a text in the place of another, from the start or from a
//! checkpoint on; and mutants as cases.

use std::path::Path;

use serde_json::Value;

use crate::typed::{Said, copied_shear, digests, edit, typed};

const REST: &str = r#"{ source = "plc/shear.st", line = 26, column = 20, was = "T#100ms", is = "T#150ms" }"#;

fn cases(folder: &Path, text: &str) {
    std::fs::write(folder.join("cases.toml"), format!("version = 1\n{text}")).expect("a file");
}

fn lines(said: &Said) -> Vec<Value> {
    said.out.lines().map(|line| serde_json::from_str(line).unwrap_or_else(|_| panic!("{said:?}"))).collect()
}

fn run(folder: &Path, words: &[&str]) -> String {
    let said = typed(folder, &[&["run", ".", "--until", "3s", "--format", "json"], words].concat());
    assert_eq!(said.err, "", "{words:?}");
    digests(&lines(&said)).remove(0)
}

#[test]
fn a_case_with_another_program_does_what_that_program_does() {
    let changed = copied_shear();
    edit(changed.path(), "plc/shear.st", "T#100ms", "T#150ms");
    let (plain, whole) = (run(copied_shear().path(), &[]), run(changed.path(), &[]));
    let folder = copied_shear();
    std::fs::copy(changed.path().join("plc/shear.st"), folder.path().join("plc/next.st")).expect("a file");
    let by = r#"{ source = "plc/shear.st", by = "plc/next.st" }"#;
    cases(
        folder.path(),
        &format!(
            "[[case]]\nname = \"text\"\ncode = [{REST}]\n[[case]]\nname = \"file\"\ncode = [{by}]\n[[case]]\nname = \"plain\"\n"
        ),
    );
    assert_ne!(plain, whole, "the change makes a difference");
    for case in ["text", "file"] {
        assert_eq!(run(folder.path(), &["--case", case]), whole, "{case}");
        assert_eq!(run(folder.path(), &["--case", case, "--transport", "tcp"]), whole, "{case} over TCP");
        let saved = run(folder.path(), &["--case", case, "--save-at", "1s", "--save", "own.ckpt"]);
        assert_eq!(run(folder.path(), &["--case", case, "--resume", "own.ckpt"]), saved, "{case} resumed");
    }
    assert_eq!(run(folder.path(), &["--case", "plain"]), plain);
    // What is recorded can be run again: the recording has the file.
    let recorded = run(folder.path(), &["--case", "file", "--record", "recording"]);
    let again = typed(folder.path(), &["diff", "recording/run-1", "recording/run-1"]);
    assert_eq!((recorded, again.code), (whole, Some(0)), "{again:?}");
    assert!(folder.path().join("recording/run-1/scenario/plc/next.st").is_file());
}

/// A fork into other code needs no more than the case that has it, and is what `--accept-code` does with the file changed.
#[test]
fn a_case_with_another_program_goes_on_from_where_the_scenario_was() {
    let folder = copied_shear();
    cases(folder.path(), &format!("[[case]]\nname = \"default\"\n[[case]]\nname = \"next\"\ncode = [{REST}]\n"));
    run(folder.path(), &["--save-at", "1s", "--save", "s.ckpt"]);
    let forked = run(folder.path(), &["--case", "next", "--resume", "s.ckpt"]);
    assert_eq!(run(folder.path(), &["--case", "next", "--resume", "s.ckpt"]), forked, "again");
    let changed = copied_shear();
    edit(changed.path(), "plc/shear.st", "T#100ms", "T#150ms");
    std::fs::copy(folder.path().join("s.ckpt"), changed.path().join("s.ckpt")).expect("a file");
    assert_eq!(run(changed.path(), &["--resume", "s.ckpt", "--accept-code"]), forked);
    assert_ne!(run(folder.path(), &["--case", "next"]), forked, "that has had its program from the start");
    // The other way round it is asked for.
    run(folder.path(), &["--case", "next", "--save-at", "1s", "--save", "next.ckpt"]);
    let refused = typed(folder.path(), &["run", ".", "--resume", "next.ckpt"]);
    assert_eq!(refused.code, Some(2), "{refused:?}");
    assert!(refused.err.contains("plc/shear.st:26:20"), "{}", refused.err);
    run(folder.path(), &["--resume", "next.ckpt", "--accept-code"]);
    // A variable more is another layout, whoever asks.
    std::fs::write(
        folder.path().join("plc/more.st"),
        std::fs::read_to_string(folder.path().join("plc/shear.st"))
            .expect("a file")
            .replace("Level : BOOL;", "Level, more : BOOL;"),
    )
    .expect("a file");
    cases(folder.path(), "[[case]]\nname = \"more\"\ncode = [{ source = \"plc/shear.st\", by = \"plc/more.st\" }]\n");
    let refused = typed(folder.path(), &["run", ".", "--case", "more", "--resume", "s.ckpt"]);
    assert!(refused.code == Some(2) && refused.err.contains("more"), "{refused:?}");
}

#[test]
fn what_is_wrong_with_a_program_is_reported() {
    let reported = [
        "{ source = \"plc/shear.st\" }",
        "{ source = \"plc/shear.st\", by = \"plc/next.st\", was = \"T#100ms\", is = \"T#1s\" }",
        "{ source = \"plc/shaer.st\", by = \"plc/next.st\" }",
        "{ client = \"plant\", source = \"plc/shear.st\", by = \"plc/alignment.st\" }",
        "{ source = \"plc/shear.st\", by = \"plc/none.st\" }",
        "{ source = \"plc/shear.st\", line = 26, column = 19, was = \"T#100ms\", is = \"T#1s\" }",
        "{ source = \"plc/shear.st\", line = 26, column = 20, was = \"\", is = \"T#1s\" }",
        "{ source = \"plc/shear.st\", line = 26, column = 20, was = \"T#100ms\", is = \"soon\" }",
        "{ source = \"plc/shear.st\", line = 26, column = 20, was = \"T#100ms\", is = \"T#1s\" }, \
         { source = \"plc/shear.st\", line = 26, column = 22, was = \"100\", is = \"90\" }",
    ]
    .map(|code| {
        let folder = copied_shear();
        cases(folder.path(), &format!("[[case]]\nname = \"next\"\ncode = [{code}]\n"));
        let said = typed(folder.path(), &["run", ".", "--case", "next", "--until", "1s"]);
        assert_eq!((said.code, said.out.as_str()), (Some(2), ""), "{code}: {said:?}");
        said.err.replace(&folder.path().display().to_string(), ".")
    });
    insta::assert_snapshot!(reported.join("\n"));
}

const CAMPAIGN: &str = r#"
[[campaign]]
name = "programs"
until = "2s"
safe = "eventually[0,100ms] not (Actuator_1_Up or Actuator_1_Down)"
program = [
    { name = "same", code = [{ source = "plc/shear.st", line = 16, column = 5, was = "Strokes", is = "Strokes" }] },
    { name = "slow", code = [REST] },
    { name = "deaf", code = [{ source = "plc/shear.st", line = 43, column = 27, was = "AND NOT Sensor_1", is = "" }] },
    { name = "broken", code = [{ source = "plc/shear.st", line = 36, column = 20, was = "Strokes + 1", is = "Strokes / Strokes" }] },
]
fault = [
    { name = "sensor-on", kind = "hardware", force = { signal = "Sensor_1", value = true } },
    { name = "noisy", kind = "hardware", disturbance = { signal = "Position_1", kind = "noisy", sigma = 0.002 } },
]
activation = [{ name = "early", at = "100ms", for = "50ms" }, { name = "late", at = "1600ms", for = "100ms" }]
"#;

const MUTANTS: &str = r#"
[[campaign]]
name = "mutants"
until = "2s"
safe = "eventually[0,100ms] not (Actuator_1_Up or Actuator_1_Down)"
mutants = { KEYS }
fault = [{ name = "sensor-on", kind = "hardware", force = { signal = "Sensor_1", value = true } }]
activation = [{ name = "early", at = "100ms", for = "50ms" }]
"#;

/// Mutants are drawn by the seed, and each is a case that runs by itself and says what it is.
#[test]
fn mutants_are_columns_of_a_campaign() {
    let folder = copied_shear();
    let with = |keys: &str| {
        cases(folder.path(), &MUTANTS.replace("KEYS", keys));
        let said = typed(folder.path(), &["campaign", ".", "--format", "json"]);
        assert_eq!(said.err, "", "{keys}");
        lines(&said)
    };
    let drawn = with("each = 6, seed = 3");
    let table = drawn.last().expect("a table").clone();
    assert_eq!(table["programs"].as_array().map(Vec::len), Some(6));
    insta::assert_snapshot!(serde_json::to_string_pretty(&table["programs"]).expect("JSON"));
    let row = drawn.iter().find(|row| row["program"] == table["programs"][0]["name"]).expect("a row");
    let case = row["case"].as_str().expect("a case");
    let alone = typed(folder.path(), &["run", ".", "--case", case, "--format", "json"]);
    assert_eq!(digests(&lines(&alone)), [row["digest"].as_str().expect("a digest")]);
    // a larger draw has those of a smaller one, and all are those of `mutate`
    let names = |lines: &[Value]| -> Vec<String> {
        let programs = lines.last().expect("a table")["programs"].as_array().expect("a list");
        programs.iter().map(|program| program["name"].as_str().expect("a name").to_owned()).collect()
    };
    let (few, more) = (names(&drawn), names(&with("each = 9, seed = 3")));
    assert!(few.iter().all(|name| more.contains(name)), "{few:?} {more:?}");
    let conditions = with("kinds = [\"condition\"], client = \"plc\"");
    let mutated = typed(folder.path(), &["mutate", ".", "--kind", "condition", "--format", "json"]);
    let counted = lines(&mutated).last().expect("a tally")["mutants"].as_u64().map(|count| count as usize);
    assert_eq!(Some(names(&conditions).len()), counted);
    let wrong = ["client = \"plq\"", "client = \"plant\"", "kinds = [\"typo\"]", "each = 0"].map(|keys| {
        cases(folder.path(), &MUTANTS.replace("KEYS", keys));
        let said = typed(folder.path(), &["campaign", "."]);
        assert_eq!((said.code, said.out.as_str()), (Some(2), ""), "{keys}: {said:?}");
        said.err.replace(&folder.path().display().to_string(), ".")
    });
    insta::assert_snapshot!(wrong.join("\n"));
}

/// A program of which the run without faults fails is a finding, and its cases are run all the same.
#[test]
fn programs_are_columns_of_a_campaign() {
    let folder = copied_shear();
    cases(folder.path(), &CAMPAIGN.replace("REST", REST));
    let campaign = |words: &[&str]| typed(folder.path(), &[&["campaign", "."], words].concat());
    let text = campaign(&["--jobs", "2"]);
    assert_eq!(text.err, "");
    insta::assert_snapshot!(
        text.out.replace(&folder.path().file_name().unwrap().to_string_lossy().into_owned(), "SHEAR")
    );
    assert_eq!(campaign(&["--jobs", "1"]).out, text.out, "to the byte");
    let json = lines(&campaign(&["--format", "json"]));
    let (rows, total) = json.split_at(json.len() - 1);
    assert_eq!(rows.len(), 2 * 2 * 5);
    for row in rows.iter().filter(|row| row["failure"].is_null()) {
        let case = row["case"].as_str().expect("a case");
        let said = typed(folder.path(), &["run", ".", "--case", case, "--format", "json"]);
        assert_eq!(digests(&lines(&said)), [row["digest"].as_str().expect("a digest")], "{case}");
    }
    let programs = total[0]["programs"].as_array().expect("a list");
    assert_eq!((programs.len(), &programs[0]["others"]), (4, &Value::Array(Vec::new())), "the same is the same");
    assert!(programs[3]["failure"]["of_plc"] == true, "{programs:?}");
    // Its parts are put together like those of any other, and a file that changes is work of something else.
    for (keep, part) in [("one", "1/2"), ("two", "2/2")] {
        assert_eq!(campaign(&["--keep", keep, "--partition", part]).code, Some(0));
    }
    assert_eq!(typed(folder.path(), &["campaign", "merge", ".", "one", "two"]).out, text.out);
}

/// Mutants that survive are cases that run by themselves, and differ from the case in which they show.
#[test]
fn a_mutant_is_a_case_that_runs_by_itself() {
    let folder = copied_shear();
    let words =
        ["mutate", ".", "--case", "sensor-lost", "--kind", "timer", "--kind", "statement", "--kind", "constant"];
    let said = typed(folder.path(), &[&words[..], &["--cases", "mutants.toml", "--format", "json"]].concat());
    assert_eq!((said.code, said.err.as_str()), (Some(0), ""));
    let survived = lines(&said).iter().filter(|line| line["verdict"] == "survived").count();
    let plain = typed(folder.path(), &["run", ".", "--case", "sensor-lost", "--format", "json"]);
    let plain = digests(&lines(&plain)).remove(0);
    std::fs::rename(folder.path().join("mutants.toml"), folder.path().join("cases.toml")).expect("a file");
    let text = std::fs::read_to_string(folder.path().join("cases.toml")).expect("a file");
    let names = || text.lines().filter_map(|line| line.strip_prefix("name = \"mutant-")?.strip_suffix('"'));
    assert!(survived >= 5 && names().count() == survived, "{survived}\n{text}");
    for number in names() {
        let case = format!("mutant-{number}");
        let run = typed(folder.path(), &["run", ".", "--case", &case, "--format", "json"]);
        let report = lines(&run);
        assert_ne!(digests(&report)[0], plain, "{case}");
    }
}
