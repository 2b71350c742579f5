//! Members of structures where their addresses say, and those that share bytes (3rd ed. 6.4.4.6, Table 11).

use onescan_iec::Dialect;

use crate::rig::{Rig, findings, findings_in};

const TYPES: &str = "
TYPE Com1 : STRUCT
    head AT %B0 : INT;
    length AT %B2 : USINT := 26;
    flag1 AT %X3.0 : BOOL;
    flag2 AT %X3.3 : BOOL := TRUE;
    tail AT %B9 : BYTE := 16#AA;
    odd AT %B5 : DINT;
END_STRUCT END_TYPE
TYPE Com2 : STRUCT OVERLAP
    head AT %B0 : INT;
    flag AT %X1.7 : BOOL;
    data1 AT %B5 : BYTE;
    data2 AT %B5 : REAL := 1.0;
    all AT %B0 : ARRAY [0..8] OF BYTE;
END_STRUCT END_TYPE
";

fn rig(declarations: &str, statements: &str) -> Rig {
    let mut rig = Rig::new(&format!("{TYPES}PROGRAM P VAR {declarations} END_VAR {statements} END_PROGRAM"));
    rig.scan().expect("no fault");
    rig
}

#[test]
fn iec3_6_4_4_6_table_11_members_lie_at_their_addresses() {
    let rig = rig(
        "a, b : Com1; c : Com1 := (flag1 := TRUE, flag2 := FALSE, odd := -1); n : UDINT; d : Com1; list : ARRAY [1..2] OF Com1;",
        "a.head := 16#0102; a.odd := 16#11223344; b := a; b.flag1 := b.flag2; b.flag2 := FALSE; n := SIZEOF(a);
         d.flag1 := a.flag2 AND NOT c.flag2; list[2].flag1 := TRUE; list[2].tail := list[1].tail XOR 16#FF;",
    );
    assert_eq!(rig.memory_of("P.a")[..10], [2, 1, 26, 8, 0, 0x44, 0x33, 0x22, 0x11, 0xAA]);
    assert_eq!(rig.memory_of("P.b")[3], 1);
    assert_eq!(rig.memory_of("P.c")[..10], [0, 0, 26, 1, 0, 255, 255, 255, 255, 0xAA]);
    assert_eq!((rig.int("P.n"), rig.memory_of("P.d")[3]), (12, 9));
    assert_eq!(
        (rig.bool("P.list[2].flag1"), rig.bool("P.list[1].flag1"), rig.int("P.list[2].tail")),
        (true, false, 0x55)
    );
}

#[test]
fn iec3_6_4_4_6_table_11_members_of_overlap_share_bytes() {
    let rig = rig(
        "a : Com2; b : Com2; r : REAL; f : BOOL;",
        "r := a.data2; a.data2 := 2.0; b.all[1] := 16#80; b.all[5] := 7; f := b.flag;",
    );
    assert_eq!((rig.real("P.r"), rig.int("P.a.data1"), rig.int("P.a.all[8]")), (1.0, 0, 0x40));
    assert_eq!((rig.bool("P.f"), rig.int("P.b.head"), rig.int("P.b.data1")), (true, -32768, 7));
}

#[test]
fn bits_of_structures_go_through_memory_and_have_paths() {
    let mut rig = Rig::new(&format!(
        "{TYPES}FUNCTION_BLOCK Flip VAR_IN_OUT x : BOOL; END_VAR x := NOT x; END_FUNCTION_BLOCK
        PROGRAM P VAR a : Com1; f : Flip; e : BOOL; END_VAR f(x := a.flag1); e := a.flag1; END_PROGRAM"
    ));
    rig.scan().expect("no fault");
    assert_eq!((rig.bool("P.e"), rig.memory_of("P.a")[3]), (true, 9));
    rig.plc.write("P.a.flag2", "FALSE").expect("a bit is written alone");
    assert_eq!(rig.memory_of("P.a")[3], 1);
    rig.plc.force("P.a.flag1", "TRUE").expect("a bit is forced alone");
    for _ in 0..3 {
        rig.scan().expect("no fault");
        assert_eq!(rig.memory_of("P.a")[3], 1);
    }
    let shown = rig.plc.read("P.a").expect("a structure is shown");
    assert_eq!(shown, "(head := 0, length := 26, flag1 := TRUE, flag2 := FALSE, tail := 16#AA, odd := 0)");
}

#[test]
fn addresses_count_what_the_dialect_counts() {
    let text = "TYPE S : STRUCT a AT %W1 : INT; b AT %D2 : DINT; END_STRUCT END_TYPE
        PROGRAM P VAR s : S; END_VAR s.a := 1; s.b := 2; END_PROGRAM";
    for (dialect, a, b) in [(Dialect::Iec3, 2, 8), (Dialect::TwinCat, 1, 3)] {
        let (mut rig, overlap) = match dialect {
            Dialect::TwinCat => {
                let text = text.replace("%D2", "%D3");
                (Rig::in_dialect(dialect, &text), findings_in(dialect, &text.replace("%D3", "%D2")))
            }
            _ => (Rig::in_dialect(dialect, text), findings_in(dialect, text)),
        };
        rig.scan().expect("no fault");
        let memory = rig.memory_of("P.s");
        assert_eq!((memory[a], memory[b]), (1, 2), "{dialect}");
        assert_eq!(overlap.to_string().contains("R0908"), dialect == Dialect::TwinCat, "{overlap}");
    }
}

#[test]
fn wrong_addresses_of_members_are_reported() {
    let reported = |members: &str| findings(&format!("TYPE S : STRUCT\n{members} END_STRUCT END_TYPE"));
    let all = [
        "a AT %B0 : INT; b AT %B1 : INT;",
        "a, b AT %B0 : INT;",
        "a AT %X0.3 : BOOL; b AT %B0 : BYTE;",
        "a AT %X0.3 : INT;",
        "a AT %W0 : DINT;",
        "a AT %IX0.0 : BOOL;",
        "a AT %QW* : BOOL;",
        "a AT %B2000000 : BOOL;",
        "a AT %X0.8 : BOOL;",
        "b AT %B4 : INT; a : INT; c AT %B6 : INT;",
    ];
    insta::assert_snapshot!(all.map(|members| format!("{members}\n    {}", reported(members))).join("\n"));
}
