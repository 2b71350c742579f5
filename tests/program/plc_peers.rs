//! PLCs that others have made: the shear's program and the shim's scheduler in Python, on servers written by other
//! people. Each free-wheels, and the digest is that of the soft PLC in this process.

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};

use crate::typed::{copied_shear, digests, edit, run_shear, typed};
use crate::venv::python;

/// A peer that runs until it is dropped, and the port that it says.
struct Peer(Child, u16);

impl Peer {
    fn start(script: &str) -> Self {
        Self::start_with(script, &[])
    }

    fn start_with(script: &str, words: &[&Path]) -> Self {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("peers/plc").join(script);
        let packages = ["asyncua==2.1.0", "pyads==3.6.0", "pymodbus==3.16.1", "python-snap7==3.3.0"];
        let mut command = Command::new(python("plc-peers-2", &packages));
        command.arg(path).args(words).env("PYTHONDONTWRITEBYTECODE", "1").stdout(Stdio::piped()).stderr(Stdio::null());
        let mut child = command.spawn().expect("Python starts");
        let mut line = String::new();
        BufReader::new(child.stdout.take().expect("piped")).read_line(&mut line).expect("it speaks");
        let port = line.trim().parse().unwrap_or_else(|_| panic!("{script} says {line:?}"));
        Self(child, port)
    }
}

impl Drop for Peer {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

fn equals_the_run_in_process(script: &str, url: &str) {
    let (reports, _) = run_shear(&["--until", "2s"]);
    let folder = copied_shear();
    edit(folder.path(), "scenario.toml", "system_words = true", "system_words = false");
    let Peer(_child, port) = &Peer::start(script);
    let gateway = format!("plc={}", url.replace("PORT", &port.to_string()));
    let said = typed(folder.path(), &["run", ".", "--format", "json", "--until", "2s", "--gateway", &gateway]);
    assert_eq!(said.code, Some(0), "{said:?}");
    let report = serde_json::from_str(&said.out).expect("a report");
    assert_eq!(digests(&[report]), digests(&reports));
    // It was made without a scenario.
    assert!(said.err.contains("SDSP_Layout is 0"), "{said:?}");
}

#[test]
fn a_plc_on_asyncua() {
    equals_the_run_in_process("opcua_plc.py", "opc.tcp://127.0.0.1:PORT/");
}

#[test]
fn a_plc_on_pyads() {
    equals_the_run_in_process("ads_plc.py", "ads://127.0.0.1:PORT");
}

#[test]
fn a_plc_on_pymodbus() {
    equals_the_run_in_process("modbus_plc.py", "modbus://127.0.0.1:PORT");
}

#[test]
fn a_plc_on_snap7() {
    equals_the_run_in_process("s7_plc.py", "s7://127.0.0.1:PORT");
}

/// What `instrument --target scl` emits, block for block, and the mapping that it writes beside: nothing is typed.
#[test]
fn the_blocks_that_are_emitted_on_snap7() {
    let (reports, _) = run_shear(&["--until", "1s"]);
    let folder = copied_shear();
    let said = typed(folder.path(), &["instrument", ".", "--target", "scl", "-o", "out"]);
    assert_eq!(said.code, Some(0), "{said:?}");
    let out = folder.path().join("out");
    let mapping = std::fs::read_to_string(out.join("gateway.toml")).expect("a mapping");
    insta::assert_snapshot!(mapping);
    let path = folder.path().join("scenario.toml");
    let text = std::fs::read_to_string(&path).unwrap();
    let (front, gateway) = text.split_once("[clients.plc.gateway]").expect("a gateway");
    let rest = gateway.split_once("\n[").map(|(_, rest)| format!("\n[{rest}")).unwrap_or_default();
    std::fs::write(&path, format!("{front}{mapping}{rest}")).unwrap();
    for _ in 0..10 {
        let Peer(_child, port) = &Peer::start_with("s7_scl_plc.py", &[&out.join("plc/sdsp.scl")]);
        let gateway = format!("plc=s7://127.0.0.1:{port}");
        let said = typed(folder.path(), &["run", ".", "--format", "json", "--until", "1s", "--gateway", &gateway]);
        assert_eq!(said.code, Some(0), "{said:?}");
        assert!(!said.err.contains("SDSP_Layout is 0"), "{said:?}");
        let report = serde_json::from_str(&said.out).expect("a report");
        assert_eq!(digests(&[report]), digests(&reports));
    }
}
