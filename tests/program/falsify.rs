//! `onescan falsify`: inputs that break what is expected, found by a search that is a function of its seed, as cases that
//! repeat it to the digest.

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::Stdio;

use serde_json::Value;

use crate::typed::{copied_from, digests, edit, onescan, scenario, typed};

/// A benchmark, in a folder of its own.
fn benchmark(name: &str) -> tempfile::TempDir {
    copied_from(&falsify_folder().join(name))
}

fn falsify_folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("falsify")
}

fn searched(folder: &Path, words: &[&str]) -> Value {
    let said = typed(folder, &[&["falsify", "."], words, &["--format", "json"]].concat());
    serde_json::from_str(said.out.trim()).unwrap_or_else(|_| panic!("{words:?}: {said:?}"))
}

/// The case of a finding, run by itself.
fn run_alone(folder: &Path, case: &str) -> (Vec<String>, Value) {
    std::fs::write(folder.join("cases.toml"), format!("version = 1\n{case}")).expect("a file");
    let said = typed(folder, &["run", ".", "--case", "falsified", "--format", "json"]);
    let report: Value = serde_json::from_str(said.out.trim()).unwrap_or_else(|_| panic!("{said:?}"));
    (digests(std::slice::from_ref(&report)), report)
}

#[test]
fn the_speed_of_the_transmission_is_broken_by_a_case_that_repeats_it() {
    let folder = benchmark("automatic-transmission");
    let words = ["falsify", ".", "--expect", "AT1", "--cases", "cases.toml", "--plot", "at1.svg"];
    let said = typed(folder.path(), &words);
    assert_eq!((said.code, said.err.as_str()), (Some(1), ""));
    let name = folder.path().file_name().and_then(|name| name.to_str()).expect("a name");
    insta::assert_snapshot!(said.out.replace(name, "automatic-transmission"));
    let run = typed(folder.path(), &["run", ".", "--case", "falsified", "--format", "json"]);
    let report: Value = serde_json::from_str(run.out.trim()).expect("JSON");
    assert!(said.out.contains(&digests(std::slice::from_ref(&report))[0]), "{run:?}");
    assert_eq!(report["expectations"][0]["verdict"], "violated");
    let svg = std::fs::read_to_string(folder.path().join("at1.svg")).expect("a picture");
    assert!(svg.contains("Speed") && svg.contains("violated"), "{svg}");
    for way in [&["--transport", "tcp"][..], &["--runs", "2"]] {
        let run = typed(folder.path(), &[&["run", ".", "--case", "falsified", "--format", "json"], way].concat());
        let first: Value = serde_json::from_str(run.out.lines().next().expect("a line")).expect("JSON");
        assert_eq!(first["digest"], report["digest"], "{way:?}");
    }
}

#[test]
fn a_search_is_the_same_again_and_with_several_at_a_time() {
    let folder = benchmark("automatic-transmission");
    for optimiser in ["cma-es", "annealing", "random"] {
        let search = |seed: &str, jobs: &str| {
            let words = ["--expect", "AT53", "--optimiser", optimiser, "--seed", seed, "--jobs", jobs, "--runs", "60"];
            searched(folder.path(), &words)
        };
        let first = search("3", "1");
        assert_eq!(first, search("3", "1"), "{optimiser}");
        assert_eq!(first, search("3", "3"), "{optimiser} with three at a time");
        let (digests, _) = run_alone(folder.path(), first["case"].as_str().unwrap_or_else(|| panic!("{first}")));
        assert_eq!(digests, [first["digest"].as_str().expect("a digest")], "{optimiser}");
        std::fs::remove_file(folder.path().join("cases.toml")).expect("a file");
    }
}

/// Points by another program: those that differ late fork from one another, to the digest of their cases.
#[test]
fn runs_that_fork_have_the_digests_of_those_from_the_start() {
    let folder = benchmark("chasing-cars");
    let mut points = vec![vec![0.5_f64; 40]; 4];
    (points[1][19], points[2][12], points[3][39]) = (1.0, 0.1, 0.0);
    let all = reported(folder.path(), &points);
    let forked: Vec<Option<u64>> = all.iter().map(|one| one["forked_ns"].as_u64()).collect();
    assert_eq!(forked, [None, Some(94_900_000_000), Some(59_900_000_000), Some(94_900_000_000)]);
    for (point, forked) in points.iter().zip(&all) {
        // Alone, there is nothing to fork from.
        let alone = &reported(folder.path(), std::slice::from_ref(point))[0];
        assert_eq!(alone["forked_ns"], Value::Null);
        assert_eq!((&alone["digest"], &alone["robustness"]), (&forked["digest"], &forked["robustness"]));
    }
}

/// What `--points` says of these.
fn reported(folder: &Path, points: &[Vec<f64>]) -> Vec<Value> {
    let words = ["falsify", ".", "--expect", "CC4", "--points"];
    let mut child =
        onescan(folder).args(words).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().expect("it starts");
    let mut stdin = child.stdin.take().expect("a pipe");
    for point in points {
        writeln!(stdin, "{}", serde_json::to_string(point).expect("JSON")).expect("a pipe");
    }
    drop(stdin);
    let output = child.wait_with_output().expect("it ends");
    let out = String::from_utf8(output.stdout).expect("text");
    out.lines().map(|line| serde_json::from_str(line).expect("JSON lines")).collect()
}

/// A set point that changes late, a parameter, and branches of a PLC, in a scenario of the project.
#[test]
fn a_slip_is_measured_wrong_while_the_speed_changes() {
    let kiln = scenario("rotary-kiln");
    let slip = ["--expect", "the slip is the lag of the shell"];
    let found = searched(&kiln, &slip);
    assert_eq!((&found["falsified"], &found["violated"][0]), (&true.into(), &slip[1].into()), "{found}");
    for objective in ["coverage", "both"] {
        let found = searched(&kiln, &[&slip[..], &["--objective", objective][..]].concat());
        let branches = &found["branches"];
        assert!(
            branches["taken"].as_u64() > Some(0) && branches["taken"].as_u64() <= branches["all"].as_u64(),
            "{found}"
        );
        assert_eq!(found["forked"], 0, "what was executed before a fork is not known");
    }
}

#[test]
fn a_parameter_is_varied_too() {
    let folder = benchmark("automatic-transmission");
    let inputs = "input = [\n    { signal = \"Throttle\", range = [0, 100], points = 7 },\n    { signal = \"Brake\", range = [0, 325], points = 7 },\n]";
    let parameter = "parameter = [{ path = \"plant.car.vehicle_inertia\", range = [6, 12] }]\ninput = [{ signal = \"Throttle\", range = [50, 90], points = 1 }]";
    edit(folder.path(), "scenario.toml", inputs, parameter);
    let found = searched(folder.path(), &["--expect", "AT1"]);
    assert_eq!(found["falsified"], true, "{found}");
    let case = found["case"].as_str().expect("a case").to_owned();
    assert!(case.contains("set.\"plant.car.vehicle_inertia\" = "), "{case}");
    assert_eq!(run_alone(folder.path(), &case).0, [found["digest"].as_str().expect("a digest")]);
}

#[test]
fn what_holds_is_reported_with_how_near_it_came() {
    let folder = benchmark("automatic-transmission");
    let said = typed(folder.path(), &["falsify", ".", "--expect", "AT6a", "--runs", "5"]);
    assert_eq!((said.code, said.err.as_str()), (Some(0), ""));
    assert!(said.out.contains("`AT6a` holds in all of 5 simulations (cma-es, seed 1); least robustness"), "{said:?}");
}

#[test]
fn what_cannot_be_falsified_is_reported() {
    let reported = |from: &str, to: &str| {
        let folder = benchmark("automatic-transmission");
        edit(folder.path(), "scenario.toml", from, to);
        let said = typed(folder.path(), &["falsify", ".", "--runs", "1"]);
        assert_eq!((said.code, said.out.as_str()), (Some(2), ""), "{from} -> {to}: {said:?}");
        format!("{from} -> {to}\n{}", said.err)
    };
    let throttle = "{ signal = \"Throttle\", range = [0, 100], points = 7 }";
    let all = [
        reported("\"Throttle\", range", "\"Throtle\", range"),
        reported(throttle, "{ signal = \"Throttle\", points = 7 }"),
        reported("range = [0, 100]", "range = [100, 0]"),
        reported("range = [0, 100], points = 7", "range = [0, 100], points = 0"),
        reported("range = [0, 100], points = 7", "range = [0, 100], points = 1, shape = \"linear\""),
        reported("range = [0, 100], points = 7", "range = [0, 100], points = 7, from = \"50s\""),
        reported("range = [0, 100], points = 7", "range = [0, 100], points = 7, every = \"10ms\""),
        reported("\"Brake\", range", "\"Throttle\", range"),
        reported("[falsify]\n", "[falsify]\nparameter = [{ path = \"plnt.car.drag\", range = [0, 1] }]\n"),
        reported("[falsify]\n", "[falsify]\nparameter = [{ path = \"plant.car.drga\", range = [0, 1] }]\n"),
    ];
    insta::assert_snapshot!(all.join("\n"));
    let shear = scenario("shear");
    let said = typed(&shear, &["falsify", "."]);
    assert!(said.code == Some(2) && said.err.contains("does not say what may be varied"), "{said:?}");
}
