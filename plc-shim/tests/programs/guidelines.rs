//! Rules that a compiler can judge without taste, those of PLCopen's coding guidelines among them.

use onescan_iec::Dialect;

use crate::rig::findings_in;

const HEAD: &str = "PROGRAM P
VAR i, n : INT; u : UINT; b : USINT; r : REAL; l : LREAL; d : DINT; x, y, q : BOOL; w : WORD; t : TON; END_VAR
VAR_OUTPUT lamp : BOOL; speed : INT; END_VAR
VAR CONSTANT none : INT := 0; ten : INT := 10; END_VAR
";

/// What is said of a body in a dialect; what is said of variables that it does not use is left out.
fn said(dialect: Dialect, body: &str) -> String {
    let found = findings_in(dialect, &format!("{HEAD}{body}\nEND_PROGRAM")).to_string();
    let unused = ["W0701", "W0702", "W0706"];
    found.lines().filter(|line| !unused.iter().any(|code| line.contains(code))).collect::<Vec<_>>().join("\n")
}

fn all(dialect: Dialect, bodies: &[&str]) -> String {
    bodies.iter().map(|body| format!("{body}\n    {}", said(dialect, body))).collect::<Vec<_>>().join("\n")
}

/// Nothing is said of any of them, in no dialect that knows them.
fn quiet(bodies: &[&str]) {
    for body in bodies {
        for dialect in [Dialect::Iec3, Dialect::Codesys, Dialect::TwinCat] {
            assert_eq!(said(dialect, body), "", "{dialect}: {body}");
        }
    }
}

#[test]
fn divisions_by_zero() {
    insta::assert_snapshot!(all(
        Dialect::Iec3,
        &[
            "n := i / 0;",
            "r := r / 0.0;",
            "n := i MOD 0;",
            "n := i / none;",
            "n := DIV(i, 0);",
            "IF x THEN n := n / 0; END_IF;"
        ]
    ));
    quiet(&[
        "n := i / ten;",
        "IF none <> 0 THEN n := i / none; END_IF;",
        "n := SEL(i = 0, 10 / ten, 0);",
        "n := 0 / ten;",
    ]);
}

#[test]
fn a_division_by_zero_in_scl() {
    let text = "FUNCTION_BLOCK F\nVAR i, n : INT; END_VAR\nBEGIN\n#n := #i / 0;\nEND_FUNCTION_BLOCK";
    insta::assert_snapshot!(findings_in(Dialect::SiemensScl, text));
}

#[test]
fn fractions_that_are_lost() {
    insta::assert_snapshot!(all(
        Dialect::Iec3,
        &[
            "r := 1 / 3;",
            "r := 2.5 * (10 / 4);",
            "r := n / 2;",
            "l := l + d / ten;",
            "r := n + i / 3;",
            "r := ten / 3;"
        ]
    ));
    insta::assert_snapshot!(said(Dialect::Codesys, "r := n / 2; l := u / 10;"), @"
    test.st:5:6: warning[W0721]: this quotient of integers loses its fraction before it becomes REAL (convert before you divide, as in `INT_TO_REAL(a) / b`)
    test.st:5:18: warning[W0721]: this quotient of integers loses its fraction before it becomes LREAL (convert before you divide, as in `UINT_TO_LREAL(a) / b`)
    ");
    quiet(&[
        "r := 1.0 / 3.0;",
        "r := 10 / 5;",
        "r := ten / 5;",
        "r := n / 10 * 10;",
        "r := INT_TO_REAL(n / 2);",
        "n := 7 / 2;",
        "r := n / 1;",
        "r := INT_TO_REAL(n) / 2;",
        "x := 7 / 2 > n;",
    ]);
}

#[test]
fn loops_that_never_run() {
    insta::assert_snapshot!(all(
        Dialect::Iec3,
        &[
            "FOR i := 10 TO 0 DO n := n + i; END_FOR;",
            "FOR i := 0 TO 10 BY -1 DO n := n + i; END_FOR;",
            "FOR i := 16#A TO 1 BY 2 DO n := n + i; END_FOR;",
        ]
    ));
    quiet(&[
        "FOR i := 0 TO 10 DO n := n + i; END_FOR;",
        "FOR i := 10 TO 0 BY -1 DO n := n + i; END_FOR;",
        "FOR i := 3 TO 3 DO n := n + i; END_FOR;",
        "FOR i := 1 TO none DO n := n + i; END_FOR;",
    ]);
}

const UNITS: &str = "FUNCTION Next : INT VAR_IN_OUT a : INT; END_VAR a := a + 1; Next := a; END_FUNCTION
FUNCTION Twice : INT VAR_IN_OUT a : INT; END_VAR Twice := a * 2; END_FUNCTION
FUNCTION Both : INT VAR_OUTPUT o : INT; END_VAR o := 1; Both := 2; END_FUNCTION
FUNCTION_BLOCK Step VAR_IN_OUT a : INT; END_VAR VAR_OUTPUT o : INT; END_VAR a := a + 1; o := a; END_FUNCTION_BLOCK
FUNCTION_BLOCK Look VAR_IN_OUT a : INT; END_VAR VAR_OUTPUT o : INT; END_VAR o := a; END_FUNCTION_BLOCK
";

fn in_loop(body: &str) -> String {
    let text = format!(
        "{UNITS}PROGRAM P VAR i, j, n : INT; s : Step; k : Look; list : ARRAY [0..9] OF INT; x : BOOL; END_VAR
FOR i := 0 TO 9 DO {body} END_FOR;\nEND_PROGRAM"
    );
    let found = findings_in(Dialect::Codesys, &text).to_string();
    found.lines().filter(|line| !line.contains("W0706") && !line.contains("W0702")).collect::<Vec<_>>().join("\n")
}

#[test]
fn a_loop_whose_variable_is_written() {
    let bodies = [
        "i := i + 1;",
        "IF x THEN i := 9; END_IF;",
        "FOR i := 0 TO 3 DO n := n + 1; END_FOR;",
        "n := Next(i);",
        "n := Both(o => i);",
        "s(a := i);",
        "k(a := n, o => i);",
    ];
    let all: Vec<String> = bodies.iter().map(|body| format!("{body}\n    {}", in_loop(body))).collect();
    insta::assert_snapshot!(all.join("\n"));
    for body in [
        "n := n + i;",
        "list[i] := i;",
        "n := Twice(i);",
        "k(a := i);",
        "FOR j := 0 TO i DO n := n + j; END_FOR;",
        "IF list[i] = 0 THEN n := i; i := 9; EXIT; END_IF;",
    ] {
        assert_eq!(in_loop(body), "", "{body}");
    }
}

#[test]
fn comparisons_that_a_type_decides() {
    insta::assert_snapshot!(all(
        Dialect::Iec3,
        &[
            "x := u < 0;",
            "x := u >= 0;",
            "x := 0 > u;",
            "x := b > 255;",
            "x := b = 256;",
            "x := b <= UINT#300;",
            "x := b <> -1;"
        ]
    ));
    insta::assert_snapshot!(said(Dialect::Codesys, "x := u < 0 OR w >= 0;"), @"
    test.st:5:6: warning[W0724]: this is always FALSE: UINT has the values 0 to 65535 (compare with a number inside of them, or declare the variable with another type)
    test.st:5:15: warning[W0724]: this is always TRUE: WORD has the values 0 to 65535 (compare with a number inside of them, or declare the variable with another type)
    ");
    quiet(&[
        "x := u > 0;",
        "x := u <= 0;",
        "x := b >= 1;",
        "x := b < 255;",
        "x := n < 0;",
        "x := d >= 40000;",
        "x := u = 0;",
    ]);
}

#[test]
fn values_that_are_overwritten() {
    insta::assert_snapshot!(all(
        Dialect::Iec3,
        &[
            "lamp := x; lamp := y;",
            "lamp := x; t(IN := q, PT := T#1s); lamp := t.Q;",
            "speed := n; IF x THEN speed := 1; END_IF; speed := i;",
            "n := 1; n := 2;",
            "%QX1.0 := x; y := q; %QX1.0 := y;",
        ]
    ));
    quiet(&[
        "lamp := x; lamp := lamp OR y;",
        "lamp := x; IF y THEN lamp := FALSE; END_IF;",
        "lamp := FALSE; lamp := x AND y;",
        "lamp := x; q := lamp; lamp := y;",
        "lamp := x; IF q THEN RETURN; END_IF; lamp := y;",
        "n := 1; n := n + 1; n := n * 2;",
        "t.IN := x; t(PT := T#1s); t.IN := y;",
        "IF x THEN lamp := TRUE; ELSE lamp := FALSE; END_IF;",
        "%QX1.0 := x; y := %QX1.0; %QX1.0 := q;",
    ]);
}

#[test]
fn what_a_pointer_or_another_unit_may_read_is_not_overwritten() {
    let text = "VAR_GLOBAL g : INT; END_VAR
FUNCTION Peek : INT Peek := g; END_FUNCTION
PROGRAM P VAR n, m : INT; p : POINTER TO INT; END_VAR
p := ADR(n);
n := 1; m := p^; n := 2;
g := m; m := Peek(); g := n;
END_PROGRAM";
    assert_eq!(findings_in(Dialect::Codesys, text).to_string(), "");
}

#[test]
fn one_coil_twice_in_a_ladder() {
    let rung = |contact: &str, at: u32| {
        format!(
            "<leftPowerRail localId=\"{at}0\"><position x=\"0\" y=\"{at}0\"/><connectionPointOut formalParameter=\"\"/></leftPowerRail>
             <contact localId=\"{at}1\"><position x=\"30\" y=\"{at}0\"/><connectionPointIn><connection refLocalId=\"{at}0\"/></connectionPointIn>
             <connectionPointOut/><variable>{contact}</variable></contact>
             <coil localId=\"{at}2\"><position x=\"60\" y=\"{at}0\"/><connectionPointIn><connection refLocalId=\"{at}1\"/></connectionPointIn>
             <connectionPointOut/><variable>lamp</variable></coil>"
        )
    };
    let variable = |name: &str| format!("<variable name=\"{name}\"><type><BOOL/></type></variable>");
    let text = format!(
        "<project xmlns=\"http://www.plcopen.org/xml/tc6_0201\"><types><dataTypes/><pous><pou name=\"P\" pouType=\"program\">
         <interface><localVars>{}{}</localVars><outputVars>{}</outputVars></interface>
         <body><LD>{}{}</LD></body></pou></pous></types></project>",
        variable("a"),
        variable("b"),
        variable("lamp"),
        rung("a", 1),
        rung("b", 2)
    );
    let input = onescan_iec::Input::from_text("p.xml", onescan_iec::input::kind::SourceKind::PlcOpen, text);
    let found = onescan_iec::inspect([input], None);
    let codes: Vec<_> = found.iter().map(|each| (each.code.text(), each.message.as_str())).collect();
    assert_eq!(codes, [("W0725", "output `lamp` is assigned to twice, and nothing reads the first value")]);
}

#[test]
fn one_output_with_two_names() {
    let two = |first: &str, second: &str| {
        let text = format!(
            "PROGRAM A VAR one AT {first} : BOOL; END_VAR one := NOT one; END_PROGRAM
PROGRAM B VAR two AT {second} : BOOL; END_VAR two := NOT two; END_PROGRAM"
        );
        findings_in(Dialect::Iec3, &text).to_string()
    };
    insta::assert_snapshot!(two("%QX0.0", "%Q0.0"), @"test.st:2:15: warning[W0726]: `two` lies at %Q0.0 as `one` does, and both are written: the last one wins (give one of them another address, or let one variable have the output)");
    assert_eq!(two("%QX0.0", "%QX0.1"), "");
    assert_eq!(two("%MX0.0", "%MX0.0"), "");
    let read = "PROGRAM A VAR one AT %QX0.0 : BOOL; END_VAR one := NOT one; END_PROGRAM
PROGRAM B VAR two AT %QX0.0 : BOOL; n : BOOL; END_VAR n := two; END_PROGRAM";
    assert!(!findings_in(Dialect::Iec3, read).to_string().contains("W0726"));
}

#[test]
fn one_output_that_two_programs_write() {
    let said = |first: &str, second: &str| {
        let text = format!(
            "PROGRAM A VAR x, y : BOOL; END_VAR {first} x := y; END_PROGRAM
PROGRAM B VAR x, y : BOOL; END_VAR {second} x := y; END_PROGRAM"
        );
        findings_in(Dialect::Iec3, &text).to_string()
    };
    insta::assert_snapshot!(said("%QX0.0 := y;", "%Q0.0 := NOT y;"), @"test.st:2:36: warning[W0726]: output `%Q0.0` is written by each call of `B` and of `A`: the last one wins (let one of them write it, and the others ask that one by variables of their own)");
    assert_eq!(said("%QX0.0 := y;", "IF x THEN %QX0.0 := y; END_IF;"), "");
    assert_eq!(said("%QX0.0 := y;", "%QX0.1 := y;"), "");
    let global = "VAR_GLOBAL lamp AT %QX0.0 : BOOL; END_VAR
PROGRAM A VAR_EXTERNAL lamp : BOOL; END_VAR lamp := TRUE; END_PROGRAM
PROGRAM B VAR_EXTERNAL lamp : BOOL; END_VAR lamp := FALSE; END_PROGRAM";
    let found = findings_in(Dialect::Iec3, global).to_string();
    assert!(found.contains("W0707") && found.lines().count() == 1, "{found}");
}

#[test]
fn conditions_that_are_constant_and_assignments_to_oneself() {
    insta::assert_snapshot!(all(
        Dialect::Iec3,
        &[
            "IF TRUE THEN n := 1; END_IF;",
            "IF x THEN n := 1; ELSIF NOT (TRUE) THEN n := 2; END_IF;",
            "WHILE FALSE DO n := 1; END_WHILE;",
            "n := n;",
            "t.IN := T.in;"
        ]
    ));
    quiet(&["REPEAT n := n + 1; UNTIL TRUE END_REPEAT;", "IF x = TRUE THEN n := 1; END_IF;", "n := i;"]);
}

#[test]
fn products_that_fit_are_not_cut() {
    let said = |body: &str| {
        let head = "PROGRAM P VAR raw : INT; small : SINT; d : DINT; l : LINT; END_VAR VAR CONSTANT K, L : INT := 100; END_VAR\n";
        findings_in(Dialect::Iec3, &format!("{head}{body}\nEND_PROGRAM")).to_string().matches("W0713").count()
    };
    for quiet in [
        "d := K * L;",
        "d := K * 2;",
        "d := raw * 1;",
        "d := SINT_TO_INT(small) * 100;",
        "l := INT_TO_DINT(raw) * 1000;",
    ] {
        assert_eq!(said(quiet), 0, "{quiet}");
    }
    for cut in [
        "d := raw * K;",
        "d := raw * 1000;",
        "d := ABS(raw * 1000);",
        "d := MAX(raw * 1000, 5);",
        "d := MIN(5, raw * 2) / 2;",
    ] {
        assert_eq!(said(cut), 1, "{cut}");
    }
}

#[test]
fn a_counter_that_wraps() {
    let at = |ty: &str, body: &str| {
        let text = format!("PROGRAM P VAR n : {ty}; m : {ty}; x, q : BOOL; END_VAR {body} END_PROGRAM");
        let plan = onescan_iec::TaskPlan::new(vec![crate::rig::task("main", 1000, 0, &["p"])]);
        let input = onescan_iec::Input::from_text("test.st", onescan_iec::input::kind::SourceKind::Text, text);
        let found = onescan_iec::inspect([input.in_dialect(Dialect::Codesys)], Some(&plan));
        let found: Vec<_> = found.iter().filter(|each| each.code == onescan_iec::Code::CounterWraps).collect();
        found.first().map_or_else(String::new, |each| each.message.clone())
    };
    assert_eq!(
        at("INT", "n := n + 1; x := n > 100;"),
        "`n` grows in each scan and is never set back: after 9 h 6 min it goes from 32767 to -32768"
    );
    assert_eq!(at("DINT", "n := n + 1; x := n > 100;"), "");
    for quiet in [
        "n := n + 1; m := n;",
        "n := n + 1; IF n > 100 THEN n := 0; END_IF;",
        "IF n < 100 THEN n := n + 1; END_IF; x := n > 5;",
        "IF q THEN RETURN; END_IF; n := n + 1; x := n > 5;",
        "n := m + 1; x := n > 5;",
    ] {
        assert_eq!(at("INT", quiet), "", "{quiet}");
    }
    assert_eq!(at("UINT", "n := n + 1; x := n > 100;"), "");
}

#[test]
fn unsigned_results_and_numbers_that_are_compared() {
    insta::assert_snapshot!(all(
        Dialect::Iec3,
        &["x := u - b < 0;", "x := u + u >= 0;", "IF 1 = 1 THEN n := i; END_IF;", "IF (2 < 1) THEN n := i; END_IF;"]
    ));
    assert_ne!(said(Dialect::Codesys, "x := u - b < 0;"), "");
    quiet(&["x := i - n < 0;", "IF i = 1 THEN n := i; END_IF;", "x := ten = 10;"]);
}

#[test]
fn outputs_that_have_bits_in_common() {
    let found = |addresses: [&str; 2]| {
        let [one, two] = addresses;
        let ty = |at: &str| match at.as_bytes().get(2) {
            Some(b'W') => ("WORD", "0"),
            Some(b'B') => ("BYTE", "0"),
            _ => ("BOOL", "FALSE"),
        };
        let ((first, low), (second, zero)) = (ty(one), ty(two));
        let text = format!(
            "PROGRAM P VAR a AT {one} : {first}; b AT {two} : {second}; END_VAR a := {low}; b := {zero}; END_PROGRAM"
        );
        findings_in(Dialect::Iec3, &text).to_string().contains("W0726")
    };
    for (addresses, shared) in [
        (["%QW0", "%QB1"], true),
        (["%QW0", "%QB2"], false),
        (["%QW0", "%QX1.3"], true),
        (["%QX1.3", "%QX1.4"], false),
        (["%QB1", "%QX1.0"], true),
        (["%QX0.0", "%Q0.0"], true),
    ] {
        assert_eq!(found(addresses), shared, "{addresses:?}");
    }
}

#[test]
fn a_step_of_zero_is_an_error() {
    for dialect in [Dialect::Iec3, Dialect::Codesys] {
        for step in ["0", "none", "ten - 10"] {
            let found = said(dialect, &format!("FOR i := 1 TO 3 BY {step} DO n := n + 1; END_FOR;"));
            assert!(found.contains("error[T0211]"), "{dialect}: {found}");
        }
    }
    quiet(&["FOR i := 1 TO 3 BY 1 DO n := n + 1; END_FOR;"]);
}

#[test]
fn a_counter_that_selects() {
    let text = "PROGRAM P VAR n : INT; b : BOOL; END_VAR n := n + 1; CASE n OF 1..5: b := TRUE; ELSE b := FALSE; END_CASE;
        END_PROGRAM CONFIGURATION C TASK t(INTERVAL := T#10ms, PRIORITY := 0); PROGRAM p1 WITH t : P; END_CONFIGURATION";
    assert!(findings_in(Dialect::Iec3, text).to_string().contains("W0729"));
}

#[test]
fn literals_beside_integers() {
    assert_eq!(said(Dialect::Codesys, "r := i * 2.0 + 1.0;"), "");
    assert_ne!(said(Dialect::Codesys, "r := d * 2.0;"), "");
    assert_ne!(said(Dialect::Codesys, "r := l * 2.0;"), "");
    let found = said(Dialect::Iec3, "r := i * 2.0;");
    assert!(found.contains("`REAL#` before it makes it a REAL"), "{found}");
}

#[test]
fn enumerations_with_attributes() {
    let found = |statement: &str| {
        let text = format!(
            "{{attribute 'qualified_only'}}\nTYPE Far : (off, on); END_TYPE
            {{attribute 'strict'}}\nTYPE Mode : (idle, busy := 5); END_TYPE\nTYPE Free : (one, two); END_TYPE
            PROGRAM P VAR f : Far; m, m2 : Mode; g : Free; i : INT; END_VAR {statement} END_PROGRAM"
        );
        let found = findings_in(Dialect::Codesys, &text).to_string();
        found.lines().filter_map(|line| line.split("error[").nth(1)?.split(']').next()).collect::<Vec<_>>().join(" ")
    };
    for statement in [
        "f := Far.on;",
        "m := busy;",
        "m := 5;",
        "m := m2;",
        "i := m;",
        "g := 7;",
        "g := i;",
        "i := g + 1;",
        "i := f + 1;",
        "i := i + busy;",
        "CASE m OF 0: i := 1; 7: i := 2; END_CASE",
    ] {
        assert_eq!(found(statement), "", "{statement}");
    }
    assert_eq!(found("f := on;"), "N0108");
    assert_eq!(found("IF f = off THEN i := 1; END_IF"), "N0108");
    for statement in ["m := 6;", "m := i;", "i := m + 1;", "m := g;", "m := m + 1;"] {
        assert_eq!(found(statement), "T0212", "{statement}");
    }
}

#[test]
fn a_bit_has_no_other_name() {
    let found = findings_in(Dialect::Codesys, "TYPE A : BIT; END_TYPE").to_string();
    assert!(found.contains("D0407"), "{found}");
}
