//! A PLC program that fails ends the run with file, line and virtual time, and exit code 3.

use crate::typed::{copied_shear, edit, typed};

/// Breaks the alignment check at its end, at the 30th scan, and gives what is said of it.
fn broken_by(declaration: &str, statement: &str) -> String {
    let folder = copied_shear();
    let at_scan_30 = format!("n := n + 1; IF n = 30 THEN {statement} END_IF;\nEND_PROGRAM");
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
    ];
    insta::assert_snapshot!(faults.join("\n"));
}
