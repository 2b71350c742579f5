//! Every row of the table of dialects acts: what a dialect lacks is reported with the dialects that have
//! it, what it has compiles, and what it does its own way is done.

use onescan_iec::dialect::{DivisionByZero, Feature, Ties, TimeRange};
use onescan_iec::{Code, Dialect, Severity};
use onescan_iec_run::FaultKind;

use crate::rig::{Rig, findings_in};

/// A program that uses the construct and nothing else that dialects differ in.
fn use_of(feature: Feature) -> &'static str {
    match feature {
        Feature::NestedComments => "PROGRAM P (* a (* b *) c *) END_PROGRAM",
        Feature::LineComments => "PROGRAM P // a\nEND_PROGRAM",
        Feature::StarComments => "PROGRAM P /* a */ END_PROGRAM",
        Feature::Continue => "PROGRAM P VAR i : INT; END_VAR FOR i := 1 TO 2 DO CONTINUE; END_FOR; END_PROGRAM",
        Feature::Power => "PROGRAM P VAR x : LREAL; END_VAR x := x ** 2; END_PROGRAM",
        Feature::LooseEnds => "PROGRAM P VAR b : BOOL; END_VAR IF b THEN b := FALSE; END_IF END_PROGRAM",
        Feature::ShortCircuit => "PROGRAM P VAR b : BOOL; END_VAR b := b AND_THEN b; END_PROGRAM",
        Feature::SetReset => "PROGRAM P VAR b : BOOL; END_VAR b S= b; END_PROGRAM",
        Feature::ChainedAssignment => "PROGRAM P VAR a, b : INT; END_VAR a := b := 1; END_PROGRAM",
        Feature::CompoundAssignment => "PROGRAM P VAR a : INT; END_VAR a += 1; END_PROGRAM",
        Feature::BareArrayValues => {
            "PROGRAM P VAR a : ARRAY [0..2] OF INT := 1, 2(3); END_VAR a[0] := a[1]; END_PROGRAM"
        }
        Feature::ConditionalPragmas => "PROGRAM P {IF defined (x)} {END_IF} END_PROGRAM",
        Feature::Jumps => "PROGRAM P VAR a : INT; END_VAR JMP done; a := 1; done: END_PROGRAM",
        Feature::ControlParts => {
            "PROGRAM P VAR a : ARRAY [0..1] OF INT; n : INT; END_VAR FOR a[1] := 0 TO 3 DO n := n + 1; END_FOR; END_PROGRAM"
        }
        Feature::StaticSection => "PROGRAM P VAR_STAT a : INT; END_VAR a := a + 1; END_PROGRAM",
        Feature::InstanceSection => {
            "FUNCTION_BLOCK F METHOD M VAR_INST n : INT; END_VAR n := n + 1; END_METHOD END_FUNCTION_BLOCK
             PROGRAM P VAR f1 : F; END_VAR f1.M(); END_PROGRAM"
        }
        Feature::FleetingInstances => {
            "FUNCTION F : BOOL VAR_INPUT a : BOOL; END_VAR VAR t : R_TRIG; END_VAR t(CLK := a); F := t.Q; END_FUNCTION
             PROGRAM P VAR b : BOOL; END_VAR b := F(b); END_PROGRAM"
        }
        Feature::InitArguments => {
            "FUNCTION_BLOCK F VAR k : INT; END_VAR
             METHOD FB_init : BOOL VAR_INPUT bInitRetains, bInCopyCode : BOOL; n : INT; END_VAR k := n; END_METHOD
             END_FUNCTION_BLOCK
             PROGRAM P VAR f1 : F(n := 1); END_VAR f1(); END_PROGRAM"
        }
        Feature::ComputedInitialValues => "PROGRAM P VAR a : INT := 1; b : INT := a + 1; END_VAR a := b; END_PROGRAM",
        Feature::BitArithmetic => "PROGRAM P VAR b : BYTE; i : INT; END_VAR b := b + 1; i := b; END_PROGRAM",
        Feature::EnumerationsAsIntegers => {
            "TYPE C : (Red, Green); END_TYPE PROGRAM P VAR c1 : C; i : INT; END_VAR i := c1; c1 := i; END_PROGRAM"
        }
        Feature::SignChange => "PROGRAM P VAR u : UINT; i : INT; END_VAR i := u; END_PROGRAM",
        Feature::LossyReals => "PROGRAM P VAR r : REAL; l : LREAL; d : DINT; END_VAR r := l; r := d; END_PROGRAM",
        Feature::CharactersAsBytes => "PROGRAM P VAR s : STRING; b : BYTE; END_VAR b := s[0]; s[0] := b; END_PROGRAM",
        Feature::VendorParameters => {
            "PROGRAM P VAR c : CTU; b : BOOL; END_VAR c(CU := b, RESET := b, PV := 3); c.RESET := TRUE; END_PROGRAM"
        }
        Feature::Variants => {
            "FUNCTION F : BOOL VAR_INPUT v : VARIANT; END_VAR F := IS_ARRAY(v); END_FUNCTION
             PROGRAM P VAR n : INT; b : BOOL; END_VAR b := F(n); END_PROGRAM"
        }
        Feature::GenericInputs => {
            "FUNCTION F : DINT VAR_INPUT v : ANY; END_VAR F := v.diSize; END_FUNCTION
             PROGRAM P VAR a : INT; n : DINT; END_VAR n := F(a); END_PROGRAM"
        }
        Feature::IntegerShifts => "PROGRAM P VAR i : INT; END_VAR i := SHR(i, 1); END_PROGRAM",
        Feature::ClockFunctions => "PROGRAM P VAR t : TIME; END_VAR t := TIME(); END_PROGRAM",
        Feature::OwnStandardBlocks => {
            "FUNCTION_BLOCK SR VAR_INPUT a : INT; END_VAR END_FUNCTION_BLOCK PROGRAM P VAR f1 : SR; END_VAR f1(a := 1); END_PROGRAM"
        }
        Feature::QuotedNames => "PROGRAM P VAR a : INT; END_VAR a := #a + 1; END_PROGRAM",
        Feature::Blocks => "ORGANIZATION_BLOCK P VAR_TEMP a : INT; END_VAR BEGIN a := 1; END_ORGANIZATION_BLOCK",
        Feature::InstanceInternals => {
            "FUNCTION_BLOCK F VAR a : INT; END_VAR a := a + 1; END_FUNCTION_BLOCK
             PROGRAM P VAR f1 : F; b : INT; END_VAR f1(); f1.a := b; END_PROGRAM"
        }
        Feature::BitsAsReals => "PROGRAM P VAR w : WORD; r : REAL; END_VAR r := WORD_TO_REAL(w); END_PROGRAM",
        Feature::EmptyArguments => "PROGRAM P VAR t : TON; END_VAR t(IN := TRUE, PT := ); END_PROGRAM",
        Feature::WindowsCharacters => "PROGRAM P VAR s : STRING := '€'; END_VAR s := s; END_PROGRAM",
        Feature::LeftOutInputs => {
            "FUNCTION F : INT VAR_INPUT a : INT; b : INT := 7; END_VAR F := a + b; END_FUNCTION
             PROGRAM P VAR n : INT; END_VAR n := F(1); END_PROGRAM"
        }
        Feature::LooseStrings => {
            "FUNCTION F : INT VAR_IN_OUT s : STRING[9]; END_VAR F := LEN(s); s := 'a'; END_FUNCTION
             PROGRAM P VAR s : STRING[20]; n : INT; END_VAR n := F(s); END_PROGRAM"
        }
        Feature::DoubleQuotes => "PROGRAM P VAR s : STRING := \"a\"; END_VAR s := s; END_PROGRAM",
        Feature::LooseWidths => "PROGRAM P VAR d AT %ML50 : DWORD; END_VAR d := d; END_PROGRAM",
        Feature::OwnStandardFunctions => {
            "FUNCTION MULTIME : TIME VAR_INPUT t : TIME; x : REAL; END_VAR MULTIME := t; END_FUNCTION
             PROGRAM P VAR t : TIME; END_VAR t := MULTIME(t := t, x := 2.0); END_PROGRAM"
        }
        Feature::InstanceCopies => "PROGRAM P VAR a, b : TON; END_VAR a := b; END_PROGRAM",
        Feature::ReadableInternals => {
            "FUNCTION_BLOCK F VAR a : INT; END_VAR a := a + 1; END_FUNCTION_BLOCK
             PROGRAM P VAR f1 : F; b : INT; END_VAR f1(); b := f1.a; END_PROGRAM"
        }
        Feature::ProgramInstances => {
            "PROGRAM Q VAR_INPUT i : INT; END_VAR VAR n : INT; END_VAR n := i; END_PROGRAM
             PROGRAM P VAR x : INT; END_VAR Q(i := 1); x := Q.n; END_PROGRAM"
        }
        Feature::ShortPrefixes => "PROGRAM P VAR w : WORD; END_VAR w := W#16#FF; END_PROGRAM",
        Feature::DivOperator => "PROGRAM P VAR a : INT; END_VAR a := a DIV 2; END_PROGRAM",
        other => use_in_projects(other),
    }
}

/// The same of what projects brought to light.
fn use_in_projects(feature: Feature) -> &'static str {
    match feature {
        Feature::NamedValues => {
            "TYPE C : INT (A := 1, B := 2); END_TYPE PROGRAM P VAR c1 : C; i : INT; END_VAR i := c1; c1 := i; END_PROGRAM"
        }
        Feature::Views => {
            "PROGRAM P VAR a : DWORD; b AT a : ARRAY [0..3] OF BYTE; c : BYTE; END_VAR c := b[0]; END_PROGRAM"
        }
        Feature::ElseColon => "PROGRAM P VAR a : INT; END_VAR CASE a OF 1: a := 2; ELSE: a := 3; END_CASE; END_PROGRAM",
        Feature::LooseParts => {
            "TYPE C : (Red, Green); END_TYPE PROGRAM P VAR c1 : C; b : BOOL; END_VAR b := c1.0; END_PROGRAM"
        }
        Feature::OutputsHandedOn => {
            "FUNCTION F : BOOL VAR_IN_OUT b : BOOL; END_VAR F := b; END_FUNCTION
             PROGRAM P VAR t : TON; b : BOOL; END_VAR b := F(t.Q); END_PROGRAM"
        }
        Feature::EmptyBases => {
            "INTERFACE I END_INTERFACE
             FUNCTION_BLOCK F IMPLEMENTS I, END_FUNCTION_BLOCK PROGRAM P VAR f1 : F; END_VAR f1(); END_PROGRAM"
        }
        Feature::ShiftedLiterals => "PROGRAM P VAR b : BYTE; n : INT; END_VAR b := SHL(1, n); END_PROGRAM",
        Feature::ReadableInOuts => {
            "FUNCTION_BLOCK F VAR_IN_OUT n : INT; END_VAR n := n + 1; END_FUNCTION_BLOCK
             PROGRAM P VAR f1 : F; a, b : INT; END_VAR f1(n := a); b := f1.n; END_PROGRAM"
        }
        Feature::LoneOutputs => {
            "FUNCTION F : INT VAR_OUTPUT q : INT; END_VAR q := 3; F := 1; END_FUNCTION
             PROGRAM P VAR a, b : INT; END_VAR a := F(b); END_PROGRAM"
        }
        Feature::IntegerParts => "PROGRAM P VAR i : INT; x : BOOL; END_VAR x := i.%X3; END_PROGRAM",
        Feature::ProgramInOuts => "PROGRAM P VAR_IN_OUT n : INT; END_VAR n := n + 1; END_PROGRAM",
        Feature::CCode => "PROGRAM P VAR a : INT; END_VAR {{ SetFbVar(a, 1); }} a := a + 1; END_PROGRAM",
        Feature::ConditionalReturns => "PROGRAM P VAR b : BOOL; END_VAR RETURN (b); b := TRUE; END_PROGRAM",
        Feature::LooseLast => "PROGRAM P VAR b : BOOL; END_VAR IF b THEN b := FALSE END_IF; END_PROGRAM",
        Feature::DbSpecific => {
            "FUNCTION_BLOCK F VAR DB_SPECIFIC a : INT; END_VAR a := a + 1; END_FUNCTION_BLOCK
             PROGRAM P VAR f1 : F; END_VAR f1(); END_PROGRAM"
        }
        Feature::UntypedConstants => {
            "FUNCTION_BLOCK F CONST k := 5; END_CONST VAR a : INT; END_VAR a := k; END_FUNCTION_BLOCK
             PROGRAM P VAR f1 : F; END_VAR f1(); END_PROGRAM"
        }
        Feature::AlikeStructures => {
            "PROGRAM P VAR a : STRUCT x : INT; END_STRUCT; b : STRUCT x : INT; END_STRUCT; END_VAR a := b; END_PROGRAM"
        }
        Feature::IntegersAsReals => "PROGRAM P VAR r : REAL; d : DINT; END_VAR r := d; END_PROGRAM",
        Feature::ValuesByContext => {
            "TYPE A : (One, Two); B : (Two, Three); END_TYPE PROGRAM P VAR b1 : B; END_VAR b1 := Two; END_PROGRAM"
        }
        Feature::DynamicMemory => "PROGRAM P VAR p : POINTER TO BYTE; END_VAR p := __NEW(BYTE); END_PROGRAM",
        Feature::AssignedValues => "PROGRAM P VAR a, b : BOOL; END_VAR IF a := b THEN b := FALSE; END_IF END_PROGRAM",
        Feature::ValueStatements => {
            "FUNCTION_BLOCK F VAR_OUTPUT q : INT; END_VAR q := 1; END_FUNCTION_BLOCK
             PROGRAM P VAR f1 : F; END_VAR f1(); f1.q; END_PROGRAM"
        }
        Feature::Exceptions => "PROGRAM P VAR a : INT; END_VAR __TRY a := 1; __CATCH a := 2; __ENDTRY END_PROGRAM",
        Feature::Recursion => {
            "FUNCTION F : INT VAR_INPUT n : INT; END_VAR IF n > 0 THEN F := F(n - 1); END_IF; END_FUNCTION
             PROGRAM P VAR a : INT; END_VAR a := F(a); END_PROGRAM"
        }
        Feature::RepeatedArguments => {
            "FUNCTION F : INT VAR_INPUT a : INT; END_VAR F := a; END_FUNCTION
             PROGRAM P VAR n : INT; END_VAR n := F(a := 1, a := 2); END_PROGRAM"
        }
        Feature::LooseUnderscores => "PROGRAM P VAR w : WORD; END_VAR w := 16#7F__00; END_PROGRAM",
        Feature::EmptyArrays => {
            "PROGRAM P VAR a : ARRAY [0..-1] OF INT; b : ARRAY [0..0] OF INT; END_VAR b[0] := 1; END_PROGRAM"
        }
        other => use_in_more_projects(other),
    }
}

/// And of what others did.
fn use_in_more_projects(feature: Feature) -> &'static str {
    match feature {
        Feature::BaseParts => {
            "TYPE B : STRUCT a : INT; END_STRUCT END_TYPE TYPE D EXTENDS B : STRUCT c : INT; END_STRUCT END_TYPE
             PROGRAM P VAR b1 : B; d1 : D; END_VAR b1 := d1; END_PROGRAM"
        }
        Feature::GlobalOperator => {
            "VAR_GLOBAL g : INT; END_VAR PROGRAM P VAR n : INT; END_VAR .g := 1; n := .g; END_PROGRAM"
        }
        Feature::PlacesOfText => {
            "PROGRAM P VAR s : STRING := __POUNAME(); END_VAR s := __POSITION(); END_PROGRAM"
        }
        Feature::BitsInOut => {
            "FUNCTION F : BOOL VAR_IN_OUT w : WORD; END_VAR F := w.0; END_FUNCTION
             PROGRAM P VAR u : UINT; b : BOOL; END_VAR b := F(u); END_PROGRAM"
        }
        Feature::EmptyLists => {
            "FUNCTION F : INT VAR_INPUT a : INT := 4; END_VAR F := a; END_FUNCTION
             PROGRAM P VAR n : INT; END_VAR n := F(); END_PROGRAM"
        }
        Feature::CharactersAsText => "PROGRAM P VAR c : CHAR; s : STRING; END_VAR s := c; END_PROGRAM",
        Feature::PositionalOutputs => {
            "FUNCTION F : INT VAR_INPUT a : INT; END_VAR VAR_OUTPUT b : INT; END_VAR F := a; b := 2 * a; END_FUNCTION
             PROGRAM P VAR n, m : INT; END_VAR n := F(n, m); END_PROGRAM"
        }
        Feature::CharactersSelect => {
            "PROGRAM P VAR s : STRING; n : INT; END_VAR CASE s OF 'a': n := 1; 'b', 'c': n := 2; END_CASE; END_PROGRAM"
        }
        Feature::BareCalls => {
            "FUNCTION F : INT VAR_INPUT a : INT; END_VAR F := a; END_FUNCTION
             PROGRAM P VAR n : INT; END_VAR n := F(); END_PROGRAM"
        }
        Feature::Overloads => {
            "FUNCTION F : INT VAR_INPUT a : INT; END_VAR F := a; END_FUNCTION
             FUNCTION F : INT VAR_INPUT a : BOOL; END_VAR F := 1; END_FUNCTION
             PROGRAM P VAR n : INT; END_VAR n := F(n); END_PROGRAM"
        }
        Feature::NamedCounts => {
            "VAR_GLOBAL CONSTANT n : INT := 3; END_VAR
             PROGRAM P VAR a : ARRAY [1..4] OF INT := [n(5), 7]; END_VAR a[1] := a[2]; END_PROGRAM"
        }
        Feature::DecimalBase => "PROGRAM P VAR n : INT; END_VAR n := 10#300; END_PROGRAM",
        Feature::GenericConstants => {
            "FUNCTION_BLOCK F VAR_GENERIC CONSTANT n : INT := 1; END_VAR VAR a : ARRAY [1..n] OF INT; END_VAR a[1] := n; END_FUNCTION_BLOCK
             PROGRAM P VAR f1 : F<2>; END_VAR f1(); END_PROGRAM"
        }
        other => use_in_released_projects(other),
    }
}

/// And of what tools accept without saying so.
fn use_in_released_projects(feature: Feature) -> &'static str {
    match feature {
        Feature::UnusedUnits => {
            "PROGRAM P END_PROGRAM FUNCTION F : INT F := nowhere; END_FUNCTION
             CONFIGURATION C TASK T (INTERVAL := T#10ms, PRIORITY := 1); PROGRAM P1 WITH T : P; END_CONFIGURATION"
        }
        Feature::ThisPointer => {
            "FUNCTION_BLOCK F VAR p : POINTER TO F; END_VAR p := THIS; END_FUNCTION_BLOCK
             PROGRAM P VAR f1 : F; END_VAR f1(); END_PROGRAM"
        }
        Feature::TimesBesideNumbers => "PROGRAM P VAR t : TIME; b : BOOL; END_VAR b := t < 0; END_PROGRAM",
        Feature::TimesAsDates => "PROGRAM P VAR t : TIME; d : DT; END_VAR d := TIME_TO_DT(t); END_PROGRAM",
        Feature::LiteralAddresses => {
            "PROGRAM P VAR p : POINTER TO BYTE; b : BYTE; END_VAR p := ADR('text'); b := p^; END_PROGRAM"
        }
        other => use_of_each_kind(other),
    }
}

/// And of tasks, timers, pointers and literals.
fn use_of_each_kind(feature: Feature) -> &'static str {
    match feature {
        Feature::FreeTasks => {
            "PROGRAM P END_PROGRAM
             CONFIGURATION C TASK T (PRIORITY := 1); PROGRAM P1 WITH T : P; END_CONFIGURATION"
        }
        Feature::GlobalConfigurations => {
            "PROGRAM P VAR_EXTERNAL n : INT; END_VAR n := 1; END_PROGRAM
             CONFIGURATION Addresses VAR_GLOBAL n : INT; END_VAR END_CONFIGURATION
             CONFIGURATION C TASK T (INTERVAL := T#10ms, PRIORITY := 1); PROGRAM P1 WITH T : P; END_CONFIGURATION"
        }
        Feature::PointersInOut => {
            "FUNCTION F : BOOL VAR_IN_OUT p : POINTER TO BYTE; END_VAR p := 0; F := TRUE; END_FUNCTION
             PROGRAM P VAR q : POINTER TO WORD; b : BOOL; END_VAR b := F(p := q); END_PROGRAM"
        }
        Feature::OpenInputsHandedOn => {
            "FUNCTION G : INT VAR_IN_OUT a : ARRAY [*] OF INT; END_VAR a[1] := 7; G := 1; END_FUNCTION
             FUNCTION F : INT VAR_INPUT a : ARRAY [*] OF INT; END_VAR F := G(a := a); END_FUNCTION
             PROGRAM P VAR x : ARRAY [1..2] OF INT; n : INT; END_VAR n := F(a := x); END_PROGRAM"
        }
        Feature::ImplicitInit => {
            "FUNCTION_BLOCK F VAR n : INT; END_VAR n := n + 1; END_FUNCTION_BLOCK
             PROGRAM P VAR f1 : F; END_VAR f1(); f1.FB_init(FALSE, FALSE); END_PROGRAM"
        }
        Feature::LongTimers => {
            "PROGRAM P VAR t : TON; l : LTIME; b : BOOL; END_VAR t(IN := TRUE, PT := l); b := t.Q; END_PROGRAM"
        }
        Feature::WideStarts => {
            "PROGRAM P VAR i, n : INT; d : DINT; END_VAR FOR i := d TO 3 DO n := n + 1; END_FOR; END_PROGRAM"
        }
        Feature::SpacedValues => {
            "TYPE C : (Red, Green); END_TYPE PROGRAM P VAR c1 : C; END_VAR c1 := C# Green; END_PROGRAM"
        }
        Feature::NarrowQuotes => "PROGRAM P VAR w : WSTRING; END_VAR w := WSTRING#'a'; END_PROGRAM",
        other => panic!("{other:?} has no program"),
    }
}

#[test]
fn every_construct_is_for_its_dialects_alone() {
    for feature in Feature::ALL {
        for dialect in Dialect::ALL {
            let findings = findings_in(dialect, use_of(*feature));
            let errors: Vec<_> = findings.iter().filter(|found| found.severity == Severity::Error).collect();
            if dialect.has(*feature) {
                assert!(errors.is_empty(), "{feature:?} in {dialect}: {findings}");
            } else {
                assert!(!errors.is_empty(), "{feature:?} passes in {dialect}");
            }
        }
    }
}

/// Constructs whose absence is not a syntax of its own: another error says it.
const REPORTED_OTHERWISE: [Feature; 69] = [
    Feature::FreeTasks,
    Feature::GlobalConfigurations,
    Feature::PointersInOut,
    Feature::OpenInputsHandedOn,
    Feature::ImplicitInit,
    Feature::LongTimers,
    Feature::WideStarts,
    Feature::SpacedValues,
    Feature::NarrowQuotes,
    Feature::TimesBesideNumbers,
    Feature::PositionalOutputs,
    Feature::CharactersSelect,
    Feature::CharactersAsText,
    Feature::BareCalls,
    Feature::Overloads,
    Feature::TimesAsDates,
    Feature::UnusedUnits,
    Feature::ThisPointer,
    Feature::LiteralAddresses,
    Feature::Variants,
    Feature::EmptyLists,
    Feature::BitsInOut,
    Feature::BaseParts,
    Feature::NamedCounts,
    Feature::LoneOutputs,
    Feature::IntegerParts,
    Feature::ProgramInOuts,
    Feature::CCode,
    Feature::NamedValues,
    Feature::LooseParts,
    Feature::OutputsHandedOn,
    Feature::ShiftedLiterals,
    Feature::LooseUnderscores,
    Feature::RepeatedArguments,
    Feature::Recursion,
    Feature::EmptyArrays,
    Feature::AssignedValues,
    Feature::DynamicMemory,
    Feature::AlikeStructures,
    Feature::IntegersAsReals,
    Feature::ValuesByContext,
    Feature::ReadableInOuts,
    Feature::ConditionalReturns,
    Feature::LooseLast,
    Feature::OwnStandardBlocks,
    Feature::LeftOutInputs,
    Feature::LooseStrings,
    Feature::WindowsCharacters,
    Feature::DoubleQuotes,
    Feature::LooseWidths,
    Feature::BitsAsReals,
    Feature::OwnStandardFunctions,
    Feature::InstanceCopies,
    Feature::ReadableInternals,
    Feature::ProgramInstances,
    Feature::VendorParameters,
    Feature::CharactersAsBytes,
    Feature::IntegerShifts,
    Feature::FleetingInstances,
    Feature::LossyReals,
    Feature::EnumerationsAsIntegers,
    Feature::ComputedInitialValues,
    Feature::NestedComments,
    Feature::Continue,
    Feature::LooseEnds,
    Feature::BitArithmetic,
    Feature::SignChange,
    Feature::InstanceInternals,
    Feature::ShortPrefixes,
];

#[test]
fn a_construct_of_others_is_reported_once_with_its_dialects() {
    for feature in Feature::ALL.iter().filter(|feature| !REPORTED_OTHERWISE.contains(feature)) {
        for dialect in Dialect::ALL.into_iter().filter(|dialect| !dialect.has(*feature)) {
            let findings = findings_in(dialect, use_of(*feature));
            let reported: Vec<_> = findings.iter().filter(|found| found.code == Code::WrongDialect).collect();
            assert_eq!(reported.len(), 1, "{feature:?} in {dialect}: {findings}");
            let help = reported[0].help.as_deref().unwrap_or("");
            assert!(help.contains(&feature.homes()), "{help}");
        }
    }
    let twice = "PROGRAM P // a\n// b\nVAR b : BOOL; END_VAR b S= b; b R= b; END_PROGRAM";
    insta::assert_snapshot!(findings_in(Dialect::Iec2, twice), @r"
    test.st:1:11: error[S0110]: a comment with `//` is not part of iec2 (it is part of iec3, codesys, twincat and siemens-scl: --dialect chooses)
    test.st:3:25: error[S0110]: `S=`, `R=` is not part of iec2 (it is part of codesys and twincat: --dialect chooses)
    ");
}

#[test]
fn shifts_of_signed_integers_keep_their_width_and_to_the_right_their_sign() {
    for dialect in [Dialect::Codesys, Dialect::TwinCat, Dialect::SiemensScl] {
        let text = "PROGRAM P
            VAR s : SINT := -100; i : INT := -32767; d : DINT := -8; l : LINT := -4; u : USINT := 200; n : INT := 40; k : INT := -1;
              r1, r2, r3 : SINT; r4, r5 : INT; r6, r7 : DINT; r8, r9 : LINT; r10 : USINT; r11 : INT; END_VAR
            r1 := SHR(s, 2); r2 := SHL(s, 1); r3 := ROL(s, 4); r4 := SHR(i, n); r5 := ROR(i, 1); r6 := SHR(d, 99); r7 := SHR(d, k);
            r8 := SHR(l, 1); r9 := SHR(l, n + 40); r10 := SHR(u, 1); r11 := SHR(INT#100, 3); END_PROGRAM";
        let mut rig = Rig::in_dialect(dialect, text);
        rig.scan().expect("no fault");
        let found: Vec<_> = (1..=11).map(|at| rig.int(&format!("P.r{at}"))).collect();
        assert_eq!(found, [-25, 56, -55, -1, -16384, -1, -1, -2, -1, 100, 12], "{dialect}");
    }
}

#[test]
fn counters_and_bistables_have_their_vendors_names() {
    let text = "PROGRAM P VAR u : CTU; d : CTD; ud : CTUD; s : SR; r : RS; l : CTUD_LINT; t : BOOL := TRUE; END_VAR
        u(CU := t, RESET := FALSE, PV := 2); d(CD := FALSE, LOAD := t, PV := 7); ud(CU := FALSE, CD := FALSE, RESET := FALSE, LOAD := t, PV := 5);
        s(SET1 := t, RESET := t); r(SET := t, RESET1 := t); l.LOAD := TRUE; l(CU := FALSE, CD := FALSE, PV := 9); END_PROGRAM";
    for dialect in [Dialect::Codesys, Dialect::TwinCat] {
        let mut rig = Rig::in_dialect(dialect, text);
        rig.scan().expect("no fault");
        assert_eq!(
            ["u.CV", "d.CV", "ud.CV", "l.CV"].map(|name| rig.int(&format!("P.{name}"))),
            [1, 7, 5, 9],
            "{dialect}"
        );
        assert_eq!((rig.bool("P.s.Q1"), rig.bool("P.r.Q1")), (true, false));
        Rig::in_dialect(
            dialect,
            &text.replace("RESET", "R").replace("LOAD", "LD").replace("SET1", "S1").replace("SET :=", "S :="),
        );
    }
}

#[test]
fn a_control_variable_may_be_a_part_of_another() {
    let text = "TYPE S : STRUCT x : INT; list : ARRAY [0..2] OF DINT; END_STRUCT END_TYPE
        FUNCTION_BLOCK Counting VAR n : INT; END_VAR VAR_OUTPUT turns : INT; END_VAR
        FOR THIS^.n := 1 TO 3 DO turns := turns + 1; END_FOR; END_FUNCTION_BLOCK
        PROGRAM P VAR a : ARRAY [0..2] OF INT; s : S; p : POINTER TO INT; i, n, m, k : INT; c : Counting; END_VAR
        FOR a[i + 1] := 0 TO 3 DO n := n + a[1]; END_FOR;
        FOR s.list[2] := 10 TO 1 BY -3 DO m := m + 1; IF s.list[2] < 5 THEN EXIT; END_IF; END_FOR;
        p := ADR(s.x); FOR p^ := 5 TO 7 DO k := k + s.x; END_FOR; c(); END_PROGRAM";
    for dialect in [Dialect::Codesys, Dialect::TwinCat] {
        let mut rig = Rig::in_dialect(dialect, text);
        rig.scan().expect("no fault");
        let found = ["n", "a[1]", "m", "s.list[2]", "k", "s.x", "c.turns"].map(|name| rig.int(&format!("P.{name}")));
        assert_eq!(found, [6, 4, 3, 4, 18, 8, 3], "{dialect}");
    }
}

#[test]
fn strings_have_the_dialect_s_length() {
    for dialect in Dialect::ALL {
        let rig = Rig::in_dialect(dialect, "PROGRAM P VAR s : STRING; END_VAR s := 'a'; END_PROGRAM");
        assert_eq!(rig.variable("P.s").type_name, format!("STRING[{}]", dialect.string_length()));
    }
}

#[test]
fn time_wraps_where_the_dialect_counts_milliseconds() {
    for dialect in Dialect::ALL {
        let text = "PROGRAM P
            VAR a, b, c, d : TIME; n : DINT := -1; day : TIME := T#20d; END_VAR
            a := T#0s - T#1ms; b := (T#10ms / 4) * 2; c := DINT_TO_TIME(n); d := day + day + day;
            END_PROGRAM";
        let mut rig = Rig::in_dialect(dialect, text);
        rig.scan().expect("no fault");
        let (ms, days) = (1_000_000, 86_400_000_000_000);
        let wrapped = (1_i64 << 32) * ms;
        let expected = match dialect.time() {
            TimeRange::Nanoseconds64 if dialect == Dialect::Matiec => [-ms, 5 * ms, -1_000 * ms, 60 * days],
            TimeRange::Nanoseconds64 => [-ms, 5 * ms, -ms, 60 * days],
            TimeRange::Unsigned32 => [wrapped - ms, 4 * ms, wrapped - ms, 60 * days - wrapped],
            TimeRange::Signed32 => [-ms, 4 * ms, -ms, 60 * days - wrapped],
        };
        assert_eq!(["P.a", "P.b", "P.c", "P.d"].map(|path| rig.int(path)), expected, "{dialect}");
    }
    let beyond = "PROGRAM P VAR t : TIME; END_VAR t := T#25d; t := T#50d; t := T#1.5ms; t := T#1us; END_PROGRAM";
    insta::assert_snapshot!(findings_in(Dialect::SiemensScl, beyond), @r"
    test.st:1:38: error[T0202]: TIME of siemens-scl counts milliseconds in signed 32 bits (LTIME counts nanoseconds)
    test.st:1:50: error[T0202]: TIME of siemens-scl counts milliseconds in signed 32 bits (LTIME counts nanoseconds)
    test.st:1:62: error[T0202]: TIME of siemens-scl counts milliseconds in signed 32 bits (LTIME counts nanoseconds)
    test.st:1:76: error[T0202]: TIME of siemens-scl counts milliseconds in signed 32 bits (LTIME counts nanoseconds)
    ");
    insta::assert_snapshot!(findings_in(Dialect::TwinCat, beyond), @r"
    test.st:1:50: error[T0202]: TIME of twincat counts milliseconds in unsigned 32 bits (LTIME counts nanoseconds)
    test.st:1:62: error[T0202]: TIME of twincat counts milliseconds in unsigned 32 bits (LTIME counts nanoseconds)
    test.st:1:76: error[T0202]: TIME of twincat counts milliseconds in unsigned 32 bits (LTIME counts nanoseconds)
    ");
    assert!(!findings_in(Dialect::Iec3, beyond).has_errors());
}

#[test]
fn reals_halfway_go_where_the_dialect_says() {
    for dialect in Dialect::ALL {
        let text = "PROGRAM P VAR
            x : ARRAY [0..7] OF REAL := [0.5, 1.5, 2.5, -0.5, -2.5, 0.49999997, 8388609.0, -7.4]; i : INT;
            y : ARRAY [0..7] OF DINT;
            END_VAR
            VAR CONSTANT k : DINT := REAL_TO_DINT(2.5); END_VAR
            FOR i := 0 TO 7 DO y[i] := REAL_TO_DINT(x[i]); END_FOR; i := DINT_TO_INT(k);
            END_PROGRAM";
        let mut rig = Rig::in_dialect(dialect, text);
        rig.scan().expect("no fault");
        let even = dialect != Dialect::TwinCat;
        let expected = if even { [0, 2, 2, 0, -2, 0, 8_388_609, -7] } else { [1, 2, 3, -1, -3, 0, 8_388_609, -7] };
        let found: Vec<_> = (0..8).map(|index| rig.int(&format!("P.y[{index}]"))).collect();
        assert_eq!(found, expected, "{dialect}");
        assert_eq!(rig.int("P.i"), if even { 2 } else { 3 });
    }
    assert_ne!(Ties::Even, Ties::Away);
}

#[test]
fn division_by_zero_goes_on_where_the_dialect_does() {
    let programs = [
        "PROGRAM P VAR a : INT := 7; z : INT; r : INT; END_VAR r := a / z; END_PROGRAM",
        "PROGRAM P VAR a : ULINT := 7; z : ULINT; r : ULINT; END_VAR r := a / z; END_PROGRAM",
        "PROGRAM P VAR a : REAL := 7.0; z : REAL; r : REAL; END_VAR r := a / z; END_PROGRAM",
        "PROGRAM P VAR a : TIME := T#7s; z : INT; r : TIME; END_VAR r := a / z; END_PROGRAM",
    ];
    for dialect in Dialect::ALL {
        for program in programs {
            let mut rig = Rig::in_dialect(dialect, program);
            let scanned = rig.scan();
            if dialect.division_by_zero() == DivisionByZero::Fault {
                assert_eq!(scanned.expect_err("a fault").kind, FaultKind::DivisionByZero, "{dialect}: {program}");
            } else {
                scanned.expect("no fault");
                let real = program.contains("REAL");
                assert!(if real { rig.real("P.r") == f64::INFINITY } else { rig.int("P.r") == 0 }, "{program}");
            }
        }
    }
    let mut rig = Rig::in_dialect(
        Dialect::SiemensScl,
        "PROGRAM P VAR a : INT := -32768; z : INT := -1; r, s : INT; END_VAR r := a / z; s := a / 2; END_PROGRAM",
    );
    rig.scan().expect("no fault");
    assert_eq!((rig.int("P.r"), rig.int("P.s")), (-32768, -16384));
}

#[test]
fn direct_addresses_count_what_the_dialect_counts() {
    let text = "PROGRAM P VAR a AT %MB2 : BYTE; b AT %MW1 : WORD; END_VAR b := 16#1234; END_PROGRAM";
    for dialect in Dialect::ALL {
        let mut rig = Rig::in_dialect(dialect, text);
        rig.scan().expect("no fault");
        // Word 1 begins at byte 2, or at byte 1.
        let bytes = matches!(dialect, Dialect::TwinCat | Dialect::SiemensScl);
        assert_eq!(rig.int("P.a"), if bytes { 0x12 } else { 0x34 }, "{dialect}");
    }
}

#[test]
fn a_library_keeps_its_dialect_in_a_program_of_another() {
    use onescan_iec::input::kind::SourceKind;
    use onescan_iec::{Input, TimeSpan};
    use onescan_iec_run::Application;
    let library = "FUNCTION half : DINT VAR_INPUT x : REAL; END_VAR half := REAL_TO_DINT(x); END_FUNCTION";
    let program = "PROGRAM P VAR a, b : DINT; x : REAL := 2.5; END_VAR a := half(x); b := REAL_TO_DINT(x); END_PROGRAM";
    let library = Input::from_text("lib.st", SourceKind::Text, library).in_dialect(Dialect::TwinCat);
    let program = Input::from_text("main.st", SourceKind::Text, program);
    let application = Application::from_inputs([library, program]).expect("it compiles");
    let mut rig = Rig::with_plan(&application, &application.single_task(TimeSpan::millis::<10>()));
    rig.scan().expect("no fault");
    assert_eq!((rig.int("P.a"), rig.int("P.b")), (3, 2));
}

#[test]
fn short_circuits_evaluate_what_they_need() {
    let text = "FUNCTION asked : BOOL VAR_INPUT v : BOOL; END_VAR VAR_IN_OUT n : INT; END_VAR
          n := n + 1; asked := v; END_FUNCTION
        PROGRAM P VAR n : INT; a, b, c, d : BOOL; i : INT := 9; list : ARRAY [0..3] OF INT; END_VAR
          a := FALSE AND_THEN asked(TRUE, n);
          b := TRUE OR_ELSE asked(FALSE, n);
          c := asked(TRUE, n) AND_THEN asked(FALSE, n) OR_ELSE asked(TRUE, n);
          d := i <= 3 AND_THEN list[i] = 0;
        END_PROGRAM";
    let mut rig = Rig::in_dialect(Dialect::Codesys, text);
    rig.scan().expect("the index out of range is never evaluated");
    assert_eq!(["P.a", "P.b", "P.c", "P.d"].map(|path| rig.bool(path)), [false, true, true, false]);
    assert_eq!(rig.int("P.n"), 3);
}

#[test]
fn assignments_of_vendors() {
    let text = "PROGRAM P VAR a, b : INT; c : DINT; s, r : BOOL; on : BOOL := TRUE; n : INT; END_VAR
          c := a := b := 5;
          s S= on; s S= FALSE; r := TRUE; r R= on; r S= NOT on;
        END_PROGRAM";
    let mut rig = Rig::in_dialect(Dialect::TwinCat, text);
    rig.scan().expect("no fault");
    assert_eq!(["P.a", "P.b", "P.c"].map(|path| rig.int(path)), [5, 5, 5]);
    assert_eq!(["P.s", "P.r"].map(|path| rig.bool(path)), [true, false]);
    let text = "PROGRAM P VAR a : Int := 5; x : Array[0..2] of Real := [1.0, 2.0, 3.0]; i : Int := 1; END_VAR
          #a += 3; #a -= 1; #a *= 4; #a /= 3; #x[#i] *= 2.5;
        END_PROGRAM";
    let mut rig = Rig::in_dialect(Dialect::SiemensScl, text);
    rig.scan().expect("no fault");
    assert_eq!((rig.int("P.a"), rig.real("P.x[1]")), (9, 5.0));
}

#[test]
fn conditional_pragmas_choose_text() {
    let text = "{define one}
        PROGRAM P VAR a, b, c, d : INT; END_VAR
        {IF defined (one)} a := 1; {ELSE} a := 2; {END_IF}
        {IF NOT defined (one)} b := 1; {ELSIF defined (two) OR (defined (one) AND NOT defined (two))} b := 2; {ELSE} b := 3; {END_IF}
        {IF defined (two)} c := ; {IF defined (one)} c := 1; {END_IF} {ELSE} c := 4; {END_IF}
        {undefine one} {IF defined (one)} d := 1; {END_IF}
        END_PROGRAM";
    let mut rig = Rig::in_dialect(Dialect::Codesys, text);
    rig.scan().expect("no fault");
    assert_eq!(["P.a", "P.b", "P.c", "P.d"].map(|path| rig.int(path)), [1, 2, 4, 0]);
}

#[test]
fn static_variables_are_one_for_all_instances() {
    let text = "FUNCTION_BLOCK F VAR_STAT n : INT := 10; END_VAR VAR_OUTPUT q : INT; END_VAR n := n + 1; q := n; END_FUNCTION_BLOCK
        FUNCTION g : INT VAR_STAT n : INT; END_VAR n := n + 1; g := n; END_FUNCTION
        PROGRAM P VAR a, b : F; x : INT; END_VAR a(); b(); x := g() + g(); END_PROGRAM";
    let mut rig = Rig::in_dialect(Dialect::Codesys, text);
    rig.scan().expect("no fault");
    assert_eq!(["P.a.q", "P.b.q", "P.x"].map(|path| rig.int(path)), [11, 12, 3]);
    rig.scan().expect("no fault");
    assert_eq!(["P.a.q", "P.b.q", "P.x"].map(|path| rig.int(path)), [13, 14, 7]);
}

#[test]
fn bit_strings_calculate_as_unsigned_numbers() {
    let text = "PROGRAM P VAR b : BYTE := 250; w : WORD := 16#FFFF; i : INT; d : DWORD; n : INT := 6; m : BOOL; END_VAR
          b := b + 10; i := b; w := w / 2; d := w * DWORD#2; n := n AND 3; m := b > 3 AND w < 16#8000;
        END_PROGRAM";
    let mut rig = Rig::in_dialect(Dialect::Codesys, text);
    rig.scan().expect("no fault");
    assert_eq!(["P.b", "P.i", "P.w", "P.d", "P.n", "P.m"].map(|path| rig.int(path)), [4, 4, 32767, 65534, 2, 1]);
}

#[test]
fn the_clock_is_virtual_time() {
    let text = "PROGRAM P VAR t : TIME; l : LTIME; END_VAR t := TIME(); l := LTIME(); END_PROGRAM";
    let mut rig = Rig::in_dialect(Dialect::Codesys, text);
    rig.scan().expect("no fault");
    assert_eq!((rig.int("P.t"), rig.int("P.l")), (10_000_000, 10_000_000));
    // 32 bits of milliseconds restart after 49.7 days.
    rig.now_ns = (1_u64 << 32) * 1_000_000;
    rig.scan().expect("no fault");
    assert_eq!(rig.int("P.t"), 10_000_000);
}

#[test]
fn enumerations_are_integers_where_the_dialect_says() {
    let mut rig = Rig::in_dialect(
        Dialect::Codesys,
        "TYPE State : (Idle, Run := 10, Stop); END_TYPE
PROGRAM P VAR s : State; i, x, y, z : INT; a : ARRAY [0..12] OF INT; b : BOOL; END_VAR
  i := Run; s := i + 1; x := 2 * s - Run; a[Stop] := 5; y := a[s]; b := s = 11 AND s > Run AND s <> Idle;
  CASE s OF 10: z := 1; Stop: z := 2; END_CASE;
  s := 10;
END_PROGRAM",
    );
    rig.scan().expect("no fault");
    assert_eq!(["i", "x", "y", "z", "b", "s"].map(|name| rig.int(&format!("P.{name}"))), [10, 12, 5, 2, 1, 10]);
}

#[test]
fn vendors_functions_take_what_vendors_give() {
    let mut rig = Rig::in_dialect(
        Dialect::Codesys,
        "PROGRAM P VAR u : UINT := 16#8001; b : BYTE := 3; a : ARRAY [0..4] OF INT := [1, 2, 3, 4, 5]; n, m, k : INT; left : UINT;
  w : WORD := 1000; r, q : REAL; d : DWORD; f : WORD; text : STRING; END_VAR
  left := SHL(u, b); n := a[b]; m := LEN(STR := CONCAT(STR1 := 'ab', STR2 := 'cde'));
  text := MID(STR := 'abcdef', LEN := 2, POS := 3); k := FIND(STR1 := 'abc', STR2 := 'c');
  r := WORD_TO_REAL(w); d := REAL_TO_DWORD(2.6); q := DWORD_TO_REAL(d); f := REAL_TO_WORD(7.2);
END_PROGRAM",
    );
    rig.scan().expect("no fault");
    assert_eq!(["left", "n", "m", "k", "d", "f"].map(|name| rig.int(&format!("P.{name}"))), [8, 4, 5, 3, 3, 7]);
    assert_eq!(["P.r", "P.q", "P.text"].map(|path| rig.plc.read(path).expect("it exists")), ["1000.0", "3.0", "'cd'"]);
}

#[test]
fn durations_dates_and_times_of_day_come_of_one_another() {
    let text = "PROGRAM P VAR t : TIME := T#1d2h3m4s500ms; day : DATE := D#1970-01-03; a, e, h : DT; b, f : DATE; c : TOD; d : TIME; i : TOD; x, y : BOOL; END_VAR
        a := TIME_TO_DT(t); b := TIME_TO_DATE(t); c := DATE_TO_TOD(day); d := DATE_TO_TIME(day); e := TOD_TO_DT(TOD#01:02:03.400);
        f := BOOL_TO_DATE(t > T#0s); h := TO_DT(TRUE); i := BOOL_TO_TOD(TRUE); x := DT_TO_BOOL(a); y := TOD_TO_BOOL(c); END_PROGRAM";
    for dialect in [Dialect::Codesys, Dialect::TwinCat] {
        let mut rig = Rig::in_dialect(dialect, text);
        rig.scan().expect("no fault");
        let seconds = ["a", "b", "e", "f", "h"].map(|name| rig.int(&format!("P.{name}")) / 1_000_000_000);
        assert_eq!(seconds, [93_784, 86_400, 3_723, 0, 1], "{dialect}");
        let ms = ["c", "d", "i"].map(|name| rig.int(&format!("P.{name}")) / 1_000_000);
        assert_eq!(ms, [0, 172_800_000, 1], "{dialect}");
        assert_eq!((rig.bool("P.x"), rig.bool("P.y")), (true, false), "{dialect}");
    }
}

#[test]
fn codesys_2_3_has_inner_arrays_in_one_row_and_an_empty_var_config() {
    let text = "VAR_CONFIG END_VAR
        PROGRAM P VAR a : ARRAY [1..3] OF ARRAY [1..2] OF SINT := -1, -2, 2(-3), -5; b : ARRAY [0..1] OF ARRAY [0..1] OF INT := [1, 2], [3, 4]; END_VAR
        ; END_PROGRAM";
    let mut rig = Rig::in_dialect(Dialect::Codesys, text);
    rig.scan().expect("no fault");
    let row =
        ["a[1][1]", "a[1][2]", "a[2][1]", "a[2][2]", "a[3][1]", "a[3][2]"].map(|name| rig.int(&format!("P.{name}")));
    assert_eq!((row, rig.int("P.b[1][0]")), ([-1, -2, -3, -3, -5, 0], 3));
    let found = findings_in(
        Dialect::Codesys,
        "VAR_CONFIG P.x AT %IX0.0 : BOOL; END_VAR PROGRAM P VAR x : BOOL; END_VAR x := x; END_PROGRAM",
    );
    insta::assert_snapshot!(found, @"test.st:1:1: error[L0501]: VAR_CONFIG outside of a CONFIGURATION is not supported yet");
}
