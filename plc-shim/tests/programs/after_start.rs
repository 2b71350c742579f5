//! Methods that run once all variables have their first values: `{attribute 'call_after_init'}` (CODESYS, TwinCAT).

use onescan_iec::Dialect;

use crate::rig::{Rig, findings_in};

fn rig(text: &str) -> Rig {
    Rig::in_dialect(Dialect::TwinCat, text)
}

/// Notes who runs, as digits in their order.
const NOTE: &str = "VAR_GLOBAL trail : LINT; END_VAR
FUNCTION Note : BOOL
VAR_INPUT n : LINT; END_VAR
  trail := trail * 10 + n; Note := TRUE;
END_FUNCTION
{attribute 'call_after_init'}
FUNCTION_BLOCK Base
VAR own : LINT; seen : LINT; END_VAR
METHOD FB_init : BOOL
VAR_INPUT bInitRetains, bInCopyCode : BOOL; n : LINT; END_VAR
  own := n; Note(n);
END_METHOD
{attribute 'call_after_init'}
METHOD Settle
  seen := Others; Note(own + 5);
END_METHOD
END_FUNCTION_BLOCK
";

#[test]
fn it_runs_once_behind_every_first_value() {
    let mut rig = rig(&format!(
        "{NOTE}PROGRAM P VAR a : Base(1); END_VAR END_PROGRAM
VAR_GLOBAL early : Base(2); Others : LINT := early.own * 21; END_VAR"
    ));
    assert_eq!(rig.int("trail"), 2176, "FB_init of both, then the method of both");
    assert_eq!((rig.int("P.a.seen"), rig.int("early.seen")), (42, 42), "also what is declared behind it");
    rig.scan().expect("no fault");
    assert_eq!(rig.int("trail"), 2176, "not in a scan");
}

#[test]
fn a_derived_block_has_its_own_method_and_members_come_first() {
    let rig = rig(&format!(
        "{NOTE}VAR_GLOBAL Others : LINT; END_VAR
FUNCTION_BLOCK Derived EXTENDS Base
VAR inner : ARRAY [0..1] OF Base[(1), (2)]; END_VAR
METHOD Settle
  Note(9);
END_METHOD
END_FUNCTION_BLOCK
PROGRAM P VAR d : Derived(3); END_VAR END_PROGRAM"
    ));
    assert_eq!(rig.int("trail"), 123_679);
}

#[test]
fn without_the_attribute_at_the_block_it_does_not_run_and_a_warning_tells_it() {
    let text = "FUNCTION_BLOCK Lone VAR n : INT; END_VAR
{attribute 'call_after_init'}
METHOD Settle
  n := 70;
END_METHOD
END_FUNCTION_BLOCK
PROGRAM P VAR x : Lone; END_VAR x(); END_PROGRAM";
    assert_eq!(rig(text).int("P.x.n"), 0);
    let found = findings_in(Dialect::TwinCat, text).to_string();
    assert!(found.contains("warning[W0714]: nothing calls `Settle` after the start"), "{found}");
    let both = format!("{{attribute 'call_after_init'}} {text}");
    assert_eq!(rig(&both).int("P.x.n"), 70);
    assert!(!findings_in(Dialect::TwinCat, &both).to_string().contains("W0714"));
}

#[test]
fn a_block_that_extends_it_may_have_the_attribute_for_it() {
    let text = "FUNCTION_BLOCK Lone VAR n : INT; END_VAR
{attribute 'call_after_init'}
METHOD Settle
  n := 70;
END_METHOD
END_FUNCTION_BLOCK
{attribute 'call_after_init'} FUNCTION_BLOCK More EXTENDS Lone END_FUNCTION_BLOCK
PROGRAM P VAR x : More; END_VAR x(); END_PROGRAM";
    assert_eq!(rig(text).int("P.x.n"), 70);
    assert!(!findings_in(Dialect::TwinCat, text).to_string().contains("W0714"));
}

#[test]
fn it_takes_no_inputs() {
    let text = "{attribute 'call_after_init'} FUNCTION_BLOCK B
{attribute 'call_after_init'} METHOD Settle VAR_INPUT n : INT; END_VAR END_METHOD
END_FUNCTION_BLOCK
PROGRAM P VAR x : B; END_VAR END_PROGRAM";
    assert!(findings_in(Dialect::Codesys, text).has_errors(), "nobody gives it an input");
}

#[test]
fn a_private_method_of_the_base_runs_beside_that_of_the_derived_block() {
    let rig = rig(&format!(
        "{}
{{attribute 'call_after_init'}}
FUNCTION_BLOCK Derived EXTENDS Base
{{attribute 'call_after_init'}}
METHOD Settle
  Note(3);
END_METHOD
END_FUNCTION_BLOCK
VAR_GLOBAL Others : LINT; d : Derived(1); END_VAR
PROGRAM P END_PROGRAM",
        NOTE.replace("METHOD Settle", "METHOD PRIVATE Settle")
    ));
    assert_eq!(rig.int("trail"), 163, "FB_init, the base's own, the derived block's own");
}
