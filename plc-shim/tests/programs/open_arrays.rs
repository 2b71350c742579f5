//! Arrays of variable length (3rd ed. 6.5.3, Table 15).

use crate::rig::{Rig, findings};

const SUM: &str = "FUNCTION Sum : DINT VAR_INPUT a : ARRAY [*] OF INT; END_VAR VAR i : DINT; END_VAR
  FOR i := LOWER_BOUND(a, 1) TO UPPER_BOUND(a, 1) DO Sum := Sum + a[i]; END_FOR; END_FUNCTION
FUNCTION Scale VAR_IN_OUT a : ARRAY [*] OF INT; END_VAR VAR_INPUT by : INT; END_VAR END_FUNCTION
";

#[test]
fn iec3_6_5_3_table_15_arrays_bring_their_bounds() {
    let text = "
        FUNCTION Fill : DINT VAR_IN_OUT a : ARRAY [*] OF INT; END_VAR VAR_INPUT step : INT; END_VAR VAR i : DINT; END_VAR
        FOR i := LOWER_BOUND(a, 1) TO UPPER_BOUND(a, 1) DO a[i] := step * DINT_TO_INT(i); END_FOR; Fill := Sum(a); END_FUNCTION
        FUNCTION Trace : DINT VAR_IN_OUT m : ARRAY [*, *] OF DINT; END_VAR VAR i, j : INT; END_VAR
        FOR i := DINT_TO_INT(LOWER_BOUND(m, 1)) TO DINT_TO_INT(UPPER_BOUND(m, 1)) DO
          FOR j := DINT_TO_INT(LOWER_BOUND(m, 2)) TO DINT_TO_INT(UPPER_BOUND(m, 2)) DO m[i, j] := 10 * i + j; END_FOR; END_FOR;
        Trace := m[LOWER_BOUND(m, 1), UPPER_BOUND(m, 2)]; END_FUNCTION
        FUNCTION_BLOCK Last VAR_IN_OUT a : ARRAY [*] OF INT; END_VAR VAR_OUTPUT q : INT; END_VAR
        q := a[UPPER_BOUND(a, 1)]; a[LOWER_BOUND(a, 1)] := q; END_FUNCTION_BLOCK
        FUNCTION Sum : DINT VAR_INPUT a : ARRAY [*] OF INT; END_VAR VAR i : DINT; END_VAR
        FOR i := LOWER_BOUND(a, 1) TO UPPER_BOUND(a, 1) DO Sum := Sum + a[i]; END_FOR; END_FUNCTION
        TYPE S : STRUCT list : ARRAY [0..2] OF INT; END_STRUCT END_TYPE
        PROGRAM P VAR a : ARRAY [1..4] OF INT; b : ARRAY [-3..-1] OF INT := [7, 8, 9]; m : ARRAY [2..3, 5..7] OF DINT; s : ARRAY [1..2] OF S;
          fb : Last; x, y, z, u, low, high : DINT; i : INT := 2; r : REF_TO ARRAY [-3..-1] OF INT; END_VAR
        x := Fill(a, 3); y := Sum(b); z := Trace(m); u := Fill(a := s[i].list, step := 5); fb(a := b); low := LOWER_BOUND(m, 2); high := UPPER_BOUND(m, 1);
        r := REF(b); y := y + 100 * Sum(r^); END_PROGRAM";
    let mut rig = Rig::new(text);
    rig.scan().expect("no fault");
    assert_eq!((rig.int("P.x"), rig.int("P.a[4]"), rig.int("P.y")), (30, 12, 2624));
    assert_eq!((rig.int("P.z"), rig.int("P.m[2,7]"), rig.int("P.m[3,5]"), rig.int("P.m[3,7]")), (27, 27, 35, 37));
    assert_eq!((rig.int("P.u"), rig.int("P.s[2].list[2]"), rig.int("P.s[1].list[2]")), (15, 10, 0));
    assert_eq!((rig.int("P.fb.q"), rig.int("P.b[-3]"), rig.int("P.low"), rig.int("P.high")), (9, 9, 5, 3));
}

#[test]
fn iec3_6_5_3_an_index_out_of_the_bounds_that_came_stops_the_plc() {
    for (index, failing) in [("0", true), ("1", false), ("4", false), ("5", true), ("-1", true), ("100000", true)] {
        let text = format!(
            "FUNCTION Get : INT VAR_IN_OUT a : ARRAY [*] OF INT; END_VAR VAR_INPUT i : DINT; END_VAR\n  Get := a[i];\nEND_FUNCTION
PROGRAM P VAR a : ARRAY [1..4] OF INT; x : INT; END_VAR x := Get(a, {index}); END_PROGRAM"
        );
        let mut rig = Rig::new(&text);
        let told = rig.scan().map_err(|fault| fault.to_string());
        assert_eq!(told.is_err(), failing, "{index}");
        if let Err(told) = told {
            assert!(told.starts_with("array index out of range at test.st:2:10 in Get"), "{told}");
        }
    }
}

#[test]
fn wrong_arrays_are_told() {
    let told = |statement: &str| {
        let declarations =
            "a : ARRAY [1..4] OF INT; d : ARRAY [1..4] OF DINT; m : ARRAY [1..2, 1..2] OF INT; x : DINT; i : INT;";
        let text = format!("{SUM}PROGRAM P VAR {declarations} END_VAR\n{statement}\nEND_PROGRAM")
            .replace("by : INT", "n : INT");
        findings(&text).lines().next().unwrap_or_default().to_owned()
    };
    for (statement, expected) in [
        ("x := Sum(d);", "test.st:5:10: error[C0305]: `a` is ARRAY [*] OF INT, this is ARRAY [1..4] OF DINT"),
        ("x := Sum(m);", "test.st:5:10: error[C0305]: `a` is ARRAY [*] OF INT, this is ARRAY [1..2, 1..2] OF INT"),
        ("x := Sum(i);", "test.st:5:10: error[C0305]: `a` is ARRAY [*] OF INT, this is INT"),
        ("x := UPPER_BOUND(a, 2);", "test.st:5:21: error[T0207]: the array has the dimensions 1 to 1, not 2"),
        ("x := UPPER_BOUND(i, 1);", "test.st:5:18: error[T0206]: INT is not an array"),
        ("x := UPPER_BOUND(a);", "test.st:5:6: error[C0302]: UPPER_BOUND takes an array and a dimension"),
        ("x := UPPER_BOUND(a, x);", "test.st:5:21: error[T0204]: a constant is wanted here"),
    ] {
        assert_eq!(told(statement), expected, "{statement}");
    }
    for (unit, expected) in [
        ("PROGRAM P VAR a : ARRAY [*] OF INT; END_VAR END_PROGRAM", "error[R0907]"),
        ("FUNCTION_BLOCK B VAR_INPUT a : ARRAY [*] OF INT; END_VAR END_FUNCTION_BLOCK", "error[R0907]"),
        ("FUNCTION F : ARRAY [*] OF INT VAR_INPUT a : INT; END_VAR END_FUNCTION", "error[R0907]"),
        ("VAR_GLOBAL a : ARRAY [*] OF INT; END_VAR", "error[R0907]"),
        ("TYPE S : STRUCT a : ARRAY [*] OF INT; END_STRUCT END_TYPE", "error[R0907]"),
        ("FUNCTION F VAR_IN_OUT a : ARRAY [1..2] OF ARRAY [*] OF INT; END_VAR END_FUNCTION", "error[R0907]"),
        ("FUNCTION F VAR_IN_OUT a : ARRAY [*, 1..2] OF INT; END_VAR END_FUNCTION", "error[S0101]: `*` expected"),
        ("FUNCTION F VAR_INPUT a : ARRAY [*] OF INT; END_VAR a[1] := 2; END_FUNCTION", "error[D0401]"),
        ("FUNCTION F VAR_IN_OUT a, b : ARRAY [*] OF INT; END_VAR a := b; END_FUNCTION", "error[R0907]"),
        (
            "FUNCTION F VAR_IN_OUT a : ARRAY [*] OF INT; END_VAR VAR r : REF_TO INT; END_VAR r := REF(a); END_FUNCTION",
            "error",
        ),
    ] {
        let found = findings(unit);
        assert!(found.contains(expected), "{unit}: {found}");
    }
}
