//! The work of campaigns: forked from the run without faults, kept, gone on with, done in parts and put together.

use std::collections::BTreeSet;
use std::path::Path;

use serde_json::Value;

use crate::typed::{Said, begun, copied, copied_shear, digests, scenario, typed};

/// Faults at the set-up, at times, on conditions that come true, with a past, and on one that never does.
const CAMPAIGN: &str = r#"
version = 1

[[campaign]]
name = "feedback"
until = "3s"
detected = "eventually[0,400ms] Strokes >= 3"

fault = [
    { name = "sensor-off", kind = "hardware", force = { signal = "Sensor_1", value = false } },
    { name = "frame-lost", kind = "hardware", disturbance = { client = "plant", kind = "lost", rate = 0.4 } },
    { name = "noisy", kind = "hardware", disturbance = { signals = ["Position_1", "Position_2"], kind = "noisy", sigma = 0.002 } },
    { name = "count", kind = "software", variable = { variable = "Shear.Strokes", value = 7 } },
]

activation = [
    { name = "start", at = "0s" },
    { name = "first-step", at = "10ms", for = "500ms" },
    { name = "off-grid", at = "1203ms", for = "1s" },
    { name = "third-stroke", when = "rose(Actuator_1_Down)", nth = 3, for = "300ms" },
    { name = "a-while-after", when = "once[100ms,200ms] fell(Sensor_1)" },
    { name = "late", when = "rose(Sensor_1)", from = "2s" },
    { name = "never", when = "Strokes > 40 and once Sensor_1" },
]
"#;

fn shear() -> tempfile::TempDir {
    let folder = copied_shear();
    std::fs::write(folder.path().join("cases.toml"), CAMPAIGN).expect("a file");
    folder
}

fn campaign(folder: &Path, words: &[&str]) -> Said {
    typed(folder, &[&["campaign", "."], words].concat())
}

/// Jobs add to one journal, and one that looks while another writes begins a line of its own: that leaves an empty one.
fn lines(text: &str) -> Vec<Value> {
    text.lines().filter(|line| !line.is_empty()).map(|line| serde_json::from_str(line).expect("JSON lines")).collect()
}

fn every_run_is_that_of_its_case(folder: &Path) {
    let said = campaign(folder, &["--format", "json"]);
    let mut runs = 0;
    for row in lines(&said.out).iter().filter(|row| row["case"].is_string()) {
        let case = row["case"].as_str().expect("a case");
        let alone = typed(folder, &["run", ".", "--case", case, "--format", "json"]);
        assert_eq!(digests(&lines(&alone.out)), [row["digest"].as_str().expect("a digest")], "{case}");
        runs += 1;
    }
    assert!(runs >= 20, "{said:?}");
}

#[test]
fn a_run_that_forks_has_the_digest_of_one_from_the_start() {
    every_run_is_that_of_its_case(shear().path());
}

#[test]
fn so_it_is_for_a_plant_with_bodies_and_failures() {
    every_run_is_that_of_its_case(&scenario("filling-machine"));
}

#[test]
fn a_state_that_is_the_healthy_one_again_is_reported() {
    let said = campaign(shear().path(), &["--format", "json"]);
    let rows = lines(&said.out);
    let rejoined = |case: &str| {
        let row = rows.iter().find(|row| row["case"] == format!("feedback/{case}")).expect("a case");
        row["rejoined"].as_bool()
    };
    assert_eq!(rejoined("noisy/never"), Some(true), "nothing happened");
    assert_eq!(rejoined("count/off-grid"), Some(false), "it has another number of strokes");
    // Noise on the positions changes what is seen of them, and nothing that lasts.
    assert_eq!(rejoined("noisy/first-step"), Some(true));
    assert_eq!(rejoined("noisy/start"), Some(false), "it lasts to the end");
}

/// Where nothing of a fault is left its run ends, and nothing that is said of it is another thing.
#[test]
fn a_run_that_comes_together_with_the_healthy_one_ends_there() {
    let mut joined = 0;
    for (folder, name) in [(shear(), "feedback"), (copied("filling-machine"), "")] {
        let named = [name];
        let chosen = if name.is_empty() { &[][..] } else { &named[..] };
        let table =
            |words: &[&str]| lines(&campaign(folder.path(), &[chosen, words, &["--format", "json"]].concat()).out);
        let (mut early, whole) = (table(&[]), table(&["--no-merge"]));
        for (row, full) in early.iter_mut().zip(&whole) {
            assert!(full["joined_ns"].is_null(), "{full}");
            let Some(at) = row.as_object_mut().and_then(|row| row.remove("joined_ns")) else { continue };
            joined += 1;
            assert!(at.as_u64() >= full["activated_ns"].as_u64(), "{full}");
            assert_eq!(full["rejoined"], true, "{full}");
        }
        assert_eq!(early, whole, "{name}");
    }
    assert!(joined >= 3, "{joined} runs ended early");
}

/// Lines of the journal of `folder`/keep.
fn journal(folder: &Path) -> String {
    std::fs::read_to_string(folder.join("keep/feedback/journal.jsonl")).expect("a journal")
}

#[test]
fn work_that_was_killed_goes_on_where_it_was() {
    let folder = shear();
    let keep = |words: &[&str]| campaign(folder.path(), &[&["--keep", "keep"], words].concat());
    let whole = keep(&["--html", "whole.html", "--junit", "whole.xml"]);
    assert_eq!((whole.code, whole.err.as_str()), (Some(1), ""));
    let complete = journal(folder.path());
    let file = |name: &str| std::fs::read(folder.path().join(name)).expect("a file");
    // What a process leaves that is killed while it writes: any prefix of the journal.
    for part in 1..=20 {
        let cut = complete.len() * part / 21;
        std::fs::write(folder.path().join("keep/feedback/journal.jsonl"), &complete[..cut]).expect("a file");
        let again = keep(&["--html", "again.html", "--junit", "again.xml"]);
        assert_eq!((again.code, &again.out, again.err.as_str()), (whole.code, &whole.out, ""), "cut at byte {cut}");
        assert_eq!(file("again.html"), file("whole.html"), "cut at byte {cut}");
        assert_eq!(file("again.xml"), file("whole.xml"), "cut at byte {cut}");
        let all = journal(folder.path());
        let whole_bytes = complete[..cut].rfind('\n').map_or(0, |last| last + 1);
        assert!(all.starts_with(&complete[..whole_bytes]), "what is done stays");
        let cases: Vec<String> =
            lines(&all).iter().filter_map(|line| Some(line["done"]["case"].as_str()?.to_owned())).collect();
        assert_eq!(cases.iter().collect::<BTreeSet<_>>().len(), cases.len(), "no run twice");
        assert_eq!(cases.len(), 24, "those that never come true are the run without faults");
    }
    // All is done: nothing is run, so the checkpoints are not missed.
    std::fs::remove_dir_all(folder.path().join("keep/feedback/forks")).expect("a folder");
    assert_eq!(keep(&[]).out, whole.out);
}

/// Killed as soon as it has noted another run, again and again, until nothing is left to do.
#[test]
fn a_campaign_that_is_killed_again_and_again_comes_to_the_same() {
    let folder = shear();
    let whole = campaign(folder.path(), &[]);
    let path = folder.path().join("keep/feedback/journal.jsonl");
    let noted = || std::fs::read_to_string(&path).map_or(0, |text| text.matches('\n').count());
    let mut kills = 0;
    loop {
        let (before, words) = (noted(), ["campaign", ".", "--keep", "keep", "--jobs", "2"]);
        let mut child = begun(folder.path(), &words);
        while noted() <= before && child.try_wait().expect("a state").is_none() {
            std::thread::yield_now();
        }
        if child.try_wait().expect("a state").is_some() {
            break;
        }
        child.kill().expect("it can be killed");
        child.wait().expect("it has ended");
        kills += 1;
    }
    assert!(kills >= 3, "killed {kills} times");
    assert_eq!(campaign(folder.path(), &["--keep", "keep"]).out, whole.out);
}

#[test]
fn parts_put_together_are_the_whole_to_the_byte() {
    let folder = shear();
    let whole = campaign(folder.path(), &["--html", "whole.html", "--junit", "whole.xml"]);
    let mut folders = Vec::new();
    for part in 1..=8 {
        let (keep, part) = (format!("part{part}"), format!("{part}/8"));
        let said = campaign(folder.path(), &["--keep", &keep, "--partition", &part]);
        assert_eq!((said.code, said.err.as_str()), (Some(0), ""), "{said:?}");
        folders.push(keep);
    }
    let merge = |folders: &[String], words: &[&str]| {
        let folders: Vec<&str> = folders.iter().map(String::as_str).collect();
        typed(folder.path(), &[&["campaign", "merge", "."], folders.as_slice(), words].concat())
    };
    let merged = merge(&folders, &["--html", "merged.html", "--junit", "merged.xml"]);
    assert_eq!((merged.code, &merged.out, merged.err.as_str()), (whole.code, &whole.out, ""));
    let file = |name: &str| std::fs::read(folder.path().join(name)).expect("a file");
    assert_eq!((file("merged.html"), file("merged.xml")), (file("whole.html"), file("whole.xml")));
    let json = campaign(folder.path(), &["--format", "json"]);
    assert_eq!(merge(&folders, &["--format", "json"]).out, json.out);
    let missing = merge(&folders[..7], &[]);
    assert_eq!((missing.code, missing.out.as_str()), (Some(2), ""));
    insta::assert_snapshot!("a_part_is_missing", missing.err);
}

#[test]
fn work_of_something_else_is_refused() {
    let folder = shear();
    let keep = ["--keep", "keep"];
    campaign(folder.path(), &keep);
    let refused = |words: &[&str]| {
        let said = campaign(folder.path(), words);
        assert_eq!((said.code, said.out.as_str()), (Some(2), ""), "{said:?}");
        said.err
    };
    let mut reported = vec![refused(&["--partition", "1/2"]), refused(&["--keep", "keep", "--partition", "3/2"])];
    let program = folder.path().join("plc/shear.st");
    let text = std::fs::read_to_string(&program).expect("a file");
    std::fs::write(&program, text + "\n// another program\n").expect("a file");
    reported.push(refused(&keep));
    let journal = folder.path().join("keep/feedback/journal.jsonl");
    std::fs::write(&journal, "{\"done\": 3}\n").expect("a file");
    reported.push(refused(&keep));
    std::fs::write(&journal, [0xff, 0xfe, 0, b'\n']).expect("a file");
    reported.push(refused(&keep));
    insta::assert_snapshot!(reported.join("\n"));
}
