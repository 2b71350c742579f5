//! SCL as classic STEP 7, PCS 7 and TIA Portal have it beside what `scl` shows.

use onescan_plc_shim::Dialect::SiemensScl;

use crate::rig::Rig;

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
