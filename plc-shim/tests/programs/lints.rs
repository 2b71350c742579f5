//! What is legal and seldom meant, and what looks like it and is meant.

use onescan_iec::input::kind::SourceKind;
use onescan_iec::{Input, TaskPlan, inspect};

use crate::rig::task;

fn warnings_with(text: &str, plan: Option<&TaskPlan>) -> String {
    inspect([Input::from_text("test.st", SourceKind::Text, text)], plan).to_string()
}

fn warnings(text: &str) -> String {
    warnings_with(text, None)
}

#[test]
fn every_warning_has_its_place() {
    insta::assert_snapshot!(warnings(
        "TYPE Point : STRUCT x, y : REAL; END_STRUCT; END_TYPE
VAR_GLOBAL
  lamp AT %QX0.0 : BOOL;
  left_over : INT;
END_VAR
FUNCTION_BLOCK Valve
VAR_INPUT open : BOOL; END_VAR
VAR_OUTPUT opened, closed : BOOL; END_VAR
VAR idle : TOF; pulse : ARRAY [1..2] OF TP; edge : R_TRIG; END_VAR
VAR_TEMP t : INT; END_VAR
  IF open THEN
    edge(CLK := open);
    RETURN;
    opened := edge.Q;
  ELSE
    RETURN;
  END_IF;
  opened := FALSE;
END_FUNCTION_BLOCK
FUNCTION Mean : REAL
VAR_INPUT a, b : REAL; END_VAR
  Mean := (a + b) / 2.0;
END_FUNCTION
PROGRAM Main
VAR v : Valve; p : ARRAY [1..2] OF Point; i : INT; c : CTU; busy : BOOL; END_VAR
  CASE i OF
    1: v(open := p[i].x = p[2].y);
    2: busy := Mean(1.0, 2.0) <> INT_TO_REAL(i);
       c(CU := busy, PV := 3);
  END_CASE;
  WHILE busy DO
    EXIT;
    i := i + 1;
  END_WHILE;
END_PROGRAM"
    ));
}

#[test]
fn what_is_meant_is_not_reported() {
    let text = "VAR_GLOBAL CONSTANT size : INT := 3; END_VAR
TYPE List : ARRAY [1..size] OF INT; END_TYPE
FUNCTION_BLOCK Sum
VAR_INPUT list : List; gain : REAL; END_VAR
VAR_OUTPUT total : INT; END_VAR
VAR timers : ARRAY [1..size] OF TON; i : INT; END_VAR
  total := 0;
  FOR i := 1 TO size DO
    timers[i](IN := list[i] > 0, PT := T#1s);
    total := total + list[i];
    IF total > 100 THEN EXIT; END_IF;
  END_FOR;
  IF gain = 0.0 THEN RETURN; END_IF;
  total := REAL_TO_INT(INT_TO_REAL(total) / gain);
END_FUNCTION_BLOCK
FUNCTION_BLOCK Step
VAR_IN_OUT timer : TON; done : BOOL; END_VAR
  timer(IN := NOT done, PT := T#1s);
  done := timer.Q;
END_FUNCTION_BLOCK
PROGRAM Main
VAR_OUTPUT ready : BOOL; END_VAR
VAR s : Sum; st : Step; t : TON; sensor AT %IX0.0 : BOOL; END_VAR
  s(gain := 1.0);
  st(timer := t, done := ready);
END_PROGRAM";
    assert_eq!(warnings(text), "");
}

#[test]
fn errors_hide_warnings() {
    let text = "PROGRAM P VAR a : INT; t : TON; END_VAR b := 1; END_PROGRAM";
    assert_eq!(warnings(text), "test.st:1:41: error[N0101]: `b` is not declared");
}

const TWO_WRITERS: &str = "VAR_GLOBAL demand : INT; END_VAR
FUNCTION_BLOCK Raise
VAR_EXTERNAL demand : INT; END_VAR
  demand := demand + 1;
END_FUNCTION_BLOCK
PROGRAM Fast VAR r : Raise; END_VAR r(); END_PROGRAM
PROGRAM Slow VAR_EXTERNAL demand : INT; END_VAR demand := 0; END_PROGRAM
PROGRAM Reader VAR_OUTPUT o : INT; END_VAR o := demand; END_PROGRAM
PROGRAM Other VAR demand : INT; END_VAR demand := 1; END_PROGRAM";

#[test]
fn two_programs_write_through_all_that_they_call() {
    insta::assert_snapshot!(
        warnings(TWO_WRITERS),
        @"test.st:1:12: warning[W0707]: `demand` is written by 2 programs: `Fast`, `Slow` (let one of them write it, and the others ask that one by variables of their own)"
    );
}

#[test]
fn programs_of_one_task_take_turns() {
    let one = TaskPlan::new(vec![task("main", 10, 0, &["Fast", "slow", "Reader", "Other"])]);
    assert_eq!(warnings_with(TWO_WRITERS, Some(&one)), "");
    let two = TaskPlan::new(vec![task("quick", 10, 0, &["Fast"]), task("lazy", 100, 1, &["Slow", "Reader"])]);
    insta::assert_snapshot!(
        warnings_with(TWO_WRITERS, Some(&two)),
        @"test.st:1:12: warning[W0707]: `demand` is written by 2 tasks: `lazy`, `quick` (let one of them write it, and the others ask that one by variables of their own)"
    );
}

#[test]
fn conversions_of_vendors_that_may_lose_are_reported() {
    let text = "PROGRAM P
VAR i : INT; u : UINT; w : WORD; d : DINT; l : LREAL; r : REAL; b : BOOL; END_VAR
  u := i; i := u; d := u; i := w; w := u;
  r := l; r := d; l := d; r := i;
  u := 5; r := 0.1; w := b;
  i := UINT_TO_INT(u); r := LREAL_TO_REAL(l);
END_PROGRAM";
    insta::assert_snapshot!(crate::rig::findings_in(onescan_iec::Dialect::Codesys, text));
}
