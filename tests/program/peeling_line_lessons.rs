//! The peeling line as people see and operate it: where its blocks are seen, and the lessons at its bench.

use std::fs;

use serde_json::Value;

use crate::typed::{copied, scenario, typed, utf8};

/// A lesson of the line, with what an operator does in it.
fn trained(lesson: &str, operator: &str) -> (Option<i32>, Value) {
    let folder = tempfile::tempdir().expect("a folder");
    let starts = folder.path().join("starts");
    let words = ["train", ".", lesson, "--replay-operator", operator, "--starts", utf8(&starts), "--format", "json"];
    let said = typed(&scenario("peeling-line"), &words);
    let record = serde_json::from_str(said.out.trim()).unwrap_or_else(|_| panic!("{lesson}: {said:?}"));
    (said.code, record)
}

#[test]
fn experts_pass_all_lessons_and_whoever_does_nothing_passes_none() {
    let folder = tempfile::tempdir().expect("a folder");
    let idle = folder.path().join("idle.jsonl");
    fs::write(&idle, "").expect("a file");
    for lesson in ["joystick", "spin-out", "splinter"] {
        let (code, record) = trained(lesson, &format!("experts/{lesson}.jsonl"));
        assert_eq!(code, Some(0), "{lesson}: {record}");
        assert_eq!(record["attempts"][0]["score"], record["expert"]["score"], "{lesson}: the expert is the lesson's");
        let (code, record) = trained(lesson, utf8(&idle));
        assert_eq!(code, Some(1), "{lesson}: {record}");
    }
}

/// The eye's signals: each block is seen on the loader, in the centring spindles, in the arms and in the lathe, one after the other,
/// and the lathe is the only place where it may have a radius.
#[test]
fn a_block_is_seen_at_each_place_of_its_way() {
    let folder = copied("peeling-line");
    let places = ["Block_on_loader", "Block_in_centring", "Block_in_arms", "Block_in_lathe"];
    let way = places.windows(2).map(|pair| {
        let (here, next) = (pair[0], pair[1]);
        let formula = format!("eventually (fell({here}) and {next})");
        format!("[[case.expect]]\nname = \"from {here} to {next}\"\nformula = \"{formula}\"\n")
    });
    let way: String = way.collect();
    let radius = "[[case.expect]]\nname = \"a radius\"\nformula = \"always (Radius > 0 implies Block_in_lathe)\"\n";
    let case = format!("version = 1\n[[case]]\nname = \"seen\"\nuntil = \"13s\"\n{way}{radius}");
    fs::write(folder.path().join("cases.toml"), case).expect("a file");
    let said = typed(folder.path(), &["run", ".", "--case", "seen"]);
    assert_eq!(said.code, Some(0), "{said:?}");
    assert_eq!(said.out.matches("` met").count(), 9, "{said:?}");
}

/// Whoever opens its page sees the machine, and from each side of it.
#[test]
fn the_line_has_its_views_and_figures() {
    let text = fs::read_to_string(scenario("peeling-line").join("scenario.toml")).expect("the scenario");
    let file: toml::Table = text.parse().expect("TOML");
    let names = |key: &str| -> Vec<String> {
        let tables = file[key].as_array().unwrap_or_else(|| panic!("{key}"));
        tables.iter().filter_map(|table| table["name"].as_str().map(str::to_owned)).collect()
    };
    assert_eq!(names("view"), ["line", "charger", "lathe", "veneer"]);
    let figures = names("figure");
    for figure in ["block", "knife", "ribbon", "nosebar", "arms", "loader", "roll_top", "core"] {
        assert!(figures.iter().any(|name| name == figure), "{figure}: {figures:?}");
    }
    assert_eq!(names("panel"), ["bench", "malfunctions"]);
}
