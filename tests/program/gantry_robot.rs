//! The gantry robot: the same path in every run in lockstep, another in every run without.

use std::collections::BTreeSet;

use crate::typed::{ROUNDS, copied, digests, is_the_same_over_tcp_and_resumed, rows, scenario, typed};

/// Runs the robot; reports and the exit code.
fn run(words: &[&str]) -> (Vec<serde_json::Value>, Option<i32>) {
    let mut all = vec!["run", ".", "--format", "json"];
    all.extend_from_slice(words);
    let said = typed(&scenario("gantry-robot"), &all);
    let reports = said.out.lines().map(|line| serde_json::from_str(line).unwrap_or_else(|_| panic!("{said:?}")));
    (reports.collect(), said.code)
}

/// The path of `plc/robot.st` (Fig. 13), from where the robot begins.
const PATH: [[f64; 2]; 11] = [
    [0.2, 0.3],
    [0.2, 0.9],
    [0.6, 1.1],
    [1.0, 0.9],
    [1.0, 0.4],
    [1.4, 0.4],
    [1.4, 0.9],
    [1.8, 0.9],
    [1.8, 0.2],
    [1.0, 0.1],
    [0.2, 0.3],
];

/// How far a place is from the line between two points.
fn off_the_line([x, z]: [f64; 2], from: [f64; 2], to: [f64; 2]) -> f64 {
    let (dx, dz) = (to[0] - from[0], to[1] - from[1]);
    let along = ((x - from[0]) * dx + (z - from[1]) * dz) / (dx * dx + dz * dz);
    let along = along.clamp(0.0, 1.0);
    (x - from[0] - along * dx).hypot(z - from[1] - along * dz)
}

/// How far a place is from the path.
fn off_the_path(place: [f64; 2]) -> f64 {
    PATH.windows(2).map(|line| off_the_line(place, line[0], line[1])).fold(f64::MAX, f64::min)
}

#[test]
fn in_lockstep_it_follows_its_path_in_every_run() {
    let folder = tempfile::tempdir().unwrap();
    let words = ["--runs", "3", "--record-also", "csv", "--record", folder.path().to_str().unwrap()];
    let (reports, code) = run(&words);
    assert_eq!((reports.len(), code), (3, Some(0)), "{reports:?}");
    let digests = digests(&reports);
    assert!(digests.iter().all(|digest| *digest == digests[0]), "{digests:?}");
    insta::assert_snapshot!("gantry_robot_digest", digests[0]);
    let rows = rows(&folder.path().join("run-1"), &["X_Position", "Z_Position", "Point", "Cycles"]);
    let furthest = rows.iter().map(|row| off_the_path([row[0], row[1]])).fold(0.0, f64::max);
    assert!(furthest < 0.03, "{furthest} m off the path");
    // It has been at every point, and has restarted.
    for point in PATH {
        let nearest = rows.iter().map(|row| (row[0] - point[0]).hypot(row[1] - point[1])).fold(f64::MAX, f64::min);
        assert!(nearest < 0.002, "{nearest} m from {point:?}");
    }
    assert!(rows.last().is_some_and(|row| row[3] >= 1.0));
}

#[test]
fn transport_and_checkpoints_do_not_matter() {
    // Both axes are on their way.
    is_the_same_over_tcp_and_resumed("gantry-robot", ".", "6s", "3210ms");
}

/// Two runs may be equal by chance, so there are more until two are not.
#[test]
fn free_wheeling_runs_differ() {
    let mut distinct = BTreeSet::new();
    for _ in 0..ROUNDS {
        let (reports, code) = run(&["--mode", "freewheel", "--until", "4s", "--runs", "2"]);
        assert!(matches!(code, Some(0 | 1)), "{reports:?}");
        distinct.extend(digests(&reports));
        if distinct.len() > 1 {
            return;
        }
    }
    panic!("equal runs without lockstep: {distinct:?}");
}

/// Both axes as a group (PLCopen, part 4): the same path, with its corners rounded off by 2 mm.
#[test]
fn a_group_follows_the_path_and_rounds_its_corners_off() {
    let folder = tempfile::tempdir().unwrap();
    let record = folder.path().to_str().unwrap();
    let words = ["run", "group.toml", "--format", "json", "--record-also", "csv", "--record", record];
    let said = typed(&scenario("gantry-robot"), &words);
    assert_eq!(said.code, Some(0), "{said:?}");
    let report: serde_json::Value = serde_json::from_str(said.out.trim()).expect("a report");
    insta::assert_snapshot!("gantry_robot_group_digest", digests(&[report])[0]);
    let rows = rows(&folder.path().join("run-1"), &["X_Set", "Z_Set", "X_Position", "Z_Position", "Cycles", "Point"]);
    // What is set leaves the lines at corners only, and passes them by no more than 2 mm.
    let set: Vec<[f64; 2]> = rows.iter().filter(|row| row[5] > 0.0).map(|row| [row[0], row[1]]).collect();
    for corner in &PATH[1..] {
        let nearest = set.iter().map(|at| (at[0] - corner[0]).hypot(at[1] - corner[1])).fold(f64::MAX, f64::min);
        assert!(nearest < 0.0065, "{nearest} m from {corner:?}, where a cycle is 10 mm of the path");
    }
    let furthest = set.iter().map(|at| off_the_path(*at)).fold(0.0, f64::max);
    assert!((0.0005..0.002).contains(&furthest), "set values are {furthest} m off the path");
    let furthest = rows.iter().map(|row| off_the_path([row[2], row[3]])).fold(0.0, f64::max);
    assert!(furthest < 0.007, "the tool is {furthest} m off the path, as without a group");
    assert!(rows.last().is_some_and(|row| row[4] >= 1.0));
}

#[test]
fn a_group_is_the_same_over_tcp_and_from_a_checkpoint() {
    // It is in a curve.
    is_the_same_over_tcp_and_resumed("gantry-robot", "group.toml", "5s", "2340ms");
}

/// Figs. 14 and 15: the path of the tool in the plane.
#[test]
fn its_path_is_drawn_in_the_plane() {
    let folder = tempfile::tempdir().unwrap();
    let plot = folder.path().join("path.svg");
    let words = ["--until", "12s", "--runs", "2", "--xy", "X_Position,Z_Position", "--plot", plot.to_str().unwrap()];
    let (reports, code) = run(&words);
    assert_eq!((reports.len(), code), (2, Some(0)));
    let svg = std::fs::read_to_string(&plot).unwrap();
    assert!(svg.contains("<desc>Z_Position (m) over X_Position (m). Runs: run 1, run 2.</desc>"), "{svg}");
    assert!(!svg.contains("time (s)"), "it is over no time");
    let said = typed(&scenario("gantry-robot"), &["run", ".", "--xy", "X_Position,Z_Postion", "--plot", "no.svg"]);
    assert!(said.code == Some(2) && said.err.contains("`Z_Position`"), "{said:?}");
    let said = typed(&scenario("gantry-robot"), &["run", ".", "--xy", "X_Position", "--plot", "no.svg"]);
    assert!(said.code == Some(2) && said.err.contains("two signals with a comma"), "{said:?}");
}

/// Fig. 14: a corner of the path, enlarged, with a frame in the whole that shows where it is.
#[test]
fn a_corner_of_its_path_is_drawn_enlarged() {
    let folder = tempfile::tempdir().unwrap();
    let plot = folder.path().join("path.svg");
    let plot = plot.to_str().unwrap();
    let drawn = |words: &[&str]| {
        typed(&scenario("gantry-robot"), &[&["run", ".", "--until", "6s", "--plot", plot, "--enlarge"], words].concat())
    };
    let said = drawn(&["0.96..1.06,0.87..0.93", "--xy", "X_Position,Z_Position"]);
    assert_eq!(said.code, Some(0), "{said:?}");
    let svg = std::fs::read_to_string(plot).unwrap();
    assert!(svg.contains("Enlarged beside them: from 0.96 to 1.06 across, from 0.87 to 0.93 up.</desc>"), "{svg}");
    let said = drawn(&["2s..2.5s"]);
    assert_eq!(said.code, Some(0), "{said:?}");
    let svg = std::fs::read_to_string(plot).unwrap();
    assert!(svg.contains("Enlarged beside them: from 2 s to 2.5 s.</desc>"), "{svg}");
}

/// What cannot be enlarged is refused before anything runs, or, where only the run shows it, with the whole drawn.
#[test]
fn a_part_that_is_not_there_is_not_enlarged() {
    let folder = tempfile::tempdir().unwrap();
    let plot = folder.path().join("path.svg");
    let said = |words: &[&str]| {
        let all = [&["run", ".", "--until", "1s", "--plot", plot.to_str().unwrap()], words].concat();
        typed(&scenario("gantry-robot"), &all)
    };
    let plane: [&str; 2] = ["--xy", "X_Position,Z_Position"];
    for (words, wanted) in [
        (vec!["--enlarge", "2s..2s"], "the range `2s..2s` is empty"),
        (vec!["--enlarge", "0..1,b..2"], "`b` is not a number"),
        (vec!["--enlarge", "1s"], "write ranges, as in `2s..2.5s`"),
        (vec!["--enlarge", "2s..3s"], "--enlarge: 2.000 s is not before the end of the run at 1.000 s"),
        (vec!["--enlarge", "0..1,0..1"], "write a range of time"),
        (vec!["--enlarge", "0s..1s", plane[0], plane[1]], "write a range of X_Position and one of Z_Position"),
    ] {
        let said = said(&words);
        assert!(said.code == Some(2) && said.err.contains(wanted), "{words:?}: {said:?}");
        assert!(!plot.exists(), "{words:?}");
    }
    let said = said(&["--enlarge", "5..6,5..6", plane[0], plane[1]]);
    assert!(said.code == Some(2) && said.err.contains("X_Position (m) is from 0.2"), "{said:?}");
    assert!(plot.exists() && said.out.contains("digest"), "the run is reported all the same: {said:?}");
}

/// Its motion control can be taken over as a whole, for any PLC.
#[test]
fn it_is_instrumented_with_nothing_left() {
    let folder = copied("gantry-robot");
    let said = typed(folder.path(), &["instrument", ".", "--in-place"]);
    assert_eq!((said.code, said.err.as_str()), (Some(0), ""), "{said:?}");
    let servo = std::fs::read_to_string(folder.path().join("plc/servo.st")).unwrap();
    assert!(servo.contains("Axis : SDSP_AXIS_REF(*@sdsp was AXIS_REF*)") && servo.contains("SDSP_MC_MoveAbsolute"));
    assert_eq!(typed(folder.path(), &["check", "plc"]).code, Some(0));
    let said = typed(folder.path(), &["instrument", ".", "--in-place", "--remove"]);
    assert_eq!(said.code, Some(0), "{said:?}");
    let given = std::fs::read_to_string(scenario("gantry-robot").join("plc/servo.st")).unwrap();
    assert_eq!(std::fs::read_to_string(folder.path().join("plc/servo.st")).unwrap(), given);
}
