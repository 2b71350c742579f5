//! Lines of bytes under the blocks of other vendors: Siemens' open and point-to-point communication, CODESYS' sockets.

use onescan_iec::Dialect;
use onescan_server::client::Client;
use onescan_server::lockstep::{Lockstep, Reached};
use onescan_soft_plc::ports::PlcWay;
use onescan_stream::Form;
use onescan_stream::connection::{Cuts, Role};
use onescan_tests::at_ms;
use onescan_tests::run::in_process;

use crate::streams::{Device, Habit, no_way_changes_a_bit, number, serial_rate, session_plan, soft_plc_in, tcp};

/// 1,026 bytes go to a partner and come back, over one connection of two blocks.
const TSEND_C: &str = "
PROGRAM Fast
END_PROGRAM
PROGRAM Main
VAR_OUTPUT got, right : DINT; END_VAR
VAR
    partner : TCON_Param; send : TSEND_C; receive : TRCV_C; bytes, body : ARRAY [0..1025] OF BYTE; i, scans, failed : DINT;
END_VAR
    IF scans = 0 THEN
        partner.ID := 1;
        partner.ACTIVE_EST := TRUE;
        partner.REM_STADDR[1] := 192;
        partner.REM_STADDR[2] := 168;
        partner.REM_STADDR[3] := 42;
        partner.REM_STADDR[4] := 30;
        partner.REM_TSAP_ID[1] := 16#0A;
        partner.REM_TSAP_ID[2] := 16#A7;
        FOR i := 0 TO 1025 DO bytes[i] := DINT_TO_BYTE((i * 7) MOD 251); END_FOR;
    END_IF;
    scans := scans + 1;
    send(REQ := scans > 20, CONT := TRUE, LEN := 0, CONNECT := partner, DATA := bytes);
    receive(EN_R := got = 0, CONT := TRUE, LEN := 0, CONNECT := partner, DATA := body);
    IF send.ERROR OR receive.ERROR THEN
        failed := failed + 1;
    END_IF;
    IF receive.DONE AND receive.RCVD_LEN > 0 THEN
        FOR i := 0 TO 1025 DO
            IF body[i] = bytes[i] THEN right := right + 1; END_IF;
        END_FOR;
        got := 1026 - failed;
    END_IF;
END_PROGRAM";

/// The same by a communication module.
const SEND_PTP: &str = "
PROGRAM Fast
END_PROGRAM
PROGRAM Main
VAR_OUTPUT got, right : DINT; END_VAR
VAR send : SEND_PTP; receive : RCV_PTP; bytes, body : ARRAY [0..1025] OF BYTE; i, scans : DINT; done : DINT; END_VAR
    IF scans = 0 THEN
        FOR i := 0 TO 1025 DO bytes[i] := DINT_TO_BYTE((i * 7) MOD 251); END_FOR;
    END_IF;
    scans := scans + 1;
    send(REQ := scans > 20, PORT := 270, BUFFER := bytes, LENGTH := 0);
    receive(EN_R := TRUE, PORT := 270, BUFFER := body);
    IF receive.NDR THEN
        FOR i := 0 TO UINT_TO_DINT(receive.LENGTH) - 1 DO
            IF body[i] = bytes[got] THEN right := right + 1; END_IF;
            got := got + 1;
        END_FOR;
    END_IF;
END_PROGRAM";

/// A message of 10 bytes comes as one, ended by the pause behind it.
const MESSAGE: &str = "
PROGRAM Fast
END_PROGRAM
PROGRAM Main
VAR_OUTPUT got, right : DINT; END_VAR
VAR send : Send_P2P; receive : Receive_P2P; bytes : ARRAY [0..9] OF BYTE; body : ARRAY [0..99] OF BYTE; scans : DINT; END_VAR
    scans := scans + 1;
    send(REQ := scans > 20, PORT := 270, BUFFER := bytes, LENGTH := 10);
    receive(PORT := 270, BUFFER := body);
    IF receive.NDR THEN
        got := got + 1;
        IF receive.LENGTH = 10 AND receive.STATUS = 16#0096 THEN
            right := right + 1;
        END_IF;
    END_IF;
END_PROGRAM";

const SYSSOCK: &str = "
PROGRAM Fast
END_PROGRAM
PROGRAM Main
VAR_OUTPUT got, right : DINT; END_VAR
VAR
    hSocket : RTS_IEC_HANDLE; address : SOCKADDRESS; result : RTS_IEC_RESULT; step : INT; n, sent, i : DINT;
    bytes, body : ARRAY [0..1099] OF BYTE; nonBlocking : DINT := 1;
END_VAR
    CASE step OF
        0:
            FOR i := 0 TO 1025 DO bytes[i] := DINT_TO_BYTE((i * 7) MOD 251); END_FOR
            hSocket := SysSockCreate(SOCKET_AF_INET, SOCKET_STREAM, SOCKET_IPPROTO_TCP, ADR(result));
            result := SysSockIoctl(hSocket, SOCKET_FIONBIO, ADR(nonBlocking));
            address.sin_family := SOCKET_AF_INET;
            address.sin_port := SysSockHtons(2727);
            result := SysSockInetAddr('192.168.42.30', ADR(address.sin_addr));
            step := 1;
        1:
            IF SysSockConnect(hSocket, ADR(address), SIZEOF(address)) = Errors.ERR_OK THEN step := 2; END_IF
        2:
            n := SysSockSend(hSocket, ADR(bytes[sent]), 1026 - sent, 0, ADR(result));
            IF n > 0 THEN sent := sent + n; END_IF
            IF sent = 1026 THEN step := 3; END_IF
        3:
            n := SysSockRecv(hSocket, ADR(body), 1100, 0, ADR(result));
            FOR i := 0 TO n - 1 DO
                IF body[i] = bytes[got] THEN right := right + 1; END_IF
                got := got + 1;
            END_FOR
            IF got >= 1026 THEN step := 4; END_IF
        4:
            result := SysSockClose(hSocket);
            step := 5;
    END_CASE
END_PROGRAM";

fn module() -> PlcWay {
    PlcWay::Module { rate: serial_rate(), number: 270, receive_buffer: None }
}

/// A device that sends back what it gets, and a program.
fn echo(dialect: Dialect, text: &str, way: PlcWay) -> Vec<Box<dyn Client>> {
    let form = match way {
        PlcWay::Tcp { cuts, .. } => Form::Connection(Role::Listens, cuts),
        PlcWay::Serial { rate, .. } | PlcWay::Module { rate, .. } => Form::Serial(rate),
    };
    vec![Device::boxed(form, Habit::Echo), Box::new(soft_plc_in(dialect, text, 2, way))]
}

fn counted(mut lockstep: Lockstep) -> [i32; 2] {
    assert_eq!(lockstep.run_to(at_ms(4_000)).expect("nothing is recorded"), Reached::Boundary);
    ["got", "right"].map(|name| number(&lockstep, name))
}

#[test]
fn what_is_sent_comes_back_over_a_connection_of_siemens_blocks() {
    for cuts in [Cuts::Nowhere, Cuts::Behind(500), Cuts::Every(37), Cuts::Random] {
        let clients = echo(Dialect::SiemensScl, TSEND_C, tcp(cuts));
        assert_eq!(counted(in_process(session_plan(), clients)), [1026, 1026], "{cuts:?}");
    }
}

#[test]
fn what_is_sent_comes_back_over_a_line_of_siemens_blocks() {
    let clients = echo(Dialect::SiemensScl, SEND_PTP, module());
    assert_eq!(counted(in_process(session_plan(), clients)), [1026, 1026]);
    let clients = echo(Dialect::SiemensScl, MESSAGE, module());
    assert_eq!(counted(in_process(session_plan(), clients)), [1, 1], "one message, as it was sent");
}

#[test]
fn what_is_sent_comes_back_over_a_socket_of_codesys() {
    for cuts in [Cuts::Nowhere, Cuts::Every(37)] {
        let clients = echo(Dialect::Codesys, SYSSOCK, tcp(cuts));
        assert_eq!(counted(in_process(session_plan(), clients)), [1026, 1026], "{cuts:?}");
    }
}

#[test]
fn neither_transport_nor_a_checkpoint_on_the_way_changes_a_bit() {
    for (dialect, text, way) in [
        (Dialect::SiemensScl, TSEND_C, tcp(Cuts::Every(100))),
        (Dialect::SiemensScl, SEND_PTP, module()),
        (Dialect::Codesys, SYSSOCK, tcp(Cuts::Every(100))),
    ] {
        no_way_changes_a_bit(|| echo(dialect, text, way.clone()));
    }
}
