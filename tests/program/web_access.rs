//! `run --web --access`: nobody gets in without a token, from another origin, or beyond what a token is good for.

use std::io::{Read, Write};
use std::net::TcpStream;
use std::path::Path;

use serde_json::json;
use tungstenite::WebSocket;
use tungstenite::client::IntoClientRequest;

use crate::training::Lesson;
use crate::typed::{scenario, typed, utf8};
use crate::web::{LIVE, Served, ask, received};

/// A folder with a token of each role; gives the tokens.
fn tokens(folder: &Path, roles: &[&str]) -> Vec<String> {
    let folder = folder.to_str().expect("UTF-8");
    let token = |role: &&str| {
        let name = role.replace(':', ".");
        let said = typed(&scenario("shear"), &["token", "new", &name, "--role", role, "--access", folder]);
        assert_eq!(said.code, Some(0), "{said:?}");
        said.out.trim().to_owned()
    };
    roles.iter().map(token).collect()
}

fn begin(folder: &Path) -> Served {
    Served::begin("filling-machine", &["--until", "1h", "--access", folder.to_str().expect("UTF-8")])
}

fn view_with(served: &Served, header: (&'static str, &str)) -> WebSocket<TcpStream> {
    view_at(&served.address, header)
}

fn view_at(address: &str, header: (&'static str, &str)) -> WebSocket<TcpStream> {
    let stream = TcpStream::connect(address).expect("served");
    let mut request = format!("ws://{address}/api/live").into_client_request().expect("a request");
    request.headers_mut().insert(header.0, header.1.parse().expect("a header"));
    tungstenite::client(request, stream).expect("a viewer").0
}

/// The number of an answer's status.
fn status(served: &Served, path: &str, headers: &[(&str, &str)]) -> String {
    let (status, _) = served.get(path, headers);
    status.split(' ').nth(1).expect("a number").to_owned()
}

/// The table of docs/security.md: each endpoint, tried by each who may come.
#[test]
fn every_endpoint_asks_who_comes() {
    let folder = tempfile::tempdir().expect("a folder");
    let made = tokens(folder.path(), &["viewer", "operator", "trainer", "client:plant"]);
    let served = begin(folder.path());
    let bearer: Vec<String> = made.iter().map(|token| format!("Bearer {token}")).collect();
    let wrong = format!("Bearer onescan_{}", "0".repeat(64));
    let comers: [(&str, Vec<(&str, &str)>); 8] = [
        ("no token", vec![]),
        ("a wrong token", vec![("Authorization", wrong.as_str())]),
        ("a wrong cookie", vec![("Cookie", "onescan_80=x")]),
        ("a client's token", vec![("Authorization", bearer[3].as_str())]),
        (
            "an operator's from another origin",
            vec![("Authorization", bearer[1].as_str()), ("Origin", "http://evil.example")],
        ),
        ("a viewer's token", vec![("Authorization", bearer[0].as_str())]),
        ("an operator's token", vec![("Authorization", bearer[1].as_str())]),
        ("a trainer's token", vec![("Authorization", bearer[2].as_str())]),
    ];
    let mut table = String::new();
    for (who, headers) in comers {
        let answers =
            ["/", "/page.js", "/page.css", "/api/session", "/api/live", "/api/panel/0", "/nowhere"].map(|path| {
                let with: Vec<(&str, &str)> =
                    if path == "/api/live" { [LIVE, &headers[..]].concat() } else { headers.clone() };
                // an upgraded connection stays open, so it is tried apart
                if path == "/api/live" && who.ends_with("s token") && !who.starts_with("a client") {
                    return format!("{path} 101");
                }
                // without the page there is none to be had
                let status = status(&served, path, &with);
                let is_page = matches!(path, "/" | "/page.js" | "/page.css");
                format!("{path} {}", if status == "404" && is_page { "200" } else { status.as_str() })
            });
        table.extend([who, ": ", answers.join(", ").as_str(), "\n"]);
    }
    insta::assert_snapshot!("web_access", table);
    for token in &bearer[..3] {
        let mut viewer = view_with(&served, ("authorization", token));
        received(&mut viewer, "status");
    }
    let mut operator = view_with(&served, ("authorization", &bearer[1]));
    ask(&mut operator, &json!({"type": "operate", "operation": "stop"}));
    assert_eq!(served.report()["status"], "stopped");
}

#[test]
fn a_token_is_typed_once_and_a_viewer_changes_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let made = tokens(folder.path(), &["viewer", "operator"]);
    let served = begin(folder.path());
    let log_in = |token: &str| served.request("POST", "/api/login", &[], &format!("token={token}"));
    assert!(served.get("/", &[]).1.contains("<form method=\"post\""), "a person is asked for the token");
    let (refused, form) = log_in("onescan_<b>");
    assert!(refused.contains(" 401 ") && !refused.contains("set-cookie") && form.contains("role=\"alert\""));
    let foreign =
        served.request("POST", "/api/login", &[("Origin", "http://evil.example")], &format!("token={}", made[1]));
    assert!(foreign.0.contains(" 403 ") && !foreign.0.contains("set-cookie"));
    let cookie = |token: &str| {
        let (head, _) = log_in(token);
        assert!(head.contains(" 303 ") && head.contains("HttpOnly; SameSite=Strict"), "{head}");
        let line = head.lines().find(|line| line.starts_with("set-cookie: ")).expect("a cookie");
        line.trim_start_matches("set-cookie: ").split(';').next().expect("a pair").to_owned()
    };
    let (looks, operates) = (cookie(&made[0]), cookie(&made[1]));
    assert!(status(&served, "/api/session", &[("Cookie", &looks)]) == "200");
    assert!(status(&served, "/api/session", &[("Cookie", &looks), ("Origin", "null")]) == "403");
    let mut viewer = view_with(&served, ("cookie", &looks));
    let refused = [
        json!({"type": "operate", "operation": "stop"}),
        json!({"type": "write", "signal": 0, "value": 1}),
        json!({"type": "force", "signal": 0, "value": "TRUE"}),
        json!({"type": "variable", "variable": 0, "action": "write", "value": "1"}),
        json!({"type": "fail", "component": "x", "failure": "y", "active": true}),
        json!({"type": "seat", "panel": "x", "take": true}),
        json!({"type": "fork", "t_ns": 0}),
    ];
    for what in &refused {
        ask(&mut viewer, what);
        let message = received(&mut viewer, "error")["message"].as_str().expect("a text").to_owned();
        assert!(message.contains("lets its holder look"), "{what}: {message}");
    }
    ask(&mut viewer, &json!({"type": "subscribe", "signals": [0]}));
    let mut operator = view_with(&served, ("cookie", &operates));
    ask(&mut operator, &json!({"type": "operate", "operation": "stop"}));
    assert_eq!(served.report()["status"], "stopped");
}

#[test]
fn beyond_this_machine_a_certificate_is_needed_too() {
    let folder = tempfile::tempdir().expect("a folder");
    tokens(folder.path(), &["viewer"]);
    let access = folder.path().to_str().expect("UTF-8");
    let said = typed(&scenario("shear"), &["run", ".", "--web=0.0.0.0:0", "--access", access]);
    assert!(said.code == Some(2) && said.err.contains("there is no certificate"), "{said:?}");
}

/// The trainee has an operator's token, with which he does not come into the trainer's page.
#[test]
fn a_trainee_does_not_see_the_trainers_page() {
    let folder = tempfile::tempdir().expect("a folder");
    let made = tokens(folder.path(), &["operator", "trainer"]);
    let starts = folder.path().join("starts");
    let words = ["three-malfunctions", "--starts", utf8(&starts), "--pace", "20", "--access", utf8(folder.path())];
    let lesson = Lesson::begin(&words);
    let bearer: Vec<String> = made.iter().map(|token| format!("Bearer {token}")).collect();
    let status = |page: usize, token: Option<&String>| {
        let mut stream = TcpStream::connect(&lesson.pages[page]).expect("served");
        let head = format!("GET /api/session HTTP/1.1\r\nHost: {}\r\nConnection: close\r\n", lesson.pages[page]);
        let shown = token.map(|token| format!("Authorization: {token}\r\n")).unwrap_or_default();
        stream.write_all(format!("{head}{shown}\r\n").as_bytes()).expect("sent");
        let mut answer = String::new();
        stream.read_to_string(&mut answer).expect("an answer");
        answer.split(' ').nth(1).expect("a status").to_owned()
    };
    let (operator, trainer) = (Some(&bearer[0]), Some(&bearer[1]));
    assert_eq!([0, 1].map(|page| status(page, None)), ["401", "401"]);
    assert_eq!([0, 1].map(|page| status(page, operator)), ["200", "403"]);
    assert_eq!([0, 1].map(|page| status(page, trainer)), ["200", "200"]);
    let mut viewer = view_at(&lesson.pages[1], ("authorization", &bearer[1]));
    ask(&mut viewer, &json!({"type": "operate", "operation": "stop"}));
    assert_eq!(lesson.record()["attempts"][0]["end"], "stopped");
}
