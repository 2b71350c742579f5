//! `onescan minimise`: what a failing run does not need is left out, and what is left fails by itself.

use std::fmt::Write as _;
use std::path::Path;

use serde_json::Value;

use crate::typed::{copied, copied_shear, digests, edit, typed};

/// What a command says of one thing, as JSON.
fn reported(folder: &Path, words: &[&str]) -> Value {
    let said = typed(folder, words);
    serde_json::from_str(said.out.trim()).unwrap_or_else(|_| panic!("{words:?}: {said:?}"))
}

/// The name of the copy is that of its folder, which is drawn.
fn unnamed(text: &str, folder: &Path) -> String {
    let name = folder.file_name().and_then(|name| name.to_str()).expect("a name");
    text.replace(name, "shear")
}

/// Forty forces of both sensors of the shear, drawn from a seed, as a case.
fn forty(seed: u64) -> String {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    let mut draw = |below: u64| {
        // xorshift64*
        state ^= state >> 12;
        state ^= state << 25;
        state ^= state >> 27;
        state.wrapping_mul(0x2545_f491_4f6c_dd1d) % below
    };
    let mut text = "version = 1\n[[case]]\nname = \"forty\"\nuntil = \"6s\"\nforce = [\n".to_owned();
    for _ in 0..40 {
        let (sensor, value, from, length) = (draw(2) + 1, draw(2) == 1, (3 + draw(580)) * 10, (1 + draw(2)) * 10);
        let until = from + length;
        writeln!(
            text,
            "  {{ signal = \"Sensor_{sensor}\", value = {value}, from = \"{from}ms\", until = \"{until}ms\" }},"
        )
        .expect("a text");
    }
    text + "]\n"
}

#[test]
fn forty_random_deviations_come_down_to_one_in_ten_runs() {
    let folder = copied_shear();
    for seed in 1..=12 {
        std::fs::write(folder.path().join("cases.toml"), forty(seed)).expect("a file");
        let words = ["minimise", ".", "--case", "forty", "--cases", "least.toml", "--format", "json"];
        let found = reported(folder.path(), &words);
        assert_eq!((&found["left"], &found["minimal"]), (&1.into(), &true.into()), "seed {seed}: {found}");
        // The run of the case as it is comes first.
        let runs = found["trials_to_fewest"].as_u64().expect("a number") + 1;
        assert!(runs <= 10, "seed {seed}: {runs} runs");
        // The case repeats it to the digest; without its one entry all is well.
        std::fs::rename(folder.path().join("least.toml"), folder.path().join("cases.toml")).expect("a file");
        let run = ["run", ".", "--case", "minimised", "--format", "json"];
        let least = reported(folder.path(), &run);
        assert_eq!(digests(&[least]), [found["digest"].as_str().expect("a digest")], "seed {seed}");
        let until = format!("{}ms", found["at_ns"].as_u64().expect("a time") / 1_000_000);
        assert_eq!(typed(folder.path(), &["run", ".", "--until", &until]).code, Some(0), "seed {seed}");
    }
}

/// A deviation that does nothing, one that two others need, and an expectation that only both break.
#[test]
fn what_is_needed_together_is_left_together() {
    let folder = copied_shear();
    let cases = r#"version = 1
[[case]]
name = "both"
about = "two that matter among five"
until = "4s"
waive = ["both sides at once", "strokes go on"]
seed = 7
disturbance = [
    { signal = "Position_1", kind = "offset", by = 0.5, from = "1s", until = "2500ms" },
    { signal = "Position_2", kind = "late", by = "200ms", from = "1s" },
]
force = [
    { signal = "Aligned", value = true, from = "2s", for = "80ms" },
    { signal = "Strokes", value = 9, from = "2040ms", until = "3s" },
    { signal = "AlignedCount", value = 9, when = "Strokes > 100" },
]
[[case.expect]]
name = "never both"
formula = "always not (Strokes = 9 and Position_1 > 0.3 m)"
"#;
    std::fs::write(folder.path().join("cases.toml"), cases).expect("a file");
    let said = typed(folder.path(), &["minimise", ".", "--case", "both", "--cases", "least.toml"]);
    assert_eq!((said.code, said.err.as_str()), (Some(0), ""));
    insta::assert_snapshot!(unnamed(&said.out, folder.path()));
    let least = std::fs::read_to_string(folder.path().join("least.toml")).expect("a file");
    assert!(least.contains("seed = 7") && least.contains("never both"), "{least}");
}

/// A recording of operators: of what they did, what broke the machine, as a case that breaks it again.
#[test]
fn what_operators_did_is_minimised() {
    let folder = copied("filling-machine");
    let mut events = String::new();
    let mut write = |step: u64, signal: &str, value: bool| {
        let t_v_ns = step * 10_000_000;
        writeln!(
            events,
            "{{\"step\":{step},\"t_v_ns\":{t_v_ns},\"event\":\"operator\",\"action\":\"write\",\"signal\":\"{signal}\",\
             \"value\":\"{value}\"}}"
        )
        .expect("a text");
    };
    write(50, "Main_Control.SwitchOutput[0]", true);
    write(70, "Main_Control.SwitchOutput[0]", false);
    for number in 0..8 {
        write(1_000 + number * 200, "Hold_Conveyor", true);
        write(1_040 + number * 200, "Hold_Conveyor", false);
    }
    write(2_700, "Distortion", true);
    write(3_200, "Distortion", false);
    std::fs::write(folder.path().join("events.jsonl"), events).expect("a file");
    let operated = ["--operator", "panel", "--until", "40s", "--format", "json"];
    let words = ["minimise", ".", "--replay-operator", "events.jsonl", "--cases", "cases.toml"];
    let found = reported(folder.path(), &[&words[..], &operated].concat());
    assert_eq!((&found["entries"], &found["left"]), (&20.into(), &2.into()), "{found}");
    assert_eq!(found["violated"], "no package is dropped");
    let least = found["minimised"].as_str().expect("a case");
    assert!(least.contains("SwitchOutput[0]") && least.contains("Distortion"), "{least}");
    let words = ["run", ".", "--case", "minimised", "--operator", "panel", "--format", "json"];
    let run = reported(folder.path(), &words);
    assert_eq!(digests(std::slice::from_ref(&run)), [found["digest"].as_str().expect("a digest")]);
    let violated: Vec<&Value> = run["expectations"].as_array().expect("a list").iter().collect();
    assert!(violated.iter().any(|one| one["name"] == "no package is dropped" && one["verdict"] == "violated"));
}

/// A PLC that stops is not an expectation, and is found all the same.
#[test]
fn a_plc_that_stops_is_minimised() {
    let folder = copied_shear();
    edit(
        folder.path(),
        "plc/alignment.st",
        "END_PROGRAM",
        "    IF b.Q AND NOT a.Q THEN n := n / zero; END_IF;\nEND_PROGRAM",
    );
    edit(folder.path(), "plc/alignment.st", "a, b, c : R_TRIG;", "a, b, c : R_TRIG; n, zero : DINT;");
    let case =
        forty(3).replacen("until = \"6s\"", "until = \"6s\"\nwaive = [\"both sides at once\", \"strokes go on\"]", 1);
    std::fs::write(folder.path().join("cases.toml"), case).expect("a file");
    let found = reported(folder.path(), &["minimise", ".", "--case", "forty", "--format", "json"]);
    assert_eq!((&found["left"], &found["violated"]), (&1.into(), &Value::Null), "{found}");
    insta::assert_snapshot!(found["failure"].as_str().expect("a failure"));
}

#[test]
fn what_cannot_be_minimised_is_reported() {
    let folder = copied_shear();
    std::fs::write(folder.path().join("cases.toml"), "version = 1\n[[case]]\nname = \"calm\"\nuntil = \"1s\"\n")
        .unwrap();
    let said = |words: &[&str]| {
        let said = typed(folder.path(), &[&["minimise", "."], words].concat());
        assert_eq!((said.code, said.out.as_str()), (Some(2), ""), "{words:?}");
        said.err
    };
    let calm = said(&["--case", "calm"]);
    let unknown = said(&["--case", "clam"]);
    let expectation = said(&["--case", "calm", "--expect", "both sides at onec"]);
    let neither = said(&[]);
    std::fs::write(folder.path().join("cases.toml"), forty(1)).unwrap();
    let name = said(&["--case", "forty", "--name", "a/b"]);
    insta::assert_snapshot!(unnamed(&[calm, unknown, expectation, neither, name].join("\n"), folder.path()));
    // A limit that is too low is reported.
    let limited = typed(folder.path(), &["minimise", ".", "--case", "forty", "--runs", "1", "--format", "json"]);
    let limited: Value = serde_json::from_str(limited.out.trim()).expect("JSON");
    assert_eq!((&limited["minimal"], &limited["trials"]), (&false.into(), &1.into()));
}
