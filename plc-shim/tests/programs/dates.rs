//! Dates, times of day, characters (2nd ed. 2.2.3.2, 2.5.1.5.7; 3rd ed. 6.3.3, Tables 35 and 36).

use crate::rig::{Rig, findings, result};

const DAY: i64 = 86_400_000_000_000;
const SECOND: i64 = 1_000_000_000;

fn text(declarations: &str, expression: &str) -> String {
    result(&format!("{declarations} r : STRING[60];"), &format!("r := TO_STRING({expression});")).text("P.r")
}

#[test]
fn iec2_2_2_3_2_literals_count_nanoseconds() {
    let rig = result(
        "a : DATE := D#1970-01-02; b : TOD := TOD#00:00:01.5; c : DATE_AND_TIME := DT#1970-01-02-00:00:01;
         d : LDATE := LD#1969-12-31; e : LTIME_OF_DAY := LTOD#00:00:00.000000001; f : LDT := LDATE_AND_TIME#1970-01-01-00:00:00;
         g : TIME_OF_DAY := TIME_OF_DAY#23:59:59; z : DATE;",
        ";",
    );
    let found = ["a", "b", "c", "d", "e", "f", "g", "z"].map(|name| rig.int(&format!("P.{name}")));
    assert_eq!(found, [DAY, 3 * SECOND / 2, DAY + SECOND, -DAY, 1, 0, DAY - SECOND, 0]);
}

#[test]
fn iec2_2_5_1_5_7_table_30_functions_of_time() {
    for (expression, wanted) in [
        ("ADD_TIME(T#1s, T#2s)", "T#3s"),
        ("SUB_TIME(T#1s, T#2s)", "T#-1s"),
        ("ADD_TOD_TIME(TOD#23:00:00, T#2h)", "TOD#01:00:00"),
        ("SUB_TOD_TIME(TOD#01:00:00, T#2h)", "TOD#23:00:00"),
        ("ADD_DT_TIME(DT#1999-12-31-23:59:59, T#1s)", "DT#2000-01-01-00:00:00"),
        ("SUB_DT_TIME(DT#2000-03-01-00:00:00, T#1s)", "DT#2000-02-29-23:59:59"),
        ("SUB_DATE_DATE(D#2024-03-01, D#2024-02-01)", "T#29d"),
        ("SUB_TOD_TOD(TOD#01:00:00, TOD#02:30:00)", "T#-1h30m"),
        ("SUB_DT_DT(DT#2000-01-02-00:00:00, DT#2000-01-01-23:00:00)", "T#1h"),
        ("CONCAT_DATE_TOD(D#1984-06-25, TOD#15:36:55.36)", "DT#1984-06-25-15:36:55.36"),
        ("MULTIME(T#2s, 3)", "T#6s"),
        ("DIV_TIME(T#3s, 1.5)", "T#2s"),
        ("ADD_LDT_LTIME(LDT#1970-01-01-00:00:00, LT#1ns)", "LDT#1970-01-01-00:00:00.000000001"),
        ("d + T#1h", "DT#1984-06-25-16:00:00"),
        ("d - T#16h", "DT#1984-06-24-23:00:00"),
        ("d - d + T#5ms", "T#5ms"),
        ("d + LT#1ns", "LDT#1984-06-25-15:00:00.000000001"),
        ("TOD#12:00:00 + T#36h", "TOD#00:00:00"),
    ] {
        assert_eq!(text("d : DT := DT#1984-06-25-15:00:00;", expression), wanted, "{expression}");
    }
}

#[test]
fn iec2_2_5_1_5_1_table_22_conversions_of_dates() {
    for (expression, wanted) in [
        ("DT_TO_DATE(d)", "D#1969-12-31"),
        ("DT_TO_TOD(d)", "TOD#23:59:58.5"),
        ("DATE_AND_TIME_TO_TIME_OF_DAY(d)", "TOD#23:59:58.5"),
        ("DATE_TO_DT(D#2024-02-29)", "DT#2024-02-29-00:00:00"),
        ("DT_TO_LDT(d)", "LDT#1969-12-31-23:59:58.5"),
        ("LDATE_TO_DATE(LD#2000-01-01)", "D#2000-01-01"),
        ("TOD_TO_TIME(TOD#01:00:00)", "T#1h"),
        ("TIME_TO_TOD(T#25h)", "TOD#01:00:00"),
        ("DATE_TO_UDINT(D#1970-01-02)", "86400"),
        ("TOD_TO_DWORD(TOD#00:00:02.5)", "2500"),
        ("LTOD_TO_LINT(LTOD#00:00:00.5)", "500000000"),
        ("UDINT_TO_DATE(100000)", "D#1970-01-02"),
        ("DINT_TO_TOD(-1000)", "TOD#23:59:59"),
        ("UDINT_TO_DT(86401)", "DT#1970-01-02-00:00:01"),
        ("STRING_TO_DATE('D#2024-02-29')", "D#2024-02-29"),
        ("STRING_TO_DATE('2023-02-29')", "D#1970-01-01"),
        ("STRING_TO_TOD('12:34:56.789 ')", "TOD#12:34:56.789"),
        ("STRING_TO_DT('DT#2000-01-01-00:00:01')", "DT#2000-01-01-00:00:01"),
    ] {
        assert_eq!(text("d : DT := DT#1969-12-31-23:59:58.5;", expression), wanted, "{expression}");
    }
}

#[test]
fn iec2_2_5_1_5_4_comparison_and_selection_of_dates() {
    let rig = result(
        "r : BOOL; a : DATE := D#1960-01-01; b : DATE := D#2020-01-01; m : DATE; s : TOD;",
        "r := a < b AND b >= D#2020-01-01 AND a <> b AND LDATE#2020-01-01 = b; m := MAX(a, b); s := SEL(r, TOD#1:2:3, TOD#4:5:6);",
    );
    assert!(rig.bool("P.r"));
    assert_eq!(rig.int("P.m"), 18_262 * DAY);
    assert_eq!(rig.int("P.s"), (4 * 3600 + 5 * 60 + 6) * SECOND);
}

#[test]
fn iec3_table_36_dates_and_their_parts() {
    for (day, weekday) in
        [("2024-02-29", 4), ("1969-12-28", 0), ("2000-03-01", 3), ("1900-01-01", 1), ("2262-04-10", 4)]
    {
        let mut rig = Rig::new(&format!(
            "PROGRAM P VAR d, again : DATE; y, m, n, w : INT; s : STRING[12]; END_VAR
             d := D#{day}; SPLIT_DATE(d, YEAR => y, MONTH => m, DAY => n); again := CONCAT_DATE(y, m, n);
             w := DAY_OF_WEEK(d); s := TO_STRING(again); END_PROGRAM"
        ));
        rig.scan().expect("no fault");
        let found = format!("{:04}-{:02}-{:02}", rig.int("P.y"), rig.int("P.m"), rig.int("P.n"));
        assert_eq!((found.as_str(), rig.text("P.s")), (day, format!("D#{day}")));
        assert_eq!((rig.int("P.d"), rig.int("P.w")), (rig.int("P.again"), weekday));
    }
    let rig = result(
        "a, b, c, d, y, m, n : INT; t : STRING[30];",
        "SPLIT_DT(DT#1984-06-25-15:36:55.360, YEAR => y, MONTH => m, DAY => n, HOUR => a, MINUTE => b, SECOND => c, MILLISECOND => d);",
    );
    let found = ["y", "m", "n", "a", "b", "c", "d"].map(|name| rig.int(&format!("P.{name}")));
    assert_eq!(found, [1984, 6, 25, 15, 36, 55, 360]);
    assert_eq!(text("", "CONCAT_TOD(15, 36, 55, 360)"), "TOD#15:36:55.36");
    assert_eq!(text("", "CONCAT_DT(1984, 6, 25, 15, 36, 55, 360)"), "DT#1984-06-25-15:36:55.36");
    assert_eq!(text("", "CONCAT_DATE(2024, 3, 0)"), "D#2024-02-29");
}

#[test]
fn iec3_6_3_3_characters() {
    let rig = result(
        "a : CHAR := 'x'; b : WCHAR := WCHAR#\"$20AC\"; c : CHAR := CHAR#'$41'; s : STRING[3]; w : WSTRING[3]; r : BOOL; n : BYTE; z : CHAR;",
        "s := CHAR_TO_STRING(c); w := WCHAR_TO_WSTRING(b); r := a > 'w' AND a <> c; n := CHAR_TO_BYTE(a);
         z := STRING_TO_CHAR(' y'); c := BYTE_TO_CHAR(16#42);",
    );
    assert_eq!((rig.text("P.s"), rig.text("P.w")), ("A".to_owned(), "\u{20ac}".to_owned()));
    assert_eq!((rig.bool("P.r"), rig.int("P.n"), rig.int("P.z"), rig.int("P.c")), (true, 120, 32, 66));
}

#[test]
fn a_user_s_own_function_goes_before_one_of_table_36() {
    let mut rig = Rig::new(
        "FUNCTION DAY_OF_WEEK : INT VAR_INPUT x : INT; END_VAR DAY_OF_WEEK := x + 1; END_FUNCTION
         PROGRAM P VAR r : INT; END_VAR r := DAY_OF_WEEK(1); END_PROGRAM",
    );
    rig.scan().expect("no fault");
    assert_eq!(rig.int("P.r"), 2);
}

#[test]
fn wrong_dates_are_reported() {
    insta::assert_snapshot!(findings(
        "PROGRAM P
VAR d : DATE; t : TOD; dt : DT; c : CHAR; x : DINT; END_VAR
  d := D#2023-02-29;
  t := TOD#25:00:00;
  dt := DT#2023-01-01;
  c := 'ab';
  d := d + T#1d;
  dt := d;
  d := 5;
  t := -t;
  dt := dt + dt;
  x := d;
  d := TOD_TO_DATE(t);
  c := \"a\";
  c := 65;
  IF d = dt OR c = 'ab' THEN ; END_IF;
  dt := ADD_DT_TIME(dt, 5);
END_PROGRAM"
    ));
}

#[test]
fn iec3_table_10_durations_and_moments_take_all_of_64_bits() {
    let text = "PROGRAM P VAR a : LTIME := LTIME#106751d23h47m16s854ms775us807ns; b : LTIME := LTIME#-106751d23h47m16s854ms775us808ns;
      d : LDT := LDT#2262-04-11-23:47:16.854775807; e, f : LTIME; g : LDT; h, i : BOOL; n : LTIME; first : LDT := LDT#1677-09-21-00:12:43.145224192;
      s : LTIME; m : LTIME; q : LTIME; END_VAR
      e := a + LTIME#1ns; f := b - LTIME#1ns; g := d + LTIME#1ns; h := a > b; i := g < d; n := a - b; s := d - first; m := a * 2; q := b / 2; END_PROGRAM";
    let mut rig = Rig::new(text);
    rig.scan().expect("no fault");
    let (least, greatest) = (i64::MIN, i64::MAX);
    assert_eq!(["a", "b", "d", "first"].map(|name| rig.int(&format!("P.{name}"))), [greatest, least, greatest, least]);
    assert_eq!(["e", "f", "g", "n", "s"].map(|name| rig.int(&format!("P.{name}"))), [least, greatest, least, -1, -1]);
    assert_eq!((rig.int("P.m"), rig.int("P.q"), rig.bool("P.h"), rig.bool("P.i")), (-2, least / 2, true, true));
    let shown = ["P.a", "P.b", "P.d", "P.first"].map(|path| rig.plc.read(path).expect(path));
    assert_eq!(shown[0], "LT#106751d23h47m16s854ms775us807ns");
    for (name, text) in ["a", "b", "d", "first"].iter().zip(shown) {
        let path = format!("P.{name}");
        rig.plc.write(&path, &text).expect("what is shown is read");
        assert_eq!(rig.plc.read(&path).expect("it exists"), text);
    }
    for beyond in [
        "LTIME#106751d23h47m16s854ms775us808ns",
        "LDT#2262-04-11-23:47:16.854775808",
        "LDT#1677-09-21-00:12:43.145224191",
    ] {
        let text = format!(
            "PROGRAM P VAR t : {}; END_VAR t := {beyond}; END_PROGRAM",
            &beyond[..beyond.find('#').unwrap_or(0)]
        );
        let found = crate::rig::findings(&text);
        assert!(found.contains("S0103"), "{beyond}: {found}");
    }
}
