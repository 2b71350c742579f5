//! `run --web`: a session in a browser leaves no trace, takes what operators write, and lets nobody else in.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::{Child, ChildStderr};
use std::time::Duration;

use serde_json::{Value, json};
use tungstenite::client::IntoClientRequest;
use tungstenite::{Message, WebSocket};

use crate::typed::{begun, scenario, typed};

/// A session with a page, and where that is.
pub(crate) struct Served {
    pub(crate) program: Child,
    said: BufReader<ChildStderr>,
    pub(crate) address: String,
}

impl Served {
    pub(crate) fn begin(name: &str, words: &[&str]) -> Self {
        let (folder, file) = name.split_once('/').unwrap_or((name, "."));
        let words = [&["run", file, "--format", "json", "--web"], words].concat();
        Self::of(begun(&scenario(folder), &words))
    }

    /// What says where its page is.
    pub(crate) fn of(mut program: Child) -> Self {
        let mut said = BufReader::new(program.stderr.take().expect("piped"));
        let mut line = String::new();
        while !line.contains("http://") {
            line.clear();
            assert_ne!(said.read_line(&mut line).expect("text"), 0, "no page");
        }
        let address = line.split("http://").nth(1).and_then(|rest| rest.split('/').next()).expect("an address");
        Self { program, address: address.to_owned(), said }
    }

    /// The status line and the body of an answer.
    pub(crate) fn get(&self, path: &str, headers: &[(&str, &str)]) -> (String, String) {
        let (head, body) = self.request("GET", path, headers, "");
        (head.lines().next().expect("a status").to_owned(), body)
    }

    /// The head and the body of an answer.
    pub(crate) fn request(&self, method: &str, path: &str, headers: &[(&str, &str)], body: &str) -> (String, String) {
        let mut stream = TcpStream::connect(&self.address).expect("served");
        let has_host = headers.iter().any(|(name, _)| *name == "Host");
        let host = [("Host", self.address.as_str())];
        let all = host.iter().filter(|_| !has_host).chain(headers);
        let lines: String = all.flat_map(|(name, value)| [name, ": ", value, "\r\n"]).collect();
        let length = if body.is_empty() { String::new() } else { format!("Content-Length: {}\r\n", body.len()) };
        let request = format!("{method} {path} HTTP/1.1\r\nConnection: close\r\n{lines}{length}\r\n{body}");
        stream.write_all(request.as_bytes()).expect("writable");
        let mut answer = Vec::new();
        stream.read_to_end(&mut answer).expect("an answer");
        let answer = String::from_utf8_lossy(&answer).into_owned();
        let (head, body) = answer.split_once("\r\n\r\n").expect("a head");
        (head.to_owned(), body.to_owned())
    }

    pub(crate) fn view(&self) -> WebSocket<TcpStream> {
        view(&self.address)
    }

    /// The report of the run.
    pub(crate) fn report(mut self) -> Value {
        let output = {
            let mut rest = String::new();
            self.said.read_to_string(&mut rest).expect("text");
            self.program.wait_with_output().expect("it ends")
        };
        serde_json::from_slice(&output.stdout).expect("a report")
    }
}

/// A viewer of the page at this address.
pub(crate) fn view(address: &str) -> WebSocket<TcpStream> {
    let stream = TcpStream::connect(address).expect("served");
    // What never comes fails the test; it does not hang it.
    stream.set_read_timeout(Some(Duration::from_mins(2))).expect("a socket");
    let request = format!("ws://{address}/api/live").into_client_request().expect("a request");
    tungstenite::client(request, stream).expect("a viewer").0
}

pub(crate) fn ask(viewer: &mut WebSocket<TcpStream>, what: &Value) {
    viewer.send(Message::text(what.to_string())).expect("sent");
}

/// The next text that says this.
pub(crate) fn received(viewer: &mut WebSocket<TcpStream>, kind: &str) -> Value {
    loop {
        if let Message::Text(text) = viewer.read().expect("a message") {
            let received: Value = serde_json::from_str(&text).expect("JSON");
            if received["type"] == kind {
                return received;
            }
        }
    }
}

/// The value of the only signal that was asked for, from the first picture that has it.
fn shown(viewer: &mut WebSocket<TcpStream>) -> (u64, f64) {
    loop {
        if let Message::Binary(bytes) = viewer.read().expect("a message") {
            let at = |from: usize| <[u8; 8]>::try_from(&bytes[from..from + 8]).expect("eight bytes");
            if bytes[2] == 1 {
                return (u64::from_le_bytes(at(16)), f64::from_le_bytes(at(32)));
            }
        }
    }
}

pub(crate) const LIVE: &[(&str, &str)] = &[
    ("Upgrade", "websocket"),
    ("Connection", "Upgrade"),
    ("Sec-WebSocket-Version", "13"),
    ("Sec-WebSocket-Key", "dGhlIHNhbXBsZSBub25jZQ=="),
];

#[test]
fn whoever_comes_from_elsewhere_is_refused_at_every_endpoint() {
    let served = Served::begin("shear", &["--until", "1h"]);
    for path in ["/", "/page.js", "/api/session", "/api/live", "/nowhere"] {
        let foreign: [&[(&str, &str)]; 4] = [
            &[("Host", "evil.example")],
            &[("Origin", "http://evil.example")],
            &[("Origin", "null")],
            &[("Host", "evil.example:80"), ("Origin", "http://evil.example:80")],
        ];
        for headers in foreign {
            let (status, body) = served.get(path, &[LIVE, headers].concat());
            assert_eq!(status, "HTTP/1.1 403 Forbidden", "{path} {headers:?}: {body}");
        }
    }
    let (status, session) = served.get("/api/session", &[]);
    assert!(status.contains("200"), "{status}");
    let session: Value = serde_json::from_str(&session).expect("JSON");
    assert_eq!((&session["protocol"], &session["scenario"]), (&json!(1), &json!("shear")));
    assert!(session["bodies"].as_array().is_some_and(|bodies| bodies.len() > 3));
    // The trends begin with what the scenario plots.
    let plotted = session["plot"].as_array().expect("a list").iter().map(|place| {
        let place = usize::try_from(place.as_u64().expect("a place")).expect("few signals");
        session["signals"][place]["name"].clone()
    });
    assert_eq!(plotted.collect::<Vec<_>>(), [json!("Position_1"), json!("Aligned"), json!("AlignedCount")]);
    // without an upgrade there is nothing to be seen
    assert!(served.get("/api/live", &[]).0.contains("400"));
    let mut viewer = served.view();
    ask(&mut viewer, &json!({"type": "operate", "operation": "stop"}));
    assert_eq!(served.report()["status"], "stopped");
}

#[test]
fn other_machines_are_not_served() {
    let said = typed(&scenario("shear"), &["run", ".", "--web=0.0.0.0:0"]);
    assert_eq!(said.code, Some(2), "{said:?}");
    assert!(said.err.contains("for browsers of this machine only") && said.err.contains("ssh -L"), "{said:?}");
}

/// Viewers that read, that never read, that send garbage: the digest is that of a run that nobody saw.
#[test]
fn viewers_leave_no_trace() {
    let plain = typed(&scenario("shear"), &["run", ".", "--format", "json", "--until", "3s"]);
    let plain: Value = serde_json::from_str(&plain.out).expect("a report");
    let served = Served::begin("shear", &["--until", "3s", "--pace", "2"]);
    let mut viewers: Vec<WebSocket<TcpStream>> = (0..4).map(|_| served.view()).collect();
    let garbage = [
        json!("text"),
        json!({"type": "subscribe", "signals": [99_999]}),
        json!({"type": "subscribe"}),
        json!({"type": "write", "signal": 0, "value": 1.0}),
        json!({"type": "write", "signal": 0, "value": 1.0, "more": 1}),
        json!({"type": "fail", "component": "nobody", "failure": "stuck", "active": true}),
        json!({"type": "seat", "panel": "nowhere", "take": true}),
        json!({"type": "show", "t_ns": -1}),
    ];
    for what in &garbage {
        ask(&mut viewers[0], what);
        let error = received(&mut viewers[0], "error");
        assert!(error["message"].as_str().is_some_and(|message| message.len() > 10), "{what}: {error}");
    }
    viewers[0].send(Message::binary(vec![0; 1000])).expect("sent");
    received(&mut viewers[0], "error");
    ask(&mut viewers[1], &json!({"type": "subscribe", "signals": [0, 1, 2]}));
    // a message that is too long ends the viewer, and nobody else
    let too_long = Message::text(" ".repeat(200_000));
    let _refused = viewers[2].send(too_long);
    let end = loop {
        let status = received(&mut viewers[1], "status");
        if status["state"] == "end" {
            break status;
        }
    };
    let report = served.report();
    assert_eq!(report["digest"], plain["digest"]);
    assert_eq!(end["digest"], plain["digest"], "the page shows the digest of the run");
}

/// What a page writes is an operator's input: in the recording, and repeated to the digest. It needs the seat.
#[test]
fn what_a_page_writes_is_repeated_to_the_same_digest() {
    let folder = tempfile::tempdir().expect("a folder");
    let live = folder.path().join("live");
    let live = live.to_str().expect("UTF-8");
    let served = Served::begin("rotary-kiln/thesis.toml", &["--until", "1h", "--pace", "20", "--record", live]);
    let session: Value = serde_json::from_str(&served.get("/api/session", &[]).1).expect("JSON");
    let signals = session["signals"].as_array().expect("a list");
    let speed = signals.iter().position(|signal| signal["name"] == "Speed").expect("a signal");
    assert_eq!(session["panels"][0]["elements"][0]["kind"], "slider", "what operators write is on a panel");

    let (mut one, mut other) = (served.view(), served.view());
    let write = json!({"type": "write", "signal": speed, "value": 200.0});
    ask(&mut one, &write);
    assert!(received(&mut one, "error")["message"].as_str().is_some_and(|message| message.contains("seat")));
    let seat = json!({"type": "seat", "panel": "operator", "take": true});
    ask(&mut one, &seat);
    while received(&mut one, "status")["seat"]["operator"] != "mine" {}
    ask(&mut other, &seat);
    assert!(received(&mut other, "error")["message"].as_str().is_some_and(|message| message.contains("somebody else")));
    ask(&mut one, &json!({"type": "subscribe", "signals": [speed]}));
    assert_eq!(shown(&mut one).1, 60.0);
    ask(&mut one, &write);
    let (t_ns, value) = shown(&mut one);
    assert!(value == 200.0 && t_ns > 0, "{t_ns} {value}");
    ask(&mut one, &json!({"type": "fail", "component": "kiln", "failure": "sliding", "active": true}));
    ask(&mut one, &json!({"type": "operate", "operation": "hold"}));
    while received(&mut one, "status")["state"] != "hold" {}
    ask(&mut one, &json!({"type": "operate", "operation": "step"}));
    ask(&mut one, &json!({"type": "operate", "operation": "stop"}));
    let report = served.report();
    assert_eq!(report["status"], "stopped");

    let words = ["run", "thesis.toml", "--format", "json", "--until", "1h", "--replay-operator", live];
    let again = typed(&scenario("rotary-kiln"), &words);
    let again: Value = serde_json::from_str(&again.out).expect("a report");
    assert_eq!((&again["digest"], &again["steps"]), (&report["digest"], &report["steps"]));
}

/// A client that nobody programs: people do what it would have done.
#[test]
fn people_stand_in_for_a_client() {
    let words = ["run", ".", "--format", "json", "--until", "2s", "--operator", "panel"];
    let said = typed(&scenario("filling-machine"), &words);
    let report: Value = serde_json::from_str(&said.out).expect("a report");
    assert_eq!(report["status"], "completed", "{said:?}");
    let unknown = typed(&scenario("filling-machine"), &["run", ".", "--operator", "pannel"]);
    assert!(unknown.code == Some(2) && unknown.err.contains("did you mean"), "{unknown:?}");
}

/// What lies behind a panel is a file of the scenario, and one that a browser shows.
#[test]
fn a_picture_lies_behind_a_panel() {
    let served = Served::begin("filling-machine", &["--until", "1h"]);
    let session: Value = serde_json::from_str(&served.get("/api/session", &[]).1).expect("JSON");
    assert_eq!(session["panels"][0]["picture"], Value::Null);
    assert_eq!(session["panels"][1]["picture"], "api/panel/0");
    let (head, picture) = served.request("GET", "/api/panel/0", &[], "");
    assert!(head.contains("200 OK") && head.contains("content-type: image/svg+xml"), "{head}");
    let file = scenario("filling-machine").join("monitor.svg");
    assert_eq!(picture, std::fs::read_to_string(file).expect("the picture"));
    for other in ["/api/panel/1", "/api/panel/x", "/api/panel/-1"] {
        assert!(served.get(other, &[]).0.contains("404"), "{other}");
    }
    let mut viewer = served.view();
    ask(&mut viewer, &json!({"type": "operate", "operation": "stop"}));
    assert_eq!(served.report()["status"], "stopped");
    // a recording is shown and run again from its own files
    let record = tempfile::tempdir().expect("a folder");
    let folder = record.path().join("out");
    let words = ["run", ".", "--until", "1s", "--record", folder.to_str().expect("UTF-8")];
    assert_eq!(typed(&scenario("filling-machine"), &words).code, Some(0));
    assert!(folder.join("run-1/scenario/monitor.svg").exists(), "the picture is recorded");
}

#[test]
fn what_is_not_a_picture_is_refused() {
    let shear = crate::typed::copied_shear();
    let panel = "\n[[panel]]\nname = \"desk\"\npicture = \"plant.toml\"\nelement = []\n";
    let file = shear.path().join("scenario.toml");
    let text = std::fs::read_to_string(&file).expect("a scenario") + panel;
    std::fs::write(&file, &text).expect("writable");
    let said = typed(shear.path(), &["check", "."]);
    assert!(
        said.code == Some(2) && said.err.contains("`plant.toml` is not a picture that a browser shows"),
        "{said:?}"
    );
    assert!(said.err.contains("PNG, JPEG or SVG") && said.err.contains("picture = \"plant.toml\""), "{said:?}");
    std::fs::write(&file, text.replace("picture = \"plant.toml\"", "picture = \"desk.png\"")).expect("writable");
    let said = typed(shear.path(), &["check", "."]);
    assert!(said.code == Some(2) && said.err.contains("desk.png"), "{said:?}");
}
