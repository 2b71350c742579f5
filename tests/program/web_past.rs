//! The past of a session on its page, sessions that go on from there, and recordings as a page.

use std::fs;
use std::net::TcpStream;
use std::path::Path;

use serde_json::{Value, json};
use tungstenite::{Message, WebSocket};

use crate::typed::{begun, scenario, typed};
use crate::web::{Served, ask, received, view};

/// A picture: whether it is of the past, its time, and its values by signal.
struct Picture {
    is_past: bool,
    t_ns: u64,
    values: Vec<(u32, f64)>,
}

/// The next picture that `wanted` lets through.
fn picture(viewer: &mut WebSocket<TcpStream>, wanted: impl Fn(&Picture) -> bool) -> Picture {
    loop {
        let Message::Binary(bytes) = viewer.read().expect("a message") else { continue };
        let eight = |at: usize| <[u8; 8]>::try_from(&bytes[at..at + 8]).expect("eight bytes");
        let count = usize::from(u16::from_le_bytes([bytes[2], bytes[3]]));
        let value = |place: usize| {
            let at = 24 + 16 * place;
            let signal = u32::from_le_bytes(bytes[at..at + 4].try_into().expect("four bytes"));
            (signal, f64::from_le_bytes(eight(at + 8)))
        };
        let picture = Picture {
            is_past: bytes[1] & 2 != 0,
            t_ns: u64::from_le_bytes(eight(16)),
            values: (0..count).map(value).collect(),
        };
        if wanted(&picture) {
            return picture;
        }
    }
}

/// The number of a signal on the page.
fn signal(served: &Served, name: &str) -> u32 {
    let session: Value = serde_json::from_str(&served.get("/api/session", &[]).1).expect("JSON");
    let signals = session["signals"].as_array().expect("a list");
    let place = signals.iter().position(|signal| signal["name"] == name).expect("a signal");
    u32::try_from(place).expect("few signals")
}

/// What the shear's blade is at a time in nanoseconds, by a run that nobody looks at.
fn position(folder: &Path, t_ns: u64) -> f64 {
    let record = folder.join("plain");
    let record = record.to_str().expect("UTF-8");
    let table = folder.join("plain.csv");
    let table = table.to_str().expect("UTF-8");
    let ran = typed(&scenario("shear"), &["run", ".", "--record", record, "--overwrite"]);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let exported = typed(&scenario("shear"), &["export", record, "-o", table, "--signals", "Position_1"]);
    assert_eq!(exported.code, Some(0), "{exported:?}");
    let rows = fs::read_to_string(table).expect("a table");
    let head: Vec<&str> = rows.lines().next().expect("a head").split(',').collect();
    let column = |name: &str| head.iter().position(|one| *one == name).expect("a column");
    let (time, value) = (column("t_v_ns"), column("Position_1"));
    let mut cells = rows.lines().skip(1).map(|row| row.split(',').collect::<Vec<_>>());
    let row = cells.find(|cells| cells[time] == t_ns.to_string()).expect("a row");
    row[value].parse().expect("a number")
}

/// The digest of the shear at a time in nanoseconds, by a run that nobody looks at.
fn digest(t_ns: u64) -> Value {
    let until = format!("{t_ns}ns");
    let ran = typed(&scenario("shear"), &["run", ".", "--format", "json", "--until", &until]);
    let report: Value = serde_json::from_str(&ran.out).expect("a report");
    report["digest"].clone()
}

const MOMENT_NS: u64 = 2_340_000_000;

#[test]
fn a_moment_of_the_past_is_shown_exactly_and_leaves_no_trace() {
    let folder = tempfile::tempdir().expect("a folder");
    let served = Served::begin("shear", &["--until", "1h", "--pace", "50"]);
    let blade = signal(&served, "Position_1");
    let (mut one, mut other) = (served.view(), served.view());
    ask(&mut one, &json!({"type": "subscribe", "signals": [blade]}));
    picture(&mut one, |picture| picture.t_ns > 5_000_000_000);
    ask(&mut one, &json!({"type": "show", "t_ns": MOMENT_NS + 1}));
    let past = picture(&mut one, |picture| picture.is_past);
    assert_eq!((past.t_ns, past.values), (MOMENT_NS, vec![(blade, position(folder.path(), MOMENT_NS))]));
    // back and forth, and what has not been yet
    for t_ns in [4_000_000_000, 0, 10_000_000, 3_990_000_000] {
        ask(&mut one, &json!({"type": "show", "t_ns": t_ns}));
        picture(&mut one, |picture| picture.is_past && picture.t_ns == t_ns);
    }
    ask(&mut one, &json!({"type": "show", "t_ns": 3.6e12}));
    assert!(
        received(&mut one, "error")["message"]
            .as_str()
            .is_some_and(|message| message.contains("not a moment of the past"))
    );
    // the other one has seen nothing of it
    let live = picture(&mut other, |_| true);
    assert!(!live.is_past);
    ask(&mut one, &json!({"type": "live"}));
    let live = picture(&mut one, |picture| !picture.is_past);
    assert!(live.t_ns > 5_000_000_000 && live.values.len() == 1, "the picture has everything again");
    ask(&mut one, &json!({"type": "operate", "operation": "stop"}));
    let report = served.report();
    assert_eq!(report["digest"], digest(report["virtual_time_ns"].as_u64().expect("a time")));
}

#[test]
fn a_session_goes_on_from_a_moment_of_the_past() {
    let served = Served::begin("shear", &["--until", "4s"]);
    let mut viewer = served.view();
    ask(&mut viewer, &json!({"type": "operate", "operation": "hold"}));
    (0..240).for_each(|_| ask(&mut viewer, &json!({"type": "operate", "operation": "step"})));
    picture(&mut viewer, |picture| picture.t_ns > MOMENT_NS);
    ask(&mut viewer, &json!({"type": "fork", "t_ns": MOMENT_NS}));
    let forked = received(&mut viewer, "forked");
    assert_eq!(forked["t_ns"], MOMENT_NS);
    let url = forked["url"].as_str().expect("a link");
    let address = url.trim_start_matches("http://").trim_end_matches('/');
    let mut fork = view(address);
    let first = picture(&mut fork, |picture| picture.t_ns > 0);
    assert!(first.t_ns >= MOMENT_NS);
    let end = loop {
        let status = received(&mut fork, "status");
        if status["state"] == "end" {
            break status;
        }
    };
    assert_eq!(end["digest"], digest(4_000_000_000));
    ask(&mut viewer, &json!({"type": "operate", "operation": "go"}));
    assert_eq!(served.report()["digest"], end["digest"], "the first session has noticed nothing");
}

/// What operators did is a part of the past.
#[test]
fn what_operators_did_is_shown_again() {
    let served = Served::begin("rotary-kiln/thesis.toml", &["--until", "1h", "--pace", "20"]);
    let speed = signal(&served, "Speed");
    let mut viewer = served.view();
    ask(&mut viewer, &json!({"type": "subscribe", "signals": [speed]}));
    ask(&mut viewer, &json!({"type": "seat", "panel": "operator", "take": true}));
    while received(&mut viewer, "status")["seat"]["operator"] != "mine" {}
    ask(&mut viewer, &json!({"type": "write", "signal": speed, "value": 200.0}));
    let written = picture(&mut viewer, |picture| picture.values.contains(&(speed, 200.0)));
    picture(&mut viewer, |picture| picture.t_ns > written.t_ns + 1_000_000_000);
    ask(&mut viewer, &json!({"type": "show", "t_ns": written.t_ns}));
    let past = picture(&mut viewer, |picture| picture.is_past);
    assert_eq!((past.t_ns, past.values), (written.t_ns, vec![(speed, 200.0)]));
    ask(&mut viewer, &json!({"type": "show", "t_ns": 0}));
    let before = picture(&mut viewer, |picture| picture.is_past && picture.t_ns == 0);
    assert_eq!(before.values, vec![(speed, 60.0)]);
    ask(&mut viewer, &json!({"type": "operate", "operation": "stop"}));
    assert_eq!(served.report()["status"], "stopped");
}

#[test]
fn why_there_is_no_past_is_said() {
    let served = Served::begin("shear", &["--until", "1h", "--past-memory", "0"]);
    let mut viewer = served.view();
    ask(&mut viewer, &json!({"type": "show", "t_ns": 0}));
    assert!(
        received(&mut viewer, "error")["message"].as_str().is_some_and(|message| message.contains("--past-memory 0"))
    );
    ask(&mut viewer, &json!({"type": "operate", "operation": "stop"}));
    assert_eq!(served.report()["status"], "stopped");
    let wrong = typed(&scenario("shear"), &["run", ".", "--web", "--past-memory", "256MB"]);
    assert!(wrong.code == Some(2) && wrong.err.contains("not an amount of memory"), "{wrong:?}");
}

fn recorded(folder: &Path) -> String {
    let record = folder.join("shear");
    let record = record.to_str().expect("UTF-8").to_owned();
    let ran = typed(&scenario("shear"), &["run", ".", "--record", &record]);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    format!("{record}/run-1")
}

/// Looks at a recording until the re-run is checked; gives what was said of it, and ends it.
fn viewed(record: &str, look: impl FnOnce(&Served, &mut WebSocket<TcpStream>)) -> (Option<i32>, String) {
    let served = Served::of(begun(&scenario("shear"), &["view", record]));
    let mut viewer = served.view();
    look(&served, &mut viewer);
    // those who come later are notified, too
    let text = received(&mut served.view(), "event")["text"].as_str().expect("a text").to_owned();
    ask(&mut viewer, &json!({"type": "operate", "operation": "stop"}));
    let output = served.program.wait_with_output().expect("it ends");
    assert!(String::from_utf8_lossy(&output.stdout).contains(&text));
    (output.status.code(), text)
}

#[test]
fn a_recording_is_a_page_of_the_past() {
    let folder = tempfile::tempdir().expect("a folder");
    let record = recorded(folder.path());
    let exact = position(folder.path(), MOMENT_NS);
    let (code, said) = viewed(&record, |served, viewer| {
        let session: Value = serde_json::from_str(&served.get("/api/session", &[]).1).expect("JSON");
        assert_eq!(session["live"], false);
        let first = picture(viewer, |_| true);
        assert_eq!((first.is_past, first.t_ns), (true, 0));
        let blade = signal(served, "Position_1");
        ask(viewer, &json!({"type": "subscribe", "signals": [blade]}));
        ask(viewer, &json!({"type": "show", "t_ns": MOMENT_NS}));
        let past = picture(viewer, |picture| picture.t_ns == MOMENT_NS);
        assert_eq!(past.values, vec![(blade, exact)]);
        for asked in [json!({"type": "operate", "operation": "go"}), json!({"type": "write", "signal": 0, "value": 1})]
        {
            ask(viewer, &asked);
            assert!(
                received(viewer, "error")["message"].as_str().is_some_and(|why| why.contains("recording is looked at"))
            );
        }
        ask(viewer, &json!({"type": "show", "t_ns": 6_010_000_000_u64}));
        assert!(
            received(viewer, "error")["message"].as_str().is_some_and(|why| why.contains("not a moment of the past"))
        );
    });
    assert_eq!(code, Some(0));
    assert!(said.contains("all steps up to 600 are as recorded"), "{said}");
}

#[test]
fn a_recording_that_is_not_what_its_files_do_is_reported() {
    let folder = tempfile::tempdir().expect("a folder");
    let record = recorded(folder.path());
    let scene = Path::new(&record).join("scenario/plant.toml");
    let text = fs::read_to_string(&scene).expect("a scene");
    fs::write(&scene, text.replacen("mass_kg = 300.0", "mass_kg = 301.0", 1)).expect("writable");
    let (code, said) = viewed(&record, |_, _| {});
    assert_eq!(code, Some(1));
    assert!(said.contains("differs from step"), "{said}");
    // a part that was cut
    let parts = Path::new(&record).join("trajectory");
    let part = fs::read_dir(&parts).expect("parts").next().expect("a part").expect("a part").path();
    let bytes = fs::read(&part).expect("bytes");
    fs::write(&part, &bytes[..bytes.len() / 2]).expect("writable");
    let said = typed(&scenario("shear"), &["view", &record]);
    assert!(said.code == Some(2) && said.out.is_empty() && said.err.contains("part-"), "{said:?}");
    // none at all
    let said = typed(&scenario("shear"), &["view", "."]);
    assert_eq!(said.code, Some(2), "{said:?}");
}
