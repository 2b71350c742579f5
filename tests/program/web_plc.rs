//! The PLC online on the page, and what becomes of expectations while a session runs.

use serde_json::{Value, json};

use crate::typed::{scenario, typed};
use crate::web::{Served, ask, received};

/// The number of a variable on the page.
fn variable(session: &Value, path: &str) -> usize {
    let variables = session["plcs"][0]["variables"].as_array().expect("a list");
    variables.iter().position(|one| one["path"] == path).unwrap_or_else(|| panic!("no variable {path}"))
}

#[test]
fn variables_are_watched_and_forced_and_what_was_done_is_repeated() {
    let folder = tempfile::tempdir().expect("a folder");
    let live = folder.path().join("live");
    let live = live.to_str().expect("UTF-8");
    let covered = folder.path().join("covered.info");
    let covered = covered.to_str().expect("UTF-8");
    let served = Served::begin("shear", &["--until", "1h", "--pace", "5", "--record", live, "--coverage", covered]);
    let session: Value = serde_json::from_str(&served.get("/api/session", &[]).1).expect("JSON");
    let strokes = variable(&session, "Shear.Strokes");
    let beside = session["sources"][0]["lines"].as_array().expect("lines");
    assert!(beside.iter().any(|line| line["inner"].as_array().is_some_and(|inner| inner.contains(&json!(strokes)))));
    let mut viewer = served.view();
    ask(&mut viewer, &json!({"type": "watch", "variables": [strokes]}));
    let seen = received(&mut viewer, "variables");
    assert_eq!((&seen["values"][0][0], &seen["forced"]), (&json!(strokes), &json!([])));
    assert!(seen["executed"].as_array().is_some_and(|lines| !lines.is_empty()), "coverage is noted: {seen}");
    let force =
        |action: &str, value: &str| json!({"type": "variable", "variable": strokes, "action": action, "value": value});
    ask(&mut viewer, &force("force", "77"));
    loop {
        let seen = received(&mut viewer, "variables");
        if seen["forced"] == json!([strokes])
            && seen["values"].as_array().is_some_and(|all| all.contains(&json!([strokes, "77"])))
        {
            break;
        }
    }
    ask(&mut viewer, &force("force", "apple"));
    assert!(received(&mut viewer, "error")["message"].as_str().is_some_and(|message| message.contains("apple")));
    ask(&mut viewer, &force("release", ""));
    while received(&mut viewer, "variables")["forced"] != json!([]) {}
    for wrong in
        [json!({"type": "watch", "variables": [1_000_000]}), json!({"type": "force", "signal": 99_999, "value": null})]
    {
        ask(&mut viewer, &wrong);
        received(&mut viewer, "error");
    }
    let eye = session["signals"].as_array().expect("a list").iter().position(|one| one["name"] == "Sensor_1");
    ask(&mut viewer, &json!({"type": "force", "signal": eye, "value": "TRUE"}));
    ask(&mut viewer, &json!({"type": "force", "signal": eye, "value": null}));
    ask(&mut viewer, &json!({"type": "operate", "operation": "stop"}));
    let report = served.report();
    let again =
        typed(&scenario("shear"), &["run", ".", "--format", "json", "--until", "1h", "--replay-operator", live]);
    let again: Value = serde_json::from_str(&again.out).expect("a report");
    assert_eq!((&again["digest"], &again["steps"]), (&report["digest"], &report["steps"]));
}

#[test]
fn verdicts_come_while_the_session_runs() {
    let served = Served::begin("shear", &["--until", "1h", "--pace", "5"]);
    let mut viewer = served.view();
    assert_eq!(received(&mut viewer, "verdict")["verdict"], "open");
    let session: Value = serde_json::from_str(&served.get("/api/session", &[]).1).expect("JSON");
    let eye = session["signals"].as_array().expect("a list").iter().position(|one| one["name"] == "Sensor_1");
    ask(&mut viewer, &json!({"type": "force", "signal": eye, "value": "FALSE"}));
    let mut failed = Value::Null;
    while failed["verdict"] != "fail" {
        failed = received(&mut viewer, "verdict");
    }
    assert!(failed["t_ns"].as_u64().is_some_and(|t_ns| t_ns > 0) && failed["name"].is_string(), "{failed}");
    ask(&mut viewer, &json!({"type": "operate", "operation": "stop"}));
    let report = served.report();
    let violated = report["expectations"].as_array().expect("a list").iter().find(|one| one["name"] == failed["name"]);
    assert_eq!(violated.map(|one| (&one["verdict"], &one["at_ns"])), Some((&json!("violated"), &failed["t_ns"])));
}
