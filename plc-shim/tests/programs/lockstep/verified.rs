//! `instrument` checks what it wrote.

use onescan_iec::Input;
use onescan_iec::dialect::Dialect;
use onescan_iec::input::kind::SourceKind;
use onescan_iec_project::instrument::{InstrumentError, Options, instrument, remove};

fn instrumented(text: &str) -> Result<(), InstrumentError> {
    instrument(&[Input::from_text("p.st", SourceKind::Text, text)], &Options::default()).map(|_| ())
}

#[test]
fn statements_that_move_into_an_action_see_what_lies_at_addresses() {
    let text = "PROGRAM P VAR A0 AT %IW100 : UINT; q AT %QX0.0 : BOOL; t : TON; n : UINT; END_VAR
        IF A0 > 5 THEN RETURN; END_IF; t(IN := A0 > 3, PT := T#1s); q := t.Q; n := A0; END_PROGRAM";
    instrumented(text).expect("what is emitted checks");
}

#[test]
fn a_name_that_the_shim_declares_is_an_error_and_nothing_is_given() {
    let text = "VAR_GLOBAL SDSP_Grant : STRING; END_VAR PROGRAM P VAR t : TON; END_VAR t(IN := TRUE, PT := T#1s); SDSP_Grant := 'x'; END_PROGRAM";
    let refused = instrumented(text).expect_err("it cannot work");
    assert!(matches!(&refused, InstrumentError::Emitted(_) | InstrumentError::Text(_)), "{refused}");
}

#[test]
fn an_action_sees_what_lies_at_a_hierarchical_address() {
    let text = "PROGRAM P VAR level AT %IW0.1 : UINT; high AT %QX0.0 : BOOL; t : TON; END_VAR
        IF level > 5 THEN RETURN; END_IF; t(IN := level > 3, PT := T#1s); high := t.Q; END_PROGRAM";
    instrumented(text).expect("what is emitted checks");
}

/// 3rd ed. Table 46: TON is overloaded for TIME and LTIME, and the shim's is not.
#[test]
fn an_ltime_for_a_timer_is_converted_and_comes_back() {
    let text = "PROGRAM P\nVAR t : TON; u : TP; pause : LTIME := LT#2s; END_VAR\nVAR CONSTANT LONG : LTIME := LTIME#1s; END_VAR
t(IN := TRUE, PT := LONG);\nt(PT := T#1s);\nu(IN := t.Q,\n    PT := pause\n);\nu(PT := LT#3s * 2);\nEND_PROGRAM\n";
    let input = || Input::from_text("p.st", SourceKind::Text, text).in_dialect(Dialect::Iec3);
    let project = instrument(&[input()], &Options::default()).expect("what is emitted checks");
    let emitted = project.files[0].text.clone().expect("the file stays");
    assert_eq!(emitted.matches("LTIME_TO_TIME(").count(), 3, "{emitted}");
    let again = Input::from_text("p.st", SourceKind::Text, emitted).in_dialect(Dialect::Iec3);
    let back = remove(&[again]).expect("the marks are whole");
    assert_eq!(back.files[0].text.as_deref(), Some(text));
}

#[test]
fn a_library_whose_task_names_a_program_of_its_users_has_nothing_to_instrument() {
    let text = "FUNCTION_BLOCK Pump END_FUNCTION_BLOCK
        CONFIGURATION C RESOURCE R ON PLC TASK T(INTERVAL := T#10ms, PRIORITY := 1); PROGRAM Main WITH T : Main; END_RESOURCE END_CONFIGURATION";
    let refused = instrumented(text).expect_err("there is no program");
    assert!(matches!(refused, InstrumentError::NoPrograms), "{refused}");
}
