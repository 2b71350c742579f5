//! Subranges and enumerations (2nd ed. 2.3.3, Tables 12 to 14; 3rd ed. 6.4.4).

use onescan_iec::Dialect;
use onescan_iec_run::FaultKind;

use crate::rig::{Rig, findings, result};

const TYPES: &str = "TYPE Percent : INT (0..100); Level : USINT (10..20) := 15; Low : SINT (-5..5); END_TYPE
    VAR_GLOBAL CONSTANT Top : INT := 9; END_VAR ";

fn program(declarations: &str, statements: &str) -> Rig {
    Rig::new(&format!("{TYPES} PROGRAM P VAR {declarations} END_VAR {statements} END_PROGRAM"))
}

#[test]
fn iec2_2_3_3_1_table_12_subranges_begin_with_their_lowest_value() {
    let rig = program("a : Percent; b : Level; c : Low; d : UINT (3..Top) := 4; e : ARRAY [0..1] OF DINT (7..8);", ";");
    assert_eq!(["a", "b", "c", "d", "e[1]"].map(|name| rig.int(&format!("P.{name}"))), [0, 15, -5, 4, 7]);
}

#[test]
fn iec2_2_3_3_1_values_of_a_subrange_are_those_of_its_base() {
    let mut rig = program(
        "a, b : Percent; n : INT := 3; r : REAL; x : ARRAY [0..100] OF INT; t : BOOL; k : Low;",
        "a := n * 20; b := a + Percent#5; r := a; x[a] := b; t := a < b AND a <> 7; n := MAX(a, b); k := -5;
         FOR a := 1 TO 3 DO b := a; END_FOR; CASE b OF 3: b := LIMIT(0, n, 100); END_CASE;",
    );
    rig.scan().expect("no fault");
    assert_eq!((rig.int("P.n"), rig.int("P.b"), rig.int("P.x[60]")), (65, 65, 65));
    assert_eq!((rig.real("P.r"), rig.bool("P.t")), (60.0, true));
}

#[test]
fn iec2_annex_e_a_value_out_of_its_subrange_stops_the_plc() {
    let fault = |declarations: &str, statements: &str| {
        let text = format!(
            "FUNCTION F : INT (0..9) VAR_INPUT x : INT (0..5); END_VAR F := x * 2; END_FUNCTION
PROGRAM P\nVAR {declarations} END_VAR\n{statements}\nEND_PROGRAM"
        );
        Rig::new(&text).scan().expect_err("out of range").to_string()
    };
    insta::assert_snapshot!(fault("a : INT (0..100); n : INT := 101;", "a := n;"), @"value out of subrange at test.st:4:6 in P, t_v = 0.010 s");
    insta::assert_snapshot!(fault("a : LINT (-3..3); n : LINT := -4;", "a := 1 + n - 1;"), @"value out of subrange at test.st:4:6 in P, t_v = 0.010 s");
    insta::assert_snapshot!(fault("n : INT := 6;", "n := F(n);"), @"value out of subrange at test.st:4:8 in P, t_v = 0.010 s");
    insta::assert_snapshot!(fault("n : INT := 5;", "n := F(n);"), @"value out of subrange at test.st:1:64 in F, called by P at test.st:4, t_v = 0.010 s");
}

#[test]
fn iec2_2_3_3_1_table_12_enumerations_have_values_and_a_base() {
    let text = "TYPE A : (Red, Green := 5, Blue); B : (One := 1, Two, Big := 200) USINT := Two;
          C : DINT (Far := 100000, Farther) := Farther; D : (Green, Yellow); END_TYPE
        PROGRAM P VAR p : A := Blue; q : B; f : C; g : D := D#Yellow; e : (On, Off) := Off; x : INT; y : BOOL; s : USINT; END_VAR
          CASE p OF A#Blue: x := 1; p := A.Green; Red: x := 9; END_CASE;
          y := q = Two AND f > Far AND g <> D#Green; s := TO_USINT(q); q := SEL(y, One, Big); END_PROGRAM";
    let mut rig = Rig::new(text);
    assert_eq!(["q", "f", "g", "e"].map(|name| rig.int(&format!("P.{name}"))), [2, 100_001, 1, 1]);
    rig.scan().expect("no fault");
    assert_eq!(["p", "x", "y", "s", "q"].map(|name| rig.int(&format!("P.{name}"))), [5, 1, 1, 2, 200]);
    assert_eq!((rig.variable("P.q").size, rig.variable("P.f").size), (1, 4));
}

#[test]
fn wrong_subranges_and_enumerations_are_reported() {
    insta::assert_snapshot!(findings(
        "TYPE A : INT (5..1); B : SINT (0..200); C : REAL (0..1); D : (X := 300) USINT; E : (Y) STRUCTURE; F : INT (0..9) := 10; END_TYPE
PROGRAM P VAR a : INT (0..100); b : INT (0..5) := 6; d : DINT; r : REAL; END_VAR
  a := 101;
  a := d;
  a := -1;
  r := 1.0;
  a := 1.0;
END_PROGRAM"
    ));
}

#[test]
fn iec2_2_4_3_2_initial_values_of_derived_types() {
    let rig = result(
        "a : ARRAY [1..2] OF ARRAY [0..2] OF INT := [[1, 2(7)], [3(4)]]; b : ARRAY [0..1, 0..2] OF INT := [6(2)];",
        ";",
    );
    assert_eq!(["a[1][2]", "a[2][0]", "b[1,2]"].map(|name| rig.int(&format!("P.{name}"))), [7, 4, 2]);
}

#[test]
fn vendors_assign_what_a_subrange_does_not_have() {
    for dialect in [Dialect::Codesys, Dialect::TwinCat] {
        let text =
            "PROGRAM P VAR a : UINT (1..9); n : UINT; x : ARRAY [1..9] OF INT; y : INT; END_VAR a := n; END_PROGRAM";
        let mut rig = Rig::in_dialect(dialect, text);
        rig.scan().expect("no fault");
        assert_eq!(rig.int("P.a"), 0, "{dialect}");
        // An index is checked all the same.
        let mut rig = Rig::in_dialect(dialect, &text.replace("a := n;", "a := n; y := x[a];"));
        assert_eq!(rig.scan().expect_err("a fault").kind, FaultKind::IndexOutOfRange, "{dialect}");
    }
}
