//! `onescan campaign`: every fault at every activation, each with a verdict, and the disturbances of which it makes use.

use std::path::Path;

use serde_json::Value;

use crate::typed::{Said, copied_shear, digests, scenario, typed};

const CAMPAIGN: &str = r#"
version = 1

[[campaign]]
name = "feedback"
until = "3s"
detected = "eventually[0,400ms] Strokes >= 3"
safe = "eventually[0,100ms] not (Actuator_1_Up or Actuator_1_Down)"
collision = "eventually abs(Position_1 - Position_2) > 150 mm"

fault = [
    { name = "nothing", kind = "hardware", disturbance = { signal = "Sensor_1", kind = "lost", rate = 0.0 } },
    { name = "sensor-off", kind = "hardware", force = { signal = "Sensor_1", value = false } },
    { name = "frame-frozen", kind = "hardware", disturbance = { client = "plant", kind = "stuck" } },
    { name = "noisy", kind = "hardware", disturbance = { signals = ["Position_1", "Position_2"], kind = "noisy", sigma = 0.002 } },
    { name = "held", kind = "model", force = { signal = "Position_2", value = -0.05 } },
    { name = "count", kind = "software", variable = { variable = "Shear.Strokes", value = 7 } },
]

activation = [
    { name = "start", at = "0s" },
    { name = "second-stroke", when = "rose(Actuator_1_Down)", nth = 2 },
    { name = "never", when = "Strokes > 40 and once Sensor_1" },
]
"#;

fn shear_with(cases: &str) -> tempfile::TempDir {
    let folder = copied_shear();
    std::fs::write(folder.path().join("cases.toml"), cases).expect("a file");
    folder
}

fn lines(said: &Said) -> Vec<Value> {
    said.out.lines().map(|line| serde_json::from_str(line).expect("JSON lines")).collect()
}

#[test]
fn every_fault_has_a_verdict_whatever_the_number_of_workers() {
    let folder = shear_with(CAMPAIGN);
    let campaign = |words: &[&str]| typed(folder.path(), &[&["campaign", "."], words].concat());
    let text = campaign(&["--jobs", "1", "--html", "campaign.html", "--junit", "campaign.xml"]);
    insta::assert_snapshot!(
        text.out.replace(&folder.path().file_name().unwrap().to_string_lossy().into_owned(), "SHEAR")
    );
    assert_eq!((text.code, text.err.as_str()), (Some(1), ""), "some are missed");
    assert_eq!(campaign(&["feedback", "--jobs", "3"]).out, text.out, "to the byte");
    let json = lines(&campaign(&["--format", "json", "--jobs", "3"]));
    assert_eq!(json.len(), 18 + 1);
    // Each is a case that runs by itself, to the same digest.
    for row in json.iter().filter(|row| row["activation"] == "second-stroke") {
        let case = row["case"].as_str().expect("a case");
        let said = typed(folder.path(), &["run", ".", "--case", case, "--format", "json"]);
        assert_eq!(digests(&lines(&said)), [row["digest"].as_str().expect("a digest")], "{case}");
    }
    // What is without effect has the digest of the run without faults.
    for row in json.iter().filter(|row| row["fault"] == "nothing" || row["verdict"] == "not-activated") {
        assert_eq!(row["digest"], json[18]["healthy_digest"], "{row}");
    }
    let page = std::fs::read_to_string(folder.path().join("campaign.html")).expect("a page");
    assert!(page.contains("feedback/held/second-stroke") && page.contains("not passed"));
    let junit = std::fs::read_to_string(folder.path().join("campaign.xml")).expect("a report");
    assert!(junit.contains("tests=\"18\"") && junit.contains("onescan run"), "{junit}");
}

#[test]
fn the_filling_machine_has_a_verdict_for_each_fault() {
    let said = typed(&scenario("filling-machine"), &["campaign", "."]);
    assert_eq!((said.code, said.err.as_str()), (Some(1), ""), "{said:?}");
    insta::assert_snapshot!(said.out);
}

#[test]
fn what_is_wrong_with_a_campaign_is_reported_before_anything_runs() {
    let reported = |from: &str, to: &str| {
        assert!(CAMPAIGN.contains(from), "{from}");
        let folder = shear_with(&CAMPAIGN.replacen(from, to, 1));
        let said = typed(folder.path(), &["campaign", ".", "feedback"]);
        assert_eq!((said.code, said.out.as_str()), (Some(2), ""), "{said:?}");
        format!("{from} -> {to}\n{}", said.err.replace(&folder.path().display().to_string(), "."))
    };
    let wrong = [
        ("name = \"noisy\"", "name = \"Nothing\""),
        ("rate = 0.0", "rate = 1.5"),
        ("sigma = 0.002", "sigma = -1.0"),
        ("signal = \"Sensor_1\", value", "signal = \"Sensor_3\", value"),
        ("force = { signal = \"Position_2\", value = -0.05 }", "fault = { component = \"gripper\", mode = \"stuck\" }"),
        ("variable = \"Shear.Strokes\"", "variable = \"Shear.Stroke\""),
        ("value = 7", "value = \"many\""),
        ("value = 7", "value = 7, at = \"1s\""),
        ("at = \"0s\"", "at = \"3s\""),
        ("at = \"0s\"", "at = \"0s\", nth = 2"),
        ("nth = 2", "nth = 0"),
        ("rose(Actuator_1_Down)", "eventually Actuator_1_Down"),
        ("detected = \"eventually[0,400ms] Strokes >= 3\"", "detected = \"Strokes >= 3\""),
        ("until = \"3s\"", "until = \"3s\"\ncase = \"plane\""),
        ("until = \"3s\"", "until = \"3s\"\nreadouts = [\"Position_3\"]"),
        ("force = { signal = \"Sensor_1\", value = false }", ""),
        ("client = \"plant\"", "client = \"plnat\""),
        ("kind = \"stuck\"", "kind = \"inverted\""),
        ("name = \"feedback\"", "name = \"feed-back\""),
    ];
    let all: Vec<String> = wrong.map(|(from, to)| reported(from, to)).into();
    insta::assert_snapshot!(all.join("\n"));
}

const DISTURBED: &str = r#"
version = 1

[[case]]
name = "plain"
until = "3s"

[[case]]
name = "never"
until = "3s"
disturbance = [
    { signal = "Sensor_1", kind = "lost", rate = 0.0 },
    { signal = "Sensor_2", kind = "flipped", rate = 0.0 },
    { signal = "Position_1", kind = "noisy", sigma = 0.0 },
]

[[case]]
name = "lost"
until = "3s"
waive = ["both sides at once"]
disturbance = [{ client = "plant", kind = "lost", rate = 0.4, from = "500ms" }]

[[case]]
name = "edges"
until = "3s"
waive = ["both sides at once"]
disturbance = [{ signal = "Sensor_1", kind = "lost", rate = 0.5 }, { signal = "Position_2", kind = "noisy", sigma = 0.001 }]

[[case]]
name = "flipped"
until = "3s"
waive = ["both sides at once"]
disturbance = [{ signals = ["Sensor_1", "Position_1", "Strokes"], kind = "flipped", rate = 0.05, when = "once[100ms,] fell(Sensor_1)", nth = 1 }]

[[case]]
name = "third"
until = "3s"
waive = ["both sides at once"]
force = [{ signal = "Sensor_1", value = true, when = "Actuator_1_Up since[50ms,1s] rose(Actuator_1_Up)", nth = 2, for = "200ms" }]
"#;

fn of_case(folder: &Path, case: &str, words: &[&str]) -> String {
    let said = typed(folder, &[&["run", ".", "--case", case, "--format", "json"], words].concat());
    digests(&lines(&said)).remove(0)
}

/// What is drawn and what is remembered is part of a session's state: a digest does not depend on how it was run.
#[test]
fn disturbed_runs_are_the_same_in_every_way() {
    let folder = shear_with(DISTURBED);
    let saved = folder.path().join("half.checkpoint");
    let saved = saved.to_str().expect("UTF-8");
    let plain = of_case(folder.path(), "plain", &[]);
    assert_eq!(of_case(folder.path(), "never", &[]), plain, "at a rate of 0 nothing is disturbed");
    let mut seen = vec![plain];
    for case in ["lost", "edges", "flipped", "third"] {
        let whole = of_case(folder.path(), case, &["--save-at", "1230ms", "--save", saved]);
        assert_eq!(of_case(folder.path(), case, &[]), whole, "{case}: again");
        assert_eq!(of_case(folder.path(), case, &["--resume", saved]), whole, "{case}: resumed");
        assert_eq!(of_case(folder.path(), case, &["--transport", "tcp"]), whole, "{case}: over TCP");
        assert!(!seen.contains(&whole), "{case} changes something");
        seen.push(whole);
    }
}

/// Another seed draws other numbers.
#[test]
fn what_is_drawn_follows_from_the_seed() {
    let folder = shear_with(&format!(
        "{DISTURBED}\n[[case]]\nname = \"seeded\"\nuntil = \"3s\"\nseed = 5\ndisturbance = [{{ client = \"plant\", kind = \"lost\", rate = 0.4, from = \"500ms\" }}]\n"
    ));
    let said = typed(folder.path(), &["run", ".", "--case", "seeded", "--format", "json"]);
    assert_ne!(digests(&lines(&said))[0], of_case(folder.path(), "lost", &[]));
}

const COLUMNS: &str = r#"
version = 1

[[campaign]]
name = "columns"
until = "1500ms"
safe = "eventually[0,100ms] not (Actuator_1_Up or Actuator_1_Down)"
matrix = { seed = "3..4", "plant.actuator_1.speed_m_s" = [0.2, 0.25] }
fault = [
    { name = "sensor-off", kind = "hardware", force = { signal = "Sensor_1", value = false } },
    { name = "noisy", kind = "hardware", disturbance = { signal = "Position_1", kind = "noisy", sigma = 0.002 } },
]
activation = [{ name = "early", at = "0s" }, { name = "late", at = "700ms", for = "100ms" }]
"#;

#[test]
fn seeds_and_parameters_are_columns_each_with_a_run_without_faults() {
    let folder = shear_with(COLUMNS);
    let campaign = |words: &[&str]| typed(folder.path(), &[&["campaign", "."], words].concat());
    let text = campaign(&["--jobs", "2"]);
    assert_eq!(text.err, "");
    insta::assert_snapshot!(
        text.out.replace(&folder.path().file_name().unwrap().to_string_lossy().into_owned(), "SHEAR")
    );
    assert_eq!(campaign(&["--jobs", "1"]).out, text.out, "to the byte");
    let json = lines(&campaign(&["--format", "json"]));
    let (rows, total) = json.split_at(json.len() - 1);
    assert_eq!(rows.len(), 2 * 2 * 4);
    let healthy: Vec<&str> = total[0]["healthy_digests"]
        .as_array()
        .expect("a list")
        .iter()
        .map(|one| one.as_str().expect("a digest"))
        .collect();
    // Nothing is drawn without faults, so that only the speed makes a difference.
    assert_eq!((healthy.len(), healthy[0] == healthy[2], healthy[0] == healthy[1]), (4, true, false));
    for row in rows {
        let case = row["case"].as_str().expect("a case");
        let said = typed(folder.path(), &["run", ".", "--case", case, "--format", "json"]);
        assert_eq!(digests(&lines(&said)), [row["digest"].as_str().expect("a digest")], "{case}");
    }
    // The work of a variant is kept, shared and put together like any other.
    assert_eq!(campaign(&["--keep", "one", "--partition", "1/2"]).code, Some(0));
    assert_eq!(campaign(&["--keep", "two", "--partition", "2/2"]).code, Some(0));
    let merged = typed(folder.path(), &["campaign", "merge", ".", "one", "two"]);
    assert_eq!(merged.out, text.out);
}

/// A run that comes to no end is not an error of the campaign, and is tried again.
#[test]
fn what_takes_too_long_is_unfinished_until_it_is_done() {
    let folder = shear_with(&COLUMNS.replace("matrix = ", "# matrix = "));
    let campaign = |words: &[&str]| typed(folder.path(), &[&["campaign", ".", "--format", "json"], words].concat());
    let whole = campaign(&[]);
    assert_eq!(campaign(&["--keep", "work", "--partition", "1/2"]).code, Some(0));
    let cut = campaign(&["--keep", "work", "--timeout", "1ns"]);
    assert_eq!((cut.code, cut.err.as_str()), (Some(1), ""));
    let verdicts: Vec<Value> = lines(&cut).iter().map(|row| row["verdict"].clone()).collect();
    assert_eq!(verdicts.iter().filter(|verdict| **verdict == "unfinished").count(), 2, "{cut:?}");
    assert_eq!(campaign(&["--keep", "work"]).out, whole.out);
}
