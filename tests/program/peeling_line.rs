//! The peeling line: twenty-five axes that take command frames, two PLCs, a block from the feeder to its core.

use crate::typed::{copied, digests, edit, is_the_same_over_tcp_and_resumed, scenario, typed};

/// A run of the line, which must end with this exit code; its report.
fn run(words: &[&str], code: i32) -> serde_json::Value {
    let said = typed(&scenario("peeling-line"), &[&["run", ".", "--format", "json"], words].concat());
    assert_eq!(said.code, Some(code), "{said:?}");
    serde_json::from_str(said.out.trim()).expect("a report")
}

/// What a count of the report has come to.
fn counted(report: &serde_json::Value, name: &str) -> u64 {
    let counts = report["report"]["counts"].as_array().expect("counts");
    let count = counts.iter().find(|count| count["name"] == name).unwrap_or_else(|| panic!("{name}: {report}"));
    count["count"].as_u64().expect("a number")
}

/// Table 3 of `[Nyyssönen]` and the lines of today peel 5 to 20 blocks a minute.
#[test]
fn an_hour_of_the_line_peels_more_than_eight_blocks_a_minute_and_nothing_falls() {
    let report = run(&["--until", "3600s"], 0);
    assert!(counted(&report, "blocks peeled") >= 480, "{report}");
    assert_eq!(counted(&report, "blocks dropped"), 0);
    insta::assert_snapshot!("peeling_line_hour_digest", digests(&[report])[0]);
}

#[test]
fn transport_and_checkpoints_do_not_matter() {
    // The second block is clamped, the third one measured.
    is_the_same_over_tcp_and_resumed("peeling-line", ".", "20s", "14.68s");
}

/// The formulas of the case hold length, turns, speed and rolls against the closed form.
#[test]
fn the_birch_of_the_thesis_gives_its_veneer() {
    run(&["--case", "birch"], 0);
}

/// 3.2: a position of 50000 that is kept in INT and converted as it is.
#[test]
fn a_conversion_without_the_way_over_uint_is_reported() {
    let folder = copied("peeling-line");
    edit(
        folder.path(),
        "charger/position_to_real.scl",
        "UINT_TO_REAL(INT_TO_UINT(#Position))",
        "INT_TO_REAL(#Position)",
    );
    let said = typed(folder.path(), &["run", ".", "--until", "10s"]);
    assert_eq!(said.code, Some(1), "{said:?}");
    let reported = said.out.lines().find(|line| line.contains("`positions are converted as UINT` violated"));
    insta::assert_snapshot!("peeling_line_conversion", reported.unwrap_or_default());
}

/// 3.1.1: Execute is held for 500 ms because a shorter one may not be seen. In lockstep one scan is enough.
#[test]
fn commands_of_one_scan_are_lost_over_a_link_that_pushes_and_never_in_lockstep() {
    let peeled = |case: &str| {
        let report = run(&["--case", case], 0);
        (counted(&report, "blocks peeled"), digests(&[report])[0].clone())
    };
    let [(held, _), (one_scan, _), (pushed, pushed_once), (both, _)] =
        ["production", "one-scan", "pushed", "one-scan-pushed"].map(peeled);
    assert_eq!(one_scan, held, "in lockstep no command is lost");
    assert!(both < one_scan && both < pushed, "{both} of {one_scan}, {pushed}");
    assert_eq!(peeled("pushed").1, pushed_once, "a link without lockstep, the same each time");
}

#[test]
fn every_fault_of_the_line_has_a_verdict() {
    let said = typed(&scenario("peeling-line"), &["campaign", ".", "line"]);
    assert_eq!(said.code, Some(1), "{said:?}");
    insta::assert_snapshot!("peeling_line_campaign", said.out);
}

/// Sec. 2.3: the campaign finds that an unseen block is pushed where the loader is not; the mended program reports it.
#[test]
fn the_mended_program_reports_what_the_first_one_missed() {
    // those of the first one are in the snapshot of its campaign: no effect, and three collisions
    let said = typed(&scenario("peeling-line"), &["campaign", "mended.toml", "line", "--format", "json"]);
    let lines = said.out.lines().map(|line| serde_json::from_str::<serde_json::Value>(line).expect("JSON lines"));
    let unseen = lines.filter(|line| line["fault"] == "block-unseen");
    let verdicts: Vec<_> = unseen.map(|line| line["verdict"].as_str().expect("a verdict").to_owned()).collect();
    assert_eq!(verdicts, ["no-effect", "detected", "detected", "detected"]);
    let healthy = |file: &str| {
        let said = typed(&scenario("peeling-line"), &["run", file, "--format", "json"]);
        digests(&[serde_json::from_str(said.out.trim()).expect("a report")])
    };
    assert_eq!(healthy("mended.toml"), healthy("."), "nothing else has changed");
}
