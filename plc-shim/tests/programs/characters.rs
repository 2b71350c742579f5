//! Single characters of strings, `s[i]` (3rd ed. 6.4.2.2).

use onescan_iec::Dialect;

use crate::rig::{Rig, findings, findings_in};

#[test]
fn iec3_6_4_2_2_characters_are_read_and_written_from_1() {
    for dialect in [Dialect::Iec3, Dialect::SiemensScl] {
        let text = "PROGRAM P VAR s : STRING[5] := 'abc'; c, d, e : CHAR; i : INT := 2; n : INT;
            list : ARRAY [1..2] OF STRING[5] := ['one', 'two']; END_VAR
            c := s[1]; d := s[i + 1]; e := s[4]; s[2] := 'X'; s[i + 1] := list[2][i];
            IF s[2] = 'X' THEN n := LEN(s); END_IF; END_PROGRAM";
        let mut rig = Rig::in_dialect(dialect, text);
        rig.scan().expect("no fault");
        let found = ["c", "d", "e", "s", "n"].map(|name| rig.plc.read(&format!("P.{name}")).expect(name));
        assert_eq!(found, ["'a'", "'c'", "'$00'", "'aXw'", "3"], "{dialect}");
    }
    let wide = "PROGRAM P VAR w : WSTRING[3] := \"xy\"; f : WCHAR; i : INT := 2; END_VAR f := w[2]; w[i] := WCHAR#\"z\"; END_PROGRAM";
    let mut rig = Rig::new(wide);
    rig.scan().expect("no fault");
    assert_eq!(["P.w", "P.f"].map(|path| rig.plc.read(path).expect(path)), ["\"xz\"", "\"y\""]);
}

#[test]
fn codesys_and_twincat_count_from_0_and_end_with_0() {
    for dialect in [Dialect::Codesys, Dialect::TwinCat] {
        let text = "PROGRAM P VAR s : STRING(5) := 'abcde'; t : STRING := 'Hello'; u, v, x : STRING(4); b, last : BYTE; i, n, k : INT;
            w : WSTRING(4) := \"uv\"; ww : WORD; p : POINTER TO STRING(5); END_VAR
            b := s[0]; last := s[5]; WHILE t[i] <> 0 DO IF t[i] >= 16#61 THEN t[i] := t[i] - 32; END_IF; i := i + 1; END_WHILE;
            s[3] := 0; n := LEN(s); FOR k := 0 TO 3 DO u[k] := TO_BYTE(48 + k); END_FOR; v := 'ab'; v[3] := 99; x := 'abc'; x[1] := 0; x[1] := 100;
            ww := w[1]; w[2] := 119; p := ADR(s); p^[0] := 90; END_PROGRAM";
        let mut rig = Rig::in_dialect(dialect, text);
        rig.scan().expect("no fault");
        let read = |name: &str| rig.plc.read(&format!("P.{name}")).expect(name);
        assert_eq!(
            ["b", "last", "i", "n", "ww"].map(|name| rig.int(&format!("P.{name}"))),
            [97, 0, 5, 3, 118],
            "{dialect}"
        );
        assert_eq!(
            ["s", "t", "u", "v", "x", "w"].map(read),
            ["'Zbc'", "'HELLO'", "'0123'", "'ab'", "'adc'", "\"uvw\""]
        );
    }
}

#[test]
fn a_position_outside_of_the_string_stops_the_plc() {
    for (dialect, statement, fails) in [
        (Dialect::Iec3, "c := s[i];", true),
        (Dialect::Iec3, "c := s[i + 3];", false),
        (Dialect::Iec3, "c := s[i + 4];", true),
        (Dialect::Iec3, "s[i + 4] := 'x';", true),
        (Dialect::Codesys, "b := s[i];", false),
        (Dialect::Codesys, "b := s[i + 3];", false),
        (Dialect::Codesys, "b := s[i + 4];", true),
        (Dialect::Codesys, "b := s[i - 1];", true),
        (Dialect::Codesys, "s[i + 3] := 1;", false),
        (Dialect::Codesys, "s[i + 4] := 1;", true),
        (Dialect::Codesys, "s[i - 1] := 1;", true),
    ] {
        let character = if dialect == Dialect::Iec3 { "c : CHAR;" } else { "b : BYTE;" };
        let text =
            format!("PROGRAM P VAR s : STRING[3] := 'abc'; i : INT; {character} END_VAR\n{statement}\nEND_PROGRAM");
        let reported = Rig::in_dialect(dialect, &text).scan().map_err(|fault| fault.to_string());
        assert_eq!(reported.is_err(), fails, "{statement} in {dialect}: {reported:?}");
        if let Err(reported) = reported {
            assert!(reported.starts_with("array index out of range at test.st:2:"), "{reported}");
        }
    }
}

#[test]
fn wrong_characters_are_reported() {
    let iec = |statement: &str| {
        findings(&format!("PROGRAM P VAR s : STRING[3]; c : CHAR; b : BYTE; END_VAR\n{statement}\nEND_PROGRAM"))
    };
    let vendor = |statement: &str| {
        let text = format!(
            "PROGRAM P VAR s : STRING(3); b : BYTE; END_VAR VAR CONSTANT k : STRING := 'a'; END_VAR\n{statement}\nEND_PROGRAM"
        );
        findings_in(Dialect::Codesys, &text).to_string()
    };
    let all = [
        iec("c := s[0];"),
        iec("c := s[4];"),
        iec("s[4] := 'x';"),
        iec("b := s[1];"),
        iec("c := s[1, 2];"),
        iec("s[1] := 'xy';"),
        vendor("b := s[4];"),
        vendor("s[4] := 1;"),
        vendor("s[0] := 'x';"),
        vendor("k[0] := 1;"),
        vendor("s[b > 1] := 1;"),
    ];
    insta::assert_snapshot!(all.join("\n"));
}
