//! `onescan compare`: lockstep beside the other ways.

use crate::typed::{scenario, typed};

#[test]
fn lockstep_is_one_run_and_the_others_are_many() {
    let folder = tempfile::tempdir().unwrap();
    let plot = folder.path().join("compare.svg");
    let words = ["compare", ".", "--until", "2s", "--runs", "2", "--format", "json", "--plot", plot.to_str().unwrap()];
    let said = typed(&scenario("shear"), &words);
    assert_eq!(said.code, Some(0), "{said:?}");
    let rows: Vec<serde_json::Value> = said.out.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let modes: Vec<&str> = rows.iter().map(|row| row["mode"].as_str().unwrap()).collect();
    assert_eq!(modes, ["lockstep", "freewheel", "halt", "follow", "follow"]);
    assert_eq!((&rows[3]["gain_pct"], &rows[4]["gain_pct"]), (&100.into(), &50.into()));
    assert!(rows[4]["errors_ms"].as_array().is_some_and(|errors| errors.len() > 2), "{said:?}");
    assert_eq!(
        (&rows[0]["digests"], &rows[0]["deviation"], &rows[0]["lost_edges"]),
        (&1.into(), &0.0.into(), &0.0.into())
    );
    // How far the others are off is chance: a machine at leisure, or one that is starved, may give what lockstep gives.
    assert!(rows.iter().all(|row| row["deviation"].as_f64().is_some_and(|part| part >= 0.0)), "{said:?}");
    assert!(rows.iter().all(|row| row["runs"] == 2 && row["steps_per_s"].as_f64().unwrap() > 0.0), "{said:?}");
    let svg = std::fs::read_to_string(plot).unwrap();
    assert!(svg.contains("follow") && svg.contains("Position_1"));
}

#[test]
fn people_get_a_table() {
    let said = typed(&scenario("shear"), &["compare", ".", "--until", "200ms", "--runs", "1"]);
    assert_eq!((said.code, said.err.as_str()), (Some(0), ""), "{said:?}");
    let lines: Vec<&str> = said.out.lines().collect();
    assert_eq!(lines.len(), 8, "{said:?}");
    assert!(lines[0].starts_with("mode        runs  digests  deviation  time offset  lost edges"));
    assert!(lines[1].starts_with("lockstep       1        1     0.00 %      +0.0 ms    0.0 of "), "{said:?}");
}
