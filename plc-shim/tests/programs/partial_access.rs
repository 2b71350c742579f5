//! Parts of bit strings (3rd ed. 6.5.3, Table 17).

use crate::rig::{Rig, findings, result};

#[test]
fn iec3_6_5_3_table_17_parts_are_read_and_written() {
    let mut rig = result(
        "l : LWORD := 16#0123456789ABCDEF; d : DWORD; w, v : WORD; b, c : BYTE; x, y : BOOL;",
        "d := l.%D1; w := l.%W1; b := l.%B7; x := l.%X63; y := l.%X56; c := l.%W1.%B1; v := d.%W0;
         l.%X0 := FALSE; l.%B1 := 16#55; l.%W1 := 16#1111; l.%D1 := 16#FEDCBA98;",
    );
    assert_eq!((rig.int("P.d"), rig.int("P.w"), rig.int("P.b")), (0x0123_4567, 0x89AB, 1));
    assert_eq!((rig.bool("P.x"), rig.bool("P.y"), rig.int("P.c"), rig.int("P.v")), (false, true, 0x89, 0x4567));
    assert_eq!(rig.int("P.l") as u64, 0xFEDC_BA98_1111_55EE);
    rig.scan().expect("no fault");
    assert_eq!(rig.int("P.d"), 0xFEDC_BA98);
}

#[test]
fn iec3_6_5_3_parts_of_what_is_held_in_a_register() {
    let rig = result(
        "r : LWORD; i : INT;",
        "r := Swap(16#0123456789ABCDEF); i := Negative();
        END_PROGRAM
        FUNCTION Swap : LWORD VAR_INPUT l : LWORD; END_VAR VAR t : DWORD; END_VAR
        t := l.%D1; l.%D1 := l.%D0; l.%D0 := t; Swap := l; Swap.%X0 := NOT Swap.%X0; Swap.%B7.%X7 := FALSE;
        Swap.%W1 := 16#FFFF; END_FUNCTION
        FUNCTION Negative : INT VAR s : SINT; END_VAR s.7 := TRUE; s.0 := s.7; Negative := s; END_FUNCTION
        PROGRAM Q",
    );
    assert_eq!(rig.int("P.r") as u64, 0x09AB_CDEF_FFFF_4566);
    assert_eq!(rig.int("P.i"), -127);
}

#[test]
fn iec3_6_5_3_parts_of_members_elements_outputs_and_addresses() {
    let mut rig = Rig::new(
        "TYPE S : STRUCT w : ARRAY [1..2] OF WORD; END_STRUCT END_TYPE
        FUNCTION_BLOCK B VAR_OUTPUT q : BOOL; r : BYTE; END_VAR q := TRUE; r := 16#7F; END_FUNCTION_BLOCK
        FUNCTION Flip VAR_IN_OUT x : BOOL; END_VAR x := NOT x; END_FUNCTION
        VAR_GLOBAL CONSTANT Ready : INT := 9; END_VAR
        PROGRAM P VAR s : S; fb : B; i : INT; n : DINT; x : BOOL; w : WORD; END_VAR
        i := 2; s.w[i].%X15 := TRUE; fb(q => s.w[1].%X3, r => s.w[i].%B0); Flip(s.w[1].0); Flip(s.w[1].%1);
        n.31 := TRUE; n.Ready := TRUE; x := n.Ready AND fb.r.6 AND NOT fb.r.%X7; %MW1.%X3 := TRUE; w := %MW1; END_PROGRAM",
    );
    rig.scan().expect("no fault");
    assert_eq!((rig.int("P.s.w[1]"), rig.int("P.s.w[2]")), (0b1011, 0x807F));
    assert_eq!((rig.int("P.n"), rig.bool("P.x"), rig.int("P.w")), (i64::from(i32::MIN) + 512, true, 8));
}

#[test]
fn wrong_parts_are_reported() {
    let reported = |statement: &str| {
        let declarations = "w : WORD; b : BYTE; l : LWORD; i : INT; x : BOOL; r : REAL; n : INT;";
        let text = format!("PROGRAM P VAR {declarations} END_VAR\n{statement}\nEND_PROGRAM");
        findings(&text).lines().next().unwrap_or_default().to_owned()
    };
    for (statement, expected) in [
        ("x := w.%X16;", "test.st:2:6: error[R0903]: WORD has the parts 0 to 15 of this width, not 16"),
        ("b := w.%B2;", "test.st:2:6: error[R0903]: WORD has the parts 0 to 1 of this width, not 2"),
        ("w := w.%W0;", "test.st:2:6: error[R0903]: WORD has no parts of 16 bits"),
        ("l := l.%L0;", "test.st:2:6: error[R0903]: LWORD has no parts of 64 bits"),
        ("x := w.%Y0;", "test.st:2:8: error[R0903]: `%Y0` is not a part: write %X, %B, %W or %D and a number"),
        (
            "x := w.%X99999999999;",
            "test.st:2:8: error[R0903]: `%X99999999999` is not a part: write %X, %B, %W or %D and a number",
        ),
        ("x := i.%X16;", "test.st:2:6: error[R0903]: INT has the parts 0 to 15 of this width, not 16"),
        ("x := i.16;", "test.st:2:6: error[R0903]: INT has the parts 0 to 15 of this width, not 16"),
        ("x := r.0;", "test.st:2:6: error[R0903]: BYTE, WORD, DWORD and LWORD have parts, this is REAL"),
        ("x := x.0;", "test.st:2:6: error[R0903]: BYTE, WORD, DWORD and LWORD have parts, this is BOOL"),
        ("x := i.n;", "test.st:2:6: error[T0208]: INT has no members"),
        ("w.%B0 := 256;", "test.st:2:10: error[T0202]: 256 does not fit BYTE (0 to 255)"),
    ] {
        assert_eq!(reported(statement), expected, "{statement}");
    }
}
