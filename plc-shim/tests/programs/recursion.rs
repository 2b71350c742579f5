//! Methods and functions that call themselves (CODESYS, TwinCAT): how deep they may, and where they stop.

use onescan_iec::Dialect;
use onescan_iec_run::FaultKind;

use crate::rig::{Rig, findings, findings_in};

const FIBONACCI: &str = "FUNCTION Fib : LINT
VAR_INPUT n : LINT; END_VAR
    IF n < 2 THEN Fib := n; ELSE Fib := Fib(n - 1) + Fib(n - 2); END_IF
END_FUNCTION
PROGRAM P VAR n : LINT := 20; r : LINT; END_VAR r := Fib(n); END_PROGRAM";

fn rig(text: &str) -> Rig {
    Rig::in_dialect(Dialect::TwinCat, text)
}

#[test]
fn a_function_calls_itself() {
    let mut rig = rig(FIBONACCI);
    rig.scan().expect("no fault");
    assert_eq!(rig.int("P.r"), 6765);
    assert!(findings(FIBONACCI).contains("D0404"), "the standard has no recursion");
}

#[test]
fn methods_call_themselves_and_one_another() {
    let mut rig = rig("FUNCTION_BLOCK B
VAR calls : LINT; END_VAR
METHOD Sum : LINT
VAR_INPUT n : LINT; END_VAR
VAR own : LINT; END_VAR
    calls := calls + 1;
    own := n;
    IF n > 0 THEN Sum := THIS^.Sum(n - 1); END_IF
    Sum := Sum + own;
END_METHOD
METHOD Even : BOOL
VAR_INPUT n : LINT; END_VAR
    Even := n = 0 OR_ELSE Odd(n - 1);
END_METHOD
METHOD Odd : BOOL
VAR_INPUT n : LINT; END_VAR
    Odd := n <> 0 AND_THEN Even(n - 1);
END_METHOD
END_FUNCTION_BLOCK
PROGRAM P VAR b1 : B; sum : LINT; even, odd : BOOL; END_VAR
    sum := b1.Sum(100); even := b1.Even(20); odd := b1.Odd(20);
END_PROGRAM");
    rig.scan().expect("no fault");
    assert_eq!((rig.int("P.sum"), rig.int("P.b1.calls")), (5050, 101));
    assert_eq!((rig.bool("P.even"), rig.bool("P.odd")), (true, false));
}

#[test]
fn too_deep_and_too_long_are_faults_with_their_places() {
    let mut deep = rig(FIBONACCI);
    deep.set("P.n", 1000);
    let fault = deep.scan().expect_err("deeper than 128 calls");
    assert_eq!((fault.kind, fault.at.pou.as_str(), fault.at.line), (FaultKind::CallTooDeep, "Fib", 1));
    // As deep as it may be, and more calls than any scan has time for.
    let mut long = rig(FIBONACCI);
    long.set("P.n", 120);
    let fault = long.scan().expect_err("more calls than a scan may make");
    assert_eq!(fault.kind, FaultKind::EndlessLoop);
}

#[test]
fn what_has_arrays_or_strings_of_its_own_runs_once_at_a_time() {
    let text = "FUNCTION Walk : INT
VAR_INPUT n : INT; END_VAR
VAR path : ARRAY [0..3] OF INT; END_VAR
    path[0] := n;
    IF n > 0 THEN Walk := Walk(n - 1) + path[0]; END_IF
END_FUNCTION
PROGRAM P VAR n, r : INT; END_VAR r := Walk(n); END_PROGRAM";
    let mut rig = rig(text);
    rig.scan().expect("it does not call itself");
    rig.set("P.n", 1);
    let fault = rig.scan().expect_err("the array is one for all calls");
    assert_eq!((fault.kind, fault.at.pou.as_str()), (FaultKind::Reentered, "Walk"));
}

#[test]
fn programs_and_blocks_do_not_call_themselves() {
    let text = "PROGRAM P VAR n : INT; END_VAR n := n + 1; P(); END_PROGRAM";
    insta::assert_snapshot!(findings_in(Dialect::TwinCat, text), @"test.st:1:44: error[D0404]: this call makes `P` call itself");
}
