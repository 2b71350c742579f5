//! Unions of vendors.

use crate::rig::{Rig, findings};

#[test]
fn members_of_a_union_share_their_bytes() {
    let mut rig = Rig::new(
        "TYPE U : UNION d : DWORD; r : REAL; b : ARRAY [0..3] OF BYTE; s : S; END_UNION;
          S : STRUCT low : WORD; high : INT; END_STRUCT; V : UNION a : INT := 5; b : DINT; END_UNION; N : UNION next : REF_TO N; n : UDINT; END_UNION; END_TYPE
        FUNCTION Low : BYTE VAR_INPUT u : U; END_VAR Low := u.b[0]; END_FUNCTION
        PROGRAM P VAR u : U; v, w : V := (b := 65536); x : BYTE; n : N; r : REAL; first : DINT; list : ARRAY [1..2] OF U; y : DWORD; END_VAR
        first := v.b; u.r := 1.0; x := u.b[3]; y := u.d; u.s.high := 16384; r := u.r; u.b[0] := 7; x := x + 0; list[2] := u; list[1].d := list[2].d;
        n.next := REF(n); v.a := 2; END_PROGRAM"
            .replace("x := x + 0; ", "")
            .as_str(),
    );
    rig.scan().expect("no fault");
    assert_eq!((rig.int("P.x"), rig.int("P.y"), rig.real("P.r")), (0x3f, 0x3f80_0000, 2.0));
    assert_eq!((rig.int("P.list[1].s.low"), rig.int("P.first"), rig.int("P.v.b")), (7, 65536, 65538));
    assert_eq!(rig.int("P.n.n"), i64::from(rig.variable("P.n").offset));
    assert_eq!((rig.variable("P.u").size, rig.variable("P.u.b[2]").offset), (4, rig.variable("P.u").offset + 2));
}

#[test]
fn wrong_unions_are_reported() {
    for (text, expected) in [
        ("TYPE U : UNION a : INT; a : DINT; END_UNION END_TYPE", "error[N0102]"),
        ("TYPE U : UNION a : INT; b : U; END_UNION END_TYPE", "error[D0404]"),
        ("TYPE U : UNION a : INT; END_STRUCT END_TYPE", "error[S0101]"),
        (
            "TYPE U : UNION a : INT; END_UNION END_TYPE PROGRAM P VAR u : U; END_VAR u.c := 1; END_PROGRAM",
            "error[N0104]",
        ),
    ] {
        let found = findings(text);
        assert!(found.contains(expected), "{text}: {found}");
    }
}
