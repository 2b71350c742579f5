//! What the page and `onescan shot` draw: looks, drawings of a PLC's bodies, a picture without a window.

use std::process::Command;

use serde_json::{Value, json};

use crate::typed::{copied_shear, edit, onescan, scenario, typed};
use crate::web::{Served, ask, received};

fn session(served: &Served) -> Value {
    serde_json::from_str(&served.get("/api/session", &[]).1).expect("JSON")
}

fn place(of: &Value, name: &str) -> usize {
    of.as_array().expect("a list").iter().position(|one| one["name"] == name).expect("it is there")
}

/// Figures, views and looks are in the structure; which looks are on comes with the pictures, and leaves no trace.
#[test]
fn looks_are_on_while_their_condition_holds() {
    let served = Served::begin("filling-machine", &["--until", "1h", "--pace", "1"]);
    let session = session(&served);
    let views: Vec<&Value> = session["views"].as_array().expect("views").iter().map(|view| &view["name"]).collect();
    assert_eq!(views, ["front", "transfer", "above"]);
    let (bodies, looks) = (&session["bodies"], session["looks"].as_array().expect("looks"));
    let arm = place(bodies, "small_wheel/sw_arm[0]");
    let holding = looks.iter().position(|look| look["when"] == "SW_ARM[0].OUT_HOLD_CONTAINER").expect("a look");
    assert_eq!((&looks[holding]["bodies"], &looks[holding]["colour"]), (&json!([arm]), &json!("green")));
    let mut viewer = served.view();
    let active = received(&mut viewer, "looks");
    assert!(active["active"].as_array().is_some_and(|active| active.iter().all(|one| one.as_u64().is_some())));
    // Where there is a trainer's panel, who sits there calls views.
    ask(&mut viewer, &json!({"type": "view", "view": "above"}));
    assert!(
        received(&mut viewer, "error")["message"].as_str().is_some_and(|message| message.contains("seat of a trainer"))
    );
    ask(&mut viewer, &json!({"type": "seat", "panel": "monitor", "take": true}));
    while received(&mut viewer, "status")["seat"]["monitor"] != "mine" {}
    ask(&mut viewer, &json!({"type": "view", "view": "above"}));
    assert_eq!(received(&mut viewer, "view")["view"], "above");
    ask(&mut viewer, &json!({"type": "view", "view": "nowhere"}));
    assert!(received(&mut viewer, "error")["message"].as_str().is_some_and(|message| message.contains("no view")));
    ask(&mut viewer, &json!({"type": "operate", "operation": "stop"}));
    let report = served.report();
    let until = format!("{}ns", report["virtual_time_ns"]);
    let plain = typed(&scenario("filling-machine"), &["run", ".", "--format", "json", "--until", &until]);
    let plain: Value = serde_json::from_str(&plain.out).expect("a report");
    assert_eq!(report["digest"], plain["digest"]);
}

/// A figure is moved by signals alone, in the frame of what it is on.
#[test]
fn figures_are_behind_the_bodies() {
    let served = Served::begin("arc-furnace", &["--until", "1s"]);
    let session = session(&served);
    let bodies = session["bodies"].as_array().expect("bodies");
    let (mast, roof) = (place(&session["bodies"], "mast[2]"), place(&session["bodies"], "roof"));
    assert_eq!((&bodies[mast]["kind"], &bodies[mast]["on"]), (&json!("figure"), &json!(roof)));
    let signal = place(&session["signals"], "Mast[2]");
    let moves = |look: &&Value| look["follows"] == signal && look["bodies"] == json!([mast]);
    let look = session["looks"].as_array().expect("looks").iter().find(moves).expect("a look");
    assert_eq!(look["move_m"], json!([0.0, 0.0, 1.0]));
    served.report();
}

/// A look that is wrong is reported at its line, before anything runs.
#[test]
fn a_look_that_is_wrong_is_reported_with_its_place() {
    let folder = copied_shear();
    let file = std::fs::read_to_string(folder.path().join("scenario.toml")).expect("a scenario");
    let wrong = format!("{file}\n[[look]]\nbodies = [\"blade\"]\nwhen = \"Positon > 1\"\ncolour = \"red\"\n");
    std::fs::write(folder.path().join("scenario.toml"), wrong).expect("written");
    let said = typed(folder.path(), &["run", "."]);
    assert!(said.code == Some(2) && said.err.contains("Positon") && said.err.contains("scenario.toml"), "{said:?}");
    edit(folder.path(), "scenario.toml", "when = \"Positon > 1\"\n", "");
    edit(folder.path(), "scenario.toml", "bodies = [\"blade\"]", "bodies = [\"no_such_body\"]");
    let said = typed(folder.path(), &["run", ".", "--web", "--until", "1s"]);
    assert!(said.code == Some(2) && said.err.contains("no_such_body"), "{said:?}");
}

/// The ladder of the shear is there with every contact, and its states are those of its variables.
#[test]
fn a_ladder_is_drawn_with_the_values_of_its_variables() {
    let served = Served::begin("shear/ladder.toml", &["--until", "1h", "--pace", "1"]);
    let session = session(&served);
    let drawings = session["drawings"].as_array().expect("drawings");
    let number = drawings.iter().position(|drawing| drawing["unit"] == "LowLevel").expect("the ladder");
    let ladder = &drawings[number];
    assert_eq!(ladder["language"], "ladder");
    let contacts = ladder["elements"].as_array().expect("elements").iter().filter(|one| one["kind"] == "contact");
    assert!(contacts.count() >= 3);
    assert!(!ladder["instances"].as_array().expect("instances").is_empty());
    let mut viewer = served.view();
    ask(&mut viewer, &json!({"type": "draw", "drawing": number, "instance": 0}));
    let paths = ladder["states"].as_array().expect("states");
    let up = paths.iter().position(|path| path == "ixUp").expect("a state");
    // the first view may be older than the question, and know no values
    let states = loop {
        let states = received(&mut viewer, "states");
        assert_eq!(states["values"].as_array().map(Vec::len), Some(paths.len()));
        if !states["values"][up].is_null() {
            break states;
        }
    };
    assert!(states["values"][up] == 0.0 || states["values"][up] == 1.0, "{states}");
    ask(&mut viewer, &json!({"type": "draw", "drawing": 99, "instance": 0}));
    assert!(received(&mut viewer, "error")["message"].as_str().is_some_and(|message| message.contains("no drawing")));
    ask(&mut viewer, &json!({"type": "operate", "operation": "stop"}));
    served.report();
}

fn shot(words: &[&str], chromium: Option<&str>) -> (Option<i32>, String) {
    let mut command: Command = onescan(&scenario("filling-machine"));
    command.arg("shot").args(words);
    if let Some(chromium) = chromium {
        command.env("CHROMIUM", chromium);
    }
    let output = command.output().expect("it runs");
    (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
}

#[test]
fn a_picture_without_a_browser_says_how_to_get_one() {
    let (code, said) = shot(&[".", "-o", "nothing.png"], Some("/nowhere/chromium"));
    assert!(
        code == Some(2) && said.contains("no browser `/nowhere/chromium`") && said.contains("install it"),
        "{said}"
    );
    let (code, said) = shot(&[".", "--view", "fromt", "-o", "nothing.png"], None);
    assert!(code == Some(2) && said.contains("no view `fromt`") && said.contains("front"), "{said}");
    let (code, said) = shot(&[".", "--film", "--until", "10ms", "-o", "nothing.webp"], None);
    assert!(code == Some(2) && said.contains("has no second picture") && said.contains("later `--until`"), "{said}");
    let (code, said) = shot(&[".", "--film", "-o", "nothing.webp"], None);
    assert!(code == Some(2) && said.contains("--until"), "{said}");
    let (code, said) = shot(&[".", "--size", "1280", "-o", "nothing.png"], None);
    assert!(code == Some(2) && said.contains("1280x720"), "{said}");
}
