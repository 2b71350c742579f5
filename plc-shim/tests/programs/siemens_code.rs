//! SCL as classic STEP 7, PCS 7 and TIA Portal have it beside what `scl` shows.

use onescan_plc_shim::Dialect::SiemensScl;

use crate::rig::{Rig, findings_in};

fn after_a_scan(text: &str) -> Rig {
    let mut rig = Rig::in_dialect(SiemensScl, text);
    rig.scan().expect("no fault");
    rig
}

#[test]
fn headers_are_what_the_editors_write() {
    for version in ["0.1", "'1.5'", "\" 1.5\"", "' 2.0'"] {
        let text = format!(
            "FUNCTION_BLOCK FB41\nTITLE ='PID'\nAUTHOR : SIMATIC\nFAMILY : ICONT\nNAME : CONT_C\nVERSION : {version}
             VAR_INPUT a : INT; END_VAR VAR n : INT; END_VAR BEGIN n := a + 1; END_FUNCTION_BLOCK
             PROGRAM P VAR f : FB41; END_VAR f(a := 4); END_PROGRAM"
        );
        assert_eq!(after_a_scan(&text).int("P.f.n"), 5, "{version}");
    }
}

#[test]
fn the_last_statement_may_lack_its_semicolon() {
    let text = "PROGRAM P VAR a, b, c, d, i : INT; END_VAR BEGIN
        IF a = 0 THEN b := 1 ELSE b := 2 END_IF;
        CASE a OF 0: c := 3 ELSE c := 4 END_CASE;
        FOR i := 1 TO 3 DO d := d + i END_FOR; WHILE a < 5 DO a := a + 2 END_WHILE;
        REPEAT a := a + 1 UNTIL a > 8 END_REPEAT; END_PROGRAM";
    let rig = after_a_scan(text);
    assert_eq!(["a", "b", "c", "d"].map(|name| rig.int(&format!("P.{name}"))), [9, 1, 3, 6]);
}

#[test]
fn arrays_begin_with_values_without_brackets() {
    let text = "PROGRAM P VAR e : ARRAY [1..4] OF INT := 3 (7); f : ARRAY [0..2] OF INT := 1, 2 (5); r : INT; END_VAR
        BEGIN r := 1000 * e[1] + 100 * e[3] + 10 * e[4] + f[0] + f[1] + f[2]; END_PROGRAM";
    assert_eq!(after_a_scan(text).int("P.r"), 7711);
}

#[test]
fn variables_of_the_data_block_alone() {
    let text = "FUNCTION_BLOCK F VAR DB_SPECIFIC n : INT := 3; END_VAR BEGIN n := n + 1; END_FUNCTION_BLOCK
        PROGRAM P VAR f1 : F; END_VAR BEGIN f1(); END_PROGRAM";
    assert_eq!(after_a_scan(text).int("P.f1.n"), 4);
}

#[test]
fn constants_without_a_type_take_that_of_their_use() {
    let text = "FUNCTION_BLOCK F
        CONST LIM := 3; HALF := LIM / 2.0; MASK := W#16#0F; END_CONST
        VAR a : ARRAY [1..LIM] OF INT; r : REAL; w : WORD := W#16#1234; i, n : INT; END_VAR
        BEGIN
        FOR i := 1 TO LIM DO a[i] := LIM * i; END_FOR;
        r := HALF * 2.0; w := w AND MASK;
        CASE a[1] OF LIM: n := 1; ELSE n := 2; END_CASE;
        END_FUNCTION_BLOCK
        FUNCTION_BLOCK G VAR LIM : INT := 8; n : INT; END_VAR BEGIN n := LIM; END_FUNCTION_BLOCK
        PROGRAM P VAR f1 : F; g1 : G; END_VAR BEGIN f1(); g1(); END_PROGRAM";
    let rig = after_a_scan(text);
    assert_eq!(["f1.a[3]", "f1.w", "f1.n", "g1.n"].map(|name| rig.int(&format!("P.{name}"))), [9, 4, 1, 8]);
    assert!((rig.real("P.f1.r") - 3.0).abs() < 1e-6);
    let twice = "FUNCTION_BLOCK F CONST k := 1; END_CONST VAR k : INT; END_VAR BEGIN k := 2; END_FUNCTION_BLOCK";
    assert!(findings_in(SiemensScl, twice).iter().any(|found| found.code.text() == "N0102"));
}

#[test]
fn structures_without_a_name_are_alike_by_their_members() {
    let text = "TYPE T : STRUCT x : INT; y : BYTE; END_STRUCT END_TYPE
        PROGRAM P VAR a : STRUCT x : INT; y : BYTE; END_STRUCT; b : STRUCT X : INT; Y : BYTE; END_STRUCT; c : T; END_VAR
        BEGIN a.x := 7; a.y := B#16#2; b := a; c := b; END_PROGRAM";
    let rig = after_a_scan(text);
    assert_eq!(["b.x", "b.y", "c.x", "c.y"].map(|name| rig.int(&format!("P.{name}"))), [7, 2, 7, 2]);
    for other in ["X : INT; Z : BYTE", "X : UINT; Y : BYTE", "X : INT", "Y : BYTE; X : INT"] {
        let text = text.replace("X : INT; Y : BYTE", other);
        assert!(findings_in(SiemensScl, &text).iter().any(|found| found.code.text() == "T0201"), "{other}");
    }
}

#[test]
fn a_dint_becomes_a_real_by_itself() {
    let text = "PROGRAM P VAR n : REAL := 6.7; d : DINT := 16777217; r : REAL; i : DINT; END_VAR
        BEGIN n := ROUND(n + 0.4); r := d; i := REAL_TO_DINT(r); END_PROGRAM";
    let rig = after_a_scan(text);
    assert_eq!((rig.real("P.n"), rig.int("P.i")), (7.0, 16_777_216));
    let lossy = "PROGRAM P VAR l : LREAL; r : REAL; END_VAR BEGIN r := l; END_PROGRAM";
    assert!(findings_in(SiemensScl, lossy).iter().any(|found| found.code.text() == "T0201"));
}

#[test]
fn a_view_of_other_memory_is_refused_with_a_way_out() {
    let text = "FUNCTION_BLOCK F VAR_INPUT a : STRUCT hi : DINT; lo : DINT; END_STRUCT;
          v AT a : STRUCT x0 : DWORD; x1 : DWORD; END_STRUCT; END_VAR
        VAR n : INT; END_VAR BEGIN IF v.x0 = DW#16#0 THEN n := 1; END_IF; END_FUNCTION_BLOCK";
    insta::assert_snapshot!(findings_in(SiemensScl, text), @"test.st:2:16: error[L0501]: a view `AT` of the memory of `a` is not supported (there a value begins with its highest byte, here with its lowest: take it apart with SHR and conversions, or member by member)");
}
