//! Constants set from outside, in every form of source.

use onescan_iec::input::kind::SourceKind;
use onescan_iec::{Input, TimeSpan, VirtualTime};
use onescan_iec_run::{Application, BuildError, Builder, SoftPlc};

const TEXT: &str = "
TYPE Colour : (Red, Green, Blue); END_TYPE
VAR_GLOBAL CONSTANT Rest : TIME := T#1s; SIZE : INT := 3; END_VAR
NAMESPACE Line VAR_GLOBAL CONSTANT speed : REAL := 1.5; END_VAR END_NAMESPACE
FUNCTION_BLOCK Axis
    VAR CONSTANT slow, fast : INT := 2; END_VAR VAR x : INT; END_VAR
    METHOD Home : INT VAR CONSTANT back : INT := 4; END_VAR Home := back; END_METHOD
    x := x + fast;
END_FUNCTION_BLOCK
PROGRAM Main
    VAR CONSTANT a, b : INT := 2; twice : INT := a * 2; colour : Colour := Green; name : STRING := 'no';
        table : ARRAY [1..3] OF INT := [1, 2, 3]; none : BOOL; END_VAR
    VAR v : INT; list : ARRAY [1..SIZE] OF INT; axis : Axis; shown : Colour; text : STRING; t : TIME; r : REAL; h : INT; END_VAR
    VAR_EXTERNAL CONSTANT Rest : TIME; END_VAR
    axis(); shown := colour; text := name; v := a + 10 * b + 100 * twice; t := Rest; r := Line.speed; h := axis.Home();
END_PROGRAM";

fn builder(text: &str) -> Builder {
    Application::builder().input(Input::from_text("main.st", SourceKind::Text, text))
}

/// The values at `paths` after a scan.
fn values(builder: Builder, paths: &[&str]) -> Vec<String> {
    let application = builder.build().unwrap_or_else(|error| panic!("{error}"));
    let plan = application.configured_tasks().unwrap_or_else(|| application.single_task(TimeSpan::millis::<1>()));
    let mut plc = SoftPlc::new(&application, &plan).expect("a plan");
    plc.scan(VirtualTime::from_nanos(1_000_000)).expect("no fault");
    paths.iter().map(|path| plc.read(path).unwrap_or_else(|error| panic!("{error}"))).collect()
}

#[test]
fn a_constant_takes_the_value_that_is_set() {
    let set =
        |path: &str, literal: &str, shown: &str| values(builder(TEXT).constant(path, literal), &[shown]).remove(0);
    assert_eq!(values(builder(TEXT), &["Main.v"]), ["422"]);
    assert_eq!(set("Main.a", "5", "Main.v"), "1025", "what is computed from it follows");
    assert_eq!(set("main.B", "INT#5", "Main.v"), "452", "one of two that are declared together");
    assert_eq!(set("Axis.fast", "7", "Main.axis.x"), "7");
    assert_eq!(set("Axis.Home.back", "9", "Main.h"), "9");
    assert_eq!(set("Rest", "T#20ms", "Main.t"), "T#20ms");
    assert_eq!(set("Line.speed", "2.5", "Main.r"), "2.5");
    assert_eq!(set("speed", "3", "Main.r"), "3.0");
    assert_eq!(set("Main.colour", "Blue", "Main.shown"), "Blue");
    assert_eq!(set("Main.name", "'yes'", "Main.text"), "'yes'");
    assert_eq!(set("Main.table", "[4, 5, 6]", "Main.table"), "[4, 5, 6]");
    assert_eq!(set("Main.none", "TRUE", "Main.none"), "TRUE");
    assert_eq!(set("size", "1 + 1", "Main.list"), "[0, 0]", "the bound of an array");
}

#[test]
fn what_cannot_be_set_is_said() {
    let refused =
        |path: &str, literal: &str| builder(TEXT).constant(path, literal).build().expect_err(path).to_string();
    let mut said = Vec::new();
    for (path, literal) in [
        ("Main.aa", "1"),
        ("Mian.twice", "1"),
        ("Rset", "T#1s"),
        ("a", "1"),
        ("Main.v", "1"),
        ("Main.a", "40000"),
        ("Main.a", "TRUE"),
        ("Main.a", "T#1s"),
        ("Main.a", "1; b : INT := 2"),
        ("Main.a", ""),
        ("Main.a", "v"),
        ("Main.colour", "Yellow"),
        ("Rest", "20"),
        ("Main.table", "[1, 2, 3, 4]"),
        ("SIZE", "0"),
    ] {
        said.push(format!("{path} := {literal}: {}", refused(path, literal)));
    }
    said.push(builder(TEXT).constant("Rest", "T#1s").constant("REST", "T#2s").build().expect_err("twice").to_string());
    insta::assert_snapshot!(said.join("\n"));
}

#[test]
fn constants_are_distinguished_from_variables() {
    let is_constant = ["Main.a", "axis.home.BACK", "rest", "Main.v", "Main.axis.x", "none", ""];
    assert_eq!(
        is_constant.map(|path| builder(TEXT).has_constant(path)),
        [true, true, true, false, false, false, false]
    );
}

/// A wrong value is not a finding of the sources, which may have findings of their own.
#[test]
fn who_is_to_blame_is_said() {
    let wrong = builder(TEXT).constant("Main.a", "TRUE").build();
    assert!(matches!(wrong, Err(BuildError::Constant(_))));
    let wrong = builder("PROGRAM Main VAR CONSTANT a : INT := 1; END_VAR b := a; END_PROGRAM").constant("Main.a", "2");
    assert!(matches!(wrong.build(), Err(BuildError::Sources(_))));
}

#[test]
fn a_program_and_its_instances_have_the_same_constants() {
    let text = "PROGRAM Main VAR CONSTANT k : INT := 1; END_VAR VAR x : INT; END_VAR x := k; END_PROGRAM
        CONFIGURATION Plant VAR_GLOBAL CONSTANT every : TIME := T#1ms; END_VAR
        RESOURCE Left ON PLC VAR_GLOBAL CONSTANT side : INT := 1; END_VAR
            TASK t (INTERVAL := every); PROGRAM one WITH t : Main; PROGRAM two WITH t : Main; END_RESOURCE
        END_CONFIGURATION";
    let paths = ["one.x", "two.x"];
    for path in ["Main.k", "one.k", "Left.two.k", "Plant.Left.two.k"] {
        assert_eq!(values(builder(text).constant(path, "6"), &paths), ["6", "6"], "{path}");
    }
    let application = builder(text).constant("every", "T#7ms").build().expect("a TIME");
    assert_eq!(application.configured_tasks().expect("it has one").tasks[0].interval, TimeSpan::from_millis(7));
    assert!(builder(text).constant("Left.side", "2").build().is_ok());
    let twice = builder(text).constant("one.k", "2").constant("two.k", "3").build().expect_err("one constant");
    assert_eq!(twice.to_string(), "the constant `Main.k` is set twice");
}

#[test]
fn constants_of_twincat_are_set() {
    let list = "<?xml version=\"1.0\"?><TcPlcObject><GVL Name=\"Limits\"><Declaration><![CDATA[VAR_GLOBAL CONSTANT
        lowest, highest : INT := 2;
        END_VAR]]></Declaration></GVL></TcPlcObject>";
    let main = "<?xml version=\"1.0\"?><TcPlcObject><POU Name=\"MAIN\"><Declaration><![CDATA[PROGRAM MAIN
        VAR x : INT; END_VAR VAR CONSTANT k : INT := 1; END_VAR]]></Declaration>
        <Implementation><ST><![CDATA[x := Limits.highest * 10 + k;]]></ST></Implementation></POU></TcPlcObject>";
    let files = || {
        let file = |name: &str, text: &str| Input::from_text(name, SourceKind::TwinCat, text);
        Application::builder().inputs([file("MAIN.TcPOU", main), file("Limits.TcGVL", list)])
    };
    assert_eq!(values(files(), &["MAIN.x"]), ["21"]);
    assert_eq!(values(files().constant("Limits.highest", "5").constant("MAIN.k", "3"), &["MAIN.x"]), ["53"]);
    assert_eq!(values(files().constant("highest", "7"), &["MAIN.x"]), ["71"]);
}

#[test]
fn constants_of_plcopen_xml_are_set() {
    let variable = |name: &str, ty: &str, value: &str| {
        format!(
            "<variable name=\"{name}\"><type><{ty}/></type><initialValue><simpleValue value=\"{value}\"/></initialValue></variable>"
        )
    };
    let xml = format!(
        "<?xml version=\"1.0\" encoding=\"utf-8\"?><project xmlns=\"http://www.plcopen.org/xml/tc6_0201\">
        <types><dataTypes/><pous><pou name=\"Main\" pouType=\"program\"><interface>
        <localVars constant=\"true\">{}{}</localVars><localVars>{}</localVars></interface>
        <body><ST><xhtml xmlns=\"http://www.w3.org/1999/xhtml\">x := k + n;</xhtml></ST></body></pou></pous></types>
        <instances><configurations/></instances></project>",
        variable("k", "INT", "1"),
        variable("n", "INT", "10"),
        variable("x", "INT", "0"),
    );
    let file = || Application::builder().input(Input::from_text("plc.xml", SourceKind::PlcOpen, xml.as_str()));
    assert_eq!(values(file(), &["Main.x"]), ["11"]);
    assert_eq!(values(file().constant("Main.k", "5"), &["Main.x"]), ["15"]);
    let error = file().constant("Main.k", "'text'").build().expect_err("an INT");
    assert!(error.to_string().starts_with("`'text'` is not a value of `Main.k`: "), "{error}");
}
