//! `onescan plc` in a process of its own, and sessions that drive it in lockstep.

use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Stdio};

use crate::typed::{Said, digests, edit, onescan, run_shear, scenario, typed};

/// A PLC that runs, until it is dropped.
pub(crate) struct Plc {
    child: Child,
    commands: ChildStdin,
    answers: BufReader<ChildStdout>,
    urls: Vec<String>,
}

impl Plc {
    /// `onescan plc` in `folder` with more words.
    pub(crate) fn start(folder: &Path, words: &[&str]) -> Self {
        Self::start_with(folder, words, "ONESCAN_OPCUA_PASSWORD", "")
    }

    /// The same with an environment variable.
    pub(crate) fn start_with(folder: &Path, words: &[&str], variable: &str, value: &str) -> Self {
        let mut command = onescan(folder);
        command.env(variable, value);
        command.args(["plc", "."]).args(words).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::null());
        let mut child = command.spawn().expect("the program starts");
        let commands = child.stdin.take().expect("piped");
        let answers = BufReader::new(child.stdout.take().expect("piped"));
        let mut plc = Self { child, commands, answers, urls: Vec::new() };
        loop {
            let line = plc.line();
            match line.strip_prefix("serving ") {
                Some(url) => plc.urls.push(url.to_owned()),
                None if line.starts_with("connecting to ") => {}
                None => break,
            }
        }
        plc
    }

    fn line(&mut self) -> String {
        let mut line = String::new();
        self.answers.read_line(&mut line).expect("it speaks");
        assert!(!line.is_empty(), "the PLC has ended");
        line.trim_end().to_owned()
    }

    /// Where it serves a protocol, as `--gateway` takes it.
    pub(crate) fn gateway(&self, scheme: &str) -> String {
        self.gateway_of("plc", scheme)
    }

    /// The same for a client of another name.
    pub(crate) fn gateway_of(&self, client: &str, scheme: &str) -> String {
        let url = self.urls.iter().find(|url| url.starts_with(scheme)).expect("it serves this");
        format!("{client}={url}")
    }

    /// Types a command and gives the answer.
    pub(crate) fn say(&mut self, command: &str) -> String {
        writeln!(self.commands, "{command}").expect("it listens");
        self.line()
    }
}

impl Drop for Plc {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// The shear for 2 s with a PLC in another process.
fn run_with(gateway: &str, words: &[&str]) -> (Vec<serde_json::Value>, Said) {
    run_shear(&[&["--until", "2s", "--gateway", gateway], words].concat())
}

fn in_process() -> String {
    let (reports, _) = run_shear(&["--until", "2s"]);
    digests(&reports).remove(0)
}

/// The PLC's cycle is not the session's business.
#[test]
fn the_cycle_of_the_plc_does_not_matter() {
    let expected = in_process();
    for cycle in ["max", "3ms"] {
        let plc = Plc::start(&scenario("shear"), &["--cycle", cycle]);
        let (reports, said) = run_with(&plc.gateway("tcp://"), &[]);
        assert_eq!(digests(&reports), std::slice::from_ref(&expected), "{cycle}: {said:?}");
    }
}

#[test]
fn the_switch_and_starts_are_obeyed() {
    let mut plc = Plc::start(&scenario("shear"), &[]);
    assert!(plc.say("status").starts_with("RUN, start 1, "));
    assert!(plc.say("stop").starts_with("STOP, start 1, "));
    assert!(plc.say("cold").starts_with("RUN, start 2, "));
    assert!(plc.say("warm").starts_with("RUN, start 3, "));
    assert_eq!(plc.say("statsu"), "no command `statsu`; did you mean `status`?");
    writeln!(plc.commands, "quit").unwrap();
    assert_eq!(plc.child.wait().unwrap().code(), Some(0));
}

/// What the PLC's operator does in mid-session, by name.
#[test]
fn a_plc_in_stop_and_a_restarted_one_are_distinguished() {
    let folder = crate::typed::copied_shear();
    edit(folder.path(), "scenario.toml", "system_words = true", "system_words = true\ngrant_timeout = \"2s\"");
    for (command, name) in [("stop", "the PLC is in STOP: grant "), ("cold", "the PLC was restarted in mid-session")] {
        let mut plc = Plc::start(folder.path(), &[]);
        let gateway = plc.gateway("tcp://");
        let words = ["run", ".", "--format", "json", "--pace", "1", "--until", "1h", "--gateway", &gateway];
        let mut run = onescan(folder.path()).args(words).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        // A PLC that is started before its first grant joins again, and nothing is lost.
        let is_under_way = |status: &str| status.contains("in session") && !status.contains("with 0 grants");
        while !is_under_way(&plc.say("status")) {
            assert!(matches!(run.try_wait(), Ok(None)), "it has ended before the session began");
        }
        plc.say(command);
        let said = Said::from(run.wait_with_output().unwrap());
        assert_eq!(said.code, Some(3), "{said:?}");
        assert!(said.out.contains(name), "{said:?}");
    }
}

#[test]
fn a_plc_that_is_not_there_is_unreachable() {
    let folder = crate::typed::copied_shear();
    edit(folder.path(), "scenario.toml", "system_words = true", "system_words = true\nreconnect_timeout = \"1s\"");
    let said = typed(folder.path(), &["run", ".", "--gateway", "plc=tcp://127.0.0.1:1"]);
    assert_eq!(said.code, Some(3), "{said:?}");
    assert!(said.err.contains("unreachable: tcp://127.0.0.1:1"), "{said:?}");
    assert_eq!(said.err.matches("; trying again for 1s").count(), 1, "reported once: {said:?}");
    assert!(said.err.contains(" times in 1s"), "{said:?}");
    let reported = |gateway: &str| typed(&scenario("shear"), &["run", ".", "--gateway", gateway]);
    let all = [reported("plc=tpc://127.0.0.1:1"), reported("plc=127.0.0.1"), reported("plant"), reported("plx")];
    assert!(all.iter().all(|said| said.code == Some(2)), "{all:?}");
    let text: Vec<String> = all.into_iter().map(|said| said.err).collect();
    insta::assert_snapshot!(text.join("----\n"));
}

/// Where the scenario says that the PLC has no words about itself, somebody must start it between two sessions, as a real one.
#[test]
fn a_plc_that_nobody_starts_is_waited_for() {
    let folder = crate::typed::copied_shear();
    edit(folder.path(), "scenario.toml", "system_words = true", "system_words = false");
    let mut plc = Plc::start(folder.path(), &[]);
    let gateway = plc.gateway("s7://");
    let words = ["run", ".", "--format", "json", "--until", "200ms", "--gateway", &gateway];
    let first = typed(folder.path(), &words);
    assert_eq!(first.code, Some(0), "{first:?}");
    let mut run = onescan(folder.path()).args(words).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let mut said = BufReader::new(run.stderr.take().expect("piped"));
    let mut line = String::new();
    while !line.contains("client `plc`: start the PLC cold, for the session to begin") {
        line.clear();
        assert_ne!(said.read_line(&mut line).expect("text"), 0, "it has ended");
    }
    assert!(plc.say("status").starts_with("RUN, start 1, "));
    plc.say("cold");
    let again = Said::from(run.wait_with_output().unwrap());
    assert_eq!(again.code, Some(0), "{again:?}");
    assert_eq!(
        again.out.split("\"digest\"").nth(1).map(|rest| &rest[..20]),
        first.out.split("\"digest\"").nth(1).map(|rest| &rest[..20])
    );
}
