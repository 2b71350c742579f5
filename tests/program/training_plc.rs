//! `onescan train --gateway`: lessons with a PLC that is a process of its own, started cold and driven to where each attempt
//! begins.

use std::fs;
use std::net::TcpStream;
use std::path::Path;

use serde_json::{Value, json};
use tempfile::TempDir;
use tungstenite::{Message, WebSocket};

use crate::plc::Plc;
use crate::sitter::Sitter;
use crate::training::{Lesson, SECOND_NS, record_of};
use crate::typed::{Said, copied, edit, scenario, typed, utf8};
use crate::web::{ask, view};

/// The regulation of the furnace's electrodes in a process of its own, and how it is reached.
fn process(folder: &Path, scheme: &str) -> (Plc, String) {
    let address = format!("--{}", scheme.trim_end_matches("://"));
    let plc = Plc::start(folder, &["--client", "process", "--cycle", "max", &address, "127.0.0.1:0"]);
    let gateway = plc.gateway(scheme).replace("plc=", "process=");
    (plc, gateway)
}

fn train(folder: &Path, words: &[&str]) -> Said {
    typed(folder, &[&["train", ".", "--format", "json", "--starts", "starts"], words].concat())
}

const SHORT: &str = r#"version = 1

[[start]]
name = "soon"
at = "2s"

[[start]]
name = "set otherwise"
at = "2s"
case = "otherwise"

[[lesson]]
name = "short"
start = "soon"
lasts = "60s"
waive = ["a heat takes an hour"]

[[lesson.malfunction]]
name = "water leak"
fault = { component = "wall", mode = "leak", from = "1s" }
act = "not Automatic"

[[start]]
name = "later"
at = "200s"

[[lesson]]
name = "later"
start = "later"
lasts = "60s"

[[lesson]]
name = "otherwise"
start = "set otherwise"
lasts = "8s"
"#;

const OTHERWISE: &str = "
[[case]]
name = \"otherwise\"
[case.set]
\"process.Regulation.Ohm\" = 0.005
";

/// The furnace with a lesson that soon begins, and a start that sets a variable of the PLC.
fn with_a_short_lesson() -> TempDir {
    let folder = copied("arc-furnace");
    fs::write(folder.path().join("lessons/short.toml"), SHORT).expect("writable");
    let cases = folder.path().join("cases.toml");
    let text = fs::read_to_string(&cases).expect("cases");
    fs::write(&cases, text + OTHERWISE).expect("writable");
    folder
}

/// A lesson as it is shipped, its start a quarter of an hour away: over S7 the expert scores what he scores with the soft PLC,
/// to the digest. The PLC is started again for the repetition.
#[test]
fn a_shipped_lesson_over_s7_is_that_with_the_soft_plc() {
    let folder = copied("arc-furnace");
    let expert = "experts/link-lost.jsonl";
    let soft = record_of(&train(folder.path(), &["link-lost", "--replay-operator", expert]));
    let (mut plc, gateway) = process(&scenario("arc-furnace"), "s7://");
    let words = ["link-lost", "--gateway", &gateway, "--record", "session", "--replay-operator", expert];
    let said = train(folder.path(), &words);
    assert_eq!(said.code, Some(0), "{said:?}");
    assert!(
        said.err.contains("client `process`: driven to `melting`, t_v = 780.000 s, from its cold start"),
        "{said:?}"
    );
    let real = record_of(&said);
    assert_eq!((&real["attempts"], &real["expert"]), (&soft["attempts"], &soft["expert"]));
    assert!(plc.say("status").starts_with("RUN, start 1, "), "it was driven once, and the lesson went on from there");
    // What was recorded with the real PLC is repeated with the soft one.
    let again = record_of(&train(folder.path(), &["link-lost", "--replay-operator", "session"]));
    assert_eq!(again["attempts"], soft["attempts"]);
}

/// Both PLCs of a plant are processes of their own in one lesson: a leak in the furnace that nobody sees, and the joystick of the
/// line, whose expert passes.
#[test]
fn both_plcs_of_a_plant_are_real_in_a_lesson() {
    let (furnace, line) = (with_a_short_lesson(), copied("peeling-line"));
    fs::write(furnace.path().join("nothing.jsonl"), "").expect("writable");
    let lessons = [
        (furnace.path(), ["process", "functions"], "short", "nothing.jsonl", 1),
        (line.path(), ["charger", "lathe"], "joystick", "experts/joystick.jsonl", 0),
    ];
    for (folder, plcs, lesson, operator, code) in lessons {
        let words = [lesson, "--replay-operator", operator];
        let soft = record_of(&train(folder, &words));
        let mut real = plcs.map(|plc| Plc::start(folder, &["--client", plc, "--cycle", "max", "--s7", "127.0.0.1:0"]));
        let gateways = [0, 1].map(|which| real[which].gateway_of(plcs[which], "s7://"));
        let links = gateways.iter().flat_map(|gateway| ["--gateway", gateway]).collect::<Vec<_>>();
        let said = train(folder, &[&words[..], &links].concat());
        assert_eq!(said.code, Some(code), "{said:?}");
        for (plc, process) in plcs.iter().zip(&mut real) {
            assert!(said.err.contains(&format!("client `{plc}`: driven to ")), "{said:?}");
            assert!(process.say("status").starts_with("RUN, start 1, "), "{plc} was driven once");
        }
        let real = record_of(&said);
        assert_eq!((&real["attempts"], &real["expert"]), (&soft["attempts"], &soft["expert"]), "{lesson}");
    }
}

/// The trainer repeats and goes back: each time the PLC is started and driven there, and what is recorded is repeated with the
/// soft PLC to the digests.
#[test]
fn a_trainer_repeats_and_goes_back_with_a_real_plc() {
    let folder = with_a_short_lesson();
    let (mut plc, gateway) = process(folder.path(), "tcp://");
    let words = ["short", "--gateway", &gateway, "--record", "session", "--pace", "1"];
    let lesson = Lesson::begin_in(folder.path(), &words);
    let mut trainee = Sitter::at(&lesson.pages[0], "pulpit", &["Automatic", "Page"]);
    let mut trainer = Sitter::at(&lesson.pages[1], "malfunctions", &["Page"]);
    trainer.until(|trainer| trainer.t_ns > 4 * SECOND_NS);
    trainer.ask(&json!({"type": "train", "turn": "repeat"}));
    trainer.until(|trainer| trainer.t_ns < 3 * SECOND_NS);
    trainee.write("Automatic", 0.0);
    trainee.until(|trainee| trainee.value("Automatic") == 0.0);
    let acted_ns = trainee.t_ns;
    trainer.until(|trainer| trainer.t_ns > acted_ns + SECOND_NS);
    trainer.ask(&json!({"type": "train", "turn": "back", "t_ns": acted_ns as f64}));
    while trainer.received("status")["state"] != "hold" {}
    trainer.ask(&json!({"type": "operate", "operation": "go"}));
    trainer.until(|trainer| trainer.t_ns > acted_ns + SECOND_NS);
    trainer.ask(&json!({"type": "operate", "operation": "stop"}));
    let held = lesson.record();
    assert!(plc.say("status").starts_with("RUN, start 3, "), "a cold start for each attempt");

    let attempts = held["attempts"].as_array().expect("attempts");
    assert_eq!(attempts.len(), 3, "{held}");
    assert!(attempts.iter().all(|attempt| attempt["begin_digest"] == attempts[0]["begin_digest"]), "{held}");
    assert_eq!((&attempts[2]["end"], &attempts[2]["fork"]["attempt"]), (&json!("stopped"), &json!(2)));
    assert_eq!(attempts[2]["score"]["malfunctions"][0]["begun_ns"], json!(3 * SECOND_NS), "{held}");
    let again: Value = record_of(&train(folder.path(), &["short", "--replay-operator", "session"]));
    let compared = ["number", "begin_digest", "digest", "score"];
    for (again, before) in again["attempts"].as_array().expect("attempts").iter().zip(attempts) {
        assert_eq!(compared.map(|key| &again[key]), compared.map(|key| &before[key]));
    }
}

/// A viewer, and what it last received of the session and of a PLC that is on its way.
struct Reader {
    viewer: WebSocket<TcpStream>,
    state: Value,
    drive: Value,
    drives: usize,
    refused: Value,
}

impl Reader {
    fn of(page: &str) -> Self {
        Self { viewer: view(page), state: Value::Null, drive: Value::Null, drives: 0, refused: Value::Null }
    }

    fn until(&mut self, is_so: impl Fn(&Self) -> bool) {
        while !is_so(self) {
            let Message::Text(text) = self.viewer.read().expect("a message") else { continue };
            let message: Value = serde_json::from_str(&text).expect("JSON");
            match message["type"].as_str() {
                Some("status") => self.state = message["state"].clone(),
                Some("drive") => (self.drive, self.drives) = (message["now"].clone(), self.drives + 1),
                Some("error") => self.refused = message["message"].clone(),
                // Signals, alarms and the rest are none of this test's.
                _ => {}
            }
        }
    }
}

/// While a PLC is on its way, both pages say which one, where it goes and how far it is; what would act on the next attempt is
/// refused, also what the trainer asks.
#[test]
fn pages_say_how_far_a_plc_is() {
    const THERE_NS: u64 = 200 * SECOND_NS;
    let folder = with_a_short_lesson();
    let (_plc, gateway) = process(folder.path(), "tcp://");
    let words = ["later", "--gateway", &gateway, "--record", "session", "--pace", "4"];
    let lesson = Lesson::begin_in(folder.path(), &words);
    for _ in 0..2 {
        let mut readers = lesson.pages.each_ref().map(|page| Reader::of(page));
        for reader in &mut readers {
            reader.until(|reader| reader.drives >= 3 && reader.drive["at_ns"].as_u64() > Some(0));
            let named = (&reader.drive["plcs"], &reader.drive["start"], &reader.drive["to_ns"], &reader.state);
            assert_eq!(named, (&json!(["process"]), &json!("later"), &json!(THERE_NS), &json!("driven")));
            assert!(reader.drive["at_ns"].as_u64() <= Some(THERE_NS), "{}", reader.drive);
        }
        let [_, trainer] = &mut readers;
        for what in [
            json!({"type": "operate", "operation": "hold"}),
            json!({"type": "train", "turn": "repeat"}),
            json!({"type": "fail", "component": "wall", "failure": "leak", "active": true}),
        ] {
            trainer.refused = Value::Null;
            ask(&mut trainer.viewer, &what);
            trainer.until(|trainer| !trainer.refused.is_null());
            let message = trainer.refused.as_str().expect("words");
            assert!(message.contains("the PLC is being driven"), "{what}: {message}");
        }
        trainer.until(|trainer| trainer.drive.is_null() && trainer.state == "run");
        ask(&mut trainer.viewer, &json!({"type": "train", "turn": "repeat"}));
        // Who leaves at once may not have been heard.
        trainer.until(|trainer| !trainer.drive.is_null());
    }
    let mut trainer = Reader::of(&lesson.pages[1]);
    trainer.until(|trainer| trainer.drive.is_null() && trainer.state == "run");
    ask(&mut trainer.viewer, &json!({"type": "operate", "operation": "stop"}));
    let held = lesson.record();
    let attempts = held["attempts"].as_array().expect("attempts");
    assert_eq!(attempts.len(), 3, "{held}");
    assert!(attempts.iter().all(|attempt| attempt["begin_digest"] == attempts[0]["begin_digest"]), "{held}");
}

/// What a lesson is refused for with a real PLC, each in words: nobody there, blocks that are counted, a start that sets one
/// of its variables, a client that is none.
#[test]
fn what_a_lesson_cannot_have_of_a_real_plc_is_said() {
    let folder = with_a_short_lesson();
    let nothing = folder.path().join("nothing.jsonl");
    fs::write(&nothing, "").expect("writable");
    let link = "\n[clients.process.gateway]\nreconnect_timeout = \"1s\"\n";
    let path = folder.path().join("scenario.toml");
    let text = fs::read_to_string(&path).expect("a scenario");
    fs::write(&path, text + link).expect("writable");
    let taken = |lesson: &str, gateway: &str| {
        let said = train(folder.path(), &[lesson, "--gateway", gateway, "--replay-operator", utf8(&nothing)]);
        (said.code, said.err)
    };
    let (code, unreachable) = taken("short", "process=s7://127.0.0.1:1");
    assert!(code == Some(3) && unreachable.contains("unreachable: s7://127.0.0.1:1"), "{unreachable}");
    let (_plc, gateway) = process(folder.path(), "tcp://");
    let mut all = Vec::new();
    for (lesson, gateway) in
        [("otherwise", gateway.as_str()), ("short", "plant"), ("short", "proces=tcp://127.0.0.1:1")]
    {
        let (code, said) = taken(lesson, gateway);
        assert_eq!(code, Some(2), "{said}");
        all.push(said);
    }
    edit(folder.path(), "scenario.toml", "reconnect_timeout = \"1s\"", "handshake = \"frames\"");
    let (code, said) = taken("short", "process=tcp://127.0.0.1:1");
    assert_eq!(code, Some(2), "{said}");
    all.push(said);
    insta::assert_snapshot!(all.join("----\n"));
}

/// A PLC that dies in an attempt ends that with its reason; one that dies between two attempts leaves the record of those that
/// were held.
#[test]
fn a_plc_that_dies_leaves_a_record() {
    for is_held in [false, true] {
        let folder = with_a_short_lesson();
        let link = "\n[clients.process.gateway]\nreconnect_timeout = \"1s\"\n";
        let path = folder.path().join("scenario.toml");
        let text = fs::read_to_string(&path).expect("a scenario");
        fs::write(&path, text + link).expect("writable");
        let (plc, gateway) = process(folder.path(), "tcp://");
        let lesson =
            Lesson::begin_in(folder.path(), &["short", "--gateway", &gateway, "--record", "session", "--pace", "1"]);
        let mut trainer = Sitter::at(&lesson.pages[1], "malfunctions", &["Page"]);
        trainer.until(|trainer| trainer.t_ns > 3 * SECOND_NS);
        if is_held {
            trainer.ask(&json!({"type": "operate", "operation": "hold"}));
            while trainer.received("status")["state"] != "hold" {}
        }
        drop(plc);
        if is_held {
            trainer.ask(&json!({"type": "train", "turn": "repeat"}));
        }
        let said = lesson.said();
        assert_eq!(said.code, Some(3), "{said:?}");
        let record: Value = serde_json::from_str(&said.out).unwrap_or_else(|_| panic!("{said:?}"));
        let kept = fs::read_to_string(folder.path().join("session/session.json")).expect("a record");
        assert_eq!(serde_json::from_str::<Value>(&kept).expect("JSON"), record);
        let attempts = record["attempts"].as_array().expect("attempts");
        assert_eq!(attempts.len(), 1, "{record}");
        if is_held {
            assert_eq!(attempts[0]["end"], "stopped", "{record}");
            assert!(said.err.contains("there is no start `soon`: client `process`"), "{said:?}");
        } else {
            assert_eq!(attempts[0]["end"], "failed", "{record}");
            let failure = attempts[0]["failure"].as_str().expect("a failure");
            assert!(failure.contains("not back within 1s"), "{failure}");
        }
    }
}
