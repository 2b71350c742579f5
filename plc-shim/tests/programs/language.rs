use onescan_iec::Dialect;

use crate::rig::{Rig, findings_in, result};

/// Declarations, statements, the value of `r`.
const TABLE: &[(&str, &str, i64)] = &[
    // Integers wrap at their width.
    ("r : SINT := 127;", "r := r + 1;", -128),
    ("r : USINT;", "r := r - 1;", 255),
    ("r : INT := 32767;", "r := r * 2;", -2),
    ("r : DINT := 2147483647;", "r := r + 1;", -2_147_483_648),
    ("r : LINT := 9223372036854775807;", "r := r + 1;", i64::MIN),
    ("a, b : INT := 300; r : DINT;", "r := a * b;", 300 * 300 - 65536),
    ("r : DINT := -2147483648; m : DINT := -1;", "r := r / m;", -2_147_483_648),
    ("r : LINT; m : LINT := -1;", "r := (-9223372036854775807 - 1) / m;", i64::MIN),
    ("r : SINT := -128; m : SINT := -1;", "r := r / m;", -128),
    ("r : INT := -7;", "r := r / 2;", -3),
    ("r : INT := -7;", "r := r MOD 2;", -1),
    ("r : INT := 7; z : INT;", "r := r MOD z;", 0),
    ("r : UDINT := 16#FFFF_FFFF;", "r := r / 2;", 0x7fff_ffff),
    ("a : UDINT := 16#FFFF_FFFF; r : BOOL;", "r := a > 1;", 1),
    // Precedence and operators.
    ("r : INT;", "r := 2 + 3 * 4 - 1;", 13),
    ("r : DINT; x : LREAL := 3.0;", "r := LREAL_TO_DINT(-x ** 2);", 9),
    ("r : BOOL; a, b : BOOL := TRUE;", "r := NOT a OR b XOR a AND NOT b;", 1),
    ("r : BYTE := 16#0F;", "r := NOT r AND 16#3C;", 0x30),
    ("r : WORD; b : BYTE := 16#80;", "r := b OR WORD#16#100;", 0x180),
    ("r : BOOL; t : TIME := T#2s;", "r := t * 2 - T#1s = T#3s;", 1),
    ("r : TIME := T#1s;", "r := r / 4 + r * 0.5;", 750_000_000),
    ("r : LTIME; t : TIME := T#-1.5s;", "r := t;", -1_500_000_000),
    // Statements.
    ("r : INT;", "IF r > 0 THEN r := 1; ELSIF r = 0 THEN r := 2; ELSE r := 3; END_IF;", 2),
    ("r, i : INT := 7;", "CASE i OF 1, 2: r := 1; 5..8: r := 2; ELSE r := 3; END_CASE;", 2),
    ("r, i : INT := -7;", "CASE i OF -7: r := 1; ELSE r := 3; END_CASE;", 1),
    ("r, i : INT;", "FOR i := 1 TO 10 DO r := r + i; END_FOR;", 55),
    ("r, i : INT;", "FOR i := 10 TO 1 BY -3 DO r := r + i; END_FOR;", 10 + 7 + 4 + 1),
    ("r, i : INT;", "FOR i := 1 TO 10 DO ; END_FOR; r := i;", 11),
    ("r : INT; i : SINT;", "FOR i := 120 TO 127 DO r := r + 1; END_FOR;", 8),
    ("r : INT; i : USINT;", "FOR i := 250 TO 255 BY 2 DO r := r + 1; END_FOR;", 3),
    ("r : INT; i : SINT;", "FOR i := -120 TO -128 BY -1 DO r := r + 1; END_FOR;", 9),
    ("r : INT; i : ULINT;", "FOR i := 18446744073709551614 TO 18446744073709551615 DO r := r + 1; END_FOR;", 2),
    ("r, i : INT;", "FOR i := 5 TO 1 DO r := 1; END_FOR;", 0),
    ("r, i, n : INT := 3;", "FOR i := 1 TO n DO n := 100; r := r + 1; END_FOR;", 6),
    (
        "r, i : INT;",
        "FOR i := 1 TO 10 DO IF i = 3 THEN CONTINUE; END_IF; IF i = 6 THEN EXIT; END_IF; r := r + i; END_FOR;",
        12,
    ),
    ("r : INT;", "WHILE r < 5 DO r := r + 2; END_WHILE;", 6),
    ("r : INT := 9;", "REPEAT r := r + 1; UNTIL TRUE END_REPEAT;", 10),
    ("r : INT;", "r := 1; RETURN; r := 2;", 1),
    (
        "r, i, j : INT;",
        "FOR i := 1 TO 3 DO FOR j := 1 TO 3 DO IF j = 2 THEN EXIT; END_IF; r := r + 1; END_FOR; END_FOR;",
        3,
    ),
    // Aggregates.
    ("a : ARRAY [-1..1, 2..3] OF INT := [1, 2, 3(7), 9]; r, i : INT := 1;", "r := a[i, 3] * 100 + a[-1, i + 2];", 902),
    ("a, b : ARRAY [0..3] OF DINT := [4(5)]; r : DINT;", "a[2] := 1; b := a; a[2] := 0; r := b[2] + b[3];", 6),
    (
        "a : ARRAY [0..1] OF ARRAY [0..1] OF INT := [[1, 2], [3, 4]]; r, i : INT := 1;",
        "r := a[i][0] * 10 + a[0][i];",
        32,
    ),
    // Constants.
    ("r : INT; b : BYTE := 255;", "r := BYTE_TO_INT(b) + 2#1010 + 8#17 + 16#1F;", 255 + 10 + 15 + 31),
];

#[test]
fn statements_do_what_the_standard_says() {
    for (declarations, statements, wanted) in TABLE {
        let rig = result(declarations, statements);
        assert_eq!(rig.int("P.r"), *wanted, "{declarations} {statements}");
    }
}

#[test]
fn structures_enumerations_and_aliases() {
    let mut rig = Rig::new(
        "TYPE
            Colour : (Red, Green := 5, Blue);
            Point : STRUCT x, y : INT := 3; END_STRUCT;
            Line : STRUCT from, to_ : Point := (y := 8); c : Colour := Blue; END_STRUCT;
            Speed : REAL := 1.5;
        END_TYPE
        VAR_GLOBAL CONSTANT N : INT := 2; END_VAR
        VAR_GLOBAL lines : ARRAY [1..N] OF Line := [(from := (x := 1)), (c := Red)]; END_VAR
        PROGRAM P
        VAR_EXTERNAL lines : ARRAY [1..2] OF Line; END_VAR
        VAR l : Line; s : Speed; q, is : INT; ok : BOOL; END_VAR
            l := lines[1];
            l.to_.x := l.from.x + N;
            q := l.from.x * 1000 + l.from.y * 100 + l.to_.x * 10 + l.to_.y;
            ok := l.c = Colour#Blue AND lines[2].c = Red AND l.c <> Colour.Green;
            CASE l.c OF Red: is := 1; Colour#Blue: is := 2; END_CASE;
        END_PROGRAM",
    );
    rig.scan().expect("no fault");
    assert_eq!(rig.int("P.q"), 1000 + 800 + 30 + 8);
    assert!(rig.bool("P.ok"));
    assert_eq!(rig.int("P.is"), 2);
    assert_eq!(rig.real("P.s"), 1.5);
    assert_eq!(rig.int("lines[2].from.y"), 8);
}

#[test]
fn functions_take_and_give_values_references_and_aggregates() {
    let mut rig = Rig::new(
        "TYPE Pair : STRUCT a, b : INT; END_STRUCT; END_TYPE
        FUNCTION Swapped : Pair VAR_INPUT p : Pair; END_VAR
            Swapped.a := p.b; Swapped.b := p.a; p.a := 99;
        END_FUNCTION
        FUNCTION Sum : INT VAR_INPUT p, q : Pair; k : INT := 5; END_VAR
            Sum := p.a * 1000 + q.a * 100 + p.b * 10 + k;
        END_FUNCTION
        FUNCTION Divided : INT
        VAR_INPUT n, d : INT; END_VAR VAR_OUTPUT rest : INT; END_VAR
        VAR_IN_OUT calls : DINT; END_VAR
        VAR local : INT := 1; END_VAR
            calls := calls + local; local := 7; rest := n MOD d; Divided := n / d;
        END_FUNCTION
        FUNCTION_BLOCK Acc VAR_IN_OUT total : DINT; END_VAR VAR_INPUT x : INT; END_VAR
        VAR_TEMP t : DINT := 2; buffer : ARRAY [0..2] OF INT := [3(1)]; END_VAR
            total := total + x * t; t := 100; buffer[1] := buffer[1] + 1; total := total + buffer[1];
        END_FUNCTION_BLOCK
        PROGRAM P
        VAR p : Pair := (a := 1, b := 2); s, d, m : INT; n : DINT; acc : Acc; END_VAR
        VAR_TEMP temp : DINT; END_VAR
            s := Sum(p := Swapped(p), q := p);
            d := Divided(17, 5, n) + Divided(n := 9, d := 2, calls := n, rest => m);
            acc(total := n, x := 10);
            acc(total := temp, x := 1);
            n := n + temp * 1000;
        END_PROGRAM",
    );
    rig.scan().expect("no fault");
    // Swapped(p) is (2, 1) and p is unchanged by the callee.
    assert_eq!(rig.int("P.s"), 2000 + 100 + 10 + 5);
    assert_eq!(rig.int("P.p.a"), 1);
    assert_eq!((rig.int("P.d"), rig.int("P.m")), (3 + 4, 1));
    assert_eq!(rig.int("P.n"), 2 + 20 + 2 + 4000);
}

#[test]
fn instances_are_independent_also_in_arrays() {
    let mut rig = Rig::new(
        "PROGRAM P
        VAR t : ARRAY [0..2] OF CTU; i, sum : INT; s : SR; END_VAR
            FOR i := 0 TO 2 DO t[i](CU := NOT t[i].CU OR i = 1, PV := i); END_FOR;
            sum := t[0].CV * 100 + t[1].CV * 10 + t[2].CV;
            s(S1 := t[2].Q);
        END_PROGRAM",
    );
    for _ in 0..5 {
        rig.scan().expect("no fault");
    }
    assert_eq!(rig.int("P.sum"), 313);
    assert_eq!(rig.int("P.t[2].CV"), 3);
    assert!(rig.bool("P.s.Q1"));
}

#[test]
fn a_type_with_named_values_has_the_other_values_of_its_type_too() {
    // 3rd ed. 6.4.4.3: names do not limit the values.
    let text = "TYPE Status : WORD (Ok := 16#7000, Wrong := 16#8001); END_TYPE
        PROGRAM P VAR s : Status; w : WORD; n : INT; END_VAR
          s := Status#Wrong; w := s; s := 16#1234; IF s = Status#Ok OR w = Status#Wrong THEN n := 1; END_IF; w := s; END_PROGRAM";
    let mut rig = Rig::in_dialect(Dialect::Iec3, text);
    rig.scan().expect("no fault");
    assert_eq!((rig.int("P.w"), rig.int("P.n")), (0x1234, 1));
    let plain = "TYPE Colour : (Red, Green); END_TYPE PROGRAM P VAR c : Colour; END_VAR c := 1; END_PROGRAM";
    assert!(findings_in(Dialect::Iec3, plain).iter().any(|found| found.code.text() == "T0201"));
}
