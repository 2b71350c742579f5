//! What the thesis on the kiln prints, and what comes of it: the whole guard of its slip, its check sum, its serial task and
//! its terminals.

use std::fs;

use serde_json::Value;

use crate::typed::{copied, digests, is_the_same_over_tcp_and_resumed, scenario, typed};

fn objects(words: &[&str]) -> Vec<Value> {
    let said = typed(&scenario("rotary-kiln"), &[words, &["--format", "json"]].concat());
    assert_eq!(said.code, Some(1), "{said:?}");
    said.out.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect()
}

/// What a case that was found gives, run by itself.
fn run_alone(case: &str, name: &str) -> Value {
    let folder = copied("rotary-kiln");
    fs::write(folder.path().join("thesis-cams.cases.toml"), format!("version = 1\n{case}")).expect("a file");
    let said = typed(folder.path(), &["run", "thesis-cams.toml", "--case", name, "--format", "json"]);
    serde_json::from_str(said.out.trim()).unwrap_or_else(|_| panic!("{said:?}"))
}

/// The third condition of the guard takes a slip below one for an error, and nothing reports it.
#[test]
fn the_slip_that_is_silently_zero_is_found_by_a_search_over_the_cams() {
    let words = ["falsify", "thesis-cams.toml", "--expect", "there is a slip", "--runs", "50"];
    let found = objects(&words).remove(0);
    assert_eq!((&found["falsified"], &found["robustness"]), (&true.into(), &0.0.into()), "{found}");
    assert!(found["simulations"].as_u64().expect("a number") <= 50, "{found}");
    let report = run_alone(found["case"].as_str().expect("a case"), "falsified");
    assert_eq!(digests(std::slice::from_ref(&report)), [found["digest"].as_str().expect("a digest")]);
}

#[test]
fn the_slip_that_is_silently_zero_is_found_by_one_edge_two_scans_late() {
    let found = objects(&["explore", "thesis-cams.toml"]).remove(0);
    assert_eq!(found["deviations"].as_array().map(Vec::len), Some(1), "{found}");
    assert_eq!(found["violated"][0]["values"][0]["value"], 0.0, "{found}");
    let report = run_alone(found["case"].as_str().expect("a case"), "timing-1");
    assert_eq!(digests(std::slice::from_ref(&report)), [found["digest"].as_str().expect("a digest")]);
}

#[test]
fn with_the_cams_exchanged_the_program_of_the_thesis_has_no_slip_and_the_mended_one_has() {
    let thesis = typed(&scenario("rotary-kiln"), &["run", "thesis-cams.toml", "--case", "exchanged"]);
    assert_eq!(thesis.code, Some(0), "{thesis:?}");
    assert!(thesis.out.contains("`the guard takes the slip for an error` met"), "{thesis:?}");
    let folder = copied("rotary-kiln");
    let exchanged = "version = 1\n[[case]]\nname = \"exchanged\"\nset.plant.kiln.ring_cam_deg = 3.0\n\
                     set.plant.kiln.shell_cam_deg = 6.0\n";
    fs::write(folder.path().join("cases.toml"), exchanged).expect("a file");
    let mended = typed(folder.path(), &["run", ".", "--case", "exchanged"]);
    assert_eq!(mended.code, Some(0), "{mended:?}");
    assert!(mended.out.contains("`the slip is the lag of the shell` met"), "{mended:?}");
}

#[test]
fn a_command_that_the_scanner_refuses_violates_what_is_expected() {
    let said = typed(&scenario("rotary-kiln"), &["run", "thesis-frame.toml"]);
    assert_eq!(said.code, Some(1), "{said:?}");
    let reported = "`the scanner accepts all seven commands` violated at 1.000 s: Accepted = 4, Refused = 9";
    assert!(said.out.contains(reported), "{said:?}");
}

/// The server compares the sum with that of the file that it wrote.
#[test]
fn the_check_sum_of_the_parameter_file_is_the_sum_of_its_bytes() {
    let bytes = fs::read(scenario("rotary-kiln").join("files/params.txt")).expect("a file");
    let sum: u32 = bytes.iter().map(|byte| u32::from(*byte)).sum();
    let words = ["run", "serial.toml", "--until", "1s", "--watch", "GV_Params_sum"];
    let said = typed(&scenario("rotary-kiln"), &words);
    assert!(said.out.contains(&format!("GV_Params_sum = 16#{:04X}", sum % 65536)), "{said:?}");
}

#[test]
fn a_serial_task_that_is_too_slow_loses_every_line() {
    let said = typed(&scenario("rotary-kiln"), &["run", "serial-slow.toml"]);
    assert_eq!(said.code, Some(1), "{said:?}");
    assert!(
        said.out.contains("`a revolution has its twelve lines` violated at 131.000 s: Rows = 12, Lines = 0"),
        "{said:?}"
    );
}

#[test]
fn the_relays_and_the_analog_outputs_are_the_same_in_every_way() {
    is_the_same_over_tcp_and_resumed("rotary-kiln", "cabinet.toml", "135s", "131.5s");
}
