//! A key of a panel that resets the session: machine and program begin again together, and what was done is repeated.

use std::path::Path;

use serde_json::{Value, json};

use crate::plc::Plc;
use crate::sitter::Sitter;
use crate::typed::{begun, copied, copied_shear, edit, scenario, typed, utf8};
use crate::web::Served;

const RESET: &str = "Main_Control.SwitchOutput[2]";
const START: &str = "Main_Control.SwitchOutput[0]";
const SEEN: [&str; 5] = ["MachineStep", "Packages_In", "SW_ANGLE", RESET, START];

/// Presses start until the machine runs and packages have come.
fn produce(desk: &mut Sitter) {
    desk.write(START, 1.0);
    desk.until(|desk| desk.value("MachineStep") == 1.0);
    desk.write(START, 0.0);
    desk.until(|desk| desk.value("MachineStep") == 3.0 && desk.value("Packages_In") >= 3.0);
}

/// [Sivtoft] sec. 5.3: Reset on the monitor presses the PLC's button and rewinds the model. Whoever looks has a new past, and
/// what people did before and after is repeated to the digest.
#[test]
fn the_monitors_reset_rewinds_machine_and_program() {
    let folder = tempfile::tempdir().expect("a folder");
    let record = folder.path().join("shift");
    let words = ["--operator", "panel", "--until", "1h", "--pace", "5", "--record", utf8(&record)];
    let served = Served::begin("filling-machine", &words);
    let mut desk = Sitter::at(&served.address, "main menu", &SEEN);
    let mut monitor = Sitter::at(&served.address, "monitor", &SEEN);
    // It is the monitor's key: the menu has none, and whoever sits elsewhere does not reset.
    desk.ask(&json!({"type": "reset", "panel": "main menu"}));
    assert_eq!(desk.received("error")["message"], "panel `main menu` has no key that resets the session");
    desk.ask(&json!({"type": "reset", "panel": "monitor"}));
    let message = desk.received("error")["message"].clone();
    assert!(message.as_str().is_some_and(|message| message.contains("take that seat first")), "{message}");

    produce(&mut desk);
    let before_ns = monitor.t_ns.max(desk.t_ns);
    monitor.ask(&json!({"type": "reset", "panel": "monitor"}));
    monitor.write(RESET, 1.0);
    monitor.until(|monitor| monitor.value(RESET) == 1.0);
    assert!(monitor.t_ns < before_ns, "{} ns after {before_ns} ns", monitor.t_ns);
    let now = ["MachineStep", "Packages_In"].map(|name| monitor.value(name));
    assert_eq!(now, [0.0, 0.0], "the program is at its first step, and no package has come");
    monitor.write(RESET, 0.0);
    // The past is that of the session that has begun.
    while monitor.received("status")["past_ns"][1].as_u64().is_none_or(|end_ns| end_ns >= before_ns) {}
    monitor.ask(&json!({"type": "show", "t_ns": before_ns + 60_000_000_000}));
    let message = monitor.received("error")["message"].clone();
    assert!(message.as_str().is_some_and(|message| message.contains("not a moment of the past")), "{message}");

    produce(&mut desk);
    desk.ask(&json!({"type": "operate", "operation": "stop"}));
    let live = served.report();
    assert_eq!(live["status"], "stopped");
    let words =
        ["run", ".", "--format", "json", "--operator", "panel", "--until", "1h", "--replay-operator", utf8(&record)];
    let said = typed(&scenario("filling-machine"), &words);
    let again: Value = serde_json::from_str(&said.out).unwrap_or_else(|_| panic!("{said:?}"));
    assert_eq!((&again["digest"], &again["steps"]), (&live["digest"], &live["steps"]));
}

/// A panel with nothing but the key.
const KEY: &str = "
[[panel]]
name = \"desk\"
element = [{ kind = \"button\", label = \"Begin again\", action = \"reset\", at = [0, 0] }]
";

fn with_a_key(folder: &Path) {
    let path = folder.join("scenario.toml");
    let text = std::fs::read_to_string(&path).expect("a scenario");
    std::fs::write(&path, text + KEY).expect("writable");
}

/// A real PLC starts cold with the machine, and the digest is that of a session that was never reset. Who resets gets a
/// message about a PLC that the link cannot start.
#[test]
fn a_real_plc_begins_again_with_the_machine() {
    for is_asked in [true, false] {
        let folder = copied_shear();
        with_a_key(folder.path());
        if !is_asked {
            edit(folder.path(), "scenario.toml", "system_words = true\n", "");
        }
        let mut plc = Plc::start(folder.path(), &["--cycle", "max", "--tcp", "127.0.0.1:0"]);
        let gateway = plc.gateway("tcp://");
        let words = ["run", ".", "--format", "json", "--web", "--until", "2s", "--pace", "1", "--gateway", &gateway];
        let served = Served::of(begun(folder.path(), &words));
        let mut desk = Sitter::at(&served.address, "desk", &["Strokes"]);
        desk.until(|desk| desk.t_ns > 1_000_000_000);
        desk.ask(&json!({"type": "reset", "panel": "desk"}));
        if !is_asked {
            let message = desk.received("error")["message"].clone();
            assert!(message.as_str().is_some_and(|text| text.contains("PLC of client `plc`")), "{message}");
        }
        desk.until(|desk| desk.t_ns < 900_000_000);
        let live = served.report();
        let status = plc.say("status");
        assert!(status.starts_with("RUN, start 2, "), "{status}");
        let said = typed(folder.path(), &["run", ".", "--format", "json", "--until", "2s"]);
        let soft: Value = serde_json::from_str(&said.out).unwrap_or_else(|_| panic!("{said:?}"));
        assert_eq!((&live["digest"], &live["steps"]), (&soft["digest"], &soft["steps"]), "{live}");
    }
}

/// What cannot be is said by `check`, at its place.
#[test]
fn a_key_that_cannot_reset_is_refused_at_its_place() {
    let mut all = Vec::new();
    for (from, to) in [
        ("action = \"reset\"", "action = \"rewind\""),
        ("action = \"reset\"", "action = \"reset\"\nlatching = true"),
        ("kind = \"button\"\nlabel = \"Reset all\"", "kind = \"switch\"\nlabel = \"Reset all\""),
    ] {
        let folder = copied("filling-machine");
        edit(folder.path(), "scenario.toml", from, to);
        let said = typed(folder.path(), &["check", "."]);
        assert_eq!(said.code, Some(2), "{said:?}");
        all.push(said.err);
    }
    insta::assert_snapshot!(all.join("----\n"));
}
