//! Members without gaps between them: the attribute `pack_mode`, and `BIT` in structures (CODESYS, TwinCAT).

use onescan_iec::Dialect;

use crate::rig::{Rig, findings_in};

fn rig(dialect: Dialect, types: &str, declarations: &str, statements: &str) -> Rig {
    let text = format!("{types} PROGRAM P VAR {declarations} END_VAR {statements} END_PROGRAM");
    let mut rig = Rig::in_dialect(dialect, &text);
    rig.scan().expect("no fault");
    rig
}

/// Beckhoff, CX7000, structure padding: the members of 1, 4, 1 and 2 bytes are 8 bytes without gaps.
#[test]
fn pack_mode_leaves_no_gaps() {
    let members = "STRUCT a : BYTE; b : UDINT; c : BYTE; d : UINT; END_STRUCT END_TYPE";
    for (mode, size, at_b, at_d) in [(None, 12, 4, 10), (Some(1), 8, 1, 6), (Some(2), 10, 2, 8), (Some(4), 12, 4, 10)] {
        let attribute = mode.map(|mode| format!("{{attribute 'pack_mode' := '{mode}'}}")).unwrap_or_default();
        let types = format!("{attribute} TYPE T : {members}");
        for dialect in [Dialect::Codesys, Dialect::TwinCat] {
            let rig = rig(
                dialect,
                &types,
                "t, u : T; list : ARRAY [0..1] OF T; n, all : UDINT; p : POINTER TO T; sum : UDINT;",
                "t.a := 1; t.b := 16#11223344; t.c := 2; t.d := 16#5566; u := t; n := SIZEOF(t); all := SIZEOF(list);
                 list[1] := u; p := ADR(list[1]); sum := p^.b + p^.d;",
            );
            assert_eq!((rig.int("P.n"), rig.int("P.all")), (size, 2 * size), "{mode:?}");
            let bytes = rig.memory_of("P.u");
            assert_eq!((bytes[at_b], bytes[at_d]), (0x44, 0x66), "{mode:?}: {bytes:?}");
            assert_eq!(rig.int("P.sum"), 0x1122_3344 + 0x5566, "{mode:?}");
        }
    }
}

#[test]
fn a_telegram_is_seen_through_a_union_as_it_is_sent() {
    let types = "
        {attribute 'pack_mode' := '1'}
        TYPE Telegram : STRUCT kind : BYTE; value : DWORD; END_STRUCT END_TYPE
        TYPE Seen : UNION telegram : Telegram; bytes : ARRAY [0..4] OF BYTE; END_UNION END_TYPE";
    let rig = rig(
        Dialect::TwinCat,
        types,
        "s : Seen; b1, b4 : BYTE;",
        "s.telegram.value := 16#11223344; b1 := s.bytes[1]; b4 := s.bytes[4];",
    );
    assert_eq!((rig.int("P.b1"), rig.int("P.b4")), (0x44, 0x11));
}

/// What is packed lies in a structure that is not packed where that structure's own members say.
#[test]
fn packing_is_of_the_structure_that_the_attribute_stands_before() {
    let types = "
        TYPE {attribute 'pack_mode' := '1'} Inner : STRUCT a : BYTE; b : DINT; END_STRUCT;
             Outer : STRUCT x : BYTE; inner : Inner; y : DINT; END_STRUCT; END_TYPE
        {attribute 'pack_mode' := '1'}
        TYPE Longer EXTENDS Outer : STRUCT z : BYTE; w : DINT; END_STRUCT END_TYPE";
    let rig = rig(
        Dialect::Codesys,
        types,
        "o : Outer; l : Longer; inner, outer, longer : UDINT;",
        "inner := SIZEOF(o.inner); outer := SIZEOF(o); longer := SIZEOF(l); l.w := 7;",
    );
    assert_eq!((rig.int("P.inner"), rig.int("P.outer"), rig.int("P.longer")), (5, 12, 17));
}

/// CODESYS, data type BIT: up to eight that follow each other share a byte.
#[test]
fn bits_of_a_structure_share_bytes() {
    let types =
        "TYPE Flags : STRUCT a, b, c, d, e, f, g, h : BIT; i : BIT := TRUE; n : BYTE; j : BIT; END_STRUCT END_TYPE
        TYPE Seen : UNION word : Flags; bytes : ARRAY [0..3] OF BYTE; END_UNION END_TYPE";
    let rig = rig(
        Dialect::Codesys,
        types,
        "s : Seen; n : UDINT; flag : BOOL; first, second, last : BYTE;",
        "s.word.a := TRUE; s.word.h := s.word.a; s.word.n := 16#55; s.word.j := s.word.h AND NOT s.word.b; n := SIZEOF(s);
         flag := s.word.i; first := s.bytes[0]; second := s.bytes[1]; last := s.bytes[3];",
    );
    assert_eq!((rig.int("P.n"), rig.bool("P.flag")), (4, true));
    assert_eq!((rig.int("P.first"), rig.int("P.second"), rig.int("P.last")), (0x81, 1, 1));
}

#[test]
fn a_bit_of_a_union_is_the_lowest_of_its_byte() {
    let types = "TYPE Seen : UNION flag : BIT; byte : BYTE; END_UNION END_TYPE";
    let rig = rig(
        Dialect::Codesys,
        types,
        "s, t : Seen; was : BOOL;",
        "s.byte := 2; was := s.flag; t.byte := 3; t.flag := FALSE;",
    );
    assert_eq!((rig.bool("P.was"), rig.int("P.t.byte")), (false, 2));
}

/// `TcUnit` and others of its kind compare values of any type through a union with a BIT.
#[test]
fn the_address_of_a_bit_is_that_of_its_byte() {
    let types = "TYPE T : STRUCT n : INT; a, b : BIT; END_STRUCT END_TYPE
        TYPE Seen : UNION flag : BIT; byte : BYTE; END_UNION END_TYPE
        FUNCTION Filled : Seen VAR_INPUT src : POINTER TO BYTE; END_VAR MEMCPY(ADR(Filled.flag), src, 1); END_FUNCTION";
    let rig = rig(
        Dialect::TwinCat,
        types,
        "t : T; p : POINTER TO BYTE; was, one : BYTE := 1; s : Seen;",
        "t.b := TRUE; p := ADR(t.b); was := p^; s := Filled(ADR(one));",
    );
    assert_eq!((rig.int("P.was"), rig.int("P.s.byte")), (2, 1));
    let text = "PROGRAM P VAR w : WORD; p : POINTER TO BYTE; END_VAR p := ADR(w.3); END_PROGRAM";
    assert!(findings_in(Dialect::Codesys, text).has_errors());
}

/// CODESYS and TwinCAT: C0203; the data type BIT is for individual variables of structures and function blocks.
#[test]
fn a_bit_stands_in_structures_and_blocks_only() {
    let right = "TYPE T : STRUCT a, b : BIT; END_STRUCT END_TYPE
        FUNCTION_BLOCK F VAR_INPUT i : BIT; END_VAR VAR b : BIT; t : T; END_VAR b := i; t.a := b; END_FUNCTION_BLOCK";
    assert!(!findings_in(Dialect::Codesys, right).has_errors());
    for wrong in [
        "PROGRAM P VAR b : BIT; END_VAR b := TRUE; END_PROGRAM",
        "FUNCTION F : BOOL VAR_INPUT b : BIT; END_VAR F := b; END_FUNCTION",
        "VAR_GLOBAL b : BIT; END_VAR",
        "FUNCTION_BLOCK F VAR b : ARRAY [0..7] OF BIT; END_VAR b[0] := TRUE; END_FUNCTION_BLOCK",
        "TYPE T : STRUCT l : ARRAY [0..7] OF BIT; END_STRUCT END_TYPE",
        "FUNCTION_BLOCK F VAR p : POINTER TO BIT; x : BOOL; END_VAR x := p <> 0; END_FUNCTION_BLOCK",
    ] {
        for dialect in [Dialect::Codesys, Dialect::TwinCat] {
            let found = findings_in(dialect, wrong).to_string();
            assert!(found.contains("error[D0407]: BIT is for single members"), "{dialect}: {wrong}: {found}");
        }
    }
}
