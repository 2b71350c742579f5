use proptest::prelude::*;

use super::*;
use crate::syntax::printer::{print_expression, print_unit};
use crate::syntax::token::TokenKind;

const FILE: FileId = FileId(0);

fn reparse(text: &str) -> (String, Vec<Diagnostic>) {
    let parsed = parse(FILE, text);
    (print_unit(&parsed.unit), parsed.diagnostics)
}

#[test]
fn a_printed_unit_parses_to_itself() {
    let text = "
        TYPE U : UNION a : INT; b : BYTE := 3; END_UNION; END_TYPE
        FUNCTION o VAR_IN_OUT a : ARRAY [*, *] OF INT; END_VAR END_FUNCTION
        TYPE N : STRUCT next : REF_TO N; p : POINTER TO ARRAY [0..1] OF REFERENCE TO INT := NULL; END_STRUCT; END_TYPE
        TYPE T : STRUCT a, b : INT := 5; c : ARRAY [0..1, 2..3] OF REAL; END_STRUCT END_TYPE
        TYPE C : (Red, Green := 5); R : INT (0..10) := 3; E : (One := 1, Two) USINT := Two; F : DINT (Three); END_TYPE
        VAR_GLOBAL RETAIN g AT %MW1 : T := (a := 1, c := [1.0, 3(2.5)]); END_VAR
        FUNCTION f : INT VAR_INPUT x : INT; END_VAR f := -x ** 2 + 1; END_FUNCTION
        FUNCTION_BLOCK e VAR_INPUT c : BOOL R_EDGE; d : BOOL F_EDGE := TRUE; END_VAR END_FUNCTION_BLOCK
        PROGRAM p VAR i : INT; t : TON; END_VAR
          IF i = 1 AND NOT (i > 2) THEN i := f(1); ELSIF TRUE THEN ; ELSE RETURN; END_IF;
          CASE i OF 1, 2..3: i := 4; i := 5; C#Red: ; ELSE i := 6; END_CASE;
          FOR i := 1 TO 10 BY 2 DO CONTINUE; END_FOR;
          WHILE i < 3 DO EXIT; END_WHILE; REPEAT i := i + 1; UNTIL i > 5 END_REPEAT;
          d ?= e.f(1).g(x => y); c := a.b.C#Red; THIS^.m(); SUPER^(); SUPER.m(a := THIS);
          t(IN := TRUE, PT := T#1.5s, Q => b, NOT Q => c); a[1, 2].b := LREAL#1.0e-7 * 16#FF;
          %QX0.1 := %IX0.0 AND %MD3.%X31; r REF= a^.b[1]^.c; r ?= REF(x^); p^(IN := q^[1].%X1); w.%B1 := w.3 OR a[1].w.%W0;
        END_PROGRAM
        ACTION a1: i := 1; END_ACTION
        INTERFACE I1 EXTENDS I2, n.I3 METHOD m : INT VAR_INPUT x : INT; END_VAR END_METHOD
          PROPERTY p : REAL GET END_GET SET END_SET END_PROPERTY END_INTERFACE
        CLASS ABSTRACT C1 EXTENDS n.m.C0 IMPLEMENTS I1, I2
          VAR PRIVATE CONSTANT a : INT := 1; END_VAR VAR PUBLIC public, method : INT; END_VAR
          METHOD PROTECTED ABSTRACT m END_METHOD
          METHOD PUBLIC OVERRIDE FINAL n : INT VAR x : INT; END_VAR n := method; method := 1; END_METHOD
        END_CLASS
        FUNCTION_BLOCK FINAL F1 EXTENDS F0 METHOD PRIVATE m END_METHOD METHOD PUBLIC OVERRIDE; SUPER.m(); END_METHOD x := 1; END_FUNCTION_BLOCK
        METHOD m2 : BOOL m2 := TRUE; END_METHOD
        PROPERTY INTERNAL p : INT GET VAR y : INT; END_VAR p := y; END_GET SET y := p; END_SET END_PROPERTY
        TYPE S2 EXTENDS S1 : STRUCT a : INT; END_STRUCT; S3 : STRUCT EXTENDS n.S2 b : INT; END_STRUCT; END_TYPE
        NAMESPACE INTERNAL a.b USING c, d.e; VAR_GLOBAL g : d.T; END_VAR NAMESPACE OPEN c END_NAMESPACE END_NAMESPACE
        USING a.b;
        FUNCTION g : INT USING a; VAR x : a.T; END_VAR g := a.f(x); END_FUNCTION";
    let (once, diagnostics) = reparse(text);
    assert_eq!(diagnostics, []);
    let (twice, diagnostics) = reparse(&once);
    assert_eq!(diagnostics, []);
    assert_eq!(once, twice);
}

#[test]
fn iec2_2_7_a_printed_configuration_parses_to_itself() {
    let text = "
        configuration Cell var_global a, b : INT; c : BOOL; end_var
          Resource Line ON Soft VAR_GLOBAL RETAIN PERSISTENT w AT %MW1 : INT := 3; END_VAR VAR_GLOBAL END_VAR
            TASK fast (INTERVAL := T#10ms, PRIORITY := 1); TASK edge(SINGLE := c, PRIORITY := 2);
            PROGRAM RETAIN p1 WITH fast : Pump (level := a, on => c, deep.x[1] := 2 + 3, fb WITH edge);
            PROGRAM NON_RETAIN p2 : Pump; PROGRAM p3 : Pump();
          END_RESOURCE
          RESOURCE Empty ON Soft END_RESOURCE;
          VAR_ACCESS one : Line.p1.level : INT READ_WRITE; two : Line.w : INT; three : %IX1.0 : BOOL READ_ONLY; END_VAR
          VAR_CONFIG Line.p1.fb.k AT %QW3 : INT := 5; Line.p1.t[2] : TON := (PT := T#1s); END_VAR
        END_CONFIGURATION
        CONFIGURATION Small TASK t (INTERVAL := T#1s); PROGRAM p WITH t : Pump; END_CONFIGURATION
        PROGRAM Task VAR on, with, configuration, resource : BOOL; persistent : INT; END_VAR
        VAR PERSISTENT task : INT; END_VAR on := task = 1; END_PROGRAM";
    let (once, first) = reparse(text);
    assert_eq!(first, []);
    let (twice, diagnostics) = reparse(&once);
    assert_eq!(diagnostics, []);
    assert_eq!(once, twice);
    insta::assert_snapshot!(once);
}

#[test]
fn iec2_2_7_one_slip_in_a_configuration_makes_one_diagnostic() {
    for slip in [
        "TASK (INTERVAL := T#1s);",
        "TASK t INTERVAL := T#1s;",
        "TASK t (INTERVAL = T#1s);",
        "TASK t (INTERVAL := T#1s)",
        "PROGRAM : P;",
        "PROGRAM p WITH : P;",
        "PROGRAM p P;",
        "PROGRAM p : P (a b);",
        "RESOURCE r END_RESOURCE",
        "RESOURCE r ON x nonsense; END_RESOURCE",
        "VAR_ACCESS a INT; END_VAR",
        "VAR_CONFIG a.b := 5; END_VAR",
        "nonsense here;",
    ] {
        let text = format!(
            "CONFIGURATION c {slip}\nTASK u (INTERVAL := T#1s);\nPROGRAM q WITH u : P;\nEND_CONFIGURATION
            PROGRAM P VAR x : INT; END_VAR x := 1; END_PROGRAM"
        );
        let found = parse(FILE, &text).diagnostics;
        assert_eq!(found.len(), 1, "{slip}: {found:#?}");
    }
}

#[test]
fn a_printed_unit_of_a_vendor_parses_to_itself() {
    let texts = [
        (
            Dialect::Codesys,
            "PROGRAM p VAR_STAT n : INT; END_VAR a := b := c; a S= b; a R= b OR_ELSE c AND_THEN d;
             IF a THEN b := 1; END_IF END_PROGRAM",
        ),
        (
            Dialect::SiemensScl,
            "TYPE \"my type\" VERSION : 0.1 STRUCT \"a b\" : Int; END_STRUCT; END_TYPE
             DATA_BLOCK \"my data\" STRUCT x : Array[0..1] of \"my type\"; y : Int; END_STRUCT; BEGIN y := 3; END_DATA_BLOCK
             FUNCTION \"f\" : Void VAR_INPUT \"in put\" : Int; END_VAR BEGIN #\"in put\" += W#16#F; END_FUNCTION
             ORGANIZATION_BLOCK \"Main\" BEGIN \"f\"(\"in put\" := \"my data\".x[0].\"a b\"); #t.TON(IN := \"y\"); END_ORGANIZATION_BLOCK",
        ),
    ];
    for (dialect, text) in texts {
        let once = parse_in(dialect, FILE, text);
        assert_eq!(once.diagnostics, [], "{text}");
        let printed = print_unit(&once.unit);
        let twice = parse_in(dialect, FILE, &printed);
        assert_eq!(twice.diagnostics, [], "{printed}");
        assert_eq!(print_unit(&twice.unit), printed);
    }
}

#[test]
fn one_caret_behind_the_object_is_part_of_its_name() {
    for (written, printed) in
        [("THIS^.x", "THIS^.x"), ("THIS.x", "THIS.x"), ("SUPER^^^.x", "SUPER^^^.x"), ("p^^.x", "p^^.x")]
    {
        let (text, diagnostics) = reparse(&format!("PROGRAM p y := {written}; END_PROGRAM"));
        assert_eq!(diagnostics, []);
        assert!(text.contains(&format!("y := {printed};")), "{text}");
    }
}

#[test]
fn a_part_is_printed_as_it_was_written_whatever_number_it_is() {
    for written in ["x.3", "x.%B1", "x.1_0", "x.16#00"] {
        let (text, diagnostics) = reparse(&format!("PROGRAM p y := {written}; END_PROGRAM"));
        assert_eq!(diagnostics, []);
        assert!(text.contains(&format!("y := {written};")), "{text}");
    }
}

#[test]
fn operators_bind_as_table_52_says() {
    let shape = |text: &str| {
        let parsed = parse(FILE, &format!("PROGRAM p x := {text}; END_PROGRAM"));
        assert_eq!(parsed.diagnostics, [], "{text}");
        format!("{:?}", strip(&parsed.unit))
    };
    for (short, full) in [
        ("a OR b XOR c AND d", "a OR (b XOR (c AND d))"),
        ("a = b < c", "a = (b < c)"),
        ("a + b * c", "a + (b * c)"),
        ("a - b - c", "(a - b) - c"),
        ("-a ** b", "(-a) ** b"),
        ("a ** -b ** c", "(a ** (-b)) ** c"),
        ("a ** b ** c", "(a ** b) ** c"),
        ("NOT a AND b", "(NOT a) AND b"),
        ("a * -b", "a * (-b)"),
        ("a & b = c", "a AND (b = c)"),
    ] {
        assert_eq!(shape(short), shape(full), "{short}");
    }
}

/// The tree's text with every operation in parentheses.
fn strip(unit: &CompilationUnit) -> String {
    use crate::syntax::ast::{Declaration, Expr, ExprKind, StatementKind};
    fn full(expr: &Expr) -> String {
        match &expr.kind {
            ExprKind::Paren(inner) => full(inner),
            ExprKind::Unary(operator, a) => format!("({operator:?} {})", full(a)),
            ExprKind::Binary(operator, a, b) => format!("({} {operator:?} {})", full(a), full(b)),
            _ => print_expression(expr),
        }
    }
    let Some(Declaration::Pou(pou)) = unit.declarations.first() else {
        return String::new();
    };
    match &pou.body[0].kind {
        StatementKind::Assign(_, value) => full(value),
        _ => String::new(),
    }
}

#[test]
fn one_slip_makes_one_diagnostic() {
    let body = |text: &str| {
        let text = format!("PROGRAM p VAR a : INT; END_VAR\n{text}\na := 1;\nEND_PROGRAM");
        parse(FILE, &text).diagnostics
    };
    for slip in [
        "a := ;",
        "a := 1 + ;",
        "a = 1;",
        "a := 1",
        "IF a > 1 a := 2; END_IF;",
        "IF a > THEN a := 2; END_IF;",
        "FOR a := 1 TO DO a := 2; END_FOR;",
        "CASE a OF 1 a := 2; 2: a := 3; END_CASE;",
        "a := (1 + 2;",
        "a[1 := 2;",
        ") a := 2;",
        "WHILE a < 1 a := 2; END_WHILE;",
        "END_IF;",
        "a := 3 ? 4;",
        "f(1, , 2);",
        "a := 12#5;",
    ] {
        assert_eq!(body(slip).len(), 1, "{slip}: {:#?}", body(slip));
    }
}

#[test]
fn depth_is_bounded_and_reported() {
    let deep = |open: &str, close: &str| {
        let (open, close) = (open.repeat(50_000), close.repeat(50_000));
        parse(FILE, &format!("PROGRAM p {open} x {close} END_PROGRAM"))
    };
    for (open, close) in [("(", ")"), ("IF a THEN ", "END_IF;"), ("NOT ", ""), ("a[", "]"), ("f(", ")")] {
        let codes: Vec<_> = deep(open, close).diagnostics.iter().map(|found| found.code).collect();
        assert_eq!(codes, [Code::NestingTooDeep], "{open}");
    }
    let chain = format!("PROGRAM p x := 1{}; END_PROGRAM", "+1".repeat(100_000));
    assert_eq!(parse(FILE, &chain).diagnostics, [], "a row is long, and not deep");
    let members = format!("PROGRAM p x := a{}; END_PROGRAM", ".b".repeat(100_000));
    assert_eq!(parse(FILE, &members).diagnostics[0].code, Code::NestingTooDeep);
    let arrays = format!("VAR_GLOBAL x : {} INT; END_VAR", "ARRAY [0..1] OF ".repeat(10_000));
    assert_eq!(parse(FILE, &arrays).diagnostics[0].code, Code::NestingTooDeep);
}

fn arbitrary_expression() -> impl Strategy<Value = String> {
    let leaf = prop_oneof![
        "[a-e]".prop_map(String::from),
        (0_u32..1000).prop_map(|value| value.to_string()),
        Just("1.5e-3".to_owned()),
        Just("T#1s".to_owned()),
        Just("INT#-5".to_owned()),
        Just("TRUE".to_owned()),
    ];
    leaf.prop_recursive(6, 60, 3, |inner| {
        let operator =
            prop::sample::select(vec!["+", "-", "*", "/", "MOD", "**", "AND", "OR", "XOR", "&", "=", "<>", "<", ">="]);
        prop_oneof![
            (inner.clone(), operator, inner.clone()).prop_map(|(a, op, b)| format!("{a} {op} {b}")),
            inner.clone().prop_map(|a| format!("({a})")),
            inner.clone().prop_map(|a| format!("NOT {a}")),
            inner.clone().prop_map(|a| format!("-{a}")),
            (inner.clone(), inner.clone()).prop_map(|(a, b)| format!("f(x := {a}, y => q.r[{b}])")),
            (inner.clone(), inner).prop_map(|(a, b)| format!("g({a}, {b}).z")),
        ]
    })
}

proptest! {
    #[test]
    fn printing_and_parsing_are_inverse(text in arbitrary_expression()) {
        let text = format!("PROGRAM p x := {text}; END_PROGRAM");
        let parsed = parse(FILE, &text);
        prop_assume!(parsed.diagnostics.is_empty());
        let printed = print_unit(&parsed.unit);
        let again = parse(FILE, &printed);
        prop_assert_eq!(&again.diagnostics, &[]);
        prop_assert_eq!(strip(&parsed.unit), strip(&again.unit));
        prop_assert_eq!(printed, print_unit(&again.unit));
    }

    #[test]
    fn any_text_gives_a_tree(text in "\\PC{0,300}") {
        parse(FILE, &text);
    }

    #[test]
    fn any_tokens_give_a_tree(words in prop::collection::vec(prop::sample::select(vec![
        "PROGRAM", "END_PROGRAM", "FUNCTION", "VAR", "END_VAR", "TYPE", "STRUCT", "END_STRUCT",
        "IF", "THEN", "ELSE", "END_IF", "CASE", "OF", "END_CASE", "FOR", "TO", "BY", "DO",
        "END_FOR", "REPEAT", "UNTIL", "a", "b", "1", "2.5", ":=", ":", ";", ",", "(", ")", "[",
        "]", "..", "+", "-", "NOT", "AND", "=>", ".", "T#1s", "ARRAY", "INT", "%IX1", "'s'",
        "STEP", "END_STEP", "INITIAL_STEP", "TRANSITION", "FROM", "END_TRANSITION", "ACTION", "END_ACTION",
    ]), 0..120)) {
        let text = words.join(" ");
        let parsed = parse(FILE, &text);
        let tokens = parsed.tokens.iter().filter(|token| token.kind != TokenKind::Whitespace);
        prop_assert_eq!(tokens.count(), words.len());
    }
}

#[test]
fn iec2_b_1_6_charts_are_printed_as_what_they_are() {
    let text = "PROGRAM P
        INITIAL_STEP A: END_STEP
        STEP B: x(); y(N); z(D, T#1s + t, done, all.done); END_STEP;
        TRANSITION FROM A TO B := x; END_TRANSITION
        TRANSITION t1 (PRIORITY := 1_0) FROM (A, B) TO (B, A) := x AND y END_TRANSITION
        TRANSITION (PRIORITY := 2) FROM A TO B : IF x THEN t := TRUE; END_IF; END_TRANSITION
        ACTION z: x := NOT x; END_ACTION
        END_PROGRAM";
    let parsed = parse(FILE, text);
    assert_eq!(parsed.diagnostics, []);
    let printed = print_unit(&parsed.unit);
    let again = parse(FILE, &printed);
    assert_eq!(again.diagnostics, [], "{printed}");
    assert_eq!(printed, print_unit(&again.unit));
    let spans_aside = |unit: &CompilationUnit| {
        let text = format!("{unit:?}");
        text.split("Span {")
            .map(|part| part.split_once('}').map_or(part, |(_, rest)| rest).to_owned())
            .collect::<Vec<_>>()
    };
    let Some(crate::syntax::ast::Declaration::Pou(pou)) = again.unit.declarations.first() else { panic!("a unit") };
    assert_eq!((pou.chart.steps.len(), pou.chart.transitions.len(), pou.body.len()), (2, 3, 0));
    assert_eq!(spans_aside(&parsed.unit), spans_aside(&again.unit));
}

#[test]
fn charts_do_not_cost_the_stack() {
    let deep = format!("PROGRAM p STEP a: x(D, {}1{}); END_STEP END_PROGRAM", "(".repeat(50_000), ")".repeat(50_000));
    assert_eq!(parse(FILE, &deep).diagnostics[0].code, Code::NestingTooDeep);
    let open = "PROGRAM p ".to_owned() + &"INITIAL_STEP a: TRANSITION FROM (a TO ".repeat(2_000);
    assert!(!parse(FILE, &open).diagnostics.is_empty());
}
