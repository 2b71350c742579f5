//! How strings lie in memory, for programs that walk them by pointer: `SIZEOF`, `ADR`, `MEMCPY`, arrays, structures.

use onescan_iec::Dialect;

use crate::rig::Rig;

const VENDORS: [Dialect; 2] = [Dialect::Codesys, Dialect::TwinCat];

#[test]
fn a_string_of_vendors_is_its_characters_and_a_zero() {
    let text = "TYPE S : STRUCT b : BYTE; s : STRING(3); c : BYTE; w : WSTRING(2); d : BYTE; END_STRUCT END_TYPE
        PROGRAM P VAR s : STRING(5) := 'abc'; w : WSTRING(4) := \"xy\"; list : ARRAY [0..2] OF STRING(3) := ['p', 'qr', 'stu'];
          all : S; p : POINTER TO BYTE; q : POINTER TO WORD; n : ARRAY [0..3] OF UDINT; c : ARRAY [0..6] OF BYTE; z : ARRAY [0..1] OF WORD;
          at_ : ARRAY [0..3] OF UDINT; END_VAR
        n[0] := SIZEOF(s); n[1] := SIZEOF(w); n[2] := SIZEOF(list); n[3] := SIZEOF(all);
        p := ADR(s); c[0] := p[0]; c[1] := p[2]; c[2] := p[3];
        p := ADR(list); c[3] := p[4]; c[4] := p[8]; c[5] := p[11];
        q := ADR(w); z[0] := q[1]; z[1] := q[2];
        at_[0] := ADR(all.s) - ADR(all); at_[1] := ADR(all.c) - ADR(all); at_[2] := ADR(all.w) - ADR(all); at_[3] := ADR(all.d) - ADR(all);
        END_PROGRAM";
    for dialect in VENDORS {
        let mut rig = Rig::in_dialect(dialect, text);
        rig.scan().expect("no fault");
        let numbers = |name: &str, count: usize| -> Vec<i64> {
            (0..count).map(|at| rig.int(&format!("P.{name}[{at}]"))).collect()
        };
        assert_eq!(numbers("n", 4), [6, 10, 12, 14], "{dialect}");
        assert_eq!(numbers("c", 6), [0x61, 0x63, 0, 0x71, 0x73, 0], "{dialect}");
        assert_eq!(numbers("z", 2), [0x79, 0]);
        assert_eq!(numbers("at_", 4), [1, 5, 6, 12]);
    }
}

#[test]
fn what_is_written_by_pointer_is_the_string() {
    let text = "PROGRAM P VAR s, t, u : STRING(8) := 'abcdefgh'; p : POINTER TO BYTE; i, n, m, k : INT; same, less : BOOL; r : STRING(20); END_VAR
        p := ADR(s); FOR i := 0 TO 4 DO p^ := INT_TO_BYTE(72 + i); p := p + 1; END_FOR; p^ := 0;
        n := LEN(s);
        MEMCPY(ADR(t), ADR(s), SIZEOF(s)); same := t = s; m := FIND(t, 'JK');
        r := CONCAT(s, '-'); r := CONCAT(r, LEFT(t, 2)); k := LEN(r);
        u[3] := 0; less := u < 'abd'; END_PROGRAM";
    for dialect in VENDORS {
        let mut rig = Rig::in_dialect(dialect, text);
        rig.scan().expect("no fault");
        assert_eq!(["n", "m", "k"].map(|name| rig.int(&format!("P.{name}"))), [5, 3, 8], "{dialect}");
        assert!(rig.bool("P.same") && rig.bool("P.less"));
        let value = |path: &str| rig.plc.application().value_text(&rig.variable(path), rig.plc.memory());
        assert_eq!([value("P.s"), value("P.r"), value("P.u")], ["'HIJKL'", "'HIJKL-HI'", "'abc'"]);
    }
}

#[test]
fn a_full_string_needs_no_more_room() {
    let text = "PROGRAM P VAR s : STRING(3) := 'abcdef'; t : STRING(3); n : INT; last : BYTE; END_VAR
        t := CONCAT(s, 'xyz'); n := LEN(t); last := t[3]; t[1] := 16#42; END_PROGRAM";
    for dialect in VENDORS {
        let mut rig = Rig::in_dialect(dialect, text);
        rig.scan().expect("no fault");
        assert_eq!((rig.int("P.n"), rig.int("P.last")), (3, 0));
        assert_eq!(rig.plc.application().value_text(&rig.variable("P.t"), rig.plc.memory()), "'aBc'");
    }
}

#[test]
fn strings_of_two_dialects_are_assigned_and_compared() {
    use onescan_iec::input::kind::SourceKind;
    use onescan_iec::{Input, TimeSpan};
    use onescan_iec_run::Application;
    let library = "FUNCTION twice : STRING(40) VAR_INPUT s : STRING(20); END_VAR twice := CONCAT(s, s); END_FUNCTION";
    let program = "PROGRAM P VAR s : STRING(20) := 'ab'; t : STRING(40); same : BOOL; n : INT; END_VAR
        t := twice(s); same := t = 'abab'; n := LEN(twice(t)); END_PROGRAM";
    for (first, second) in [(Dialect::TwinCat, Dialect::Iec3), (Dialect::Iec3, Dialect::Codesys)] {
        let library = Input::from_text("lib.st", SourceKind::Text, library).in_dialect(first);
        let program = Input::from_text("main.st", SourceKind::Text, program).in_dialect(second);
        let application = Application::from_inputs([library, program]).expect("it compiles");
        let mut rig = Rig::with_plan(&application, &application.single_task(TimeSpan::millis::<10>()));
        rig.scan().expect("no fault");
        assert!(rig.bool("P.same"), "{first} and {second}");
        assert_eq!(rig.int("P.n"), 8);
    }
}

#[test]
fn strings_of_other_lengths_go_by_reference() {
    let text = "FUNCTION F : INT VAR_IN_OUT s : STRING(5); END_VAR F := LEN(s); s := 'vwxyz'; END_FUNCTION
        PROGRAM P VAR long : STRING(9) := 'abcdefghi'; short : STRING(3) := 'abc'; behind : DWORD := 16#11223344; n, m : INT; END_VAR
        n := F(long); m := F(short); END_PROGRAM";
    for dialect in VENDORS {
        let mut rig = Rig::in_dialect(dialect, text);
        rig.scan().expect("no fault");
        assert_eq!(["n", "m", "behind"].map(|name| rig.int(&format!("P.{name}"))), [5, 3, 0x1122_3344], "{dialect}");
        let value = |path: &str| rig.plc.application().value_text(&rig.variable(path), rig.plc.memory());
        assert_eq!([value("P.long"), value("P.short")], ["'vwxyz'", "'vwx'"]);
    }
}
