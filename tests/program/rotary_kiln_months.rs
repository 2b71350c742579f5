//! The rotary kiln over months: histories and histograms of its zones; and what is wrong with its shell and its gas.

use serde_json::Value;

use crate::typed::{Said, scenario, typed};

fn kiln(words: &[&str]) -> Said {
    let said = typed(&scenario("rotary-kiln"), words);
    assert_eq!(said.code, Some(0), "{said:?}");
    said
}

/// The report of a run, as JSON.
fn report(words: &[&str]) -> Value {
    let said = kiln(&[&["run", "--format", "json"], words].concat());
    let run: Value = serde_json::from_str(said.out.trim()).unwrap_or_else(|_| panic!("{said:?}"));
    run["report"].clone()
}

#[test]
fn three_days_of_zones_are_reported_for_people() {
    let said = kiln(&["run", "month.toml", "--until", "60h"]);
    insta::assert_snapshot!(&said.out[said.out.find("  report of").expect("a report")..]);
}

/// Steps in which nobody is due are passed over, and the report is the one of a run that goes through all of them.
#[test]
fn a_report_is_the_same_step_by_step() {
    let passed = report(&["month.toml", "--until", "2h"]);
    assert_eq!(passed, report(&["month.toml", "--until", "2h", "--pace", "1000000000"]));
    let day = &passed["histories"][0];
    assert_eq!(
        (day["window_ns"].as_u64(), day["signals"].as_array().map(Vec::len)),
        (Some(86_400_000_000_000), Some(8))
    );
    for signal in passed["histograms"][0]["signals"].as_array().expect("signals") {
        let total: u64 = signal["time_ns"].as_array().expect("bins").iter().filter_map(Value::as_u64).sum();
        assert_eq!(total, 7_200_000_000_000, "{signal}");
    }
}

#[test]
fn a_page_draws_histories_and_histograms_and_a_recording_gives_the_same() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name).to_str().expect("UTF-8").to_owned();
    let (page, recording, other) = (path("page.html"), path("out"), path("other.html"));
    kiln(&["run", "month.toml", "--until", "1h", "--html", &page, "--record", &recording]);
    let text = std::fs::read_to_string(&page).expect("a page");
    for part in ["Lowest, mean and highest values", "zones: Zone[5], % of the time", "windows of 1 d"] {
        assert!(text.contains(part), "{part}");
    }
    let said = kiln(&["report", &recording, "--format", "json", "--html", &other]);
    let again: Value = serde_json::from_str(said.out.trim()).unwrap_or_else(|_| panic!("{said:?}"));
    assert_eq!(again["report"], report(&["month.toml", "--until", "1h"]));
    let drawn = |text: &str| text.matches("% of the time").count();
    assert_eq!(drawn(&text), drawn(&std::fs::read_to_string(&other).expect("a page")));
}

/// A bent shell moves where the shell ends in the scanner's lines and makes no zone hot; a hot spot does the reverse.
#[test]
fn the_plc_distinguishes_a_bent_shell_from_a_hot_spot() {
    for case in ["default", "bent-shell", "both"] {
        kiln(&["run", "bent.toml", "--case", case]);
    }
}

#[test]
fn a_blockage_is_seen_by_draught_and_zones() {
    kiln(&["run", "blocked.toml"]);
}
