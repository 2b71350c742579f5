//! Files of other versions of the program: those that older versions wrote are kept in `tests/formats` and must be read,
//! or refused with a message that `docs/formats.md` lists.

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::typed::{Said, copied, copied_from, digests, edit, scenario, typed, utf8};

/// A recording of half a second with an operator's action.
const RECORDING: &str = "run-1";
/// Of the same scenario without that action, halfway.
const CHECKPOINT: &str = "halfway.checkpoint";
const SNAPSHOT: &str = "default.traj";

/// One force of a sensor; it takes effect with the next commit.
const EVENTS: &str = "{\"step\":5,\"t_v_ns\":50000000,\"event\":\"operator\",\"action\":\"force\",\
                      \"signal\":\"Sensor_1\",\"value\":\"TRUE\"}\n";

/// What `scenario.toml` of the shear is followed by in the small scenario: what a snapshot and a report contain.
const SMALL: &str = "[plot]\nsignals = [\"Position_1\", \"Aligned\"]\n\n\
                     [[report.count]]\nname = \"strokes\"\nwhen = \"Actuator_1_Down\"\n";

/// With this variable the files of this version are written into `tests/formats`.
const UPDATE: &str = "UPDATE_FORMATS";

fn kept() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("formats")
}

/// The part of `docs/formats.md` that lists the messages.
fn promised() -> String {
    let page = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/formats.md")).expect("the page");
    let (_, part) = page.split_once("## What a file of another version is refused with").expect("the messages");
    part.to_owned()
}

/// All messages of the page, as its table has them.
fn messages() -> Vec<String> {
    let page = promised();
    let rows = page.lines().filter_map(|line| line.strip_prefix('|')?.split_once("| `"));
    rows.filter_map(|(_, message)| message.split('`').next()).map(without_numbers).collect()
}

/// The numbers of the page are examples.
fn without_numbers(message: &str) -> String {
    message.chars().map(|letter| if letter.is_ascii_digit() { '#' } else { letter }).collect()
}

/// Everything printed in one line: a message is broken where a line is full, and a test's stands in its output.
fn one_line(said: &Said) -> String {
    let printed = format!("{}\n{}", said.err, said.out);
    printed.replace(['│', '×'], " ").split_whitespace().collect::<Vec<_>>().join(" ")
}

/// The shear for half a second, with what is kept of it and nothing else.
fn small() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let text = fs::read_to_string(scenario("shear").join("scenario.toml")).expect("the shear");
    let (declared, _) = text.split_once("[[expect]]").expect("what is expected follows what is declared");
    let declared = declared.replace("until = \"6s\"", "until = \"500ms\"");
    assert!(declared.contains("500ms"), "the shear runs for another time now");
    fs::write(folder.path().join("scenario.toml"), declared + SMALL).expect("written");
    fs::create_dir(folder.path().join("plc")).expect("a folder");
    for file in ["plant.toml", "plc/shear.st", "plc/alignment.st"] {
        fs::copy(scenario("shear").join(file), folder.path().join(file)).expect("a file of the shear");
    }
    folder
}

/// Writes what is kept of a version into `folder`, which must not have it.
fn write(folder: &Path) {
    fs::create_dir_all(folder).expect("a folder");
    let small = small();
    let does = |words: &[&str]| {
        let said = typed(small.path(), words);
        assert_eq!(said.code, Some(0), "{words:?}: {said:?}");
    };
    fs::write(small.path().join("operator.jsonl"), EVENTS).expect("written");
    does(&["run", ".", "--replay-operator", "operator.jsonl", "--record", utf8(folder)]);
    does(&["run", ".", "--save-at", "250ms", "--save", utf8(&folder.join(CHECKPOINT))]);
    does(&["test", ".", "--bless"]);
    fs::copy(small.path().join("snapshots/default.traj"), folder.join(SNAPSHOT)).expect("the snapshot");
}

fn reports(said: &Said) -> Vec<Value> {
    said.out.lines().map(|line| serde_json::from_str(line).expect("JSON lines")).collect()
}

/// Reads everything that is kept in `folder`, in every way in which onescan reads it.
fn read(folder: &Path) {
    let name = folder.display();
    let recording = folder.join(RECORDING);
    // Nothing is written into the repository.
    let scenario = copied_from(&recording.join("scenario"));
    let type_in = |words: &[&str]| typed(scenario.path(), words);

    let same = type_in(&["diff", utf8(&recording), utf8(&recording)]);
    assert_eq!(same.code, Some(0), "{name}: {same:?}");
    let exported = type_in(&["export", utf8(&recording), "-o", "out.csv"]);
    assert_eq!(exported.code, Some(0), "{name}: {exported:?}");
    let rows = fs::read_to_string(scenario.path().join("out.csv")).expect("exported");
    assert_eq!(rows.lines().count(), 1 + 51, "{name}: a head, the start and 50 steps");
    let reported = type_in(&["report", utf8(&recording), "--format", "json"]);
    assert_eq!(reported.code, Some(0), "{name}: {reported:?}");
    assert_eq!(reports(&reported)[0]["report"]["counts"][0]["name"], "strokes", "{name}");
    let replayed = type_in(&["run", ".", "--replay-operator", utf8(&recording), "--format", "json"]);
    assert_eq!(replayed.code, Some(0), "{name}: {replayed:?}");

    let whole = type_in(&["run", ".", "--format", "json"]);
    assert_eq!(whole.code, Some(0), "{name}: {whole:?}");
    assert_ne!(digests(&reports(&whole)), digests(&reports(&replayed)), "{name}: the operator did something");
    let resumed = type_in(&["run", ".", "--resume", utf8(&folder.join(CHECKPOINT)), "--format", "json"]);
    if resumed.code == Some(0) {
        assert_eq!(digests(&reports(&resumed)), digests(&reports(&whole)), "{name}: the checkpoint is misread");
    } else {
        let refused = without_numbers(&one_line(&resumed));
        assert_eq!(resumed.code, Some(2), "{name}: {resumed:?}");
        assert!(messages().iter().any(|message| refused.contains(message.as_str())), "{name}: {refused}");
    }

    fs::create_dir(scenario.path().join("snapshots")).expect("a folder");
    fs::copy(folder.join(SNAPSHOT), scenario.path().join("snapshots").join(SNAPSHOT)).expect("the snapshot");
    let compared = type_in(&["test", ".", "--check", "--format", "json"]);
    // A trajectory may have changed since, for a reason that the changelog gives; the snapshot is read all the same.
    assert!(matches!(compared.code, Some(0 | 1)), "{name}: {compared:?}");
}

#[test]
fn files_of_this_version_and_of_older_ones_are_read() {
    let folder = tempfile::tempdir().expect("a folder");
    let own = folder.path().join("this-version");
    write(&own);
    read(&own);
    if std::env::var_os(UPDATE).is_some() {
        let target = kept().join(env!("CARGO_PKG_VERSION"));
        if target.exists() {
            fs::remove_dir_all(&target).expect("the old files go");
        }
        write(&target);
    }
    let Ok(versions) = fs::read_dir(kept()) else { return };
    for version in versions {
        let path = version.expect("an entry").path();
        if path.is_dir() {
            read(&path);
        }
    }
}

#[test]
fn what_this_version_resumes_it_resumes_to_the_same_digest() {
    let folder = tempfile::tempdir().expect("a folder");
    write(folder.path());
    let scenario = copied_from(&folder.path().join(RECORDING).join("scenario"));
    let resumed = typed(scenario.path(), &["run", ".", "--resume", utf8(&folder.path().join(CHECKPOINT))]);
    assert_eq!(resumed.code, Some(0), "its own checkpoint is not refused: {resumed:?}");
}

/// Exit code 2, and a message that the page lists.
fn is_refused(said: &Said, message: &str) {
    assert!(promised().contains(&format!("`{message}`")), "docs/formats.md does not list `{message}`");
    let found = one_line(said);
    assert!(said.code == Some(2) && found.contains(message), "`{message}` is not in {said:?}");
}

#[test]
fn a_version_of_a_text_that_is_not_known_is_refused_by_name() {
    let run: &[&str] = &["run", "."];
    let test: &[&str] = &["test", ".", "--check"];
    let cases = [
        (run, "scenario.toml", "version = 1", "version = 2", "version 2 of the scenario format is not known"),
        (run, "plant.toml", "version = 1", "version = 2", "scene format version 2 is not known"),
        (test, "cases.toml", "version = 1", "version = 2", "version 2 of the format of cases is not known"),
        (test, "snapshots/default.traj", "trajectory 1", "trajectory 2", "this program reads version 1"),
    ];
    for (words, file, from, to, message) in cases {
        let folder = copied("shear");
        edit(folder.path(), file, from, to);
        is_refused(&typed(folder.path(), words), message);
    }
    let folder = copied("shear");
    fs::write(folder.path().join("lessons.toml"), "version = 2\n").expect("written");
    is_refused(&typed(folder.path(), &["train", "."]), "version 2 of the format of lessons is not known");
}

#[test]
fn a_version_of_a_recording_or_a_checkpoint_that_is_not_known_is_refused_by_name() {
    let folder = tempfile::tempdir().expect("a folder");
    write(folder.path());
    let recording = folder.path().join(RECORDING);
    let scenario = copied_from(&recording.join("scenario"));
    let header = recording.join("recording.json");
    let text = fs::read_to_string(&header).expect("a header");
    let mut other: Value = serde_json::from_str(&text).expect("JSON");
    assert_eq!(other["recording"], 1, "docs/formats.md has another version");
    other["recording"] = 2.into();
    fs::write(&header, other.to_string()).expect("written");
    let said = typed(scenario.path(), &["diff", utf8(&recording), utf8(&recording)]);
    is_refused(&said, "version 2 of the layout of recordings is not known; this program knows 1");

    let checkpoint = folder.path().join(CHECKPOINT);
    let mut bytes = fs::read(&checkpoint).expect("a checkpoint");
    let version = b"onescan state ".len();
    assert_eq!(&bytes[..=version], b"onescan state 5", "docs/formats.md has another version");
    bytes[version] = b'4';
    fs::write(&checkpoint, bytes).expect("written");
    let said = typed(scenario.path(), &["run", ".", "--resume", utf8(&checkpoint)]);
    is_refused(&said, "a checkpoint of another version of onescan; take it again with this one");
}
