//! TwinCAT: `Tc2_SerialCom`, `Tc2_TcpIp` and the files of `Tc2_System`.

use onescan_iec::Dialect;

use crate::rig::Rig;

fn rig(text: &str) -> Rig {
    Rig::in_dialect(Dialect::TwinCat, text)
}

#[test]
fn a_line_control_keeps_the_handshake_of_its_terminal() {
    let mut rig = rig("PROGRAM P
        VAR
            in : KL6inData22B; out : KL6outData22B; line : SerialLineControl; tx, rx : ComBuffer;
            send : SendData; get : ReceiveByte; bytes : ARRAY [0..29] OF BYTE; n : INT; got : BYTE; asked : BOOL;
            wrong : SerialLineControl; code : INT;
        END_VAR
            IF asked THEN
                send(pSendData := ADR(bytes), Length := 30, TxBuffer := tx);
                asked := FALSE;
            END_IF
            line(Mode := SERIALLINEMODE_KL6_22B_STANDARD, pComIn := ADR(in), pComOut := ADR(out), SizeComIn := SIZEOF(in),
                TxBuffer := tx, RxBuffer := rx);
            get(RxBuffer := rx, ReceivedByte => got);
            IF get.ByteReceived THEN n := n + 1; END_IF
            wrong(Mode := SERIALLINEMODE_KL6_5B_STANDARD, TxBuffer := tx, RxBuffer := rx);
            code := wrong.ErrorID;
        END_PROGRAM");
    rig.scan().expect("no fault");
    assert_eq!(rig.int("P.out.Ctrl"), 4, "it asks for the initialisation");
    assert_eq!(rig.int("P.code"), 0x101, "no such mode");
    rig.set("P.in.Status", 4);
    rig.scan().expect("no fault");
    assert_eq!(rig.int("P.out.Ctrl"), 0, "and takes back what is accepted");
    rig.set("P.in.Status", 0);
    rig.set("P.asked", 1);
    rig.scan().expect("no fault");
    rig.scan().expect("no fault");
    assert_eq!(rig.int("P.out.Ctrl"), 22 * 256 + 1, "22 of 30 bytes go first");
    rig.scan().expect("no fault");
    assert_eq!(rig.int("P.out.Ctrl"), 22 * 256 + 1, "nothing until they are taken");
    rig.set("P.in.Status", 1);
    rig.scan().expect("no fault");
    assert_eq!(rig.int("P.out.Ctrl"), 8 * 256, "then the other 8");
    // 3 bytes arrive
    rig.set("P.in.D[2]", 77);
    rig.set("P.in.Status", 3 * 256 + 3);
    for _ in 0..4 {
        rig.scan().expect("no fault");
    }
    assert_eq!((rig.int("P.n"), rig.int("P.got")), (3, 77));
    assert_eq!(rig.int("P.out.Ctrl") & 2, 2);
}

#[test]
fn texts_and_data_end_where_they_are_said_to() {
    let mut rig = rig("PROGRAM P
        VAR
            rx, tx : ComBuffer; get : ReceiveString; send : SendString; data : ReceiveData; text : STRING; n, m, late : INT;
            body : ARRAY [0..9] OF BYTE; one : SendByte; i : INT; step : INT;
        END_VAR
            CASE step OF
                0: send(SendString := 'xx<ab>', TxBuffer := rx);
                1: send(SendString := '<cd', TxBuffer := rx);
                4: FOR i := 1 TO 10 DO one(SendByte := INT_TO_BYTE(i), TxBuffer := tx); END_FOR
            END_CASE
            get(Prefix := '<', Suffix := '>', Timeout := T#25ms, ReceivedString := text, RxBuffer := rx);
            IF get.StringReceived THEN n := n + 1; END_IF
            IF get.RxTimeout THEN late := step; END_IF
            data(pReceiveData := ADR(body), SizeReceiveData := 10, RxBuffer := tx);
            IF data.DataReceived THEN m := m + 1; END_IF
            step := step + 1;
        END_PROGRAM");
    for _ in 0..8 {
        rig.scan().expect("no fault");
    }
    assert_eq!((rig.int("P.n"), rig.int("P.m"), rig.int("P.body[9]")), (1, 1, 10));
    assert_eq!(rig.text("P.text"), "<ab>");
    assert_eq!(rig.int("P.late"), 4, "three scans of 10 ms after its last byte");
}

#[test]
fn files_are_written_and_read_back_by_line() {
    let mut rig = rig("PROGRAM P
        VAR
            open : FB_FileOpen; put : FB_FilePuts; gets : FB_FileGets; close : FB_FileClose; seek : FB_FileSeek;
            tell : FB_FileTell; eof : FB_EOF; none : FB_FileOpen; bad : FB_FileClose; step : INT; line : STRING; place : DINT;
            missing, handle : UDINT;
        END_VAR
            open(sPathName := 'C:\\TwinCAT\\log.txt', nMode := FOPEN_MODEWRITE OR FOPEN_MODEPLUS OR FOPEN_MODETEXT,
                bExecute := step >= 1);
            put(hFile := open.hFile, sLine := 'first$Nsecond$N', bExecute := step >= 4);
            tell(hFile := open.hFile, bExecute := step >= 7);
            place := tell.nSeekPos;
            seek(hFile := open.hFile, nSeekPos := 7, bExecute := step >= 10);
            gets(hFile := open.hFile, bExecute := step >= 13);
            eof(hFile := open.hFile, bExecute := step >= 16);
            close(hFile := open.hFile, bExecute := step >= 19);
            none(sPathName := 'nowhere.txt', nMode := FOPEN_MODEREAD, bExecute := step >= 1);
            missing := none.nErrId;
            bad(hFile := 9, bExecute := step >= 1);
            handle := bad.nErrId;
            step := step + 1;
        END_PROGRAM");
    for _ in 0..24 {
        rig.scan().expect("no fault");
    }
    assert_eq!((rig.int("P.missing"), rig.int("P.handle")), (0x70c, 0x703));
    assert_eq!(rig.int("P.place"), 15, "each line ends with CR LF in the file");
    assert_eq!(rig.text("P.gets.sLine"), "second\n");
    assert!(rig.bool("P.eof.bEOF"));
    assert!(!rig.bool("P.close.bError") && !rig.bool("P.put.bError"));
}

#[test]
fn a_socket_without_a_port_ends_by_its_time_out() {
    let mut rig = rig("PROGRAM P
        VAR connect : FB_SocketConnect; send : FB_SocketSend; code, lost : UDINT; END_VAR
            connect(sRemoteHost := '10.0.0.1', nRemotePort := 2727, bExecute := TRUE, tTimeout := T#50ms);
            code := connect.nErrId;
            send(hSocket := connect.hSocket, bExecute := TRUE);
            lost := send.nErrId;
        END_PROGRAM");
    for _ in 0..4 {
        rig.scan().expect("no fault");
    }
    assert!(rig.bool("P.connect.bBusy"));
    assert_eq!(rig.int("P.lost"), 0x8002);
    for _ in 0..4 {
        rig.scan().expect("no fault");
    }
    assert_eq!(rig.int("P.code"), 1861);
}

#[test]
fn a_loop_that_waits_for_a_byte_within_a_scan_is_a_fault_with_its_line() {
    let mut rig = rig("PROGRAM P
        VAR rx : ComBuffer; get : ReceiveByte; END_VAR
            WHILE NOT get.ByteReceived DO
                get(RxBuffer := rx);
            END_WHILE
        END_PROGRAM");
    let fault = rig.scan().expect_err("nobody sends within a scan");
    assert_eq!((fault.at.file.as_str(), fault.at.line), ("test.st", 3));
    assert!(fault.to_string().contains("loop"), "{fault}");
}

#[test]
fn a_connection_of_net_base_services_is_begun_and_given_up() {
    let mut rig = Rig::in_dialect(
        Dialect::Codesys,
        "PROGRAM P
        VAR client : NBS.TCP_Client; read : NBS.TCP_Read; ip : NBS.IP_ADDR := (sAddr := '10.0.0.1'); code, bad : INT; body : BYTE;
        END_VAR
            client(xEnable := TRUE, udiTimeOut := 50000, ipAddr := ip, uiPort := 2000);
            code := client.eError;
            read(xEnable := TRUE, hConnection := client.hConnection, szSize := 1, pData := ADR(body));
            bad := read.eError;
        END_PROGRAM",
    );
    rig.scan().expect("no fault");
    assert!(rig.bool("P.client.xBusy"));
    for _ in 0..8 {
        rig.scan().expect("no fault");
    }
    assert_eq!((rig.int("P.code"), rig.int("P.bad")), (6001, 6003));
}
