//! What projects of SIMATIC AX hold: assertions of its unit tests, namespaces in parts, values that several
//! enumerations share, parts of integers.

use onescan_iec::Dialect::{Iec2, Iec3, SiemensScl};
use onescan_iec::input::kind::SourceKind;
use onescan_iec::{Code, Input, Severity, inspect};
use onescan_iec_run::Application;

use crate::rig::{Rig, application_in, findings_in};

#[test]
fn assertions_are_stubs_that_take_any_value() {
    let text = "USING AxUnit;
        NAMESPACE Own.Tests
          CLASS T
            METHOD PUBLIC m VAR_TEMP w : DWORD; x : LREAL; END_VAR
              Assert.Equal(actual := w.%X5, expected := TRUE);
              AxUnit.Assert.NotEqual(expected := DWORD#16#20, actual := w);
              AxUnit.Assert.LessThan(left := x, right := 2.5);
            END_METHOD
          END_CLASS
        END_NAMESPACE";
    let findings = findings_in(Iec3, text);
    let reported: Vec<_> = findings.iter().map(|found| (found.severity, found.code)).collect();
    assert_eq!(reported, [(Severity::Warning, Code::StubUsed); 3], "{findings}");
    let wrong = text.replace("left := x", "left := missing");
    assert!(findings_in(Iec3, &wrong).iter().any(|found| found.code == Code::UnknownName));
}

#[test]
fn the_parts_of_a_namespace_s_name_are_namespaces() {
    let text = "NAMESPACE A.B.C FUNCTION F : INT F := 3; END_FUNCTION END_NAMESPACE
        USING A.B; PROGRAM P VAR r : INT; END_VAR r := C.F(); END_PROGRAM";
    let mut rig = Rig::in_dialect(Iec3, text);
    rig.scan().expect("no fault");
    assert_eq!(rig.int("P.r"), 3);
    let unknown = text.replace("USING A.B;", "USING A.BC;");
    assert!(findings_in(Iec3, &unknown).iter().any(|found| found.code == Code::UnknownNamespace));
}

#[test]
fn the_place_says_which_enumeration_is_meant() {
    let text = "TYPE One : INT (POSITIVE := 1, NEGATIVE := 2) := NEGATIVE; END_TYPE
        TYPE Two : INT (NEGATIVE := 7, SHORTEST := 3) := NEGATIVE; END_TYPE
        PROGRAM P VAR a : One; b : Two; c : Two := SHORTEST; r1, r2, r3 : INT; END_VAR
          r1 := a; r2 := b; c := NEGATIVE; IF c = NEGATIVE THEN r3 := c; END_IF; END_PROGRAM";
    let mut rig = Rig::in_dialect(Iec3, text);
    rig.scan().expect("no fault");
    assert_eq!(["r1", "r2", "r3"].map(|name| rig.int(&format!("P.{name}"))), [2, 7, 7]);
    let open = "TYPE A : (X, Y); B : (Y, Z); END_TYPE PROGRAM P VAR n : DINT; END_VAR n := A#X + Y; END_PROGRAM";
    assert!(
        findings_in(Iec3, open).iter().any(|found| found.severity == Severity::Error),
        "nothing says whose Y it is"
    );
}

#[test]
fn integers_have_parts() {
    let text = "PROGRAM P VAR i : INT := 16#1234; d : DINT; x : BOOL; b : BYTE; END_VAR
        x := i.%X2; b := i.%B1; d.%X31 := TRUE; d.%W0 := 16#FFFF; i.%B0 := 16#FF; END_PROGRAM";
    for dialect in [Iec3, SiemensScl] {
        let mut rig = Rig::in_dialect(dialect, text);
        rig.scan().expect("no fault");
        assert!(rig.bool("P.x"), "{dialect}");
        let found = ["b", "i", "d"].map(|name| rig.int(&format!("P.{name}")));
        assert_eq!(found, [0x12, 0x12ff, i64::from(0x8000_ffff_u32 as i32)], "{dialect}");
    }
    assert!(findings_in(Iec2, text).iter().any(|found| found.code == Code::InvalidPart));
}

#[test]
fn the_only_parameter_has_no_name_even_if_it_is_an_output() {
    let text =
        "PROGRAM P VAR now : DTL; error, year : INT; END_VAR error := RD_SYS_T(now); year := now.YEAR; END_PROGRAM";
    let mut rig = Rig::in_dialect(SiemensScl, &text.replace("year := now.YEAR", "year := UINT_TO_INT(now.YEAR)"));
    rig.scan().expect("no fault");
    assert_eq!((rig.int("P.error"), rig.int("P.year")), (0, 1970));
}

/// Functions by the type of one parameter, by their number, by a reference.
const FUNCTIONS: &str = "
    FUNCTION Kind : INT VAR_INPUT value : INT; END_VAR Kind := 1; END_FUNCTION
    FUNCTION Kind : INT VAR_INPUT value : LREAL; END_VAR Kind := 2; END_FUNCTION
    FUNCTION Kind : INT VAR_INPUT value : BOOL; END_VAR Kind := 3; END_FUNCTION
    FUNCTION Kind : INT VAR_INPUT value : STRING; END_VAR Kind := 4; END_FUNCTION
    FUNCTION Kind : INT VAR_INPUT value, more : INT; END_VAR Kind := 5; END_FUNCTION
    FUNCTION Kind : INT VAR_IN_OUT value : ARRAY [*] OF INT; END_VAR Kind := 6; END_FUNCTION
    FUNCTION Kind : INT Kind := 7; END_FUNCTION
    FUNCTION Kind : INT VAR_INPUT value : DINT; END_VAR Kind := Kind(value := INT#4) + 10; END_FUNCTION";

#[test]
fn a_call_means_the_function_whose_parameters_suit_best() {
    let calls = [
        ("Kind(i)", 1),
        ("Kind(x)", 2),
        ("Kind(b)", 3),
        ("Kind('a')", 4),
        ("Kind(i, INT#3)", 5),
        ("Kind(more := i, value := i)", 5),
        ("Kind(a)", 6),
        ("Kind()", 7),
        ("Kind(d)", 11),
        // An argument of another type goes to the nearest one that it widens to.
        ("Kind(s)", 1),
        ("Kind(r)", 2),
        ("Kind(u)", 11),
        ("Kind(Kind(Kind(Kind(b))))", 1),
        ("Kind(i + d)", 11),
    ];
    for (call, wanted) in calls {
        let program = format!(
            "{FUNCTIONS} PROGRAM P VAR n, i : INT; s : SINT; u : UINT; d : DINT; r : REAL; x : LREAL; b : BOOL;
             a : ARRAY [0..2] OF INT; END_VAR n := {call}; END_PROGRAM"
        );
        let mut rig = Rig::in_dialect(Iec3, &program);
        rig.scan().expect("no fault");
        assert_eq!(rig.int("P.n"), wanted, "{call}");
    }
}

#[test]
fn what_no_function_or_several_take_is_reported_with_their_parameters() {
    let program =
        |call: &str| format!("{FUNCTIONS} PROGRAM P VAR n : INT; t : TIME; l : LINT; END_VAR n := {call}; END_PROGRAM");
    for (call, message) in [
        ("Kind(t)", "no `Kind` takes these arguments"),
        ("Kind(7)", "several `Kind` take these arguments equally well"),
        ("Kind(l, l)", "no `Kind` takes these arguments"),
        ("Kind(nothing := 3)", "no `Kind` takes these arguments"),
    ] {
        let findings = findings_in(Iec3, &program(call));
        let unclear: Vec<_> = findings.iter().filter(|found| found.code == Code::UnclearOverload).collect();
        assert_eq!(unclear.len(), 1, "{call}: {findings}");
        assert_eq!(unclear[0].message, message, "{call}");
        assert!(unclear[0].labels.iter().any(|label| label.message == "takes (DINT)"), "{call}: {findings}");
    }
    let deep = format!("{}t{}", "Kind(".repeat(40), ")".repeat(40));
    assert!(findings_in(Iec3, &program(&deep)).iter().any(|found| found.code == Code::UnclearOverload));
    let twice = "FUNCTION F : INT VAR_INPUT a : INT; END_VAR F := 1; END_FUNCTION
        FUNCTION F : INT VAR_INPUT b : INT; END_VAR F := 2; END_FUNCTION";
    assert!(findings_in(Iec3, twice).iter().any(|found| found.code == Code::DuplicateName), "only the names differ");
}

#[test]
fn methods_of_one_name_are_overridden_by_their_parameters() {
    let text = "
        INTERFACE Sink METHOD Put : INT VAR_INPUT value : INT; END_VAR END_METHOD
          METHOD Put : INT VAR_INPUT value : BOOL; END_VAR END_METHOD END_INTERFACE
        CLASS Base IMPLEMENTS Sink
          METHOD PUBLIC Put : INT VAR_INPUT value : INT; END_VAR Put := 1; END_METHOD
          METHOD PUBLIC Put : INT VAR_INPUT value : BOOL; END_VAR Put := 2; END_METHOD
          METHOD PUBLIC Twice : INT VAR_INPUT value : INT; END_VAR Twice := 10 * THIS.Put(value) + Put(TRUE); END_METHOD
        END_CLASS
        CLASS Derived EXTENDS Base
          METHOD PUBLIC OVERRIDE Put : INT VAR_INPUT value : BOOL; END_VAR Put := SUPER.Put(value) + 5; END_METHOD
          METHOD PUBLIC Put : INT VAR_INPUT value : LREAL; END_VAR Put := 3; END_METHOD
        END_CLASS
        PROGRAM P VAR base : Base; derived : Derived; sink : Sink; r : ARRAY [0..6] OF INT; END_VAR
          r[0] := base.Put(INT#0); r[1] := base.Put(FALSE); r[2] := base.Twice(0);
          r[3] := derived.Put(value := INT#0); r[4] := derived.Twice(0); r[5] := derived.Put(LREAL#1.5);
          sink := derived; r[6] := 10 * sink.Put(INT#1) + sink.Put(TRUE);
        END_PROGRAM";
    let mut rig = Rig::in_dialect(Iec3, text);
    rig.scan().expect("no fault");
    let found: Vec<i64> = (0..=6).map(|index| rig.int(&format!("P.r[{index}]"))).collect();
    assert_eq!(found, [1, 2, 12, 1, 17, 3, 17]);
    let lacking = text.replace("METHOD PUBLIC Put : INT VAR_INPUT value : BOOL; END_VAR Put := 2; END_METHOD", "");
    let findings = findings_in(Iec3, &lacking);
    let missing =
        findings.iter().find(|found| found.code == Code::MissingMethod).expect("a prototype without a method");
    assert_eq!(missing.message, "`Base` lacks the method `Put(BOOL)` of `Sink`");
    let wrong = text.replace("OVERRIDE Put : INT VAR_INPUT value : BOOL", "OVERRIDE Put : INT VAR_INPUT value : UINT");
    let findings = findings_in(Iec3, &wrong);
    let nothing = findings.iter().find(|found| found.code == Code::NothingOverridden).expect("no such method above");
    assert_eq!(nothing.message, "no base has a method `Put(UINT)` to override");
}

#[test]
fn a_method_stands_beside_the_one_of_its_base_that_has_other_parameters() {
    let text = "
        CLASS Base METHOD PUBLIC Attach : INT VAR_INPUT a : INT; END_VAR Attach := a; END_METHOD END_CLASS
        CLASS Derived EXTENDS Base
          METHOD PUBLIC Attach : INT VAR_INPUT a : STRING; END_VAR Attach := SUPER.Attach(INT#3) + LEN(a); END_METHOD
        END_CLASS
        PROGRAM P VAR d : Derived; n, m : INT; END_VAR n := d.Attach('four'); m := d.Attach(INT#9); END_PROGRAM";
    let mut rig = Rig::in_dialect(Iec3, text);
    rig.scan().expect("no fault");
    assert_eq!((rig.int("P.n"), rig.int("P.m")), (7, 9));
}

#[test]
fn a_character_stands_for_a_string_of_its_own() {
    let text = "FUNCTION Digit : CHAR VAR_INPUT n : INT; END_VAR Digit := '0'; IF n = 1 THEN Digit := '1'; END_IF; END_FUNCTION
        PROGRAM P VAR s : STRING := 'xyz'; t, u : STRING; c : CHAR := 'x'; w : WSTRING; k : WCHAR := \"k\"; a, b, d : BOOL; END_VAR
          t := c; u := CONCAT(Digit(1), s, s[2]); w := k;
          a := s = c; b := LEFT(s, 1) = c; d := c = 'x'; END_PROGRAM";
    let mut rig = Rig::in_dialect(Iec3, text);
    rig.scan().expect("no fault");
    assert_eq!(["t", "u", "w"].map(|name| rig.text(&format!("P.{name}"))), ["x", "1xyzy", "k"]);
    assert_eq!(["a", "b", "d"].map(|name| rig.bool(&format!("P.{name}"))), [false, true, true]);
    let wide = "PROGRAM P VAR c : CHAR; w : WSTRING; END_VAR w := c; END_PROGRAM";
    assert!(findings_in(Iec3, wide).iter().any(|found| found.code == Code::TypeMismatch), "of one width alone");
}

#[test]
fn characters_and_strings_select() {
    let text = "FUNCTION Next : STRING VAR_IN_OUT n : INT; END_VAR n := n + 1; Next := 'go'; END_FUNCTION
        PROGRAM P VAR s : STRING := 'stop'; c : CHAR := 'b'; n, r1, r2, r3, r4 : INT; END_VAR
          CASE s OF 'go': r1 := 1; 'halt', 'stop': r1 := 2; ELSE r1 := 3; END_CASE;
          CASE c OF 'a': r2 := 1; 'b'..'d': r2 := 2; END_CASE;
          CASE Next(n) OF 'no': r3 := 1; 'none': r3 := 2; ELSE r3 := 3; END_CASE;
          CASE Next(n) OF ELSE r4 := 4; END_CASE;
        END_PROGRAM";
    let mut rig = Rig::in_dialect(Iec3, text);
    rig.scan().expect("no fault");
    assert_eq!(["r1", "r2", "r3", "r4", "n"].map(|name| rig.int(&format!("P.{name}"))), [2, 2, 3, 4, 2]);
    let findings = findings_in(Iec3, &text.replace("'halt', 'stop'", "'go', 'a'..'b'"));
    let found: Vec<_> = findings.iter().map(|found| found.code).collect();
    assert!(found.contains(&Code::DuplicateCase) && found.contains(&Code::InvalidRange), "{findings}");
}

#[test]
fn an_empty_list_leaves_every_input_at_its_initial_value() {
    let text = "FUNCTION F : INT VAR_INPUT a : INT; b : INT := 4; END_VAR F := 10 * a + b; END_FUNCTION
        CLASS C METHOD PUBLIC M : DINT VAR_INPUT t : TIME; n : DINT := 3; END_VAR M := n + TIME_TO_DINT(t); END_METHOD END_CLASS
        PROGRAM P VAR c : C; n : INT; m : DINT; END_VAR n := F(); m := c.M(); END_PROGRAM";
    let mut rig = Rig::in_dialect(Iec3, text);
    rig.scan().expect("no fault");
    assert_eq!((rig.int("P.n"), rig.int("P.m")), (4, 3));
    let left_out = findings_in(Iec3, text);
    let said: Vec<_> = left_out.iter().map(|found| (found.severity, found.message.clone())).collect();
    let message =
        |name: &str| (Severity::Warning, format!("parameter `{name}` is missing: it is what its type begins with"));
    assert_eq!(said, [message("a"), message("t")]);
    let some = text.replace("F()", "F(1)");
    let mut rig = Rig::in_dialect(Iec3, &some);
    rig.scan().expect("no fault");
    assert_eq!(rig.int("P.n"), 14, "an input with a value of its own may be left out behind others");
    let others = text.replace("F()", "F(b := 1)").replace("c.M()", "c.M(T#1ms)");
    assert!(!findings_in(Iec3, &others).has_errors());
    let needed = text.replace("b : INT := 4", "b : INT").replace("F()", "F(1)");
    assert!(findings_in(Iec3, &needed).iter().any(|found| found.code == Code::MissingArgument));
}

#[test]
fn in_a_method_its_bare_name_is_the_function_s() {
    let text = "NAMESPACE Own FUNCTION TRUNC : DINT VAR_INPUT value : LREAL; END_VAR TRUNC := 42; END_FUNCTION END_NAMESPACE
        CLASS Builder VAR text : STRING := 'abcdef'; END_VAR
          METHOD PUBLIC Left : INT VAR_INPUT s : STRING; n : INT; END_VAR text := Left(text, n); Left := LEN(text); END_METHOD
        END_CLASS
        PROGRAM P VAR b : Builder; n : INT; d, e : DINT; END_VAR
          n := b.Left('', 2); d := Own.TRUNC(1.5); e := TRUNC(LREAL#1.5); END_PROGRAM";
    let mut rig = Rig::in_dialect(Iec3, text);
    rig.scan().expect("no fault");
    assert_eq!((rig.int("P.n"), rig.int("P.d"), rig.int("P.e")), (2, 42, 1));
}

#[test]
fn outputs_stand_behind_inputs_and_say_which_function_is_meant() {
    let text = "
        FUNCTION Read : BOOL VAR_INPUT s : STRING; END_VAR VAR_OUTPUT value : INT; END_VAR value := 1; Read := TRUE; END_FUNCTION
        FUNCTION Read : BOOL VAR_INPUT s : STRING; END_VAR VAR_OUTPUT value : LREAL; END_VAR value := 2.5; END_FUNCTION
        FUNCTION Read : BOOL VAR_INPUT s : STRING; END_VAR VAR_OUTPUT value : INT; rest : STRING; END_VAR
          value := 3; rest := CONCAT(string1 := s, string2 := '!'); END_FUNCTION
        PROGRAM P VAR i, j, k : INT; d : DINT; x : LREAL; a, b : BOOL; rest : STRING; END_VAR
          a := Read('', i); b := Read('', value => x); Read('so', k, rest); a := Read('', d) AND a;
        END_PROGRAM";
    let mut rig = Rig::in_dialect(Iec3, text);
    rig.scan().expect("no fault");
    assert_eq!(["i", "d", "k"].map(|name| rig.int(&format!("P.{name}"))), [1, 1, 3]);
    assert_eq!((rig.bool("P.a"), rig.bool("P.b"), rig.text("P.rest").as_str()), (true, false, "so!"));
    let same = "FUNCTION F : INT VAR_OUTPUT a : INT; END_VAR a := 1; F := 1; END_FUNCTION
        FUNCTION F : INT VAR_OUTPUT b : INT; END_VAR b := 1; F := 1; END_FUNCTION";
    assert!(findings_in(Iec3, same).iter().any(|found| found.code == Code::DuplicateName));
}

#[test]
fn a_reference_to_a_base_refers_to_what_is_derived() {
    let text = "
        CLASS Base METHOD PUBLIC Kind : INT Kind := 1; END_METHOD END_CLASS
        CLASS Derived EXTENDS Base VAR n : INT; END_VAR METHOD PUBLIC OVERRIDE Kind : INT Kind := 2; END_METHOD END_CLASS
        PROGRAM P VAR base : Base; derived : Derived; r : REF_TO Base; s : REF_TO Derived; a, b, c : INT; END_VAR
          s := REF(derived); r := s; a := r^.Kind(); r := REF(base); b := r^.Kind(); r := REF(derived); c := r^.Kind();
        END_PROGRAM";
    let mut rig = Rig::in_dialect(Iec3, text);
    rig.scan().expect("no fault");
    assert_eq!(["a", "b", "c"].map(|name| rig.int(&format!("P.{name}"))), [2, 1, 2]);
    let wrong = text.replace("r := s;", "s := r;");
    assert!(findings_in(Iec3, &wrong).iter().any(|found| found.code == Code::TypeMismatch));
}

#[test]
fn a_task_without_an_interval_is_the_program_cycle() {
    let text = "PROGRAM P VAR n : INT; END_VAR n := n + 1; END_PROGRAM PROGRAM Q VAR n : INT; END_VAR n := n + 1; END_PROGRAM
        CONFIGURATION C TASK Main (PRIORITY := 2); TASK First (PRIORITY := 1); TASK Fast (INTERVAL := T#20ms, PRIORITY := 3);
          PROGRAM p1 WITH Main : P; PROGRAM p2 WITH First : P; PROGRAM q1 WITH Fast : Q; END_CONFIGURATION";
    let application = application_in(Iec3, text);
    let plan = application.configured_tasks().expect("a configuration");
    assert_eq!((plan.tasks.len(), plan.background.as_slice()), (1, ["p2".to_owned(), "p1".to_owned()].as_slice()));
    let mut rig = Rig::with_plan(&application, &plan);
    rig.step_ns = 10 * crate::rig::MS;
    for _ in 0..4 {
        rig.scan().expect("no fault");
    }
    assert_eq!([rig.int("p1.n"), rig.int("p2.n"), rig.int("q1.n")], [4, 4, 2]);
    let findings = findings_in(Iec3, text);
    let said = findings.iter().filter(|found| found.code == Code::TaskNeverRuns && found.severity == Severity::Warning);
    assert_eq!(said.count(), 2, "{findings}");
    let wrong = text.replace("Main (PRIORITY := 2)", "Main (INTERVAL := T#0s)");
    assert!(
        findings_in(Iec3, &wrong).iter().any(|found| found.severity == Severity::Error),
        "an interval of 0 is none"
    );
}

#[test]
fn timers_take_an_ltime() {
    let text = "PROGRAM P VAR CONSTANT short : LTIME := LTIME#25ms; END_VAR VAR t : TON; q : BOOL; l : LTIME; END_VAR
          t(IN := TRUE, PT := short); q := t.Q; l := t.ET; END_PROGRAM";
    let mut rig = Rig::in_dialect(Iec3, text);
    let found: Vec<bool> = (0..4)
        .map(|_| {
            rig.scan().expect("no fault");
            rig.bool("P.q")
        })
        .collect();
    assert_eq!(found, [false, false, false, true]);
    let own = "FUNCTION_BLOCK F VAR_INPUT PT : TIME; END_VAR END_FUNCTION_BLOCK
        PROGRAM P VAR f1 : F; l : LTIME; END_VAR f1(PT := l); END_PROGRAM";
    assert!(
        findings_in(Iec3, own).iter().any(|found| found.code == Code::TypeMismatch),
        "of the standard's timers alone"
    );
}

#[test]
fn a_count_begins_with_a_wider_number_and_a_value_stands_behind_blanks() {
    let text = "TYPE Colour : (Red, Green, Blue); END_TYPE
        PROGRAM P VAR c : Colour; d : DINT := 2; i, n : INT; w, v : WSTRING; END_VAR
          FOR i := d TO 4 DO n := n + i; END_FOR; c := Colour# Blue; IF c = Colour#@Blue THEN n := n + 100; END_IF;
          w := WSTRING#'so'; v := WSTRING#''; END_PROGRAM"
        .replace('@', "\t");
    let mut rig = Rig::in_dialect(Iec3, &text);
    rig.scan().expect("no fault");
    assert_eq!(
        (rig.int("P.n"), rig.int("P.c"), rig.text("P.w").as_str(), rig.text("P.v").as_str()),
        (109, 2, "so", "")
    );
    let findings = findings_in(Iec3, &text);
    assert!(findings.iter().any(|found| found.code == Code::TypeMismatch && found.severity == Severity::Warning));
    for wrong in
        [text.replace("TO 4", "TO d"), text.replace("d : DINT", "d : UDINT"), text.replace("WSTRING#''", "STRING#\"\"")]
    {
        assert!(findings_in(Iec3, &wrong).has_errors(), "{wrong}");
    }
}

#[test]
fn global_variables_have_configurations_of_their_own() {
    let file = |name: &str, text: &str| Input::from_text(name, SourceKind::Text, text).in_dialect(Iec3);
    let files = |second: &str| {
        [
            file("ids.st", "CONFIGURATION Identifiers VAR_GLOBAL CONSTANT id : UINT := 265; END_VAR END_CONFIGURATION"),
            file(
                "main.st",
                "CONFIGURATION C TASK T (INTERVAL := T#10ms); PROGRAM P1 WITH T : P; VAR_GLOBAL m : UINT; END_VAR END_CONFIGURATION",
            ),
            file("addresses.st", second),
            file(
                "p.st",
                "PROGRAM P VAR_EXTERNAL CONSTANT id : UINT; END_VAR VAR_EXTERNAL m, n : UINT; END_VAR m := id; n := m; END_PROGRAM",
            ),
        ]
    };
    let application =
        Application::from_inputs(files("CONFIGURATION Addresses VAR_GLOBAL n : UINT; END_VAR END_CONFIGURATION"))
            .expect("it compiles");
    let mut rig = Rig::with_plan(&application, &application.configured_tasks().expect("a configuration"));
    rig.scan().expect("no fault");
    assert_eq!((rig.int("m"), rig.int("n")), (265, 265));
    let two = "CONFIGURATION D TASK U (INTERVAL := T#10ms); PROGRAM P2 WITH U : P; VAR_GLOBAL n : UINT; END_VAR END_CONFIGURATION";
    assert!(inspect(files(two), None).iter().any(|found| found.code == Code::SecondConfiguration));
}

#[test]
fn an_instance_is_copied_with_a_warning() {
    let text = "CLASS Box VAR PUBLIC n : INT; END_VAR METHOD PUBLIC Kind : INT Kind := n; END_METHOD END_CLASS
        PROGRAM P VAR b : ARRAY [0..1] OF Box; x : INT; END_VAR b[1].n := 5; b[0] := b[1]; b[1].n := 6; x := b[0].Kind(); END_PROGRAM";
    let mut rig = Rig::in_dialect(Iec3, text);
    rig.scan().expect("no fault");
    assert_eq!(rig.int("P.x"), 5);
    let findings = findings_in(Iec3, text);
    let said: Vec<_> = findings.iter().filter(|found| found.code == Code::NotAssignable).collect();
    assert!(said.len() == 1 && said[0].severity == Severity::Warning, "{findings}");
}

#[test]
fn instances_begin_with_one_another() {
    let text = "INTERFACE INode METHOD Number : INT END_METHOD END_INTERFACE
        CLASS Node IMPLEMENTS INode VAR PUBLIC next : INode; n : INT; END_VAR
          METHOD PUBLIC Number : INT Number := n; END_METHOD METHOD PUBLIC After : INT After := next.Number(); END_METHOD END_CLASS
        PROGRAM P VAR_EXTERNAL a, b : Node; END_VAR VAR x, y : INT; END_VAR x := a.After(); y := b.After(); END_PROGRAM
        CONFIGURATION C TASK T (INTERVAL := T#10ms); PROGRAM P1 WITH T : P;
          VAR_GLOBAL a : Node := (next := b, n := 1); b : Node := (next := a, n := 2); END_VAR END_CONFIGURATION";
    let mut rig = Rig::in_dialect(Iec3, text);
    rig.scan().expect("no fault");
    assert_eq!((rig.int("P1.x"), rig.int("P1.y")), (2, 1));
    let wrong = text.replace("CLASS Node IMPLEMENTS INode", "CLASS Node").replace("next.Number()", "n");
    assert!(findings_in(Iec3, &wrong).has_errors(), "what implements nothing is not referred to");
}
