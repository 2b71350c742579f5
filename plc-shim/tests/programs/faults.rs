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
    ), @"endless or very long loop at test.st:4:3 in P, t_v = 0.030 s");
    insta::assert_snapshot!(fault(
        "PROGRAM P\nVAR i : INT; END_VAR\n  REPEAT\n  UNTIL i = 1 END_REPEAT;\nEND_PROGRAM"
    ), @"endless or very long loop at test.st:3:3 in P, t_v = 0.010 s");
    insta::assert_snapshot!(fault(
        "PROGRAM P\nVAR i, n : INT; END_VAR\n  FOR i := 1 TO 5\n    BY n DO ; END_FOR;\nEND_PROGRAM"
    ), @"FOR with a step of 0 at test.st:4:8 in P, t_v = 0.010 s");
    insta::assert_snapshot!(fault(
        "PROGRAM P\nVAR n : INT := 3; END_VAR\n  n := MUX(n, 1, 2);\nEND_PROGRAM"
    ), @"selector out of range at test.st:3:8 in P, t_v = 0.010 s");
}

#[test]
fn a_fault_reports_who_called() {
    insta::assert_snapshot!(fault(
        "FUNCTION Ratio : INT VAR_INPUT a, b : INT; END_VAR\n  Ratio := a / b;\nEND_FUNCTION
FUNCTION_BLOCK Axis VAR r : INT; END_VAR\n  r := Ratio(1, r);\nEND_FUNCTION_BLOCK
PROGRAM P VAR axis : Axis; END_VAR\n  axis();\nEND_PROGRAM"
    ), @"division by zero at test.st:2:12 in Ratio, called by P.axis (Axis) at test.st:5, called by P at test.st:8, t_v = 0.010 s");
}

#[test]
fn a_fault_reports_the_instances_on_the_way() {
    let text = "VAR_GLOBAL shared : Inner; END_VAR
FUNCTION Ratio : INT VAR_INPUT a, b : INT; END_VAR
  Ratio := a / b;
END_FUNCTION
FUNCTION_BLOCK Inner VAR_INPUT go : BOOL; END_VAR VAR r : INT; END_VAR
  IF go THEN
    r := Ratio(a := 1,
               b := r);
  END_IF;
END_FUNCTION_BLOCK
FUNCTION_BLOCK Outer VAR inner : ARRAY [1..3] OF Inner; i : INT := 2; END_VAR VAR_INPUT n : INT; END_VAR VAR_IN_OUT ref : Inner; END_VAR
  inner[ i + 1 ](go := n = 1);
  shared(go := n = 2);
  ref(go := n = 3);
END_FUNCTION_BLOCK
PROGRAM Prg VAR_INPUT n : INT; END_VAR VAR fb : Outer; other : Inner; END_VAR

  fb(n := n, ref := other);
END_PROGRAM
CONFIGURATION c
  RESOURCE R ON Soft TASK t (INTERVAL := T#10ms); PROGRAM P1 WITH t : Prg (n := NUMBER); END_RESOURCE
END_CONFIGURATION";
    let of = |number: &str| {
        let application = crate::rig::application(&text.replace("NUMBER", number));
        let plan = application.configured_tasks().expect("a configuration");
        let fault = Rig::with_plan(&application, &plan).scan().expect_err("a division by zero");
        fault.to_string()
    };
    insta::assert_snapshot!(of("1"), @"division by zero at test.st:3:12 in Ratio, called by P1.fb.inner[i+1] (Inner) at test.st:7, called by P1.fb (Outer) at test.st:12, called by P1 (Prg) at test.st:18, t_v = 0.010 s");
    insta::assert_snapshot!(of("2"), @"division by zero at test.st:3:12 in Ratio, called by shared (Inner) at test.st:7, called by P1.fb (Outer) at test.st:13, called by P1 (Prg) at test.st:18, t_v = 0.010 s");
    insta::assert_snapshot!(of("3"), @"division by zero at test.st:3:12 in Ratio, called by P1.fb.ref (Inner) at test.st:7, called by P1.fb (Outer) at test.st:14, called by P1 (Prg) at test.st:18, t_v = 0.010 s");
}

#[test]
fn a_fault_in_a_connection_names_the_instance() {
    let application = crate::rig::application(
        "VAR_GLOBAL x : INT := 11; END_VAR
PROGRAM Prg VAR_INPUT n : INT (0..10); END_VAR ; END_PROGRAM
CONFIGURATION c TASK t (INTERVAL := T#10ms);
  PROGRAM P1 WITH t : Prg (n := x);
END_CONFIGURATION",
    );
    let plan = application.configured_tasks().expect("a configuration");
    let fault = Rig::with_plan(&application, &plan).scan().expect_err("out of the subrange");
    insta::assert_snapshot!(fault.to_string(), @"value out of subrange at test.st:4:33 in P1, t_v = 0.010 s");
}

#[test]
fn iec2_annex_e_each_kind_of_fault_is_tested() {
    use onescan_iec_run::FaultKind;
    let of = |declarations: &str, statements: &str| {
        let mut rig = Rig::new(&format!("PROGRAM P VAR {declarations} END_VAR {statements} END_PROGRAM"));
        rig.scan().expect_err(statements).kind
    };
    let mut found = vec![
        of("n : INT;", "n := 1 / n;"),
        of("n : INT; a : ARRAY [1..2] OF INT;", "n := a[n];"),
        of("n : INT := 3;", "n := MUX(n, 1, 2);"),
        of("n, i : INT;", "FOR i := 1 TO 2 BY n DO ; END_FOR;"),
        of("n : INT;", "WHILE n = 0 DO ; END_WHILE;"),
        of("n : INT := 9; r : INT (0..5);", "r := n;"),
        of("r : REF_TO INT;", "r^ := 1;"),
        of("p : POINTER TO INT;", "p := 16#7FFFFFFF; p^ := 1;"),
    ];
    // Only methods can be nested too deep or come back, which has tests of its own; an internal error has
    // no program.
    found.extend([FaultKind::CallTooDeep, FaultKind::Reentered, FaultKind::Internal]);
    let missing = |kind: &&FaultKind| !found.contains(*kind);
    assert_eq!(FaultKind::ALL.iter().filter(missing).collect::<Vec<_>>(), Vec::<&FaultKind>::new());
}
