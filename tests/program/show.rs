//! `onescan show` as it is typed, and scenarios that take in another one.

use std::path::Path;

use serde_json::Value;

use crate::typed::{copied_shear, digests, edit, scenario, typed};

#[test]
fn a_variant_is_shown_as_one_file() {
    let said = typed(&scenario("shear"), &["show", "race.toml"]);
    assert_eq!((said.code, said.err.as_str()), (Some(0), ""));
    for line in [
        "until = \"600ms\"",
        "item_transfer = \"5ms\"",
        "update_rate = \"1ms\"",
        "c = { type = \"BOOL\", writer = \"plc\", about = \"both in the same scan: the blade is aligned\" }",
        "formula = \"always ((a or b) implies c)\"",
    ] {
        assert!(said.out.lines().any(|other| other == line), "{line} in {}", said.out);
    }
    for gone in ["strokes go on", "gateway", "base = ", "without = "] {
        assert!(!said.out.contains(gone), "{gone} in {}", said.out);
    }
}

/// What is shown runs to the same digest as the variant.
#[test]
fn what_is_shown_is_the_same_session() {
    let shear = copied_shear();
    let digest = |file: &str| {
        let said = typed(shear.path(), &["run", file, "--format", "json"]);
        digests(&[serde_json::from_str(said.out.trim()).expect("a report")])
    };
    let shown = typed(shear.path(), &["show", "race.toml"]).out;
    std::fs::write(shear.path().join("whole.toml"), shown).unwrap();
    assert_eq!(digest("whole.toml"), digest("race.toml"));
    let json = |file: &str| typed(shear.path(), &["show", file, "--format", "json"]).out;
    let whole: Value = serde_json::from_str(&json("whole.toml")).expect("JSON");
    assert_eq!((&whole["freewheel"]["update_rate"], &whole["base"]), (&"1ms".into(), &Value::Null));
    assert_eq!(json("whole.toml"), json("race.toml"));
}

/// A recording holds the base, so that the variant runs from its copy; the scenario's own file is not taken for it.
#[test]
fn a_recording_of_a_variant_holds_its_base() {
    let shear = copied_shear();
    let run = |folder: &Path, words: &[&str]| {
        let said = typed(folder, &[&["run", "race.toml", "--format", "json"], words].concat());
        assert_eq!(said.code, Some(0), "{said:?}");
        digests(&[serde_json::from_str(said.out.trim()).expect("a report")])
    };
    let digest = run(shear.path(), &["--record", "recorded"]);
    let recorded = shear.path().join("recorded/run-1");
    let header = std::fs::read_to_string(recorded.join("recording.json")).expect("a header");
    for reported in ["\"file\": \"race.toml\"", "\"path\": \"race.toml\"", "\"path\": \"scenario.toml\""] {
        assert!(header.contains(reported), "{reported}: {header}");
    }
    assert_eq!(run(&recorded.join("scenario"), &[]), digest);
}

#[test]
fn what_is_wrong_in_a_base_is_shown_there() {
    let shear = copied_shear();
    edit(shear.path(), "scenario.toml", "kind = \"plant\"", "kind = \"plnt\"");
    let base = typed(shear.path(), &["show", "race.toml"]);
    edit(shear.path(), "race.toml", "\"clients.plc.gateway\"", "\"clients.plc.gatewy\"");
    let without = typed(shear.path(), &["show", "race.toml"]);
    edit(shear.path(), "race.toml", "scenario.toml\"", "scenari.toml\"");
    let missing = typed(shear.path(), &["show", "race.toml"]);
    for (said, reported) in [
        (base, "scenario.toml:"),
        (without, "the base has no `clients.plc.gatewy`"),
        (missing, "cannot read the base `scenari.toml`"),
    ] {
        assert_eq!((said.code, said.out.as_str()), (Some(2), ""), "{said:?}");
        assert!(said.err.contains(reported), "{reported} in {}", said.err);
    }
}

#[test]
fn the_editor_refuses_a_variant() {
    let said = typed(&scenario("shear"), &["edit", "race.toml"]);
    assert_eq!(said.code, Some(2), "{said:?}");
    assert!(said.err.contains("the scenario takes in `scenario.toml`"), "{}", said.err);
}
