//! Code of released projects of CODESYS and TwinCAT that other tools compile, in small programs of our own.

use onescan_iec::Dialect::{self, Codesys, Iec3, TwinCat};

use crate::rig::{Rig, findings_in};

const VENDORS: &[Dialect] = &[Codesys, TwinCat];

/// What `P.r` is after one scan.
fn gives(text: &str, expected: i64) {
    for dialect in VENDORS {
        let mut rig = Rig::in_dialect(*dialect, text);
        rig.scan().expect("no fault");
        assert_eq!(rig.int("P.r"), expected, "{dialect}: {text}");
    }
}

#[test]
fn a_bound_is_a_constant_of_a_bit_string() {
    gives(
        "VAR_GLOBAL CONSTANT n : BYTE := 3; m : WORD := 16#10; END_VAR
         PROGRAM P VAR a : ARRAY [1..n] OF INT; b : ARRAY [0..m - 1] OF BYTE; s : STRING(n); r : UDINT; END_VAR
           r := SIZEOF(a) * 10000 + SIZEOF(b) * 100 + SIZEOF(s); END_PROGRAM",
        61_604,
    );
}

#[test]
fn equal_initial_values_are_counted_by_name() {
    gives(
        "VAR_GLOBAL CONSTANT n : INT := 3; END_VAR
         PROGRAM P VAR a : ARRAY [1..4] OF INT := [n(5), 7]; r : INT; END_VAR
           r := a[1] * 1000 + a[2] * 100 + a[3] * 10 + a[4]; END_PROGRAM",
        5557,
    );
    gives(
        "TYPE S : STRUCT k : INT; l : INT; END_STRUCT END_TYPE
         VAR_GLOBAL CONSTANT n : BYTE := 2; END_VAR
         PROGRAM P VAR CONSTANT k : INT := 2; END_VAR
           VAR a : ARRAY [1..3] OF S := [n((k := 4, l := 5)), (k := 6)]; x : INT := 8; r : DINT;
           b : ARRAY [0..2] OF INT := [k(x), 1]; c : ARRAY [0..1] OF ARRAY [0..1] OF INT := [k([2, 3])]; END_VAR
           r := INT_TO_DINT(a[2].l) * 10000 + a[3].k * 1000 + b[1] * 100 + b[2] * 10 + c[1][1]; END_PROGRAM",
        56_813,
    );
    gives(
        "NAMESPACE OPEN GVL VAR_GLOBAL CONSTANT n : UINT := 2; END_VAR END_NAMESPACE
         PROGRAM P VAR a : ARRAY [1..3] OF INT := [GVL.n(5), GVL.n - 1]; r : INT; END_VAR
           r := a[1] * 100 + a[2] * 10 + a[3]; END_PROGRAM",
        551,
    );
    let text = "PROGRAM P VAR n : INT := 2; a : ARRAY [1..2] OF INT := [n(5)]; END_VAR a[1] := a[2]; END_PROGRAM";
    assert!(findings_in(TwinCat, text).to_string().contains("a constant is wanted here"));
    // A function is called, as before.
    gives(
        "FUNCTION F : INT VAR_INPUT x : INT; END_VAR F := 2 * x; END_FUNCTION
         PROGRAM P VAR a : ARRAY [0..1] OF INT := [F(5), F(6)]; r : INT; END_VAR r := a[0] * 100 + a[1]; END_PROGRAM",
        1012,
    );
}

#[test]
fn a_structure_is_assigned_to_one_that_it_extends() {
    let types =
        "TYPE B : STRUCT a : INT := 1; END_STRUCT END_TYPE TYPE D EXTENDS B : STRUCT c : INT; END_STRUCT END_TYPE
         TYPE E EXTENDS D : STRUCT f : INT; END_STRUCT END_TYPE TYPE Other : STRUCT a : INT; END_STRUCT END_TYPE ";
    gives(
        &format!(
            "{types} FUNCTION F : INT VAR_INPUT x : B; END_VAR F := x.a; END_FUNCTION
             PROGRAM P VAR b1 : B; e1 : E := (a := 7, c := 8); n : INT := 5; r : INT; END_VAR
               b1 := e1; e1.a := 3; r := 100 * b1.a + 10 * F(e1) + n; END_PROGRAM"
        ),
        735,
    );
    for wrong in ["d1 := b1;", "b1 := o1;"] {
        let text = format!("{types} PROGRAM P VAR b1 : B; d1 : D; o1 : Other; END_VAR {wrong} END_PROGRAM");
        assert!(findings_in(TwinCat, &text).has_errors(), "{wrong}");
    }
}

#[test]
fn a_point_leads_to_what_is_global() {
    gives(
        "VAR_GLOBAL g : INT := 4; END_VAR FUNCTION F : INT F := 5; END_FUNCTION
         PROGRAM P VAR g : INT := 1; r : INT; END_VAR
           .g := .g + g; IF .g > 4 THEN r := .g * 100 + g * 10 + .F(); END_IF; END_PROGRAM",
        515,
    );
    let unknown = findings_in(Codesys, "PROGRAM P VAR g : INT; END_VAR .g := 1; END_PROGRAM").to_string();
    assert!(unknown.contains("`.g` is not declared"), "{unknown}");
    let foreign = findings_in(Iec3, "VAR_GLOBAL g : INT; END_VAR PROGRAM P .g := 1; END_PROGRAM").to_string();
    assert!(foreign.contains("--dialect chooses"), "{foreign}");
}

#[test]
fn a_variable_lies_at_the_byte_of_an_address_of_another_width() {
    gives(
        "PROGRAM P VAR a AT %MB4 : INT := 16#1234; b AT %MB5 : BYTE; c AT %MD12 : BYTE := 7; r : INT; END_VAR
           r := BYTE_TO_INT(b) * 10 + c; END_PROGRAM",
        187,
    );
    for dialect in VENDORS {
        let found = findings_in(*dialect, "PROGRAM P VAR a AT %IX0.0 : INT; b : INT; END_VAR b := a; END_PROGRAM");
        assert!(found.has_errors(), "{dialect}: {found}");
    }
}

#[test]
fn types_have_a_size() {
    gives("PROGRAM P VAR r : UDINT; END_VAR r := SIZEOF(STRING(255)) * 10 + SIZEOF(INT); END_PROGRAM", 2562);
    gives("PROGRAM P VAR r : UDINT; END_VAR r := SIZEOF(WSTRING[3]) * 100 + SIZEOF(STRING); END_PROGRAM", 881);
    gives("PROGRAM P VAR r : UDINT; END_VAR r := SIZEOF(POINTER TO STRING(255)); END_PROGRAM", 4);
}

#[test]
fn memory_is_made_of_strings_and_pointers() {
    gives(
        "PROGRAM P VAR p : POINTER TO STRING(1); q : POINTER TO POINTER TO STRING(255); s : STRING(255) := 'abc'; r : INT;
         END_VAR
           p := __NEW(STRING(1), 5); q := __NEW(POINTER TO STRING(255), 3);
           q[2] := ADR(s); p^ := 'x'; r := LEN(q[2]^) * 10 + LEN(p^); __DELETE(p); __DELETE(q); END_PROGRAM",
        31,
    );
}

#[test]
fn strings_are_as_long_as_memory_allows() {
    gives(
        "PROGRAM P VAR s : STRING(100000); t : STRING(50000); w : WSTRING(40000) := \"ab\"; i : DINT; r : DINT; END_VAR
           FOR i := 0 TO 49998 DO t[i] := 16#41; END_FOR; t[49999] := 0;
           s := t; r := TO_DINT(s[49998]) + LEN(w); IF s = t THEN r := r + 1000; END_IF r := r + LEN(s); END_PROGRAM",
        // The functions count 255 characters.
        0x41 + 2 + 1000 + 255,
    );
    let found = |length: &str, dialect| {
        let text = format!("PROGRAM P VAR s : STRING({length}); END_VAR s := 'a'; END_PROGRAM");
        findings_in(dialect, &text).to_string()
    };
    assert!(found("100_000_000", TwinCat).contains("take more than 64 MiB"), "{}", found("100_000_000", TwinCat));
    assert!(found("40000", Iec3).contains("1 to 32767"), "{}", found("40000", Iec3));
}

/// What `P.<name>` is after one scan.
fn texts(text: &str, expected: &[(&str, &str)]) {
    for dialect in VENDORS {
        let mut rig = Rig::in_dialect(*dialect, text);
        rig.scan().expect("no fault");
        for (name, value) in expected {
            assert_eq!(rig.plc.read(name).expect("a variable"), format!("'{value}'"), "{dialect}: {name}");
        }
    }
}

#[test]
fn operators_give_the_unit_and_the_place_of_the_text() {
    texts(
        "VAR_GLOBAL g : STRING; END_VAR
         FUNCTION_BLOCK F
           VAR_OUTPUT q : STRING := __POUNAME(); m, n : STRING; END_VAR
           METHOD Act
             m := __POUNAME();
           END_METHOD
           PROPERTY Name : STRING
             GET
               Name := __POUNAME();
             END_GET
           END_PROPERTY
           Act(); n := Name;
         END_FUNCTION_BLOCK
         FUNCTION H : STRING H := __POUNAME(); END_FUNCTION
PROGRAM P
VAR
    f1 : F; a : STRING;
    b : STRING := __POSITION(); c : STRING;
END_VAR
f1(); a := CONCAT(CONCAT(__POUNAME(), '/'), H());
    c := __POSITION();
END_PROGRAM",
        &[
            ("P.f1.q", "F"),
            ("P.f1.m", "F.Act"),
            ("P.f1.n", "F.Name.Get"),
            ("P.a", "P/H"),
            ("P.b", "Line 4 (Decl)"),
            ("P.c", "Line 2, Column 10 (Impl)"),
        ],
    );
}

#[test]
fn an_unsigned_integer_is_given_for_its_bits() {
    gives(
        "FUNCTION F : BOOL VAR_IN_OUT w : WORD; END_VAR w := w + 1; F := TRUE; END_FUNCTION
         PROGRAM P VAR u : UINT := 4; s : STRING; r : INT; END_VAR
           F(u); s := F_FormatArgToText(u); r := u * 10 + LEN(s); END_PROGRAM
         FUNCTION F_FormatArgToText : STRING VAR_INPUT u : UINT; END_VAR VAR a : T_Arg; END_VAR
           a := F_WORD(u); F_FormatArgToText := UDINT_TO_STRING(a.cbLen); END_FUNCTION",
        51,
    );
    let text = "FUNCTION F : BOOL VAR_IN_OUT w : WORD; END_VAR F := w.0; END_FUNCTION
         PROGRAM P VAR i : INT; END_VAR F(i); END_PROGRAM";
    assert!(findings_in(TwinCat, text).has_errors());
}

#[test]
fn exceptions_have_codes() {
    gives(
        "PROGRAM P VAR e : __SYSTEM.ExceptionCode := __SYSTEM.ExceptionCode.RTSEXCPT_NOEXCEPTION; r, RTSEXCPT_OVERFLOW : UDINT; END_VAR
           __TRY r := 5;
           __CATCH(e) IF e = __SYSTEM.ExceptionCode.RTSEXCPT_DIVIDEBYZERO THEN r := 2; END_IF;
           __FINALLY r := r * 1000 + __SYSTEM.ExceptionCode.RTSEXCPT_DIVIDEBYZERO; __ENDTRY
           IF e <> __SYSTEM.ExceptionCode.RTSEXCPT_NOEXCEPTION THEN r := 0; END_IF; END_PROGRAM",
        5258,
    );
}

/// SIMATIC AX.
#[test]
fn a_call_without_arguments_leaves_out_what_has_a_value() {
    let text = "CLASS K METHOD PUBLIC M : INT VAR_INPUT a : INT := 4; b : INT := 5; END_VAR M := 10 * a + b; END_METHOD END_CLASS
         PROGRAM P VAR k1 : K; r : INT; END_VAR r := k1.M() * 100 + k1.M(b := 2); END_PROGRAM";
    let mut rig = Rig::in_dialect(Iec3, text);
    rig.scan().expect("no fault");
    assert_eq!(rig.int("P.r"), 4542);
    let text = "FUNCTION F : INT VAR_INPUT a : INT := 4; b : INT; END_VAR F := a + b; END_FUNCTION
         PROGRAM P VAR n : INT; END_VAR n := F(); END_PROGRAM";
    let findings = findings_in(Iec3, text);
    assert!(
        !findings.has_errors() && findings.to_string().contains("parameter `b` is missing: it is what"),
        "{findings}"
    );
}

/// `TcOpen` takes the names of its inputs and outputs for its messages.
#[test]
fn what_is_known_of_a_variable() {
    gives(
        "TYPE S : STRUCT level : ARRAY [0..2] OF INT; END_STRUCT END_TYPE
         PROGRAM P VAR s : S; x : REAL; info, other : __SYSTEM.VAR_INFO; r : DINT; END_VAR
           info := __VARINFO(s.level); other := __VARINFO(x);
           IF info.Symbol = 's.level' AND other.Symbol = 'x' AND other.TypeName = 'REAL' AND info.BitNr = -1
             AND info.TypeClass = __SYSTEM.TYPE_CLASS.TYPE_ARRAY AND other.TypeClass = __SYSTEM.TYPE_CLASS.TYPE_REAL
             AND info.BaseTypeClass = __SYSTEM.TYPE_CLASS.TYPE_INT AND info.ElemBitSize = 16 THEN
             r := UDINT_TO_DINT(info.NumElements * 10000 + info.BitSize * 100 + other.BitSize); END_IF END_PROGRAM",
        34_832,
    );
}

/// Alone, without another name of its namespace.
#[test]
fn the_symbol_of_a_variable_alone() {
    gives(
        "PROGRAM P VAR x, r : DINT; END_VAR r := LEN(__VARINFO(x).Symbol) * 10 + LEN(__VARINFO(x).TypeName); END_PROGRAM",
        14,
    );
}

/// `TwinCAT3-Utilities-Hash-BLAKE3` has its flags so.
#[test]
fn a_constant_is_a_shift() {
    gives(
        "VAR_GLOBAL CONSTANT flag : DWORD := SHL(DWORD#1, 4); low : WORD := SHR(WORD#16#FF00, 8); END_VAR
         PROGRAM P VAR a : ARRAY [0..flag] OF BYTE; r : DWORD; END_VAR r := SIZEOF(a) * 1000 + low; END_PROGRAM",
        17_255,
    );
}
