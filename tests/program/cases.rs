//! `cases.toml`: one scenario tried in many ways.

use crate::typed::{Said, copied_shear, digests, edit, typed};

/// The shear with these cases and no other.
fn shear_with(cases: &str) -> tempfile::TempDir {
    let folder = copied_shear();
    std::fs::write(folder.path().join("cases.toml"), format!("version = 1\n{cases}")).expect("a file");
    folder
}

fn run_case(folder: &tempfile::TempDir, name: &str, more: &[&str]) -> Said {
    let words = [&["run", ".", "--case", name, "--until", "2s", "--format", "json"], more].concat();
    typed(folder.path(), &words)
}

#[test]
fn a_constant_of_the_plc_is_set_in_its_place() {
    let folder =
        shear_with("[[case]]\nname = \"low\"\nset.plc.Shear.LowerLimit = -0.08\nset.plc.Shear.Rest = \"T#50ms\"\n");
    let set = digest(&run_case(&folder, "low", &[]));
    edit(folder.path(), "plc/shear.st", "LREAL := -0.10", "LREAL := -0.08");
    edit(folder.path(), "plc/shear.st", "TIME := T#100ms", "TIME := T#50ms");
    let written = typed(folder.path(), &["run", ".", "--until", "2s", "--format", "json"]);
    assert_eq!(set, digest(&written), "as if it had been written so");
}

fn digest(said: &Said) -> String {
    assert_eq!(said.code, Some(0), "{said:?}");
    let reports: Vec<_> = said.out.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
    digests(&reports).remove(0)
}

const CASES: &str = r#"
[[case]]
name = "plain"

[[case]]
name = "slow"
set.plant.actuator_1.speed_m_s = 0.2
set.plant.actuator_2.speed_m_s = 0.2

[[case]]
name = "late"
set.plc.Shear.Strokes = 40

[[case]]
name = "held"
waive = ["both sides at once"]

[[case.force]]
signal = "Sensor_1"
value = false
from = "1.5s"
until = "1.7s"
"#;

#[test]
fn each_case_has_its_own_trajectory_and_always_the_same() {
    let folder = shear_with(CASES);
    let plain = digest(&run_case(&folder, "plain", &[]));
    let as_it_is = typed(folder.path(), &["run", ".", "--until", "2s", "--format", "json"]);
    assert_eq!(plain, digest(&as_it_is), "a case that changes nothing changes no bit");
    let all = ["plain", "slow", "late", "held"].map(|name| digest(&run_case(&folder, name, &[])));
    for (index, one) in all.iter().enumerate() {
        assert!(all[..index].iter().all(|other| other != one), "{all:?}");
    }
    let again = digest(&run_case(&folder, "held", &["--transport", "tcp"]));
    assert_eq!(again, all[3], "clients in processes of their own know their case");
}

#[test]
fn a_case_goes_on_from_a_checkpoint() {
    let folder = shear_with(CASES);
    let whole = digest(&run_case(&folder, "held", &[]));
    let saved = run_case(&folder, "held", &["--save-at", "1.6s", "--save", "held.ckpt"]);
    assert_eq!(digest(&saved), whole);
    let resumed = run_case(&folder, "held", &["--resume", "held.ckpt"]);
    assert_eq!(digest(&resumed), whole);
}

#[test]
fn an_initial_value_is_where_the_plc_begins() {
    let folder = shear_with(CASES);
    let said = run_case(&folder, "late", &["--record", "out", "--record-also", "csv"]);
    assert_eq!(said.code, Some(0), "{said:?}");
    let csv = std::fs::read_to_string(folder.path().join("out/run-1/trajectory.csv")).expect("a recording");
    let mut lines = csv.lines();
    let column = lines.next().and_then(|head| head.split(',').position(|name| name.starts_with("Strokes")));
    let column = column.expect("the signal is recorded");
    assert_eq!(lines.next().and_then(|line| line.split(',').nth(column)), Some("40"));
}

const OPERATED: &str = r#"
[[case]]
name = "pressed"

[[case.input]]
at = "300ms"
signal = "Start"
value = true

[[case.input]]
at = "600ms"
signal = "Start"
value = false
"#;

#[test]
fn an_operator_presses_a_button_at_its_instant() {
    let folder = shear_with(OPERATED);
    let path = folder.path().join("scenario.toml");
    let text = std::fs::read_to_string(&path).expect("a file");
    let text = text.replace("[signals]\n", "[signals]\nStart = { type = \"BOOL\", writer = \"operator\" }\n");
    std::fs::write(&path, format!("{text}\n[clients.operator]\nkind = \"operator\"\n")).expect("a file");
    let said = typed(folder.path(), &["test", ".", "--bless"]);
    assert_eq!(said.code, Some(0), "{said:?}");
    let cases = std::fs::read_to_string(folder.path().join("cases.toml")).expect("a file");
    std::fs::write(folder.path().join("cases.toml"), format!("{cases}\n[snapshot]\nsignals = [\"Start\"]\n"))
        .expect("a file");
    let said = typed(folder.path(), &["test", ".", "--bless"]);
    assert_eq!(said.code, Some(0), "{said:?}");
    let snapshot = std::fs::read_to_string(folder.path().join("snapshots/pressed.traj")).expect("a snapshot");
    insta::assert_snapshot!(snapshot.split_once("signal").expect("a signal").1);
}

#[test]
fn what_is_wrong_with_a_case_is_reported_with_its_place() {
    let reported = |case: &str| {
        let folder = shear_with(&format!("[[case]]\nname = \"a\"\n{case}\n"));
        let said = typed(folder.path(), &["run", ".", "--case", "a"]);
        assert_eq!((said.code, said.out.as_str()), (Some(2), ""), "{said:?}");
        said.err
    };
    let wrong = [
        "set.plnat.actuator_1.speed_m_s = 1.0",
        "set.plant.acutator_1.speed_m_s = 1.0",
        "set.plant.actuator_1.sped_m_s = 1.0",
        "set.plant.actuator_1.speed_m_s = -1.0",
        "set.plc.Shear.Storkes = 1",
        "set.plc.Shear.Strokes = \"many\"",
        "set.plc.Shear.LowerLimit = \"low\"",
        "set.plc.Shear.Dwell.PT = 5",
        "force = [{ signal = \"Sensor1\", value = true }]",
        "force = [{ signal = \"Sensor_1\", value = 3 }]",
        "force = [{ signal = \"Sensor_1\", value = true, from = \"2s\", until = \"1s\" }]",
        "fault = [{ component = \"gripper\", mode = \"stuck\" }]",
        "waive = [\"both sides\"]",
        "expect = [{ name = \"b\", formula = \"always Stroks > 0\" }]",
        "matrix.seed = []",
        "tag = [\"x\"]",
    ];
    let all: Vec<String> = wrong.iter().map(|case| format!("{case}\n{}", reported(case))).collect();
    insta::assert_snapshot!(all.join("\n"));
}

#[test]
fn an_unknown_case_is_reported_with_the_nearest() {
    let folder = shear_with(CASES);
    let said = typed(folder.path(), &["run", ".", "--case", "slwo"]);
    assert_eq!(said.code, Some(2), "{said:?}");
    let own = folder.path().file_name().expect("a name").to_string_lossy().into_owned();
    insta::assert_snapshot!(said.err.replace(&own, "shear"));
}

/// Names in a list of cases can be copied: none goes over the end of a line.
#[test]
fn names_of_cases_are_never_broken() {
    let said = typed(&crate::typed::scenario("shear"), &["minimise", ".", "--case", "NAME"]);
    assert_eq!(said.code, Some(2), "{said:?}");
    for name in ["on-the-limit-2,", "slow-sampling,", "sensor-jitter,seed=2,", "flipped-bits\n"] {
        assert!(said.err.contains(name), "{name}: {said:?}");
    }
}

#[test]
fn a_component_fails_for_a_while() {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = "version = 1\n\n[[component]]\nname = \"valve\"\nkind = \"pneumatic_cylinder\"\n";
    let kinds = typed(folder.path(), &["components", "pneumatic_cylinder", "--format", "json"]);
    let kind: serde_json::Value = serde_json::from_str(&kinds.out).expect("JSON");
    let mode = kind["failures"][0]["mode"].as_str().expect("it can fail");
    let output = &kind["outputs"][0];
    let ty = if output["values"] == "bool" { "BOOL" } else { "LREAL" };
    let output = output["key"].as_str().expect("it has an output");
    let scene = format!("{scene}{output}_signal = \"out\"\n");
    std::fs::write(folder.path().join("plant.toml"), scene).expect("a file");
    let scenario = format!(
        "version = 1\nstep = \"10ms\"\nuntil = \"100ms\"\n[signals]\nout = {{ type = \"{ty}\", writer = \"plant\" }}\n\
         [clients.plant]\nkind = \"plant\"\nscene = \"plant.toml\"\n"
    );
    std::fs::write(folder.path().join("scenario.toml"), scenario).expect("a file");
    let case = |mode: &str| {
        let text = format!(
            "version = 1\n[[case]]\nname = \"stuck\"\nfault = [{{ component = \"valve\", mode = \"{mode}\", from = \"20ms\", until = \"40ms\" }}]\n"
        );
        std::fs::write(folder.path().join("cases.toml"), text).expect("a file");
        typed(folder.path(), &["run", ".", "--case", "stuck"])
    };
    let said = case(mode);
    assert_eq!(said.code, Some(0), "{said:?}");
    let said = case(&format!("{mode}x"));
    assert_eq!(said.code, Some(2), "{said:?}");
    assert!(said.err.contains("cases.toml") && said.err.contains("did you mean"), "{said:?}");
}
