//! `[[expect]]` in a scenario, and formulas held against `rtamt`, an independent tool of the field.

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;
use std::process::{Command, Stdio};

use onescan_scenario::expect::{Expectation, Judge, KnownSignal, TraceEnd};
use onescan_server::signal::SignalType;
use serde_json::json;

use crate::typed::{copied_shear, edit, run_shear, typed};
use crate::venv::python;

const STEP_NS: u64 = 100_000_000;

/// Numbers from a seed (Knuth's MMIX generator).
struct Numbers(u64);

impl Numbers {
    fn below(&mut self, limit: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % limit
    }

    fn column(&mut self, length: usize) -> Vec<f64> {
        (0..length).map(|_| self.below(41) as f64 / 4.0 - 5.0).collect()
    }

    /// A formula as it is written here and by rtamt.
    fn formula(&mut self, depth: u32) -> (String, String) {
        if depth == 0 || self.below(5) == 0 {
            let name = ["a", "b"][self.below(2) as usize];
            let sign = ["<", "<=", ">", ">="][self.below(4) as usize];
            let text = format!("({name} {sign} {})", self.below(5));
            return (text.clone(), text);
        }
        let (ours, theirs) = self.formula(depth - 1);
        let window = self.below(4);
        let length = self.below(6);
        let (our_window, their_window) = match self.below(3) {
            0 => (String::new(), String::new()),
            _ => (
                format!("[{}ns,{}ns]", window * STEP_NS, (window + length) * STEP_NS),
                format!("[{window}:{}]", window + length),
            ),
        };
        let unary = ["always", "eventually", "historically", "once"];
        match self.below(9) {
            0 => (format!("(not {ours})"), format!("(not {theirs})")),
            kind @ 1..=4 => {
                let word = unary[kind as usize - 1];
                (format!("({word}{our_window} {ours})"), format!("({word}{their_window} {theirs})"))
            }
            kind => {
                let (our_right, their_right) = self.formula(depth - 1);
                let (our_word, their_word) = match kind {
                    5 => ("and".to_owned(), "and".to_owned()),
                    6 => ("implies".to_owned(), "->".to_owned()),
                    7 => (format!("until{our_window}"), format!("until{their_window}")),
                    _ => (format!("since{our_window}"), format!("since{their_window}")),
                };
                (format!("({ours} {our_word} {our_right})"), format!("({theirs} {their_word} {their_right})"))
            }
        }
    }
}

/// What the peer says to each case.
fn ask(cases: &str) -> Vec<f64> {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("peers/stl_oracle.py");
    let pipes = || Stdio::piped();
    let mut child = Command::new(python("rtamt-0.4.10", &["rtamt==0.4.10"]))
        .arg(script)
        .stdin(pipes())
        .stdout(pipes())
        .spawn()
        .expect("the peer starts");
    let mut input = child.stdin.take().expect("it has an input");
    let text = cases.to_owned();
    let writer = std::thread::spawn(move || input.write_all(text.as_bytes()));
    let output = child.wait_with_output().expect("the peer ends");
    writer.join().expect("no panic").expect("the peer reads");
    assert!(output.status.success());
    let answers = String::from_utf8(output.stdout).expect("the peer writes text");
    answers.lines().map(|line| serde_json::from_str::<String>(line).unwrap().parse().unwrap()).collect()
}

/// rtamt takes what lies beyond the end of a trace for false or true, whichever the operator
/// neglects; here it is unknown. So its robustness lies between the two margins, and is equal to
/// them where they are one.
#[test]
fn margins_are_those_of_rtamt() {
    let mut numbers = Numbers(61131);
    let signal = |name: &str| KnownSignal { name: name.to_owned(), ty: SignalType::LREAL, unit: None };
    let (mut cases, mut ours) = (String::new(), Vec::new());
    for _ in 0..400 {
        // The peer does not take a single sample.
        let length = 2 + numbers.below(24) as usize;
        let (a, b) = (numbers.column(length), numbers.column(length));
        let (our_formula, their_formula) = numbers.formula(3);
        let at = numbers.below(length as u64);
        let (our_formula, their_formula) = (
            format!("eventually[{0}ns,{0}ns] {our_formula}", at * STEP_NS),
            format!("eventually[{at}:{at}] {their_formula}"),
        );
        let mut columns = vec!["a".to_owned(), "b".to_owned()];
        let expectation = Expectation::parse(&our_formula, &[signal("a"), signal("b")], &mut columns).unwrap();
        let mut judge = Judge::new([expectation], 2);
        for (step, (a, b)) in (0..).zip(a.iter().zip(&b)) {
            judge.push(step * STEP_NS, [*a, *b]);
        }
        ours.push((their_formula.clone(), judge.finish(TraceEnd::Complete)[0].margin));
        writeln!(cases, "{}", json!({ "formula": their_formula, "a": a, "b": b })).unwrap();
    }
    let theirs = ask(&cases);
    assert_eq!(theirs.len(), ours.len());
    let mut decided = 0;
    for ((formula, margin), robustness) in ours.iter().zip(theirs) {
        assert!(margin.least <= robustness && robustness <= margin.greatest, "{formula}: {robustness}, {margin:?}");
        decided += usize::from(margin.least == margin.greatest);
    }
    assert!(decided > 200, "only {decided} cases are decided by what was seen");
}

/// The shear with one more expectation.
fn shear_that_expects(name: &str, formula: &str) -> tempfile::TempDir {
    let folder = copied_shear();
    let entry = format!("[[expect]]\nname = \"{name}\"\nformula = \"{formula}\"\n\n[plot]");
    edit(folder.path(), "scenario.toml", "[plot]", &entry);
    folder
}

#[test]
fn the_shear_shows_what_is_expected_of_it() {
    let (reports, said) = run_shear(&[]);
    assert_eq!(said.code, Some(0), "{said:?}");
    let expectations = reports[0]["expectations"].as_array().expect("a list");
    assert!(!expectations.is_empty());
    assert!(expectations.iter().all(|each| each["verdict"] == "met"), "{expectations:?}");
}

#[test]
fn a_run_that_does_not_show_it_fails() {
    let folder = shear_that_expects("short strokes", "always Position_1 > -100 mm");
    let said = typed(folder.path(), &["run", ".", "--until", "2s", "--format", "json", "--plot", "plot.svg"]);
    assert_eq!(said.code, Some(1), "{said:?}");
    let report: serde_json::Value = serde_json::from_str(&said.out).expect("JSON");
    let found = report["expectations"].as_array().and_then(|all| all.last()).expect("an expectation");
    insta::assert_snapshot!(serde_json::to_string_pretty(found).expect("JSON"));
    let plot = std::fs::read_to_string(folder.path().join("plot.svg")).expect("a plot");
    assert!(plot.contains("`short strokes` violated"));

    let said = typed(folder.path(), &["run", ".", "--until", "2s"]);
    let lines: Vec<&str> = said.out.lines().filter(|line| line.contains("expectation")).collect();
    insta::assert_snapshot!(lines.join("\n"));
}

#[test]
fn a_margin_of_nothing_has_no_sign() {
    let folder = shear_that_expects("no more than itself", "not (Position_1 > Position_1)");
    let said = typed(folder.path(), &["run", ".", "--until", "100ms"]);
    let line = said.out.lines().find(|line| line.contains("no more than itself")).expect("a line");
    assert!(line.ends_with("met (margin 0 m)"), "{line}");
}

#[test]
fn an_expectation_changes_no_digest() {
    let folder = shear_that_expects("short strokes", "always Position_1 > -100 mm");
    let said = typed(folder.path(), &["run", ".", "--until", "500ms", "--format", "json"]);
    let report: serde_json::Value = serde_json::from_str(&said.out).expect("JSON");
    let (plain, _) = run_shear(&["--until", "500ms"]);
    assert_eq!(report["digest"], plain[0]["digest"]);
}

#[test]
fn a_wrong_formula_is_reported_with_its_place() {
    let wrong = |formula: &str| {
        let folder = shear_that_expects("wrong", formula);
        let said = typed(folder.path(), &["run", "."]);
        assert_eq!((said.code, said.out.as_str()), (Some(2), ""), "{said:?}");
        said.err
    };
    insta::assert_snapshot!(wrong("always Positon_1 > -100 mm"));
    insta::assert_snapshot!(wrong("always (Position_1 > -100 bar)"));
    insta::assert_snapshot!(wrong("always (Aligned implies within Aligned)"));
}

/// What would keep every step of a long run is refused before it runs, and says what to write.
#[test]
fn an_expectation_that_keeps_every_step_of_a_long_run_is_refused() {
    let shear = copied_shear();
    let add = "[freewheel]";
    let formula = |formula: &str| format!("[[expect]]\nname = \"new\"\nformula = \"{formula}\"\n\n{add}");
    edit(shear.path(), "scenario.toml", add, &formula("always (Sensor_1 implies eventually Sensor_2)"));
    assert_eq!(typed(shear.path(), &["run", ".", "--until", "100ms"]).code, Some(0));
    let said = typed(shear.path(), &["run", ".", "--until", "6h"]);
    let text = crate::typed::flat(&said.err);
    assert_eq!(said.code, Some(2), "{said:?}");
    assert!(text.contains("expectation `new` keeps every step until the end of the run, which has 2160000"), "{text}");
    assert!(text.contains("`always (a implies within 10s b)`"), "{text}");
}
