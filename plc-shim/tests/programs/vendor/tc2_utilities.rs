//! `Tc2_Utilities`: texts, conversions, formats, times, records in memory.

use onescan_iec::Dialect;

use super::hold;
use crate::rig::Rig;

#[test]
fn texts() {
    hold(
        Dialect::TwinCat,
        "",
        "",
        &[
            "F_LTrim('  a b ') = 'a b '",
            "F_RTrim('  a b ') = '  a b'",
            "F_LTrim(in := F_RTrim(in := '   ')) = ''",
            "F_LTrim('') = ''",
            "F_ToUCase('Hello, World 1') = 'HELLO, WORLD 1'",
            "F_ToLCase('Hello, World 1') = 'hello, world 1'",
            "F_ToUCase('$E4$F7$FF') = '$C4$F7$FF'",
            "F_ToLCase('$C4$D7') = '$E4$D7'",
            "F_ToCHR(65) = 'A' AND F_ToCHR(0) = ''",
            "F_ToASC('A') = 65 AND F_ToASC('') = 0",
        ],
    );
}

/// Characters with a 0 behind the last, whatever a STRING is in memory.
fn characters(name: &str, text: &str) -> String {
    let bytes: Vec<_> = text.bytes().chain([0]).map(|byte| byte.to_string()).collect();
    format!("{name} : ARRAY [0..19] OF BYTE := [{}];\n", bytes.join(", "))
}

/// A condition that an array holds a text with a 0 behind it.
fn is_text(name: &str, text: &str) -> String {
    let bytes = text.bytes().chain([0]).enumerate();
    bytes.map(|(index, byte)| format!("{name}[{index}] = {byte}")).collect::<Vec<_>>().join(" AND ")
}

#[test]
fn texts_at_addresses() {
    let declarations = characters("ab", "ab")
        + &characters("banana", "banana")
        + &characters("an", "an")
        + &characters("x", "X")
        + "a, b, c, d, e, f, left, right, all : ARRAY [0..19] OF BYTE; ok : ARRAY [0..9] OF BOOL; n, m : UDINT;\n"
        + &characters("deleted", "banana");
    let statements = "
        n := LEN2(ADR(banana)); m := FIND2(ADR(banana), ADR(an));
        ok[0] := CONCAT2(ADR(ab), ADR(banana), ADR(a), SIZEOF(a));
        ok[1] := CONCAT2(ADR(ab), ADR(banana), ADR(b), 5);
        ok[2] := INSERT2(ADR(ab), ADR(x), ADR(c), SIZEOF(c), 1);
        ok[3] := DELETE2(ADR(deleted), 2, 3);
        ok[4] := REPLACE2(ADR(banana), ADR(x), ADR(d), SIZEOF(d), 2, 2);
        ok[5] := FindAndReplace(ADR(an), ADR(x), ADR(banana), ADR(e), SIZEOF(e));
        ok[6] := FindAndDelete(ADR(an), ADR(banana), ADR(f), SIZEOF(f));
        ok[7] := FindAndSplit(ADR(an), ADR(banana), ADR(left), SIZEOF(left), ADR(right), SIZEOF(right), TRUE);
        ok[8] := FindAndSplitChar('z', ADR(banana), ADR(all), SIZEOF(all), ADR(all), 0, FALSE);";
    let rows = [
        "n = 6 AND m = 2 AND ok[0] AND NOT ok[1] AND ok[2] AND ok[3] AND ok[4] AND ok[5] AND ok[6] AND ok[7]"
            .to_owned(),
        is_text("a", "abbanana"),
        is_text("b", "abba"),
        is_text("c", "aXb"),
        is_text("deleted", "bana"),
        is_text("d", "bXana"),
        is_text("e", "bXXa"),
        is_text("f", "ba"),
        is_text("left", "ban"),
        is_text("right", "a"),
        is_text("all", "banana"),
        "NOT ok[8]".to_owned(),
    ];
    hold(Dialect::TwinCat, &declarations, statements, &rows.each_ref().map(String::as_str));
}

#[test]
fn numbers_as_texts() {
    hold(
        Dialect::TwinCat,
        "bytes : ARRAY [0..3] OF BYTE; n, m : UDINT; number : DWORD := 16#BECF1234;
         to_bcd : DEC_TO_BCD; from_bcd : BCD_TO_DEC;",
        "n := HEXSTR_TO_DATA('AB CDef', ADR(bytes), SIZEOF(bytes)); m := HEXSTR_TO_DATA('AG', ADR(bytes), 0);
         to_bcd(START := TRUE, DIN := 42); from_bcd(START := TRUE, BIN := 16#1A);",
        &[
            "BYTE_TO_HEXSTR(in := 16#AB, iPrecision := 2, bLoCase := FALSE) = 'AB'",
            "BYTE_TO_HEXSTR(16#B, 2, TRUE) = '0b'",
            "BYTE_TO_HEXSTR(0, 0, FALSE) = '' AND BYTE_TO_HEXSTR(0, 2, FALSE) = '00'",
            "WORD_TO_HEXSTR(16#1AB, 2, FALSE) = '1AB'",
            "DWORD_TO_HEXSTR(16#DEADBEEF, 8, FALSE) = 'DEADBEEF'",
            "LWORD_TO_HEXSTR(16#FEDC_BA98_7654_3210, 0, TRUE) = 'fedcba9876543210'",
            "BYTE_TO_BINSTR(5, 8) = '00000101' AND WORD_TO_OCTSTR(8, 3) = '010'",
            "DWORD_TO_DECSTR(4294967295, 0) = '4294967295' AND BYTE_TO_DECSTR(7, 3) = '007'",
            "DATA_TO_HEXSTR(ADR(number), SIZEOF(number), FALSE) = '34 12 CF BE'",
            "DATA_TO_HEXSTR(0, 3, FALSE) = ''",
            "n = 3 AND bytes[0] = 16#AB AND bytes[2] = 16#EF AND m = 0",
            "HEXASCNIBBLE_TO_BYTE(70) = 15 AND BYTE_TO_HEXASCNIBBLE(15, TRUE) = 102",
            "to_bcd.BOUT = 16#42 AND from_bcd.ERR AND NOT to_bcd.ERR",
            "LREAL_TO_FMTSTR(1.23456, 3, TRUE) = '1.235'",
            "LREAL_TO_FMTSTR(1.23456, 3, FALSE) = '1.234'",
            "LREAL_TO_FMTSTR(-0.5, 0, TRUE) = '-1' AND LREAL_TO_FMTSTR(9.999, 2, TRUE) = '10.00'",
            "LREAL_TO_FMTSTR(0.1, 20, FALSE) = '0.10000000000000000555'",
            "LREAL_TO_FMTSTR(1.0E22, 1, TRUE) = '10000000000000000000000.0'",
            "LREAL_TO_FMTSTR(0.0, 2, TRUE) = '0.00' AND LREAL_TO_FMTSTR(1.0E-9, 3, TRUE) = '0.000'",
            "ABS(DEG_TO_RAD(180.0) - PI) < 1E-12 AND ABS(RAD_TO_DEG(PI / 2) - 90.0) < 1E-12",
            "BE16_TO_HOST(16#1234) = 16#3412 AND HOST_TO_BE32(16#12345678) = 16#78563412",
            "HOST_TO_BE64(16#0102030405060708) = 16#0807060504030201",
        ],
    );
}

#[test]
fn formats() {
    let (i, d, u) = ("F_INT(i)", "F_DINT(d)", "F_UDINT(u)");
    let rows = [
        ("%d", i, "-42"),
        ("%+d|", d, "+1234567|"),
        ("%8d|", i, "     -42|"),
        ("%-8d|", i, "-42     |"),
        ("%08d", i, "-0000042"),
        ("%.5d", i, "-00042"),
        ("% d", d, " 1234567"),
        ("%u", u, "4294967295"),
        ("%x %%", u, "ffffffff %"),
        ("%#X", u, "16#FFFFFFFF"),
        ("%X", i, "FFD6"),
        ("%b", "F_BYTE(b)", "1000001"),
        ("%#.8b", "F_BYTE(b)", "2#01000001"),
        ("%o", "F_BYTE(b)", "101"),
        ("%c", "F_BYTE(b)", "A"),
        ("%f", "F_LREAL(l)", "3.141593"),
        ("%.2f", "F_LREAL(l)", "3.14"),
        ("%8.3f|", "F_LREAL(l)", "   3.142|"),
        ("%+.0f", "F_LREAL(l)", "+3"),
        ("%.1f", "F_REAL(r)", "-2.5"),
        ("%e", "F_LREAL(big)", "1.234560e+012"),
        ("%.2E", "F_REAL(r)", "-2.50E+000"),
        ("%d", "F_BOOL(t)", "1"),
        ("%d", "F_LINT(n)", "-9223372036854775808"),
        ("no argument", i, "no argument"),
    ];
    let conditions: Vec<String> =
        rows.iter().enumerate().map(|(at, (.., wanted))| format!("got[{at}] = '{wanted}' AND NOT bad[{at}]")).collect();
    let each = |(at, (format, argument, _)): (usize, &(&str, &str, &str))| {
        format!("f(sFormat := '{format}', arg1 := {argument}); got[{at}] := f.sOut; bad[{at}] := f.bError;\n")
    };
    let statements: String = rows.iter().enumerate().map(each).collect();
    let declarations = "f : FB_FormatString; i : INT := -42; d : DINT := 1234567; u : UDINT := 16#FFFFFFFF; b : BYTE := 65;
        l : LREAL := 3.14159265; r : REAL := -2.5; big : LREAL := 1.23456E12; t : BOOL := TRUE; n : LINT := -9223372036854775808;
        got : ARRAY [0..99] OF T_MaxString; bad : ARRAY [0..99] OF BOOL;";
    let conditions: Vec<&str> = conditions.iter().map(String::as_str).collect();
    hold(Dialect::TwinCat, declarations, &statements, &conditions);
}

#[test]
fn formats_with_several_arguments_and_errors() {
    hold(
        Dialect::TwinCat,
        "a, b, c, e, g : FB_FormatString; i : INT := 5; j : INT := 7; l : LREAL := 0.5; code : UDINT; text : T_MaxString;",
        "a(sFormat := '%d of %d: %.1f', arg1 := F_INT(i), arg2 := F_INT(j), arg3 := F_LREAL(l));
         b(sFormat := '%*d|', arg1 := F_INT(i), arg2 := F_INT(j));
         c(sFormat := 'x %d', arg1 := F_LREAL(l));
         e(sFormat := '%d %q', arg1 := F_INT(i), arg2 := F_INT(j));
         g(sFormat := '%d');
         code := F_FormatArgToStr(TRUE, FALSE, FALSE, FALSE, FALSE, TRUE, 6, FALSE, 0, 100, F_INT(i), text);",
        &[
            "a.sOut = '5 of 7: 0.5' AND NOT a.bError AND a.nErrId = 0",
            "b.sOut = '    7|'",
            "c.bError AND c.nErrId = 16#1001",
            "e.bError AND e.nErrId = 16#802",
            "g.nErrId = 16#1001",
            "code = 0 AND text = '    +5'",
        ],
    );
}

#[test]
fn times() {
    hold(
        Dialect::TwinCat,
        "moment : TIMESTRUCT := (wYear := 2024, wMonth := 5, wDay := 6, wHour := 7, wMinute := 8, wSecond := 9,
             wMilliseconds := 123); back : TIMESTRUCT; file : T_FILETIME; thursday : TIMESTRUCT := (wYear := 2026, wMonth := 1, wDay := 1);
         clock : FB_LocalSystemTime; nt : NT_GetTime; zone : FB_GetTimeZoneInformation;
         to_utc : FB_TzSpecificLocalTimeToSystemTime; from_utc : FB_SystemTimeToTzSpecificLocalTime;",
        "file := SYSTEMTIME_TO_FILETIME(moment); back := FILETIME_TO_SYSTEMTIME(file);
         clock(bEnable := TRUE); nt(START := TRUE); nt(); zone(bExecute := TRUE); zone();
         to_utc(in := moment, tzInfo := WEST_EUROPE_TZI); from_utc(in := to_utc.out, tzInfo := WEST_EUROPE_TZI);",
        &[
            "SYSTEMTIME_TO_DT(moment) = DT#2024-05-06-07:08:09",
            "DT_TO_SYSTEMTIME(DT#2024-05-06-07:08:09).wDayOfWeek = 1",
            "SYSTEMTIME_TO_STRING(moment) = '2024-05-06-07:08:09.123'",
            "STRING_TO_SYSTEMTIME('2024-05-06-07:08:09.123').wMilliseconds = 123",
            "file.dwHighDateTime = 16#01DA9F84 AND back.wSecond = 9 AND back.wMilliseconds = 123",
            "FILETIME_TO_DT(DT_TO_FILETIME(DT#2000-01-01-00:00:00)) = DT#2000-01-01-00:00:00",
            "DT_TO_FILETIME64(DT#1970-01-01-00:00:00) = 116444736000000000",
            "FILETIME64_TO_DCTIME64(DT_TO_FILETIME64(DT#2000-01-01-00:00:00)) = 0",
            "DCTIME64_TO_FILETIME64(0) = DT_TO_FILETIME64(DT#2000-01-01-00:00:00)",
            "FILETIME64_TO_DT(F_GetSystemTime()) = DT#1970-01-01-00:00:00",
            "F_YearIsLeapYear(2000) AND NOT F_YearIsLeapYear(1900) AND F_YearIsLeapYear(2024)",
            "F_GetMaxMonthDays(2024, 2) = 29 AND F_GetMaxMonthDays(2023, 2) = 28 AND F_GetMaxMonthDays(2023, 4) = 30",
            "F_GetDayOfWeek(moment) = 1 AND F_GetDayOfWeek(thursday) = 4",
            "F_GetWeekOfTheYear(moment) = 19 AND F_GetWeekOfTheYear(thursday) = 1",
            "F_GetDOYOfYearMonthDay(2024, 12, 31) = 366 AND F_GetMonthOfDOY(2024, 61) = 3",
            "clock.bValid AND clock.systemTime.wYear = 1970 AND clock.systemTime.wMilliseconds = 10",
            "nt.TIMESTR.wMilliseconds = 10 AND NOT nt.BUSY AND NOT nt.ERR",
            "zone.tzInfo.bias = 0 AND NOT zone.bBusy",
            "to_utc.out.wHour = 5 AND to_utc.eTzID = eTimeZoneID_Daylight",
            "from_utc.out.wHour = 7 AND from_utc.eTzID = eTimeZoneID_Daylight",
        ],
    );
}

/// The text and its number are those of the test of the timestamp in `TcUnit`'s advanced example.
#[test]
fn distributed_clocks() {
    hold(
        Dialect::TwinCat,
        "moment : Tc2_EtherCAT.T_DCTIME64 := 16#07C76560A71025C0; parts : DCTIMESTRUCT;",
        "parts := DCTIME64_TO_DCTIMESTRUCT(moment);",
        &[
            "DCTIME64_TO_STRING(in := moment) = '2017-10-05-14:15:44.425035200'",
            "DCTIME64_TO_STRING(16#FFFFFFFFFFFFFFFF) = '2584-07-20-23:34:33.709551615'",
            "STRING_TO_DCTIME64('2017-10-05-14:15:44.425035200') = moment",
            "parts.wDayOfWeek = 4 AND parts.wMilliseconds = 425 AND parts.wMicroseconds = 35 AND parts.wNanoseconds = 200",
            "DCTIME64_TO_STRING(Tc2_EtherCAT.F_GetCurDcTaskTime64()) = '2000-01-01-00:00:00.010000000'",
            "F_GetCurDcTickTime64() = F_GetCurDcTaskTime64() AND F_GetActualDcTime64() = F_GetCurDcTaskTime64()",
        ],
    );
}

#[test]
fn records_in_a_ring() {
    let text = "
    TYPE Entry : STRUCT n : DINT; x : LREAL; END_STRUCT END_TYPE
    PROGRAM P VAR
        ring : FB_MemRingBuffer; memory : ARRAY [0..49] OF BYTE; put, got : Entry;
        added, taken : INT; sum : DINT; i, round : INT; ok : BOOL := TRUE; short : DWORD; need : UDINT;
        texts : FB_StringRingBuffer; room : ARRAY [0..19] OF BYTE; a, b : T_MaxString; kept : UDINT;
    END_VAR
    ring.A_Reset();
    FOR round := 1 TO 20 DO
        FOR i := 1 TO 3 DO
            put.n := put.n + 1; put.x := 0.5;
            ring.A_AddTail(pWrite := ADR(put), cbWrite := SIZEOF(put), pBuffer := ADR(memory), cbBuffer := SIZEOF(memory));
            IF ring.bOk THEN added := added + 1; ELSE put.n := put.n - 1; END_IF
        END_FOR
        ok := ok AND ring.nCount = 2 AND ring.cbSize = 40;
        ring.pRead := ADR(short); ring.cbRead := 4; ring.A_GetHead();
        ok := ok AND NOT ring.bOk AND ring.cbReturn = 16;
        ring.pRead := ADR(got); ring.cbRead := SIZEOF(got);
        ring.A_GetHead(); ok := ok AND ring.bOk AND got.n = taken + 1;
        ring.A_RemoveHead(); taken := taken + 1; ok := ok AND ring.bOk AND got.n = taken AND got.x = 0.5;
    END_FOR
    texts(pBuffer := ADR(room), cbBuffer := SIZEOF(room));
    texts.putValue := 'first'; texts.A_AddTail(); texts.putValue := 'second'; texts.A_AddTail();
    ok := ok AND NOT texts.bOk;
    texts.bOverwrite := TRUE; texts.A_AddTail(); kept := texts.nCount;
    texts.A_GetHead(); a := texts.getValue; texts.A_RemoveHead(); texts.A_RemoveHead(); b := texts.getValue;
    END_PROGRAM";
    let mut rig = Rig::in_dialect(Dialect::TwinCat, text);
    rig.scan().expect("no fault");
    assert_eq!((rig.int("P.added"), rig.int("P.taken"), rig.int("P.kept")), (21, 20, 1));
    assert!(rig.bool("P.ok"));
    assert_eq!([rig.plc.read("P.a"), rig.plc.read("P.b")].map(|text| text.expect("it exists")), ["'second'", "''"]);
}
