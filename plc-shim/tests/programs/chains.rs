//! Rows of operators of any length: on a stack of the usual 2 MiB, with the values that the order from left to right gives.

use std::fmt::Write;

use onescan_iec::source::FileId;
use onescan_iec::{Dialect, inspect};
use onescan_iec_run::Application;

use crate::rig::Rig;

const LONG: usize = 5_000;

const DECLARATIONS: &str = "VAR_GLOBAL calls : DINT; END_VAR
FUNCTION Tick : BOOL VAR_INPUT value : BOOL; END_VAR VAR_EXTERNAL calls : DINT; END_VAR
  calls := calls + 1; Tick := value;
END_FUNCTION
FUNCTION Next : DINT VAR_EXTERNAL calls : DINT; END_VAR calls := calls + 1; Next := calls; END_FUNCTION
";

/// `term` so many times with the operator between.
fn row(term: &str, operator: &str) -> String {
    vec![term; LONG].join(&format!(" {operator} "))
}

/// Runs on a thread with the stack that threads have by default.
fn on_a_thread<T: Send + 'static>(run: impl FnOnce() -> T + Send + 'static) -> T {
    let thread = std::thread::Builder::new().stack_size(2 << 20).spawn(run).expect("a thread");
    thread.join().expect("no overflow")
}

/// The program after one scan.
fn scanned(variables: &str, statements: &str) -> Rig {
    let text = format!("{DECLARATIONS}PROGRAM P VAR {variables} END_VAR {statements} END_PROGRAM");
    on_a_thread(move || {
        let mut rig = Rig::in_dialect(Dialect::Codesys, &text);
        rig.scan().expect("a scan");
        rig
    })
}

#[test]
fn sums_of_integers() {
    let rig = scanned(
        "a : DINT := 3; x : DINT; i : INT := 10; y : INT;",
        &format!("x := {}; y := {};", row("a", "+"), row("i", "+")),
    );
    assert_eq!(rig.int("P.x"), 15_000);
    assert_eq!(rig.int("P.y"), i64::from(50_000_u16 as i16), "it wraps at every step, as INT does");
}

#[test]
fn sums_of_reals_are_rounded_at_every_step() {
    let rig = scanned("a : REAL := 0.1; x : REAL;", &format!("x := {};", row("a", "+")));
    let expected = (1..LONG).fold(0.1_f32, |sum, _| sum + 0.1);
    assert_eq!((rig.real("P.x") as f32).to_bits(), expected.to_bits());
}

#[test]
fn operators_and_types_that_differ() {
    let mut sum = String::from("1");
    let mut expected = 1_i64;
    for n in 1..LONG as i64 {
        let (text, value) = match n % 4 {
            0 => (" - d * 2", -14),
            1 => (" + i", 5),
            2 => (" + (d - i)", 2),
            _ => (" + 9 / i", 1),
        };
        sum.push_str(text);
        expected += value;
    }
    let rig = scanned("i : INT := 5; d : DINT := 7; x : DINT;", &format!("x := {sum};"));
    assert_eq!(rig.int("P.x"), expected);
}

#[test]
fn rows_of_conditions() {
    let (all, any) = (row("t", "AND"), row("f", "OR"));
    let odd = row("t", "XOR");
    let statements =
        format!("a := {all}; b := {all} AND f; c := {any} OR t; d := {odd}; IF {all} THEN e := TRUE; END_IF;");
    let rig = scanned("t : BOOL := TRUE; f, a, b, c, d, e : BOOL;", &statements);
    let values = ["P.a", "P.b", "P.c", "P.d", "P.e"].map(|path| rig.bool(path));
    assert_eq!(values, [true, false, true, LONG % 2 == 1, true]);
}

#[test]
fn operands_are_evaluated_from_the_left() {
    // 1 - 2 - 3 - ..
    let rig = scanned("x : DINT;", &format!("x := {};", row("Next()", "-")));
    let expected = (2..=LONG as i64).fold(1, |left, right| left - right);
    assert_eq!((rig.int("P.x"), rig.int("calls")), (expected, LONG as i64));
}

#[test]
fn short_circuits_stop_where_they_should() {
    let before = vec!["Tick(TRUE)"; 1000].join(" AND_THEN ");
    let rig = scanned(
        "x : BOOL;",
        &format!("x := {before} AND_THEN Tick(FALSE) AND_THEN {};", row("Tick(TRUE)", "AND_THEN")),
    );
    assert_eq!((rig.bool("P.x"), rig.int("calls")), (false, 1001));
    let rig = scanned("x : BOOL;", &format!("x := {};", row("Tick(FALSE)", "OR_ELSE")));
    assert_eq!((rig.bool("P.x"), rig.int("calls")), (false, LONG as i64));
}

#[test]
fn rows_of_constants_are_constants() {
    let ones = row("1", "+");
    let text = format!(
        "PROGRAM P VAR CONSTANT k : DINT := {ones}; m : DINT := k + {ones}; END_VAR VAR a : ARRAY[1..m] OF BYTE; x : DINT; END_VAR x := SIZEOF(a); END_PROGRAM"
    );
    let rig = on_a_thread(move || {
        let mut rig = Rig::in_dialect(Dialect::Codesys, &text);
        rig.scan().expect("a scan");
        rig
    });
    assert_eq!(rig.int("P.x"), 2 * LONG as i64);
}

#[test]
fn what_is_wrong_in_a_row_is_reported_once_and_warnings_are_found() {
    let sum = format!("{} + missing + {} + b", row("a", "+"), row("a", "+"));
    let text = format!("PROGRAM P VAR a : DINT; b : BOOL; END_VAR a := {sum}; END_PROGRAM");
    let found = on_a_thread(move || Application::from_sources([("t.st", text)]).expect_err("wrong"));
    let messages: Vec<_> = found.iter().map(|each| each.message.as_str()).collect();
    assert_eq!(messages, ["`missing` is not declared"]);
    let text = format!("PROGRAM P VAR a, b : DINT; END_VAR a := {}; END_PROGRAM", row("a", "+"));
    let file = onescan_iec::Input::from_text("t.st", onescan_iec::input::kind::SourceKind::Text, text);
    let found = on_a_thread(move || inspect([file], None));
    assert_eq!(found.to_string().matches("W0706").count(), 1, "{found}");
}

/// The tree is low enough to be printed, copied and dropped anywhere.
#[test]
fn a_tree_of_rows_is_low() {
    on_a_thread(|| {
        let text = format!("PROGRAM P a := {}; END_PROGRAM", row("a", "+"));
        let parsed = onescan_iec::syntax::parse(FileId(0), &text);
        assert!(parsed.diagnostics.is_empty());
        let printed = onescan_iec::syntax::printer::print_unit(&parsed.unit.clone());
        assert_eq!(printed.matches('+').count(), LONG - 1);
    });
}

#[test]
fn rows_in_rows_are_computed_or_refused() {
    let mut answers = String::new();
    for deep in [2, 10, 100, 150, 10_000] {
        let inner = vec!["a"; 100].join(" + ");
        let nested = format!("{}a{}", &format!("{inner} + (").repeat(deep), ")".repeat(deep));
        let text = format!("PROGRAM P VAR a : DINT; END_VAR a := {nested}; END_PROGRAM");
        let compiled = on_a_thread(move || Application::from_sources([("t.st", text)]).map(drop));
        let said = compiled
            .map_or_else(|found| found.iter().map(|each| each.code.text()).collect(), |()| "compiled".to_owned());
        writeln!(answers, "{deep}: {said}").expect("a text");
    }
    insta::assert_snapshot!(answers);
}
