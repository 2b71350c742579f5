//! `onescan explore` beyond single edges: frames, orders, tasks, starts; equal states, and random schedules. On small
//! machines of two PLCs, of which one drives two signals and the other looks at them.

use std::path::Path;

use proptest::prelude::*;
use serde_json::Value;
use tempfile::TempDir;

use crate::typed::{Said, digests, edit, typed};

/// What the reader does with what it sees, in each of its scans.
const TOGETHER: &str = "IF A AND B AND NOT seen THEN n := n + 1; END_IF; \
                        IF A <> B THEN apart := apart + 1; END_IF; seen := A AND B;";

/// A machine: A changes each `a` steps of 10 ms and B each `b`; the reader scans each `scan_ms`.
fn machine(scan_ms: u64, (a, b): (u64, u64), program: &str, formula: &str, timing: &str) -> TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let write = |name: &str, text: String| std::fs::write(folder.path().join(name), text).expect("written");
    write(
        "source.st",
        format!(
            "PROGRAM Source VAR k : INT; END_VAR VAR_OUTPUT A, B : BOOL; END_VAR k := k + 1; \
             IF k MOD {a} = 0 THEN A := NOT A; END_IF; IF k MOD {b} = 0 THEN B := NOT B; END_IF; END_PROGRAM"
        ),
    );
    write(
        "reader.st",
        format!(
            "PROGRAM Reader VAR_INPUT A, B : BOOL; END_VAR VAR_OUTPUT n, apart : INT; END_VAR \
             VAR seen : BOOL; t : TON; END_VAR \
             {program} t(IN := A, PT := T#30ms); END_PROGRAM"
        ),
    );
    write(
        "machine.toml",
        format!(
            r#"version = 1
step = "10ms"
until = "300ms"

[signals]
A = {{ type = "BOOL", writer = "source" }}
B = {{ type = "BOOL", writer = "source" }}
n = {{ type = "INT", writer = "reader" }}
apart = {{ type = "INT", writer = "reader" }}

[clients.source]
kind = "soft-plc"
sources = ["source.st"]
tasks = [{{ name = "drive", interval = "10ms", programs = ["Source"] }}]

[clients.reader]
kind = "soft-plc"
sources = ["reader.st"]
tasks = [{{ name = "look", interval = "{scan_ms}ms", programs = ["Reader"] }}]

[[expect]]
name = "as it should"
formula = "{formula}"

{timing}
"#
        ),
    );
    folder
}

fn lines(said: &Said) -> Vec<Value> {
    said.out.lines().map(|line| serde_json::from_str(line).expect("JSON lines")).collect()
}

fn explored(folder: &Path, words: &[&str]) -> (Vec<Value>, Value) {
    let said = typed(folder, &[&["explore", "machine.toml", "--format", "json"], words].concat());
    let mut all = lines(&said);
    let statement = all.pop().unwrap_or_else(|| panic!("a statement: {said:?}"));
    (all, statement)
}

/// Each finding is a case that runs by itself, to the same digest.
fn repeats(folder: &Path, findings: &[Value]) {
    let cases: Vec<&str> = findings.iter().map(|finding| finding["case"].as_str().expect("a case")).collect();
    std::fs::write(folder.join("cases.toml"), format!("version = 1\n{}", cases.join("\n"))).expect("written");
    for (number, finding) in findings.iter().enumerate() {
        let case = format!("timing-{}", number + 1);
        let run = typed(folder, &["run", "machine.toml", "--case", &case, "--format", "json"]);
        let digest = finding["digest"].as_str().expect("a digest");
        assert_eq!(digests(&lines(&run)), [digest], "{case}\n{}\n{run:?}", finding["case"]);
    }
    std::fs::remove_file(folder.join("cases.toml")).expect("removed");
}

/// Every kind of deviation breaks what must never be otherwise at all, and each is a case of its own.
#[test]
fn every_deviation_is_a_case_that_runs_by_itself() {
    let timing = r#"[timing]
late = [{ signals = ["n"], by = "10ms" }]
together = [{ signals = ["A", "B"], by = "20ms" }]
order = [{ signals = ["A", "B"] }]
task = [{ client = "reader", task = "look", late = "10ms", phase = "20ms", two_cycles = true }]
start = [{ client = "reader", by = "20ms" }, { client = "source", by = "10ms" }]"#;
    let folder = machine(30, (3, 6), TOGETHER, "always (apart = 0 and n <= 0)", timing);
    // What is wrong already is not a finding of a deviation, so that each way is reported only if something is expected
    // of it.
    edit(
        folder.path(),
        "machine.toml",
        "always (apart = 0 and n <= 0)",
        "always[0,10ms] n = 0 and always[290ms,300ms] n > 9",
    );
    let (findings, statement) = explored(folder.path(), &["--all"]);
    assert_eq!(
        (findings.len(), &statement["exhausted"]),
        (1, &Value::Null),
        "wrong without any deviation: {statement}"
    );
    edit(folder.path(), "machine.toml", "always[0,10ms] n = 0 and always[290ms,300ms] n > 9", "always n < 100");
    let (findings, statement) = explored(folder.path(), &[]);
    assert!(findings.is_empty(), "{findings:?}");
    insta::assert_snapshot!(typed(folder.path(), &["explore", "machine.toml"]).out);
    assert!(statement["joined"].as_u64().expect("a count") > 0, "{statement}");
}

/// A frame that is late as a whole shows no difference that single edges do.
#[test]
fn what_travels_together_is_late_together() {
    let late = "[timing]\nlate = [{ signals = [\"A\", \"B\"], by = \"10ms\" }]";
    let folder = machine(10, (3, 3), TOGETHER, "always apart = 0", late);
    let alone = typed(folder.path(), &["explore", "machine.toml"]);
    edit(folder.path(), "machine.toml", "late = [", "together = [");
    let together = typed(folder.path(), &["explore", "machine.toml", "--bound", "2"]);
    edit(
        folder.path(),
        "machine.toml",
        "together = [{ signals = [\"A\", \"B\"], by = \"10ms\" }]",
        "order = [{ signals = [\"A\", \"B\"] }]",
    );
    let order = typed(folder.path(), &["explore", "machine.toml"]);
    assert_eq!([alone.code, together.code, order.code], [Some(1), Some(0), Some(1)], "{together:?}");
    insta::assert_snapshot!([alone.out, together.out, order.out].join("\n"));
    let (findings, _) = explored(folder.path(), &["--all"]);
    repeats(folder.path(), &findings);
}

/// What a task sees depends on when it runs.
#[test]
fn tasks_are_late_once_or_for_good() {
    // What the reader has counted in the end is that of the run without deviations.
    let program = "IF A THEN n := n + 1; END_IF; IF B THEN apart := apart + 1; END_IF;";
    let mut reported = Vec::new();
    for timing in [
        "task = [{ client = \"reader\", late = \"20ms\" }]",
        "task = [{ client = \"reader\", phase = \"20ms\" }]",
        "task = [{ client = \"reader\", two_cycles = true }]",
        "start = [{ client = \"reader\", by = \"50ms\" }]",
    ] {
        let folder = machine(30, (4, 5), program, "always (n < 100)", &format!("[timing]\n{timing}"));
        let healthy = typed(folder.path(), &["explore", "machine.toml"]);
        assert_eq!(healthy.code, Some(0), "{healthy:?}");
        let counted = (0..20).find(|count| {
            edit(folder.path(), "machine.toml", "always (n < 100)", &format!("always[280ms,290ms] (n = {count})"));
            let (findings, _) = explored(folder.path(), &["--bound", "0"]);
            edit(folder.path(), "machine.toml", &format!("always[280ms,290ms] (n = {count})"), "always (n < 100)");
            findings.is_empty()
        });
        let wanted = format!("always[280ms,290ms] (n = {})", counted.expect("a count"));
        edit(folder.path(), "machine.toml", "always (n < 100)", &wanted);
        reported.push(typed(folder.path(), &["explore", "machine.toml"]).out);
        let (findings, _) = explored(folder.path(), &["--all"]);
        repeats(folder.path(), &findings);
        let unmerged = explored(folder.path(), &["--all", "--no-merge"]).0;
        assert_eq!(findings, unmerged);
    }
    insta::assert_snapshot!(reported.join("\n"));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]
    /// Ways that end at a state that is known are those that hold: the same findings, the same number of schedules.
    #[test]
    fn equal_states_change_nothing_but_the_work(
        periods in (2_u64..7, 2_u64..7),
        scan in 1_u64..4,
        formula in prop::sample::select(vec![
            "always n <= 3",
            "always apart <= 4",
            "always (rose(A) implies within 40ms B)",
            "always (A implies once[0,50ms] B)",
            "eventually n > 2",
            "always (rate(n) > 0 implies (A and B))",
            "always[0,200ms] n < 3 and always apart < 6",
            "always (A implies eventually n > 1)",
        ]),
        tasks in any::<bool>(),
    ) {
        let more = if tasks && scan > 1 {
            "task = [{ client = \"reader\", late = \"10ms\", two_cycles = true }]\nstart = [{ client = \"reader\", by = \"10ms\" }]"
        } else {
            ""
        };
        let timing = format!("[timing]\nlate = [{{ signals = [\"A\", \"B\"], by = \"20ms\" }}]\n{more}");
        let folder = machine(scan * 10, periods, TOGETHER, formula, &timing);
        let words = ["--all", "--bound", "2", "--until", "200ms"];
        let (findings, statement) = explored(folder.path(), &words);
        let (unmerged, whole) = explored(folder.path(), &[&words[..], &["--no-merge"]].concat());
        prop_assert_eq!(findings, unmerged);
        prop_assert_eq!(&statement["schedules"], &whole["schedules"]);
        prop_assert_eq!(&whole["joined"], 0);
        prop_assert!(statement["runs"].as_u64() <= whole["runs"].as_u64());
    }
}

/// Beyond the bound schedules are drawn; what is found is left with as few deviations as still fail.
#[test]
fn random_schedules_are_those_of_their_seed() {
    let late = "[timing]\nlate = [{ signals = [\"A\", \"B\"], by = \"10ms\" }]";
    // Three edges that are late are needed: each adds one scan in which A and B differ.
    let folder = machine(10, (3, 3), TOGETHER, "always apart < 3", late);
    let words = ["explore", "machine.toml", "--bound", "1", "--samples", "40", "--seed", "7"];
    let said = typed(folder.path(), &words);
    assert_eq!(said.code, Some(1), "{said:?}");
    insta::assert_snapshot!(said.out);
    assert_eq!(typed(folder.path(), &words).out, said.out);
    let (findings, statement) = explored(folder.path(), &words[2..]);
    assert_eq!(findings[0]["deviations"].as_array().map(Vec::len), Some(3), "{findings:?}");
    assert!(findings[0]["drawn"].as_u64() >= Some(3), "{statement}");
    repeats(folder.path(), &findings);
    edit(folder.path(), "machine.toml", "apart < 3", "apart < 300");
    let holds = typed(folder.path(), &["explore", "machine.toml", "--samples", "20", "--most", "4"]);
    assert!(holds.out.contains("and so do 20 random ones with 2 to 4, of seed 1"), "{holds:?}");
}

#[test]
fn what_tasks_and_orders_cannot_do_is_reported() {
    let reported = [
        "order = [{ signals = [\"A\"] }]",
        "together = [{ signals = [\"A\", \"C\"], by = \"10ms\" }]",
        "task = [{ late = \"10ms\" }]",
        "task = [{ client = \"reader\", task = \"lok\", late = \"10ms\" }]",
        "task = [{ client = \"reader\", late = \"30ms\" }]",
        "task = [{ client = \"reader\", phase = \"5ms\" }]",
        "task = [{ client = \"reader\" }]",
        "start = [{ client = \"reeder\", by = \"10ms\" }]",
        "start = [{ client = \"reader\", by = \"1ms\" }]",
    ]
    .map(|timing| {
        let folder = machine(30, (3, 3), TOGETHER, "always n < 9", &format!("[timing]\n{timing}"));
        let said = typed(folder.path(), &["explore", "machine.toml"]);
        assert_eq!((said.code, said.out.as_str()), (Some(2), ""), "{timing}: {said:?}");
        said.err
    });
    let cases = [
        "task = [{ client = \"reader\", task = \"lok\", by = \"10ms\" }]",
        "task = [{ client = \"reader\", by = \"15ms\" }]",
        "task = [{ client = \"reader\", by = \"soon\" }]",
        "task = [{ by = \"10ms\" }]",
    ]
    .map(|task| {
        let folder = machine(30, (3, 3), TOGETHER, "always n < 9", "");
        let text = format!("version = 1\n\n[[case]]\nname = \"late\"\n{task}\n");
        std::fs::write(folder.path().join("cases.toml"), text).expect("written");
        let said = typed(folder.path(), &["run", "machine.toml", "--case", "late"]);
        assert_eq!((said.code, said.out.as_str()), (Some(2), ""), "{task}: {said:?}");
        said.err
    });
    insta::assert_snapshot!(reported.into_iter().chain(cases).collect::<Vec<_>>().join("\n"));
}

/// A late task is part of the state: resumed and in other processes it is late alike.
#[test]
fn a_case_with_a_late_task_is_the_same_resumed_and_over_tcp() {
    let folder = machine(30, (4, 5), TOGETHER, "always n < 99", "");
    let case = "version = 1\n\n[[case]]\nname = \"late\"\ntask = [\n\
                \x20   { client = \"reader\", task = \"look\", by = \"20ms\", from = \"60ms\", until = \"170ms\" },\n\
                \x20   { client = \"source\", by = \"10ms\" },\n]\n";
    std::fs::write(folder.path().join("cases.toml"), case).expect("written");
    let run = |words: &[&str]| {
        let said =
            typed(folder.path(), &[&["run", "machine.toml", "--case", "late", "--format", "json"], words].concat());
        assert_eq!(said.code, Some(0), "{said:?}");
        digests(&lines(&said))
    };
    let whole = run(&["--save-at", "100ms", "--save", "s.ckpt"]);
    assert_eq!(whole, run(&["--resume", "s.ckpt"]));
    assert_eq!(whole, run(&["--transport", "tcp"]));
    let plain = typed(folder.path(), &["run", "machine.toml", "--format", "json"]);
    assert_ne!(whole, digests(&lines(&plain)), "it makes a difference");
}
