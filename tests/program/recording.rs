//! `onescan run --record`, `onescan export`: recordings that others can open, whole or cut off.

use std::path::{Path, PathBuf};
use std::process::Command;

use onescan_recording::Recording;

use crate::typed::flat;
use crate::typed::{Said, begun, copied_shear, edit, run_shear, scenario, typed};
use crate::venv::python;

/// All files below a folder by their relative path.
fn files(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let mut found = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(next) = folders.pop() {
        for entry in std::fs::read_dir(next).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else {
                found.push((path.strip_prefix(folder).unwrap().to_owned(), std::fs::read(&path).unwrap()));
            }
        }
    }
    found.sort();
    found
}

/// What programs of others find in recordings.
fn seen_by_others(folders: &[PathBuf]) -> Vec<serde_json::Value> {
    let python = python("recordings-1", &["pyarrow==26.0.1", "mcap==1.6.0", "mcap-protobuf-support==0.6.0"]);
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("peers/recordings.py");
    let output = Command::new(python).arg(script).args(folders).output().expect("the peer starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).expect("the peer writes text");
    text.lines().map(|line| serde_json::from_str(line).expect("JSON lines")).collect()
}

#[test]
fn equal_runs_have_equal_recordings() {
    let folder = tempfile::tempdir().unwrap();
    let (reports, said) = run_shear(&[
        "--until",
        "3s",
        "--runs",
        "2",
        "--record",
        folder.path().to_str().unwrap(),
        "--record-also",
        "csv,mcap",
    ]);
    assert_eq!(said.code, Some(0), "{said:?}");
    let [one, two] = ["run-1", "run-2"].map(|run| files(&folder.path().join(run)));
    let names: Vec<String> = one.iter().map(|(path, _)| path.display().to_string()).collect();
    insta::assert_snapshot!(names.join("\n"));
    for ((path, ours), (_, theirs)) in one.iter().zip(&two) {
        assert!(ours == theirs || path == Path::new("run.json"), "{} differs", path.display());
    }
    let recording = Recording::open(&folder.path().join("run-1")).unwrap();
    assert_eq!(recording.steps(), Some(0..=300));
    assert_eq!(recording.digest(300).unwrap().to_string(), reports[0]["digest"]);
    let again = typed(&recording.scenario(), &["run", ".", "--format", "json", "--until", "3s"]);
    assert!(again.out.contains(reports[0]["digest"].as_str().unwrap()), "{again:?}");
}

#[test]
fn programs_of_others_read_what_was_recorded() {
    let folder = tempfile::tempdir().unwrap();
    let record = folder.path().to_str().unwrap();
    let (reports, _) = run_shear(&["--until", "3s", "--record", record, "--record-also", "csv,mcap"]);
    let seen = &seen_by_others(&[folder.path().join("run-1")])[0];
    assert_eq!(seen["parquet"]["rows"], 301);
    assert_eq!(seen["parquet"]["digest"], reports[0]["digest"]);
    assert_eq!(seen["csv"]["rows"], 301);
    assert_eq!(seen["mcap"]["messages"], serde_json::json!({ "/plant": 301, "/plc": 301 }));
    assert_eq!(seen["mcap"]["whole"], true);
    let (last, csv) = (&seen["parquet"]["last"], &seen["csv"]["last"]);
    for (topic, signal) in [("/plant", "Position_1"), ("/plant", "Position_2"), ("/plc", "Strokes")] {
        let value = last[signal].as_f64().unwrap();
        assert_eq!(seen["mcap"]["last"][topic][signal].as_f64(), Some(value), "{signal}");
        assert_eq!(csv[signal].as_str().unwrap().parse(), Ok(value), "{signal}");
    }
    assert_eq!(seen["mcap"]["last"]["/plc"]["t_v_ns"].to_string(), "3000000000".to_owned());
}

/// Killed at any moment a recording opens, with all steps up to its last part.
#[cfg(unix)]
#[test]
fn killed_at_any_moment_a_recording_opens() {
    let folder = tempfile::tempdir().unwrap();
    let whole = folder.path().join("whole");
    let (_, said) = run_shear(&["--until", "120s", "--record", whole.to_str().unwrap()]);
    assert_eq!(said.code, Some(0), "{said:?}");
    let whole = Recording::open(&whole).unwrap();
    let mut seed = 20_u64;
    let mut runs = Vec::new();
    for number in 0..20 {
        // Knuth's MMIX generator: the moments are the same in every test run, as far as bytes show them.
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let bytes = (seed >> 33) % 400_000;
        let record = folder.path().join(format!("killed-{number}"));
        let words = ["run", ".", "--until", "120s", "--record", record.to_str().unwrap(), "--record-also", "csv,mcap"];
        let mut run = begun(&scenario("shear"), &words);
        let csv = record.join("run-1/trajectory.csv");
        let reached = || std::fs::metadata(&csv).is_ok_and(|file| file.len() >= bytes);
        while !reached() && run.try_wait().unwrap().is_none() {
            std::thread::yield_now();
        }
        run.kill().unwrap();
        run.wait().unwrap();
        runs.push(record.join("run-1"));
    }
    for (folder, seen) in runs.iter().zip(seen_by_others(&runs)) {
        let recording = Recording::open(folder).unwrap();
        let rows = recording.steps().map_or(0, |steps| steps.end() + 1);
        assert_eq!(seen["parquet"]["rows"], rows);
        if rows > 0 {
            assert_eq!(seen["parquet"]["digest"], whole.digest(rows - 1).unwrap().to_string());
        }
        // Each part is one block here: the other forms are a part ahead or behind at most.
        let near = |count: u64| count.abs_diff(rows) <= 1_000;
        let csv = seen["csv"]["rows"].as_u64().unwrap();
        assert!(near(csv), "{csv} rows of CSV, {rows} of Parquet");
        for topic in ["/plant", "/plc"] {
            let messages = seen["mcap"]["messages"][topic].as_u64().unwrap_or(0);
            assert!(near(messages), "{messages} messages, {rows} rows");
        }
    }
}

#[test]
fn what_is_exported_is_what_was_recorded() {
    let folder = tempfile::tempdir().unwrap();
    let record = folder.path().to_str().unwrap();
    run_shear(&["--until", "3s", "--record", record, "--record-also", "csv,mcap"]);
    let out = |name: &str| folder.path().join(name);
    for form in ["csv", "mcap"] {
        let file = out(&format!("out.{form}"));
        let said = typed(folder.path(), &["export", "run-1", "-o", file.to_str().unwrap()]);
        assert_eq!(said.code, Some(0), "{said:?}");
        let recorded = std::fs::read(out("run-1").join(format!("trajectory.{form}"))).unwrap();
        assert!(std::fs::read(&file).unwrap() == recorded, "{form} differs");
    }
    let words = ["export", ".", "-o", "some.csv", "--signals", "Pos*", "--from", "990ms", "--to", "1010ms"];
    assert_eq!(typed(folder.path(), &words).code, Some(0));
    insta::assert_snapshot!(std::fs::read_to_string(out("some.csv")).unwrap());
    assert_eq!(typed(folder.path(), &["export", ".", "-o", "one.parquet"]).code, Some(0));
    assert!(std::fs::read(out("one.parquet")).unwrap().starts_with(b"PAR1"));
}

#[test]
fn chosen_signals_are_recorded_and_the_digest_is_that_of_all() {
    let folder = tempfile::tempdir().unwrap();
    let record = folder.path().to_str().unwrap();
    let (plain, _) = run_shear(&["--until", "1s"]);
    let (reports, _) =
        run_shear(&["--until", "1s", "--record", record, "--record-signals", "Position_?", "--record-also", "csv"]);
    assert_eq!(reports[0]["digest"], plain[0]["digest"]);
    let csv = std::fs::read_to_string(folder.path().join("run-1/trajectory.csv")).unwrap();
    assert_eq!(csv.lines().next(), Some("t_v_ns,Position_1,Position_2"));
    let recording = Recording::open(folder.path()).unwrap();
    assert_eq!(recording.digest(100).unwrap().to_string(), plain[0]["digest"]);
}

#[test]
fn what_cannot_be_is_reported() {
    let folder = copied_shear();
    let mut text = String::new();
    let mut say = |words: &[&str]| {
        let said = typed(folder.path(), words);
        text += &["$ onescan ", &words.join(" "), "\n", &said.out, &said.err, "\n"].concat();
        assert_eq!(said.code, Some(2), "{said:?}");
    };
    say(&["run", ".", "--record", "r", "--record-signals", "Positoin_1"]);
    say(&["export", ".", "-o", "x.csv"]);
    run_in(folder.path(), &["run", ".", "--until", "1s", "--runs", "2", "--record", "r"]);
    say(&["export", "r", "-o", "x.csv"]);
    say(&["export", "r/run-1", "-o", "x.txt"]);
    say(&["export", "r/run-1", "-o", "x.csv", "--signals", "Drive*"]);
    say(&["export", "r/run-1", "-o", "x.csv", "--from", "2s"]);
    let part = folder.path().join("r/run-1/trajectory/part-000001.parquet");
    std::fs::write(&part, b"PAR1 nonsense PAR1").unwrap();
    say(&["export", "r/run-1", "-o", "x.csv"]);
    edit(folder.path(), "r/run-2/recording.json", "\"recording\": 1", "\"recording\": 7");
    say(&["export", "r/run-2", "-o", "x.csv"]);
    insta::assert_snapshot!(text);
    assert!(!folder.path().join("x.csv").exists(), "nothing is half-written");
}

fn run_in(folder: &Path, words: &[&str]) {
    let said = typed(folder, words);
    assert_eq!(said.code, Some(0), "{said:?}");
}

/// Two runs that record into one folder would mix their files.
#[test]
fn one_run_records_into_a_folder_at_a_time() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let place = out.to_str().unwrap();
    let served = crate::web::Served::begin("shear", &["--until", "1h", "--record", place]);
    for more in [&[][..], &["--overwrite"]] {
        let said = typed(&scenario("shear"), &[&["run", ".", "--until", "100ms", "--record", place], more].concat());
        assert_eq!(said.code, Some(2), "{said:?}");
        let is_said = said.err.contains("another run records into") || said.err.contains("holds an earlier recording");
        assert!(is_said, "{said:?}");
    }
    let mut viewer = served.view();
    crate::web::ask(&mut viewer, &serde_json::json!({"type": "operate", "operation": "stop"}));
    let report = served.report();
    assert_eq!(report["status"], "stopped");
    let own: serde_json::Value = serde_json::from_slice(&std::fs::read(out.join("run-1/run.json")).unwrap()).unwrap();
    assert_eq!(own["digest"], report["digest"], "the recording is the first run's");
    assert!(!out.join("run-1/.recording.lock").exists());
    let after = typed(&scenario("shear"), &["run", ".", "--until", "100ms", "--record", place, "--overwrite"]);
    assert_eq!(after.code, Some(0), "{after:?}");
}

/// A run of a virtual hour that records into `out`, once it has some steps on the disk.
fn recording(out: &Path, more: &[&str]) -> std::process::Child {
    let words = ["run", ".", "--until", "1h", "--pace", "1", "--record", out.to_str().unwrap()];
    let described = || std::fs::metadata(out.join("run-1/recording.json")).and_then(|file| file.modified()).ok();
    // A recording that is replaced has the same files.
    let earlier = described();
    let mut run = begun(&scenario("shear"), &[&words[..], more].concat());
    let parts = || std::fs::read_dir(out.join("run-1/trajectory")).into_iter().flatten().flatten();
    let is_part = |entry: std::fs::DirEntry| entry.file_name().to_string_lossy().starts_with("part-");
    while !(described().is_some() && described() != earlier && parts().any(is_part)) {
        assert!(run.try_wait().unwrap().is_none(), "{:?}", Said::from(run.wait_with_output().unwrap()));
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    run
}

fn killed(mut run: std::process::Child) {
    run.kill().expect("it runs");
    run.wait().expect("it ends");
}

/// What is not whole is not taken for a whole run, and a recording that it was to replace is still there.
#[test]
fn a_recording_that_is_cut_short_says_so_and_replaces_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let place = out.to_str().unwrap();
    let csv = folder.path().join("x.csv");
    let export = |of: &str| {
        let said = typed(folder.path(), &["export", of, "-o", csv.to_str().unwrap()]);
        assert_eq!(said.code, Some(0), "{said:?}");
        flat(&said.err)
    };
    let run = recording(&out, &[]);
    assert!(export(place).contains("is being recorded: it holds steps 0 to "));
    killed(run);
    assert!(export(place).contains("is cut short, its run has not come to its end: it holds steps 0 to "));
    // One that is cut short is replaced by a whole one, and leaves nothing of its own.
    let whole = ["run", ".", "--until", "200ms", "--record", place, "--record-also", "csv", "--overwrite"];
    assert_eq!(typed(&scenario("shear"), &whole).code, Some(0));
    assert_eq!(export(place), "");
    let report = std::fs::read(out.join("run-1/run.json")).unwrap();
    // A session that does not begin costs nothing.
    let none = ["run", ".", "--record", place, "--overwrite", "--opcua-client", "plc", "--join-timeout", "100ms"];
    let said = typed(&scenario("shear"), &none);
    assert_eq!(said.code, Some(3), "{said:?}");
    assert_eq!((std::fs::read(out.join("run-1/run.json")).unwrap(), export(place)), (report.clone(), String::new()));
    // Twice cut short: the whole one is kept both times.
    for _ in 0..2 {
        killed(recording(&out, &["--overwrite"]));
        assert!(export(place).contains("what it was to replace is in "));
        assert!(!out.join("run-1/trajectory.csv").exists(), "nothing of the other is mixed in");
        assert_eq!(std::fs::read(out.join("run-1/.earlier/run.json")).unwrap(), report);
        assert_eq!(export(out.join("run-1/.earlier").to_str().unwrap()), "");
    }
    assert_eq!(typed(&scenario("shear"), &[&whole[..6], &["--overwrite"]].concat()).code, Some(0));
    assert_eq!((export(place), out.join("run-1/.earlier").exists()), (String::new(), false));
    assert!(!out.join("run-1/trajectory.csv").exists(), "this run wrote none");
}
