//! Steps of a recording reach the disk before their part is full, and what it is in the end does not depend on that.

use std::collections::BTreeMap;
use std::path::Path;

use onescan_recording::{Choice, FlushPolicy, Recorder, Recording};
use onescan_server::lockstep::Lockstep;
use onescan_server::plan::Coupling;
use onescan_server::signal::SignalType;
use onescan_tests::run::{boxed, in_process, provenance};
use onescan_tests::toy::Mixer;
use onescan_tests::{at_ms, plan, span_ms};

const ALL: Choice = Choice { signals: Vec::new(), csv: true, mcap: true };

/// A session of two clients with steps of 10 ms, recorded in all forms.
fn session(folder: &Path, flush_policy: FlushPolicy) -> Lockstep {
    let step = span_ms(10);
    let signals = [("a.out", SignalType::ULINT, "a"), ("b.out", SignalType::ULINT, "b")];
    let plan = plan(step, &Coupling::Parallel, &signals, &["a", "b"]);
    let mut lockstep = in_process(plan, boxed([Mixer::new("a", step, &["b"]), Mixer::new("b", step, &["a"])]));
    lockstep.observe(Box::new(Recorder::new(folder, provenance(), ALL).writing(flush_policy)));
    lockstep
}

/// All files of a recording with their bytes.
fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(inner) = folders.pop() {
        for entry in std::fs::read_dir(inner).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else {
                let name = path.strip_prefix(folder).unwrap().display().to_string();
                found.insert(name, std::fs::read(path).unwrap());
            }
        }
    }
    found
}

/// A copy of a recording as a kill would leave it now.
fn killed(folder: &Path) -> tempfile::TempDir {
    let copy = tempfile::tempdir().unwrap();
    for (name, bytes) in files(folder) {
        let path = copy.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, bytes).unwrap();
    }
    copy
}

#[test]
fn a_killed_recording_has_all_that_was_written() {
    let (folder, whole) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    session(whole.path(), FlushPolicy::Steps(u64::MAX)).run_to(at_ms(5_000)).unwrap();
    let mut lockstep = session(folder.path(), FlushPolicy::Steps(7));
    // Within the first part, at its end, behind it; within a later one.
    for (at, written) in [(0, 0), (60, 0), (70, 7), (90, 7), (620, 56), (630, 63), (640, 63), (700, 70), (4_130, 413)] {
        lockstep.run_to(at_ms(at)).unwrap();
        let copy = killed(folder.path());
        let recording = Recording::open(copy.path()).unwrap();
        let rows = recording.rows(&[], 0..=written).unwrap();
        assert_eq!(recording.steps(), Some(0..=written), "at {at} ms");
        assert_eq!(rows.rows.len() as u64, written + 1);
        for row in &rows.rows {
            assert_eq!(recording.digest(row.step.0).unwrap(), row.digest);
        }
        let lines = std::fs::read_to_string(copy.path().join("trajectory.csv")).unwrap().lines().count() as u64;
        assert_eq!(lines, written + 2, "a line a step, and one with the names");
    }
}

#[test]
fn a_recording_is_the_same_in_every_rhythm() {
    let flush_policies = [
        FlushPolicy::Steps(u64::MAX),
        FlushPolicy::Steps(1),
        FlushPolicy::Steps(7),
        FlushPolicy::Steps(64),
        FlushPolicy::WallClock,
    ];
    let recorded = flush_policies.map(|flush_policy| {
        let folder = tempfile::tempdir().unwrap();
        let mut lockstep = session(folder.path(), flush_policy);
        lockstep.set_until(Some(at_ms(3_010)));
        lockstep.run().unwrap();
        files(folder.path())
    });
    for other in &recorded[1..] {
        assert!(recorded[0].keys().eq(other.keys()), "{:?}", other.keys());
        assert!(recorded[0] == *other);
    }
}

/// A kill between a part's taking its name and the end of what it takes the place of.
#[test]
fn what_a_part_has_taken_the_place_of_counts_no_more() {
    let folder = tempfile::tempdir().unwrap();
    let mut lockstep = session(folder.path(), FlushPolicy::Steps(10));
    lockstep.run_to(at_ms(500)).unwrap();
    let early = files(folder.path());
    lockstep.run_to(at_ms(700)).unwrap();
    for (name, bytes) in early.iter().filter(|(name, _)| name.contains("part-000001.")) {
        std::fs::write(folder.path().join(name), bytes).unwrap();
    }
    assert!(folder.path().join("trajectory/part-000001.parquet").is_file());
    assert!(folder.path().join("trajectory/part-000001.000001.parquet").is_file());
    assert_eq!(Recording::open(folder.path()).unwrap().steps(), Some(0..=70));
}
