//! Arrays of variable length (3rd ed. 6.5.3, Table 15).

use crate::rig::{Rig, findings};

const SUM: &str = "FUNCTION Sum : DINT VAR_INPUT a : ARRAY [*] OF INT; END_VAR VAR i : DINT; END_VAR
  FOR i := LOWER_BOUND(a, 1) TO UPPER_BOUND(a, 1) DO Sum := Sum + a[i]; END_FOR; END_FUNCTION
FUNCTION Scale VAR_IN_OUT a : ARRAY [*] OF INT; END_VAR VAR_INPUT by : INT; END_VAR END_FUNCTION
FUNCTION Make VAR_INPUT n : INT; END_VAR VAR_OUTPUT a : ARRAY [*] OF INT; END_VAR a[1] := n; END_FUNCTION
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
        let reported = rig.scan().map_err(|fault| fault.to_string());
        assert_eq!(reported.is_err(), failing, "{index}");
        if let Err(reported) = reported {
            assert!(reported.starts_with("array index out of range at test.st:2:10 in Get"), "{reported}");
        }
    }
}

#[test]
fn iec3_6_5_3_functions_and_methods_write_to_the_arrays_of_their_outputs() {
    let text = "
        FUNCTION Ramp VAR_INPUT from : INT; END_VAR VAR_OUTPUT a : ARRAY [*] OF INT; last : INT; END_VAR VAR i : DINT; END_VAR
        FOR i := LOWER_BOUND(a, 1) TO UPPER_BOUND(a, 1) DO a[i] := from + DINT_TO_INT(i); END_FOR;
        last := a[UPPER_BOUND(a, 1)]; END_FUNCTION
        FUNCTION Both VAR_OUTPUT x, y : ARRAY [*] OF INT; END_VAR
        Ramp(from := 100, a => x); Ramp(from := 200, a => y); x[LOWER_BOUND(x, 1)] := 7; END_FUNCTION
        INTERFACE IStore METHOD Copy : DINT VAR_INPUT a : ARRAY [*] OF INT; END_VAR VAR_OUTPUT b : ARRAY [*] OF INT; n : INT; END_VAR END_METHOD END_INTERFACE
        CLASS Store IMPLEMENTS IStore
          METHOD Copy : DINT VAR_INPUT a : ARRAY [*] OF INT; END_VAR VAR_OUTPUT b : ARRAY [*] OF INT; n : INT; END_VAR VAR i : DINT; END_VAR
          FOR i := 0 TO UPPER_BOUND(a, 1) - LOWER_BOUND(a, 1) DO b[LOWER_BOUND(b, 1) + i] := a[LOWER_BOUND(a, 1) + i]; n := n + 1; END_FOR;
          Copy := UPPER_BOUND(b, 1); END_METHOD
        END_CLASS
        CLASS Twice EXTENDS Store METHOD OVERRIDE Copy : DINT VAR_INPUT a : ARRAY [*] OF INT; END_VAR VAR_OUTPUT b : ARRAY [*] OF INT; n : INT; END_VAR
          Copy := SUPER.Copy(a, b => b, n => n); b[LOWER_BOUND(b, 1)] := -1; END_METHOD END_CLASS
        PROGRAM P VAR a : ARRAY [1..3] OF INT; b : ARRAY [-2..1] OF INT; c : ARRAY [0..4] OF INT := [5(9)]; n, last : INT; x : DINT;
          store : Store; twice : Twice; i : IStore; END_VAR
        Ramp(from := 10, a => a, last => last); Both(x => b, y => c);
        x := store.Copy(a, b => c, n => n); i := twice; x := x + 10 * i.Copy(a, b => b); END_PROGRAM";
    let mut rig = Rig::new(text);
    rig.scan().expect("no fault");
    let list = |name: &str, from: i32, to: i32| (from..=to).map(|at| rig.int(&format!("P.{name}[{at}]"))).collect();
    let (a, b, c): (Vec<i64>, Vec<i64>, Vec<i64>) = (list("a", 1, 3), list("b", -2, 1), list("c", 0, 4));
    assert_eq!((a, rig.int("P.last")), (vec![11, 12, 13], 13));
    assert_eq!(b, [-1, 12, 13, 101]);
    assert_eq!((c, rig.int("P.n"), rig.int("P.x")), (vec![11, 12, 13, 203, 204], 3, 14));
}

#[test]
fn wrong_arrays_are_reported() {
    let reported = |statement: &str| {
        let declarations =
            "a : ARRAY [1..4] OF INT; d : ARRAY [1..4] OF DINT; m : ARRAY [1..2, 1..2] OF INT; x : DINT; i : INT;";
        let text = format!("{SUM}PROGRAM P VAR {declarations} END_VAR\n{statement}\nEND_PROGRAM")
            .replace("by : INT", "n : INT");
        findings(&text).lines().next().unwrap_or_default().to_owned()
    };
    for (statement, expected) in [
        ("x := Sum(d);", "test.st:6:10: error[C0305]: `a` is ARRAY [*] OF INT, this is ARRAY [1..4] OF DINT"),
        ("x := Sum(m);", "test.st:6:10: error[C0305]: `a` is ARRAY [*] OF INT, this is ARRAY [1..2, 1..2] OF INT"),
        ("x := Sum(i);", "test.st:6:10: error[C0305]: `a` is ARRAY [*] OF INT, this is INT"),
        ("x := UPPER_BOUND(a, 2);", "test.st:6:21: error[T0207]: the array has the dimensions 1 to 1, not 2"),
        ("x := UPPER_BOUND(i, 1);", "test.st:6:18: error[T0206]: INT is not an array"),
        ("x := UPPER_BOUND(a);", "test.st:6:6: error[C0302]: UPPER_BOUND takes an array and a dimension"),
        ("Scale(n := 1);", "test.st:6:1: error[C0302]: parameter `a` is missing"),
        ("Make(n := 1);", "test.st:6:1: error[C0302]: parameter `a` is missing"),
        ("Make(n := 1, a => d);", "test.st:6:19: error[C0305]: `a` is ARRAY [*] OF INT, this is ARRAY [1..4] OF DINT"),
        ("Make(n := 1, NOT a => a);", "test.st:6:23: error[T0201]: BOOL is wanted, this is ARRAY [*] OF INT"),
        ("x := UPPER_BOUND(a, 1.5);", "test.st:6:21: error[T0201]: an integer is wanted, this is LREAL"),
    ] {
        assert_eq!(reported(statement), expected, "{statement}");
    }
    for (unit, expected) in [
        ("PROGRAM P VAR a : ARRAY [*] OF INT; END_VAR END_PROGRAM", "error[R0907]"),
        ("FUNCTION_BLOCK B VAR_OUTPUT a : ARRAY [*] OF INT; END_VAR END_FUNCTION_BLOCK", "error[R0907]"),
        ("FUNCTION F VAR a : ARRAY [*] OF INT; END_VAR END_FUNCTION", "error[R0907]"),
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

/// 3rd ed. 6.5.3: the dimension is an `ANY_INT`, so a variable, too.
#[test]
fn a_dimension_is_chosen_when_the_program_runs() {
    let text = "
        FUNCTION Extent : DINT VAR_IN_OUT m : ARRAY [*, *] OF INT; END_VAR VAR_INPUT d : INT; END_VAR
        Extent := UPPER_BOUND(m, d) - LOWER_BOUND(m, d) + 1; END_FUNCTION
        PROGRAM P VAR m : ARRAY [2..3, -5..7] OF INT; d : USINT := 2; x, y, low : DINT; END_VAR
        x := Extent(m, 1); y := Extent(m, 2); low := LOWER_BOUND(m, d); d := d + 1; END_PROGRAM";
    let mut rig = Rig::new(text);
    rig.scan().expect("no fault");
    assert_eq!((rig.int("P.x"), rig.int("P.y"), rig.int("P.low")), (2, 13, -5));
    let fault = rig.scan().expect_err("there is no third dimension").to_string();
    assert!(fault.starts_with("selector out of range at test.st:5"), "{fault}");
}
