//! SIMATIC: scaling, date and time.

use onescan_iec::Dialect;

use super::hold;
use crate::rig::Rig;

#[test]
fn scaling() {
    hold(
        Dialect::SiemensScl,
        "r, u, b : Real; i, j : Int; w, w2, w3, w4 : Word; low : Int := -27648; raw : Int := 13824;",
        "w := SCALE(IN := 13824, HI_LIM := 100.0, LO_LIM := 0.0, BIPOLAR := FALSE, OUT => r);
         w2 := SCALE(IN := 30000, HI_LIM := 100.0, LO_LIM := 0.0, BIPOLAR := FALSE, OUT => u);
         w3 := SCALE(IN := low, HI_LIM := 100.0, LO_LIM := -100.0, BIPOLAR := TRUE, OUT => b);
         w4 := UNSCALE(IN := 50.0, HI_LIM := 100.0, LO_LIM := 0.0, BIPOLAR := FALSE, OUT => i);
         w4 := UNSCALE(IN := 500.0, HI_LIM := 100.0, LO_LIM := 0.0, BIPOLAR := FALSE, OUT => j);",
        &[
            "r = 50.0 AND w = W#16#0",
            "u = 100.0 AND w2 = W#16#8",
            "b = -100.0 AND w3 = W#16#0",
            "i = 13824 AND j = 27648 AND w4 = W#16#8",
            "NORM_X(MIN := 0, VALUE := raw, MAX := 27648) = 0.5",
            "SCALE_X(MIN := 10.0, VALUE := 0.5, MAX := 30.0) = 20.0",
            "SCALE_X(MIN := 0.0, VALUE := NORM_X(MIN := 0, VALUE := raw, MAX := 27648), MAX := 80.0) = 40.0",
            "SWAP(W#16#1234) = W#16#3412 AND SWAP(DW#16#12345678) = DW#16#78563412",
        ],
    );
}

#[test]
fn date_and_time() {
    hold(
        Dialect::SiemensScl,
        "now, local, a, b : DTL; error, error2 : Int; day : Date := D#2024-05-06; clock : Time_Of_Day := TOD#07:08:09;",
        "error := RD_SYS_T(OUT => now); error2 := RD_LOC_T(OUT => local);
         a := T_COMBINE(IN1 := day, IN2 := clock); b := a; b.SECOND := 4;",
        &[
            "error = 0 AND now.YEAR = 1970 AND now.NANOSECOND = 10000000 AND local.NANOSECOND = now.NANOSECOND",
            "T_ADD(IN1 := T#1s, IN2 := T#500ms) = T#1s500ms AND T_SUB(IN1 := T#1s, IN2 := T#500ms) = T#500ms",
            "a.YEAR = 2024 AND a.HOUR = 7 AND a.SECOND = 9 AND a.WEEKDAY = 2",
            "T_DIFF(IN1 := a, IN2 := b) = T#5s",
        ],
    );
}

/// A partner that is not a port of the scenario does not answer; wrong lengths and numbers are reported at once.
#[test]
fn open_communication_reports_what_is_wrong() {
    let mut rig = Rig::in_dialect(
        Dialect::SiemensScl,
        "PROGRAM P
        VAR
            partner, none : TCON_Param; send, long, nobody : TSEND_C; body : ARRAY [0..9] OF BYTE; scans, late : DINT;
            wrong, missing : WORD; errors : DINT;
        END_VAR
            partner.ID := 1; partner.ACTIVE_EST := TRUE;
            send(REQ := FALSE, CONT := TRUE, CONNECT := partner, DATA := body);
            IF send.ERROR AND send.STATUS = 16#80C4 THEN errors := errors + 1; IF late = 0 THEN late := scans; END_IF; END_IF;
            long(REQ := TRUE, CONT := TRUE, LEN := 11, CONNECT := partner, DATA := body);
            IF long.ERROR AND wrong = 0 THEN wrong := long.STATUS; END_IF;
            nobody(REQ := TRUE, CONT := TRUE, CONNECT := none, DATA := body);
            missing := nobody.STATUS;
            scans := scans + 1;
        END_PROGRAM",
    );
    for _ in 0..2_500 {
        rig.scan().expect("no fault");
    }
    assert_eq!((rig.int("P.wrong"), rig.int("P.missing")), (0x8088, 0x8086));
    assert_eq!((rig.int("P.errors"), rig.int("P.late")), (2, 1_000), "every 10 s, at scans of 10 ms");
    assert!(rig.bool("P.send.BUSY"), "it goes on asking");
}

#[test]
fn a_module_that_is_not_there_is_reported() {
    hold(
        Dialect::SiemensScl,
        "send : SEND_PTP; get : RCV_PTP; body : ARRAY [0..9] OF BYTE;",
        "send(REQ := TRUE, PORT := 270, BUFFER := body, LENGTH := 0); get(EN_R := TRUE, PORT := 270, BUFFER := body);",
        &["send.ERROR AND send.STATUS = W#16#8090", "get.ERROR AND get.STATUS = W#16#8090 AND NOT get.NDR"],
    );
}
