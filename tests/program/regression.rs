//! `onescan test` on scenarios: what differs is found, what does not differ stays green.

use std::path::Path;

use crate::typed::{copied_shear, copied_shear_of_snapshots, edit, scenario, typed};

/// `onescan test` of a folder with JSON output; one object a test, and one for all.
fn tested(folder: &Path, words: &[&str]) -> (Vec<serde_json::Value>, Option<i32>) {
    let said = typed(folder, &[&["test", ".", "--format", "json"], words].concat());
    let all = said.out.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
    (all, said.code)
}

fn digests(outcomes: &[serde_json::Value]) -> Vec<&str> {
    outcomes.iter().filter_map(|outcome| outcome["digest"].as_str()).collect()
}

/// Every scenario of the project that has snapshots. If this says that one is missing: `onescan test scenarios`,
/// then `onescan review scenarios`.
#[test]
fn all_scenarios_are_as_they_were_reviewed() {
    let folder = scenario("");
    let entries = std::fs::read_dir(&folder).expect("a folder").map(|entry| entry.expect("an entry").path());
    let mut reviewed: Vec<_> =
        entries.filter(|path| path.join("snapshots").is_dir() && path.join("scenario.toml").is_file()).collect();
    reviewed.sort();
    assert!(reviewed.len() >= 2, "{reviewed:?}");
    let names: Vec<String> = reviewed.iter().map(|path| path.to_string_lossy().into_owned()).collect();
    let words: Vec<&str> = ["test", "--check"].into_iter().chain(names.iter().map(String::as_str)).collect();
    let said = typed(&folder, &words);
    assert_eq!(said.code, Some(0), "{}{}", said.out, said.err);
}

#[test]
fn the_number_of_jobs_changes_no_bit() {
    let folder = copied_shear();
    let (one, _) = tested(folder.path(), &["--check", "--jobs", "1"]);
    let (two, _) = tested(folder.path(), &["--check", "--jobs", "2"]);
    assert_eq!(one, two);
    assert_eq!(digests(&one).len(), 11);
}

#[test]
fn a_changed_comparison_is_found() {
    let folder = copied_shear_of_snapshots();
    edit(folder.path(), "plc/shear.st", "Position_1 > LowerLimit", "Position_1 >= LowerLimit");
    let said = typed(folder.path().parent().expect("a folder"), &["test", &folder.path().to_string_lossy(), "--check"]);
    assert_eq!(said.code, Some(1), "{said:?}");
    let own = folder.path().to_string_lossy().into_owned();
    insta::assert_snapshot!(said.out.replace(&own, "shear"));
    let (outcomes, _) = tested(folder.path(), &["--check"]);
    let changed = outcomes.iter().find(|outcome| outcome["status"] == "changed").expect("it is found");
    assert_eq!(changed["name"], "on-the-limit");
    let first = &changed["differences"][0];
    assert_eq!((first["signal"].as_str(), first["at_ns"].as_u64()), (Some("Actuator_1_Down"), Some(860_000_000)));
}

#[test]
fn a_change_that_nobody_sees_stays_green() {
    let folder = copied_shear();
    edit(
        folder.path(),
        "plc/shear.st",
        "ixDown AND Position_2 > LowerLimit",
        "NOT (Position_2 <= LowerLimit) AND ixDown",
    );
    let (outcomes, code) = tested(folder.path(), &["--check"]);
    assert_eq!(code, Some(0), "{outcomes:?}");
}

#[test]
fn pending_snapshots_come_and_go() {
    let folder = copied_shear_of_snapshots();
    let snapshots = folder.path().join("snapshots");
    let pending = || {
        let names = std::fs::read_dir(&snapshots).expect("a folder").map(|entry| entry.expect("an entry").file_name());
        names.filter(|name| name.to_string_lossy().ends_with(".new")).count()
    };
    edit(folder.path(), "plc/shear.st", "Position_1 > LowerLimit", "Position_1 >= LowerLimit");
    std::fs::remove_file(snapshots.join("default.traj")).expect("it is there");
    let (_, code) = tested(folder.path(), &["--check"]);
    assert_eq!((code, pending()), (Some(1), 0), "--check writes nothing");
    let (outcomes, code) = tested(folder.path(), &[]);
    assert_eq!((code, pending()), (Some(1), 2));
    assert_eq!((outcomes[0]["status"].as_str(), outcomes[1]["status"].as_str()), (Some("new"), Some("changed")));
    edit(folder.path(), "plc/shear.st", "Position_1 >= LowerLimit", "Position_1 > LowerLimit");
    let (_, code) = tested(folder.path(), &[]);
    assert_eq!((code, pending()), (Some(0), 1), "what is as it was waits no longer; what is new does");
    let (_, code) = tested(folder.path(), &["--bless"]);
    assert_eq!((code, pending()), (Some(0), 0));
    let read = |path: &Path| std::fs::read_to_string(path.join("snapshots/default.traj")).expect("a snapshot");
    let values = |text: &str| text.split_once("\ncase").map(|(_, rest)| rest.to_owned());
    assert!(values(&read(folder.path())) == values(&read(&scenario("shear"))), "the same bits as those reviewed");
}

#[test]
fn tolerances_forgive_what_is_declared() {
    let folder = copied_shear();
    std::fs::write(
        folder.path().join("cases.toml"),
        "version = 1\n[snapshot]\nsignals = [\"Position_1\", \"Position_2\"]\n[snapshot.tolerance]\nPosition_1 = 0.05\nPosition_2 = 0.05\n",
    )
    .expect("a file");
    assert_eq!(tested(folder.path(), &["--bless"]).1, Some(0));
    edit(folder.path(), "plant.toml", "acceleration_m_s2 = 2.5", "acceleration_m_s2 = 2.4");
    let (outcomes, code) = tested(folder.path(), &["--check", "--filter", "default"]);
    assert_eq!(code, Some(0), "{outcomes:?}");
    edit(folder.path(), "cases.toml", "0.05", "0.00001");
    let (outcomes, code) = tested(folder.path(), &["--check"]);
    assert_eq!(code, Some(1), "{outcomes:?}");
}

#[test]
fn cases_are_chosen_by_name_and_tag() {
    let folder = copied_shear();
    let names = |words: &[&str]| {
        let (outcomes, code) = tested(folder.path(), &[&["--check"], words].concat());
        assert_eq!(code, Some(0), "{outcomes:?}");
        let named = outcomes.iter().filter_map(|outcome| outcome["name"].as_str().map(str::to_owned));
        named.collect::<Vec<_>>()
    };
    assert_eq!(names(&["--filter", "uneven"]), ["uneven,speed_m_s=0.15", "uneven,speed_m_s=0.2"]);
    assert_eq!(
        names(&["--tag", "fault", "--tag", "boundary"]),
        ["on-the-limit", "on-the-limit-2", "sensor-lost", "lost-edges", "flipped-bits"]
    );
    assert_eq!(
        names(&["--skip-tag", "plant", "--skip-tag", "fault"]),
        ["default", "on-the-limit", "on-the-limit-2", "slow-sampling", "sensor-jitter,seed=1", "sensor-jitter,seed=2"]
    );
    let said = typed(folder.path(), &["test", ".", "--tag", "nightly"]);
    assert_eq!(said.code, Some(2));
    insta::assert_snapshot!(said.err);
}

#[test]
fn what_goes_wrong_has_its_exit_code() {
    let folder = copied_shear();
    // A fault of the PLC takes only its own test with it.
    edit(folder.path(), "plc/shear.st", "Strokes := Strokes + 1;", "Strokes := 1 / (Strokes - Strokes);");
    let said = typed(folder.path(), &["test", ".", "--check", "--filter", "on-the-limit", "--sarif", "log.sarif"]);
    assert_eq!(said.code, Some(3), "{said:?}");
    assert!(said.out.contains("division by zero") && said.out.contains("plc/shear.st:"), "{}", said.out);
    let log = std::fs::read_to_string(folder.path().join("log.sarif")).expect("a log");
    let log: serde_json::Value = serde_json::from_str(&log).expect("JSON");
    let result = &log["runs"][0]["results"][0];
    assert_eq!(result["ruleId"], "plc-fault");
    assert_eq!(result["locations"][0]["physicalLocation"]["artifactLocation"]["uri"], "plc/shear.st");

    edit(folder.path(), "plc/shear.st", "END_PROGRAM", "END_PROGAM");
    assert_eq!(typed(folder.path(), &["test", ".", "--check", "--filter", "default"]).code, Some(2));
    let nothing = tempfile::tempdir().expect("a folder");
    let said = typed(nothing.path(), &["test"]);
    assert_eq!(said.code, Some(2), "{said:?}");
}

#[test]
fn a_garbled_snapshot_is_reported_with_its_line() {
    let folder = copied_shear();
    let path = folder.path().join("snapshots/default.traj");
    let text = std::fs::read_to_string(&path).expect("a snapshot");
    std::fs::write(&path, &text[..text.len() / 2]).expect("a file");
    let said = typed(folder.path(), &["test", ".", "--check", "--filter", "default"]);
    assert_eq!(said.code, Some(2), "{said:?}");
    assert!(said.out.contains("default.traj: line "), "{}", said.out);
}

/// What git leaves in a snapshot that two branches have changed is named, and the review resolves it.
#[test]
fn a_snapshot_with_both_sides_of_a_merge_is_resolved_by_a_review() {
    let folder = copied_shear_of_snapshots();
    let file = folder.path().join("snapshots/default.traj");
    let ours = std::fs::read_to_string(&file).expect("it is there");
    let (from, to) =
        ("      0.00  FALSE\n", "<<<<<<< HEAD\n      0.00  FALSE\n=======\n      0.00  TRUE\n>>>>>>> feature\n");
    std::fs::write(&file, ours.replacen(from, to, 1)).expect("written");
    let line = 1 + ours.lines().position(|line| line == from.trim_end()).expect("a BOOL");

    let said = typed(folder.path(), &["test", ".", "--check", "-f", "default"]);
    assert_eq!(said.code, Some(1), "{said:?}");
    let note = format!("default.traj:{line} holds both sides of a merge; this run is that of `HEAD`");
    assert!(said.out.contains(&note), "{said:?}");
    let said = typed(folder.path(), &["test", ".", "-f", "default"]);
    assert!(said.out.contains("1 snapshot waits for a review"), "{said:?}");
    let said = typed(folder.path(), &["review", "."]);
    assert!(said.out.contains(&note), "{said:?}");
    let said = typed(folder.path(), &["review", ".", "--accept-all"]);
    assert_eq!((said.code, said.out.contains("accepted")), (Some(0), true), "{said:?}");
    // All but the name of the folder is as it was.
    let merged = std::fs::read_to_string(&file).expect("it is there");
    let behind_name = |text: &str| text.split_once("\ncase ").map(|(_, rest)| rest.to_owned());
    assert_eq!(behind_name(&merged), behind_name(&ours));
}

#[test]
fn ten_seconds_of_many_axes_are_small_text() {
    let folder = tempfile::tempdir().expect("a folder");
    let moved = |axis: u32| {
        format!(
            r#"
[[body]]
name = "b{axis}"
kind = "dynamic"
shape = "box"
size_m = [0.1, 0.1, 0.1]
mass_kg = 1.0
collides = false

[[joint]]
name = "j{axis}"
kind = "prismatic"
parent = "ground"
child = "b{axis}"
axis = [1.0, 0.0, 0.{axis}1]

[[axis]]
name = "a{axis}"
joint = "j{axis}"
drive = "velocity"
command_signal = "c{axis}"
speed_m_s = 1.0
acceleration_m_s2 = 0.0{axis}7
position_signal = "p{axis}"
"#
        )
    };
    let declared = |axis: u32| {
        format!(
            "p{axis} = {{ type = \"LREAL\", writer = \"plant\", unit = \"m\" }}\n\
             c{axis} = {{ type = \"LREAL\", writer = \"operator\" }}\n"
        )
    };
    let scene = format!("version = 1\n{}", (0..8).map(moved).collect::<String>());
    let signals: String = (0..8).map(declared).collect();
    let initial: Vec<String> = (0..8).map(|axis| format!("c{axis} = 0.{axis}3")).collect();
    let scenario = format!(
        "version = 1\nstep = \"1ms\"\nuntil = \"10s\"\n[signals]\n{signals}[clients.plant]\nkind = \"plant\"\nscene = \"plant.toml\"\n\
         [clients.operator]\nkind = \"operator\"\ninitial = {{ {} }}\n",
        initial.join(", ")
    );
    std::fs::write(folder.path().join("plant.toml"), scene).expect("a file");
    std::fs::write(folder.path().join("scenario.toml"), scenario).expect("a file");
    let said = typed(folder.path(), &["test", ".", "--bless"]);
    assert_eq!(said.code, Some(0), "{said:?}");
    let text = std::fs::read_to_string(folder.path().join("snapshots/default.traj")).expect("a snapshot");
    assert!(text.lines().count() > 800, "the axes move: {text}");
    assert!(text.len() < 50_000, "{} bytes", text.len());
}
