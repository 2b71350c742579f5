//! Lists of instructions (2nd ed. 3.2, 3rd ed. 7.2).

use onescan_iec::syntax::printer::print_unit;
use onescan_iec::syntax::{FileId, parse};

use crate::plcopen;
use crate::rig::{Rig, findings};

/// A program with these variables and instructions, each on a line of its own.
fn list(declarations: &str, instructions: &str) -> String {
    format!("PROGRAM P VAR {declarations} END_VAR\n{instructions}\nEND_PROGRAM\n")
}

/// The variable `r` after one scan.
fn result(declarations: &str, instructions: &str) -> i64 {
    let mut rig = Rig::new(&list(declarations, instructions));
    rig.scan().expect("no fault");
    rig.int("P.r")
}

#[test]
fn iec2_table_52_operators() {
    let cases = [
        ("r : INT; a : INT := 7;", "LD a\nST r", 7),
        ("r : BOOL; a : BOOL;", "LDN a\nST r", 1),
        ("r : WORD; a : WORD := 16#00FF;", "LDN a\nST r", 0xff00),
        ("r : BOOL; a : BOOL;", "LD a\nSTN r", 1),
        ("r : BOOL;", "LD TRUE\nS r", 1),
        ("r : BOOL := TRUE;", "LD FALSE\nR r", 1),
        ("r : BOOL := TRUE;", "LD TRUE\nR r", 0),
        ("r : BOOL; a : BOOL := TRUE;", "LD TRUE\nAND a\nST r", 1),
        ("r : BOOL; a : BOOL := TRUE;", "LD TRUE\n& a\nST r", 1),
        ("r : BOOL; a : BOOL := TRUE;", "LD TRUE\nANDN a\nST r", 0),
        ("r : BOOL; a : BOOL := TRUE;", "LD TRUE\n&N a\nST r", 0),
        ("r : BOOL; a : BOOL;", "LD FALSE\nOR a\nORN a\nST r", 1),
        ("r : WORD; a : WORD := 16#0F0F;", "LD a\nXOR 16#FFFF\nXORN WORD#0\nST r", 0x0f0f),
        ("r : BYTE; a : BYTE := 16#F0;", "LD a\nNOT\nST r", 0x0f),
        ("r : INT; a : INT := 7;", "LD a\nADD 5\nSUB 2\nMUL a\nDIV 4\nMOD 10\nST r", 7),
        ("r : INT; a : INT := 7;", "LD -5\nADD a, 1, 2\nST r", 5),
        ("r : BOOL; a : INT := 7;", "LD a\nGT 6\nST r", 1),
        ("r : BOOL; a : INT := 7;", "LD a\nGE 8\nST r", 0),
        ("r : BOOL; a : INT := 7;", "LD a\nEQ 7\nST r", 1),
        ("r : BOOL; a : INT := 7;", "LD a\nNE 7\nST r", 0),
        ("r : BOOL; a : INT := 7;", "LD a\nLE 7\nST r", 1),
        ("r : BOOL; a : INT := 7;", "LD a\nLT 7\nST r", 0),
        ("r : INT; a : INT := 7;", "LD a (* 7 *)\nST r\nADD 1\nST a\nLD a\nST r", 8),
    ];
    for (declarations, instructions, expected) in cases {
        assert_eq!(result(declarations, instructions), expected, "{instructions}");
    }
}

#[test]
fn iec2_3_2_2_parentheses_defer() {
    assert_eq!(result("r : BOOL; a, c : BOOL := TRUE; b : BOOL;", "LD b\nOR( a\nAND c\n)\nST r"), 1);
    assert_eq!(result("r : INT; a : INT := 2;", "LD a\nMUL(\nLD 3\nADD( a\nMUL 5\n)\n)\nSUB 1\nST r"), 25);
    assert_eq!(result("r : BOOL; a : BOOL := TRUE;", "LD TRUE\nANDN( a\nXOR TRUE\n)\nST r"), 1);
}

#[test]
fn iec2_3_2_2_jumps_and_returns() {
    let sum =
        "LD 0\nST r\nagain:\nLD i\nADD r\nST r\nLD i\nADD 1\nST i\nLE 10\nJMPC again\nLD r\nGT 50\nRETC\nLD 0\nST r";
    assert_eq!(result("r, i : INT;", sum), 55);
    let carried = "LD a\nJMP there\nLD 9\nthere: ADD 1\nST r";
    assert_eq!(result("r, a : INT := 4;", carried), 5);
    assert_eq!(result("r : INT; a : BOOL;", "LD a\nJMPCN out\nLD 1\nST r\nout:\nRET"), 0);
    assert_eq!(result("r : INT := 3; a : BOOL;", "LD a\nRETCN\nLD 1\nST r"), 3);
}

const COUNTED: &str = "\
    LD 2
    ST c.PV
    LD pulse
    ST c.CU
    CAL c
    CAL d(CU := pulse,
          PV := 2,
          Q => q)
    LD 2
    PV e
    LD pulse
    CU e
    LD on
    CALC t(IN := ( LD pulse
                   ANDN off
                 ), PT := T#10ms)
    LDN pulse
    ST pulse";

#[test]
fn iec2_tables_53_and_54_calls_of_function_blocks() {
    let declarations = "c, d, e : CTU; t : TON; q, pulse, off : BOOL; on : BOOL := TRUE;";
    let mut rig = Rig::new(&list(declarations, COUNTED));
    for _ in 0..4 {
        rig.scan().expect("no fault");
    }
    assert_eq!(["c", "d", "e"].map(|name| rig.int(&format!("P.{name}.CV"))), [2, 2, 2]);
    assert!(rig.bool("P.q") && rig.bool("P.c.Q") && rig.bool("P.e.Q") && rig.bool("P.t.IN"));
    let latch = list("s : SR; r : RS; a : BOOL := TRUE;", "LD a\nS1 s\nLD a\nS r\nLD FALSE\nR s");
    let mut rig = Rig::new(&latch);
    rig.scan().expect("no fault");
    assert!(rig.bool("P.s.Q1") && rig.bool("P.r.Q1"));
}

#[test]
fn iec2_3_2_4_calls_of_functions() {
    let limit = "LD 12\nLIMIT 0, 10\nST r";
    assert_eq!(result("r : INT;", limit), 10);
    assert_eq!(result("r : INT; a : INT := -4;", "LD a\nABS\nMAX 3\nST r"), 4);
    assert_eq!(result("r : INT; a : INT := 30;", "LIMIT(\n MN := 0,\n IN := a,\n MX := 20\n)\nST r"), 20);
    let own = "FUNCTION twice : INT VAR_INPUT x : INT; END_VAR\nLD x\nMUL 2\nST twice\nEND_FUNCTION\n";
    let text = format!("{own}{}", list("r : INT;", "LD 4\ntwice\nADD 1\nST r\nLD 9\ntwice"));
    let mut rig = Rig::new(&text);
    rig.scan().expect("no fault");
    assert_eq!(rig.int("P.r"), 9);
}

#[test]
fn wrong_instructions_are_reported() {
    let text = list(
        "a : BOOL; i : INT; t : TON;",
        "ST a\nLD\nLD a\nADD 1\nST i\nLD i\nAND a\nST a\nBLA i\nLD a\nJMPC nowhere\nLD i i\nLD a\nST i\nCAL t(XX := a)\nLD a\nAND(\nLD i",
    );
    insta::assert_snapshot!(findings(&text));
}

#[test]
fn a_fault_is_at_its_instruction_and_loops_end() {
    let mut rig = Rig::new(&list("r, a : INT;", "LD 5\nADD 1\nDIV a\nST r"));
    insta::assert_snapshot!(rig.scan().expect_err("a division by 0"));
    let mut rig = Rig::new(&list("r, a : INT;", "again:\nLD a\nADD 1\nST a\nJMP again"));
    insta::assert_snapshot!(rig.scan().expect_err("an endless loop"));
}

#[test]
fn what_is_printed_is_parsed_to_the_same() {
    let text = list("c, d, e : CTU; t : TON; q, pulse, on, off : BOOL;", COUNTED);
    let more = list(
        "a : BOOL; i : INT;",
        "x: LDN a\nANDN( a\nOR a\n)\nJMPCN x\nLD i\nLIMIT -1, 5\nABS\nLIMIT(MN := 1, IN := i, MX := 5)\nS a\nRET",
    );
    for text in [text, more] {
        let first = parse(FileId(0), &text);
        assert_eq!(first.diagnostics, [], "{text}");
        let printed = print_unit(&first.unit);
        let second = parse(FileId(0), &printed);
        assert_eq!(second.diagnostics, [], "{printed}");
        assert_eq!(print_unit(&second.unit), printed);
    }
}

#[test]
fn a_body_in_xml_is_a_list_too() {
    let body =
        "<xhtml:p xmlns:xhtml=\"http://www.w3.org/1999/xhtml\"><![CDATA[(* a list *)\nLD a\nADD 1\nST a]]></xhtml:p>\n";
    let mut rig = plcopen::rig(&plcopen::program("local a : INT = 41", "IL", body));
    rig.scan().expect("no fault");
    assert_eq!(rig.int("P.a"), 42);
}

#[test]
fn statements_that_look_like_instructions_are_statements() {
    for body in ["st := 1;", "ld(1);", "s.x := 1;", "r := 2;", "ADD := 3;", "x: y := 1;", "cal^ := 1;"] {
        let text = list("r : INT;", body);
        let printed = print_unit(&parse(FileId(0), &text).unit);
        assert!(printed.contains(';') && printed.contains(":= ") || printed.contains("ld(1)"), "{printed}");
    }
}

#[test]
fn a_jump_back_inside_of_a_loop_is_no_step_of_it() {
    let text = "PROGRAM P VAR i, turns : INT; a : ARRAY [0..9] OF INT; END_VAR
        WHILE i < 10 DO
            again:
            i := i + 1;
            turns := turns + 1;
            IF i < 15 THEN JMP again; END_IF;
            a[i - 6] := i;
            IF turns > 100 THEN JMP out; END_IF;
        END_WHILE;
        out:
        END_PROGRAM";
    let mut rig = Rig::in_dialect(onescan_iec::Dialect::Codesys, text);
    rig.scan().expect("no fault");
    assert_eq!((rig.int("P.i"), rig.int("P.a[9]"), rig.int("P.turns")), (15, 15, 15));
}

#[test]
fn what_is_no_instruction_ends() {
    for line in ["\n    ^\n    LD 1\n", "\n    LD 1\n    ,\n    ]\n", "\n    LD 1\n    :=\n    := :=\n"] {
        let text = format!("PROGRAM P\nVAR r : INT; END_VAR\n    LD 1\n    ST r{line}END_PROGRAM");
        assert!(findings(&text).contains("error["), "{text}\n{}", findings(&text));
    }
}
