//! `{external}`: what is declared here and done elsewhere; names of libraries; what stands beside them in projects.

use onescan_iec::syntax::printer::print_unit;
use onescan_iec::syntax::{FileId, parse};

use crate::rig::{Rig, findings};

const STUBS: &str = "
{external} FUNCTION Level : INT VAR_INPUT n : INT; END_VAR VAR_OUTPUT o : INT := 3; END_VAR Level := n; END_FUNCTION
{attribute 'hide'} {external}
// a remark
FUNCTION_BLOCK Lamp
VAR_INPUT on : BOOL; END_VAR VAR_OUTPUT lit : BOOL := TRUE; count : INT; END_VAR
  count := count + 1;
METHOD Blink : INT VAR_INPUT any_value : ANY; END_VAR Blink := 5; END_METHOD
PROPERTY Hours : INT GET Hours := 7; END_GET SET END_SET END_PROPERTY
END_FUNCTION_BLOCK
{external} INTERFACE I_Lamp METHOD Blink : INT END_METHOD END_INTERFACE
{external} TYPE Kind : (Small, Large); END_TYPE
{external} NAMESPACE Lib END_NAMESPACE
";

#[test]
fn a_stub_takes_what_it_is_given_and_does_nothing() {
    let mut rig = Rig::new(&format!(
        "{STUBS}PROGRAM P
VAR lamp : Lamp; a, b, c, d : INT; k : Lib.Kind; END_VAR
  lamp(on := TRUE); lamp();
  a := Lib.Level(n := 8, o => b); c := lamp.Blink(a); d := lamp.Hours; lamp.Hours := 9; k := Lib.Large;
END_PROGRAM"
    ));
    rig.scan().expect("no fault");
    assert_eq!(["a", "b", "c", "d", "lamp.count"].map(|name| rig.int(&format!("P.{name}"))), [0, 3, 0, 0, 0]);
    assert!(rig.bool("P.lamp.on") && rig.bool("P.lamp.lit"));
}

#[test]
fn the_calls_of_a_stub_are_reported_once() {
    insta::assert_snapshot!(findings(&format!(
        "{STUBS}FUNCTION_BLOCK Bright EXTENDS Lamp METHOD Twice : INT Twice := SUPER^.Blink(THIS^.count); END_METHOD END_FUNCTION_BLOCK
PROGRAM P
VAR lamp : Lamp; bright : Bright; unused : Lamp; x : INT; k : Kind; END_VAR
  lamp(on := TRUE); lamp(on := FALSE); x := bright.Twice(); x := lamp.Hours + Level(1);
  k := Kind#Large;
END_PROGRAM"
    )));
}

#[test]
fn the_pragma_is_printed() {
    let printed = print_unit(&parse(FileId(0), STUBS).unit);
    assert_eq!(printed.matches("{external}").count(), 5, "{printed}");
    let again = parse(FileId(0), &printed);
    assert!(again.diagnostics.is_empty(), "{:?}", again.diagnostics);
    assert_eq!(print_unit(&again.unit), printed);
}

#[test]
fn variables_of_lists_have_members() {
    let mut rig = Rig::new(
        "NAMESPACE List VAR_GLOBAL s : S; f : F; END_VAR END_NAMESPACE
TYPE S : STRUCT a : INT; t : T; END_STRUCT END_TYPE
TYPE T : STRUCT b : ARRAY [0..1] OF INT; END_STRUCT END_TYPE
FUNCTION_BLOCK F VAR_OUTPUT q : INT; END_VAR q := 4; METHOD M : INT M := 2; END_METHOD END_FUNCTION_BLOCK
PROGRAM P VAR x, y, z, n : INT; END_VAR
  List.s.a := 3; List.s.t.b[1] := 5; List.f();
  x := List.s.a + List.s.t.b[1]; y := List.f.q; z := List.f.M(); n := Tc2_Standard.LEN('abc');
END_PROGRAM",
    );
    rig.scan().expect("no fault");
    assert_eq!(["x", "y", "z", "n"].map(|name| rig.int(&format!("P.{name}"))), [8, 4, 2, 3]);
}

#[test]
fn a_method_calls_what_its_instance_refers_to() {
    let mut rig = Rig::new(
        "FUNCTION_BLOCK Inner VAR_OUTPUT q : INT; END_VAR q := q + 1; END_FUNCTION_BLOCK
FUNCTION_BLOCK Outer VAR_INPUT inner : REFERENCE TO Inner; END_VAR
METHOD Run inner(); END_METHOD
END_FUNCTION_BLOCK
PROGRAM P VAR i : Inner; o : Outer; END_VAR o.inner REF= i; o.Run(); o.Run(); END_PROGRAM",
    );
    rig.scan().expect("no fault");
    assert_eq!(rig.int("P.i.q"), 2);
}

#[test]
fn outputs_do_not_count_as_inputs() {
    let mut rig = Rig::new(
        "FUNCTION F : INT VAR_INPUT a, b : INT; END_VAR VAR_OUTPUT o : INT; END_VAR o := a; F := b; END_FUNCTION
PROGRAM P VAR x, y : INT; END_VAR x := F(o => y, 3, 5); x := F(a := 3, 5, o => y); END_PROGRAM",
    );
    rig.scan().expect("no fault");
    assert_eq!((rig.int("P.x"), rig.int("P.y")), (5, 3));
}
