//! Constructs as real code of the field has them, in programs of our own.

use onescan_iec::Dialect::{self, Codesys, TwinCat};

use crate::rig::{Rig, findings_in};

fn ran(dialect: Dialect, text: &str) -> Rig {
    let mut rig = Rig::in_dialect(dialect, text);
    rig.scan().expect("no fault");
    rig
}

#[test]
fn a_checksum_in_bytes() {
    let text = "FUNCTION checksum : BYTE
        VAR_INPUT size : INT; END_VAR
        VAR_IN_OUT data : ARRAY [0..7] OF BYTE; END_VAR
        VAR i : INT; END_VAR
        (* a (* nested *) comment *)
        checksum := 16#FF;
        FOR i := 0 TO size - 1 DO
            checksum := checksum XOR data[i];
            IF checksum > 127 THEN checksum := SHL(checksum, 1) XOR 16#07; ELSE checksum := SHL(checksum, 1); END_IF
        END_FOR
        END_FUNCTION
        PROGRAM P
        VAR data : ARRAY [0..7] OF BYTE := 1, 2, 3, 4, 4(16#A5); crc : BYTE; END_VAR
        crc := checksum(8, data);;
        END_PROGRAM";
    let mut crc = 0xff_u8;
    for byte in [1, 2, 3, 4, 0xa5, 0xa5, 0xa5, 0xa5_u8] {
        crc ^= byte;
        crc = if crc > 127 { (crc << 1) ^ 7 } else { crc << 1 };
    }
    assert_eq!(ran(Codesys, text).int("P.crc"), i64::from(crc));
}

#[test]
fn a_state_machine_of_an_enumeration() {
    let text = "{attribute 'qualified_only'}
        TYPE E_State : (Idle, Busy := 10, Done) INT; END_TYPE
        TYPE ST_Job : STRUCT
            sName : STRING(20) := 'none';
            {attribute 'hide'}
            tLimit : TIME := T#1.5s;
        END_STRUCT END_TYPE
        PROGRAM MAIN
        VAR eState : E_State; stJob : ST_Job := (sName := 'first', tLimit := T#20ms); fbTimer : TON; nRuns : UINT; bError : BOOL; END_VAR
        {warning 'not finished'}
        CASE eState OF
            E_State.Idle:
                fbTimer(IN := FALSE);
                eState := E_State.Busy;
            E_State.Busy:
                fbTimer(IN := TRUE, PT := stJob.tLimit);
                IF fbTimer.Q THEN eState := E_State.Done; END_IF
            E_State.Done:
                nRuns := nRuns + 1;
                eState := E_State.Idle;
            ELSE
                bError S= TRUE;
        END_CASE
        END_PROGRAM";
    let mut rig = ran(TwinCat, text);
    for _ in 0..5 {
        rig.scan().expect("no fault");
    }
    assert_eq!((rig.int("MAIN.nRuns"), rig.bool("MAIN.bError")), (1, false));
}

#[test]
fn time_since_the_last_call() {
    let text = "FUNCTION_BLOCK Elapsed
        VAR_OUTPUT ms : UDINT; END_VAR
        VAR last : TIME; init : BOOL; END_VAR
        VAR_TEMP now : TIME; END_VAR
        now := TIME();
        IF NOT init THEN init := TRUE; last := now; END_IF;
        ms := TIME_TO_UDINT(now - last);
        last := now;
        END_FUNCTION_BLOCK
        PROGRAM P VAR e : Elapsed; total : UDINT; END_VAR e(); total := total + e.ms; END_PROGRAM";
    let mut rig = ran(Codesys, text);
    assert_eq!(rig.int("P.total"), 0);
    rig.scan().expect("no fault");
    rig.scan().expect("no fault");
    assert_eq!((rig.int("P.e.ms"), rig.int("P.total")), (10, 20));
}

#[test]
fn what_no_vendor_s_runtime_has_here_is_reported() {
    let text = "PROGRAM P VAR a : INT; p, exc : UDINT; END_VAR
        __TRY
            a := a + 1;
        __CATCH(exc)
            a := 0;
        __ENDTRY
        p := TIME_TCK();
        IF a > 3 THEN JMP ende; END_IF
        a := a * 2;
        ende: a := a - 1;
        {IF hasvalue (x, '1')} a := 5; {END_IF}
        END_PROGRAM";
    insta::assert_snapshot!(findings_in(Codesys, text));
}
