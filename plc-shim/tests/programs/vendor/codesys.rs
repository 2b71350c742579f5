//! CODESYS: `Util`, `SysTime`, `SysFile`, `CAA` types.

use onescan_iec::Dialect;

use super::hold;
use crate::rig::Rig;

#[test]
fn bits() {
    hold(
        Dialect::Codesys,
        "u : UNPACK; b : BIT_AS_BYTE; w : BIT_AS_WORD; d : BIT_AS_DWORD; bb : BYTE_AS_BIT; wb : WORD_AS_BIT; db : DWORD_AS_BIT;",
        "u(B := 16#81); b(B0 := TRUE, B7 := TRUE); w(B00 := TRUE, B15 := TRUE); d(B01 := TRUE, B31 := TRUE);
         bb(B := 2); wb(W := 16#8000); db(X := 16#4000_0001);",
        &[
            "EXTRACT(X := 81, N := 4) AND NOT EXTRACT(33, 0) = FALSE AND GETBIT(2, 1)",
            "PUTBIT(38, 4, TRUE) = 54 AND PUTBIT(38, 1, FALSE) = 36",
            "SETBIT(0, 31) = 16#80000000 AND SWITCHBIT(1, 0) = 0",
            "PACK(TRUE, FALSE, FALSE, TRUE, FALSE, FALSE, FALSE, TRUE) = 16#89",
            "u.B0 AND u.B7 AND NOT u.B1",
            "b.B = 16#81 AND w.W = 16#8001 AND d.X = 16#80000002",
            "bb.B1 AND NOT bb.B0 AND wb.B15 AND NOT wb.B00 AND db.B00 AND db.B30 AND NOT db.B31",
            "BYTE_TO_GRAY(5) = 7 AND GRAY_TO_BYTE(7) = 5 AND GRAY_TO_DWORD(DWORD_TO_GRAY(16#DEADBEEF)) = 16#DEADBEEF",
            "GRAY_TO_WORD(WORD_TO_GRAY(16#1234)) = 16#1234",
            "BCD_TO_INT(73) = 49 AND BCD_TO_INT(151) = 97 AND BCD_TO_INT(15) = -1",
            "INT_TO_BCD(49) = 73 AND INT_TO_BCD(100) = 255",
            "WORD_TO_BCD(1234) = 16#1234 AND BCD_TO_DWORD(16#12345678) = 12345678 AND BYTE_TO_BCD(42) = 16#42",
            "BCD_TO_WORD(16#99) = 99 AND DWORD_TO_BCD(7) = 7 AND BCD_TO_BYTE(16#42) = 42",
            "BYTE_TO_HEXinASCII(16#A3) = 16#4133 AND HEXinASCII_TO_BYTE(16#4133) = 16#A3",
        ],
    );
}

#[test]
fn characteristics_and_statistics() {
    hold(
        Dialect::Codesys,
        "h : ARRAY [0..3] OF HYSTERESIS; l, m, n : LIMITALARM; t, e : LIN_TRAFO; c, beyond : CHARCURVE;
         points : ARRAY [0..10] OF POINT := [(X := 0, Y := 0), (X := 250, Y := 50), (X := 500, Y := 150), (X := 750, Y := 400), 7((X := 1000, Y := 1000))];
         si : STATISTICS_INT; sr : STATISTICS_REAL; v : VARIANCE; d : DERIVATIVE; i : INTEGRAL; k : INT; ramp : RAMP_INT; rise : RAMP_REAL;
         outside : BOOL; seen : ARRAY [0..3] OF BOOL;",
        "h[0](IN := 4, HIGH := 10, LOW := 5); seen[0] := h[0].OUT; h[0](IN := 7); seen[1] := h[0].OUT; h[0](IN := 11); seen[2] := h[0].OUT;
         l(IN := 11, HIGH := 10, LOW := 5); m(IN := 4, HIGH := 10, LOW := 5); n(IN := 7, HIGH := 10, LOW := 5);
         t(IN := 5.0, IN_MIN := 0.0, IN_MAX := 10.0, OUT_MIN := 100.0, OUT_MAX := 200.0); e(IN := 11.0, IN_MAX := 10.0, OUT_MAX := 1.0);
         c(IN := 375, N := 5, P := points); beyond(IN := 2000, N := 5, P := points);
         FOR k := 1 TO 4 DO
             si(IN := k * 10); sr(IN := INT_TO_REAL(k)); v(IN := INT_TO_REAL(k));
             d(IN := INT_TO_REAL(k) * 3.0, TM := 10); i(IN := 2.0, TM := 500);
         END_FOR
         ramp(IN := 0); ramp(IN := 10, ASCEND := 3); rise(IN := 0.0); rise(IN := -10.0, DESCEND := 4.0);",
        &[
            "seen[0] AND seen[1] AND NOT seen[2]",
            "l.O AND NOT l.U AND NOT l.IL AND m.U AND n.IL",
            "t.OUT = 150.0 AND NOT t.ERROR AND e.ERROR",
            "c.OUT = 100 AND c.ERR = 0 AND beyond.OUT = 1000 AND beyond.ERR = 2",
            "si.MN = 10 AND si.MX = 40 AND si.AVG = 25",
            "sr.MN = 1.0 AND sr.MX = 4.0 AND sr.AVG = 2.5",
            "ABS(v.OUT - 1.25) < 1E-6",
            "ABS(d.OUT - 300.0) < 1E-3",
            "ABS(i.OUT - 3.5) < 1E-6 AND NOT i.OVERFLOW",
            "ramp.OUT = 3 AND rise.OUT = -4.0",
        ],
    );
}

#[test]
fn signals_over_virtual_time() {
    let text = "PROGRAM P VAR
        b : BLINK; saw, triangle, sine : GEN; f : FREQ_MEASURE; r : RAMP_REAL; blinks, n : INT; was : BOOL;
        values : ARRAY [0..7] OF INT; END_VAR
        b(ENABLE := TRUE, TIMELOW := T#30MS, TIMEHIGH := T#20MS);
        IF b.OUT AND NOT was THEN blinks := blinks + 1; END_IF
        was := b.OUT;
        saw(MODE := GEN_MODE.SAWTOOTH_RISE, BASE := TRUE, PERIOD := T#100MS, AMPLITUDE := 100);
        triangle(MODE := GEN_MODE.TRIANGLE, BASE := FALSE, CYCLES := 8, AMPLITUDE := 10);
        sine(MODE := SINUS, BASE := FALSE, CYCLES := 4, AMPLITUDE := 100);
        IF n < 8 THEN values[n] := triangle.OUT; n := n + 1; END_IF
        f(IN := b.OUT, PERIODS := 2);
        r(IN := 100.0, ASCEND := 10.0, DESCEND := 10.0, TIMEBASE := T#100MS, RESET := n = 1);
    END_PROGRAM";
    let mut rig = Rig::in_dialect(Dialect::Codesys, text);
    for _ in 0..16 {
        rig.scan().expect("no fault");
    }
    assert_eq!(rig.int("P.blinks"), 4, "at 10, 60, 110 and 160 ms");
    assert_eq!(rig.int("P.saw.OUT"), 50, "150 ms after its first call");
    assert_eq!((0..8).map(|at| rig.int(&format!("P.values[{at}]"))).collect::<Vec<_>>(), [0, 5, 10, 5, 0, -5, -10, -5]);
    assert_eq!(rig.int("P.sine.OUT"), -100);
    assert!((rig.real("P.f.OUT") - 20.0).abs() < 1e-4 && rig.bool("P.f.VALID"));
    assert!((rig.real("P.r.OUT") - 15.0).abs() < 1e-4);
}

#[test]
fn controllers() {
    let text = "PROGRAM P VAR
        p : PID; fixed : PID_FIXCYCLE; pd1 : PD; limited, manual : PID; END_VAR
        p(ACTUAL := 8.0, SET_POINT := 10.0, KP := 3.0, TN := 0.1, TV := 0.0, Y_OFFSET := 1.0);
        fixed(ACTUAL := 8.0, SET_POINT := 10.0, KP := 3.0, TN := 0.1, TV := 0.0, Y_OFFSET := 1.0, CYCLE := 0.01);
        pd1(ACTUAL := 8.0, SET_POINT := 10.0, KP := 3.0, TV := 1.0);
        limited(ACTUAL := 0.0, SET_POINT := 10.0, KP := 3.0, TN := 0.1, Y_MIN := -5.0, Y_MAX := 5.0);
        manual(ACTUAL := 0.0, SET_POINT := 10.0, KP := 3.0, TN := 0.1, Y_MANUAL := 7.0, MANUAL := TRUE);
    END_PROGRAM";
    let mut rig = Rig::in_dialect(Dialect::Codesys, text);
    for _ in 0..11 {
        rig.scan().expect("no fault");
    }
    // 1 + 3 (2 + 2 * 0.1 s / 0.1 s)
    for name in ["P.p.Y", "P.fixed.Y"] {
        assert!((rig.real(name) - 13.0).abs() < 1e-3, "{name} {}", rig.real(name));
    }
    assert!((rig.real("P.pd1.Y") - 6.0).abs() < 1e-4);
    assert_eq!((rig.real("P.limited.Y"), rig.bool("P.limited.LIMITS_ACTIVE")), (5.0, true));
    assert_eq!(rig.real("P.manual.Y"), 7.0);
}

#[test]
fn the_clock() {
    hold(
        Dialect::Codesys,
        "us, ns, ms : SYSTIME; result : SysTypes.RTS_IEC_RESULT := 9; seconds, utc : DWORD; date, again : SYSTIMEDATE;
         codes : ARRAY [0..5] OF RTS_IEC_RESULT;",
        "codes[0] := SysTimeGetUs(us); codes[1] := SysTimeGetNs(ns); codes[2] := SysTimeRtcHighResGet(ms);
         seconds := SysTimeRtcGet(result);
         codes[3] := SysTimeRtcConvertUtcToDate(1714979289, date);
         codes[4] := SysTimeRtcConvertDateToUtc(date, utc);
         codes[5] := SysTimeRtcConvertHighResToDate(ms, again);",
        &[
            "SysTimeGetMs() = 10 AND us = 10000 AND ns = 10000000 AND ms = 10 AND seconds = 0",
            "result = CmpErrors.Errors.ERR_OK AND codes[5] = Errors.ERR_OK",
            "date.wYear = 2024 AND date.wMonth = 5 AND date.wDay = 6 AND date.wHour = 7 AND date.wMinute = 8",
            "date.wSecond = 9 AND date.wDayOfWeek = 1 AND date.wYday = 127 AND utc = 1714979289",
            "again.wYear = 1970 AND again.wMilliseconds = 10",
        ],
    );
}

#[test]
fn types_of_libraries_are_there() {
    hold(
        Dialect::TwinCat,
        "h : CAA.HANDLE; size : CAA.SIZE; error : CAA.ERROR; n : CAA.COUNT;
         class : IBaseLibrary.TypeClass := IBaseLibrary.TYPE_DATE;",
        "error := CAA.ERROR.ERR_TIME_OUT;",
        &["h = 0 AND n = 0 AND size = 0", "class = IBaseLibrary.TypeClass.TYPE_DATE AND error <> CAA.ERROR.NO_ERROR"],
    );
}

#[test]
fn files_are_kept_in_memory() {
    hold(
        Dialect::TwinCat,
        "handle : SysFile.SysTypes.RTS_IEC_HANDLE; result, none, closed, gone : RTS_IEC_RESULT; nobody : RTS_IEC_HANDLE;
         text : STRING(20) := 'one and two'; back : STRING(20); wrote, got, rest, size : RTS_IEC_SIZE;
         end, renamed, again, open : RTS_IEC_RESULT;",
        "nobody := SysFile.SysFileOpen('a.txt', SysFile.ACCESS_MODE.AM_READ, ADR(none));
         handle := SysFile.SysFileOpen('a.txt', SysFile.ACCESS_MODE.AM_APPEND_PLUS, ADR(result));
         wrote := SysFileWrite(handle, ADR(text), 11, ADR(result));
         SysFileSetPos(handle, 4);
         got := SysFileRead(handle, ADR(back), 20, ADR(result));
         end := SysFileEOF(handle);
         rest := SysFileRead(handle, ADR(back[8]), 1, ADR(result));
         open := SysFileDelete('a.txt');
         closed := SysFileClose(handle); again := SysFileClose(handle);
         renamed := SysFileRename('a.txt', 'b.txt'); size := SysFileGetSize('b.txt', 0);
         gone := SysFileDelete('b.txt');",
        &[
            "nobody = RTS_INVALID_HANDLE AND none = Errors.ERR_NO_OBJECT",
            "handle <> RTS_INVALID_HANDLE AND result = SysDir.CmpErrors.Errors.ERR_OK",
            "wrote = 11 AND got = 7 AND back = 'and two' AND rest = 0 AND end = Errors.ERR_OK",
            "open = Errors.ERR_FAILED AND closed = Errors.ERR_OK AND again = Errors.ERR_INVALID_HANDLE",
            "renamed = Errors.ERR_OK AND size = 11 AND gone = Errors.ERR_OK",
            "SysFileGetSize('b.txt', 0) = 0 AND SysFileDelete('b.txt') = Errors.ERR_NO_OBJECT",
        ],
    );
}

#[test]
fn files_have_an_end() {
    hold(
        Dialect::Codesys,
        "handle : RTS_IEC_HANDLE; result, full : RTS_IEC_RESULT; bytes : ARRAY [0..39999] OF BYTE; wrote : RTS_IEC_SIZE;
         i : INT; last : RTS_IEC_HANDLE; name : STRING;",
        "handle := SysFileOpen('big', AM_WRITE, ADR(result));
         wrote := SysFileWrite(handle, ADR(bytes), 40000, ADR(result));
         wrote := wrote + SysFileWrite(handle, ADR(bytes), 40000, ADR(full));
         FOR i := 1 TO 8 DO name := CONCAT('f', INT_TO_STRING(i)); last := SysFileOpen(name, AM_WRITE, ADR(result)); END_FOR",
        &[
            "wrote = 40000 AND full = Errors.ERR_NOMEMORY",
            "last = RTS_INVALID_HANDLE AND result = Errors.ERR_NOMEMORY",
        ],
    );
}

/// Addresses in the order of their bytes, and what is refused.
#[test]
fn sockets() {
    hold(
        Dialect::Codesys,
        "h, h2 : RTS_IEC_HANDLE; a : SOCKADDRESS; r, r2, r3, r4, r5 : RTS_IEC_RESULT; n : DINT; body : BYTE; ip : UDINT;",
        "h := SysSockCreate(SOCKET_AF_INET, SOCKET_STREAM, SOCKET_IPPROTO_TCP, ADR(r));
         h2 := SysSockCreate(SOCKET_AF_INET, SOCKET_DGRAM, SOCKET_IPPROTO_IP, ADR(r2));
         r3 := SysSockInetAddr('10.0.0.1', ADR(a.sin_addr));
         ip := a.sin_addr.ulAddr;
         r4 := SysSockConnect(h, ADR(a), SIZEOF(a));
         n := SysSockRecv(h, ADR(body), 1, 0, ADR(r5));",
        &[
            "r = Errors.ERR_OK AND h <> RTS_INVALID_HANDLE",
            "r2 = Errors.ERR_SOCK_AFUNSUPPORTED AND h2 = RTS_INVALID_HANDLE",
            "r3 = Errors.ERR_OK AND ip = 16#0100000A",
            "SysSockInetAddr('10.0.0.256', ADR(a.sin_addr)) = Errors.ERR_PARAMETER",
            "SysSockHtons(2727) = 16#A70A",
            "r4 = Errors.ERR_SOCK_HOSTUNREACHABLE",
            "n = -1 AND r5 = Errors.ERR_SOCK_NOTSOCKET",
            "SysSockClose(h) = Errors.ERR_OK AND SysSockClose(h) = Errors.ERR_SOCK_NOTSOCKET",
        ],
    );
}
