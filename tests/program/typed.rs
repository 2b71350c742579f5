//! Typing a command and looking at what comes of it.

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};

/// How often something of chance is tried until it is seen.
pub(crate) const ROUNDS: usize = 10;

/// The folder of a scenario of the project.
pub(crate) fn scenario(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios").join(name)
}

/// A path as a word that is typed.
pub(crate) fn utf8(path: &Path) -> &str {
    path.to_str().expect("UTF-8")
}

/// The program, to be started in `folder`.
pub(crate) fn onescan(folder: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_onescan-under-test"));
    // In a job of a CI server, `test` says more.
    command.current_dir(folder).env_remove("ONESCAN_LOG").env_remove("CI").env("NO_COLOR", "1");
    command
}

/// What a command said, and its exit code.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Said {
    pub(crate) out: String,
    pub(crate) err: String,
    pub(crate) code: Option<i32>,
}

impl From<Output> for Said {
    fn from(output: Output) -> Self {
        let err = String::from_utf8(output.stderr).expect("text");
        Self {
            out: String::from_utf8(output.stdout).expect("text"),
            // That a file was written is said for each of them, and looked at in `output.rs`.
            err: err.split_inclusive('\n').filter(|line| !line.starts_with(WROTE)).collect(),
            code: output.status.code(),
        }
    }
}

/// How a line begins that says what was written.
pub(crate) const WROTE: &str = " INFO wrote ";

/// Types a command in `folder` and waits for its end.
pub(crate) fn typed(folder: &Path, words: &[&str]) -> Said {
    onescan(folder).args(words).output().expect("the program starts").into()
}

/// Types a command in `folder` and goes on.
pub(crate) fn begun(folder: &Path, words: &[&str]) -> Child {
    onescan(folder).args(words).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the program starts")
}

/// `onescan run shear` with more words and JSON output; one object a run.
pub(crate) fn run_shear(words: &[&str]) -> (Vec<serde_json::Value>, Said) {
    let shear = scenario("shear");
    let mut all = vec!["run", ".", "--format", "json"];
    all.extend_from_slice(words);
    let said = typed(&shear, &all);
    let reports = said.out.lines().map(|line| serde_json::from_str(line).expect("JSON lines")).collect();
    (reports, said)
}

/// The digests of runs that must have been completed.
pub(crate) fn digests(reports: &[serde_json::Value]) -> Vec<String> {
    let digest = |report: &serde_json::Value| {
        assert_eq!(report["status"], "completed", "{report}");
        report["digest"].as_str().expect("a digest").to_owned()
    };
    reports.iter().map(digest).collect()
}

/// The values of these signals in each row that a run has recorded for spreadsheets.
pub(crate) fn rows(run: &Path, signals: &[&str]) -> Vec<Vec<f64>> {
    let text = std::fs::read_to_string(run.join("trajectory.csv")).expect("a recording");
    let mut lines = text.lines();
    let head: Vec<&str> = lines.next().expect("a head").split(',').collect();
    let columns: Vec<usize> =
        signals.iter().map(|name| head.iter().position(|known| known == name).expect("recorded")).collect();
    let row = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        columns.iter().map(|at| cells[*at].parse().unwrap_or(f64::NAN)).collect()
    };
    lines.map(row).collect()
}

/// Runs a file of a scenario over TCP, and again from a checkpoint: both have the digest of the whole run in one process.
pub(crate) fn is_the_same_over_tcp_and_resumed(name: &str, file: &str, until: &str, save_at: &str) {
    let folder = tempfile::tempdir().unwrap();
    let saved = folder.path().join("checkpoint");
    let saved = saved.to_str().expect("UTF-8");
    let digest = |words: &[&str]| {
        let all = [&["run", file, "--format", "json", "--until", until], words].concat();
        let said = typed(&scenario(name), &all);
        let report: serde_json::Value = serde_json::from_str(said.out.trim()).unwrap_or_else(|_| panic!("{said:?}"));
        digests(&[report])
    };
    let whole = digest(&["--save-at", save_at, "--save", saved]);
    assert_eq!(digest(&["--transport", "tcp"]), whole, "{name}/{file} over TCP");
    assert_eq!(digest(&["--resume", saved]), whole, "{name}/{file} from {save_at} on");
}

/// A copy of the shear in a folder of its own, to be broken.
pub(crate) fn copied_shear() -> tempfile::TempDir {
    copied("shear")
}

/// The same whose cases expect nothing beside what the scenario does, so that a change shows in snapshots alone.
pub(crate) fn copied_shear_of_snapshots() -> tempfile::TempDir {
    let folder = copied_shear();
    let path = folder.path().join("cases.toml");
    let text = std::fs::read_to_string(&path).expect("a file");
    let blocks = text.split("\n\n").filter(|block| !block.contains("[[case.expect]]"));
    std::fs::write(path, blocks.collect::<Vec<_>>().join("\n\n")).expect("a file");
    folder
}

/// A copy of a scenario of the project in a folder of its own, to be broken.
pub(crate) fn copied(name: &str) -> tempfile::TempDir {
    copied_from(&scenario(name))
}

/// A copy of a folder.
pub(crate) fn copied_from(from: &Path) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    copy(from, folder.path());
    folder
}

fn copy(from: &Path, to: &Path) {
    for entry in std::fs::read_dir(from).expect("a folder") {
        let entry = entry.expect("an entry");
        let target = to.join(entry.file_name());
        if entry.file_type().expect("a type").is_dir() {
            std::fs::create_dir(&target).expect("a folder");
            copy(&entry.path(), &target);
        } else {
            std::fs::copy(entry.path(), target).expect("a file");
        }
    }
}

/// Changes `from` to `to` in a file, which must have it.
pub(crate) fn edit(folder: &Path, file: &str, from: &str, to: &str) {
    let path = folder.join(file);
    let text = std::fs::read_to_string(&path).expect("a file");
    assert!(text.contains(from), "{file} has no {from:?}");
    std::fs::write(path, text.replace(from, to)).expect("a file");
}

/// Lets git do something in a folder, always at the same time by the same author.
pub(crate) fn git(folder: &Path, words: &[&str]) {
    let output = Command::new("git")
        .current_dir(folder)
        .args(["-c", "user.name=An Engineer", "-c", "user.email=engineer@example.com", "-c", "commit.gpgsign=false"])
        .args(words)
        .env("GIT_AUTHOR_DATE", "2024-05-06T07:08:09Z")
        .env("GIT_COMMITTER_DATE", "2024-05-06T07:08:09Z")
        .output()
        .expect("git is on the machine");
    assert!(output.status.success(), "{words:?} {}", String::from_utf8_lossy(&output.stderr));
}

/// What was said, without the ends of lines that the width of a terminal makes.
pub(crate) fn flat(text: &str) -> String {
    text.replace('│', " ").split_whitespace().collect::<Vec<_>>().join(" ")
}
