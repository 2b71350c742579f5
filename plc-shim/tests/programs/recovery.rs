//! Slips that people make: each is reported once, and what follows it is read as if it were not there.

use crate::rig::findings;

/// What is written between `VAR a : INT; b : BOOL; t : TON; END_VAR` and `a := 1; END_PROGRAM`.
const SLIPS: [&str; 24] = [
    "IF a == 1 THEN a := 2; END_IF;",
    "IF a != 1 THEN a := 2; END_IF;",
    "IF a = 1 DO a := 2; END_IF;",
    "IF (a = 1 THEN a := 2; END_IF;",
    "IF a = 1 THEN a := 2; ELSEIF a = 2 THEN a := 3; END_IF;",
    "IF b THEN a := 2; END_WHILE; a := 3;",
    "IF b THEN a := 2;",
    "a =: 1;",
    "a : = 1;",
    "a++;",
    "b := b && b; b := b || b;",
    "FOR a := 1 UNTIL 3 DO a := 2; END_FOR;",
    "CASE a 1: a := 2; 2: a := 3; END_CASE;",
    "CASE a OF 1: a := 2; BREAK; 2: a := 3; END_CASE;",
    "REPEAT a := a + 1; UNTIL a > 3; END_REPEAT;",
    "t(IN := TRUE, PT := 1s);",
    "t(IN := TRUE PT := T#1s);",
    "RETURN a;",
    "a := 1; *) a := 2;",
    "c : INT;",
    "b := a = 1 ? TRUE : FALSE;",
    "a := 2; VAR c : INT; END_VAR c := 1;",
    "a := 1 + 2);",
    "a := 'open;",
];

/// Files that are wrong outside of statements.
const DECLARATIONS: [&str; 10] = [
    "PROGRAM P VAR a : INT; a := 1; END_PROGRAM",
    "PROGRAM P VAR if : INT; a : INT; END_VAR a := 1; END_PROGRAM",
    "PROGRAM P VAR a : ARRAY 0..3 OF INT; END_VAR a[0] := 1; END_PROGRAM",
    "PROGRAM P VAR a INT; b : INT; END_VAR a := 1; b := 2; END_PROGRAM",
    "FUNCTION f INT VAR_INPUT a : INT; END_VAR f := a; END_FUNCTION PROGRAM P VAR a : INT; END_VAR a := f(1); END_PROGRAM",
    "FUNCTION_BLOCK f VAR a : INT; END_VAR a := 1; PROGRAM P VAR a : INT; END_VAR a := 1; END_PROGRAM",
    "FUNCTION_BLOCK f VAR a : INT; END_VAR a := 1; END_FUNCTION PROGRAM P VAR a : INT; END_VAR a := 1; END_PROGRAM",
    "TYPE t : STRUCT a : INT; b : INT; END_TYPE PROGRAM P VAR x : t; END_VAR x.a := 1; END_PROGRAM",
    "TYPE c : (red green); END_TYPE PROGRAM P VAR x : c; END_VAR x := red; END_PROGRAM",
    "PROGRAM VAR b : INT; END_VAR b := 1; END_PROGRAM PROGRAM Q VAR b : INT; END_VAR b := 1; END_PROGRAM",
];

fn reported(text: &str, shown: &str) -> String {
    let found = findings(text);
    format!("{shown}\n    {}\n", found.replace('\n', "\n    "))
}

#[test]
fn a_slip_in_a_statement_is_reported_once() {
    let reported = SLIPS.map(|slip| {
        let text = format!("PROGRAM P VAR a : INT; b : BOOL; t : TON; END_VAR\n{slip} a := 1; END_PROGRAM");
        reported(&text, slip)
    });
    insta::assert_snapshot!(reported.concat());
}

#[test]
fn a_slip_in_a_declaration_is_reported_once() {
    insta::assert_snapshot!(DECLARATIONS.map(|text| reported(text, text)).concat());
}
