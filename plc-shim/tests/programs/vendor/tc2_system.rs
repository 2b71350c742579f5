//! `Tc2_System`: types, constants, messages, counters.

use onescan_iec::Dialect;

use super::hold;
use crate::rig::{Rig, findings_in};

#[test]
fn constants_and_functions() {
    hold(
        Dialect::TwinCat,
        "ids : T_AmsNetIdArr := [127, 16, 17, 3, 1, 1]; ip : T_IPv4AddrArr := [172, 16, 7, 199];
         version : ST_LibVersion := (iMajor := 2, iMinor := 1); flag : BOOL; guard : FB_IecCriticalSection;
         address : Global.AMSADDR; size : ARRAY [1..MAX_STRING_LENGTH] OF BYTE; open : E_OpenPath := PATH_BOOTPATH;",
        "address.netId := ids;",
        &[
            "MAX_STRING_LENGTH = 255",
            "UPPER_BOUND(size, 1) = 255",
            "ADSLOG_MSGTYPE_ERROR = 4 AND ADSLOG_MSGTYPE_STRING = 16#80",
            "Tc2_System.ADSLOG_MSGTYPE_LOG = 16#10",
            "DEFAULT_ADS_TIMEOUT = T#5S",
            "F_CreateAmsNetId(ids) = '127.16.17.3.1.1'",
            "F_ScanAmsNetIds('127.16.17.3.1.1')[1] = 16",
            "F_ScanAmsNetIds('127.16.17.3.1')[0] = 0",
            "F_ScanAmsNetIds('127.16.256.3.1.1')[0] = 0",
            "F_CreateIPv4Addr(ip) = '172.16.7.199'",
            "F_ScanIPv4AddrIds('172.16.7.199')[3] = 199",
            "F_CmpLibVersion(version, 2, 1, 0, 0) = 0",
            "F_CmpLibVersion(version, 1, 9, 9, 9) = 1",
            "F_CmpLibVersion(version, 2, 2, 0, 0) = -1",
            "TestAndSet(flag) AND NOT TestAndSet(flag)",
            "guard.Enter() AND guard.Leave()",
            "SETBIT32(0, 31) = 16#80000000 AND CLEARBIT32(16#FF, 0) = 16#FE AND GETBIT32(4, 2)",
            "CSETBIT32(0, 15, TRUE) = 16#8000 AND CSETBIT32(16#8000, 15, FALSE) = 0",
            "address.netId[2] = 17",
            "E_OpenPath.PATH_BOOTPATH = 4 AND open = PATH_BOOTPATH AND Tc2_System.PATH_BOOTPATH = open",
            "Tc2_System.Global_Constants.MAX_STRING_LENGTH = 255",
            "TwinCAT_SystemInfoVarList._AppInfo.ProjectName = 'onescan' AND TwinCAT_SystemInfoVarList._AppInfo.TaskCnt = 1",
        ],
    );
}

#[test]
fn messages_are_counted_and_the_last_ones_are_kept() {
    hold(
        Dialect::TwinCat,
        "a, b, c : DINT; text : T_MaxString;",
        "a := ADSLOGSTR(ADSLOG_MSGTYPE_HINT OR ADSLOG_MSGTYPE_LOG, 'Door %s is open', 'A');
         text := OnescanAdsLog.text;
         b := ADSLOGLREAL(ADSLOG_MSGTYPE_WARN, 'value %f', 1.5);
         c := ADSLOGDINT(msgCtrlMask := ADSLOG_MSGTYPE_ERROR, msgFmtStr := '%d parts', dintArg := -3);",
        &[
            "a = 0 AND b = 0 AND c = 0",
            "text = 'Door A is open'",
            "OnescanAdsLog.text = '-3 parts'",
            "OnescanAdsLog.count = 3",
            "OnescanAdsLog.texts[0] = text AND OnescanAdsLog.texts[2] = OnescanAdsLog.text",
            "OnescanAdsLog.masks[0] = 16#11 AND OnescanAdsLog.masks[1] = ADSLOG_MSGTYPE_WARN",
            "OnescanAdsLog.mask = ADSLOG_MSGTYPE_ERROR",
        ],
    );
}

#[test]
fn counters_show_virtual_time() {
    hold(
        Dialect::TwinCat,
        "cpu : GETCPUCOUNTER; used : GETCPUACCOUNT; clock : GETSYSTEMTIME; one, other : DRAND;",
        "cpu(); used(); clock(); one(Seed := 5); other(Seed := 5);",
        &[
            // 10 ms
            "cpu.cpuCntLoDW = 100000 AND cpu.cpuCntHiDW = 0 AND used.cpuAccountDW = 100000",
            "clock.timeHiDW = 16#019DB1DE AND clock.timeLoDW = 16#D53E8000 + 100000",
            "one.Num = other.Num AND one.Num >= 0.0 AND one.Num < 1.0",
        ],
    );
}

#[test]
fn tasks_know_their_number_and_their_cycles() {
    let text = "PROGRAM P VAR
            current : GETCURTASKINDEX; index : DINT; count, before : UDINT; first : BOOL; firsts : INT;
            cycle : UDINT; name : STRING;
        END_VAR
        current();
        index := GETCURTASKINDEXEX();
        before := count;
        count := TwinCAT_SystemInfoVarList._TaskInfo[current.index].CycleCount;
        first := _TaskInfo[index].FirstCycle;
        IF first THEN firsts := firsts + 1; END_IF
        cycle := F_GetTaskInfo().CycleTime;
        name := _TaskInfo[index].TaskName;
    END_PROGRAM";
    let mut rig = Rig::in_dialect(Dialect::TwinCat, text);
    for _ in 0..3 {
        rig.scan().expect("no fault");
    }
    assert_eq!(
        ["index", "before", "count", "firsts", "cycle"].map(|name| rig.int(&format!("P.{name}"))),
        [1, 2, 3, 1, 100_000]
    );
    assert!(!rig.bool("P.first"));
    rig.plc.warm_start();
    rig.scan().expect("no fault");
    assert_eq!((rig.int("P.count"), rig.bool("P.first")), (1, true));
}

#[test]
fn a_users_own_declaration_goes_before() {
    let text = "
        TYPE T_MaxString : STRING(10); END_TYPE
        FUNCTION_BLOCK FB_IecCriticalSection VAR_OUTPUT own : INT := 7; END_VAR END_FUNCTION_BLOCK
        FUNCTION_BLOCK TON VAR_INPUT IN : INT; END_VAR VAR_OUTPUT Q : INT; END_VAR Q := IN + 1; END_FUNCTION_BLOCK
        VAR_GLOBAL ADSLOG_MSGTYPE_HINT : INT := 5; END_VAR
        TYPE Mine : (PATH_GENERIC := 40); END_TYPE
        PROGRAM P VAR a : FB_IecCriticalSection; t : TON; s : T_MaxString := '0123456789abc'; x, y, l, p, d : INT; END_VAR
            a(); t(IN := 4); x := a.own; y := t.Q + ADSLOG_MSGTYPE_HINT; l := LEN(s); p := PATH_GENERIC;
            d := DINT_TO_INT(ADSLOGSTR(Tc2_System.ADSLOG_MSGTYPE_HINT, 'longer than 10 characters', ''));
            d := LEN(OnescanAdsLog.text);
        END_PROGRAM";
    for dialect in [Dialect::TwinCat, Dialect::Codesys] {
        let mut rig = Rig::in_dialect(dialect, text);
        rig.scan().expect("no fault");
        assert_eq!(["x", "y", "l", "p", "d"].map(|name| rig.int(&format!("P.{name}"))), [7, 10, 10, 40, 25]);
    }
    let reported = findings_in(Dialect::Iec3, "FUNCTION_BLOCK TON END_FUNCTION_BLOCK").to_string();
    assert!(reported.contains("`TON` is a name of the standard"), "{reported}");
}

#[test]
fn events_are_kept_and_counted() {
    hold(
        Dialect::TwinCat,
        "message : FB_TcMessage; alarm : FB_TcAlarm; source : FB_TcSourceInfo; any : I_TcMessage; h : ARRAY [0..4] OF HRESULT;
         entry : TcEventEntry := (nEventID := 7, eSeverity := TcEventSeverity.Error); arguments : I_TcArguments; Error : INT := 3;",
        "source.sName := 'here'; h[0] := message.CreateEx(entry, source); arguments := message.ipArguments.AddInt(4).AddString('x');
         any := message; h[1] := any.Send(0); h[2] := message.Send(nTimeStamp := 0);
         h[3] := alarm.Create(entry.uuidEventClass, 8, TcEventSeverity.Warning, FALSE, 0); h[4] := alarm.Raise(0);",
        &[
            "message.nEventId = 7 AND message.eSeverity = TcEventSeverity.Error AND Error = 3",
            "message.ipSourceInfo.sName = 'here' AND message.ipArguments.nCount = 2",
            "message.OnescanSent = 2 AND alarm.bRaised AND alarm.eSeverity = TcEventSeverity.Warning",
        ],
    );
}

#[test]
fn an_alarm_is_active_until_it_is_cleared_and_confirmed() {
    hold(
        Dialect::TwinCat,
        "alarm : FB_TcAlarm; message : FB_TcMessage; h : HRESULT; json : STRING(100) := 'old'; name : STRING(255) := 'old';
         entry : TcEventEntry := (nEventID := 7, eSeverity := TcEventSeverity.Error); other : TcEventEntry;
         raised, waits, cleared, confirmed, asked : BOOL; state : TcEventConfirmationState; any : I_TcMessage;",
        "h := alarm.CreateEx(entry, TRUE, 0); h := message.CreateEx(entry, 0); any := message;
         h := alarm.Raise(0); raised := alarm.bRaised; waits := alarm.bActive; state := alarm.eConfirmationState;
         h := alarm.Clear(0, FALSE); cleared := alarm.bActive AND NOT alarm.bRaised;
         h := alarm.Confirm(0); confirmed := NOT alarm.bActive;
         h := message.SetJsonAttribute('{}'); h := any.GetJsonAttribute(json, SIZEOF(json));
         asked := any.RequestEventText(1033, name, SIZEOF(name));",
        &[
            "raised AND waits AND cleared AND confirmed AND state = TcEventConfirmationState.WaitForConfirmation",
            "message.EqualsTo(alarm) AND message.EqualsToEventEntryEx(entry) AND NOT message.EqualsToEventEntryEx(other)",
            "message.EqualsToEventEntry(entry.uuidEventClass, 7, TcEventSeverity.Error) AND any.stEventEntry.nEventID = 7",
            "json = '{}' AND asked AND name = ''",
        ],
    );
}
