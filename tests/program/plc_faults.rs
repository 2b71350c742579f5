//! A PLC program that fails ends the run with file, line and virtual time, and exit code 3.

use crate::typed::{copied_shear, edit, typed};

/// What calls itself in a way that only the run decides, up to a depth and not at all.
const CIRCLES: &str = "
INTERFACE IDo METHOD Act : INT VAR_INPUT n : INT; END_VAR END_METHOD END_INTERFACE
FUNCTION_BLOCK Doer IMPLEMENTS IDo VAR_INPUT next : IDo; END_VAR
  METHOD Act : INT VAR_INPUT n : INT; END_VAR IF n > 0 THEN Act := next.Act(n - 1) + 1; END_IF; END_METHOD
END_FUNCTION_BLOCK
FUNCTION_BLOCK Loud IMPLEMENTS IDo VAR_INPUT next : IDo; END_VAR
  METHOD Act : INT VAR_INPUT n : INT; END_VAR VAR s : STRING; END_VAR s := 'a'; Act := LEN(s) + next.Act(n); END_METHOD
END_FUNCTION_BLOCK
";

/// Breaks the alignment check at its end, at the 30th scan, and gives what is said of it.
fn broken_by(declaration: &str, statement: &str) -> String {
    let folder = copied_shear();
    let at_scan_30 = format!("n := n + 1; IF n = 30 THEN {statement} END_IF;\nEND_PROGRAM{CIRCLES}");
    edit(folder.path(), "plc/alignment.st", "END_PROGRAM", &at_scan_30);
    edit(folder.path(), "plc/alignment.st", "a, b, c : R_TRIG;", &format!("a, b, c : R_TRIG; n : INT; {declaration}"));
    let said = typed(folder.path(), &["run", ".", "--record-also", "csv", "--record", "record"]);
    assert_eq!(said.code, Some(3), "{said:?}");
    let rows = std::fs::read_to_string(folder.path().join("record/run-1/trajectory.csv")).unwrap().lines().count();
    assert_eq!(rows, 1 + 1 + 29, "every step before the fault is recorded");
    said.out.lines().find(|line| line.contains("failed in state")).expect("a reason").trim().to_owned()
}

#[test]
fn each_kind_of_fault_names_its_place() {
    let faults = [
        broken_by("", "n := n / (n - 30);"),
        broken_by("x : LREAL;", "x := 1.0 / x;"),
        broken_by("a10 : ARRAY [1..10] OF INT;", "a10[n] := 1;"),
        broken_by("", "WHILE n > 0 DO n := n; END_WHILE;"),
        broken_by("i, by0 : INT;", "FOR i := 1 TO 3 BY by0 DO n := n; END_FOR;"),
        broken_by("", "n := MUX(n, 1, 2);"),
        broken_by("few : INT (0..5);", "few := n;"),
        broken_by("far : REF_TO INT;", "far^ := n;"),
        broken_by("wild : POINTER TO INT;", "wild := 16#7FFFFFFF; wild^ := n;"),
        broken_by("letters : STRING[4];", "letters[n] := 'x';"),
        broken_by("deep : Doer;", "deep.next := deep; n := deep.Act(n * 10);"),
        broken_by("loud : Loud;", "loud.next := loud; n := loud.Act(n);"),
    ];
    insta::assert_snapshot!(faults.join("\n"));
}
