use crate::rig::findings;

#[test]
fn names() {
    insta::assert_snapshot!(findings(
        "PROGRAM P
VAR Sensor_1 : BOOL; t : TON; x : INT; y : ITN; x : DINT; s : STRING; END_VAR
VAR_EXTERNAL Presure : REAL; level : DINT; END_VAR
  Sensor_2 := TRUE;
  Sensr_1 := y;
  t(INN := TRUE);
  x := t.ET2;
  x := t.M;
  x := LIMITT(1, 2, 3);
  x.y := 1;
  P := 1;
  Presure := 1.0;
END_PROGRAM
VAR_GLOBAL Pressure : REAL; level : INT; END_VAR
FUNCTION_BLOCK TON END_FUNCTION_BLOCK
FUNCTION ABS : INT END_FUNCTION"
    ));
}

#[test]
fn types() {
    insta::assert_snapshot!(findings(
        "PROGRAM P
VAR i : INT; d : DINT; u : UINT; r : REAL; b : BOOL; w : WORD; t : TIME; a : ARRAY [1..3] OF INT; END_VAR
VAR CONSTANT k : INT := 40000; END_VAR
  i := d;
  i := 40000;
  i := 1.5;
  u := -1;
  b := i;
  i := b AND w;
  w := i AND 1;
  t := 5;
  t := t * t;
  r := d;
  i := u;
  b := NOT i;
  IF i THEN ; END_IF;
  a[4] := 1;
  a[1, 2] := 1;
  a[r] := 1;
  i[1] := 1;
  a := 1;
  i := 5 / 0;
  r := w + 1.0;
  FOR r := 1 TO 2 DO ; END_FOR;
  CASE r OF 1: ; END_CASE;
  CASE i OF 1..5: ; 3: ; 70000: ; END_CASE;
END_PROGRAM"
    ));
}

#[test]
fn calls_and_declarations() {
    insta::assert_snapshot!(findings(
        "FUNCTION F : INT VAR_INPUT a : INT; b : INT; END_VAR VAR_IN_OUT c : DINT; END_VAR
  a := 1;
END_FUNCTION
FUNCTION G : INT G := H(); END_FUNCTION
FUNCTION H : INT H := G(); END_FUNCTION
FUNCTION_BLOCK Outer VAR inner : Inner; END_VAR END_FUNCTION_BLOCK
FUNCTION_BLOCK Inner VAR outer : Outer; END_VAR END_FUNCTION_BLOCK
TYPE Loop : STRUCT next : ARRAY [0..1] OF Loop; END_STRUCT; END_TYPE
FUNCTION_BLOCK I VAR_IN_OUT x : DINT; END_VAR VAR_OUTPUT q : BOOL; END_VAR q := x > 1; END_FUNCTION_BLOCK
PROGRAM P
VAR i : INT; d : DINT; t : TON; blk : I; END_VAR
VAR CONSTANT k : INT := i; n : INT := 5; a : ARRAY [0..2] OF INT := [1, 2, 3, 4]; END_VAR
  i := F(1, 2);
  i := F(1, 2, i);
  i := F(1, 2, d, 4);
  i := F(a := 1, a := 2, c := d);
  F(1, 2, d);
  ABS(i);
  blk();
  blk(x := d, q => 5);
  t.Q := TRUE;
  n := 6;
  i := t(IN := TRUE);
  i := TON(IN := TRUE);
  i();
  EXIT;
  MAX(1);
  i := SHL(i, 1);
END_PROGRAM"
    ));
}

#[test]
fn syntax_errors_do_not_hide_one_another() {
    insta::assert_snapshot!(findings(
        "PROGRAM P
VAR a b : INT; c : INT := ; END_VAR
  a := (1 + ;
  IF c > 1 c := 2; END_IF
  c = 3;
  FOR c := 1 TO DO c := 2; END_FOR;
  CASE c OF 1 c := 2; END_CASE;
  WHILE c < 2 DO c := c + 1;
END_PROGRAM
FUNCTION_BLOCK
PROGRAM Q
VAR x : INT; END_VAR
  x := 16#XY + 7#1 + T#5;
  x := 'open;
  unknown := 1;
END_PROGRAM"
    ));
}

#[test]
fn a_clean_program_has_no_findings() {
    assert_eq!(findings("PROGRAM P VAR x : INT; END_VAR x := x + 1; END_PROGRAM"), "");
}

#[test]
fn every_finding_is_a_related_diagnostic_with_its_own_source() {
    use miette::Diagnostic;
    let text = "PROGRAM P VAR x, x : INT; END_VAR x := y; END_PROGRAM";
    let found = onescan_iec_run::Application::from_sources([("two.st", text)]).expect_err("wrong");
    let related: Vec<_> = found.related().expect("findings").collect();
    assert_eq!(related.len(), 3);
    assert_eq!(related[2].to_string(), "2 errors");
    let labels: Vec<_> = related[0].labels().expect("labels").collect();
    assert_eq!((labels[0].offset(), labels[1].offset()), (17, 14));
    assert_eq!(labels[1].label(), Some("first declared here"));
    let source = related[1].source_code().expect("a source");
    let span = related[1].labels().expect("labels").next().expect("a label");
    let contents = source.read_span(span.inner(), 0, 0).expect("inside of the text");
    assert_eq!(contents.name(), Some("two.st"));
    assert_eq!(contents.data(), b"y");
}

#[test]
fn errors_are_read_last_and_counted() {
    use miette::Diagnostic;
    let text = "PROGRAM P VAR x : INT; END_VAR x := y; ABS(x); END_PROGRAM";
    let found = onescan_iec_run::Application::from_sources([("both.st", text)]).expect_err("wrong");
    let read: Vec<_> = found.related().expect("findings").map(ToString::to_string).collect();
    assert_eq!(read, ["the result of this call is lost", "`y` is not declared", "1 error, 1 warning"]);
}
