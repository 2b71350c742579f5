//! `start` of a scenario: virtual time stands until it holds, and no step is another one for that.

use std::io::{BufRead, BufReader};
use std::path::Path;

use crate::typed::{Said, begun, copied, digests, edit, typed};

fn report(said: &Said) -> serde_json::Value {
    serde_json::from_str(said.out.trim()).unwrap_or_else(|_| panic!("{said:?}"))
}

fn run(folder: &Path, words: &[&str]) -> Said {
    typed(folder, &[&["run", ".", "--format", "json", "--until", "2s"], words].concat())
}

/// The furnace, which starts when this holds.
fn furnace(start: &str) -> tempfile::TempDir {
    let folder = copied("arc-furnace");
    edit(folder.path(), "scenario.toml", "version = 1\n", &format!("version = 1\nstart = \"{start}\"\n"));
    folder
}

#[test]
fn what_holds_at_once_changes_nothing() {
    let plain = report(&run(copied("arc-furnace").path(), &[]));
    let started = report(&run(furnace("Heat_start and not Emergency_stop").path(), &[]));
    assert_eq!(digests(&[started]), digests(&[plain]));
}

/// An operator's switch starts it, and what was recorded is repeated without anybody.
#[test]
fn an_operator_starts_it() {
    let folder = furnace("Page = 1");
    let words = ["run", ".", "--format", "json", "--until", "2s", "--listen", "127.0.0.1:0", "--record", "record"];
    let mut server = begun(folder.path(), &words);
    let mut said = BufReader::new(server.stderr.take().expect("piped"));
    let mut until = |what: &str| {
        let mut line = String::new();
        while !line.contains(what) {
            line.clear();
            assert_ne!(said.read_line(&mut line).expect("text"), 0, "it has ended");
        }
        line
    };
    let listening = until("listening at ");
    let address = listening.split("listening at ").nth(1).and_then(|rest| rest.split(' ').next()).expect("an address");
    until("the session starts when this holds: Page = 1");
    let control = |words: &[&str]| typed(folder.path(), &[&["control", address], words].concat());
    assert_eq!(control(&[]).out, "held in state initial-write after step 0, t_v = 0.000 s\n");
    assert_eq!(control(&["resume"]).out, "held in state initial-write after step 0, t_v = 0.000 s\n");
    let written = control(&["write", "Page", "1"]);
    assert_eq!(written.code, Some(0), "{written:?}");
    let ended = Said::from(server.wait_with_output().expect("it ends"));
    let started = digests(&[report(&ended)]);
    let again = run(folder.path(), &["--replay-operator", "record/run-1"]);
    assert_eq!(digests(&[report(&again)]), started);
    // The same write without the logic is the same session.
    let plain = copied("arc-furnace");
    let recorded = folder.path().join("record/run-1");
    let plain = run(plain.path(), &["--replay-operator", recorded.to_str().expect("text")]);
    assert_eq!(digests(&[report(&plain)]), started);
}

#[test]
fn what_nobody_can_start_is_said() {
    let folder = furnace("Page = 1");
    let nobody = run(folder.path(), &[]);
    let unknown = run(furnace("Pag = 1").path(), &[]);
    let past = run(furnace("once Page = 1").path(), &[]);
    let all = [nobody, unknown, past];
    assert!(all.iter().all(|said| said.code == Some(2)), "{all:?}");
    insta::assert_snapshot!(all.map(|said| said.err).join("----\n"));
}
