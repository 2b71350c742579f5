//! Kinds of component of the user's own: function blocks and assemblies, from files beside the scene.

use onescan_base::regular::Within;
use onescan_plant::scene::Override;
use onescan_plant::scene::own::listing;
use onescan_plant::{Plant, Scene, SceneError};
use onescan_server::client::Client;
use onescan_server::signal::ClientName;
use onescan_server::time::TimeSpan;

use crate::bench::{Bench, PERIOD};

/// The heater of the library as a function block: its equation by Euler's rule.
const OVEN: &str = "(* Heater with a thermal mass, by Euler's rule. *)
FUNCTION_BLOCK oven
VAR_INPUT
    on : BOOL; // contactor
    heat_w : LREAL; // heat from elsewhere
    fail_burnt : BOOL; // the element is burnt: no power
    dt_s : LREAL;
END_VAR
VAR CONSTANT
    heating_w : LREAL := 2000.0; // power of the element
    capacity_j_k : LREAL := 5000.0; // heat capacity
    loss_w_k : LREAL := 10.0; // loss to the surroundings
    ambient_degc : LREAL := 20.0; // temperature of the surroundings
    unseen : LREAL := 1.0;
END_VAR
VAR_OUTPUT
    temperature_degc : LREAL := ambient_degc; // of what is heated
    hot : BOOL; // for three seconds above 25 °C
    turns : DINT;
END_VAR
VAR
    flow_w : LREAL;
    since : TON;
END_VAR
flow_w := heat_w - loss_w_k * (temperature_degc - ambient_degc) * unseen;
IF on AND NOT fail_burnt THEN
    flow_w := flow_w + heating_w;
END_IF;
temperature_degc := temperature_degc + flow_w / capacity_j_k * dt_s;
since(IN := temperature_degc > 25.0, PT := T#3s);
hot := since.Q;
turns := turns + 1;
END_FUNCTION_BLOCK
";

const OVENS: &str = r#"
version = 1
libraries = ["kinds"]

[[component]]
name = "reference"
kind = "heater"
capacity_j_k = 2500.0
on_signal = "On"
temperature_degc_signal = "Reference"

[[component]]
name = "own"
kind = "oven"
capacity_j_k = 2500.0
on_signal = "On"
temperature_degc_signal = "Own"
hot_signal = "Hot"
turns_signal = "Turns"

[[component]]
name = "seen"
kind = "temperature_sensor"
temperature_degc_from = "own.temperature_degc"
measured_degc_signal = "Seen"

[[failure]]
component = "own"
mode = "burnt"
signal = "Burn"
"#;

/// A press: a table, a plate on a joint, its cylinder, a switch at its end.
const PRESS: &str = r#"
version = 1
summary = "press: a plate that a pneumatic cylinder moves, with a switch at its end"

[[parameter]]
key = "stroke_m"
about = "way of the plate"
preset = 0.2
least = 0.05
most = 1.0

[[parameter]]
key = "valve"
about = "its valve"
preset = "5/2"
choice = ["5/2", "5/3-closed"]

[[binding]]
key = "base"
about = "body that carries it"
preset = "ground"

[[input]]
key = "close"
about = "moves the plate out"
to = ["cylinder.extend"]

[[output]]
key = "position_m"
about = "of the plate"
from = "cylinder.position_m"

[[output]]
key = "closed"
about = "the plate is at its end"
from = "end.contact"

[[failure_mode]]
mode = "stuck"
about = "the plate does not move"
of = "cylinder.jammed"

[[body]]
name = "plate"
kind = "dynamic"
shape = "box"
size_m = [0.1, 0.1, "=stroke_m / 10"]
mass_kg = 2.0
position_m = [0.0, 0.0, 1.0]

[[joint]]
name = "guide"
kind = "prismatic"
parent = "=base"
child = "plate"
axis = [1, 0, 0]
lower_m = 0.0
upper_m = "=stroke_m"

[[component]]
name = "cylinder"
kind = "pneumatic_cylinder"
joint = "guide"
stroke_m = "=stroke_m"
valve = "=valve"

[[component]]
name = "end"
kind = "limit_switch"
joint = "guide"
from = "=0.9 * stroke_m"
to = "=stroke_m"
"#;

/// A folder with a scene and kinds.
fn folder(scene: &str, kinds: &[(&str, &str)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::create_dir(folder.path().join("kinds")).expect("a folder");
    for (name, text) in kinds {
        std::fs::write(folder.path().join("kinds").join(name), text).expect("written");
    }
    std::fs::write(folder.path().join("plant.toml"), scene).expect("written");
    folder
}

fn plant(scene: &str, kinds: &[(&str, &str)], period: TimeSpan) -> Result<Plant, SceneError> {
    let folder = folder(scene, kinds);
    Plant::load(&folder.path().join("plant.toml"), ClientName::new("plant").expect("a name"), period)
}

fn bench(scene: &str, kinds: &[(&str, &str)], period: TimeSpan) -> Bench {
    Bench::of(plant(scene, kinds, period).unwrap_or_else(|error| panic!("{error}")), period)
}

/// What is wrong, without the folder of the test.
fn refused(scene: &str, kinds: &[(&str, &str)]) -> String {
    let folder = folder(scene, kinds);
    let path = folder.path().join("plant.toml");
    let error = Plant::load(&path, ClientName::new("plant").expect("a name"), PERIOD).err().expect("refused");
    error.to_string().replace(&format!("{}/", folder.path().display()), "")
}

/// Greatest distance between the block and the library's heater over 200 s, on for the first half.
fn greatest_error_k(period_ms: u64) -> f64 {
    let period = TimeSpan::from_millis(period_ms).expect("not zero");
    let mut bench = bench(OVENS, &[("oven.st", OVEN)], period);
    let turns = 200_000 / period_ms;
    let mut greatest: f64 = 0.0;
    for turn in 0..turns {
        bench.command("On", turn < turns / 2);
        bench.turn();
        greatest = greatest.max((bench.read::<f64>("Own") - bench.read::<f64>("Reference")).abs());
    }
    greatest
}

#[test]
fn a_block_agrees_with_the_library_within_the_error_of_integration() {
    let errors = [100, 50, 25].map(greatest_error_k);
    // Euler's rule on a lag of T = 250 s by 200 K: 200 K dt / (2 e T) where it is greatest, of first order in dt
    let bound_k = |dt_s: f64| 1.001 * 200.0 * dt_s / (2.0 * std::f64::consts::E * 250.0);
    for (error, dt_s) in errors.into_iter().zip([0.1, 0.05, 0.025]) {
        assert!(error < bound_k(dt_s) && error > 0.5 * bound_k(dt_s), "{error} K at {dt_s} s");
    }
    assert!((errors[0] / errors[1] - 2.0).abs() < 0.01 && (errors[1] / errors[2] - 2.0).abs() < 0.01, "{errors:?}");
}

#[test]
fn a_block_has_timers_presets_wires_and_failures() {
    let mut bench = bench(OVENS, &[("oven.st", OVEN)], PERIOD);
    assert_eq!(bench.read::<f64>("Own"), 20.0, "outputs begin with their initial values");
    bench.command("On", true);
    let mut above = None;
    while !bench.read::<bool>("Hot") {
        bench.turn();
        above = above.or((bench.read::<f64>("Own") > 25.0).then_some(bench.t_v));
    }
    let above = above.expect("above 25 °C before");
    assert_eq!(bench.t_v.as_nanos() - above.as_nanos(), 3_000_000_000, "the timer runs on virtual time");
    assert_eq!(u64::from(bench.read::<i32>("Turns").unsigned_abs()), bench.t_v.as_nanos() / 10_000_000);
    for _ in 0..1000 {
        bench.turn();
    }
    let seen = bench.read::<f64>("Seen");
    assert!(seen > 21.0 && seen < bench.read::<f64>("Own"), "a wire takes its output: {seen}");
    bench.command("Burn", true);
    let hottest = bench.read::<f64>("Own");
    bench.turn();
    assert!(bench.read::<f64>("Own") < hottest, "burnt");
}

#[test]
fn a_block_goes_on_from_a_state_and_refuses_that_of_another() {
    let mut whole = bench(OVENS, &[("oven.st", OVEN)], PERIOD);
    whole.command("On", true);
    (0..500).for_each(|_| whole.turn());
    let saved = whole.plant.save().expect("a state");
    let mut other = bench(OVENS, &[("oven.st", OVEN)], PERIOD);
    other.plant.restore(&saved).expect("the same plant");
    (other.t_v, other.inputs) = (whole.t_v, whole.inputs.clone());
    for _ in 0..500 {
        whole.turn();
        other.turn();
        assert_eq!(whole.outputs, other.outputs);
    }
    let changed = OVEN.replace("> 25.0", "> 26.0");
    let mut changed = bench(OVENS, &[("oven.st", &changed)], PERIOD);
    let error = changed.plant.restore(&saved).expect_err("another program").to_string();
    assert!(error.contains("another `code` at component `own`"), "{error}");
}

#[test]
fn a_block_that_fails_is_named_with_its_line() {
    let broken = OVEN
        .replace("turns := turns + 1;", "turns := 100 / (turns - 7) + 8;")
        .replace("turns : DINT;", "turns : DINT := 7;");
    let mut bench = bench(OVENS, &[("oven.st", &broken)], PERIOD);
    let fault = bench.try_turn().expect_err("a division by zero");
    insta::assert_snapshot!(fault.to_string(), @"component `own`: division by zero in oven at kinds/oven.st:32:10");
    let endless = OVEN.replace("turns := turns + 1;", "WHILE TRUE DO turns := turns + 1; END_WHILE;");
    let mut endless = self::bench(OVENS, &[("oven.st", &endless)], PERIOD);
    insta::assert_snapshot!(endless.try_turn().expect_err("an endless loop").to_string(), @"component `own`: endless or very long loop in oven at kinds/oven.st:32:1");
    let infinite = OVEN.replace("/ capacity_j_k", "/ 1.0E-308 * 1.0E308");
    let mut infinite = self::bench(OVENS, &[("oven.st", &infinite)], PERIOD);
    infinite.command("On", true);
    insta::assert_snapshot!(infinite.try_turn().expect_err("no number").to_string(), @"component `own`: its output `temperature_degc` is inf, which is not finite");
}

/// Two presses, one moved, wired to each other and to signals; and the same written out.
fn presses() -> [String; 2] {
    let named = r#"
version = 1
libraries = ["kinds"]

[[body]]
name = "table"
kind = "fixed"
shape = "box"
size_m = [2.0, 1.0, 0.1]

[[component]]
name = "first"
kind = "press"
close_signal = "Close"
position_m_signal = "First"
closed_signal = "First_Closed"

[[component]]
name = "second"
kind = "press"
position_m = [0.0, 0.5, 0.25]
base = "table"
stroke_m = 0.3
valve = "5/3-closed"
close_from = "first.closed"
position_m_signal = "Second"
closed_signal = "Second_Closed"

[[component]]
name = "lamp"
kind = "lamp"
on_from = "second.closed"
lit_signal = "Lamp"

[[failure]]
component = "first"
mode = "stuck"
signal = "Stick"
"#;
    let press = |name: &str, y: f64, z: f64, base: &str, stroke: f64, valve: &str, close: &str| {
        let thickness = stroke / 10.0;
        let end = 0.9 * stroke;
        [
            format!(
                "[[body]]\nname = \"{name}.plate\"\nkind = \"dynamic\"\nshape = \"box\"\nmass_kg = 2.0\n\
                 size_m = [0.1, 0.1, {thickness:?}]\nposition_m = [0.0, {y:?}, {z:?}]\n\
                 [[joint]]\nname = \"{name}.guide\"\nkind = \"prismatic\"\nparent = \"{base}\"\n\
                 child = \"{name}.plate\"\naxis = [1, 0, 0]\nlower_m = 0.0\nupper_m = {stroke:?}\n"
            ),
            format!(
                "[[component]]\nname = \"{name}.cylinder\"\nkind = \"pneumatic_cylinder\"\njoint = \"{name}.guide\"\n\
                 stroke_m = {stroke:?}\nvalve = \"{valve}\"\n{close}\nposition_m_signal = \"{}\"\n\
                 [[component]]\nname = \"{name}.end\"\nkind = \"limit_switch\"\njoint = \"{name}.guide\"\n\
                 from = {end:?}\nto = {stroke:?}\ncontact_signal = \"{}_Closed\"\n",
                if name == "first" { "First" } else { "Second" },
                if name == "first" { "First" } else { "Second" },
            ),
        ]
    };
    let [bodies, parts] = press("first", 0.0, 1.0, "ground", 0.2, "5/2", "extend_signal = \"Close\"");
    let [more, others] = press("second", 0.5, 1.25, "table", 0.3, "5/3-closed", "extend_from = \"first.end.contact\"");
    let written = format!(
        "version = 1\n[[body]]\nname = \"table\"\nkind = \"fixed\"\nshape = \"box\"\nsize_m = [2.0, 1.0, 0.1]\n\
         {bodies}{more}{parts}{others}\
         [[component]]\nname = \"lamp\"\nkind = \"lamp\"\non_from = \"second.end.contact\"\nlit_signal = \"Lamp\"\n\
         [[failure]]\ncomponent = \"first.cylinder\"\nmode = \"jammed\"\nsignal = \"Stick\"\n"
    );
    [named.to_owned(), written]
}

#[test]
fn an_assembly_is_its_parts_to_the_bit() {
    let [named, written] = presses();
    let mut assembled = bench(&named, &[("press.toml", PRESS)], PERIOD);
    let mut plain = bench(&written, &[], PERIOD);
    assert_eq!(assembled.plant.join(), plain.plant.join());
    let mut closed = 0;
    for turn in 0..600 {
        for bench in [&mut assembled, &mut plain] {
            bench.command("Close", turn % 300 < 200);
            bench.command("Stick", (320..350).contains(&turn));
            bench.turn();
        }
        assert_eq!(assembled.outputs, plain.outputs, "turn {turn}");
        closed += u32::from(assembled.read::<bool>("Second_Closed"));
    }
    assert!(closed > 50, "the second press closes behind the first: {closed} turns");
}

#[test]
fn an_assembly_is_turned_with_its_parts() {
    let scene = |place: &str| {
        format!(
            "version = 1\nlibraries = [\"kinds\"]\n[[component]]\nname = \"press\"\nkind = \"press\"\n{place}\n\
             close_signal = \"Close\"\nposition_m_signal = \"Way\"\n"
        )
    };
    let plate = |place: &str| {
        let mut bench = bench(&scene(place), &[("press.toml", PRESS)], PERIOD);
        bench.command("Close", true);
        (0..200).for_each(|_| bench.turn());
        let pose = bench.plant.poses().find(|pose| pose.name == "press.plate").expect("a body");
        (pose.position_m, bench.read::<f64>("Way"))
    };
    let ([x, y, z], way_m) = plate("");
    assert!((x - way_m).abs() < 1e-6 && way_m > 0.19 && y.abs() < 1e-6 && (z - 1.0).abs() < 1e-6);
    let ([x, y, z], turned_m) = plate("position_m = [3.0, 0.0, 0.0]\nrpy_deg = [0.0, 0.0, 90.0]");
    assert!((x - 3.0).abs() < 1e-6 && (y - turned_m).abs() < 1e-6 && (z - 1.0).abs() < 1e-6, "{x} {y} {z}");
    assert!((turned_m - way_m).abs() < 1e-6);
}

#[test]
fn assemblies_are_in_arrays_and_in_each_other() {
    let pair = "version = 1\nsummary = \"two presses\"\n\
        [[parameter]]\nkey = \"apart_m\"\nabout = \"how far\"\npreset = 1.0\n\
        [[input]]\nkey = \"close\"\nabout = \"both\"\nto = [\"one[0].close\", \"one[1].close\"]\n\
        [[output]]\nkey = \"closed\"\nabout = \"the second\"\nfrom = \"one[1].closed\"\n\
        [[failure_mode]]\nmode = \"stuck\"\nabout = \"the second\"\nof = \"one[1].stuck\"\n\
        [[component]]\nname = \"one[0]\"\nkind = \"press\"\n\
        [[component]]\nname = \"one[1]\"\nkind = \"press\"\nposition_m = [0.0, \"=apart_m\", 0.0]\n";
    let scene = "version = 1\nlibraries = [\"kinds\"]\n\
        [[component]]\nname = \"pair[0..2]\"\nkind = \"pair\"\nstep_m = [2.0, 0.0, 0.0]\nclose_signal = \"Close[i]\"\n\
        closed_signal = \"Closed[i]\"\n\
        [[failure]]\ncomponent = \"pair[1]\"\nmode = \"stuck\"\nfrom_s = 0\n";
    let kinds = [("press.toml", PRESS), ("pair.toml", pair)];
    let mut bench = bench(scene, &kinds, PERIOD);
    for pair in 0..3 {
        bench.command(&format!("Close[{pair}]"), true);
    }
    (0..200).for_each(|_| bench.turn());
    let closed: Vec<bool> = (0..3).map(|pair| bench.read(&format!("Closed[{pair}]"))).collect();
    assert_eq!(closed, [true, false, true], "the second press of the second pair is stuck");
    let poses: Vec<_> = bench.plant.poses().filter(|pose| pose.name.ends_with("one[1].plate")).collect();
    assert!(poses.len() == 3 && poses.iter().all(|pose| (pose.position_m[1] - 1.0).abs() < 1e-6));
    let apart: Vec<f64> = poses.iter().map(|pose| pose.position_m[0].round()).collect();
    assert_eq!(apart, [0.0, 2.0, 4.0]);
}

#[test]
fn a_case_sets_the_parameters_of_a_component() {
    let [named, _] = presses();
    let folder = folder(&named, &[("press.toml", PRESS), ("oven.st", OVEN)]);
    let path = folder.path().join("plant.toml").display().to_string();
    let with = |key: &str, value: toml::Value| {
        let overrides = [Override::new(key, &value)];
        Scene::parse_with(&named, &path, &overrides, &Within::anywhere())
    };
    let scene = with("first.stroke_m", 0.4.into()).expect("allowed");
    let stroke = scene.joints.iter().find(|joint| joint.name == "first.guide").and_then(|joint| joint.upper);
    assert_eq!(stroke, Some(0.4));
    let error = with("first.stroke_m", 4.0.into()).expect_err("too long");
    let fault = &error.faults()[0];
    assert_eq!(
        (fault.overridden, fault.kind.to_string().as_str()),
        (Some(0), "`stroke_m` must be a number from 0.05 to 1, not 4.0")
    );
    scene.check_failure("first", "stuck").expect("a mode of the assembly");
    scene.check_failure("first.cylinder", "jammed").expect("a mode of the part");
    let unknown = scene.check_failure("first", "stcuk").expect_err("unknown").to_string();
    assert_eq!(unknown, "component `first` has no failure mode `stcuk` (did you mean `stuck`?)");
}

#[test]
fn what_is_wrong_with_a_block_has_its_place() {
    let wrong = |from: &str, to: &str| refused(OVENS, &[("oven.st", &OVEN.replace(from, to))]);
    let found = [
        wrong("FUNCTION_BLOCK oven", "FUNCTION_BLOCK ovne"),
        wrong("flow_w : LREAL;", "flow_w : LRAEL;"),
        wrong("heat_w : LREAL; //", "heat_w : TIME; //"),
        wrong("fail_burnt : BOOL;", "fail_burnt : INT;"),
        wrong("VAR_OUTPUT", "VAR_IN_OUT x : REAL; END_VAR VAR_OUTPUT"),
        wrong("heat capacity", "heat capacity\n name : REAL; // of it"),
        refused(
            &OVENS.replace(
                "capacity_j_k = 2500.0\non_signal = \"On\"\ntemperature_degc_signal = \"Own\"",
                "capacity_k = 1.0",
            ),
            &[("oven.st", OVEN)],
        ),
        refused(&OVENS.replace("hot_signal", "unseen = 2.0\nhot_signal"), &[("oven.st", OVEN)]),
        refused(&OVENS.replace("\"oven\"", "\"ovn\""), &[("oven.st", OVEN)]),
        refused(OVENS, &[("oven.st", OVEN), ("oven.scl", OVEN)]),
        refused(OVENS, &[("oven.st", OVEN), ("heater.st", OVEN)]),
        refused(&OVENS.replace("\"kinds\"", "\"knids\""), &[("oven.st", OVEN)]),
        refused(OVENS, &[("oven.st", "")]),
    ];
    insta::assert_snapshot!(found.join("\n---\n"));
}

/// Each fault has a place in the file; the file is not kept as often.
#[test]
fn a_block_with_very_many_faults_names_the_first_ones() {
    let unknown: String = (0..10_000).map(|k| format!("x{k} := TRUE;\n")).collect();
    let wrong = OVEN.replace("END_FUNCTION_BLOCK\n", &format!("{unknown}END_FUNCTION_BLOCK\n"));
    let lines = refused(OVENS, &[("oven.st", &wrong)]);
    assert_eq!(lines.lines().count(), 50, "{}", &lines[..lines.len().min(2000)]);
    assert!(lines.starts_with("plant.toml:14:8: kind `oven`: kinds/oven.st line 33: "), "{}", &lines[..200]);
}

#[test]
fn what_is_wrong_with_an_assembly_has_its_place() {
    let [named, _] = presses();
    let wrong = |from: &str, to: &str| {
        assert!(PRESS.contains(from), "{from}");
        refused(&named, &[("press.toml", &PRESS.replacen(from, to, 1))])
    };
    let scene = |from: &str, to: &str| {
        assert!(named.contains(from), "{from}");
        refused(&named.replacen(from, to, 1), &[("press.toml", PRESS)])
    };
    let found = [
        wrong("child = \"plate\"", "child = \"palte\""),
        wrong("\"=stroke_m / 10\"", "\"=strok_m / 10\""),
        wrong("\"=stroke_m / 10\"", "\"=stroke_m / 0\""),
        wrong("[\"cylinder.extend\"]", "[\"cylinder.extnd\"]"),
        wrong("\"end.contact\"", "\"ned.contact\""),
        wrong("\"cylinder.jammed\"", "\"cylinder.jmamed\""),
        wrong("kind = \"limit_switch\"", "kind = \"limt_switch\""),
        wrong("mass_kg = 2.0", "masskg = 2.0"),
        wrong("preset = 0.2", "preset = 2.0"),
        wrong("key = \"closed\"", "key = \"close\""),
        wrong("version = 1", "version = 2"),
        wrong("summary = ", "sumary = "),
        wrong("valve = \"=valve\"", "valve = \"=valve\"\nposition_m_signal = \"X\""),
        wrong("[[body]]", "[[sensor]]\nname = \"s\"\n[[body]]"),
        wrong("kind = \"limit_switch\"", "kind = \"press\""),
        wrong("[[body]]", "[[body]"),
        scene("stroke_m = 0.3", "stroke_m = 3.0"),
        scene("stroke_m = 0.3", "strok_m = 0.3"),
        scene("base = \"table\"", "base = \"tabel\""),
        scene("base = \"table\"", "base = 3"),
        scene("first.closed", "first.clsoed"),
        scene("mode = \"stuck\"", "mode = \"stcuk\""),
        scene("close_from = ", "close = true\nclose_from = "),
        scene("position_m = [0.0, 0.5, 0.25]", "position_m = [0.0, 0.5]"),
    ];
    insta::assert_snapshot!(found.join("\n---\n"));
}

#[test]
fn a_folder_of_kinds_is_listed() {
    let wrong = PRESS.replace("cylinder.extend", "cylinder.extnd");
    let folder = folder("", &[("press.toml", PRESS), ("oven.st", OVEN), ("wrong.toml", &wrong), ("notes.txt", "")]);
    let listing = listing::read(&folder.path().join("kinds"), &Within::anywhere()).expect("a folder");
    let pages: Vec<String> = listing.kinds.iter().map(listing::OwnKind::page).collect();
    let faults: Vec<String> = listing.faults.iter().map(ToString::to_string).collect();
    let all = format!("{}\n{}", pages.join("\n"), faults.join("\n"));
    insta::assert_snapshot!(all.replace(&format!("{}/", folder.path().display()), ""));
}
