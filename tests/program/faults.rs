//! A client in another process is killed: the session ends for all, by name, with its recording whole.

use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::process::Child;

use crate::typed::{begun, copied_shear, edit, onescan, typed};

/// The shear with a plant that somebody else starts.
fn shear_with_external_plant() -> tempfile::TempDir {
    let folder = copied_shear();
    edit(folder.path(), "scenario.toml", "kind = \"plant\"\nscene = \"plant.toml\"", "kind = \"external\"");
    folder
}

/// Starts the server in `folder` and reads where it waits for the plant.
fn serve(folder: &Path, words: &[&str]) -> (Child, String, BufReader<std::process::ChildStderr>) {
    let mut server = begun(folder, &[&["run", ".", "--format", "json"], words].concat());
    let mut said = BufReader::new(server.stderr.take().expect("piped"));
    let mut line = String::new();
    while !line.contains("waiting at ") {
        line.clear();
        assert!(said.read_line(&mut line).expect("text") > 0, "the server ended before it waited");
    }
    let address = line.split("waiting at ").nth(1).and_then(|rest| rest.split(' ').next()).expect("an address");
    (server, address.to_owned(), said)
}

fn plant(address: &str) -> Child {
    let shear = crate::typed::scenario("shear");
    onescan(&shear).args(["join", ".", "plant", "--server", address]).spawn().expect("the program starts")
}

#[test]
fn an_external_plant_gives_the_same_digest() {
    let folder = shear_with_external_plant();
    let (server, address, _said) = serve(folder.path(), &["--until", "1s"]);
    let mut plant = plant(&address);
    let output = server.wait_with_output().expect("it ends");
    assert!(plant.wait().expect("it ends").success());
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).expect("a report");
    let (inproc, _) = crate::typed::run_shear(&["--until", "1s"]);
    assert_eq!(report["digest"], inproc[0]["digest"]);
}

#[test]
fn a_killed_plant_ends_the_session_by_name() {
    for t_v in ["0.25s", "1.5s"] {
        let folder = shear_with_external_plant();
        // Paced, so that there is time to kill; what is checked does not depend on when.
        let words = [
            "--until",
            "600s",
            "--pace",
            "50",
            "--record-also",
            "csv",
            "--record",
            "record",
            "--listen",
            "127.0.0.1:0",
        ];
        let (server, address, mut said) = serve(folder.path(), &words);
        let mut plant = plant(&address);
        wait_for(&address, t_v.trim_end_matches('s').parse().expect("a number"));
        plant.kill().expect("it runs");
        plant.wait().expect("it is gone");
        let output = server.wait_with_output().expect("it ends");
        let mut rest = String::new();
        said.read_to_string(&mut rest).expect("text");
        assert_eq!(output.status.code(), Some(3), "{rest}");
        let report: serde_json::Value = serde_json::from_slice(&output.stdout).expect("a report");
        assert_eq!((&report["status"], &report["failure"]["client"]), (&"failed".into(), &"plant".into()));
        assert_eq!(report["failure"]["state"], "run");
        assert_eq!(report["failure"]["cause"], "disconnected");
        let t_v_ns = report["failure"]["t_v_ns"].as_u64().expect("a time");
        let steps = report["steps"].as_u64().expect("a number");
        assert_eq!(t_v_ns, (steps + 1) * 10_000_000, "the step after the last committed one");
        let csv = std::fs::read_to_string(folder.path().join("record/run-1/trajectory.csv")).expect("a recording");
        assert_eq!(csv.lines().count() as u64, 1 + 1 + steps, "header, initial values, every committed step");
        assert!(csv.ends_with('\n'));
    }
}

/// Asks the session how it is until it has come to `t_v` seconds.
fn wait_for(address: &str, t_v_s: f64) {
    let here = crate::typed::scenario("shear");
    loop {
        let said = typed(&here, &["control", address, "status", "--format", "json"]);
        let status: Option<serde_json::Value> = serde_json::from_str(&said.out).ok();
        if status.is_some_and(|status| status["t_v_ns"].as_f64().unwrap_or(0.0) / 1e9 >= t_v_s) {
            return;
        }
    }
}

#[test]
fn a_client_process_that_cannot_begin_is_reported() {
    let folder = copied_shear();
    let external = "kind = \"external\"\ncommand = [\"python3\", \"-c\", \"raise SystemExit(7)\"]";
    edit(folder.path(), "scenario.toml", "kind = \"plant\"\nscene = \"plant.toml\"", external);
    let said = typed(folder.path(), &["run", "."]);
    assert_eq!(said.code, Some(3), "{said:?}");
    assert!(said.err.contains("the process of client `plant` ended before it joined (exit status: 7)"), "{said:?}");
}

#[test]
fn nobody_comes() {
    let folder = shear_with_external_plant();
    let said = typed(folder.path(), &["run", ".", "--join-timeout", "200ms"]);
    assert_eq!(said.code, Some(3), "{said:?}");
    assert!(said.err.contains("client `plant` did not join within 0.2 s"), "{said:?}");
}
