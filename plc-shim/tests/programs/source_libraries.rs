//! What libraries need that are read as source: their namespace, bodies by pointer, paths of instances, LTIME without
//! sign.

use onescan_iec::input::found::Found;
use onescan_iec::input::kind::SourceKind;
use onescan_iec::{Dialect, Input, TimeSpan};
use onescan_iec_run::Application;

use crate::rig::{Rig, findings_in};

fn object(kind: &str, name: &str, declaration: &str, body: &str) -> String {
    format!(
        "<TcPlcObject><{kind} Name=\"{name}\"><Declaration><![CDATA[{declaration}]]></Declaration>\
         <Implementation><ST><![CDATA[{body}]]></ST></Implementation></{kind}></TcPlcObject>"
    )
}

/// A library of a block, a function and two lists, and a program that uses it.
fn rig(program: &str) -> Rig {
    let library = |name: &str, text: String| {
        Input::of_library(Some("Gears"), name, Found::decode(SourceKind::TwinCat, text.as_bytes()))
    };
    let list = "{attribute 'qualified_only'} VAR_GLOBAL made : INT; size : ST_Size; END_VAR";
    let inputs = [
        library("list.TcGVL", object("GVL", "GVL_Gears", list, "")),
        library("open.TcGVL", object("GVL", "Limits", "VAR_GLOBAL CONSTANT Teeth : INT := 12; END_VAR", "")),
        library("size.TcDUT", object("DUT", "ST_Size", "TYPE ST_Size : STRUCT x, y : INT; END_STRUCT END_TYPE", "")),
        library("run.TcPOU", object("POU", "RUN", "FUNCTION RUN", "GVL_Gears.made := GVL_Gears.made + Teeth;")),
        library("mill.TcPOU", object("POU", "Mill", "PROGRAM Mill VAR turns : INT; END_VAR", "turns := turns + 1;")),
        library("size_of.TcPOU", object("POU", "Bytes", "FUNCTION Bytes : UDINT", "Bytes := SIZEOF(ST_Size);")),
        Input::from_text("main.st", SourceKind::Text, program).in_dialect(Dialect::TwinCat),
    ];
    let application = Application::from_inputs(inputs).unwrap_or_else(|found| panic!("{found}"));
    Rig::with_plan(&application, &application.single_task(TimeSpan::millis::<10>()))
}

#[test]
fn a_program_of_a_library_is_its_instance_with_the_namespace_and_without() {
    let mut rig = rig("PROGRAM P VAR a : INT; END_VAR Mill(); Gears.Mill(); a := Gears.Mill.turns; END_PROGRAM");
    rig.scan().expect("no fault");
    assert_eq!((rig.int("P.a"), rig.int("Mill.turns")), (2, 2));
}

#[test]
fn names_of_a_library_are_known_with_its_namespace_and_without() {
    let mut rig = rig("PROGRAM P VAR a, b : INT; c : UDINT; s : Gears.ST_Size; t : ST_Size; END_VAR
          RUN(); Gears.RUN(); a := GVL_Gears.made; b := Gears.GVL_Gears.made + Gears.Limits.Teeth; c := Bytes();
          s.x := 1; t.y := GVL_Gears.size.x; END_PROGRAM");
    rig.scan().expect("no fault");
    assert_eq!(["P.a", "P.b", "P.c"].map(|path| rig.int(path)), [24, 36, 4]);
    assert_eq!((rig.int("GVL_Gears.made"), rig.int("Gears.GVL_Gears.made")), (24, 24));
}

#[test]
fn what_a_project_declares_itself_goes_before_its_libraries() {
    let mut rig = rig("FUNCTION RUN : INT RUN := 5; END_FUNCTION
        PROGRAM P VAR a : INT; END_VAR a := RUN(); Gears.RUN(); END_PROGRAM");
    rig.scan().expect("no fault");
    assert_eq!((rig.int("P.a"), rig.int("GVL_Gears.made")), (5, 12));
}

#[test]
fn the_body_that_a_pointer_calls_is_that_of_the_instance() {
    let text = "FUNCTION_BLOCK Base VAR n : INT; END_VAR n := 1; END_FUNCTION_BLOCK
        FUNCTION_BLOCK Derived EXTENDS Base SUPER^(); n := n + 10; END_FUNCTION_BLOCK
        FUNCTION_BLOCK Holder VAR inner : Base; END_VAR END_FUNCTION_BLOCK
        PROGRAM P VAR d : Derived; e : Derived; h : Holder; p : POINTER TO Base; r : REFERENCE TO Base; END_VAR
        p := ADR(d); p^(); r REF= e; r(); p := ADR(h.inner); p^(); END_PROGRAM";
    for dialect in [Dialect::Codesys, Dialect::TwinCat] {
        let mut rig = Rig::in_dialect(dialect, text);
        rig.scan().expect("no fault");
        assert_eq!(["P.d.n", "P.e.n", "P.h.inner.n"].map(|path| rig.int(path)), [11, 11, 1], "{dialect}");
    }
}

const PATHS: &str = "{attribute 'reflection'}
FUNCTION_BLOCK Named
VAR
    {attribute 'instance-path'}
    {attribute 'noinit'}
    path : STRING(60);
    plain : STRING(60);
END_VAR
END_FUNCTION_BLOCK
FUNCTION_BLOCK Deep EXTENDS Named VAR inner : ARRAY [1..2, 0..1] OF Named; END_VAR END_FUNCTION_BLOCK
TYPE Pair : STRUCT left : Named; END_STRUCT END_TYPE
VAR_GLOBAL shared : Named; END_VAR
PROGRAM P VAR d : Deep; s : Pair; short : Named; END_VAR END_PROGRAM";

#[test]
fn an_instance_knows_its_path() {
    let rig = Rig::in_dialect(Dialect::TwinCat, PATHS);
    let text = |path: &str| rig.text(path);
    assert_eq!(text("P.d.path"), "onescan.P.d");
    assert_eq!(text("P.d.inner[2,1].path"), "onescan.P.d.inner[2,1]");
    assert_eq!(text("P.s.left.path"), "onescan.P.s.left");
    assert_eq!((text("shared.path"), text("shared.plain")), ("onescan.shared".to_owned(), String::new()));
    let rig = Rig::in_dialect(Dialect::Codesys, PATHS);
    assert_eq!(rig.text("P.d.path"), "Device.Application.P.d");
    let rig = Rig::in_dialect(Dialect::TwinCat, &PATHS.replace("STRING(60)", "STRING(9)"));
    assert_eq!(rig.text("P.d.path"), "onescan.P", "what does not fit is cut off");
}

#[test]
fn a_long_time_of_vendors_has_no_sign() {
    let text = "PROGRAM P VAR a : LTIME := LTIME#213503d23h34m33s709ms551us615ns; b : LTIME := LT#1d; n : INT := 2;
          s, t : STRING; above, below : BOOL; half, sum : LTIME; most : ULINT; END_VAR
          s := LTIME_TO_STRING(a); t := LTIME_TO_STRING(b / n); above := a > b; below := b < LTIME#200000d;
          half := a / n; sum := a + LT#2ns; most := LTIME_TO_ULINT(a); END_PROGRAM";
    for dialect in [Dialect::Codesys, Dialect::TwinCat] {
        let mut rig = Rig::in_dialect(dialect, text);
        rig.scan().expect("no fault");
        assert_eq!(rig.text("P.s"), "LTIME#213503d23h34m33s709ms551us615ns", "{dialect}");
        assert_eq!(rig.text("P.t"), "LTIME#12h", "{dialect}");
        assert!(rig.bool("P.above") && rig.bool("P.below"), "{dialect}");
        assert_eq!((rig.int("P.half"), rig.int("P.sum")), (i64::MAX, 1), "{dialect}");
        assert_eq!(rig.int("P.most"), -1, "{dialect}: all bits");
    }
    let found =
        findings_in(Dialect::Iec3, "PROGRAM P VAR a : LTIME := LTIME#200000d; END_VAR a := a; END_PROGRAM").to_string();
    assert!(found.contains("S0103") && found.contains("duration is too long"), "{found}");
}

#[test]
fn values_that_are_known_by_their_type_only_give_way() {
    let text = "{attribute 'qualified_only'} TYPE Own : (TYPE_WORD := 22, Red := 5); END_TYPE
        TYPE Other : (Red := 7); END_TYPE
        PROGRAM P VAR a, b : UDINT; c, d, e : INT; END_VAR
        a := IBaseLibrary.TYPE_WORD; b := IBaseLibrary.TypeClass.TYPE_WORD; c := Own.TYPE_WORD; d := Red; e := Own.Red;
        END_PROGRAM";
    let mut rig = Rig::in_dialect(Dialect::TwinCat, text);
    rig.scan().expect("no fault");
    assert_eq!(["P.a", "P.b", "P.c", "P.d", "P.e"].map(|path| rig.int(path)), [3, 3, 22, 7, 5]);
}
