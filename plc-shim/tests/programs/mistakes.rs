//! Mistakes that people make, and what the findings advise them to write.

use std::fmt::Write;

use onescan_iec::Dialect;

use crate::rig::{findings, findings_in};

const HEAD: &str = "PROGRAM P VAR a, b, n : INT; x, q : BOOL; t : TON; d : TIME; END_VAR\n";

/// Each body with all that is said about it; the body is line 2.
fn reported(dialect: Dialect, bodies: &[&str]) -> String {
    let mut list = String::new();
    for body in bodies {
        let found = findings_in(dialect, &format!("{HEAD}{body}\nEND_PROGRAM")).to_string();
        let lines = found.lines().filter(|line| !line.contains("W0706") && !line.contains("W0702"));
        let lines: String = lines.fold(String::new(), |all, line| all + "\n    " + line);
        writeln!(list, "{body}{lines}").expect("a text");
    }
    list
}

#[test]
fn habits_of_other_languages() {
    let bodies = [
        "t(IN = q);",
        "t(IN := q, ET = d);",
        "q := TON.Q;",
        "a++;",
        "t.ET--;",
        "++a;",
        "a += 1;",
        "WHILE x DO IF q THEN break; END_IF; continue; END_WHILE;",
        "CASE a OF 1: b := 1; default: b := 2; END_CASE;",
        "CASE a OF case 1: b := 1; case 2: b := 3; END_CASE;",
        "IF a == 1 THEN b := 1; END_IF;",
        "x := !q;",
        "x := q && x;",
        "x := q || x;",
        "IF x THEN a := 1; ELSEIF q THEN a := 2; END_IF;",
        "RETURN a;",
    ];
    insta::assert_snapshot!(reported(Dialect::Iec3, &bodies));
}

#[test]
fn continue_is_younger_than_the_2nd_edition() {
    insta::assert_snapshot!(reported(Dialect::Iec2, &["WHILE x DO IF q THEN continue; END_IF; a := 1; END_WHILE;"]));
}

#[test]
fn durations_without_units() {
    insta::assert_snapshot!(reported(
        Dialect::Iec3,
        &["d := T#500;", "d := T#1.5;", "d := T#1m30;", "d := LTIME#2h15;"]
    ));
}

#[test]
fn loops_that_nothing_leaves() {
    let bodies = [
        "WHILE TRUE DO a := a + 1; END_WHILE;",
        "REPEAT a := a + 1; UNTIL FALSE END_REPEAT;",
        "WHILE NOT FALSE DO FOR n := 1 TO 3 DO EXIT; END_FOR; END_WHILE;",
        "WHILE TRUE DO IF q THEN EXIT; END_IF; END_WHILE;",
        "REPEAT CASE a OF 1: RETURN; END_CASE; UNTIL FALSE END_REPEAT;",
        "WHILE TRUE DO FOR n := 1 TO 3 DO RETURN; END_FOR; END_WHILE;",
        "WHILE x DO a := a + 1; END_WHILE;",
        "REPEAT a := 1; UNTIL TRUE END_REPEAT;",
    ];
    insta::assert_snapshot!(reported(Dialect::Iec3, &bodies));
}

#[test]
fn sizes_for_bounds() {
    let found = findings_in(
        Dialect::Iec3,
        "PROGRAM P
VAR CONSTANT k : INT := 3; END_VAR
VAR a : ARRAY[10] OF INT; b : INT[5]; c[4] : INT; d : ARRAY[k] OF INT; e : ARRAY[2, 3] OF INT; END_VAR
  a[9] := 1; b[4] := a[0]; c[1] := 2; d[2] := 1; e[1, 2] := 3;
END_PROGRAM",
    );
    insta::assert_snapshot!(found);
}

#[test]
fn a_value_behind_return() {
    let found = findings_in(
        Dialect::Iec3,
        "FUNCTION Add1 : INT
VAR_INPUT a : INT; END_VAR
  IF a > 5 THEN RETURN; END_IF;
  RETURN a + 1;
END_FUNCTION
FUNCTION_BLOCK FB
VAR a : INT; END_VAR
METHOD M : INT
  RETURN (THIS.a);
END_METHOD
  a := 1;
  RETURN -a;
END_FUNCTION_BLOCK",
    );
    insta::assert_snapshot!(found);
}

#[test]
fn keywords_for_names() {
    let found = findings_in(
        Dialect::Iec3,
        "FUNCTION F : INT VAR_INPUT by : INT; END_VAR F := by; END_FUNCTION
PROGRAM P VAR at : INT; if : BOOL; mod AT %MW2 : INT; END_VAR at := mod; END_PROGRAM",
    );
    insta::assert_snapshot!(found);
}

/// What beginners of the language write, and people who come from another one: the message names what mends it.
#[test]
fn slips_of_beginners_are_mended() {
    let body = |declared: &str, text: &str| findings(&format!("PROGRAM P VAR {declared} END_VAR\n{text}\nEND_PROGRAM"));
    let all = [
        body("t : TON; q : BOOL;", "t(IN := q, PT := T#1s, Q := q);"),
        body("a : INT;", "IF a = 1 THEN a := 2; ELSE IF a = 2 THEN a := 3; END_IF;"),
        body("s : STRING;", "s := 'it''s';"),
        body("s : STRING; n : INT;", "s := 'n=' + n;"),
        body("n : INT;", "n := 0xFF;"),
        body("i, n : INT;", "FOR i := 0 TO 10 STEP 2 DO n := n + 1; END_FOR;"),
        body("w : WORD; b : BOOL;", "b := w[3];"),
        body("n : INT;", "n := 10#30000;"),
        body("n : INT;", "n := $FF;"),
        body("s : STRING;", "s := ‘text’;"),
        body("s : STRING;", "s := “text”;"),
        body("i, n : INT;", "FOR i = 0 TO 10 DO n := n + 1; END_FOR;"),
        body("i, n : INT;", "FOR i := 0 TO 10 DO n := n + 1; NEXT i;"),
        body("x : BOOL; n : INT;", "IF x THEN n := 1; ENDIF;"),
        body("i, n : INT;", "FOR i := 0 TO 3 DO IF n = i THEN n := 1; END IF; end for;"),
        body("w : WORD; b : BOOL;", "b := w.bit3;"),
        body("n : INT;", "n := n % 2;"),
        body("n : INT;", "n := n ^ 2;"),
        body("w : WORD;", "w := w << 1;"),
        body("x : BOOL; n : INT;", "x := n =< 3;"),
        body("x : BOOL; n : INT;", "x := n => 3;"),
        body("r : REAL;", "r := 1,5;"),
        body("x : BOOL; n : INT;", "n := x ? 1 : 2;"),
        body("n : INT;", "INT z; n := 1;"),
    ];
    insta::assert_snapshot!(all.join("\n"));
}

/// Names that are words of Instruction List begin a statement of Structured Text as all others do.
#[test]
fn words_of_instruction_list_are_names_in_text() {
    for name in ["r1", "s1", "in", "pt", "pv", "cu", "cd", "clk", "st", "ld", "eq", "add", "sub"] {
        let text = format!(
            "PROGRAM P VAR x, y : INT; {name} : REFERENCE TO INT; END_VAR\n{name} REF= x;\ny := {name};\nEND_PROGRAM"
        );
        let found = findings_in(Dialect::Codesys, &text);
        assert!(!found.has_errors(), "{name}: {found}");
    }
}
