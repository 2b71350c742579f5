//! The arc furnace: a heat's balances, its interlocks under any hand, its checkpoints.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::sitter::Sitter;
use crate::typed::{ROUNDS, copied, edit, is_the_same_over_tcp_and_resumed, rows, scenario, typed, utf8};
use crate::web::Served;

/// A run of the furnace: the values of these signals, a row a change, and what was said.
fn run<const N: usize>(more: &[&str], signals: [&str; N]) -> (Vec<[String; N]>, String) {
    let folder = tempfile::tempdir().expect("a folder");
    let record = folder.path().join("r");
    let mut words = [&["run", ".", "--record", utf8(&record)], more].concat();
    words.extend(signals.iter().flat_map(|signal| ["--record-signals", signal]));
    let said = typed(&scenario("arc-furnace"), &words);
    assert!(matches!(said.code, Some(0 | 1)), "{said:?}");
    let exported = typed(folder.path(), &["export", "r", "-o", "r.csv"]);
    assert_eq!(exported.code, Some(0), "{exported:?}");
    let table = fs::read_to_string(folder.path().join("r.csv")).expect("a table");
    let mut rows = table.lines().map(|line| line.split(',').collect::<Vec<&str>>());
    let head = rows.next().expect("a head");
    let columns = signals.map(|signal| head.iter().position(|name| *name == signal).expect("a column"));
    (rows.map(|row| columns.map(|column| row[column].to_owned())).collect(), said.out)
}

#[test]
fn the_energy_of_a_heat_is_in_balance() {
    let (rows, _) = run(&["--until", "65min"], ["Energy_in", "Energy_lost", "Energy_out", "Energy_held", "Tapped"]);
    let number = |text: &String| text.parse::<f64>().expect("a number");
    let (first, last) = (rows.first().expect("rows"), rows.last().expect("rows"));
    let [came, lost, out, held, tapped] = [0, 1, 2, 3, 4].map(|k| (number(&first[k]), number(&last[k])));
    let (brought_j, found_j) = (came.1 + held.0, lost.1 + out.1 + held.1);
    assert!((brought_j / found_j - 1.0).abs() < 1e-3, "{brought_j} {found_j}");
    assert!(tapped.1 > 99e3 && tapped.1 < 101e3, "{tapped:?}");
    // 385 kWh a tonne at an efficiency of 0.65
    let per_tonne_kwh = came.1 / 3.6e6 / (tapped.1 / 1000.0);
    assert!((per_tonne_kwh * 0.65 - 385.0).abs() < 20.0, "{per_tonne_kwh}");
}

#[test]
fn two_heats_are_an_hour_apart_and_hot_enough() {
    let said = typed(&scenario("arc-furnace"), &["run", "."]);
    assert_eq!(said.code, Some(0), "{said:?}");
}

#[test]
fn transport_and_checkpoints_do_not_matter() {
    // Electrodes have just touched, arcs burn, the tap changer is on its way.
    is_the_same_over_tcp_and_resumed("arc-furnace", ".", "9min", "478.5s");
}

/// A trainer's start: the flat bath, once reached, is there in no time, and every time the same.
#[test]
fn the_flat_bath_is_taken_up_again_twenty_times() {
    let folder = tempfile::tempdir().expect("a folder");
    let start = folder.path().join("flat-bath.ckpt");
    let digest = |more: &[&str]| {
        let words = [&["run", ".", "--until", "2890s", "--format", "json"], more].concat();
        let said = typed(&scenario("arc-furnace"), &words);
        let run: Value = serde_json::from_str(&said.out).expect("JSON");
        run["digest"].as_str().expect("a digest").to_owned()
    };
    let whole = digest(&["--save-at", "48min", "--save", utf8(&start)]);
    for _ in 0..20 {
        assert_eq!(digest(&["--resume", utf8(&start)]), whole);
    }
}

/// 10,000 inputs of any kind at any time: no power under an open roof, no tilt with electrodes down.
#[test]
fn no_hand_at_the_pulpit_gets_past_the_interlocks() {
    const STEPS: u64 = 500_000;
    const STEP_NS: u64 = 20_000_000;
    let mut random = 12u64;
    let mut draw = |below: u64| {
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (random >> 33) % below
    };
    let switches = [
        "Automatic",
        "Heat_start",
        "Emergency_stop",
        "Acknowledge",
        "Electrode_automatic",
        "Power_button",
        "Roof_switch",
        "Door_switch",
        "Car_switch",
        "Sample_button",
        "Join_electrode",
    ];
    let mut inputs = String::new();
    for number in 0..10_000 {
        let step = number * STEPS / 10_000;
        let (signal, value) = match draw(6) {
            0 => ("Tilt_lever".to_owned(), (draw(3) as i64 - 1).to_string()),
            1 => (format!("Lever[{}]", 1 + draw(3)), (draw(3) as i64 - 1).to_string()),
            2 => ("Programme_selector".to_owned(), draw(5).to_string()),
            _ => {
                let switch = switches[usize::try_from(draw(switches.len() as u64)).expect("small")];
                // mostly by hand, and mostly not stopped
                let on = match switch {
                    "Automatic" | "Emergency_stop" => draw(8) == 0,
                    "Acknowledge" | "Power_button" => draw(4) != 0,
                    _ => draw(2) == 0,
                };
                (switch.to_owned(), if on { "TRUE" } else { "FALSE" }.to_owned())
            }
        };
        let t_v_ns = step * STEP_NS;
        writeln!(
            inputs,
            r#"{{"step":{step},"t_v_ns":{t_v_ns},"event":"operator","action":"write","signal":"{signal}","value":"{value}"}}"#
        )
        .expect("a string takes all");
    }
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("inputs.jsonl");
    fs::write(&file, inputs).expect("writable");
    let (rows, said) = run(
        &["--until", "10000s", "--replay-operator", utf8(&file)],
        ["Breaker_closed", "Roof_opened", "Tilt_level", "Mast_up[2]"],
    );
    for law in ["no power under an open roof", "no tilt with electrodes down"] {
        assert!(said.contains(&format!("`{law}` met")), "{said}");
    }
    // all that could have met was tried
    for (column, least) in [(0, 20), (1, 3), (2, 10), (3, 10)] {
        let edges = rows.windows(2).filter(|pair| pair[0][column] != pair[1][column]).count();
        assert!(edges >= least, "column {column}: {edges} edges");
    }
}

/// The greatest distances from the library's mast, m: of the kind in Structured Text, and of the PLC that is the mechanics.
fn apart(folder: &Path) -> [f64; 2] {
    let record = folder.join("r");
    let words = ["run", "mechanics.toml", "--record-also", "csv", "--overwrite", "--record", utf8(&record)];
    let said = typed(folder, &words);
    assert_eq!(said.code, Some(0), "{said:?}");
    let rows = rows(&record.join("run-1"), &["Built_in", "Own_kind", "Second_plc"]);
    assert!(rows.len() > 2000, "{}", rows.len());
    [1, 2].map(|column| rows.iter().map(|row| (row[column] - row[0]).abs()).fold(0.0, f64::max))
}

/// Mechanics in Structured Text, as a kind of one's own and as a second PLC, are the library's within the error of Euler's
/// rule: half the step, half the distance.
#[test]
fn mechanics_in_structured_text_are_those_of_the_library() {
    let folder = copied("arc-furnace");
    let coarse = apart(folder.path());
    edit(folder.path(), "mechanics.toml", "\"20ms\"", "\"10ms\"");
    edit(folder.path(), "mechanics/mechanics.st", "0.02", "0.01");
    let fine = apart(folder.path());
    for (coarse, fine) in coarse.into_iter().zip(fine) {
        assert!(coarse > 1e-4 && coarse < 3.1e-3, "{coarse} m");
        assert!((coarse / fine - 2.0).abs() < 0.3, "{coarse} m, {fine} m");
    }
    is_the_same_over_tcp_and_resumed("arc-furnace", "mechanics.toml", "30s", "12s");
}

/// A heat with an expert's hand at its presets and taps: one digest in process, over TCP, and from its own recording.
#[test]
fn an_experts_heat_is_repeated_over_every_way() {
    let folder = tempfile::tempdir().expect("a folder");
    let record = folder.path().join("r");
    let digest = |source: &str, more: &[&str]| {
        let words = ["run", ".", "--until", "62min", "--format", "json", "--replay-operator", source];
        let said = typed(&scenario("arc-furnace"), &[&words, more].concat());
        let run: Value = serde_json::from_str(&said.out).unwrap_or_else(|_| panic!("{said:?}"));
        let tapped = run["expectations"].as_array().expect("expectations").iter();
        let hot = tapped.filter(|one| one["name"] == "steel is tapped hot enough").map(|one| one["verdict"].clone());
        assert_eq!(hot.collect::<Vec<Value>>(), ["met"], "{run}");
        run["digest"].as_str().expect("a digest").to_owned()
    };
    let whole = digest("experts/heat.jsonl", &["--record", utf8(&record)]);
    assert_eq!(digest("experts/heat.jsonl", &["--transport", "tcp"]), whole);
    assert_eq!(digest(utf8(&record.join("run-1")), &[]), whole);
    let automatic = typed(&scenario("arc-furnace"), &["run", ".", "--until", "62min", "--format", "json"]);
    assert!(!automatic.out.contains(&whole), "the expert does something");
}

/// A heat that somebody drives at the pulpit of the page, by rules. What was done is repeated from its recording, in one
/// process and over TCP, and from the recording of that.
#[test]
fn a_heat_at_the_page_is_repeated_over_every_way() {
    let folder = tempfile::tempdir().expect("a folder");
    let (taken, again) = (folder.path().join("taken"), folder.path().join("again"));
    let words = ["--until", "68min", "--pace", "400", "--record", utf8(&taken)];
    let served = Served::begin("arc-furnace", &words);
    let mut person = Sitter::at(&served.address, "pulpit", &LOOKED_AT);
    drive_a_heat(&mut person);
    let report = served.report();
    assert_eq!(report["status"], "completed", "{report}");

    let events = fs::read_to_string(taken.join("run-1/events.jsonl")).expect("events");
    assert_eq!(events.matches(r#""event":"operator""#).count(), person.written, "{events}");
    let repeated = |source: &Path, more: &[&str]| {
        let words = ["run", ".", "--until", "68min", "--format", "json", "--replay-operator", utf8(source)];
        let said = typed(&scenario("arc-furnace"), &[&words, more].concat());
        let run: Value = serde_json::from_str(&said.out).unwrap_or_else(|_| panic!("{said:?}"));
        let hot = run["expectations"].as_array().expect("expectations").iter();
        assert!(hot.clone().any(|one| one["name"] == "steel is tapped hot enough" && one["verdict"] == "met"), "{run}");
        run["digest"].clone()
    };
    let digest = &report["digest"];
    assert_eq!(repeated(&taken, &["--record", utf8(&again)]), *digest, "in process");
    assert_eq!(repeated(&taken, &["--transport", "tcp"]), *digest, "over TCP");
    assert_eq!(repeated(&again, &[]), *digest, "from the recording of the repetition");
}

/// What a person at the pulpit looks at.
const LOOKED_AT: [&str; 8] = [
    "Heat_step",
    "Heats",
    "Scrap",
    "Bath_temperature",
    "Tilt_angle",
    "Electrode_automatic",
    "Page",
    "Tapping_temperature",
];

/// A heat, from the empty furnace to the tap.
fn drive_a_heat(person: &mut Sitter) {
    let at_step = |step: f64| move |person: &Sitter| person.value("Heat_step") >= step;
    person.write("Tapping_temperature", 1640.0);
    person.write("Carbon_limit", 0.24);
    // less voltage while the electrodes bore down
    person.until(at_step(6.0));
    person.write("Tap_selector", 3.0);
    person.until(at_step(7.0));
    person.write("Tap_selector", 0.0);
    for page in [1.0, 2.0, 3.0, 0.0] {
        person.write("Page", page);
        person.until(|person| person.value("Page") == page);
    }
    // the second charge, and the flat bath
    person.until(|person| person.value("Heat_step") < 7.0);
    person.until(at_step(7.0));
    person.write("Tap_selector", 5.0);
    person.until(|person| person.value("Scrap") < 15e3);
    person.write("Tap_selector", 0.0);
    person.until(at_step(8.0));
    // electrodes by hand for a moment: they stay where they are
    person.write("Electrode_automatic", 0.0);
    person.until(|person| person.value("Electrode_automatic") == 0.0);
    person.write("Electrode_automatic", 1.0);
    person.until(|person| person.value("Bath_temperature") > 1550.0);
    person.write("Tap_selector", 4.0);
    person.until(|person| person.value("Bath_temperature") > 1600.0);
    person.write("Tap_selector", 0.0);
    person.write("Acknowledge", 1.0);
    person.write("Acknowledge", 0.0);
    // no further heat behind this one
    person.until(|person| person.value("Tilt_angle") > 15.0);
    person.write("Heat_start", 0.0);
    person.until(|person| person.value("Heats") >= 1.0);
    person.write("Carbon_limit", 0.25);
    person.write("Tapping_temperature", 1625.0);
    person.until(|person| person.value("Tapping_temperature") == 1625.0);
}

/// The paper's checks of consistency (a feedback within 100 ms) hold in lockstep, and fail where plant and PLC meet ten times a
/// second.
#[test]
fn checks_of_consistency_fail_without_lockstep_alone() {
    let words = ["compare", ".", "--case", "feedback", "--until", "6s", "--runs", "1", "--count", "Regulation_fault"];
    let mut seen = Vec::new();
    // When plant and PLC meet is the wall clock's affair: it is tried until it is seen.
    for _ in 0..ROUNDS {
        let said = typed(&scenario("arc-furnace"), &[&words[..], &["--format", "json"]].concat());
        assert_eq!(said.code, Some(0), "{said:?}");
        let rows: Vec<Value> = said.out.lines().map(|line| serde_json::from_str(line).expect("JSON lines")).collect();
        let counted = |mode: &str| {
            let of = rows.iter().filter(|row| row["mode"] == mode);
            of.map(|row| row["counted"].as_f64().expect("a number")).collect::<Vec<f64>>()
        };
        assert_eq!(counted("lockstep"), [0.0]);
        if counted("follow").into_iter().all(|times| times > 0.0) {
            return;
        }
        seen.push(said);
    }
    panic!("{seen:?}");
}
