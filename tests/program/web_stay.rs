//! `run --web` waits for its viewer and stays when the run is over, where somebody sits who looks.

use std::path::Path;
use std::process::{Command, Output};

use serde_json::{Value, json};

use crate::typed::{onescan, scenario, typed};
use crate::web::{Served, ask, received, view};

/// The first status in this state.
fn status(viewer: &mut tungstenite::WebSocket<std::net::TcpStream>, state: &str) -> Value {
    loop {
        let status = received(viewer, "status");
        if status["state"] == state {
            return status;
        }
    }
}

fn digest(until: &str) -> Value {
    let ran = typed(&scenario("shear"), &["run", ".", "--format", "json", "--until", until]);
    let report: Value = serde_json::from_str(&ran.out).expect("a report");
    report["digest"].clone()
}

#[test]
fn what_is_over_is_looked_back_at_and_gone_on_from() {
    let served = Served::begin("shear", &["--until", "1s", "--pace", "max", "--await-viewer", "--stay"]);
    let mut viewer = served.view();
    let mut end = status(&mut viewer, "end");
    // The past is run again behind the session: statuses before it has all of it show how far it is.
    while end["past_ns"] != json!([0, 1_000_000_000]) {
        end = status(&mut viewer, "end");
    }
    assert_eq!(end["digest"], digest("1s"));

    ask(&mut viewer, &json!({"type": "show", "t_ns": 500_000_000}));
    // A status that was on its way before shows the moment before.
    while status(&mut viewer, "end")["shown_ns"] != 500_000_000 {}
    ask(&mut viewer, &json!({"type": "operate", "operation": "go"}));
    let refused = received(&mut viewer, "error");
    assert_eq!(refused["message"], "the session is over: look back, or let another go on from one of its moments");

    ask(&mut viewer, &json!({"type": "fork", "t_ns": 1_000_000_000, "until_ns": 1_000_000_000}));
    let refused = received(&mut viewer, "error");
    assert_eq!(refused["message"], "a session that goes on from 1.000 s cannot end at 1000000000 ns");
    ask(&mut viewer, &json!({"type": "fork", "t_ns": 1_000_000_000, "until_ns": 2_000_000_000_u64}));
    let url = received(&mut viewer, "forked")["url"].as_str().expect("a link").to_owned();
    let mut fork = view(url.trim_start_matches("http://").trim_end_matches('/'));
    assert_eq!(status(&mut fork, "end")["digest"], digest("2s"), "it goes on beyond the end");
    drop(fork);

    ask(&mut viewer, &json!({"type": "operate", "operation": "stop"}));
    let report = served.report();
    assert_eq!((&report["status"], &report["digest"]), (&json!("completed"), &end["digest"]));
}

#[test]
fn without_a_terminal_the_page_ends_with_its_last_viewer() {
    let served = Served::begin("shear", &["--until", "100ms", "--pace", "max", "--await-viewer", "--stay"]);
    let mut viewer = served.view();
    status(&mut viewer, "end");
    drop(viewer);
    assert_eq!(served.report()["status"], "completed");
}

/// Types a command on a terminal of its own, and Ctrl-C once `text` has been printed.
#[cfg(target_os = "linux")]
fn interrupted_after(text: &str, words: &[&str]) -> Output {
    const TERMINAL: &str = "
import os, pty, sys
text, words = sys.argv[1].encode(), sys.argv[2:]
child, terminal = pty.fork()
if child == 0:
    os.execv(words[0], words)
said = b''
while True:
    try:
        more = os.read(terminal, 65536)
    except OSError:
        break
    if not more:
        break
    before, said = said, said + more
    if text in said and text not in before:
        os.write(terminal, b'\\x03')
print(said.decode(errors='replace'))
sys.exit(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
";
    let mut python = Command::new("python3");
    python.args(["-c", TERMINAL, text]).arg(onescan(Path::new(".")).get_program()).args(words);
    python.current_dir(scenario("shear")).env_remove("CI").env("NO_COLOR", "1").output().expect("python3")
}

#[cfg(target_os = "linux")]
#[test]
fn on_a_terminal_it_waits_and_stays() {
    let waited = interrupted_after("it begins when the page is opened", &["run", ".", "--web"]);
    assert_eq!(waited.status.code(), Some(130), "{waited:?}");
    let words = ["run", ".", "--web", "--no-await-viewer", "--pace", "max", "--until", "100ms"];
    let stayed = interrupted_after("the run is over; its page stays at", &words);
    assert_eq!(stayed.status.code(), Some(0), "the run came to its own end: {stayed:?}");
    let said = String::from_utf8_lossy(&stayed.stdout).into_owned();
    assert!(said.contains("digest"), "the report comes before: {said}");
    let words = [&words[..], &["--no-stay"]].concat();
    let ended = interrupted_after("this is not said", &words);
    assert_eq!(ended.status.code(), Some(0), "{ended:?}");
}
