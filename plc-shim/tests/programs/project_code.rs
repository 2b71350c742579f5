//! What whole projects of CODESYS and TwinCAT have in common and small examples do not, in programs of our own.

use onescan_iec::Dialect::{self, Codesys, TwinCat};
use onescan_iec::Severity;
use onescan_iec_run::FaultKind;

use crate::rig::{Rig, findings_in};

const VENDORS: [Dialect; 2] = [Codesys, TwinCat];

/// What `P.r` is after one scan.
pub(crate) fn gives(text: &str, expected: i64) {
    for dialect in VENDORS {
        let mut rig = Rig::in_dialect(dialect, text);
        rig.scan().expect("no fault");
        assert_eq!(rig.int("P.r"), expected, "{dialect}: {text}");
    }
}

#[test]
fn a_constant_input_has_what_it_is_given() {
    gives(
        "FUNCTION F : DINT VAR_INPUT CONSTANT k : DINT := 3; END_VAR F := k; END_FUNCTION
         FUNCTION_BLOCK B VAR_INPUT CONSTANT k : DINT := 3; END_VAR VAR_OUTPUT q : DINT; END_VAR
           METHOD M : DINT VAR_INPUT CONSTANT k : DINT := 5; END_VAR M := k; END_METHOD q := k; END_FUNCTION_BLOCK
         PROGRAM P VAR b1, b2 : B; r : DINT; END_VAR b1(k := 40); b2(); b2.k := 8;
           r := F(k := 9) * 1000000 + b1.q * 10000 + b2.q * 1000 + b2.k * 100 + b1.M(7) * 10; END_PROGRAM",
        9_403_870,
    );
    let written = "FUNCTION F : DINT VAR_INPUT CONSTANT k : DINT; END_VAR k := 3; F := k; END_FUNCTION
        PROGRAM P VAR r : DINT; END_VAR r := F(1); END_PROGRAM";
    insta::assert_snapshot!(findings_in(Codesys, written), @"test.st:1:56: error[D0401]: a constant is not assigned to");
}

#[test]
fn a_pointer_to_a_long_array_leads_to_a_shorter_one() {
    let text = |index: &str| {
        format!(
            "FUNCTION Pick : DINT VAR_INPUT p : POINTER TO ARRAY [0..1000000] OF DINT; n : DINT; END_VAR
               Pick := p^[n] + p^[2]; END_FUNCTION
             PROGRAM P VAR a : ARRAY [0..3] OF DINT := [1, 2, 30, 400]; r : DINT; END_VAR
               r := Pick(ADR(a), {index}); END_PROGRAM"
        )
    };
    gives(&text("3"), 430);
    for dialect in VENDORS {
        let behind = Rig::in_dialect(dialect, &text("900000")).scan().expect_err("behind memory");
        assert_eq!(behind.kind, FaultKind::InvalidPointer, "{dialect}");
        let outside = Rig::in_dialect(dialect, &text("1000001")).scan().expect_err("behind the array");
        assert_eq!(outside.kind, FaultKind::IndexOutOfRange, "{dialect}");
    }
}

#[test]
fn commas_and_parentheses_without_a_value() {
    gives(
        "FUNCTION_BLOCK F VAR_INPUT a, b : DINT; END_VAR VAR_OUTPUT q : DINT; END_VAR q := a + b; END_FUNCTION_BLOCK
         PROGRAM P VAR f1 : F := (); r : DINT; END_VAR f1(a := 3, b := 4,); r := f1.q; END_PROGRAM",
        7,
    );
}

#[test]
fn a_value_alone_is_read() {
    let text = "FUNCTION_BLOCK F VAR_OUTPUT n : DINT; END_VAR PROPERTY Next : DINT GET n := n + 1; Next := n; END_GET
          END_PROPERTY END_FUNCTION_BLOCK
        PROGRAM P VAR f1 : F; r : DINT; END_VAR f1.Next; f1.Next; r := f1.n; END_PROGRAM";
    gives(text, 2);
    insta::assert_snapshot!(findings_in(TwinCat, text), @r"
    test.st:3:49: warning[C0307]: this value goes nowhere
    test.st:3:58: warning[C0307]: this value goes nowhere
    ");
}

#[test]
fn a_constant_of_a_block_is_known_by_the_blocks_name() {
    gives(
        "FUNCTION_BLOCK F VAR CONSTANT m : INT := n * 2; END_VAR VAR a : ARRAY [1..m] OF BYTE; END_VAR
           VAR CONSTANT n : INT := G.k; END_VAR END_FUNCTION_BLOCK
         FUNCTION_BLOCK G VAR CONSTANT k : INT := 21; END_VAR VAR text : STRING(F.n); END_VAR END_FUNCTION_BLOCK
         PROGRAM P VAR a : ARRAY [0..F.m] OF BYTE; r : INT; END_VAR r := DINT_TO_INT(UPPER_BOUND(a, 1)); END_PROGRAM",
        42,
    );
    let wrong = "FUNCTION_BLOCK F VAR CONSTANT m : INT := G.k; END_VAR END_FUNCTION_BLOCK
        FUNCTION_BLOCK G VAR CONSTANT k : INT := F.m; END_VAR VAR n : INT; END_VAR END_FUNCTION_BLOCK
        PROGRAM P VAR r : INT; END_VAR r := F.m + G.n; END_PROGRAM";
    let findings = findings_in(TwinCat, wrong);
    assert!(findings.iter().any(|found| found.severity == Severity::Error), "{findings}");
}

const REFERENCES: &str = "TYPE Base : STRUCT n : DINT; END_STRUCT END_TYPE
    TYPE More EXTENDS Base : STRUCT m : DINT; END_STRUCT END_TYPE
    FUNCTION_BLOCK F VAR _data : REFERENCE TO Base; END_VAR
      PROPERTY Data : REFERENCE TO Base GET Data REF= _data; END_GET SET _data REF= Data; END_SET END_PROPERTY
      PROPERTY Read : REFERENCE TO Base GET Read REF= _data; END_GET END_PROPERTY
    END_FUNCTION_BLOCK";

#[test]
fn a_property_that_is_a_reference_is_set_and_written_through() {
    gives(
        &format!(
            "{REFERENCES} PROGRAM P VAR f1 : F; d : More; b : Base := (n := 50); r : DINT; END_VAR
             f1.Data REF= d; f1.Read.n := 3; r := d.n; f1.Read := b; r := r + d.n; END_PROGRAM"
        ),
        53,
    );
}

#[test]
fn an_enumeration_stands_for_its_number() {
    gives(
        "TYPE Mode : (Off, On := 4, Test) UINT; END_TYPE
         FUNCTION Next : BOOL VAR_IN_OUT m : UINT; END_VAR m := m + 1; Next := TRUE; END_FUNCTION
         PROGRAM P VAR m : Mode := Mode.On; r : INT; b : BOOL; END_VAR b := Next(m); r := m; END_PROGRAM",
        5,
    );
}

#[test]
fn an_operation_on_narrow_numbers_goes_to_a_narrow_one() {
    gives(
        "PROGRAM P VAR r : WORD; high, low : BYTE := 7; n : INT := 5; u : UINT := 9; END_VAR
           r := 256 * high + low; n := MIN(n, u - n); r := r + INT_TO_WORD(n); END_PROGRAM",
        256 * 7 + 7 + 4,
    );
    let wide = "PROGRAM P VAR w : WORD; d : DINT; END_VAR w := d + 1; END_PROGRAM";
    let findings = findings_in(Codesys, wide);
    assert!(findings.iter().any(|found| found.severity == Severity::Error), "{findings}");
}

#[test]
fn units_that_contain_one_another_are_reported_and_not_followed() {
    let text = "FUNCTION_BLOCK H EXTENDS V END_FUNCTION_BLOCK
        FUNCTION_BLOCK A EXTENDS V METHOD FB_init : BOOL p := THIS^; END_METHOD END_FUNCTION_BLOCK
        FUNCTION_BLOCK V VAR_INPUT p : A; END_VAR END_FUNCTION_BLOCK";
    let findings = findings_in(TwinCat, text);
    assert!(findings.iter().any(|found| found.severity == Severity::Error), "{findings}");
}

#[test]
fn plain_text_names_its_dialect() {
    let text = "(* a library *) {dialect 'twincat'} PROGRAM P VAR a, b : BOOL; END_VAR a S= b; END_PROGRAM";
    let found = onescan_iec_run::Application::from_sources([("a.st", text)]);
    assert!(found.is_ok(), "{found:?}");
    let unknown = text.replace("twincat", "twinkat");
    let found = onescan_iec_run::Application::from_sources([("a.st", unknown.as_str())]).expect_err("no dialect");
    insta::assert_snapshot!(found, @r"
    a.st:1:27: error[S0110]: `twinkat` is not a dialect: iec2, iec3, codesys, twincat, siemens-scl, matiec
    a.st:1:74: error[S0110]: `S=`, `R=` is not part of iec3 (it is part of codesys and twincat: --dialect chooses)
    ");
}

#[test]
fn what_a_stub_leaves_out_is_not_missing() {
    let text = "INTERFACE I METHOD M : DINT END_METHOD PROPERTY Q : DINT GET END_GET END_PROPERTY END_INTERFACE
        {external} FUNCTION_BLOCK S IMPLEMENTS I END_FUNCTION_BLOCK
        FUNCTION_BLOCK T EXTENDS S METHOD M : DINT M := 4; END_METHOD END_FUNCTION_BLOCK
        FUNCTION_BLOCK U IMPLEMENTS I METHOD M : DINT M := 70; END_METHOD
          PROPERTY Q : DINT GET Q := 600; END_GET END_PROPERTY END_FUNCTION_BLOCK
        PROGRAM P VAR t1 : T; s1 : S; u1 : U; i : I; r : DINT; END_VAR
          i := t1; r := i.M() + i.Q + s1.M() + t1.Q; i := u1; r := r + i.M() + i.Q; i := s1; r := r + i.M(); END_PROGRAM";
    gives(text, 674);
}

#[test]
fn a_reference_begins_with_what_it_refers_to() {
    gives(
        "FUNCTION F : DINT VAR_INPUT x : REFERENCE TO DINT := 0; END_VAR
           IF __ISVALIDREF(x) THEN F := x; ELSE F := 1000; END_IF END_FUNCTION
         FUNCTION_BLOCK B VAR n : DINT := 5; mine : REFERENCE TO DINT := n; END_VAR VAR_OUTPUT q : DINT; END_VAR
           mine := mine + 1; q := n; END_FUNCTION_BLOCK
         PROGRAM P VAR a : DINT := 40; ref : REFERENCE TO DINT := a; list : ARRAY [0..2] OF DINT := [1, 2, 300];
           all : REFERENCE TO ARRAY [0..2] OF DINT := list; b1, b2 : B; r : DINT; END_VAR
           b1(); ref := ref + 1; r := a + all[2] + F() + F(a) + b1.q; END_PROGRAM",
        41 + 300 + 1000 + 41 + 6,
    );
}

#[test]
fn a_constant_input_may_bound_an_array() {
    gives(
        "FUNCTION_BLOCK F VAR_INPUT CONSTANT n : INT := 4; END_VAR VAR a : ARRAY [1..n] OF BYTE; END_VAR
           VAR_OUTPUT q : INT; END_VAR q := n * 100 + DINT_TO_INT(UPPER_BOUND(a, 1)); END_FUNCTION_BLOCK
         PROGRAM P VAR f1 : F; r : INT; END_VAR f1(n := 3); r := f1.q; END_PROGRAM",
        304,
    );
}

#[test]
fn an_assignment_has_a_value() {
    gives(
        "FUNCTION_BLOCK F VAR _n : DINT; END_VAR PROPERTY N : DINT GET N := _n; END_GET SET _n := N * 2; END_SET END_PROPERTY
         END_FUNCTION_BLOCK
         PROGRAM P VAR f1 : F; i, k, r : DINT; done : BOOL; small : SINT; END_VAR
           IF (i := i + 4) = 4 THEN r := r + 1; END_IF
           IF done := i > 3 THEN r := r + 10; END_IF
           WHILE (i := i - 1) > 0 DO k := k + 1; END_WHILE
           r := r + (k := k + 1) * 100 + (f1.N := 5) * 1000 + (small := SINT#7) * 100000;
           IF NOT done THEN r := 0; END_IF END_PROGRAM",
        11 + 4 * 100 + 10 * 1000 + 700_000,
    );
}

#[test]
fn a_byte_counts_the_targets_of_a_pointer() {
    gives(
        "PROGRAM P VAR a : ARRAY [0..3] OF LREAL := [1.0, 2.0, 30.0, 4.0]; p : POINTER TO LREAL; i : BYTE := 2; r : DINT;
         END_VAR p := ADR(a); r := LREAL_TO_DINT(p[i]); END_PROGRAM",
        30,
    );
}

#[test]
fn sel_evaluates_what_it_selects() {
    let text = "FUNCTION_BLOCK C VAR_OUTPUT n : DINT; END_VAR METHOD Next : DINT n := n + 1; Next := n; END_METHOD
        END_FUNCTION_BLOCK
        PROGRAM P VAR c1, c2 : C; a : ARRAY [0..1] OF DINT := [5, 6]; i, r : DINT; END_VAR
          r := SEL(i > 0, 1, a[i - INDEX]) * 1000 + SEL(TRUE, c1.Next(), c2.Next()) * 100 + c1.n * 10 + c2.n; END_PROGRAM";
    gives(&text.replace("INDEX", "1"), 1101);
    let mut rig = Rig::in_dialect(Dialect::Iec3, &text.replace("INDEX", "0"));
    rig.scan().expect("no fault");
    assert_eq!(rig.int("P.r"), 1111, "a function's inputs are evaluated");
}

#[test]
fn pvoid_is_a_number_as_wide_as_a_pointer() {
    gives(
        "PROGRAM P VAR a : ARRAY [0..3] OF BYTE := [1, 2, 30, 4]; p : POINTER TO BYTE; v : PVOID; r : DINT; END_VAR
           v := ADR(a); IF (v AND 16#1) <= 1 THEN v := v + 2; END_IF p := v; r := p^; END_PROGRAM",
        30,
    );
}

#[test]
fn a_negative_literal_is_the_unsigned_number_of_its_bits_and_is_reported() {
    let text = "PROGRAM P VAR a : UINT := -1; b : ULINT; c : USINT; r : DINT; END_VAR
         b := -2; c := -128; r := a; IF b = 18446744073709551614 THEN r := r + c; END_IF; END_PROGRAM";
    gives(text, 65_535 + 128);
    for dialect in VENDORS {
        let found = findings_in(dialect, text);
        assert!(found.findings().iter().all(|each| each.diagnostic().severity == Severity::Warning), "{found}");
        assert!(found.to_string().contains("-1 becomes 65535 as UINT"), "{found}");
        let found = findings_in(dialect, "PROGRAM P VAR a : USINT; END_VAR a := -129; END_PROGRAM").to_string();
        assert!(found.contains("T0202"), "{found}");
    }
    let found = findings_in(Dialect::Iec3, "PROGRAM P VAR a : UINT; END_VAR a := -1; END_PROGRAM").to_string();
    assert!(found.contains("-1 does not fit UINT"), "{found}");
}

#[test]
fn what_gives_a_reference_is_a_variable() {
    gives(
        "FUNCTION_BLOCK Counter VAR_IN_OUT n : DINT; END_VAR n := n + 1; END_FUNCTION_BLOCK
         FUNCTION_BLOCK Holder VAR value : DINT := 40; END_VAR
           PROPERTY Kept : REFERENCE TO DINT GET Kept REF= value; END_GET END_PROPERTY
           METHOD Where : REFERENCE TO DINT Where REF= value; END_METHOD END_FUNCTION_BLOCK
         PROGRAM P VAR h : Holder; c : Counter; r : DINT; END_VAR
           c(n := h.Kept); c(n := h.Where()); r := h.Kept; END_PROGRAM",
        42,
    );
    let found = findings_in(
        TwinCat,
        "FUNCTION_BLOCK Counter VAR_IN_OUT n : DINT; END_VAR n := n + 1; END_FUNCTION_BLOCK
         FUNCTION_BLOCK Holder PROPERTY Kept : DINT GET Kept := 1; END_GET END_PROPERTY END_FUNCTION_BLOCK
         PROGRAM P VAR h : Holder; c : Counter; END_VAR c(n := h.Kept); END_PROGRAM",
    );
    assert!(found.to_string().contains("`Kept` is a property, which is not a variable"), "{found}");
}

#[test]
fn a_longer_string_stands_behind_a_reference_to_a_shorter_one() {
    gives(
        "FUNCTION Fill : DINT VAR_INPUT text : REFERENCE TO STRING(5); END_VAR text := 'abcdefgh'; Fill := LEN(text);
         END_FUNCTION
         PROGRAM P VAR s : STRING(20) := 'something longer'; r : DINT; END_VAR
           r := Fill(s) * 100 + LEN(s); END_PROGRAM",
        505,
    );
    let found = findings_in(
        TwinCat,
        "FUNCTION Fill : DINT VAR_INPUT text : REFERENCE TO STRING(20); END_VAR text := 'abcdefgh'; Fill := 1;
         END_FUNCTION PROGRAM P VAR s : STRING(5); r : DINT; END_VAR r := Fill(s); END_PROGRAM",
    );
    assert!(found.to_string().contains("T0201"), "a shorter one would be written beyond its end: {found}");
}

#[test]
fn a_method_is_called_on_what_a_property_or_method_gives() {
    let blocks = "FUNCTION_BLOCK Inner VAR n : DINT; END_VAR
           METHOD Next : DINT n := n + 1; Next := n; END_METHOD END_FUNCTION_BLOCK
         FUNCTION_BLOCK Outer VAR i : Inner; END_VAR
           PROPERTY Copy : Inner GET Copy := i; END_GET END_PROPERTY
           PROPERTY Own : REFERENCE TO Inner GET Own REF= i; END_GET END_PROPERTY
           METHOD Get : Inner Get := i; END_METHOD END_FUNCTION_BLOCK";
    gives(
        &format!(
            "{blocks} PROGRAM P VAR o : Outer; r : DINT; END_VAR
               o.Own.Next(); o.Copy.Next();
               r := o.Copy.Next() * 100 + o.Get().Next() * 10 + o.Own.Next(); END_PROGRAM"
        ),
        222,
    );
}

#[test]
fn what_is_derived_is_given_for_its_base() {
    gives(
        "FUNCTION_BLOCK Base VAR_OUTPUT n : DINT; END_VAR
           METHOD Take : DINT VAR_INPUT other : Base; END_VAR Take := other.n * 10 + other.Kind(); other.n := 9; END_METHOD
           METHOD Kind : DINT Kind := 1; END_METHOD END_FUNCTION_BLOCK
         FUNCTION_BLOCK Derived EXTENDS Base VAR more : DINT := 5; END_VAR
           METHOD Kind : DINT Kind := more; END_METHOD
           METHOD Go : DINT n := 7; Go := Take(THIS^); END_METHOD END_FUNCTION_BLOCK
         PROGRAM P VAR d : Derived; r : DINT; END_VAR r := d.Go() * 100 + d.n * 10 + d.Kind(); END_PROGRAM",
        7175,
    );
}

#[test]
fn an_array_may_have_no_elements() {
    gives(
        "PROGRAM P VAR CONSTANT n : DINT := 0; END_VAR VAR none : ARRAY [0..n - 1] OF DINT; r : DINT := 5; END_VAR
           r := r + SIZEOF(none); END_PROGRAM",
        5,
    );
    let text = "PROGRAM P VAR none : ARRAY [0..-1] OF DINT; i : DINT; END_VAR none[i] := 1; END_PROGRAM";
    for dialect in VENDORS {
        let fault = Rig::in_dialect(dialect, text).scan().expect_err("there is no element");
        assert_eq!(fault.kind, FaultKind::IndexOutOfRange, "{dialect}");
    }
    let text =
        "PROGRAM P VAR a : ARRAY [0..-1] OF DINT; b : ARRAY [3..1] OF DINT; END_VAR a[0] := 1; b[3] := 1; END_PROGRAM";
    insta::assert_snapshot!(findings_in(Codesys, text), @r"
    test.st:1:53: error[D0408]: bounds 3..1 are reversed or beyond 32 bits
    test.st:1:78: error[T0205]: index 0 is outside of 0..-1
    ");
    insta::assert_snapshot!(findings_in(Dialect::Iec3, text), @r"
    test.st:1:26: error[D0408]: bounds 0..-1 are reversed or beyond 32 bits
    test.st:1:53: error[D0408]: bounds 3..1 are reversed or beyond 32 bits
    ");
}

#[test]
fn strings_are_made_while_a_program_runs() {
    gives(
        "PROGRAM P VAR p : POINTER TO STRING(10); q : POINTER TO STRING; r : DINT; END_VAR
           p := __NEW(STRING(10)); p^ := 'abcdefghijklm'; q := __NEW(STRING); q^ := CONCAT(p^, 'xy');
           r := LEN(p^) * 100 + LEN(q^); __DELETE(p); __DELETE(q); END_PROGRAM",
        1012,
    );
}

#[test]
fn an_enumeration_begins_with_a_value_of_its_own() {
    gives(
        "TYPE {attribute 'qualified_only'} Valve : (Shut := 3, Open := 4) USINT := Open; END_TYPE
         TYPE Door : (Open, Closed) := Closed; END_TYPE
         PROGRAM P VAR v : Valve; d : Door; r : DINT; END_VAR r := v * 10 + d; END_PROGRAM",
        41,
    );
}

#[test]
fn words_of_charts_are_names_of_members() {
    gives(
        "TYPE T : STRUCT Step : REFERENCE TO DINT; Transition : DINT; END_STRUCT END_TYPE
         PROGRAM P VAR t1 : T; r : DINT; END_VAR
           t1.Step REF= r; t1.Step := 4; t1.Transition := r; END_PROGRAM",
        4,
    );
}

#[test]
fn of_a_parameter_given_twice_the_last_value_counts() {
    let text = "FUNCTION_BLOCK B VAR_INPUT a, b : DINT; END_VAR VAR_OUTPUT q : DINT; END_VAR q := a * 10 + b; END_FUNCTION_BLOCK
         FUNCTION F : DINT VAR_INPUT a : DINT; END_VAR F := a; END_FUNCTION
         PROGRAM P VAR b1 : B; r : DINT; END_VAR b1(a := 1, b := 2, a := 3); r := b1.q * 10 + F(a := 4, a := 5); END_PROGRAM";
    gives(text, 325);
    insta::assert_snapshot!(findings_in(TwinCat, text), @r"
    test.st:3:69: warning[C0304]: this parameter is given twice, and the last value counts
    test.st:3:105: warning[C0304]: this parameter is given twice, and the last value counts
    ");
}

#[test]
fn an_instance_that_is_only_read_may_be_derived() {
    gives(
        "FUNCTION_BLOCK Base VAR_OUTPUT n : DINT; END_VAR
           METHOD Kind : DINT Kind := 1; END_METHOD
           METHOD Read : DINT VAR_IN_OUT CONSTANT other : Base; END_VAR Read := other.n * 10 + other.Kind(); END_METHOD
         END_FUNCTION_BLOCK
         FUNCTION_BLOCK Derived EXTENDS Base METHOD Kind : DINT Kind := 2; END_METHOD
           METHOD Go : DINT n := 7; Go := Read(THIS^); END_METHOD END_FUNCTION_BLOCK
         PROGRAM P VAR d : Derived; b : Base; r : DINT; END_VAR r := d.Go() * 100 + b.Read(d); END_PROGRAM",
        7272,
    );
}

#[test]
fn a_real_is_joined_with_a_wide_integer() {
    gives(
        "PROGRAM P VAR x : REAL := 20.5; u : ULINT := 8; l : LINT := -3; r : DINT; END_VAR
           r := REAL_TO_DINT((x - u + l) * 10); END_PROGRAM",
        95,
    );
}

#[test]
fn a_value_of_an_enumeration_takes_no_more_room_than_its_number() {
    gives(
        "TYPE Mode : (Off := 0, Far := 200) WORD; END_TYPE
         PROGRAM P VAR b : BYTE; r : DINT; END_VAR b := Mode.Far; r := b; END_PROGRAM",
        200,
    );
    let text =
        "TYPE Mode : (Off := 0, Far := 300) WORD; END_TYPE PROGRAM P VAR b : BYTE; END_VAR b := Mode.Far; END_PROGRAM";
    insta::assert_snapshot!(findings_in(TwinCat, text), @"test.st:1:88: error[T0201]: BYTE is wanted, this is WORD (convert it with WORD_TO_BYTE)");
}
