//! Character strings (2nd ed. 2.2.2, 2.3.1, 2.5.1.5.5).

use crate::rig::{Rig, findings, result};

/// A program's string variables after one scan.
fn texts(declarations: &str, statements: &str, names: &[&str]) -> Vec<String> {
    let rig = result(declarations, statements);
    names.iter().map(|name| rig.text(&format!("P.{name}"))).collect()
}

/// The value of a string expression.
fn text(declarations: &str, expression: &str) -> String {
    texts(&format!("{declarations} r : STRING[200];"), &format!("r := {expression};"), &["r"]).remove(0)
}

fn int(declarations: &str, expression: &str) -> i64 {
    result(&format!("{declarations} r : INT;"), &format!("r := {expression};")).int("P.r")
}

fn bool(declarations: &str, expression: &str) -> bool {
    result(&format!("{declarations} r : BOOL;"), &format!("r := {expression};")).bool("P.r")
}

#[test]
fn iec2_2_3_1_table_10_a_string_is_a_count_and_characters() {
    let rig =
        result("a : STRING[4] := 'xy'; b : WSTRING[3] := \"xy\"; c : STRING; d : ARRAY [1..2] OF STRING[3];", ";");
    assert_eq!(rig.memory_of("P.a"), [2, 0, b'x', b'y', 0, 0]);
    assert_eq!(rig.memory_of("P.b"), [2, 0, b'x', 0, b'y', 0, 0, 0]);
    assert_eq!(rig.variable("P.c").size, 82);
    assert_eq!(rig.variable("P.c").type_name, "STRING[80]");
    assert_eq!((rig.variable("P.d").size, rig.variable("P.d[2]").size), (10, 5));
}

#[test]
fn iec2_2_4_3_2_assignment_cuts_off_and_clears_behind() {
    let rig = result(
        "a : STRING[3] := 'zzz'; b : STRING[9] := '12345'; c : STRING[9] := 'zzzzzzzzz';",
        "a := b; c := b; b := '';",
    );
    assert_eq!(rig.memory_of("P.a"), b"\x03\x00123");
    assert_eq!(rig.memory_of("P.c"), b"\x05\x0012345\0\0\0\0");
    assert_eq!(rig.memory_of("P.b"), [0; 11]);
}

#[test]
fn iec2_2_2_2_literals() {
    assert_eq!(text("", "'a$'b$$c$41$R$L'"), "a'b$cA\r\n");
    assert_eq!(text("", "STRING#'typed'"), "typed");
    assert_eq!(texts("r : WSTRING;", "r := WSTRING#\"$20ac\";", &["r"]), ["\u{20ac}"]);
}

#[test]
fn iec2_2_5_1_5_5_table_29_string_functions() {
    for (expression, wanted) in [
        ("LEFT(IN := 'ASTR', L := 3)", "AST"),
        ("RIGHT(IN := 'ASTR', L := 3)", "STR"),
        ("MID(IN := 'ASTR', L := 2, P := 2)", "ST"),
        ("CONCAT('AB', 'CD', 'E')", "ABCDE"),
        ("INSERT(IN1 := 'ABC', IN2 := 'XY', P := 2)", "ABXYC"),
        ("DELETE(IN := 'ABXYC', L := 2, P := 3)", "ABC"),
        ("REPLACE(IN1 := 'ABCDE', IN2 := 'X', L := 2, P := 3)", "ABXE"),
        ("CONCAT(CONCAT('a', 'b'), LEFT('cd', 1))", "abc"),
        ("REPLACE(IN1 := 'ABCDE', IN2 := '', L := 5, P := 1)", ""),
        ("INSERT('ABC', 'XY', 0)", "XYABC"),
        ("INSERT('ABC', 'XY', 3)", "ABCXY"),
    ] {
        assert_eq!(text("", expression), wanted, "{expression}");
    }
    assert_eq!(int("", "LEN('ASTRING')"), 7);
    assert_eq!(int("s : STRING[5];", "LEN(s)"), 0);
    assert_eq!(int("", "FIND(IN1 := 'ABCBC', IN2 := 'BC')"), 2);
    assert_eq!(int("", "FIND('ABC', 'D') + FIND('ABC', '') + FIND('A', 'AB')"), 0);
}

#[test]
fn iec2_annex_e_positions_and_lengths_out_of_range() {
    for (expression, wanted) in [
        ("LEFT('ABC', -1)", ""),
        ("LEFT('ABC', 9)", "ABC"),
        ("RIGHT('ABC', 9)", "ABC"),
        ("MID('ABC', 9, 2)", "BC"),
        ("MID('ABC', 1, 0)", ""),
        ("MID('ABC', 1, 4)", ""),
        ("MID('ABC', -1, 1)", ""),
        ("INSERT('ABC', 'X', 4)", "ABC"),
        ("INSERT('ABC', 'X', -1)", "ABC"),
        ("DELETE('ABC', 1, 0)", "ABC"),
        ("DELETE('ABC', 9, 2)", "A"),
        ("DELETE('ABC', -5, 2)", "ABC"),
        ("REPLACE('ABC', 'X', 1, 4)", "ABC"),
        ("REPLACE('ABC', 'X', 9, 2)", "AX"),
    ] {
        assert_eq!(text("", expression), wanted, "{expression}");
    }
}

#[test]
fn iec2_2_5_1_5_4_selection_and_comparison_of_strings() {
    assert!(bool("a, b : STRING[9] := 'abc';", "a = b AND a >= 'ab' AND a < 'abd' AND a <> 'ABC' AND a <= b"));
    assert!(bool("a : STRING[3] := 'Z'; b : STRING[9] := 'a';", "GT('b', b, a) AND NOT (a > b)"));
    assert!(bool("", "'$FF' > 'a' AND '' < 'a' AND \"$0100\" > \"$00FF\""));
    assert_eq!(text("", "MAX('b', 'abc', 'c') "), "c");
    assert_eq!(text("s : STRING[2] := 'zz';", "MIN(s, 'abc')"), "abc");
    assert_eq!(text("s : STRING[2] := 'm';", "LIMIT('n', s, 'q')"), "n");
    assert_eq!(text("s : STRING[2] := 'm'; g : BOOL := TRUE;", "SEL(g, s, 'long text')"), "long text");
    assert_eq!(text("s : STRING[2] := 'm'; k : INT := 2;", "MUX(k, s, 'b', 'third', 'd')"), "third");
}

#[test]
fn iec2_2_5_1_5_1_table_22_conversions_with_strings() {
    for (declarations, expression, wanted) in [
        ("x : INT := -12;", "INT_TO_STRING(x)", "-12"),
        ("x : BYTE := 16#FF;", "TO_STRING(x)", "255"),
        ("x : ULINT := 18446744073709551615;", "ULINT_TO_STRING(x)", "18446744073709551615"),
        ("x : BOOL := TRUE;", "BOOL_TO_STRING(x)", "TRUE"),
        ("x : REAL := 0.1;", "REAL_TO_STRING(x)", "0.1"),
        ("x : LREAL := -2.0E300;", "LREAL_TO_STRING(x)", "-2.0E+300"),
        ("x : TIME := T#90.5s;", "TIME_TO_STRING(x)", "T#1m30s500ms"),
        ("x : LTIME := LT#-7ns;", "LTIME_TO_STRING(x)", "LT#-7ns"),
        ("x : WSTRING[5] := \"a$20ACb\";", "WSTRING_TO_STRING(x)", "a?b"),
        ("x : INT := 5;", "CONCAT('n = ', TO_STRING(x + 1), '!')", "n = 6!"),
    ] {
        assert_eq!(text(declarations, expression), wanted, "{expression}");
    }
    assert_eq!(texts("r : WSTRING; s : STRING := 'a$E4';", "r := STRING_TO_WSTRING(s);", &["r"]), ["a\u{e4}"]);
    assert_eq!(int("s : STRING := ' -42 mm';", "STRING_TO_INT(s) + TO_INT('2')"), -40);
    let rig = result(
        "x : LREAL; y : REAL; t : TIME; b : BOOL; u : USINT; w : WORD;",
        "x := STRING_TO_LREAL('1.5e3'); y := STRING_TO_REAL('0.1'); t := STRING_TO_TIME('T#1h'); b := STRING_TO_BOOL('true');
         u := STRING_TO_USINT('300'); w := STRING_TO_WORD('16#BEEF');",
    );
    assert_eq!((rig.real("P.x"), rig.real("P.y")), (1500.0, f64::from(0.1_f32)));
    assert_eq!((rig.int("P.t"), rig.bool("P.b")), (3_600_000_000_000, true));
    assert_eq!((rig.int("P.u"), rig.int("P.w")), (255, 0xbeef));
}

#[test]
fn iec2_2_5_1_strings_go_in_and_out_of_units() {
    let text = "
        FUNCTION Greet : STRING[20] VAR_INPUT name : STRING[10]; mark : STRING[2] := '!'; END_VAR
          name := CONCAT('<', name); Greet := CONCAT('hi ', name, mark); END_FUNCTION
        FUNCTION Twice : INT VAR_IN_OUT s : STRING; END_VAR VAR_OUTPUT before : STRING; END_VAR
          before := s; s := CONCAT(s, s); Twice := LEN(s); END_FUNCTION
        FUNCTION_BLOCK Journal VAR_INPUT line : STRING[8]; END_VAR VAR_OUTPUT all : STRING[40]; END_VAR
          all := CONCAT(all, line, ';'); END_FUNCTION_BLOCK
        TYPE Item : STRUCT id : INT; name : STRING[6] := 'none'; END_STRUCT; END_TYPE
        VAR_GLOBAL CONSTANT Title : STRING[9] := 'title'; END_VAR
        PROGRAM P VAR a, b, d, e : STRING; n : INT; log : Journal; item : Item; items : ARRAY [1..3] OF Item;
          names : ARRAY [0..2] OF STRING[5] := ['a', 2('bb')]; t : STRING := Title; c : STRING[20]; END_VAR
          a := Greet('Ann', '!'); b := Greet(name := 'Bob');
          t := CONCAT(Greet('x', '?'), Greet('y', '.'));
          d := 'ab'; n := Twice(s := d, before => e);
          log(line := 'first', all => c); log(line := a);
          item.name := Title; items[2].name := names[n - 2]; names[0] := item.name;
        END_PROGRAM";
    let mut rig = Rig::new(text);
    assert_eq!(rig.text("P.t"), "title");
    rig.scan().expect("no fault");
    let found = ["a", "b", "t", "d", "e", "c", "log.all", "item.name", "items[1].name", "items[2].name", "names[0]"];
    let found = found.map(|name| rig.text(&format!("P.{name}")));
    let wanted = [
        "hi <Ann!",
        "hi <Bob!",
        "hi <x?hi <y.",
        "abab",
        "ab",
        "first;",
        "first;hi <Ann!;",
        "title",
        "none",
        "bb",
        "title",
    ];
    assert_eq!(found, wanted);
}

#[test]
fn wrong_strings_are_reported() {
    insta::assert_snapshot!(findings(
        "PROGRAM P
VAR s : STRING[5]; w : WSTRING; n : INT; a : STRING[0]; c : STRING := w; d : STRING[3] := 'abcd'; END_VAR
  s := w;
  s := \"wide\";
  s := 5;
  n := s;
  s := s + s;
  n := LEN(n);
  s := CONCAT(s, w);
  s := 'too long';
  IF s = w OR s = 1 THEN ; END_IF;
  s := '$z';
  s := LEFT(s, 1.5);
  s := STRING#\"x\";
END_PROGRAM"
    ));
}

#[test]
fn an_endless_loop_over_strings_ends() {
    let mut rig = Rig::new(
        "PROGRAM P VAR s, t : STRING[32000]; END_VAR
         WHILE LEN(s) < 40000 DO s := CONCAT(s, 'x'); t := CONCAT(s, s); END_WHILE; END_PROGRAM",
    );
    let fault = rig.scan().expect_err("never ends");
    assert_eq!(fault.kind, onescan_iec_run::FaultKind::EndlessLoop);
}

#[test]
fn whatever_stands_in_memory_a_scan_ends() {
    let mut rig = Rig::new(
        "PROGRAM P VAR a, b : STRING[5]; n : INT; END_VAR b := CONCAT(a, a); n := LEN(a) + FIND(a, 'x'); END_PROGRAM",
    );
    rig.set_bytes("P.a", &[0xff; 7]);
    rig.scan().expect("no fault");
    assert_eq!((rig.int("P.n"), rig.text("P.b").chars().count()), (5, 5));
}
