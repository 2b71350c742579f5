//! Every number of every file at its ends: the JSON schemas are walked along good files, and each numeric key and each duration
//! that they know gets the smallest and the largest value that it may have, or that can be written where it has no bound. What
//! comes of it is an error or a short run; never a panic, and never a cost without a bound.

use std::collections::BTreeSet;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

use onescan_base::{TimeSpan, VirtualTime};
use onescan_plant::Plant;
use onescan_runner::run::production::{pictures, tables};
use onescan_runner::run::rerun::rerun;
use onescan_scenario::Scenario;
use onescan_scenario::case::Catalogue;
use onescan_scenario::lesson::Book;
use onescan_scenario::report::Report;
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

/// The same for a key that may be anything, by what it is in the file.
fn ends_like(about: &Json, value: Option<&Value>) -> Vec<Value> {
    match value {
        Some(Value::Integer(_)) if *about == Json::Bool(true) => [i64::MIN, i64::MAX].map(Value::Integer).to_vec(),
        Some(Value::Float(_)) if *about == Json::Bool(true) => [-f64::MAX, f64::MAX, 5e-324].map(Value::Float).to_vec(),
        _ => ends(about),
    }
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
                    let ends = ends_like(about, table.get(key));
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
    let write = |file: &Value| {
        std::fs::write(path, toml::to_string(file).expect("TOML")).expect("a file");
        run();
    };
    let tried = all_tried((kind, &schema_of(kind)), &file, seen, &write);
    std::fs::write(path, text).expect("a file");
    tried
}

/// The same for a file as a value, and what is done with each that is made of it.
fn all_tried(
    (kind, schema): (&str, &Json),
    file: &Value,
    seen: &mut BTreeSet<String>,
    run: &dyn Fn(&Value),
) -> (usize, Vec<String>) {
    let (mut found, mut bad) = (Vec::new(), Vec::new());
    numbers(schema, file, &Way::new(), seen, &mut found, kind);
    let mut count = 0;
    for Number { way, ends } in &found {
        for end in ends {
            count += 1;
            let name = format!("{kind}: {way:?} = {end}");
            // What ends the whole process is found by the last line.
            if std::env::var_os("ONESCAN_EXTREMES").is_some() {
                eprintln!("{name}");
            }
            let file = changed(file, way, end);
            if catch_unwind(AssertUnwindSafe(|| run(&file))).is_err() {
                bad.push(name);
            }
        }
    }
    (count, bad)
}

/// The schema of a kind of file. That of kinds of component leaves their parts to that of plants.
fn schema_of(kind: &str) -> Json {
    let mut of_kind = schema(kind);
    if kind == "kinds" {
        let plant = schema("plant");
        for part in ["body", "shape", "urdf", "joint", "fitting", "coupling", "component"] {
            assert!(of_kind["properties"][part].is_object() && plant["properties"][part].is_object(), "{part}");
            of_kind["properties"][part] = plant["properties"][part].clone();
        }
    }
    of_kind
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

/// The kind of component of the manual, and the scene with it.
#[test]
fn no_number_of_a_kind_of_component_is_beyond_the_plant() {
    let folder = tempfile::tempdir().expect("a folder");
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/kinds.md");
    let page = std::fs::read_to_string(docs).expect("a manual");
    let block = |what: &str| {
        let mut blocks = page.split("```toml\n").skip(1).filter_map(|block| block.split("```").next());
        blocks.find(|block| block.contains(what)).expect("the manual shows it")
    };
    let (scene, kind) = (folder.path().join("plant.toml"), folder.path().join("components/press.toml"));
    std::fs::create_dir(folder.path().join("components")).expect("a folder");
    std::fs::write(&kind, block("summary = \"press")).expect("a file");
    std::fs::write(&scene, block("kind = \"press\"").replace(", \"../shared/components\"", "")).expect("a file");
    let oven = page.split("```st\n").skip(1).find_map(|block| block.split("```").next()).expect("an oven");
    std::fs::write(folder.path().join("components/oven.st"), oven).expect("a file");
    let name = ClientName::new("plant").expect("a name");
    Plant::load(&scene, name, TimeSpan::nanos::<10_000_000>()).expect("the manual is right");
    let mut seen = BTreeSet::new();
    let (mut tries, mut bad) = tried("kinds", &kind, &mut seen, &|| moves(&scene));
    for key in ["parameter[].least", "parameter[].most", "parameter[].preset", "body[].dynamic.mass_kg"] {
        assert!(seen.iter().any(|name| name.replace("..", ".").ends_with(key)), "{key} is not in {seen:?}");
    }
    // What a component of the kind is given, against its bounds.
    let (more, found) = tried("plant", &scene, &mut seen, &|| moves(&scene));
    tries += more;
    bad.extend(found);
    assert_none_panicked(tries, 40, &bad);
}

/// A report with one of everything.
fn whole_report() -> serde_json::Value {
    let occurrence = serde_json::json!({ "name": "hot", "from_ns": 5, "to_ns": 9, "duration_ns": 4 });
    serde_json::json!({
        "from_ns": 0, "to_ns": 1_000_000_000,
        "counts": [{ "name": "filled", "count": 7, "per_hour": 25_200.0, "quality": "good",
            "throughput": { "window_ns": 500_000_000, "counts": [3, 4] } }],
        "quality": { "good": 7, "reject": 1, "ratio": 0.875 },
        "cycles": [{ "name": "cycle", "count": 6, "abandoned": 1,
            "times": { "mean_ns": 100, "sigma_ns": 7, "median_ns": 99, "p95_ns": 110, "min_ns": 90, "max_ns": 120,
                "resolution_ns": 1 },
            "histogram": { "from_ns": 90, "bin_ns": 10, "counts": [2, 3, 1], "shorter": 1, "longer": 1 } }],
        "down_time": { "run_ns": 900, "down_ns": 100, "planned_ns": 40, "availability": 0.9, "failures": 2, "mtbf_ns": 450,
            "mttr_ns": 30, "causes": [{ "name": "jam", "planned": false, "count": 2, "total_ns": 60, "longest_ns": 40,
                "share": 0.06 }] },
        "oee": { "availability": 0.9, "performance": 0.8, "quality": 0.875, "oee": 0.63 },
        "alarms": { "totals": [{ "name": "hot", "count": 1, "total_ns": 4, "longest_ns": 4, "active": false }],
            "first": [occurrence], "left_out": 1, "last": [occurrence] },
        "histories": [{ "name": "zones", "window_ns": 500_000_000,
            "signals": [{ "signal": "T", "unit": "degC", "min": [1.0, 2.0], "mean": [2.0, 3.0], "max": [3.0, 4.0] }] }],
        "histograms": [{ "name": "zones", "from": 0.0, "to": 10.0,
            "signals": [{ "signal": "T", "unit": "degC", "time_ns": [5, 6], "below_ns": 1, "above_ns": 1,
                "not_finite_ns": 1 }] }],
    })
}

/// Every number of the report as a run of any length could have it, in tables and pictures.
#[test]
fn no_number_of_a_report_is_beyond_its_tables_and_pictures() {
    let file = Value::try_from(whole_report()).expect("no key is null");
    let shown = |file: &Value| {
        let json = serde_json::to_value(file).expect("JSON");
        let report: Report = serde_json::from_value(json).unwrap_or_else(|error| panic!("{error}: {file}"));
        let mut text = Vec::new();
        tables::write(&report, &mut text).expect("a list takes all");
        assert!(text.len() + pictures::of(&report).len() < 1 << 20, "it has a bound");
        drop(tables::for_pages(&report));
    };
    shown(&file);
    let schema = schema("report");
    let mut seen = BTreeSet::new();
    let (tries, bad) = all_tried(("report", &schema), &file, &mut seen, &shown);
    let of_type = |ty: &str| schema.to_string().matches(&format!("\"type\":\"{ty}\"")).count();
    let known = of_type("integer") + of_type("number");
    assert_eq!(seen.len(), known, "each number of the schema is in the report of this test: {seen:?}");
    assert_none_panicked(tries, 2 * known, &bad);
}
