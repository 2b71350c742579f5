//! `__NEW` and `__DELETE`: what is made, what ends, and that memory comes back.

use onescan_iec::Dialect::{self, Codesys, TwinCat};
use onescan_iec_run::FaultKind;

use crate::rig::{Rig, findings, findings_in};

const VENDORS: [Dialect; 2] = [Codesys, TwinCat];

fn scanned(dialect: Dialect, text: &str, scans: usize) -> Rig {
    let mut rig = Rig::in_dialect(dialect, text);
    for _ in 0..scans {
        rig.scan().expect("no fault");
    }
    rig
}

const SHAPES: &str = "
INTERFACE I_Shape METHOD Area : DINT END_METHOD END_INTERFACE
VAR_GLOBAL ended : DINT; begun : DINT; END_VAR
FUNCTION_BLOCK Shape IMPLEMENTS I_Shape
VAR side : DINT := 3; inner : Counter; END_VAR
METHOD FB_init : BOOL VAR_INPUT bInitRetains, bInCopyCode : BOOL; factor : DINT; END_VAR
  side := side * factor; begun := begun + 1; END_METHOD
METHOD FB_exit : BOOL VAR_INPUT bInCopyCode : BOOL; END_VAR ended := ended + side; END_METHOD
METHOD Area : DINT Area := side * side + inner.n; END_METHOD
END_FUNCTION_BLOCK
FUNCTION_BLOCK Cube EXTENDS Shape
METHOD Area : DINT Area := 6 * SUPER^.Area(); END_METHOD
METHOD FB_exit : BOOL VAR_INPUT bInCopyCode : BOOL; END_VAR ended := ended + 1000; END_METHOD
END_FUNCTION_BLOCK
FUNCTION_BLOCK Counter VAR_OUTPUT n : DINT := 7; END_VAR END_FUNCTION_BLOCK
";

#[test]
fn an_instance_begins_as_declared_and_runs_its_own_methods() {
    for dialect in VENDORS {
        let text = format!(
            "{SHAPES} PROGRAM P VAR s : POINTER TO Shape; i : I_Shape; a, b, c : DINT; gone : BOOL; step : INT; END_VAR
             step := step + 1;
             CASE step OF
             1: s := __NEW(Shape(factor := 2)); a := s^.Area(); i := s^; b := i.Area();
             2: __DELETE(s); gone := s = 0;
             3: s := __NEW(Cube(5)); c := s^.Area();
             4: i := s^; __DELETE(i);
             END_CASE END_PROGRAM"
        );
        let rig = scanned(dialect, &text, 2);
        assert_eq!((rig.int("P.a"), rig.int("P.b")), (43, 43), "{dialect}: side 6, and the inner counter's 7");
        assert!(rig.bool("P.gone"), "{dialect}");
        assert_eq!((rig.int("begun"), rig.int("ended")), (1, 6), "{dialect}");
        let rig = scanned(dialect, &text, 4);
        assert_eq!(rig.int("P.c"), 6 * (15 * 15 + 7), "{dialect}");
        assert_eq!(rig.int("ended"), 6 + 1000 + 15, "{dialect}: FB_exit of what it is, then of its base");
    }
}

#[test]
fn arrays_and_structures_have_their_initial_values() {
    for dialect in VENDORS {
        let text = "TYPE Part : STRUCT n : INT := 4; name : STRING(9) := 'abc'; END_STRUCT END_TYPE
            PROGRAM P VAR bytes : POINTER TO BYTE; parts : POINTER TO Part; list : POINTER TO POINTER TO Part;
              n : INT := 5; a, b, c, d : DINT; same : BOOL; s : STRING(9); END_VAR
            bytes := __NEW(BYTE, n); bytes[4] := 9; a := bytes[0]; b := bytes[4];
            parts := __NEW(Part, 3); parts[1].n := 8; c := parts[0].n + parts[1].n + parts[2].n; s := parts[2].name;
            list := __NEW(POINTER TO Part, 2); list[1] := parts; d := list[1]^.n; same := list[0] = 0;
            __DELETE(bytes); __DELETE(parts); __DELETE(list); END_PROGRAM";
        let rig = scanned(dialect, text, 1);
        assert_eq!((rig.int("P.a"), rig.int("P.b"), rig.int("P.c"), rig.int("P.d")), (0, 9, 16, 4), "{dialect}");
        assert!(rig.bool("P.same"), "{dialect}");
        assert_eq!(rig.text("P.s"), "abc", "{dialect}");
    }
}

#[test]
fn memory_that_is_given_back_is_taken_again() {
    // Each scan takes 600,000 of 1 MiB, in two blocks that are given back in turns: only neighbours that become one
    // block leave room for the next.
    let text = "PROGRAM P VAR p, q : POINTER TO BYTE; first, n : UDINT; lost : DINT; END_VAR
        p := __NEW(BYTE, 300000); q := __NEW(BYTE, 300000 + n MOD 7);
        IF p = 0 OR q = 0 THEN lost := lost + 1; END_IF
        IF first = 0 THEN first := p; END_IF
        n := n + 1;
        IF n MOD 2 = 0 THEN __DELETE(p); __DELETE(q); ELSE __DELETE(q); __DELETE(p); END_IF END_PROGRAM";
    for dialect in VENDORS {
        let rig = scanned(dialect, text, 100);
        assert_eq!((rig.int("P.lost"), rig.int("P.n")), (0, 100), "{dialect}");
    }
}

#[test]
fn without_memory_the_pointer_is_0() {
    let text = "PROGRAM P VAR p, q, r : POINTER TO BYTE; n : DINT := 2000000; k : DINT := -1; END_VAR
        p := __NEW(BYTE, n); q := __NEW(BYTE, k); r := __NEW(BYTE, 1000000); __DELETE(p); END_PROGRAM";
    for dialect in VENDORS {
        let rig = scanned(dialect, text, 1);
        assert_eq!((rig.int("P.p"), rig.int("P.q")), (0, 0), "{dialect}");
        assert_ne!(rig.int("P.r"), 0, "{dialect}");
    }
}

#[test]
fn what_was_not_taken_is_not_given_back() {
    let text = "PROGRAM P VAR p, q : POINTER TO BYTE; b : BYTE; END_VAR
        p := __NEW(BYTE, 4); q := p; __DELETE(p); __DELETE(q); END_PROGRAM";
    for dialect in VENDORS {
        let fault = Rig::in_dialect(dialect, text).scan().expect_err("given back twice");
        assert_eq!(fault.kind, FaultKind::InvalidPointer, "{dialect}");
    }
}

#[test]
fn mistakes_have_their_places() {
    let wrong = "INTERFACE I END_INTERFACE FUNCTION_BLOCK ABSTRACT A END_FUNCTION_BLOCK
        PROGRAM P VAR p : POINTER TO BYTE; n : INT; q : POINTER TO A; END_VAR
        p := __NEW(n); p := __NEW(BYTE, 'a'); p := __NEW(); __DELETE(n); __DELETE(); q := __NEW(A); END_PROGRAM";
    insta::assert_snapshot!(findings_in(Codesys, wrong), @r"
    test.st:3:20: error[N0106]: a type is wanted here
    test.st:3:41: error[T0201]: LINT is wanted, this is a STRING
    test.st:3:52: error[C0302]: __NEW takes a type and, of an array, its length
    test.st:3:70: error[T0201]: a pointer or an interface is wanted, this is INT
    test.st:3:74: error[C0302]: __DELETE takes one pointer
    test.st:3:97: error[O0802]: `A` is ABSTRACT and has no instances (declare an instance of what extends it)
    ");
    insta::assert_snapshot!(
        findings("PROGRAM P VAR p : REF_TO BYTE; END_VAR p := __NEW(BYTE); END_PROGRAM"), @"test.st:1:45: error[L0513]: `__NEW` is a function of a vendor's controllers (CODESYS and TwinCAT have it: --dialect chooses)");
}
