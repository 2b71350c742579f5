//! What an operator did on the page as a case: shown, written where the run allows it, and run again to the digest.

use serde_json::{Value, json};

use crate::typed::{begun, copied_shear, typed};
use crate::web::{Served, ask, received};

/// A held session of a shear of its own, in which a sensor is forced for a while; its viewer at the end.
fn operated(folder: &std::path::Path, more: &[&str]) -> (Served, tungstenite::WebSocket<std::net::TcpStream>) {
    let words =
        [&["run", ".", "--format", "json", "--web", "--await-viewer", "--stay", "--until", "3s"], more].concat();
    let served = Served::of(begun(folder, &words));
    let mut viewer = served.view();
    let (_, session) = served.get("/api/session", &[]);
    let session: Value = serde_json::from_str(&session).expect("JSON");
    let names = session["signals"].as_array().expect("signals");
    let sensor = names.iter().position(|signal| signal["name"] == "Sensor_1").expect("a sensor");
    let until_at = |viewer: &mut _, end_ns: u64| {
        while received(viewer, "status")["past_ns"][1].as_u64().is_none_or(|now_ns| now_ns < end_ns) {}
    };
    until_at(&mut viewer, 500_000_000);
    ask(&mut viewer, &json!({"type": "force", "signal": sensor, "value": "FALSE"}));
    until_at(&mut viewer, 1_500_000_000);
    ask(&mut viewer, &json!({"type": "force", "signal": sensor, "value": null}));
    while received(&mut viewer, "status")["state"] != "end" {}
    (served, viewer)
}

#[test]
fn what_an_operator_did_is_a_case_with_the_digest_of_the_session() {
    let shear = copied_shear();
    let path = shear.path().join("cases.toml");
    let before = std::fs::read_to_string(&path).expect("a file");
    let (served, mut viewer) = operated(shear.path(), &["--save-cases"]);
    let keep =
        |viewer: &mut _, name: &str, save: bool| ask(viewer, &json!({"type": "case", "name": name, "save": save}));

    // What it would be, and a name that there is.
    keep(&mut viewer, "by-hand", false);
    let shown = received(&mut viewer, "case");
    assert_eq!((&shown["saved"], &shown["may_save"]), (&json!(false), &json!(true)));
    let text = shown["text"].as_str().expect("a text");
    assert!(text.starts_with("[[case]]\nname = \"by-hand\"\nuntil = \"3000ms\"\nforce = [\n"), "{text}");
    assert_eq!(std::fs::read_to_string(&path).expect("a file"), before, "nothing is written yet");
    keep(&mut viewer, "sensor-lost", false);
    let message = received(&mut viewer, "error")["message"].clone();
    assert!(
        message.as_str().is_some_and(|message| message.contains("two cases are called `sensor-lost`")),
        "{message}"
    );

    keep(&mut viewer, "by-hand", true);
    assert_eq!(received(&mut viewer, "case")["saved"], true);
    assert_eq!(std::fs::read_to_string(&path).expect("a file"), format!("{}\n\n{text}", before.trim_end()));
    ask(&mut viewer, &json!({"type": "operate", "operation": "stop"}));
    let live = served.report();
    let digest = |words: &[&str]| {
        let said = typed(shear.path(), &[&["run", ".", "--format", "json"], words].concat());
        let report: Value = serde_json::from_str(&said.out).unwrap_or_else(|_| panic!("{said:?}"));
        report["digest"].clone()
    };
    assert_eq!(digest(&["--case", "by-hand"]), live["digest"], "{text}");
    assert_ne!(digest(&["--until", "3s"]), live["digest"], "what the operator did made a difference");
}

#[test]
fn nothing_is_written_where_the_run_does_not_allow_it() {
    let shear = copied_shear();
    let path = shear.path().join("cases.toml");
    let before = std::fs::read_to_string(&path).expect("a file");
    let (served, mut viewer) = operated(shear.path(), &[]);
    ask(&mut viewer, &json!({"type": "case", "name": "by-hand", "save": false}));
    assert_eq!(received(&mut viewer, "case")["may_save"], false);
    ask(&mut viewer, &json!({"type": "case", "name": "by-hand", "save": true}));
    let message = received(&mut viewer, "error")["message"].clone();
    assert!(message.as_str().is_some_and(|message| message.contains("begin it with `--save-cases`")), "{message}");
    assert_eq!(std::fs::read_to_string(&path).expect("a file"), before);
    ask(&mut viewer, &json!({"type": "operate", "operation": "stop"}));
    served.report();
}
