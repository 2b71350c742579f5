//! What a scenario takes in, read from files.

use std::fs;
use std::path::Path;

use miette::Diagnostic;

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
    let read = error.source_code().unwrap().read_span(&place, 0, 0).unwrap();
    format!("{message} @ {}: {}", name.display(), String::from_utf8_lossy(read.data()))
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
    insta::assert_snapshot!(text);
    fs::write(folder.path().join("one.toml"), &text).unwrap();
    let again = load(&folder, "one.toml");
    assert_eq!(again.bases().count(), 0);
    assert_eq!((again.to_json().unwrap(), again.seed()), (first.to_json().unwrap(), u64::MAX));
    assert_eq!(again.to_toml().unwrap(), text);
}

#[test]
fn what_is_wrong_is_shown_in_the_file_that_states_it() {
    let variant = "version = 1\nbase = 'middle.toml'\n";
    let shown =
        |middle: &str| wrong(variant, &[("middle.toml", &format!("version = 1\nbase = 'scenario.toml'\n{middle}"))]);
    insta::assert_snapshot!(
        [
            shown("step = 'soon'"),
            shown("sigals = {}"),
            shown("[plot]\nsignals = ['Feeed']"),
            shown("[signals]\nLevel = { type = 'REAL', writer = 'plcs' }"),
            shown("[[expect]]\nname = 'it moves'\nformula = 'eventually Feeed > 0'"),
            shown("[[expect]]\nname = 'it is fast'"),
            shown("[[panel]]\nname = 'p'\nelement = [{ kind = 'lamp', signal = 'Strat', at = [0, 0] }]"),
            shown("a = ["),
            wrong("version = 1\nbase = 'scenario.toml'\n[plot]\nsignals = ['Feeed']", &[]),
        ]
        .join("\n")
    );
}

#[test]
fn circles_and_what_is_not_there_are_refused() {
    let circle = [("a.toml", "version = 1\nbase = 'b.toml'"), ("b.toml", "version = 1\nbase = './a.toml'")];
    let file = |head: &str| format!("version = 1\n{head}\n");
    insta::assert_snapshot!(
        [
            wrong(&file("base = 'a.toml'"), &circle),
            wrong(&file("base = 'variant.toml'"), &[]),
            wrong(&file("base = 'plant.toml'"), &[]).split(':').next().unwrap_or_default().to_owned(),
            wrong(&file("base = 3"), &[]),
            wrong(&file("base = 'scenario.toml'\nwithout = ['signals.Strat']"), &[]),
            wrong(&file("base = 'scenario.toml'\nwithout = ['signals Start']"), &[]),
            wrong(&file("base = 'scenario.toml'\nwithout = ['a = 1\nb']"), &[]),
            wrong(&file("base = 'scenario.toml'\nwithout = 'signals'"), &[]),
            wrong(&file("without = ['signals.Start']"), &[]),
            wrong("base = 'scenario.toml'\n", &[]),
            wrong("version = 2\nbase = 'scenario.toml'\n", &[]),
            wrong(&file("base = 'old.toml'"), &[("old.toml", "version = 0\n")]),
        ]
        .join("\n")
    );
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
