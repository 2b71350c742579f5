//! `onescan train`: lessons from their start, measured on virtual time, repeated to the digest.

use std::fs;
use std::io::{BufRead, BufReader, Read};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, ChildStderr};
use std::time::Instant;

use serde_json::{Value, json};
use tungstenite::client::IntoClientRequest;
use tungstenite::{Message, WebSocket};

use crate::sitter::structure;
use crate::typed::{Said, begun, copied, edit, scenario, typed, utf8};

const STEP_NS: u64 = 20_000_000;

/// The record that a lesson's end wrote to standard output.
fn record(said: &Said) -> Value {
    serde_json::from_str(&said.out).unwrap_or_else(|_| panic!("{said:?}"))
}

pub(crate) fn train(starts: &Path, words: &[&str]) -> Said {
    typed(&scenario("arc-furnace"), &[&["train", ".", "--format", "json", "--starts", utf8(starts)], words].concat())
}

const EXPERT: &str = "experts/three-malfunctions.jsonl";

/// What the expert did passes; the same from his recording, from the record of the session, and once more.
#[test]
fn an_experts_lesson_is_repeated_to_its_digest_and_its_score() {
    let folder = tempfile::tempdir().expect("a folder");
    let (starts, session) = (folder.path().join("starts"), folder.path().join("session"));
    let page = folder.path().join("page.html");
    let lesson = "three-malfunctions";
    let first = train(
        &starts,
        &[lesson, "--trainee", "ann", "--replay-operator", EXPERT, "--record", utf8(&session), "--html", utf8(&page)],
    );
    assert_eq!(first.code, Some(0), "{first:?}");
    let first = record(&first);
    let score = &first["attempts"][0]["score"];
    assert_eq!((&first["passed"], &first["trainee"]), (&json!(true), &json!("ann")), "{first}");
    assert_eq!(score, &first["expert"]["score"], "the expert beside himself");
    let html = fs::read_to_string(&page).expect("a page");
    assert!(html.contains("water leak") && html.contains("electrode broken"));

    // A step: the leak begins 20 s after the start at 780 s, the acknowledgement acts 1.5 s later.
    let leak = &score["malfunctions"][0];
    assert_eq!(leak["begun_ns"], json!(800_000_000_000_u64));
    assert_eq!(leak["identified"]["after_ns"], json!(1_500_000_000_u64));
    assert_eq!(leak["acted"]["after_ns"], json!(3_000_000_000_u64));
    // The same times in the recording, to the step.
    let events = fs::read_to_string(session.join("run-1/events.jsonl")).expect("events");
    let events: Vec<Value> = events.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
    let image_of = |found: &dyn Fn(&Value) -> bool| {
        let event = events.iter().find(|event| found(event)).expect("recorded");
        event["t_v_ns"].as_u64().expect("a time") + STEP_NS
    };
    assert_eq!(leak["begun_ns"], json!(image_of(&|event| event["action"] == "fail" && event["component"] == "wall")));
    assert_eq!(
        leak["identified"]["at_ns"],
        json!(image_of(&|event| event["signal"] == "Acknowledge" && event["value"] == "TRUE"))
    );

    let digest = &first["attempts"][0]["digest"];
    for source in [session.join("run-1"), session.clone(), scenario("arc-furnace").join(EXPERT)] {
        let again = train(&starts, &[lesson, "--replay-operator", utf8(&source)]);
        assert_eq!(again.code, Some(0), "{again:?}");
        let again = record(&again);
        assert_eq!((&again["attempts"][0]["digest"], &again["attempts"][0]["score"]), (digest, score));
    }
    let table = typed(&scenario("arc-furnace"), &["train", ".", "--table", utf8(folder.path())]);
    assert!(table.code == Some(0) && table.out.contains("ann") && table.out.contains("3 of 3"), "{table:?}");
}

/// Who does nothing is notified, with what the expert made of it.
#[test]
fn who_does_nothing_does_not_pass() {
    let folder = tempfile::tempdir().expect("a folder");
    let nothing = folder.path().join("nothing.jsonl");
    fs::write(&nothing, "").expect("writable");
    let words = ["train", ".", "three-malfunctions", "--starts", utf8(folder.path())];
    let said = typed(&scenario("arc-furnace"), &[&words, &["--replay-operator", utf8(&nothing)][..]].concat());
    assert_eq!(said.code, Some(1), "{said:?}");
    assert!(said.out.contains("not passed") && said.out.contains("never"), "{said:?}");
}

/// Who acknowledges over and over, whether there is an alarm or not, does not pass: ten false acknowledgements are eight too
/// many. Two are forgiven.
#[test]
fn who_acknowledges_everything_does_not_pass() {
    let folder = tempfile::tempdir().expect("a folder");
    let expert = fs::read_to_string(scenario("arc-furnace").join(EXPERT)).expect("an expert");
    for (often, code) in [(10, 1), (2, 0)] {
        let press = |number: u64| {
            ["TRUE", "FALSE"].into_iter().zip(0..).map(move |(value, half)| {
                let step = 39_200 + number * 40 + half * 20;
                let t_v_ns = (step - 1) * STEP_NS;
                let (event, action, signal) = ("operator", "write", "Acknowledge");
                format!("{}\n", json!({ "step": step, "t_v_ns": t_v_ns, "event": event, "action": action, "signal": signal, "value": value }))
            })
        };
        let pressed: String = (0..often).flat_map(press).collect();
        let inputs = folder.path().join(format!("{often}.jsonl"));
        fs::write(&inputs, pressed + &expert).expect("writable");
        let said = train(folder.path(), &["three-malfunctions", "--replay-operator", utf8(&inputs)]);
        assert_eq!(said.code, Some(code), "{said:?}");
        let score = &record(&said)["attempts"][0]["score"];
        assert_eq!(score["mistakes"][0]["count"], json!(often), "{score}");
        let are_mastered =
            score["malfunctions"].as_array().expect("a list").iter().all(|one| !one["identified"].is_null());
        assert!(are_mastered && score["mistakes"][0]["first_ns"].is_u64(), "{score}");
    }
}

/// Lessons and starts are listed; what is wrong is reported at its place.
#[test]
fn lessons_are_listed_and_checked() {
    let listed = typed(&scenario("arc-furnace"), &["train", "."]);
    assert_eq!(listed.code, Some(0), "{listed:?}");
    assert!(
        listed.out.contains("three-malfunctions") && listed.out.contains("start `flat bath` at 2880.000 s"),
        "{listed:?}"
    );
    assert!(listed.out.contains(", 1 malfunction, at most") && !listed.out.contains(" 1 malfunctions"), "{listed:?}");
    let widest = listed.out.lines().map(|line| line.chars().count()).max();
    assert!(widest.is_some_and(|width| width <= 80), "{listed:?}");
    let unknown = typed(&scenario("arc-furnace"), &["train", ".", "three-malfunction"]);
    assert!(unknown.code == Some(2) && unknown.err.contains("did you mean"), "{unknown:?}");
    for (from, to, reported) in [
        ("start = \"melting\"\nlasts = \"6min\"", "start = \"meltin\"\nlasts = \"6min\"", "there is no start `meltin`"),
        ("act = \"not Automatic\"", "act = \"not Automatc\"", "Automatc"),
        ("mode = \"suction_lost\", from", "mode = \"suction_lst\", from", "has no failure mode `suction_lst`"),
        ("signals = [\"Electrode[1..3]\"]", "signals = [\"Electrod[1..3]\"]", "there is no signal `Electrod[1]`"),
        ("by_trainer = true", "by_trainer = false", ""),
    ] {
        let folder = copied("arc-furnace");
        edit(folder.path(), "lessons.toml", from, to);
        let words = ["train", ".", "three-malfunctions", "--starts", "starts", "--replay-operator", EXPERT];
        let said = typed(folder.path(), &words);
        if reported.is_empty() {
            assert_eq!(said.code, Some(0), "a fault of another lesson without a time begins with it: {said:?}");
        } else {
            assert!(
                said.code == Some(2) && said.err.contains(reported) && said.err.contains("lessons.toml"),
                "{said:?}"
            );
        }
    }
    let alone = typed(&scenario("arc-furnace"), &["train", ".", "tap"]);
    assert!(alone.code == Some(2) && alone.err.contains("--web"), "{alone:?}");
}

/// A lesson on its pages.
pub(crate) struct Lesson {
    program: Child,
    said: BufReader<ChildStderr>,
    pub(crate) pages: [String; 2],
}

impl Lesson {
    pub(crate) fn begin(words: &[&str]) -> Self {
        Self::begin_in(&scenario("arc-furnace"), words)
    }

    pub(crate) fn begin_in(folder: &Path, words: &[&str]) -> Self {
        let words = [&["train", ".", "--format", "json", "--web"], words].concat();
        let mut program = begun(folder, &words);
        let mut said = BufReader::new(program.stderr.take().expect("piped"));
        let pages = ["trainee", "trainer"].map(|whose| {
            let mut line = String::new();
            while !line.contains(&format!("{whose}'s page is at http://")) {
                line.clear();
                assert_ne!(said.read_line(&mut line).expect("text"), 0, "no page");
            }
            let address = line.split("http://").nth(1).and_then(|rest| rest.split('/').next());
            address.expect("an address").to_owned()
        });
        Self { program, said, pages }
    }

    fn view(&self, page: usize) -> WebSocket<TcpStream> {
        let address = &self.pages[page];
        let stream = TcpStream::connect(address).expect("served");
        let request = format!("ws://{address}/api/live").into_client_request().expect("a request");
        tungstenite::client(request, stream).expect("a viewer").0
    }

    pub(crate) fn record(self) -> Value {
        let said = self.said();
        serde_json::from_str(&said.out).unwrap_or_else(|_| panic!("{said:?}"))
    }

    /// All that it says, to its end.
    pub(crate) fn said(mut self) -> Said {
        let mut err = String::new();
        self.said.read_to_string(&mut err).expect("text");
        Said { err, ..Said::from(self.program.wait_with_output().expect("it ends")) }
    }
}

fn ask(viewer: &mut WebSocket<TcpStream>, what: &Value) {
    viewer.send(Message::text(what.to_string())).expect("sent");
}

fn received(viewer: &mut WebSocket<TcpStream>, kind: &str) -> Value {
    loop {
        if let Message::Text(text) = viewer.read().expect("a message") {
            let received: Value = serde_json::from_str(&text).expect("JSON");
            if received["type"] == kind {
                return received;
            }
        }
    }
}

/// The time of the next picture, ns.
fn time(viewer: &mut WebSocket<TcpStream>) -> u64 {
    loop {
        if let Message::Binary(bytes) = viewer.read().expect("a message") {
            return u64::from_le_bytes(bytes[16..24].try_into().expect("eight bytes"));
        }
    }
}

/// Pictures until one is of a time that is asked for.
fn until(viewer: &mut WebSocket<TcpStream>, is_it: impl Fn(u64) -> bool) -> u64 {
    loop {
        let t_ns = time(viewer);
        if is_it(t_ns) {
            return t_ns;
        }
    }
}

pub(crate) const SECOND_NS: u64 = 1_000_000_000;

/// The trainer repeats the start twenty times, jumps to the flat bath, goes back: all attempts are in the record, forks too,
/// and all of them are repeated to their digests. The trainee may do none of that.
#[test]
fn a_trainer_repeats_jumps_and_goes_back() {
    let folder = tempfile::tempdir().expect("a folder");
    let (starts, session) = (folder.path().join("starts"), folder.path().join("session"));
    // The flat bath has been prepared before, as that of any lesson is.
    let nothing = folder.path().join("nothing.jsonl");
    fs::write(&nothing, "").expect("writable");
    train(&starts, &["tap", "--replay-operator", utf8(&nothing)]);
    // Slow enough that a request arrives in time on a loaded machine, too: after the cave-in the lesson soon ends by itself.
    let words = ["cave-in", "--starts", utf8(&starts), "--record", utf8(&session), "--pace", "10"];
    let lesson = Lesson::begin(&words);
    let (mut trainee, mut trainer) = (lesson.view(0), lesson.view(1));
    for refused in [
        json!({"type": "operate", "operation": "hold"}),
        json!({"type": "fail", "component": "wall", "failure": "leak", "active": true}),
        json!({"type": "train", "turn": "repeat"}),
        json!({"type": "force", "signal": 0, "value": "1"}),
        json!({"type": "variable", "variable": 0, "action": "force", "value": "1"}),
    ] {
        ask(&mut trainee, &refused);
        let error = received(&mut trainee, "error");
        assert!(error["message"].as_str().is_some_and(|message| message.contains("trainer's business")), "{error}");
    }
    let start_ns = 780 * SECOND_NS;
    for _ in 0..20 {
        let before = until(&mut trainer, |t_ns| t_ns > start_ns + 5 * SECOND_NS);
        ask(&mut trainer, &json!({"type": "train", "turn": "repeat"}));
        until(&mut trainer, |t_ns| t_ns < before);
    }
    let asked = Instant::now();
    ask(&mut trainer, &json!({"type": "train", "turn": "jump", "start": "flat bath"}));
    until(&mut trainer, |t_ns| t_ns >= 2880 * SECOND_NS);
    let jumped = asked.elapsed();
    println!("the jump to the flat bath took {jumped:?}");
    ask(&mut trainer, &json!({"type": "train", "turn": "jump", "start": "melting"}));
    until(&mut trainer, |t_ns| t_ns < 2000 * SECOND_NS);
    ask(&mut trainer, &json!({"type": "fail", "component": "bath", "failure": "cave_in", "active": true}));
    until(&mut trainer, |t_ns| t_ns > start_ns + 30 * SECOND_NS);
    ask(&mut trainer, &json!({"type": "train", "turn": "back", "t_ns": (start_ns + 10 * SECOND_NS) as f64}));
    while received(&mut trainer, "status")["state"] != "hold" {}
    ask(&mut trainer, &json!({"type": "operate", "operation": "go"}));
    until(&mut trainer, |t_ns| t_ns > start_ns + 12 * SECOND_NS && t_ns < start_ns + 100 * SECOND_NS);
    ask(&mut trainer, &json!({"type": "operate", "operation": "stop"}));
    let held = lesson.record();
    let attempts = held["attempts"].as_array().expect("attempts");
    assert_eq!(attempts.len(), 24, "{held}");
    for attempt in &attempts[..21] {
        assert_eq!(attempt["begin_digest"], attempts[0]["begin_digest"]);
    }
    let (jumped, last) = (&attempts[21], &attempts[23]);
    assert_eq!((&jumped["start"], &jumped["score"]["begin_ns"]), (&json!("flat bath"), &json!(2880 * SECOND_NS)));
    assert_eq!((&last["fork"]["attempt"], &last["fork"]["t_v_ns"]), (&json!(23), &json!(start_ns + 10 * SECOND_NS)));
    assert!(attempts[22]["score"]["malfunctions"][0]["begun_ns"].is_u64(), "{}", attempts[22]);
    let again = train(&starts, &["cave-in", "--replay-operator", utf8(&session)]);
    let again: Value = record_of(&again);
    for (again, before) in again["attempts"].as_array().expect("attempts").iter().zip(attempts) {
        assert_eq!(again["digest"], before["digest"], "attempt {}", before["number"]);
        assert_eq!(again["score"]["malfunctions"], before["score"]["malfunctions"], "attempt {}", before["number"]);
    }
}

pub(crate) fn record_of(said: &Said) -> Value {
    assert!(matches!(said.code, Some(0 | 1)), "{said:?}");
    record(said)
}

/// The trainer's panel is on the trainer's page alone, and the trainee's page names no failure.
#[test]
fn the_trainee_sees_nothing_of_the_trainer() {
    let folder = tempfile::tempdir().expect("a folder");
    // At a pace: as fast as it can, the lesson may be over before both pages have been read.
    let lesson = Lesson::begin(&["three-malfunctions", "--starts", utf8(folder.path()), "--pace", "20"]);
    let structures = [0, 1].map(|page| structure(&lesson.pages[page]));
    let panels = |structure: &Value| {
        let panels = structure["panels"].as_array().expect("panels").iter();
        panels.map(|panel| panel["name"].as_str().expect("a name").to_owned()).collect::<Vec<String>>()
    };
    assert_eq!(panels(&structures[0]), ["pulpit", "water", "hydraulics", "electrics"]);
    assert_eq!(panels(&structures[1]), ["pulpit", "water", "hydraulics", "electrics", "malfunctions"]);
    let failures = |structure: &Value| {
        let parts = structure["components"].as_array().expect("components").iter();
        parts.map(|part| part["failures"].as_array().expect("failures").len()).sum::<usize>()
    };
    assert!(failures(&structures[0]) == 0 && failures(&structures[1]) > 20);
    assert_eq!(structures[0]["training"]["starts"], json!([]));
    // It stays until the lesson has ended: a connection that is reset takes with it what was sent and not yet read.
    let mut trainer = lesson.view(1);
    ask(&mut trainer, &json!({"type": "operate", "operation": "stop"}));
    let record = lesson.record();
    assert_eq!(record["attempts"][0]["end"], "stopped");
}
