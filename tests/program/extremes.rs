//! Every number of every file at its ends: the JSON schemas are walked along good files, and each numeric key and each duration
//! that they know gets the smallest and the largest value that it may have, or that can be written where it has no bound. What
//! comes of it is an error or a short run; never a panic, and never a cost without a bound.

use std::collections::BTreeSet;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

use onescan_base::{TimeSpan, VirtualTime};
use onescan_plant::Plant;
use onescan_runner::run::rerun::rerun;
use onescan_scenario::Scenario;
use onescan_scenario::case::Catalogue;
use onescan_scenario::lesson::Book;
use onescan_server::client::Client;
use onescan_server::signal::{ClientName, Port};
use serde_json::Value as Json;
use toml::Value;

use crate::typed::{copied_from, scenario};

/// A place in a file: keys, and indices of lists.
type Way = Vec<Step>;

#[derive(Clone, Debug)]
enum Step {
    Key(String),
    At(usize),
}

/// A key of a schema at a place of a file, with the values at its ends.
struct Number {
    way: Way,
    ends: Vec<Value>,
}

fn schema(name: &str) -> Json {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/schemas").join(format!("{name}.schema.json"));
    serde_json::from_str(&std::fs::read_to_string(path).expect("a schema")).expect("JSON")
}

/// The schemas of which one holds.
fn alternatives(schema: &Json) -> Vec<&Json> {
    let listed = ["anyOf", "oneOf"].iter().find_map(|key| schema[*key].as_array());
    listed.map_or_else(|| vec![schema], |all| all.iter().flat_map(alternatives).collect())
}

/// Whether a table may be one of this schema: its kind is, and so are all its keys.
fn fits(table: &toml::Table, schema: &Json) -> bool {
    let Some(properties) = schema["properties"].as_object() else { return schema["additionalProperties"].is_object() };
    let same = |(key, about): (&String, &Json)| {
        about["const"].is_null() || table.get(key).and_then(Value::as_str) == about["const"].as_str()
    };
    let known = |key: &String| properties.contains_key(key) || schema["additionalProperties"] != Json::Bool(false);
    properties.iter().filter(|(_, about)| !about["const"].is_null()).all(same) && table.keys().all(known)
}

/// The values at the ends of a number or a duration.
fn ends(schema: &Json) -> Vec<Value> {
    let mut found = Vec::new();
    for one in alternatives(schema) {
        let bound = |key: &str| one[key].as_f64();
        match one["type"].as_str() {
            Some("integer") => {
                let whole =
                    |key: &str, none: i64| one[key].as_i64().or(bound(key).map(|value| value as i64)).unwrap_or(none);
                found.extend([whole("minimum", i64::MIN), whole("maximum", i64::MAX)].map(Value::Integer));
            }
            Some("number") => {
                let (low, high) = (bound("minimum"), bound("maximum"));
                found.extend([low.unwrap_or(-f64::MAX), high.unwrap_or(f64::MAX), 5e-324].map(Value::Float));
            }
            Some("string") if one["pattern"].as_str().is_some_and(|pattern| pattern.contains("ns|us|ms|s|min|h")) => {
                found.extend(["1ns", "18446744073709551615ns"].map(|text| Value::String(text.to_owned())));
            }
            _ => {}
        }
    }
    found
}

/// All numbers that the schema knows along the file, each key of the schema once.
fn numbers(schema: &Json, value: &Value, way: &Way, seen: &mut BTreeSet<String>, found: &mut Vec<Number>, name: &str) {
    let below = |step: Step| [&way[..], &[step]].concat();
    match value {
        Value::Table(table) => {
            for one in alternatives(schema).into_iter().filter(|one| fits(table, one)) {
                let kind = table.get("kind").and_then(Value::as_str).unwrap_or_default();
                for (key, about) in one["properties"].as_object().into_iter().flatten() {
                    let name = format!("{name}.{kind}.{key}");
                    let ends = ends(about);
                    if !ends.is_empty() && seen.insert(name.clone()) {
                        found.push(Number { way: below(Step::Key(key.clone())), ends });
                    }
                    if let Some(inner) = table.get(key) {
                        numbers(about, inner, &below(Step::Key(key.clone())), seen, found, &name);
                    }
                }
                let more = &one["additionalProperties"];
                for (key, inner) in
                    table.iter().filter(|(key, _)| more.is_object() && one["properties"].get(*key).is_none())
                {
                    let ends = ends(more);
                    if !ends.is_empty() && seen.insert(format!("{name}.*")) {
                        found.push(Number { way: below(Step::Key(key.clone())), ends });
                    }
                    numbers(more, inner, &below(Step::Key(key.clone())), seen, found, &format!("{name}.*"));
                }
            }
        }
        Value::Array(list) => {
            for one in alternatives(schema) {
                for (at, inner) in list.iter().enumerate() {
                    let items = one["prefixItems"].get(at).unwrap_or(&one["items"]);
                    let ends = ends(items);
                    if !ends.is_empty() && seen.insert(format!("{name}[]")) {
                        found.push(Number { way: below(Step::At(at)), ends });
                    }
                    numbers(items, inner, &below(Step::At(at)), seen, found, &format!("{name}[]"));
                }
            }
        }
        _ => {}
    }
}

/// The file with another value at a place.
fn changed(file: &Value, way: &[Step], end: &Value) -> Value {
    let Some((step, rest)) = way.split_first() else { return end.clone() };
    let mut file = file.clone();
    match (step, &mut file) {
        (Step::Key(key), Value::Table(table)) => {
            let before = table.get(key).cloned().unwrap_or(Value::Boolean(false));
            table.insert(key.clone(), changed(&before, rest, end));
        }
        (Step::At(at), Value::Array(list)) => list[*at] = changed(&list[*at], rest, end),
        (step, other) => panic!("{step:?} is not in {other}"),
    }
    file
}

/// Tries all numbers of a file; gives how many there were, and those that panicked.
fn tried(kind: &str, path: &Path, seen: &mut BTreeSet<String>, run: &dyn Fn()) -> (usize, Vec<String>) {
    let text = std::fs::read_to_string(path).expect("a file");
    let Ok(file) = toml::from_str::<Value>(&text) else { return (0, Vec::new()) };
    let (mut found, mut bad) = (Vec::new(), Vec::new());
    numbers(&schema(kind), &file, &Way::new(), seen, &mut found, kind);
    let mut count = 0;
    for Number { way, ends } in &found {
        for end in ends {
            count += 1;
            let name = format!("{}: {way:?} = {end}", path.display());
            std::fs::write(path, toml::to_string(&changed(&file, way, end)).expect("TOML")).expect("a file");
            // What ends the whole process is found by the last line.
            if std::env::var_os("ONESCAN_EXTREMES").is_some() {
                eprintln!("{name}");
            }
            if catch_unwind(AssertUnwindSafe(run)).is_err() {
                bad.push(name);
            }
        }
    }
    std::fs::write(path, text).expect("a file");
    (count, bad)
}

/// Three turns of a plant, if it is one.
fn moves(scene: &Path) {
    const PERIOD: TimeSpan = TimeSpan::nanos::<10_000_000>();
    let Ok(mut plant) = Plant::load(scene, ClientName::new("plant").expect("a name"), PERIOD) else { return };
    let request = plant.join();
    let bytes = |ports: &[Port]| vec![0_u8; ports.iter().map(|port| port.ty.size()).sum()];
    let (inputs, mut outputs) = (bytes(&request.reads), bytes(&request.writes));
    let _fault = plant.setup(&mut outputs).is_err();
    let mut turn = |step: u64| plant.turn(VirtualTime::from_nanos(step * PERIOD.as_nanos()), &inputs, &mut outputs);
    // A fault is an answer like any other.
    let _faults = [1, 2, 3].map(|step| turn(step).is_err());
}

/// Three steps of a scenario, its cases and its lessons, if it is one.
fn runs(file: &Path) {
    let Ok(scenario) = Scenario::load(file) else { return };
    let step = scenario.plan().step();
    let until = step.times(3).map_or(VirtualTime::MAX, |three| VirtualTime::from_nanos(three.as_nanos()));
    // It may lack a client that is a program of its own.
    let _ran = rerun(&scenario, until, Vec::new()).is_ok();
    if let Ok(catalogue) = Catalogue::load(file) {
        for case in catalogue.cases().iter().take(3) {
            drop(scenario.clone().with_case(&catalogue, case));
        }
        for campaign in catalogue.campaigns() {
            drop(scenario.campaign_measures(&catalogue, campaign));
        }
    }
    drop(Book::load(&scenario));
}

/// The examples of the manuals: each block of TOML with a component, made a scene.
fn examples() -> Vec<String> {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/plant.md");
    let page = std::fs::read_to_string(docs).expect("a manual");
    let blocks = page.split("```toml\n").skip(1).filter_map(|block| block.split("```").next());
    let scenes = blocks.filter(|block| block.contains("[["));
    scenes
        .map(|block| if block.contains("version =") { block.to_owned() } else { format!("version = 1\n{block}") })
        .collect()
}

/// A scene for each kind of component, with what it must have, if that makes a plant.
fn kinds() -> Vec<String> {
    let plant = schema("plant");
    let kinds = alternatives(&plant["properties"]["component"]["items"]);
    let scene = |about: &&Json| {
        let kind = about["properties"]["kind"]["const"].as_str()?;
        let mut component = toml::Table::from_iter([("name".to_owned(), Value::String("part".to_owned()))]);
        component.insert("kind".to_owned(), Value::String(kind.to_owned()));
        for key in about["required"].as_array().into_iter().flatten().filter_map(Json::as_str) {
            let value = ends(&about["properties"][key]).into_iter().next();
            component.entry(key).or_insert_with(|| value.unwrap_or_else(|| Value::String("part".to_owned())));
        }
        let file = [("version", Value::Integer(1)), ("component", Value::Array(vec![Value::Table(component)]))];
        toml::to_string(&toml::Table::from_iter(file.map(|(key, value)| (key.to_owned(), value)))).ok()
    };
    kinds.iter().filter_map(scene).collect()
}

fn assert_none_panicked(tries: usize, at_least: usize, bad: &[String]) {
    assert!(tries >= at_least, "only {tries} were tried");
    assert!(bad.is_empty(), "{} of {tries}:\n{}", bad.len(), bad.join("\n"));
}

#[test]
fn no_number_of_a_scene_is_beyond_the_plant() {
    let folder = tempfile::tempdir().expect("a folder");
    let (mut seen, mut tries, mut bad) = (BTreeSet::new(), 0, Vec::new());
    let mut scenes: Vec<PathBuf> = Vec::new();
    for name in ["arc-furnace", "filling-machine", "gantry-robot", "peeling-line", "robot-cell", "rotary-kiln", "shear"]
    {
        let copy = copied_from(&scenario(name)).keep();
        scenes.push(copy.join("plant.toml"));
    }
    for (at, text) in examples().into_iter().chain(kinds()).enumerate() {
        let path = folder.path().join(format!("{at}.toml"));
        std::fs::write(&path, text).expect("a file");
        scenes.push(path);
    }
    for scene in &scenes {
        let (count, found) = tried("plant", scene, &mut seen, &|| moves(scene));
        tries += count;
        bad.extend(found);
    }
    for copy in scenes.iter().filter(|scene| !scene.starts_with(folder.path())) {
        std::fs::remove_dir_all(copy.parent().expect("a folder")).expect("our own folder");
    }
    assert_none_panicked(tries, 800, &bad);
}

#[test]
fn no_number_of_a_scenario_is_beyond_a_session() {
    let (mut seen, mut tries, mut bad) = (BTreeSet::new(), 0, Vec::new());
    for (name, files) in [
        ("shear", &["scenario.toml", "cases.toml"][..]),
        ("filling-machine", &["scenario.toml", "cases.toml"]),
        ("rotary-kiln", &["scenario.toml", "thesis.toml", "serial.toml"]),
        ("arc-furnace", &["lessons.toml"]),
    ] {
        let copy = copied_from(&scenario(name));
        for file in files {
            let kind = match *file {
                "cases.toml" => "cases",
                "lessons.toml" => "training",
                _ => "scenario",
            };
            let path = copy.path().join(file);
            let own = if kind == "scenario" { path.clone() } else { copy.path().to_owned() };
            let (count, found) = tried(kind, &path, &mut seen, &|| runs(&own));
            tries += count;
            bad.extend(found);
        }
    }
    assert_none_panicked(tries, 80, &bad);
}
