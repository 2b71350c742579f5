//! What a scenario takes in, read from files.

use std::fs;
use std::path::Path;

use crate::case;
use crate::error::ScenarioError;
use crate::load::{Scenario, kept_as};

const BASE: &str = r#"version = 1
title = "line"
step = "10ms"
until = "1s"

[signals]
Start = { type = "BOOL", writer = "panel" }
Speed = { type = "REAL", writer = "panel", unit = "m/s" }
Feed = { type = "REAL", writer = "plc" }

[clients.panel]
kind = "operator"
initial = { Speed = 0.5 }

[clients.plc]
kind = "soft-plc"
sources = ["plc/main.st"]
tasks = [{ name = "main", interval = "10ms", programs = ["Main"] }]

[[expect]]
name = "it moves"
formula = "eventually Feed > 0"

[[expect]]
name = "it is slow"
formula = "always Feed < 1"
"#;

/// A folder with `scenario.toml` as above and these files.
fn folder(files: &[(&str, &str)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("scenario.toml"), BASE).unwrap();
    for (name, text) in files {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }
    folder
}

fn load(folder: &tempfile::TempDir, name: &str) -> Scenario {
    Scenario::load(&folder.path().join(name)).unwrap_or_else(|error| panic!("{error}"))
}

/// The message, the file and the text at the place of what is wrong with `variant`.
fn wrong(variant: &str, others: &[(&str, &str)]) -> String {
    let folder = folder(&[&[("variant.toml", variant)], others].concat());
    let error = Scenario::load(&folder.path().join("variant.toml")).expect_err("it is wrong");
    let ScenarioError::Wrong { message, file, place, .. } = &error else { return error.to_string() };
    let name = Path::new(file.name()).strip_prefix(folder.path()).expect("a file of the folder");
    let place = place.expect("a place");
    let text = &file.inner()[place.offset()..place.offset() + place.len()];
    format!("{message} @ {}: {text}", name.display())
}

#[test]
fn a_variant_states_what_differs() {
    let variant = r#"version = 1
base = "scenario.toml"
without = ["expect.'it is slow'", "signals.Start", "clients.panel.initial"]
title = "fast line"

[signals]
Speed = { unit = "km/h" }
Level = { type = "REAL", writer = "plc" }

[[clients.plc.tasks]]
name = "main"
interval = "20ms"

[[expect]]
name = "it fills"
formula = "eventually Level > 0"

[[expect]]
name = "it moves"
about = "the belt"
"#;
    let whole = r#"version = 1
title = "fast line"
step = "10ms"
until = "1s"

[signals]
Speed = { type = "REAL", writer = "panel", unit = "km/h" }
Feed = { type = "REAL", writer = "plc" }
Level = { type = "REAL", writer = "plc" }

[clients.panel]
kind = "operator"

[clients.plc]
kind = "soft-plc"
sources = ["plc/main.st"]
tasks = [{ name = "main", interval = "20ms", programs = ["Main"] }]

[[expect]]
name = "it moves"
formula = "eventually Feed > 0"
about = "the belt"

[[expect]]
name = "it fills"
formula = "eventually Level > 0"
"#;
    let folder = folder(&[("variant.toml", variant), ("whole.toml", whole)]);
    let (variant, whole) = (load(&folder, "variant.toml"), load(&folder, "whole.toml"));
    assert_eq!(variant.to_json().unwrap(), whole.to_json().unwrap());
    assert_eq!(format!("{:?}", variant.plan()), format!("{:?}", whole.plan()));
    let files: Vec<_> = variant.files().unwrap().iter().map(|file| file.display().to_string()).collect();
    assert_eq!(files, ["variant.toml", "scenario.toml", "plc/main.st"]);
}

#[test]
fn a_scenario_as_one_file_is_the_same_scenario() {
    let variant = "version = 1\nbase = 'scenario.toml'\nseed = 18446744073709551615\n\
                   title = \"a \\\"b\\\"\\n'c'\"\nsignals.\"Alarm[1..2]\" = { type = 'BOOL', writer = 'plc' }\n\
                   report = { ideal_cycle = '6s', alarm = [{ name = 'slow', when = 'Feed < 0.1' }] }\n\
                   clients.plc.bind = { \"Alarm[1..2]\" = \"Main.A[1..2]\" }\n";
    let folder = folder(&[("variant.toml", variant)]);
    let first = load(&folder, "variant.toml");
    let text = first.to_toml().unwrap();
    // What is short stands on one line, what belongs to a client below its header.
    for line in [
        "Start = { type = \"BOOL\", writer = \"panel\" }",
        "\"Alarm[1..2]\" = { type = \"BOOL\", writer = \"plc\" }",
        "alarm = [{ name = \"slow\", when = \"Feed < 0.1\" }]",
        "[[expect]]",
    ] {
        assert!(text.lines().any(|other| other == line), "{line} in {text}");
    }
    assert!(!text.contains("base = "), "{text}");
    fs::write(folder.path().join("one.toml"), &text).unwrap();
    let again = load(&folder, "one.toml");
    assert_eq!(again.bases().count(), 0);
    assert_eq!((again.to_json().unwrap(), again.seed()), (first.to_json().unwrap(), u64::MAX));
    assert_eq!(again.to_toml().unwrap(), text);
}

#[test]
fn what_is_wrong_is_shown_in_the_file_that_states_it() {
    let variant = "version = 1\nbase = 'middle.toml'\n";
    for (middle, culprit) in [
        ("step = 'soon'", "soon"),
        ("sigals = {}", "sigals"),
        ("[plot]\nsignals = ['Feeed']", "'Feeed'"),
        ("[signals]\nLevel = { type = 'REAL', writer = 'plcs' }", "'plcs'"),
        ("[[expect]]\nname = 'it moves'\nformula = 'eventually Feeed > 0'", "Feeed"),
        ("[[expect]]\nname = 'it is fast'", ""),
        ("[[panel]]\nname = 'p'\nelement = [{ kind = 'lamp', signal = 'Strat', at = [0, 0] }]", "'Strat'"),
        ("a = [", ""),
    ] {
        let middle = format!("version = 1\nbase = 'scenario.toml'\n{middle}");
        let shown = wrong(variant, &[("middle.toml", &middle)]);
        let (_, place) = shown.split_once(" @ ").expect("a place");
        assert!(place.starts_with("middle.toml: ") && place.contains(culprit), "{shown}");
    }
    let own = wrong("version = 1\nbase = 'scenario.toml'\n[plot]\nsignals = ['Feeed']", &[]);
    assert!(own.ends_with(" @ variant.toml: 'Feeed'"), "{own}");
}

#[test]
fn circles_are_refused() {
    let circle = [("a.toml", "version = 1\nbase = 'b.toml'"), ("b.toml", "version = 1\nbase = './a.toml'")];
    assert_eq!(
        wrong("version = 1\nbase = 'a.toml'\n", &circle),
        "the base `./a.toml` takes in this file: they lead in a circle @ b.toml: './a.toml'"
    );
    assert_eq!(
        wrong("version = 1\nbase = 'variant.toml'\n", &[]),
        "the base `variant.toml` takes in this file: they lead in a circle @ variant.toml: 'variant.toml'"
    );
}

#[test]
fn what_is_not_there_is_refused() {
    let missing = wrong("version = 1\nbase = 'plant.toml'\n", &[]);
    assert!(missing.starts_with("cannot read the base `plant.toml`: "), "{missing}");
    assert!(missing.ends_with(" @ variant.toml: 'plant.toml'"), "{missing}");
    let without = |list: &str| wrong(&format!("version = 1\nbase = 'scenario.toml'\nwithout = {list}\n"), &[]);
    assert_eq!(without("['signals.Strat']"), "the base has no `signals.Strat` @ variant.toml: 'signals.Strat'");
    assert_eq!(without("['signals Start']"), "`signals Start` is not a path of keys @ variant.toml: 'signals Start'");
    assert!(without("[\"a = 1\\nb\"]").contains("is not a path of keys"));
    for wrong_type in [without("'signals'"), wrong("version = 1\nbase = 3\n", &[])] {
        assert!(wrong_type.starts_with("invalid type") && wrong_type.contains(" @ variant.toml: "), "{wrong_type}");
    }
    let alone = wrong("version = 1\nwithout = ['signals.Start']\n", &[]);
    assert_eq!(alone, "`without` needs a `base` @ variant.toml: 'signals.Start'");
}

#[test]
fn every_file_states_its_version() {
    let none = wrong("base = 'scenario.toml'\n", &[]);
    assert!(none.starts_with("missing field `version` @ variant.toml: "), "{none}");
    let other = "version 2 of the scenario format is not known @ variant.toml: 2";
    assert_eq!(wrong("version = 2\nbase = 'scenario.toml'\n", &[]), other);
    let old = wrong("version = 1\nbase = 'old.toml'\n", &[("old.toml", "version = 0\n")]);
    assert_eq!(old, "version 0 of the scenario format is not known @ old.toml: 0");
}

#[cfg(unix)]
#[test]
fn a_base_lies_where_a_scenario_may_read() {
    let folder = folder(&[("own/variant.toml", "version = 1\nbase = '../scenario.toml'\n")]);
    let error = Scenario::load(&folder.path().join("own/variant.toml")).expect_err("it is outside").to_string();
    assert!(error.contains("outside of the scenario's folder"), "{error}");
}

#[test]
fn a_base_in_a_folder_below_names_its_own_files() {
    let lib = "version = 1\nbase = 'more/first.toml'\nclients.plant = { kind = 'plant', scene = 'plant.toml' }\n\
               panel = [{ name = 'p', picture = '../p.svg', element = [] }]\n";
    let folder = folder(&[
        ("variant.toml", "version = 1\nbase = 'lib/line.toml'\n"),
        ("lib/line.toml", lib),
        ("lib/more/first.toml", BASE),
        ("p.svg", "<svg xmlns='http://www.w3.org/2000/svg'/>"),
    ]);
    let shown = load(&folder, "variant.toml").to_json().unwrap();
    assert_eq!(shown["clients"]["plant"]["scene"], "lib/plant.toml");
    assert_eq!(shown["clients"]["plc"]["sources"][0], "lib/more/plc/main.st");
    assert_eq!(shown["panel"][0]["picture"], "p.svg");
}

#[test]
fn a_variant_has_the_cases_of_its_base_unless_it_has_its_own() {
    let named = |name: &str| format!("version = 1\nbase = '{name}'\n");
    let folder = folder(&[
        ("cases.toml", "version = 1\n"),
        ("serial.toml", &named("scenario.toml")),
        ("serial.cases.toml", "version = 1\n"),
        ("old.toml", &named("serial.toml")),
        ("mended.toml", &named("scenario.toml")),
        ("own.toml", &named("old.toml")),
        ("own.cases.toml", "version = 1\n"),
    ]);
    let of = |name: &str| {
        let path = case::beside(&folder.path().join(name)).unwrap();
        path.strip_prefix(folder.path()).unwrap().display().to_string()
    };
    let found = ["", "scenario.toml", "serial.toml", "old.toml", "mended.toml", "own.toml"].map(of);
    let cases = "cases.toml serial.cases.toml".split(' ').collect::<Vec<_>>();
    assert_eq!(found, [cases[0], cases[0], cases[1], cases[1], cases[0], "own.cases.toml"]);
    assert_eq!(load(&folder, "old.toml").cases_file().unwrap(), Path::new("serial.cases.toml"));
}

#[test]
fn what_a_recording_names_is_a_file_of_its_folder() {
    let folder = folder(&[("race.toml", BASE)]);
    let kept = |name: &str, file: Option<&str>| {
        let path = kept_as(folder.path(), name, file);
        path.strip_prefix(folder.path()).unwrap().display().to_string()
    };
    assert_eq!(kept("race", Some("race.toml")), "race.toml");
    assert_eq!(kept("race", Some("../../race.toml")), "race.toml");
    assert_eq!(kept("race", None), "scenario.toml", "as earlier versions recorded it");
}
