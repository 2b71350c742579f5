//! Whatever is nested ten thousand deep is refused with an error; nothing exhausts the stack.

use onescan_iec_run::Application;

const DEEP: usize = 10_000;

fn compiles(text: &str) -> Result<(), String> {
    Application::from_sources([("deep.st", text)]).map(drop).map_err(|found| found.to_string())
}

fn refused(what: &str, text: &str) {
    let found = compiles(text).expect_err(what);
    assert!(found.len() < 100_000, "{what}: one mistake, few findings, not {} bytes of them", found.len());
}

fn program(declarations: &str, statements: &str) -> String {
    format!("PROGRAM P VAR x : DINT; b : BOOL; {declarations} END_VAR {statements} END_PROGRAM")
}

#[test]
fn expressions() {
    for (open, inner, close) in [
        ("(", "x", ")"),
        ("-", "x", ""),
        ("-(", "x", ")"),
        ("ABS(", "x", ")"),
        ("MAX(1, ", "x", ")"),
        ("a[", "0", "]"),
        ("(1 + ", "x", ")"),
        ("SEL(b, 1, ", "x", ")"),
    ] {
        let expression = format!("{}{inner}{}", open.repeat(DEEP), close.repeat(DEEP));
        let text = program("a : ARRAY [0..1] OF DINT;", &format!("x := {expression};"));
        refused(open, &text);
    }
    refused("NOT", &program("", &format!("b := {}b;", "NOT ".repeat(DEEP))));
    refused("members", &program("", &format!("x := x{};", ".y".repeat(DEEP))));
    refused("indices", &program("", &format!("x := x{};", "[0]".repeat(DEEP))));
}

#[test]
fn statements() {
    for (open, close) in [
        ("IF b THEN ", " END_IF;"),
        ("IF b THEN ; ELSE ", " END_IF;"),
        ("IF b THEN ; ELSIF b THEN ", " END_IF;"),
        ("WHILE b DO ", " END_WHILE;"),
        ("REPEAT ", " UNTIL b END_REPEAT;"),
        ("FOR x := 0 TO 1 DO ", " END_FOR;"),
        ("CASE x OF 1: ", " END_CASE;"),
        ("CASE x OF 1: ; ELSE ", " END_CASE;"),
    ] {
        refused(open, &program("", &format!("{} x := 1; {}", open.repeat(DEEP), close.repeat(DEEP))));
        // Unfinished, as in an editor.
        refused(open, &program("", &open.repeat(DEEP)));
    }
}

#[test]
fn types_and_initial_values() {
    let arrays = format!("a : {}INT;", "ARRAY [0..0] OF ".repeat(DEEP));
    refused("arrays of arrays", &program(&arrays, ""));
    let structures =
        format!("TYPE T : {} x : INT; {} END_TYPE", "STRUCT y : ".repeat(DEEP), "END_STRUCT;".repeat(DEEP));
    refused("structures in structures", &structures);
    for (open, close) in [("[", "]"), ("(a := ", ")"), ("2(", ")"), ("(", ")")] {
        let value = format!("{}1{}", open.repeat(DEEP), close.repeat(DEEP));
        refused(open, &program(&format!("a : ARRAY [0..1] OF INT := {value};"), ""));
    }
    let chain: Vec<String> = (0..DEEP).map(|n| format!("T{n} : ARRAY [0..0] OF T{};", n + 1)).collect();
    refused("types of types", &format!("TYPE {} T{DEEP} : INT; END_TYPE", chain.join(" ")));
}

#[test]
fn blocks_of_blocks_and_calls_of_calls() {
    let blocks: Vec<String> =
        (0..DEEP).map(|n| format!("FUNCTION_BLOCK F{n} VAR a : F{}; END_VAR a(); END_FUNCTION_BLOCK", n + 1)).collect();
    refused("instances in instances", &format!("{} FUNCTION_BLOCK F{DEEP} END_FUNCTION_BLOCK", blocks.join("\n")));
    // A row of calls needs no nesting in the text: it is compiled, whatever it does when it runs.
    let calls: Vec<String> =
        (0..DEEP).map(|n| format!("FUNCTION f{n} : INT f{n} := f{}(); END_FUNCTION", n + 1)).collect();
    let text = format!("{} FUNCTION f{DEEP} : INT f{DEEP} := 1; END_FUNCTION", calls.join("\n"));
    assert_eq!(compiles(&text), Ok(()));
}

#[test]
fn comments_and_pragmas() {
    let nested =
        |open: &str, close: &str| program("", &format!("{} {} x := 1;", open.repeat(DEEP), close.repeat(DEEP)));
    for (open, close) in [("(*", "*)"), ("/*", "*/"), ("{", "}")] {
        // Accepted or refused, as the dialect says; unfinished ones are refused.
        let _ = compiles(&nested(open, close));
        refused(open, &program("", &open.repeat(DEEP)));
    }
}

/// What is long and not deep is fine.
#[test]
fn long_rows() {
    let arms: String = (0..DEEP).map(|n| format!("{n}: x := {n}; ")).collect();
    let elsifs: String = (0..2000).map(|n| format!("ELSIF x = {n} THEN x := {n}; ")).collect();
    for text in [
        program("", &"x := x + 1;\n".repeat(DEEP)),
        program("", &format!("x := {}x;", "1 + ".repeat(DEEP))),
        program("", &format!("x := {}x;", "2 * ".repeat(DEEP))),
        program("", &format!("CASE x OF {arms} END_CASE;")),
        program("", &format!("IF b THEN ; {elsifs} END_IF;")),
        program(&(0..DEEP).map(|n| format!("v{n} : INT; ")).collect::<String>(), ""),
    ] {
        assert_eq!(compiles(&text), Ok(()));
    }
}

/// `cargo test --release -p onescan-iec-tests --test programs -- --ignored a_million_lines`
#[test]
#[ignore = "takes a minute without optimisation"]
fn a_million_lines() {
    let block = |n: usize| {
        let lines = "  x := x + y;\n  IF x > 100 THEN\n    x := 0;\n  END_IF;\n".repeat(240);
        format!("FUNCTION_BLOCK B{n}\nVAR_INPUT y : DINT; END_VAR\nVAR x : DINT; END_VAR\n{lines}END_FUNCTION_BLOCK\n")
    };
    let text: String = (0..1040).map(block).collect();
    assert!(text.lines().count() > 1_000_000);
    assert_eq!(compiles(&text), Ok(()));
    let one = program("", &"x := x + 1;\n".repeat(1_000_000));
    assert_eq!(compiles(&one), Ok(()));
}
