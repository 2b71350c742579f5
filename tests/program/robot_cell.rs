//! The robot cell: a six-joint arm that picks and places by coordinated motion.

use std::path::Path;

use crate::typed::{digests, is_the_same_over_tcp_and_resumed, rows, scenario, typed};

/// Runs a case, recorded; the digest and the rows of these signals.
fn recorded(record: &Path, case: &str, signals: &[&str]) -> (String, Vec<Vec<f64>>) {
    let folder = record.join(case);
    let words = ["run", ".", "--case", case, "--format", "json", "--record-also", "csv", "--record"];
    let said = typed(&scenario("robot-cell"), &[&words[..], &[folder.to_str().expect("UTF-8")]].concat());
    assert_eq!(said.code, Some(0), "{said:?}");
    let report: serde_json::Value = serde_json::from_str(said.out.trim()).expect("a report");
    (digests(&[report])[0].clone(), rows(&folder.join("run-1"), signals))
}

const TOOL: [&str; 4] = ["Tool_X", "Tool_Y", "Tool_Z", "Stopped"];

fn apart(a: &[f64], b: &[f64]) -> f64 {
    (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
}

/// Stopped and continued, on the arc and in a curve, the tool goes along the same path.
#[test]
fn a_stop_does_not_change_the_path() {
    let folder = tempfile::tempdir().unwrap();
    let (digest, path) = recorded(folder.path(), "default", &TOOL);
    insta::assert_snapshot!("robot_cell_digest", digest);
    for case in ["stop-on-the-arc", "stop-in-a-curve"] {
        let (other, rows) = recorded(folder.path(), case, &TOOL);
        assert_ne!(other, digest);
        assert!(rows.iter().any(|row| row[3] == 1.0), "{case}: it stops");
        // Around the stop, and as far again.
        for at in &rows[750..1800] {
            let off = path[700..1800].iter().map(|place| apart(at, place)).fold(f64::MAX, f64::min);
            assert!(off < 0.004, "{case}: {at:?} is {off} m off, where a cycle is 3.2 mm of the path");
        }
    }
}

#[test]
fn transport_and_checkpoints_do_not_matter() {
    // It is in the curve after the first part was gripped.
    is_the_same_over_tcp_and_resumed("robot-cell", ".", "6s", "3.28s");
}
