//! What single lines of public projects of CODESYS and TwinCAT rest on, in programs of our own.

use onescan_iec::Dialect::{Codesys, TwinCat};

use crate::project_code::gives;
use crate::rig::{Rig, findings_in};

#[test]
fn one_value_sets_and_resets_several() {
    // Each refers to the value at the end, which is evaluated once, not to the variable behind it.
    let text = "FUNCTION_BLOCK F VAR_INPUT on : BOOL; END_VAR VAR n : DINT; END_VAR
          METHOD M : BOOL n := n + 1; M := on; END_METHOD END_FUNCTION_BLOCK
        PROGRAM P VAR f1 : F; a, c : BOOL; b, d : BOOL := TRUE; r : DINT; END_VAR
          f1(on := VALUE); a S= b R= f1.M(); d R= c S= NOT f1.M();
          r := f1.n * 10000 + BOOL_TO_DINT(a) * 1000 + BOOL_TO_DINT(b) * 100 + BOOL_TO_DINT(c) * 10 + BOOL_TO_DINT(d);
        END_PROGRAM";
    gives(&text.replace("VALUE", "TRUE"), 21_001);
    gives(&text.replace("VALUE", "FALSE"), 20_110);
}

#[test]
fn enumerations_beside_numbers() {
    gives(
        "TYPE Fault : (Low := 16#2000, High := 16#20FF) UINT; END_TYPE
         PROGRAM P VAR u : UINT := 16#3000; f : Fault := Fault.Low; r : DINT; END_VAR
           u := MIN(u, Fault.High); r := u - MAX(f, u) + LIMIT(1, f, 16#2001) - 16#2000; IF f.13 AND NOT f.0 THEN r := r + 7; END_IF
         END_PROGRAM",
        7,
    );
}

#[test]
fn the_first_bit_of_a_bool_is_the_bool() {
    gives(
        "PROGRAM P VAR a : BOOL := TRUE; b : BOOL; r : DINT; END_VAR
           b.0 := a.0; IF b THEN r := 1; END_IF END_PROGRAM",
        1,
    );
    let beyond = "PROGRAM P VAR a, b : BOOL; END_VAR b := a.1; END_PROGRAM";
    insta::assert_snapshot!(findings_in(TwinCat, beyond), @"test.st:1:41: error[R0903]: BYTE, WORD, DWORD and LWORD have parts, this is BOOL");
}

#[test]
fn one_of_two_pointers() {
    gives(
        "TYPE Node : STRUCT n : DINT; END_STRUCT END_TYPE
         PROGRAM P VAR a : Node := (n := 3); b : Node := (n := 40); p, q : POINTER TO Node; r : DINT; END_VAR
           p := ADR(a); q := ADR(b); r := SEL(r = 0, p, SEL(r = 1, q, p))^.n; p := SEL(TRUE, p, q); r := r + p^.n;
           p := MUX(1, p, 0); IF p = 0 THEN r := r + 100; END_IF END_PROGRAM",
        180,
    );
}

#[test]
fn an_output_is_handed_on() {
    let text = "FUNCTION Twice : DINT VAR_IN_OUT n : DINT; END_VAR Twice := 2 * n; END_FUNCTION
        FUNCTION_BLOCK F VAR_OUTPUT q : DINT := 21; END_VAR END_FUNCTION_BLOCK
        PROGRAM P VAR f1 : F; r : DINT; END_VAR f1(); r := Twice(n := f1.q); END_PROGRAM";
    gives(text, 42);
    insta::assert_snapshot!(findings_in(TwinCat, text), @r"
    test.st:2:37: warning[W0701]: output `q` is never written
    test.st:3:71: warning[D0403]: an output is written by its own instance; what is written to it here does not last
    ");
}

#[test]
fn lists_with_a_comma_at_their_end() {
    gives(
        "INTERFACE I END_INTERFACE INTERFACE J EXTENDS I, METHOD M : DINT END_METHOD END_INTERFACE
         FUNCTION_BLOCK F IMPLEMENTS J, VAR k : DINT; END_VAR
           METHOD FB_init : BOOL VAR_INPUT bInitRetains, bInCopyCode : BOOL; n : DINT; END_VAR k := n; END_METHOD
           METHOD M : DINT M := k; END_METHOD END_FUNCTION_BLOCK
         PROGRAM P VAR f1 : F(n := 5,); r : DINT; END_VAR r := f1.M(); END_PROGRAM",
        5,
    );
}

#[test]
fn a_literal_is_shifted_in_the_smallest_type_that_holds_it() {
    let text = "PROGRAM P VAR n : INT := 3; a : BYTE; b, c : DWORD; r : DINT; END_VAR
        a := SHL(1, n); b := SHL(1, n + 5); c := SHL(16#100, n); r := a + c + b; END_PROGRAM";
    gives(text, 0x808);
    insta::assert_snapshot!(findings_in(Codesys, text), @r"
    test.st:2:18: warning[W0708]: 1 is shifted as BYTE, the smallest type that holds it (say how many bits are shifted, as in DWORD#1)
    test.st:2:34: warning[W0708]: 1 is shifted as BYTE, the smallest type that holds it (say how many bits are shifted, as in DWORD#1)
    test.st:2:54: warning[W0708]: 256 is shifted as WORD, the smallest type that holds it (say how many bits are shifted, as in DWORD#256)
    test.st:2:71: warning[W0708]: this DWORD may change its sign as DINT (DWORD_TO_DINT says that it is meant)
    ");
}

#[test]
fn what_a_stub_is_begun_with_is_not_asked_for() {
    gives(
        "{external} FUNCTION_BLOCK Base METHOD FB_init : BOOL VAR_INPUT bInitRetains, bInCopyCode : BOOL; p1 : ANY; END_VAR
           END_METHOD END_FUNCTION_BLOCK
         FUNCTION_BLOCK F EXTENDS Base VAR k : DINT; END_VAR
           METHOD FB_init : BOOL VAR_INPUT bInitRetains, bInCopyCode : BOOL; n : DINT; END_VAR k := n; END_METHOD
           METHOD M : DINT M := k; END_METHOD END_FUNCTION_BLOCK
         PROGRAM P VAR f1 : F(n := 5); r : DINT; END_VAR r := f1.M(); END_PROGRAM",
        5,
    );
}

#[test]
fn a_reference_begins_at_a_variable_that_is_declared_later() {
    gives(
        "INTERFACE I METHOD M : DINT END_METHOD END_INTERFACE
         FUNCTION_BLOCK Off IMPLEMENTS I METHOD M : DINT M := 7; END_METHOD END_FUNCTION_BLOCK
         FUNCTION_BLOCK Machine VAR state : I := off1; off1 : Off; p : POINTER TO DINT := ADR(list[1]); list : ARRAY [0..1] OF DINT := [1, 50];
           b : REFERENCE TO DINT REF= list2[0]; list2 : ARRAY [0..1] OF DINT := [600, 2]; END_VAR
           VAR_OUTPUT q : DINT; END_VAR q := state.M() + p^ + b; END_FUNCTION_BLOCK
         PROGRAM P VAR m : Machine; r : DINT; END_VAR m(); r := m.q; END_PROGRAM",
        657,
    );
    // The value of a later variable is not there yet.
    let value = "PROGRAM P VAR a : DINT := b; b : DINT := 5; END_VAR a := b; END_PROGRAM";
    insta::assert_snapshot!(findings_in(TwinCat, value), @"test.st:1:27: error[N0101]: `b` is not declared");
}

#[test]
fn a_constant_says_how_many_structures_there_are() {
    let text = "TYPE S : STRUCT a : INT; b : INT := 2; END_STRUCT END_TYPE
        PROGRAM P VAR CONSTANT many : INT := 3; END_VAR
        VAR list : ARRAY [1..many] OF S := [many((a := 4, b := 5))]; sum, i : INT; END_VAR
          sum := 0; FOR i := 1 TO many DO sum := sum + list[i].a * list[i].b; END_FOR END_PROGRAM";
    for dialect in [Codesys, TwinCat] {
        let mut rig = Rig::in_dialect(dialect, text);
        rig.scan().expect("no fault");
        assert_eq!(rig.int("P.sum"), 60, "{dialect}");
    }
}
