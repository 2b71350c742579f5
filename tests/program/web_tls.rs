//! `run --web --access` with a certificate: the page under TLS, to a client that is not ours.

use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::process::Command;

use crate::access::access;
use crate::typed::{begun, scenario};

#[test]
fn a_desk_comes_over_tls() {
    let (folder, made) = access(&["127.0.0.1"], &[("anna", "operator")]);
    let place = folder.path().to_str().expect("UTF-8");
    let words = ["run", ".", "--format", "json", "--until", "1h", "--web", "--access", place];
    let mut program = begun(&scenario("shear"), &words);
    let mut said = BufReader::new(program.stderr.take().expect("piped"));
    let mut line = String::new();
    while !line.contains("https://") {
        line.clear();
        assert_ne!(said.read_line(&mut line).expect("text"), 0, "no page");
    }
    let address = line.split("https://").nth(1).and_then(|rest| rest.split('/').next()).expect("an address");
    let (host, port) = address.split_once(':').expect("a port");
    let desk = Path::new(env!("CARGO_MANIFEST_DIR")).join("peers/desk.py");
    let ca = folder.path().join("ca.pem");
    let output = Command::new("python3").arg(desk).args([host, port]).arg(ca).arg(&made[0]).output().expect("Python");
    let reported = String::from_utf8_lossy(&output.stdout);
    let lines: Vec<&str> = reported.lines().collect();
    let wrong = String::from_utf8_lossy(&output.stderr);
    assert_eq!(
        lines.get(1..),
        Some(
            &[
                "without a token: 401",
                "session: shear TLSv1.3",
                "live: HTTP/1.1 101 Switching Protocols True",
                "the session has closed the line"
            ][..]
        ),
        "{reported}{wrong}"
    );
    assert!(lines[0].starts_with("without the CA: "), "{reported}");
    let mut rest = String::new();
    said.read_to_string(&mut rest).expect("text");
    let output = program.wait_with_output().expect("it ends");
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).expect("a report");
    assert_eq!(report["status"], "stopped", "{rest}");
}
