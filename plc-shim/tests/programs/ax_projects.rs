//! What projects of SIMATIC AX hold: assertions of its unit tests, namespaces in parts, values that several
//! enumerations share, parts of integers.

use onescan_iec::Dialect::{Iec2, Iec3, SiemensScl};
use onescan_iec::{Code, Severity};

use crate::rig::{Rig, findings_in};

#[test]
fn assertions_are_stubs_that_take_any_value() {
    let text = "USING AxUnit;
        NAMESPACE Own.Tests
          CLASS T
            METHOD PUBLIC m VAR_TEMP w : DWORD; x : LREAL; END_VAR
              Assert.Equal(actual := w.%X5, expected := TRUE);
              AxUnit.Assert.NotEqual(expected := DWORD#16#20, actual := w);
              AxUnit.Assert.LessThan(left := x, right := 2.5);
            END_METHOD
          END_CLASS
        END_NAMESPACE";
    let findings = findings_in(Iec3, text);
    let reported: Vec<_> = findings.iter().map(|found| (found.severity, found.code)).collect();
    assert_eq!(reported, [(Severity::Warning, Code::StubUsed); 3], "{findings}");
    let wrong = text.replace("left := x", "left := missing");
    assert!(findings_in(Iec3, &wrong).iter().any(|found| found.code == Code::UnknownName));
}

#[test]
fn the_parts_of_a_namespace_s_name_are_namespaces() {
    let text = "NAMESPACE A.B.C FUNCTION F : INT F := 3; END_FUNCTION END_NAMESPACE
        USING A.B; PROGRAM P VAR r : INT; END_VAR r := C.F(); END_PROGRAM";
    let mut rig = Rig::in_dialect(Iec3, text);
    rig.scan().expect("no fault");
    assert_eq!(rig.int("P.r"), 3);
    let unknown = text.replace("USING A.B;", "USING A.BC;");
    assert!(findings_in(Iec3, &unknown).iter().any(|found| found.code == Code::UnknownNamespace));
}

#[test]
fn the_place_says_which_enumeration_is_meant() {
    let text = "TYPE One : INT (POSITIVE := 1, NEGATIVE := 2) := NEGATIVE; END_TYPE
        TYPE Two : INT (NEGATIVE := 7, SHORTEST := 3) := NEGATIVE; END_TYPE
        PROGRAM P VAR a : One; b : Two; c : Two := SHORTEST; r1, r2, r3 : INT; END_VAR
          r1 := a; r2 := b; c := NEGATIVE; IF c = NEGATIVE THEN r3 := c; END_IF; END_PROGRAM";
    let mut rig = Rig::in_dialect(Iec3, text);
    rig.scan().expect("no fault");
    assert_eq!(["r1", "r2", "r3"].map(|name| rig.int(&format!("P.{name}"))), [2, 7, 7]);
    let open = "TYPE A : (X, Y); B : (Y, Z); END_TYPE PROGRAM P VAR n : DINT; END_VAR n := A#X + Y; END_PROGRAM";
    assert!(
        findings_in(Iec3, open).iter().any(|found| found.severity == Severity::Error),
        "nothing says whose Y it is"
    );
}

#[test]
fn integers_have_parts() {
    let text = "PROGRAM P VAR i : INT := 16#1234; d : DINT; x : BOOL; b : BYTE; END_VAR
        x := i.%X2; b := i.%B1; d.%X31 := TRUE; d.%W0 := 16#FFFF; i.%B0 := 16#FF; END_PROGRAM";
    for dialect in [Iec3, SiemensScl] {
        let mut rig = Rig::in_dialect(dialect, text);
        rig.scan().expect("no fault");
        assert!(rig.bool("P.x"), "{dialect}");
        let found = ["b", "i", "d"].map(|name| rig.int(&format!("P.{name}")));
        assert_eq!(found, [0x12, 0x12ff, i64::from(0x8000_ffff_u32 as i32)], "{dialect}");
    }
    assert!(findings_in(Iec2, text).iter().any(|found| found.code == Code::InvalidPart));
}

#[test]
fn the_only_parameter_has_no_name_even_if_it_is_an_output() {
    let text =
        "PROGRAM P VAR now : DTL; error, year : INT; END_VAR error := RD_SYS_T(now); year := now.YEAR; END_PROGRAM";
    let mut rig = Rig::in_dialect(SiemensScl, &text.replace("year := now.YEAR", "year := UINT_TO_INT(now.YEAR)"));
    rig.scan().expect("no fault");
    assert_eq!((rig.int("P.error"), rig.int("P.year")), (0, 1970));
}
