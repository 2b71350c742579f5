//! Every form of every fault names its file, line, unit, caller and virtual time.

use onescan_iec_run::FaultKind;
use std::collections::BTreeSet;

use crate::rig::Rig;

const OTHERS: &str = "
FUNCTION Pick : INT VAR_INPUT a : ARRAY [*] OF INT; i : DINT; END_VAR Pick := a[i]; END_FUNCTION
FUNCTION Narrow : INT VAR_INPUT n : INT (0..5); END_VAR Narrow := n; END_FUNCTION
FUNCTION Give VAR_OUTPUT n : INT; END_VAR n := 9; END_FUNCTION
FUNCTION_BLOCK Inner VAR_INPUT x : INT (0..5); END_VAR VAR_OUTPUT q : INT; END_VAR q := x; END_FUNCTION_BLOCK
INTERFACE IDo METHOD Act : INT VAR_INPUT n : INT; END_VAR END_METHOD END_INTERFACE
FUNCTION_BLOCK Doer IMPLEMENTS IDo VAR_INPUT next : IDo; END_VAR
  METHOD Act : INT VAR_INPUT n : INT; END_VAR IF n > 0 THEN Act := next.Act(n - 1) + 1; END_IF; END_METHOD END_FUNCTION_BLOCK
FUNCTION_BLOCK Loud IMPLEMENTS IDo VAR_INPUT next : IDo; END_VAR
  METHOD Act : INT VAR_INPUT n : INT; END_VAR VAR s : STRING; END_VAR s := 'a'; Act := LEN(s) + next.Act(n); END_METHOD END_FUNCTION_BLOCK
TYPE Rec : STRUCT list : ARRAY [1..3] OF INT; END_STRUCT END_TYPE
";

const INTEGERS: [&str; 8] = ["SINT", "INT", "DINT", "LINT", "USINT", "UINT", "UDINT", "ULINT"];

const CASES: &[(FaultKind, &str, &str)] = {
    use FaultKind::*;
    &[
        (DivisionByZero, "x, y : REAL;", "x := 1.0 / y;"),
        (DivisionByZero, "x, y : LREAL;", "x := x / y;"),
        (DivisionByZero, "n : INT;", "n := DIV(5, n);"),
        (DivisionByZero, "t : TIME; n : INT;", "t := T#1s / n;"),
        (DivisionByZero, "t : LTIME; n : LINT;", "t := DIV_LTIME(t, n);"),
        (DivisionByZero, "t : TIME; x : REAL;", "t := t / x;"),
        (IndexOutOfRange, "a : ARRAY [1..4] OF INT; i : INT;", "i := a[i];"),
        (IndexOutOfRange, "a : ARRAY [1..4] OF INT; i : INT := 5;", "a[i] := 1;"),
        (IndexOutOfRange, "a : ARRAY [-2..2] OF LREAL; i : SINT := -3;", "a[i] := 1.0;"),
        (IndexOutOfRange, "a : ARRAY [0..9] OF INT; i : ULINT := 18446744073709551615;", "a[i] := 1;"),
        (IndexOutOfRange, "a : ARRAY [0..9] OF INT; i : LINT := 4294967296;", "a[i] := 1;"),
        (IndexOutOfRange, "a : ARRAY [0..1, 1..2] OF INT; i : INT;", "a[1, i] := 1;"),
        (IndexOutOfRange, "a : ARRAY [1..2] OF Rec; i : INT := 4;", "a[2].list[i] := 1;"),
        (IndexOutOfRange, "a : ARRAY [1..2] OF Rec; i : INT := 4;", "a[i].list[1] := 1;"),
        (IndexOutOfRange, "a : ARRAY [1..3] OF INT; i : INT;", "FOR i := 1 TO 4 DO a[i] := i; END_FOR;"),
        (
            IndexOutOfRange,
            "a : ARRAY [1..3] OF INT; i : INT := 3;",
            "REPEAT i := i + 1; a[i] := i; UNTIL FALSE END_REPEAT;",
        ),
        (IndexOutOfRange, "a : ARRAY [1..3] OF Inner; i : INT;", "a[i](x := 1);"),
        (IndexOutOfRange, "a : ARRAY [1..3] OF BOOL; i : INT; b : BOOL;", "b := b AND a[i];"),
        (IndexOutOfRange, "a : ARRAY [1..3] OF STRING[5]; i : INT;", "a[i] := 'x';"),
        (
            IndexOutOfRange,
            "r : REF_TO ARRAY [1..3] OF INT; a : ARRAY [1..3] OF INT; i : INT;",
            "r := REF(a); r^[i] := 1;",
        ),
        (IndexOutOfRange, "a, b : ARRAY [1..3] OF INT; i : INT;", "a[b[i]] := 1;"),
        (SelectorOutOfRange, "n : INT := 2;", "n := MUX(n, 1, 2);"),
        (SelectorOutOfRange, "n : INT := -1; s : STRING;", "s := MUX(n, 'a', 'b');"),
        (ZeroStep, "i, n : INT;", "FOR i := 1 TO 2 BY n DO ; END_FOR;"),
        (ZeroStep, "i, n : LINT;", "FOR i := 1 TO 2 BY n DO ; END_FOR;"),
        (EndlessLoop, "n : INT;", "WHILE n = 0 DO ; END_WHILE;"),
        (EndlessLoop, "n : INT;", "REPEAT n := 1; UNTIL n = 0 END_REPEAT;"),
        (EndlessLoop, "i : INT;", "FOR i := 1 TO 2 DO i := 0; END_FOR;"),
        (
            EndlessLoop,
            "i, j, k : DINT; n : LINT;",
            "FOR i := 1 TO 100000 DO FOR j := 1 TO 100000 DO n := n + i / j; END_FOR; END_FOR;",
        ),
        (OutOfSubrange, "n : INT := 9; r : INT (0..5);", "r := n;"),
        (OutOfSubrange, "n : INT := 9; r : ARRAY [0..1] OF INT (0..5);", "r[1] := n;"),
        (OutOfSubrange, "n : INT := -1;", "n := Narrow(n);"),
        (OutOfSubrange, "n : INT := 6; f : Inner;", "f(x := n);"),
        (OutOfSubrange, "r : INT (0..5);", "Give(n => r);"),
        (OutOfSubrange, "r : UINT (1..5) := 5;", "r := r + 1;"),
        (NullReference, "r : REF_TO INT;", "r^ := 1;"),
        (NullReference, "r : REF_TO INT; n : INT;", "n := r^;"),
        (NullReference, "r : REF_TO Rec;", "r^.list[1] := 1;"),
        (NullReference, "r : REF_TO Inner;", "r^(x := 1);"),
        (NullReference, "r : REFERENCE TO INT;", "r := 1;"),
        (NullReference, "p : POINTER TO INT;", "p^ := 1;"),
        (NullReference, "i : IDo; n : INT;", "n := i.Act(1);"),
        (InvalidPointer, "p : POINTER TO INT;", "p := 16#7FFFFFFF; p^ := 1;"),
        (InvalidPointer, "p : POINTER TO INT; n : INT;", "p := ADR(n); p[100000000] := 1;"),
        (InvalidPointer, "p : POINTER TO BYTE; n : BYTE;", "p := 16#FFFFFFFF; n := p^;"),
        (InvalidPointer, "p : POINTER TO BYTE; n : BYTE;", "p := ADR(n) - 1000000000; n := p^;"),
        (InvalidPointer, "n : BYTE;", "MEMSET(ADR(n), 0, 16#7FFFFFFF);"),
    ]
};

/// Runs the statement in an instance that a program calls.
fn fault(declarations: &str, statement: &str) -> onescan_iec_run::PlcFault {
    let text = format!(
        "FUNCTION_BLOCK Unit VAR {declarations} END_VAR\n{statement}\nEND_FUNCTION_BLOCK
PROGRAM P VAR u : Unit; END_VAR\nu();\nEND_PROGRAM{OTHERS}"
    );
    Rig::new(&text).scan().expect_err(statement)
}

#[test]
fn iec2_annex_e_every_form_of_a_fault_names_its_place() {
    let divisions = INTEGERS.map(|ty| (FaultKind::DivisionByZero, format!("a, b : {ty} := 0;"), "a := 100 / b;"));
    let divisions = divisions.iter().map(|(kind, declarations, statement)| (*kind, declarations.as_str(), *statement));
    let deep = [
        (FaultKind::CallTooDeep, "d : Doer; n : INT;", "d.next := d; n := d.Act(200);"),
        (FaultKind::Reentered, "l : Loud; n : INT;", "l.next := l; n := l.Act(2);"),
    ];
    let mut kinds = BTreeSet::new();
    for (kind, declarations, statement) in divisions.chain(CASES.iter().copied()).chain(deep) {
        let found = fault(declarations, statement);
        assert_eq!(found.kind, kind, "{statement}: {found}");
        let reported = found.to_string();
        let inside = format!("{kind} at test.st:2:");
        let direct = reported.starts_with(&inside)
            && reported.contains(" in P.u (Unit), called by P at test.st:5, t_v = 0.010 s");
        let below = reported.contains("called by P.u (Unit) at test.st:2, called by P at test.st:5, t_v = 0.010 s");
        assert!(direct || below, "{statement}: {reported}");
        kinds.insert(kind);
    }
    // An internal error has no program.
    let all: BTreeSet<_> = FaultKind::ALL.into_iter().filter(|kind| *kind != FaultKind::Internal).collect();
    assert_eq!(kinds, all);
}

#[test]
fn what_stops_nothing() {
    let quiet = [
        ("n : INT := -7; z : INT;", "n := n MOD z;"),
        ("n : SINT := -128; m : SINT := -1;", "n := n / m;"),
        ("n : LINT := -9223372036854775807; m : LINT := -1;", "n := (n - 1) / m; n := (n - 1) MOD m;"),
        ("r : LREAL := 1.0E300; n : INT;", "n := LREAL_TO_INT(r); n := LREAL_TO_INT(SQRT(-r));"),
        (
            "s : STRING := 'abc'; t : STRING;",
            "t := MID(s, 5, -3); t := LEFT(s, -1); t := INSERT(s, s, 99); t := DELETE(s, 300, 300);",
        ),
        ("s : STRING; n : INT;", "n := STRING_TO_INT('99999999'); s := 'x'; n := FIND(s, '');"),
        ("w : WORD; n : INT := -5;", "w := SHL(w, n); w := ROR(w, n);"),
        ("x : LREAL;", "x := LN(x); x := ATAN2(0.0, 0.0);"),
    ];
    for (declarations, statement) in quiet {
        let text = format!("PROGRAM P VAR {declarations} END_VAR {statement} END_PROGRAM");
        Rig::new(&text).scan().expect(statement);
    }
}
