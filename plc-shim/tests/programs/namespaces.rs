//! Namespaces (3rd ed. 6.9), the names of vendors' libraries and lists of global variables.

use onescan_iec::input::kind::SourceKind;
use onescan_iec::{Dialect, Input, TimeSpan};
use onescan_iec_run::Application;

use crate::rig::{Rig, findings};

const PLANT: &str = "NAMESPACE Plant
  NAMESPACE Tools
    TYPE Level : (Low, High); END_TYPE
    VAR_GLOBAL gain : INT := 3; END_VAR
    VAR_GLOBAL CONSTANT step : INT := 4; END_VAR
    FUNCTION Scaled : INT VAR_INPUT x : INT; END_VAR Scaled := x * gain + offset; END_FUNCTION
    FUNCTION_BLOCK INTERNAL Hidden VAR_OUTPUT q : INT; END_VAR q := 5; END_FUNCTION_BLOCK
    FUNCTION_BLOCK Shown VAR_OUTPUT q : INT; END_VAR VAR h : Hidden; END_VAR h(q => q); END_FUNCTION_BLOCK
  END_NAMESPACE
  VAR_GLOBAL offset : INT := 100; END_VAR
  FUNCTION Both : INT Both := Tools.Scaled(1) + Plant.Tools.Scaled(2); END_FUNCTION
END_NAMESPACE
";

#[test]
fn iec3_6_9_names_are_found_from_where_they_stand() {
    let mut rig = Rig::new(&format!(
        "{PLANT}NAMESPACE Other.Place
USING Plant;
FUNCTION Used : INT Used := Both(); END_FUNCTION
END_NAMESPACE
PROGRAM P
USING Plant.Tools;
VAR a, b, c, d, e : INT; level : Level; else_where : Plant.Tools.Level := High; block : Plant.Tools.Shown; t : Tc2_Standard.TON; END_VAR
  a := Plant.Both();
  b := Scaled(1);
  Plant.Tools.gain := 2;
  c := Other.Place.Used();
  level := Plant.Tools.Level#High;
  block(q => d);
  e := Plant.offset + Plant.Tools.step;
  t(IN := level = else_where, PT := T#1s);
END_PROGRAM"
    ));
    rig.scan().expect("no fault");
    let values = ["a", "b", "c", "d", "e"].map(|name| rig.int(&format!("P.{name}")));
    assert_eq!(values, [209, 103, 206, 5, 104]);
    assert!(rig.bool("P.t.IN"));
    assert_eq!((rig.int("Plant.Tools.gain"), rig.int("offset")), (2, 100));
}

#[test]
fn iec3_6_9_what_is_not_seen_is_reported() {
    insta::assert_snapshot!(findings(&format!(
        "{PLANT}USING Plant.Tool;
FUNCTION Both : INT Both := 1; END_FUNCTION
PROGRAM P
VAR h : Plant.Tools.Hidden; l : Level; x : INT; END_VAR
  x := Both() + Scaled(1) + Plant.Tools.Scald(1) + Plant.Tools.gian;
END_PROGRAM"
    )), @r#"
    test.st:13:7: error[O0810]: there is no namespace `Plant.Tool` (did you mean `Plant.Tools`?)
    test.st:16:9: error[O0801]: `Hidden` is INTERNAL to its namespace
    test.st:16:33: error[N0103]: type `Level` is not declared (write `Plant.Tools.Level`)
    test.st:17:17: error[N0105]: there is no function or instance `Scaled` (write `Plant.Tools.Scaled`)
    test.st:17:29: error[N0105]: there is no function or instance `Plant.Tools.Scald`
    test.st:17:52: error[N0101]: `Plant.Tools.gian` is not declared
    "#);
}

#[test]
fn vendors_lists_of_globals_are_named() {
    let list = "<TcPlcObject><GVL Name=\"GVL\"><Declaration><![CDATA[{attribute 'qualified_only'}
VAR_GLOBAL x : INT := 5; END_VAR]]></Declaration></GVL><GVL Name=\"Open\"><Declaration>VAR_GLOBAL y : INT; END_VAR</Declaration></GVL></TcPlcObject>";
    let program = |text: &str| Input::from_text("P.st", SourceKind::Text, format!("PROGRAM P {text} END_PROGRAM"));
    let lists = || Input::from_text("GVL.TcGVL", SourceKind::TwinCat, list);
    let good = [lists(), program("GVL.x := GVL.x + 1; y := y + 1; Open.y := y + 1;")];
    let application = Application::from_inputs(good).expect("it compiles");
    let mut rig = Rig::with_plan(&application, &application.single_task(TimeSpan::millis::<10>()));
    rig.scan().expect("no fault");
    assert_eq!((rig.int("GVL.x"), rig.int("Open.y"), rig.int("y")), (6, 2, 2));
    let found = Application::from_inputs([lists(), program("x := 1;")]).expect_err("x is qualified only");
    insta::assert_snapshot!(found, @"P.st:1:11: error[N0101]: `x` is not declared (write `GVL.x`)");
}

#[test]
fn members_of_listed_globals_are_named_with_the_list() {
    let text = "TYPE S : STRUCT x : INT; END_STRUCT END_TYPE
        NAMESPACE OPEN Gvl VAR_GLOBAL s1 : S; END_VAR END_NAMESPACE
        PROGRAM P VAR a : INT; END_VAR Gvl.s1.x := 3; a := Gvl.s1.x + s1.x; END_PROGRAM";
    let mut rig = Rig::in_dialect(Dialect::TwinCat, text);
    rig.scan().expect("no fault");
    assert_eq!(rig.int("P.a"), 6);
}
