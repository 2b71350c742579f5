//! `instrument` checks what it wrote.

use onescan_iec::Input;
use onescan_iec::input::kind::SourceKind;
use onescan_iec_project::instrument::{InstrumentError, Options, instrument};

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
