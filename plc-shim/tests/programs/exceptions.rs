//! `__TRY` of CODESYS and TwinCAT: which faults end its statements, what is as it was then, and where the rest goes on.

use onescan_iec::Dialect::{self, Codesys, TwinCat};
use onescan_iec_run::FaultKind;

use crate::rig::{Rig, findings_in};

const VENDORS: [Dialect; 2] = [Codesys, TwinCat];

/// What `P.r` is after one scan, and what it is after a second.
fn gives(text: &str, expected: [i64; 2]) {
    for dialect in VENDORS {
        let mut rig = Rig::in_dialect(dialect, text);
        let found = [0, 1].map(|_| {
            rig.scan().unwrap_or_else(|fault| panic!("{fault}: {text}"));
            rig.int("P.r")
        });
        assert_eq!(found, expected, "{dialect}: {text}");
    }
}

#[test]
fn a_fault_leads_to_the_handler_with_all_before_it_done() {
    gives(
        "PROGRAM P VAR e : __SYSTEM.ExceptionCode; a, r, zero : DINT; END_VAR
           a := 1;
           __TRY a := a + 10; r := 100 / zero; a := a + 1000;
           __CATCH(e) a := a + 100;
             IF e = __SYSTEM.ExceptionCode.RTSEXCPT_DIVIDEBYZERO THEN a := a * 2; END_IF
           __FINALLY r := a; __ENDTRY
           zero := 1; END_PROGRAM",
        [222, 1011],
    );
    // Without a handler the rest goes on.
    gives(
        "PROGRAM P VAR r, zero : DINT; END_VAR __TRY r := 7; r := r / zero; __ENDTRY r := r + 1; END_PROGRAM",
        [8, 8],
    );
}

#[test]
fn each_kind_has_its_code() {
    let of = |declared: &str, statement: &str| {
        let text = format!(
            "{declared} VAR e : UDINT; r : DINT; n : DINT := 9; x, nought : LREAL; a : ARRAY [1..4] OF DINT; p : POINTER TO DINT;
               q : REFERENCE TO DINT; m : INT := 7; END_VAR
             __TRY {statement} r := 1; __CATCH(e) r := UDINT_TO_DINT(e); __ENDTRY END_PROGRAM"
        );
        let mut rig = Rig::in_dialect(TwinCat, &text);
        rig.scan().map(|()| rig.int("P.r")).map_err(|fault| fault.kind)
    };
    let code = |statement| of("PROGRAM P", statement);
    assert_eq!(code("n := n / 0 + n MOD 1;"), Ok(0x102));
    assert_eq!(code("x := 1.0 / nought;"), Ok(0x102));
    assert_eq!(code("a[n] := 3;"), Ok(0x101));
    assert_eq!(code("n := MUX(n, 1, 2);"), Ok(0x101));
    assert_eq!(code("q := 4;"), Ok(0x51));
    assert_eq!(code("p := ADR(n) + 16#7000_0000; p^ := 4;"), Ok(0x51));
    assert_eq!(code("WHILE TRUE DO n := n + 1; END_WHILE"), Err(FaultKind::EndlessLoop));
    assert_eq!(code("FOR n := 1 TO 5 BY m - 7 DO ; END_FOR"), Err(FaultKind::ZeroStep));
}

#[test]
fn faults_of_what_is_called_are_caught_and_it_may_be_called_again() {
    // Both call themselves, so a flag or a count says that they run: the fault must not leave it set.
    gives(
        "FUNCTION_BLOCK B VAR kept : DINT; END_VAR
           METHOD Ratio : DINT VAR_INPUT n, d : DINT; END_VAR VAR own : ARRAY [0..1] OF DINT; END_VAR
             kept := kept + 1; own[0] := n;
             IF n > 100 THEN Ratio := Ratio(n - 100, d); RETURN; END_IF
             Ratio := own[0] / d; END_METHOD
         END_FUNCTION_BLOCK
         FUNCTION Deep : DINT VAR_INPUT n : DINT; END_VAR
           IF n > 0 THEN Deep := Deep(n - 1); ELSE Deep := 1 / n; END_IF END_FUNCTION
         PROGRAM P VAR b1 : B; i, r : DINT; END_VAR
           r := 0;
           FOR i := 1 TO 300 DO
             __TRY r := r + Deep(20); __CATCH r := r + 1; __ENDTRY
             __TRY r := r + b1.Ratio(50, 0); __CATCH r := r + 1; __ENDTRY
           END_FOR
           r := r * 1000 + b1.Ratio(90, 10) + b1.kept; END_PROGRAM",
        [600_310, 600_611],
    );
}

#[test]
fn variables_of_functions_are_as_they_were_at_the_fault() {
    gives(
        "FUNCTION F : LREAL VAR_INPUT n : DINT; x : LREAL; END_VAR VAR_IN_OUT shared : DINT; END_VAR
           VAR i : DINT; y : REAL; big : LINT; done : BOOL; END_VAR
           F := 1.5; big := 16#1_0000_0000;
           __TRY
             FOR i := 3 TO -3 BY -1 DO
               shared := shared + 1; y := y + 0.5; big := big + 1; F := F + x; done := i = 1;
               n := n + 12 / i;
             END_FOR
           __CATCH
             IF done THEN shared := -1; END_IF
           __ENDTRY
           F := F + n + y + DINT_TO_LREAL(shared) + LINT_TO_LREAL(big - 16#1_0000_0000) * 1000; END_FUNCTION
         PROGRAM P VAR s : DINT := 10; r : DINT; END_VAR r := LREAL_TO_DINT(F(100, 0.25, s) * 10); END_PROGRAM",
        [41_405, 41_445],
    );
}

#[test]
fn return_exit_and_continue_lead_by_way_of_finally() {
    gives(
        "FUNCTION_BLOCK F VAR_INPUT n, off : DINT; END_VAR VAR_OUTPUT r : DINT; END_VAR VAR i : DINT; END_VAR
           r := 0;
           FOR i := 1 TO 6 DO
             __TRY
               IF i = 2 THEN CONTINUE; END_IF
               IF i = n THEN EXIT; END_IF
               IF i = 5 THEN RETURN; END_IF
               r := r + 10 / (i - off);
             __CATCH
               IF i = 4 THEN RETURN; END_IF
               IF i = 3 THEN EXIT; END_IF
               CONTINUE;
             __FINALLY
               r := r + 1000;
             __ENDTRY
             r := r + 100;
           END_FOR
           r := -r;
         END_FUNCTION_BLOCK
         PROGRAM P VAR f1, f2, f3, f4, f5 : F; r : LINT; END_VAR
           f1(n := 3, off := 0); f2(n := 0, off := 0); f3(n := 0, off := 1); f4(n := 0, off := 3); f5(n := 0, off := 4);
           r := f1.r * 100_000_000 + f2.r * 10_000 + f3.r * 3 + f4.r + f5.r; END_PROGRAM",
        {
            let f1 = -(10 + 100 + 3 * 1000);
            let f2 = 10 + 3 + 2 + 300 + 5 * 1000;
            let f3 = 10 / 2 + 10 / 3 + 2 * 100 + 5 * 1000;
            let f4 = -(-5 + 100 + 3 * 1000);
            let f5 = -3 - 10 + 200 + 4 * 1000;
            [f1 * 100_000_000 + f2 * 10_000 + f3 * 3 + f4 + f5; 2]
        },
    );
}

#[test]
fn a_fault_of_a_handler_leads_to_the_next_one_outside() {
    gives(
        "PROGRAM P VAR r, zero : DINT; END_VAR
           r := 1;
           __TRY
             __TRY r := r * 10 / zero; __CATCH r := r + 1; r := r / zero; __FINALLY r := r + 5000; __ENDTRY
             r := r + 9000;
           __CATCH r := r + 100; __ENDTRY END_PROGRAM",
        [102, 102],
    );
    let text =
        "PROGRAM P VAR r, zero : DINT; END_VAR\n__TRY r := 1 / zero;\n__CATCH r := 2 / zero;\n__ENDTRY END_PROGRAM";
    let fault = Rig::in_dialect(Codesys, text).scan().expect_err("nobody catches the second");
    assert_eq!((fault.kind, fault.at.line), (FaultKind::DivisionByZero, 3));
}

/// A fault in statements that are tried, of a kind that stops the PLC, has its place and the way to it.
#[test]
fn what_is_not_caught_is_reported_as_anywhere_else() {
    let text = "FUNCTION_BLOCK F\nVAR n : INT; END_VAR\n  __TRY\n    WHILE n >= 0 DO n := 1; END_WHILE\n  __CATCH n := 5;\n  __ENDTRY
END_FUNCTION_BLOCK\nPROGRAM P\nVAR f1 : F; END_VAR\n  f1();\nEND_PROGRAM";
    let fault = Rig::in_dialect(TwinCat, text).scan().expect_err("endless");
    insta::assert_snapshot!(fault.to_string(), @"endless or very long loop at test.st:4:5 in P.f1 (F), called by P at test.st:10, t_v = 0.010 s");
}

/// Each of these loops is short, and all of them together use the task's instructions up.
#[test]
fn what_is_tried_again_and_again_pays_for_its_loops() {
    let text = "PROGRAM P VAR i, n, zero : DINT; END_VAR
        WHILE TRUE DO __TRY FOR i := 1 TO 100_000 DO n := n + i MOD 7; IF i = 99_999 THEN n := n / zero; END_IF END_FOR
          __CATCH n := 0; __ENDTRY END_WHILE END_PROGRAM";
    let fault = Rig::in_dialect(TwinCat, text).scan().expect_err("endless");
    assert_eq!(fault.kind, FaultKind::EndlessLoop);
}

#[test]
fn mistakes_are_reported() {
    let wrong = |text: &str| findings_in(TwinCat, text).to_string();
    insta::assert_snapshot!(
        wrong("PROGRAM P VAR r : DINT; END_VAR __TRY r := 1; __CATCH(x) r := 2; END_PROGRAM"), @r"
        test.st:1:55: error[N0101]: `x` is not declared
        test.st:1:66: error[S0101]: `__ENDTRY` expected, found `END_PROGRAM`
        ");
    insta::assert_snapshot!(
        wrong("PROGRAM P VAR r : DINT; e : INT; END_VAR __TRY r := 1; __CATCH(e) EXIT; __ENDTRY END_PROGRAM"), @r"
        test.st:1:64: error[T0201]: `__CATCH` gives a code of `__SYSTEM.ExceptionCode`, this is INT
        test.st:1:67: error[D0409]: EXIT outside of a loop
        ");
    insta::assert_snapshot!(
        wrong("PROGRAM P VAR r : DINT; END_VAR __TRY JMP done; __ENDTRY done: r := 1; END_PROGRAM"),
        @"test.st:1:43: error[G1101]: there is no label `done` that this jump could lead to (no jump leads out of a part of `__TRY`; RETURN, EXIT and CONTINUE do)");
    let inside = "PROGRAM P VAR r, i : DINT; END_VAR __TRY again: i := i + 1; IF i < 5 THEN JMP again; END_IF r := i; __ENDTRY END_PROGRAM";
    gives(inside, [5, 6]);
}

#[test]
fn a_project_has_it_in_methods_and_properties() {
    let text = "FUNCTION_BLOCK F VAR zero : DINT; END_VAR
        PROPERTY Ratio : DINT GET __TRY Ratio := 5; Ratio := Ratio / zero; __CATCH Ratio := Ratio + 2; __ENDTRY END_GET END_PROPERTY
        METHOD FB_init : BOOL VAR_INPUT bInitRetains, bInCopyCode : BOOL; END_VAR
          __TRY zero := 1 / zero; __CATCH zero := 0; __ENDTRY END_METHOD
        ACTION Act: __TRY zero := 1 / zero; __CATCH zero := zero + 1; __ENDTRY END_ACTION
      END_FUNCTION_BLOCK
      PROGRAM P VAR f1 : F; r : DINT; END_VAR r := f1.Ratio; f1.Act(); END_PROGRAM";
    gives(text, [7, 5]);
}
