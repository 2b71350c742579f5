//! Ten runs with `onescan plc` in a process of its own, over each link, on an idle machine and on a loaded one: every
//! digest is that of the run in one process. Without the handshake they differ.

use std::collections::BTreeSet;
use std::path::Path;

use crate::load::under_load;
use crate::plc::Plc;
use crate::typed::{ROUNDS, Said, copied, digests, typed};

const RUNS: usize = 10;

/// The digests of runs in `folder` up to `until`.
fn run(folder: &Path, until: &str, words: &[&str]) -> (Vec<String>, Said) {
    let said = typed(folder, &[&["run", ".", "--format", "json", "--until", until], words].concat());
    let reports: Vec<_> = said.out.lines().map(|line| serde_json::from_str(line).expect("JSON lines")).collect();
    (digests(&reports), said)
}

/// A scenario of the project whose PLC is one that can be started over its link.
fn prepared(name: &str) -> tempfile::TempDir {
    let folder = copied(name);
    let path = folder.path().join("scenario.toml");
    let text = std::fs::read_to_string(&path).unwrap();
    if !text.contains("[clients.plc.gateway]") {
        let link = "\n[clients.plc.gateway]\nurl = \"tcp://127.0.0.1:2000\"\nsystem_words = true\n";
        std::fs::write(&path, text + link).unwrap();
    }
    folder
}

/// Until when a run goes: on an idle machine far enough for something to happen, on a loaded one shorter.
struct Until {
    idle: &'static str,
    loaded: &'static str,
}

const SHEAR: Until = Until { idle: "1s", loaded: "300ms" };
const ROBOT: Until = Until { idle: "1s", loaded: "300ms" };

fn every_run_is_that_in_one_process(scenario: &str, until: &Until, scheme: &str) {
    let folder = prepared(scenario);
    let plc = Plc::start(folder.path(), &[]);
    let (gateway, runs) = (plc.gateway(scheme), RUNS.to_string());
    let words = ["--runs", &runs, "--gateway", &gateway];
    let one = |until: &str| run(folder.path(), until, &[]).0.remove(0);
    let (all, said) = run(folder.path(), until.idle, &words);
    assert_eq!(all, vec![one(until.idle); RUNS], "{said:?}");
    let (all, said) = under_load(|| run(folder.path(), until.loaded, &words));
    assert_eq!(all, vec![one(until.loaded); RUNS], "{said:?}");
}

#[test]
fn the_shear_over_raw_tcp() {
    every_run_is_that_in_one_process("shear", &SHEAR, "tcp://");
}

#[test]
fn the_shear_over_modbus() {
    every_run_is_that_in_one_process("shear", &SHEAR, "modbus://");
}

#[test]
fn the_shear_over_opc_ua() {
    every_run_is_that_in_one_process("shear", &SHEAR, "opc.tcp://");
}

#[test]
fn the_shear_over_s7() {
    every_run_is_that_in_one_process("shear", &SHEAR, "s7://");
}

#[test]
fn the_shear_over_ads() {
    every_run_is_that_in_one_process("shear", &SHEAR, "ads://");
}

/// A group of six axes on an instrumented PLC ([SDSP] sec. V-C).
#[test]
fn the_robot_cell_over_raw_tcp() {
    every_run_is_that_in_one_process("robot-cell", &ROBOT, "tcp://");
}

#[test]
fn the_gantry_robot_over_raw_tcp() {
    every_run_is_that_in_one_process("gantry-robot", &ROBOT, "tcp://");
}

#[test]
fn the_gantry_robot_over_modbus() {
    every_run_is_that_in_one_process("gantry-robot", &ROBOT, "modbus://");
}

#[test]
fn the_gantry_robot_over_opc_ua() {
    every_run_is_that_in_one_process("gantry-robot", &ROBOT, "opc.tcp://");
}

#[test]
fn the_gantry_robot_over_s7() {
    every_run_is_that_in_one_process("gantry-robot", &ROBOT, "s7://");
}

#[test]
fn the_gantry_robot_over_ads() {
    every_run_is_that_in_one_process("gantry-robot", &ROBOT, "ads://");
}

/// The same processes and links without the handshake: runs differ from each other and from lockstep.
///
/// Each run has a PLC that has just started: one that was left alone between two runs may have stopped its axes, and
/// then stands still in both. Any two runs may be equal by chance, so there are more until two are not.
fn without_the_handshake_runs_differ(scenario: &str, until: &str) {
    let folder = prepared(scenario);
    let lockstep = run(folder.path(), until, &[]).0.remove(0);
    let mut others = BTreeSet::new();
    for round in 0..ROUNDS {
        for scheme in ["tcp://", "s7://", "modbus://", "opc.tcp://", "ads://"] {
            let plc = Plc::start(folder.path(), &["--mode", "freewheel"]);
            let (digests, said) =
                run(folder.path(), until, &["--mode", "freewheel", "--gateway", &plc.gateway(scheme)]);
            assert_eq!(digests.len(), 1, "round {round}: {said:?}");
            others.extend(digests);
        }
        if others.len() > 1 && others.iter().any(|digest| *digest != lockstep) {
            return;
        }
    }
    panic!("equal runs without the handshake: {others:?}");
}

#[test]
fn the_shear_without_the_handshake() {
    without_the_handshake_runs_differ("shear", "2s");
}

#[test]
fn the_gantry_robot_without_the_handshake() {
    without_the_handshake_runs_differ("gantry-robot", "2s");
}

/// A scenario that says nothing of a link: the PLC and the gateway lay out the same, over every link, and the next session
/// starts the PLC by itself.
#[test]
fn a_scenario_without_a_link_fits_its_plc() {
    let folder = copied("gantry-robot");
    let expected = run(folder.path(), "200ms", &[]).0.remove(0);
    let plc = Plc::start(folder.path(), &["--cycle", "max"]);
    for scheme in ["s7://", "tcp://", "modbus://", "ads://", "opc.tcp://"] {
        let (all, said) = run(folder.path(), "200ms", &["--runs", "2", "--gateway", &plc.gateway(scheme)]);
        assert_eq!(all, [expected.as_str(), expected.as_str()], "{scheme}: {said:?}");
        assert!(!said.err.contains("start the PLC cold"), "{scheme}: {said:?}");
    }
}

/// The same of a PLC that reads signals in several variables and whose scenario has several PLCs.
#[test]
fn one_of_two_plcs_without_a_link_fits() {
    let folder = copied("arc-furnace");
    let expected = run(folder.path(), "2s", &[]).0.remove(0);
    let plc = Plc::start(folder.path(), &["--cycle", "max", "--client", "process"]);
    for scheme in ["s7://", "tcp://", "modbus://"] {
        let gateway = plc.gateway(scheme).replace("plc=", "process=");
        let (all, said) = run(folder.path(), "2s", &["--gateway", &gateway]);
        assert_eq!(all, [expected.as_str()], "{scheme}: {said:?}");
    }
}
