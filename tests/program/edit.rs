//! `onescan edit`: files are written as a person would have written them, nobody else's change is lost, and nobody from
//! elsewhere comes in.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::{Path, PathBuf};
use std::process::Child;

use serde_json::{Value, json};

use crate::typed::{begun, typed};

/// An editor that is served; it ends with the test.
struct Editor {
    program: Child,
    address: String,
    folder: tempfile::TempDir,
}

impl Drop for Editor {
    fn drop(&mut self) {
        self.program.kill().expect("it serves until it is ended");
        self.program.wait().expect("it ends");
    }
}

impl Editor {
    /// The editor of a new scenario, whose program calls a variable otherwise.
    fn begin(template: &str) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let said = typed(folder.path(), &["new", "mine", "--template", template]);
        assert_eq!(said.code, Some(0), "{said:?}");
        let source = folder.path().join("mine/plc/main.st");
        let text = std::fs::read_to_string(&source).expect("a source");
        std::fs::write(&source, text.replace("Box_There", "Box_Seen")).expect("writable");
        let mut program = begun(folder.path(), &["edit", "mine"]);
        let mut said = BufReader::new(program.stderr.take().expect("piped"));
        let mut line = String::new();
        while !line.contains("http://") {
            line.clear();
            assert_ne!(said.read_line(&mut line).expect("text"), 0, "no editor");
        }
        let address = line.split("http://").nth(1).and_then(|rest| rest.split('/').next()).expect("an address");
        Self { program, address: address.to_owned(), folder }
    }

    fn file(&self, name: &str) -> PathBuf {
        self.folder.path().join("mine").join(name)
    }

    fn text(&self, name: &str) -> String {
        std::fs::read_to_string(self.file(name)).expect("a file")
    }

    /// The status and the body of an answer.
    fn send(&self, method: &str, path: &str, headers: &[(&str, &str)], body: &str) -> (u32, String) {
        let mut stream = TcpStream::connect(&self.address).expect("served");
        let has_host = headers.iter().any(|(name, _)| *name == "Host");
        let host = [("Host", self.address.as_str())];
        let all = host.iter().filter(|_| !has_host).chain(headers);
        let lines: String = all.flat_map(|(name, value)| [name, ": ", value, "\r\n"]).collect();
        let length = body.len();
        let request =
            format!("{method} {path} HTTP/1.1\r\nConnection: close\r\nContent-Length: {length}\r\n{lines}\r\n{body}");
        stream.write_all(request.as_bytes()).expect("writable");
        let mut answer = Vec::new();
        stream.read_to_end(&mut answer).expect("an answer");
        let answer = String::from_utf8_lossy(&answer).into_owned();
        let (head, body) = answer.split_once("\r\n\r\n").expect("a head");
        (head.split(' ').nth(1).and_then(|code| code.parse().ok()).expect("a status"), body.to_owned())
    }

    fn look(&self) -> Value {
        serde_json::from_str(&self.send("GET", "/api/edit", &[], "").1).expect("JSON")
    }

    fn want(&self, want: &Value) -> (u32, Value) {
        let (status, body) = self.send("POST", "/api/edit", &[], &want.to_string());
        (status, serde_json::from_str(&body).expect("JSON"))
    }
}

fn diff(before: &str, after: &str) -> String {
    let diff = similar::TextDiff::from_lines(before, after);
    let changes = diff.iter_all_changes().filter(|change| change.tag() != similar::ChangeTag::Equal);
    changes.flat_map(|change| [change.tag().to_string(), change.to_string()]).collect()
}

fn join(revision: u64, one: &Value, other: &Value) -> Value {
    json!({"want": "join", "revision": revision, "one": one, "other": other})
}

#[test]
fn a_connection_that_is_drawn_is_one_line_and_what_the_command_line_says() {
    let editor = Editor::begin("cell");
    let before = editor.text("scenario.toml");
    let wiring = typed(editor.folder.path(), &["wiring", "mine", "--format", "json"]);
    let by_command: Value = serde_json::from_str(&wiring.out).expect("JSON");
    let state = editor.look();
    assert_eq!(state["map"], by_command, "the page shows the wiring of the command line");
    let seen = json!({"client": "plc", "at": "Main.Box_Seen"});
    let barrier = json!({"client": "plant", "at": "barrier.detected"});
    let (status, answer) = editor.want(&join(0, &barrier, &seen));
    assert_eq!(status, 200, "{answer}");
    let line = "+bind = { Box_There = \"Main.Box_Seen\" }\n";
    assert_eq!(diff(&before, &editor.text("scenario.toml")), line);
    let run = typed(editor.folder.path(), &["run", "mine"]);
    assert_eq!(run.code, Some(0), "{run:?}");
    // taken back to the byte, and done again
    assert_eq!(editor.want(&json!({"want": "undo", "revision": 1})).0, 200);
    assert_eq!(editor.text("scenario.toml"), before);
    assert_eq!(editor.want(&json!({"want": "redo", "revision": 2})).0, 200);
    assert_eq!(diff(&before, &editor.text("scenario.toml")), line);
    // an end is let go by the same line
    let (status, answer) = editor.want(&json!({"want": "part", "revision": 3, "tip": seen}));
    assert_eq!(status, 200, "{answer}");
    assert_eq!(editor.text("scenario.toml"), before);
}

#[test]
fn what_is_wrong_is_reported_with_its_place() {
    let editor = Editor::begin("cell");
    let scene = editor.text("plant.toml");
    let set = |revision: u64, key: &str, value: Value| {
        let edit = json!({"do": "set", "scene": "plant.toml", "sort": "component", "name": "cylinder", "key": key, "value": value});
        json!({"want": "change", "revision": revision, "edits": [edit]})
    };
    let (status, answer) = editor.want(&set(0, "stroke_m", json!(99)));
    assert_eq!(
        (status, &answer["error"]["message"]),
        (422, &json!("`stroke_m` is a number from 0.001 to 10, which 99 is not"))
    );
    assert_eq!(editor.text("plant.toml"), scene);
    let remove = json!({"do": "remove", "scene": "plant.toml", "sort": "body", "name": "belt"});
    let (status, answer) = editor.want(&json!({"want": "change", "revision": 0, "edits": [remove]}));
    assert_eq!((status, &answer["error"]["references"][0]["file"]), (422, &json!("plant.toml")));
    assert_eq!(answer["error"]["references"][0]["by"], "component `conveyor`, belt");
    // what the scene cannot have is written and found, as if it had been typed
    let (status, answer) = editor.want(&set(0, "joint", json!("nothing")));
    assert_eq!(status, 200, "{answer}");
    let line = editor.text("plant.toml").lines().position(|line| line == "joint = \"nothing\"").expect("written") + 1;
    let finding = &answer["state"]["findings"][0];
    assert_eq!((&finding["file"], &finding["line"]), (&json!("plant.toml"), &json!(line)), "{finding}");
    assert_eq!(typed(editor.folder.path(), &["run", "mine"]).code, Some(2));
    assert_eq!(editor.want(&json!({"want": "undo", "revision": 1})).0, 200);
    assert_eq!(editor.text("plant.toml"), scene);
}

#[test]
fn what_somebody_else_has_changed_is_not_written_over() {
    let editor = Editor::begin("cell");
    let path = editor.file("plant.toml");
    let theirs = editor.text("plant.toml").replace("speed_m_s = 0.3", "speed_m_s = 0.25");
    std::fs::write(&path, &theirs).expect("writable");
    let faster = |revision: u64| {
        let edit = json!({"do": "set", "scene": "plant.toml", "sort": "component", "name": "conveyor", "key": "speed_m_s", "value": 0.5});
        json!({"want": "change", "revision": revision, "edits": [edit]})
    };
    let (status, answer) = editor.want(&faster(0));
    assert_eq!((status, &answer["state"]["changed"]), (409, &json!(["plant.toml"])), "{answer}");
    assert_eq!(editor.text("plant.toml"), theirs);
    assert_eq!(editor.want(&json!({"want": "reload"})).0, 200);
    // a page that has not seen that is notified
    assert_eq!(editor.want(&faster(0)).0, 409);
    assert_eq!(editor.want(&faster(1)).0, 200);
    assert_eq!(diff(&theirs, &editor.text("plant.toml")), "-speed_m_s = 0.25\n+speed_m_s = 0.5\n");
}

#[test]
fn whoever_comes_from_elsewhere_is_refused_and_garbage_changes_nothing() {
    let editor = Editor::begin("blank");
    let before = (editor.text("scenario.toml"), editor.text("plant.toml"));
    let endpoints = [
        ("GET", "/"),
        ("GET", "/edit.js"),
        ("GET", "/api/edit"),
        ("POST", "/api/edit"),
        ("GET", "/api/library"),
        ("GET", "/x"),
    ];
    for (method, path) in endpoints {
        let foreign: [&[(&str, &str)]; 4] = [
            &[("Host", "evil.example")],
            &[("Origin", "http://evil.example")],
            &[("Origin", "null")],
            &[("Host", "evil.example:80"), ("Origin", "http://evil.example:80")],
        ];
        for headers in foreign {
            let (status, body) = editor.send(method, path, headers, r#"{"want":"reload"}"#);
            assert_eq!(status, 403, "{method} {path} {headers:?}: {body}");
        }
    }
    let outside = json!({"do": "add", "scene": "../other.toml", "sort": "body", "name": "a", "keys": []});
    let garbage = [
        (String::new(), 400),
        ("{".to_owned(), 400),
        (json!({"want": "everything"}).to_string(), 400),
        (json!({"want": "undo", "revision": 0, "more": 1}).to_string(), 400),
        (json!({"want": "undo", "revision": 0}).to_string(), 422),
        (json!({"want": "undo", "revision": 7}).to_string(), 409),
        (json!({"want": "change", "revision": 0, "edits": [outside]}).to_string(), 422),
        (json!({"want": "join", "revision": 0, "one": {"signal": "x"}, "other": {"signal": "y"}}).to_string(), 422),
    ];
    for (body, expected) in garbage {
        let (status, said) = editor.send("POST", "/api/edit", &[], &body);
        assert_eq!(status, expected, "{} {said}", body.get(..80).unwrap_or(&body));
    }
    assert_eq!((editor.text("scenario.toml"), editor.text("plant.toml")), before);
    let said = typed(Path::new("."), &["edit", ".", "--web", "0.0.0.0:0"]);
    assert!(said.code == Some(2) && said.err.contains("for browsers of this machine only"), "{said:?}");
    let said = typed(editor.folder.path(), &["edit", "nothing"]);
    assert_eq!(said.code, Some(2), "{said:?}");
}

/// A belt, a light barrier and a cylinder, built by requests only, run from the command line.
#[test]
fn what_is_built_runs() {
    let editor = Editor::begin("blank");
    let add = |sort: &str, name: &str, keys: Value| json!({"do": "add", "scene": "plant.toml", "sort": sort, "name": name, "keys": keys});
    let declare =
        |signal: &str, ty: &str, writer: &str| json!({"do": "declare", "signal": signal, "type": ty, "writer": writer});
    let edits = json!([
        add("body", "belt", json!([["kind", "kinematic"], ["shape", "box"], ["size_m", [2, 0.3, 0.1]], ["position_m", [0, 0, -0.05]]])),
        add("body", "parcel", json!([["kind", "dynamic"], ["shape", "box"], ["size_m", [0.1, 0.1, 0.1]], ["position_m", [-0.6, 0, 0.05]], ["mass_kg", 0.5]])),
        add("component", "belt_drive", json!([["kind", "conveyor"], ["belt", "belt"], ["direction", [1, 0, 0]], ["run_signal", "Belt_On"]])),
        add("component", "barrier", json!([["kind", "light_barrier"], ["point_m", [0.36, -0.145, 0.09]], ["direction", [0, 1, 0]], ["detected_signal", "Box_There"]])),
        add("component", "ram", json!([["kind", "pneumatic_cylinder"], ["extend_signal", "Push"], ["extended_signal", "Cylinder_Out"], ["retracted_signal", "Cylinder_In"]])),
        declare("Belt_On", "BOOL", "plc"),
        declare("Push", "BOOL", "plc"),
        declare("Box_There", "BOOL", "plant"),
        declare("Cylinder_Out", "BOOL", "plant"),
        declare("Cylinder_In", "BOOL", "plant"),
        {"do": "connect", "client": "plc", "signal": "Box_There", "variable": "Main.Box_Seen"},
    ]);
    let (status, answer) = editor.want(&json!({"want": "change", "revision": 0, "edits": edits}));
    assert_eq!(status, 200, "{answer}");
    assert_eq!(answer["state"]["findings"], json!([]));
    insta::assert_snapshot!("built_scene", editor.text("plant.toml"));
    insta::assert_snapshot!("built_scenario", editor.text("scenario.toml"));
    let run = typed(editor.folder.path(), &["run", "mine", "--record", "out"]);
    assert_eq!(run.code, Some(0), "{run:?}");
    let csv = typed(
        editor.folder.path(),
        &["export", "out", "-o", "out.csv", "--signals", "Box_There", "--signals", "Cylinder_Out"],
    );
    assert_eq!(csv.code, Some(0), "{csv:?}");
    let table = std::fs::read_to_string(editor.folder.path().join("out.csv")).expect("a table");
    let seen: Vec<&str> = table.lines().skip(1).collect();
    let has = |column: usize| {
        let values: std::collections::BTreeSet<&str> =
            seen.iter().filter_map(|line| line.split(',').nth(column)).collect();
        values.len()
    };
    assert_eq!((has(1), has(2)), (2, 2), "the barrier switches and the cylinder moves");
}
