//! What projects of other tools hold beside plain code: calls with EN alone, what CODESYS and `MatIEC` alone take.

use onescan_iec::Dialect::{self, Codesys, Iec3, Matiec, TwinCat};
use onescan_iec::input::kind::SourceKind;
use onescan_iec::{Input, Severity, TimeSpan};
use onescan_iec_run::Application;

use crate::rig::{Rig, findings_in};

const VENDORS: [Dialect; 2] = [Codesys, TwinCat];

fn values<const N: usize>(dialect: Dialect, text: &str, scans: usize, names: [&str; N]) -> [i64; N] {
    let mut rig = Rig::in_dialect(dialect, text);
    for _ in 0..scans {
        rig.scan().expect("no fault");
    }
    names.map(|name| rig.int(&format!("P.{name}")))
}

#[test]
fn a_call_with_en_alone_leaves_all_inputs_out() {
    let text =
        "FUNCTION F : INT VAR_INPUT a : INT := 5; b : BOOL; END_VAR F := a; IF b THEN F := 0; END_IF; END_FUNCTION
        PROGRAM P VAR x, y, z : INT := 9; off : BOOL; END_VAR
          x := F(EN := TRUE); y := F(EN := off); z := F(EN := TRUE, a := 7); END_PROGRAM";
    for dialect in Dialect::ALL {
        assert_eq!(values(dialect, text, 1, ["x", "y", "z"]), [5, 0, 7], "{dialect}");
        let bare = text.replace("F(EN := TRUE)", "F()");
        let findings = findings_in(dialect, &bare);
        // SIMATIC AX takes it; what has no value of its own is said.
        let wanted = if dialect == Iec3 { Severity::Warning } else { Severity::Error };
        assert!(findings.iter().any(|found| found.severity == wanted), "{dialect}");
        assert_eq!(findings.has_errors(), dialect != Iec3, "{dialect}");
    }
}

#[test]
fn a_call_of_a_method_with_en_alone_leaves_all_inputs_out() {
    let text = "FUNCTION_BLOCK B METHOD PUBLIC m : INT VAR_INPUT a : INT := 5; END_VAR m := a + 1; END_METHOD END_FUNCTION_BLOCK
        PROGRAM P VAR o : B; x : INT; END_VAR x := o.m(EN := TRUE); END_PROGRAM";
    assert_eq!(values(Iec3, text, 1, ["x"]), [6]);
}

#[test]
fn matiec_reads_what_an_instance_was_given() {
    let text =
        "FUNCTION_BLOCK Ramp VAR_IN_OUT n : INT; END_VAR VAR_INPUT k : INT; END_VAR n := n + k; END_FUNCTION_BLOCK
        PROGRAM P VAR r, idle : Ramp; count, a, b, turns : INT; END_VAR
          b := 7 + idle.n; IF turns > 0 THEN r(n := count, k := 3); END_IF; a := r.n; turns := turns + 1; END_PROGRAM";
    for (scans, expected) in [(1, [0, 7, 0]), (2, [3, 7, 3]), (3, [6, 7, 6])] {
        assert_eq!(values(Matiec, text, scans, ["a", "b", "count"]), expected);
    }
}

#[test]
fn a_return_may_have_a_condition() {
    let text = "FUNCTION_BLOCK F VAR_INPUT done : BOOL; END_VAR VAR_OUTPUT n : INT; END_VAR
          n := n + 1; RETURN (done); n := n + 10; RETURN (NOT done); n := n + 100; END_FUNCTION_BLOCK
        PROGRAM P VAR f1, f2 : F; x, y : INT; END_VAR f1(done := TRUE, n => x); f2(done := FALSE, n => y); END_PROGRAM";
    for dialect in VENDORS {
        assert_eq!(values(dialect, text, 2, ["x", "y"]), [2, 22], "{dialect}");
        let number = text.replace("RETURN (done)", "RETURN (n)");
        assert!(findings_in(dialect, &number).iter().any(|found| found.severity == Severity::Error));
    }
}

#[test]
fn super_reaches_the_variables_of_the_base() {
    let text =
        "FUNCTION_BLOCK A VAR_INPUT i : INT; END_VAR VAR_OUTPUT q : INT; END_VAR VAR x : INT := 3; t : CTU; END_VAR
          METHOD Twice : INT Twice := 2 * x; END_METHOD END_FUNCTION_BLOCK
        FUNCTION_BLOCK B EXTENDS A VAR y : INT; END_VAR
          METHOD M : INT SUPER^.x := SUPER^.x + 1; M := SUPER^.x + SUPER^.Twice(); END_METHOD
          ACTION Act: SUPER^.q := SUPER^.i + 1; SUPER^.t(CU := TRUE, PV := 2); END_ACTION
          y := SUPER^.t.CV; END_FUNCTION_BLOCK
        PROGRAM P VAR b1 : B; m, q, x, y : INT; END_VAR
          b1.i := 40; m := b1.M(); b1.Act(); b1(); q := b1.q; x := b1.x; y := b1.y; END_PROGRAM";
    for dialect in VENDORS {
        assert_eq!(values(dialect, text, 2, ["m", "q", "x", "y"]), [15, 41, 5, 1], "{dialect}");
    }
    let nothing = "FUNCTION_BLOCK A METHOD M : INT M := SUPER^.x; END_METHOD END_FUNCTION_BLOCK
        PROGRAM P VAR a1 : A; END_VAR a1.M(); END_PROGRAM";
    let findings = findings_in(TwinCat, nothing);
    assert!(findings.iter().any(|found| found.code.text() == "O0808"), "{findings}");
}

#[test]
fn a_program_that_is_called_takes_variables() {
    let text = "PROGRAM Q VAR_IN_OUT n : INT; END_VAR n := n + 2; END_PROGRAM
        PROGRAM P VAR a : INT; END_VAR Q(n := a); END_PROGRAM";
    for dialect in VENDORS {
        let mut rig = Rig::in_dialect(dialect, text);
        rig.scan().expect("no fault");
        rig.scan().expect("no fault");
        assert_eq!(rig.int("P.a"), 4, "{dialect}");
        let findings = findings_in(dialect, "PROGRAM Q VAR_IN_OUT n : INT; END_VAR n := n + 2; END_PROGRAM");
        assert!(findings.iter().any(|found| found.code.text() == "D0407"), "{findings}");
    }
}

#[test]
fn a_semicolon_alone_declares_nothing() {
    let text = "PROGRAM P VAR ; a : INT; ;END_VAR VAR_TEMP ; END_VAR a := a + 1; END_PROGRAM";
    assert_eq!(values(TwinCat, text, 2, ["a"]), [2]);
}

#[test]
fn c_code_that_only_reports_is_passed_over_with_a_warning() {
    let text = |code: &str| {
        format!(
            "PROGRAM P VAR a : INT; END_VAR IF a = 0 THEN {{{{ if (x) {{ {code}(GetFbVar(A)); }} }}}} END_IF; a := a + 1; END_PROGRAM"
        )
    };
    for dialect in [Iec3, Matiec] {
        assert_eq!(values(dialect, &text("LogMessage"), 2, ["a"]), [2], "{dialect}");
        let findings = findings_in(dialect, &text("LogMessage"));
        let reported: Vec<_> = findings.iter().map(|found| (found.code.text(), found.severity)).collect();
        assert_eq!(reported, [("L0513", Severity::Warning)], "{findings}");
    }
    let reported = |dialect| {
        let findings = findings_in(dialect, &text("SetFbVar"));
        findings.iter().map(|found| (found.code.text(), found.severity)).collect::<Vec<_>>()
    };
    assert_eq!(reported(Iec3), [("L0513", Severity::Error)]);
    assert_eq!(reported(Matiec), [("W0710", Severity::Warning)], "the variables that it sets keep their values");
}

#[test]
fn a_task_may_be_faster_than_a_millisecond() {
    let task = r#"<TcPlcObject><Task Name="Fast"><CycleTime>250</CycleTime><Priority>1</Priority>
        <PouCall><Name>MAIN</Name></PouCall></Task></TcPlcObject>"#;
    let program =
        Input::from_text("MAIN.st", SourceKind::Text, "PROGRAM MAIN VAR n : INT; END_VAR n := n + 1; END_PROGRAM");
    let task = Input::from_text("Fast.TcTTO", SourceKind::TwinCat, task);
    let application = Application::from_inputs([program.in_dialect(TwinCat), task]).expect("it compiles");
    let plan = application.single_task(TimeSpan::millis::<10>());
    assert_eq!(Rig::with_plan(&application, &plan).int("MAIN.n"), 0);
}

#[test]
fn a_library_has_a_task_and_no_program() {
    let task = r#"<TcPlcObject><Task Name="PlcTask"><CycleTime>10000</CycleTime><Priority>20</Priority>
        <PouCall><Name>MAIN</Name></PouCall></Task></TcPlcObject>"#;
    let inputs = |text: &str| {
        [
            Input::from_text("lib.st", SourceKind::Text, text).in_dialect(TwinCat),
            Input::from_text("PlcTask.TcTTO", SourceKind::TwinCat, task),
        ]
    };
    let block = "FUNCTION_BLOCK F VAR a : INT; END_VAR a := a + 1; END_FUNCTION_BLOCK";
    let found = onescan_iec::inspect(inputs(block), None);
    assert!(found.iter().all(|found| found.severity == Severity::Warning), "{found}");
    assert!(found.iter().any(|found| found.code.text() == "D0431"), "{found}");
    let other = format!("{block} PROGRAM Other VAR f1 : F; END_VAR f1(); END_PROGRAM");
    let found = onescan_iec::inspect(inputs(&other), None);
    assert!(found.iter().any(|found| found.code.text() == "D0431" && found.severity == Severity::Error), "{found}");
}

const ARGUMENTS: &str = r#"<?xml version="1.0" encoding="utf-8"?>
<project xmlns="http://www.plcopen.org/xml/tc6_0200"><fileHeader productName="CODESYS"/><types><dataTypes/><pous>
<pou name="F" pouType="functionBlock"><interface>
  <globalVars><variable name="made"><type><INT/></type></variable></globalVars>
  <localVars><variable name="k"><type><INT/></type></variable></localVars></interface>
  <body><ST><xhtml xmlns="http://www.w3.org/1999/xhtml">made := made + 1;</xhtml></ST></body>
  <addData><data name="http://www.3s-software.com/plcopenxml/method"><Method name="FB_init"><interface>
    <returnType><BOOL/></returnType><inputVars><variable name="bInitRetains"><type><BOOL/></type></variable>
    <variable name="bInCopyCode"><type><BOOL/></type></variable><variable name="n"><type><INT/></type></variable></inputVars>
    </interface><body><ST><xhtml xmlns="http://www.w3.org/1999/xhtml">k := n;</xhtml></ST></body></Method></data></addData>
</pou>
<pou name="P" pouType="program"><interface><localVars>
  <variable name="a"><type><derived name="F"/></type><addData>
    <data name="http://www.3s-software.com/plcopenxml/inputassignments"><InputAssignments>
      <InputAssignment><Name>n</Name><Value>5 + 1</Value></InputAssignment></InputAssignments></data></addData></variable>
  <variable name="b"><type><derived name="F"/></type><addData>
    <data name="http://www.3s-software.com/plcopenxml/inputassignments"><InputAssignments>
      <InputAssignment><Value>8</Value></InputAssignment></InputAssignments></data></addData></variable>
</localVars></interface><body><ST><xhtml xmlns="http://www.w3.org/1999/xhtml">a(); b();</xhtml></ST></body></pou>
</pous></types></project>"#;

#[test]
fn arguments_of_instances_and_static_variables_are_read_from_xml() {
    let input = Input::from_text("app.xml", SourceKind::PlcOpen, ARGUMENTS);
    let application = Application::from_inputs([input]).expect("it compiles");
    let mut rig = Rig::with_plan(&application, &application.single_task(TimeSpan::millis::<10>()));
    rig.scan().expect("no fault");
    assert_eq!((rig.int("P.a.k"), rig.int("P.b.k")), (6, 8));
    // One variable of all instances.
    assert_eq!((rig.int("P.a.made"), rig.int("P.b.made")), (2, 2));
}

#[test]
fn a_value_of_several_enumerations_is_that_of_its_place() {
    let text = "TYPE A : (Close, Open); B : (Stop := 5, Close := 7, Open := 9); S : STRUCT a1 : A := Open; b1 : B := Open; END_STRUCT END_TYPE
        FUNCTION F : INT VAR_INPUT b1 : B; END_VAR F := 0; IF b1 = Close THEN F := 1; ELSIF Open = b1 THEN F := 2; END_IF; END_FUNCTION
        PROGRAM P VAR s : S; b2 : B; a2 : A; x, y, z : INT; END_VAR
          b2 := Close; a2 := Open; x := F(Open) * 10 + F(b1 := Close);
          CASE b2 OF Stop: y := 1; Close: y := 2; Open: y := 3; END_CASE;
          IF s.a1 <> Close AND s.b1 = Open THEN z := 4; END_IF; s.b1 := Close; END_PROGRAM";
    for dialect in VENDORS {
        assert_eq!(values(dialect, text, 1, ["x", "y", "z", "b2", "a2", "s.b1"]), [21, 2, 4, 7, 1, 7], "{dialect}");
        let unclear = "TYPE A : (Close, Open); B : (Stop := 5, Close := 7); END_TYPE
            PROGRAM P VAR n : INT; END_VAR n := Close; END_PROGRAM";
        assert!(findings_in(dialect, unclear).iter().any(|found| found.code.text() == "N0101"), "{dialect}");
    }
}

#[test]
fn values_of_an_enumeration_over_a_bit_string_are_bit_strings() {
    let text = "TYPE State : WORD (Off := WORD#16#7000, Busy := 16#7001, Failed := WORD#16#8001) := Busy; END_TYPE
        PROGRAM P VAR s, t : State; b : BOOL; END_VAR b := s = State#Busy; t := State#Failed; END_PROGRAM";
    assert_eq!(values(Iec3, text, 1, ["b", "s", "t"]), [1, 0x7001, 0x8001]);
}

#[test]
fn an_enumeration_is_shifted_as_its_number() {
    let text = "TYPE E : (Low := 16#12, High := 16#84) BYTE; END_TYPE
        PROGRAM P VAR e1 : E := High; x, y : BYTE; END_VAR x := SHR(e1, 4); y := SHL(e1, 1); END_PROGRAM";
    for dialect in VENDORS {
        assert_eq!(values(dialect, text, 1, ["x", "y"]), [8, 8], "{dialect}");
    }
    // Without a base type it is not a number in the standard.
    let plain = text.replace(" BYTE; END_TYPE", "; END_TYPE");
    assert!(findings_in(Iec3, &plain).iter().any(|found| found.code.text() == "T0201"));
}

#[test]
fn units_may_be_called_as_parts_of_charts_are() {
    let text = "INTERFACE IStep METHOD Action : INT END_METHOD END_INTERFACE
        CLASS Transition IMPLEMENTS IStep METHOD PUBLIC Action : INT Action := 3; END_METHOD
          METHOD PUBLIC Step : INT Step := 4; END_METHOD END_CLASS
        CLASS Step EXTENDS Transition IMPLEMENTS IStep END_CLASS
        PROGRAM P VAR t : Transition; s : Step; x : INT; END_VAR x := 10 * t.Action() + s.Step(); END_PROGRAM";
    assert_eq!(values(Iec3, text, 1, ["x"]), [34]);
}

#[test]
fn a_shifted_number_without_a_width_is_reported() {
    let text = "PROGRAM P VAR w : WORD; n : INT := 9; END_VAR w := SHL(1, n); END_PROGRAM";
    for dialect in VENDORS {
        let findings = findings_in(dialect, text);
        let helps = findings.iter().filter_map(|found| found.help.as_deref());
        assert!(helps.into_iter().any(|help| help.contains("WORD#1")), "{dialect}: {findings}");
        assert_eq!(values(dialect, &text.replace("SHL(1", "SHL(WORD#1"), 1, ["w"]), [512], "{dialect}");
    }
}

#[test]
fn a_reference_begins_as_what_it_refers_to() {
    let text = "FUNCTION_BLOCK Lamp VAR n : INT; END_VAR METHOD On : INT n := n + 1; On := n; END_METHOD END_FUNCTION_BLOCK
        FUNCTION_BLOCK Switch VAR r : REFERENCE TO Lamp; END_VAR
          METHOD FB_init : BOOL VAR_INPUT bInitRetains, bInCopyCode : BOOL; lamp1 : REFERENCE TO Lamp; END_VAR r REF= lamp1; END_METHOD
          METHOD Press : INT Press := r.On(); END_METHOD END_FUNCTION_BLOCK
        TYPE S : STRUCT a : INT; END_STRUCT END_TYPE
        PROGRAM P VAR l : Lamp; r1 : REFERENCE TO Lamp := l; s1 : Switch(r1); x, y, z : INT; v : S; q : REFERENCE TO S := v;
          w : INT := 3; t : REFERENCE TO INT REF= w; none : REFERENCE TO INT := 0; valid : BOOL; END_VAR
          x := r1.On(); y := s1.Press(); q.a := 5; t := t + 1; valid := __ISVALIDREF(none); END_PROGRAM";
    for dialect in VENDORS {
        assert_eq!(values(dialect, text, 1, ["x", "y", "v.a", "w", "valid"]), [1, 2, 5, 4, 0], "{dialect}");
        let wrong =
            "PROGRAM P VAR w : INT; r : REFERENCE TO DINT := w; v : INT REF= w; END_VAR r := 1; v := 2; END_PROGRAM";
        let findings = findings_in(dialect, wrong);
        let errors = findings.iter().filter(|found| found.severity == Severity::Error).count();
        assert_eq!(errors, 2, "{findings}");
    }
}

#[test]
fn a_called_fb_init_begins_the_instance_again() {
    let text = "
        FUNCTION_BLOCK Inner VAR k : INT := 4; count : INT; END_VAR
          METHOD FB_init : BOOL VAR_INPUT bInitRetains, bInCopyCode : BOOL; END_VAR count := count + 1; END_METHOD
          METHOD Work : INT k := 99; count := 70; END_METHOD END_FUNCTION_BLOCK
        FUNCTION_BLOCK A VAR n : INT := 3; i : Inner; END_VAR VAR RETAIN r : INT := 1; END_VAR VAR_IN_OUT used : INT; END_VAR
          METHOD Work : INT n := 50; r := 60; i.Work(); END_METHOD
          METHOD Reset : BOOL VAR_INPUT all : BOOL; END_VAR
            IF all THEN Reset := THIS^.FB_init(TRUE, FALSE); ELSE Reset := THIS^.FB_init(bInCopyCode := FALSE, bInitRetains := FALSE); END_IF
          END_METHOD
          used := used + 1; Reset(FALSE); used := used + 1; END_FUNCTION_BLOCK
        FUNCTION_BLOCK B VAR n : INT := 5; END_VAR
          METHOD FB_init : BOOL VAR_INPUT bInitRetains, bInCopyCode : BOOL; m : INT; END_VAR n := n + m; FB_init := TRUE; END_METHOD
        END_FUNCTION_BLOCK
        PROGRAM P VAR a1, a2 : A; b1 : B(m := 1); used : INT; b : BOOL; END_VAR
          a1.Work(); a1(used := used); a2.Work(); a2.Reset(TRUE);
          b1.FB_init(FALSE, FALSE, 10); b := b1.FB_init(FALSE, FALSE, 10); END_PROGRAM";
    for dialect in VENDORS {
        let names = ["a1.n", "a1.r", "a1.i.k", "a1.i.count", "a2.n", "a2.r", "used", "b1.n", "b"];
        assert_eq!(values(dialect, text, 1, names), [3, 60, 4, 1, 3, 1, 2, 15, 1], "{dialect}");
        for (call, code) in
            [("FB_init()", "C0302"), ("FB_init(TRUE, FALSE, 3)", "C0303"), ("FB_init(1.5, FALSE)", "T0201")]
        {
            let wrong = text.replace("a2.Reset(TRUE)", &format!("a2.{call}"));
            let findings = findings_in(dialect, &wrong);
            assert!(findings.iter().any(|found| found.code.text() == code), "{call} in {dialect}: {findings}");
        }
    }
}

#[test]
fn initial_values_name_the_instance() {
    let text = "
        FUNCTION_BLOCK S VAR CONSTANT base : INT := 40; END_VAR
          VAR k : INT := THIS^.base; m : INT := THIS^.Twice(THIS^.Next); p : POINTER TO INT := ADR(THIS^.k); END_VAR
          PROPERTY Next : INT GET Next := k + 1; END_GET END_PROPERTY
          METHOD Twice : INT VAR_INPUT n : INT; END_VAR Twice := 2 * n; END_METHOD
          METHOD Kept : INT VAR_INST c : INT := THIS^.k; END_VAR c := c + 1; Kept := c; END_METHOD
          METHOD Held : INT VAR_INST h : Holder := (other := THIS^.inner); END_VAR Held := h.Number(); END_METHOD
          VAR inner : Numbered; END_VAR END_FUNCTION_BLOCK
        INTERFACE INumbered METHOD Number : INT END_METHOD END_INTERFACE
        FUNCTION_BLOCK Numbered IMPLEMENTS INumbered METHOD Number : INT Number := 8; END_METHOD END_FUNCTION_BLOCK
        FUNCTION_BLOCK Holder VAR_INPUT other : INumbered; END_VAR METHOD Number : INT Number := other.Number(); END_METHOD END_FUNCTION_BLOCK
        PROGRAM P VAR s1, s2 : S; x, y, z : INT; END_VAR x := s1.m + s1.p^; y := s2.Kept(); z := s2.Held(); END_PROGRAM";
    for dialect in VENDORS {
        assert_eq!(values(dialect, text, 2, ["x", "y", "z"]), [122, 42, 8], "{dialect}");
        let findings = findings_in(dialect, &text.replace("k : INT := THIS^.base", "k : BOOL := THIS^.base"));
        let wrong = findings.iter().filter(|found| found.message == "BOOL is wanted, this is INT").count();
        assert_eq!(wrong, 1, "{dialect}: {findings}");
        let constant = text.replace("base : INT := 40;", "base : INT := 40; other : INT := THIS^.base;");
        assert!(findings_in(dialect, &constant).iter().any(|found| found.code.text() == "T0204"), "{dialect}");
    }
}

#[test]
fn what_is_declared_behind_a_reference_is_checked() {
    let text = "FUNCTION_BLOCK F VAR r : REFERENCE TO INT := x; x : REAL; END_VAR r := 1; END_FUNCTION_BLOCK
        PROGRAM P VAR f1, f2 : F; END_VAR f1(); f2(); END_PROGRAM";
    for dialect in VENDORS {
        let findings = findings_in(dialect, text);
        let wrong = findings.iter().filter(|found| found.message == "INT is wanted, this is REAL").count();
        assert_eq!(wrong, 1, "{dialect}: {findings}");
        assert!(!findings_in(dialect, &text.replace("x : REAL", "x : INT")).has_errors(), "{dialect}");
    }
}

#[test]
fn what_an_instance_is_declared_with_comes_behind_its_fb_init_computed_or_not() {
    let text = "TYPE Pair : STRUCT a, b : INT; END_STRUCT END_TYPE
        FUNCTION_BLOCK F VAR_INPUT a : INT; p : Pair; END_VAR
          METHOD FB_init : BOOL VAR_INPUT bInitRetains, bInCopyCode : BOOL; END_VAR a := 7; p.a := 7; p.b := 7; END_METHOD
        END_FUNCTION_BLOCK
        PROGRAM P VAR g : INT := 4; f1 : F := (a := g + 1, p := (a := g + 2, b := 9)); x : INT; END_VAR x := f1.a; END_PROGRAM";
    for dialect in VENDORS {
        assert_eq!(values(dialect, text, 1, ["x", "f1.p.a", "f1.p.b"]), [5, 6, 9], "{dialect}");
    }
}

#[test]
fn pointers_and_arrays_without_bounds_are_handed_on() {
    let text = "FUNCTION Next : BOOL VAR_IN_OUT p : POINTER TO BYTE; END_VAR p := p + 2; Next := TRUE; END_FUNCTION
        FUNCTION Again : BOOL VAR_INPUT p : REFERENCE TO POINTER TO BYTE; END_VAR p := p + 2; Again := TRUE; END_FUNCTION
        FUNCTION Fill : INT VAR_IN_OUT a : ARRAY [*] OF INT; END_VAR a[2] := 30; Fill := a[1]; END_FUNCTION
        FUNCTION Outer : INT VAR_INPUT a : ARRAY [*] OF INT; END_VAR Outer := Fill(a) + a[2]; END_FUNCTION
        PROGRAM P VAR w : ARRAY [0..2] OF WORD := [1, 7, 9]; q : POINTER TO WORD; x, y, z : INT; a : ARRAY [1..2] OF INT := [5, 6]; END_VAR
          q := ADR(w); Next(p := q); x := q^; Again(p := q); y := q^; z := Outer(a); END_PROGRAM";
    for dialect in VENDORS {
        assert_eq!(values(dialect, text, 1, ["x", "y", "z", "a[2]"]), [7, 9, 35, 30], "{dialect}");
        let said = findings_in(dialect, text).iter().filter(|found| found.code.text() == "R0906").count();
        assert_eq!(said, 2, "{dialect}");
        let constant = text.replace("FUNCTION Outer : INT VAR_INPUT a", "FUNCTION Outer : INT VAR_IN_OUT CONSTANT a");
        assert!(findings_in(dialect, &constant).has_errors(), "{dialect}");
    }
}

#[test]
fn a_constant_reference_takes_constants_and_any_stands_for_what_it_is() {
    let text = "INTERFACE ICheck METHOD Verify : DINT VAR_INPUT arg : ANY; END_VAR END_METHOD END_INTERFACE
        FUNCTION_BLOCK Check IMPLEMENTS ICheck
          METHOD Verify : DINT VAR_INPUT arg : __SYSTEM.AnyType; END_VAR Verify := arg.diSize; END_METHOD
          METHOD Length : INT VAR_INPUT CONSTANT name : REFERENCE TO STRING; END_VAR Length := LEN(name); END_METHOD
          METHOD Given : INT VAR_INPUT CONSTANT name : STRING; END_VAR Given := Length(name) + Length(fixed); END_METHOD
        END_FUNCTION_BLOCK
        VAR_GLOBAL CONSTANT fixed : STRING := 'four'; END_VAR
        PROGRAM P VAR c : Check; i : ICheck := c; d : LREAL; x : DINT; n : INT; END_VAR x := i.Verify(d); n := c.Given('two'); END_PROGRAM";
    for dialect in VENDORS {
        assert_eq!(values(dialect, text, 1, ["x", "n"]), [8, 7], "{dialect}");
        let written = text.replace("VAR_INPUT CONSTANT name : REFERENCE", "VAR_INPUT name : REFERENCE");
        assert!(findings_in(dialect, &written).iter().any(|found| found.code.text() == "R0904"), "{dialect}");
        let other = text.replace("arg : __SYSTEM.AnyType", "arg : LREAL").replace("arg.diSize", "1");
        assert!(findings_in(dialect, &other).iter().any(|found| found.code.text() == "O0804"), "{dialect}");
    }
}
