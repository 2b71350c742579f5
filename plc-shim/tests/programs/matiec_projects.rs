//! What projects of Beremiz and of `OpenPLC`'s editor hold, in text and in PLCopen XML.

use onescan_iec::Dialect::{Iec3, Matiec};
use onescan_iec::input::kind::SourceKind;
use onescan_iec::{Code, Dialect, Input, Severity, TimeSpan, inspect};
use onescan_iec_run::Application;

use crate::plcopen::{pou, program, project};
use crate::rig::{Rig, findings_in};

fn after_a_scan(text: &str) -> Rig {
    let mut rig = Rig::in_dialect(Matiec, text);
    rig.scan().expect("no fault");
    rig
}

/// The project as the editor writes it: it names the schema once more.
fn of_beremiz(text: &str) -> String {
    text.replace("<project ", "<project xmlns:ns1=\"http://www.plcopen.org/xml/tc6.xsd\" ")
}

fn input(text: &str) -> Input {
    Input::from_text("plc.xml", SourceKind::PlcOpen, text)
}

fn drawn(text: &str) -> Rig {
    let application = match Application::from_inputs([input(text)]) {
        Ok(application) => application,
        Err(found) => panic!("{found}"),
    };
    Rig::with_plan(&application, &application.single_task(TimeSpan::millis::<10>()))
}

fn codes(text: &str) -> Vec<(Severity, Code)> {
    inspect([input(text)], None).iter().map(|found| (found.severity, found.code)).collect()
}

#[test]
fn a_variable_of_an_instance_is_written_and_read_from_outside() {
    let text = "FUNCTION_BLOCK F VAR a, b : INT; END_VAR b := a + 1; END_FUNCTION_BLOCK
        PROGRAM P VAR f1 : F; r : INT; END_VAR f1.a := 4; f1(); r := f1.b; END_PROGRAM";
    assert_eq!(after_a_scan(text).int("P.r"), 5);
}

#[test]
fn a_var_in_out_is_given_by_an_assignment() {
    let text = "FUNCTION_BLOCK F VAR_IN_OUT list : ARRAY [1..3] OF INT; n : INT; END_VAR
          list[1] := list[3]; n := n + 1; END_FUNCTION_BLOCK
        PROGRAM P VAR f1 : F; own, back : ARRAY [1..3] OF INT; turns, r1, r2 : INT; END_VAR
          own[3] := 7; f1.list := own; f1.n := turns; f1(); back := f1.list; turns := f1.n;
          r1 := back[1]; r2 := own[1]; END_PROGRAM";
    let mut rig = after_a_scan(text);
    rig.scan().expect("no fault");
    // The block has a variable of its own.
    assert_eq!(["r1", "r2", "turns"].map(|name| rig.int(&format!("P.{name}"))), [7, 0, 2]);
    let never = text.replace("f1.list := own;", "");
    let mut rig = Rig::in_dialect(Matiec, &never);
    assert!(rig.scan().is_err(), "nobody gave it anything");
}

#[test]
fn a_program_has_a_var_in_out_of_its_own() {
    let text = "PROGRAM P VAR_IN_OUT n : INT := 4; END_VAR n := n + 1; END_PROGRAM";
    assert_eq!(after_a_scan(text).int("P.n"), 5);
}

#[test]
fn c_code_is_a_stub() {
    let text = "FUNCTION_BLOCK F VAR now, last : TIME; END_VAR {__SET_VAR(data__->,now,,__CURRENT_TIME)} last := now; END_FUNCTION_BLOCK
        PROGRAM P VAR f1 : F; a : INT; END_VAR f1();
          {if (Ready()) __SET_VAR(data__->,a, 2)} {{ SetFbVar(a, 1); }} a := a + 1; END_PROGRAM";
    let findings = findings_in(Matiec, text);
    let reported: Vec<_> = findings.iter().map(|found| (found.severity, found.code)).collect();
    assert_eq!(reported, [(Severity::Warning, Code::StubUsed); 3], "{findings}");
    assert_eq!(after_a_scan(text).int("P.a"), 1);
    assert!(findings_in(Iec3, text).iter().any(|found| found.code == Code::VendorRuntime));
}

#[test]
fn a_whole_number_has_the_type_that_a_conversion_wants() {
    let text = "PROGRAM P VAR x : REAL := 200.7; b : BYTE; u : UDINT; END_VAR
        b := INT_TO_BYTE(TRUNC(x)); u := UINT_TO_UDINT(TRUNC(x)); END_PROGRAM";
    let rig = after_a_scan(text);
    assert_eq!((rig.int("P.b"), rig.int("P.u")), (200, 200));
}

#[test]
fn a_project_may_declare_blocks_of_the_library() {
    let text = "FUNCTION_BLOCK LOGGER VAR_INPUT TRIG : BOOL; END_VAR VAR_OUTPUT n : INT; END_VAR n := 3; END_FUNCTION_BLOCK
        FUNCTION_BLOCK SR VAR_INPUT S1, R : BOOL; END_VAR VAR_OUTPUT Q1 : INT; END_VAR Q1 := 4; END_FUNCTION_BLOCK
        PROGRAM P VAR l : LOGGER; s : SR; r : INT; END_VAR l(TRIG := TRUE); s(S1 := TRUE); r := l.n + s.Q1; END_PROGRAM";
    assert_eq!(after_a_scan(text).int("P.r"), 7);
}

#[test]
fn a_chart_needs_none_of_the_blocks_that_a_project_has_of_its_own() {
    let rig = after_a_scan(
        "FUNCTION_BLOCK RS VAR_INPUT other : INT; END_VAR END_FUNCTION_BLOCK
         FUNCTION_BLOCK R_TRIG VAR_INPUT other : INT; END_VAR END_FUNCTION_BLOCK
         PROGRAM P VAR n, m : INT; END_VAR
         INITIAL_STEP First: Count(N); Once(P1); END_STEP
         ACTION Count: n := n + 1; END_ACTION
         ACTION Once: m := m + 1; END_ACTION
         END_PROGRAM",
    );
    // MatIEC gives an initial step no pulse at the start.
    assert_eq!((rig.int("P.n"), rig.int("P.m")), (1, 0));
}

#[test]
fn a_structure_at_a_bit_lies_elsewhere() {
    let text = "TYPE S : STRUCT a, b : INT; END_STRUCT; END_TYPE
        PROGRAM P VAR s AT %I3.0 : S; r : INT; END_VAR s.a := 2; r := s.a; END_PROGRAM";
    let findings = findings_in(Matiec, text);
    assert!(findings.iter().any(|found| found.code == Code::UnsuitableAddress), "{findings}");
    assert_eq!(after_a_scan(text).int("P.r"), 2);
    for dialect in Dialect::ALL.into_iter().filter(|dialect| *dialect != Matiec) {
        assert!(findings_in(dialect, text).iter().any(|found| found.severity == Severity::Error), "{dialect}");
    }
}

/// `a -> b`, and an output that nothing leads to.
const COPY: &str = "<inVariable localId=\"1\"><connectionPointOut/><expression>a</expression></inVariable>
    <outVariable localId=\"2\"><connectionPointIn><connection refLocalId=\"1\"/></connectionPointIn><expression>b</expression></outVariable>
    <outVariable localId=\"3\"><connectionPointIn/><expression>c</expression></outVariable>";

#[test]
fn an_output_that_nothing_leads_to_is_left_out() {
    let text = program("local a : INT = 5, b : INT, c : INT = 9", "FBD", COPY);
    let reported = codes(&of_beremiz(&text));
    assert!(reported.contains(&(Severity::Warning, Code::Unconnected)), "{reported:?}");
    let mut rig = drawn(&of_beremiz(&text));
    rig.scan().expect("no fault");
    assert_eq!((rig.int("P.b"), rig.int("P.c")), (5, 9));
    assert!(codes(&text).contains(&(Severity::Error, Code::Unconnected)), "in a file of another tool");
}

#[test]
fn strings_stand_without_quotes() {
    let body = "<xhtml:p xmlns:xhtml=\"http://www.w3.org/1999/xhtml\">n := LEN(s); m := LEN(t); k := LEN(h);</xhtml:p>";
    let variables = "local n : INT, m : INT, k : INT, s : TEXT = abc d, h : HMI_STRING = 3.5";
    let text = program(variables, "ST", body).replace("<derived name=\"TEXT\"/>", "<string/>");
    let quoted = "<localVars><variable name=\"t\"><type><string/></type><initialValue>\
        <simpleValue value=\"&quot;12&quot;\"/></initialValue></variable></localVars></interface>";
    let text = of_beremiz(&text.replace("</interface>", quoted));
    let mut rig = drawn(&text);
    rig.scan().expect("no fault");
    // Double quotes are characters of the string, as in what the editor writes.
    assert_eq!(["n", "m", "k"].map(|name| rig.int(&format!("P.{name}"))), [5, 4, 3]);
}

/// A chart that goes on by a transition of its unit, twice.
fn chart(condition: &str) -> String {
    let step = |id: u32, name: &str, from: &str, initial: &str| {
        format!(
            "<step localId=\"{id}\" name=\"{name}\" {initial}><connectionPointIn>{from}</connectionPointIn><connectionPointOut formalParameter=\"\"/></step>"
        )
    };
    let transition = |id: u32, from: u32| {
        format!(
            "<transition localId=\"{id}\"><connectionPointIn><connection refLocalId=\"{from}\"/></connectionPointIn>\
             <connectionPointOut/><condition><reference name=\"GO\"/></condition></transition>"
        )
    };
    let link = |id: u32| format!("<connection refLocalId=\"{id}\"/>");
    let body = [
        step(1, "First", "", "initialStep=\"true\""),
        transition(2, 1),
        step(3, "Second", &link(2), ""),
        transition(4, 3),
        "<jumpStep localId=\"5\" targetName=\"First\"><connectionPointIn><connection refLocalId=\"4\"/></connectionPointIn></jumpStep>".to_owned(),
    ];
    let unit = pou("program", "P", "local on : BOOL = TRUE", "SFC", &body.concat());
    let transitions =
        format!("<transitions><transition name=\"GO\"><body><FBD>{condition}</FBD></body></transition></transitions>");
    project(&unit.replace("<body>", &format!("{transitions}<body>")))
}

#[test]
fn a_drawn_condition_serves_several_transitions() {
    let condition = "<inVariable localId=\"11\"><connectionPointOut/><expression>on</expression></inVariable>
        <outVariable localId=\"12\"><connectionPointIn><connection refLocalId=\"11\"/></connectionPointIn><expression>GO</expression></outVariable>";
    let text = of_beremiz(&chart(condition));
    let mut rig = drawn(&text);
    let mut seen = Vec::new();
    for _ in 0..4 {
        rig.scan().expect("no fault");
        seen.push((rig.bool("P.First.X"), rig.bool("P.Second.X")));
    }
    assert_eq!(seen, [(true, false), (false, true), (true, false), (false, true)]);
}

#[test]
fn a_file_is_of_beremiz_by_its_header_and_by_its_c_code() {
    let body = "<xhtml:p xmlns:xhtml=\"http://www.w3.org/1999/xhtml\">l(TRIG := TRUE);</xhtml:p>";
    let text = program("local l : LOGGER", "ST", body);
    let header = "<fileHeader companyName=\"\" productName=\"PLC\" contentDescription=\"made with Beremiz\"/><types>";
    let reported = codes(&text.replace("<types>", header));
    assert_eq!(reported, [(Severity::Warning, Code::StubUsed)]);
    let with_c = text.replace("l(TRIG := TRUE);", "{__SET_VAR(data__->,l.TRIG,,1)} l(TRIG := TRUE);");
    assert_eq!(codes(&with_c), [(Severity::Warning, Code::StubUsed); 2]);
    assert!(codes(&text).iter().any(|(severity, _)| *severity == Severity::Error), "another tool has no LOGGER");
}
