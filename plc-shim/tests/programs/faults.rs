use crate::rig::Rig;

fn fault(text: &str) -> String {
    let mut rig = Rig::new(text);
    loop {
        if let Err(fault) = rig.scan() {
            assert_eq!(rig.plc.fault(), Some(&fault));
            assert_eq!(rig.scan(), Err(fault.clone()), "a stopped PLC stays stopped");
            return fault.to_string();
        }
        assert!(rig.now_ns < 1_000_000_000, "the program never fails");
    }
}

#[test]
fn faults_name_file_line_unit_and_time() {
    insta::assert_snapshot!(fault(
        "PROGRAM Shear\nVAR n : INT := 12; r : INT; END_VAR\n  n := n - 1;\n  r := 5 +\n    100 / n;\nEND_PROGRAM"
    ), @"division by zero at test.st:5:5 in Shear, t_v = 0.120 s");
    insta::assert_snapshot!(fault(
        "PROGRAM P\nVAR x, y : LREAL; END_VAR\n  x := 1.0 / y;\nEND_PROGRAM"
    ), @"division by zero at test.st:3:8 in P, t_v = 0.010 s");
    insta::assert_snapshot!(fault(
        "PROGRAM P\nVAR t : TIME := T#1s; n : UDINT; END_VAR\n  t := t / n;\nEND_PROGRAM"
    ), @"division by zero at test.st:3:8 in P, t_v = 0.010 s");
    insta::assert_snapshot!(fault(
        "PROGRAM P\nVAR i : INT; a : ARRAY [1..4] OF INT := [4(1)]; END_VAR\n  i := i + 1;\n  a[i] := i;\nEND_PROGRAM"
    ), @"array index out of range at test.st:4:3 in P, t_v = 0.050 s");
    insta::assert_snapshot!(fault(
        "PROGRAM P\nVAR i : LINT; a : ARRAY [-3..4, 0..1] OF INT; END_VAR\n  i := i - 1;\n  a[i, 0] := a[0, 1];\nEND_PROGRAM"
    ), @"array index out of range at test.st:4:3 in P, t_v = 0.040 s");
    insta::assert_snapshot!(fault(
        "PROGRAM P\nVAR i : INT; END_VAR\n  i := i + 1;\n  WHILE i > 2 DO\n    i := 5;\n  END_WHILE;\nEND_PROGRAM"
    ), @"endless loop at test.st:4:3 in P, t_v = 0.030 s");
    insta::assert_snapshot!(fault(
        "PROGRAM P\nVAR i : INT; END_VAR\n  REPEAT\n  UNTIL i = 1 END_REPEAT;\nEND_PROGRAM"
    ), @"endless loop at test.st:3:3 in P, t_v = 0.010 s");
    insta::assert_snapshot!(fault(
        "PROGRAM P\nVAR i, n : INT; END_VAR\n  FOR i := 1 TO 5\n    BY n DO ; END_FOR;\nEND_PROGRAM"
    ), @"FOR with a step of 0 at test.st:4:8 in P, t_v = 0.010 s");
    insta::assert_snapshot!(fault(
        "PROGRAM P\nVAR n : INT := 3; END_VAR\n  n := MUX(n, 1, 2);\nEND_PROGRAM"
    ), @"selector out of range at test.st:3:8 in P, t_v = 0.010 s");
}

#[test]
fn a_fault_tells_who_called() {
    insta::assert_snapshot!(fault(
        "FUNCTION Ratio : INT VAR_INPUT a, b : INT; END_VAR\n  Ratio := a / b;\nEND_FUNCTION
FUNCTION_BLOCK Axis VAR r : INT; END_VAR\n  r := Ratio(1, r);\nEND_FUNCTION_BLOCK
PROGRAM P VAR axis : Axis; END_VAR\n  axis();\nEND_PROGRAM"
    ), @"division by zero at test.st:2:12 in Ratio, called by P.axis (Axis) at test.st:5, called by P at test.st:8, t_v = 0.010 s");
}
