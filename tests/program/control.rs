//! `onescan control`: a session held, stepped and released from another terminal.

use std::io::{BufRead, BufReader};

use crate::typed::{begun, copied_shear, digests, edit, onescan, run_shear, scenario, typed};

/// Where a session that was begun with `--listen` says that it listens.
fn listening_at(said: &mut impl BufRead) -> String {
    let mut line = String::new();
    said.read_line(&mut line).unwrap();
    line.split("listening at ").nth(1).and_then(|rest| rest.split(' ').next()).expect("an address").to_owned()
}

#[cfg(unix)]
#[test]
fn ctrl_c_stops_at_a_step_and_leaves_everything_whole() {
    let folder = tempfile::tempdir().unwrap();
    let record = folder.path().to_str().unwrap();
    let words = ["run", ".", "--format", "json", "--until", "1h", "--pace", "1", "--listen", "127.0.0.1:0"];
    let mut server = begun(
        &scenario("shear"),
        &[&words[..], &["--transport", "tcp", "--record", record, "--record-also", "csv"]].concat(),
    );
    let mut said = BufReader::new(server.stderr.take().unwrap());
    let address = listening_at(&mut said);
    while typed(&scenario("shear"), &["control", &address]).code != Some(0) {}
    let signalled = std::process::Command::new("kill").args(["-INT", &server.id().to_string()]).status().unwrap();
    assert!(signalled.success());
    let output = server.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130));
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["status"], "stopped");
    let csv = std::fs::read_to_string(folder.path().join("run-1/trajectory.csv")).unwrap();
    assert_eq!(csv.lines().count() as u64, 2 + report["steps"].as_u64().unwrap());
}

/// The exit code says which signal has asked to end.
#[test]
fn a_request_to_end_has_an_exit_code_of_its_own() {
    for (signal, code) in [("-TERM", 143), ("-HUP", 129)] {
        let words = ["run", ".", "--until", "1h", "--pace", "1", "--listen", "127.0.0.1:0", "--transport", "tcp"];
        let mut server = begun(&scenario("shear"), &words);
        let mut said = BufReader::new(server.stderr.take().unwrap());
        let address = listening_at(&mut said);
        while typed(&scenario("shear"), &["control", &address]).code != Some(0) {}
        let signalled = std::process::Command::new("kill").args([signal, &server.id().to_string()]).status().unwrap();
        assert!(signalled.success());
        assert_eq!(server.wait_with_output().unwrap().status.code(), Some(code), "{signal}");
    }
}

#[test]
fn a_session_is_paused_stepped_reset_and_released_without_a_trace() {
    let folder = copied_shear();
    edit(folder.path(), "scenario.toml", "kind = \"plant\"\nscene = \"plant.toml\"", "kind = \"external\"");
    let words = ["run", ".", "--format", "json", "--until", "2s", "--pace", "1", "--listen", "127.0.0.1:0"];
    let mut server = begun(folder.path(), &words);
    let mut said = BufReader::new(server.stderr.take().unwrap());
    let address = listening_at(&mut said);
    let here = scenario("shear");
    let ask = |wish: &str| -> serde_json::Value {
        let said = typed(&here, &["control", &address, wish, "--format", "json"]);
        serde_json::from_str(&said.out).unwrap_or_else(|_| panic!("{said:?}"))
    };
    let mut plant = onescan(&here).args(["join", ".", "plant", "--server", &address]).spawn().unwrap();
    ask("pause");
    let before = ask("status");
    assert_eq!(before["held"], true);
    ask("step");
    let after = ask("status");
    assert_eq!(after["steps"].as_u64(), before["steps"].as_u64().map(|steps| steps + 1));
    ask("reset");
    assert_eq!(ask("status")["steps"], 0);
    let people = typed(&here, &["control", &address]);
    assert_eq!(people.out, "held in state initial-write after step 0, t_v = 0.000 s\n");
    let values = typed(&here, &["control", &address, "get", "Position_1", "Aligned"]);
    assert_eq!(values.out, "Position_1 = -0.05 m\nAligned    = FALSE\n");
    let unknown = typed(&here, &["control", &address, "get", "Positon_1"]);
    assert!(
        unknown.code == Some(2) && unknown.err.contains("did you mean") && unknown.err.contains("`Position_1`?"),
        "{unknown:?}"
    );
    let words = ["control", &address, "watch", "Strokes", "Aligned", "--format", "json", "--interval", "1ms"];
    let mut watcher = begun(&here, &words);
    let mut watched = BufReader::new(watcher.stdout.take().unwrap());
    let mut first = String::new();
    watched.read_line(&mut first).unwrap();
    ask("resume");
    let output = server.wait_with_output().unwrap();
    let rest: Vec<String> = watched.lines().map(|line| line.unwrap()).collect();
    let ended = watcher.wait_with_output().unwrap();
    assert!(ended.status.success(), "it ends with the session: {}", String::from_utf8_lossy(&ended.stderr));
    let strokes = |line: &str| -> String {
        let status: serde_json::Value = serde_json::from_str(line).unwrap();
        status["values"]["Strokes"].as_str().unwrap().to_owned()
    };
    assert_eq!(strokes(&first), "0");
    assert!(rest.iter().any(|line| strokes(line) == "1"), "a change is reported: {rest:?}");
    assert!(plant.wait().unwrap().success());
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let (undisturbed, _) = run_shear(&["--until", "2s"]);
    assert_eq!(digests(&[report]), digests(&undisturbed));
}
