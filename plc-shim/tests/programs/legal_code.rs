//! Code that other tools compile and that real projects hold, in small programs of our own: each line checks without
//! an error, and those that say so give a value.

use onescan_iec::Dialect::{self, Codesys, Iec2, Iec3, Matiec, SiemensScl, TwinCat};
use onescan_iec::Severity;

use crate::rig::{Rig, findings_in};

const VENDORS: &[Dialect] = &[Codesys, TwinCat];
const ALL: &[Dialect] = &Dialect::ALL;

fn checks(dialects: &[Dialect], text: &str) {
    for dialect in dialects {
        let findings = findings_in(*dialect, text);
        assert!(findings.iter().all(|found| found.severity != Severity::Error), "{dialect}: {findings}\n{text}");
    }
}

/// What `P.r` is after one scan.
fn gives(dialects: &[Dialect], text: &str, expected: i64) {
    for dialect in dialects {
        let mut rig = Rig::in_dialect(*dialect, text);
        rig.scan().expect("no fault");
        assert_eq!(rig.int("P.r"), expected, "{dialect}: {text}");
    }
}

#[test]
fn declarations() {
    checks(ALL, "PROGRAM P VAR a : INT;; b : INT; END_VAR a := b; END_PROGRAM");
    checks(
        ALL,
        "TYPE S : STRUCT a : INT;; b : INT; END_STRUCT;; END_TYPE PROGRAM P VAR s : S; END_VAR s.a := s.b; END_PROGRAM",
    );
    checks(
        VENDORS,
        "TYPE INTERNAL T1 : STRUCT a : INT; END_STRUCT END_TYPE PROGRAM P VAR s : T1; END_VAR s.a := 1; END_PROGRAM",
    );
    gives(
        &[Iec2, Iec3, Matiec],
        "PROGRAM P VAR AT %QW5 : WORD := 16#FF00; r : WORD; END_VAR r := %QW5; END_PROGRAM",
        0xff00,
    );
    gives(
        VENDORS,
        "FUNCTION_BLOCK F VAR list : ARRAY [0..n] OF INT; END_VAR VAR CONSTANT n : INT := m - 1; m : INT := 16; END_VAR
           VAR_OUTPUT size : UDINT; END_VAR size := SIZEOF(list); END_FUNCTION_BLOCK
         PROGRAM P VAR f1 : F; r : UDINT; END_VAR f1(); r := f1.size; END_PROGRAM",
        32,
    );
    checks(
        VENDORS,
        "TYPE ST_E : STRUCT n : INT; s : STRING(5); END_STRUCT END_TYPE
         VAR_GLOBAL CONSTANT none : ST_E := (n := 3, s := 'none'); END_VAR
         PROGRAM P VAR e : ST_E := none; f : ARRAY [0..1] OF ST_E := [none, none]; END_VAR e.n := f[0].n; END_PROGRAM",
    );
    checks(
        &[SiemensScl],
        "FUNCTION_BLOCK \"Regler\" VAR_INPUT Verstärkung : Real := 2.0; END_VAR VAR Größe : Real; END_VAR BEGIN #Größe := #Verstärkung * 2.0; END_FUNCTION_BLOCK",
    );
}

#[test]
fn a_structure_begins_as_a_constant_does() {
    let text = "TYPE ST_E : STRUCT n : INT; m : INT; END_STRUCT END_TYPE
        VAR_GLOBAL CONSTANT none : ST_E := (n := 3, m := 4); END_VAR
        VAR_GLOBAL other : ST_E := (n := 5); END_VAR
        PROGRAM P VAR e : ST_E := none; f : ST_E := other; r : INT; END_VAR r := 100 * e.n + 10 * e.m + f.n; END_PROGRAM";
    gives(VENDORS, text, 345);
}

#[test]
fn literals() {
    gives(ALL, "PROGRAM P VAR r : BOOL; END_VAR r := TOD#12:00 = TOD#12:00:00; END_PROGRAM", 1);
    gives(VENDORS, "PROGRAM P VAR r : BOOL; END_VAR r := DT#1970-01-01-00:01 = DT#1970-01-01-00:01:00; END_PROGRAM", 1);
    gives(VENDORS, "PROGRAM P VAR s : STRING := '€'; r : BYTE; END_VAR r := s[0]; END_PROGRAM", 0x80);
}

#[test]
fn operators() {
    gives(VENDORS, "PROGRAM P VAR b : BYTE := 5; r : INT; END_VAR r := -b; END_PROGRAM", -5);
    gives(VENDORS, "PROGRAM P VAR u : ULINT := 17; i : INT := 5; r : ULINT; END_VAR r := u MOD i; END_PROGRAM", 2);
    gives(
        VENDORS,
        "PROGRAM P VAR i : USINT; r : INT; END_VAR FOR i := 5 TO 0 BY -1 DO r := r + i; END_FOR; END_PROGRAM",
        15,
    );
    gives(
        VENDORS,
        "PROGRAM P VAR i : UDINT; n : UDINT := 7; k : INT := -2; r : LINT; END_VAR FOR i := n TO 2 BY k DO r := 10 * r + i; END_FOR; END_PROGRAM",
        753,
    );
    gives(
        &[Iec2, Iec3, Matiec],
        "PROGRAM P VAR x : LREAL := 2.0; r : DINT; END_VAR r := LREAL_TO_DINT(-x ** 2); END_PROGRAM",
        4,
    );
    gives(
        &[SiemensScl],
        "PROGRAM P VAR x : LREAL := 2.0; r : DINT; END_VAR r := LREAL_TO_DINT(-x ** 2); END_PROGRAM",
        -4,
    );
}

#[test]
fn conversions() {
    let truth = "PROGRAM P VAR d : DWORD := 2; r : BOOL; END_VAR r := DWORD_TO_BOOL(d); END_PROGRAM";
    gives(&[Codesys, TwinCat, Matiec], truth, 1);
    gives(&[Iec2, Iec3, SiemensScl], truth, 0);
    gives(
        &[Iec2, Iec3, Matiec, Codesys],
        "PROGRAM P VAR x : REAL := 7.9; r : INT; END_VAR r := TRUNC(x); END_PROGRAM",
        7,
    );
    gives(VENDORS, "PROGRAM P VAR i : INT := 17; r : DINT; END_VAR r := TRUNC(i / 3); END_PROGRAM", 5);
    gives(
        &[Iec2, Matiec, Codesys],
        "PROGRAM P VAR w : WORD := 300; r : DINT; END_VAR r := REAL_TO_DINT(WORD_TO_REAL(w)); END_PROGRAM",
        300,
    );
    let seconds =
        "PROGRAM P VAR t : TIME := T#2500ms; r : DINT; END_VAR r := REAL_TO_DINT(TIME_TO_REAL(t) * 10.0); END_PROGRAM";
    gives(&[Matiec], seconds, 25);
    gives(&[Iec2, Iec3], seconds, 25_000);
}

#[test]
fn calls_and_references() {
    gives(VENDORS, "PROGRAM P VAR t : TON; r : BOOL; END_VAR t(IN := TRUE, PT := , Q => r); r := t.IN; END_PROGRAM", 1);
    gives(
        VENDORS,
        "FUNCTION_BLOCK F VAR n : INT := 7; END_VAR
           METHOD Get : REFERENCE TO INT Get REF= n; END_METHOD
           PROPERTY Ref : REFERENCE TO INT GET Ref REF= n; END_GET END_PROPERTY
         END_FUNCTION_BLOCK
         PROGRAM P VAR f1 : F; a, b, none : REFERENCE TO INT; r : INT; END_VAR
           a REF= f1.Get(); b REF= f1.Ref; a := a + 1;
           IF __ISVALIDREF(a) AND __ISVALIDREF(f1.Ref) AND NOT __ISVALIDREF(none) THEN r := b; END_IF; END_PROGRAM",
        8,
    );
    gives(
        VENDORS,
        "FUNCTION F : BOOL VAR_IN_OUT s : INT; END_VAR F := __ISVALIDREF(s); END_FUNCTION
         PROGRAM P VAR i : INT; r : BOOL; END_VAR r := F(i); END_PROGRAM",
        1,
    );
    gives(
        VENDORS,
        "FUNCTION_BLOCK Base VAR n : INT; END_VAR METHOD Kind : INT Kind := 1; END_METHOD METHOD Set VAR_INPUT v : INT; END_VAR n := v; END_METHOD
           METHOD Get : INT Get := n; END_METHOD END_FUNCTION_BLOCK
         FUNCTION_BLOCK Derived EXTENDS Base METHOD Kind : INT Kind := 2; END_METHOD END_FUNCTION_BLOCK
         PROGRAM P VAR a : Base; d : Derived; list : ARRAY [0..1] OF Base; r : INT; END_VAR
           d.Set(5); a := d; list[1] := a; r := 100 * list[1].Get() + 10 * a.Kind() + d.Kind(); END_PROGRAM",
        512,
    );
}

#[test]
fn variables_called_r_and_s_are_no_instructions() {
    gives(
        VENDORS,
        "PROGRAM P VAR i : INT := 3; r : INT; s : REFERENCE TO INT; END_VAR s REF= i; r := s; END_PROGRAM",
        3,
    );
    gives(VENDORS, "PROGRAM P VAR s, r, i : BOOL := TRUE; END_VAR s R= i; r := s; END_PROGRAM", 0);
    gives(VENDORS, "PROGRAM P VAR s, i : BOOL := TRUE; r : BOOL; END_VAR r S= i; s := r; END_PROGRAM", 1);
    gives(ALL, "PROGRAM P VAR r, s : INT := 2; END_VAR r := s + 1; END_PROGRAM", 3);
}

#[test]
fn actions_see_what_their_program_has_at_addresses() {
    for dialect in ALL {
        let text = "PROGRAM P VAR A0 AT %MW100 : UINT := 7; r : UINT; END_VAR Act(); ACTION Act: r := A0; END_ACTION END_PROGRAM";
        gives(&[*dialect], text, 7);
    }
}

#[test]
fn what_matiec_and_its_editors_write() {
    checks(
        &[Matiec],
        "PROGRAM P VAR s : STRING := \"Gate\"; d AT %ML50 : DWORD; END_VAR s := 'x'; d := 1; END_PROGRAM",
    );
    let found = findings_in(
        Matiec,
        "PROGRAM P VAR s : STRING := \"Gate\"; d AT %ML50 : DWORD; END_VAR s := 'x'; d := 1; END_PROGRAM",
    );
    insta::assert_snapshot!(found);
}

#[test]
fn arguments_of_vendors() {
    gives(
        VENDORS,
        "FUNCTION F : INT VAR_INPUT a : INT; b : INT := 7; s : STRING := 'abc'; END_VAR F := a + b + LEN(s); END_FUNCTION
         PROGRAM P VAR r : INT; END_VAR r := F(1) * 10 + F(1, 2, 'x'); END_PROGRAM",
        114,
    );
    gives(
        VENDORS,
        "FUNCTION F : INT VAR_IN_OUT CONSTANT s : STRING; END_VAR F := LEN(s); END_FUNCTION
         VAR_GLOBAL CONSTANT k : STRING := 'abcd'; END_VAR
         PROGRAM P VAR r : INT; t : STRING := 'xy'; END_VAR r := 100 * F('a') + 10 * F(k) + F(t); END_PROGRAM",
        142,
    );
    gives(
        VENDORS,
        "TYPE Base : STRUCT a : INT; END_STRUCT END_TYPE TYPE More EXTENDS Base : STRUCT b : INT; END_STRUCT END_TYPE
         FUNCTION F : INT VAR_IN_OUT s : Base; END_VAR s.a := s.a + 1; F := s.a; END_FUNCTION
         PROGRAM P VAR m : More := (a := 4, b := 9); r : INT; END_VAR r := 10 * F(m) + m.b; END_PROGRAM",
        59,
    );
    gives(VENDORS, "PROGRAM P VAR i : BYTE; r : INT; END_VAR FOR i := 1 TO 3 DO r := r + i; END_FOR; END_PROGRAM", 6);
    gives(
        VENDORS,
        "FUNCTION F : LREAL VAR_INPUT x : LREAL; END_VAR VAR bits : POINTER TO ULINT := ADR(x); END_VAR bits^ := bits^ + 0; F := x; END_FUNCTION
         PROGRAM P VAR r : DINT; END_VAR r := LREAL_TO_DINT(F(2.0)); END_PROGRAM",
        2,
    );
}

#[test]
fn a_method_called_by_pointer_or_reference_is_that_of_the_instance() {
    gives(
        VENDORS,
        "FUNCTION_BLOCK Base METHOD Kind : INT Kind := 1; END_METHOD END_FUNCTION_BLOCK
         FUNCTION_BLOCK Derived EXTENDS Base METHOD Kind : INT Kind := 2; END_METHOD END_FUNCTION_BLOCK
         PROGRAM P VAR d : Derived; p : POINTER TO Base; q : REFERENCE TO Base; r : INT; END_VAR
           p := ADR(d); q REF= d; r := 10 * p^.Kind() + q.Kind(); END_PROGRAM",
        22,
    );
}

/// The 3rd edition's own example of arrays of variable length (6.5.3), which `RuSTy` tests.
#[test]
fn a_repetition_of_repetitions() {
    gives(
        ALL,
        "PROGRAM P VAR a : ARRAY [1..20, -2..2] OF INT := [20(5(1))]; b : ARRAY [0..6] OF INT := [2(3(7)), 5]; r : DINT; END_VAR
           r := INT_TO_DINT(a[20, 2]) * 1000 + INT_TO_DINT(b[5]) * 100 + INT_TO_DINT(b[6]); END_PROGRAM",
        1705,
    );
    let text = "PROGRAM P VAR a : ARRAY [0..5] OF INT := [2(4(7))]; END_VAR a[0] := a[1]; END_PROGRAM";
    assert!(findings_in(Iec3, text).has_errors());
}
