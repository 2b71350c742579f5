//! Shims and gateways that are wrong in one thing: the model finds each of them.

use stateright::{Checker, HasDiscoveries, Model};

use super::gateway::Gateway;
use super::plc::Change;
use super::undisturbed::stuck;
use super::{SESSIONS, Shim, project_with_single};

fn is_broken(gateway: Gateway, changes: &[Change]) -> bool {
    let checker = Shim::new(gateway, changes).checker().finish_when(HasDiscoveries::AnyFailures).spawn_bfs().join();
    checker.discovery("nothing is broken").is_some()
}

fn right() -> Gateway {
    Gateway::new(&SESSIONS[..2], 3)
}

/// Without it, a grant whose predecessor was lost is run.
#[test]
fn the_scheduler_needs_the_row_of_grants() {
    assert!(is_broken(right(), &[("Grant - SDSP_Done > 1", "FALSE")]));
}

/// Without it, the late grant that a PLC joins with is run as if time had not begun with it.
#[test]
fn the_scheduler_needs_a_time_that_grows() {
    assert!(is_broken(right(), &[("TV <= Last", "FALSE")]));
}

/// Without it, a PLC that left a session joins the next with what it has from the first.
#[test]
fn the_scheduler_needs_fresh() {
    assert!(is_broken(right(), &[("SDSP_Joined = 0 AND Fresh", "SDSP_Joined = 0")]));
}

/// Without it, a second session is joined in the midst of the first.
#[test]
fn the_scheduler_needs_to_leave_before_it_joins() {
    assert!(is_broken(right(), &[("SDSP_Joined = 0 AND Fresh", "TRUE")]));
}

/// Without it, a grant is done before its programs have run.
#[test]
fn the_scheduler_needs_to_wait_for_the_line() {
    assert!(is_broken(right(), &[("IF SDSP_Turn <> 0 THEN", "IF FALSE THEN")]));
}

/// Without it, every cycle of the PLC runs every program.
#[test]
fn the_execution_controller_needs_its_turn() {
    assert!(is_broken(right(), &[("SDSP_Simulated AND SDSP_Turn = 1", "SDSP_Simulated")]));
}

/// Without it, a program runs until the end of days.
#[test]
fn the_execution_controller_needs_to_hand_on() {
    assert!(is_broken(right(), &[("SDSP_Turn := SDSP_Next[1];", ";")]));
}

/// A program that hands the turn to itself, or to nobody in the midst of the line.
#[test]
fn the_execution_controller_needs_the_line() {
    assert!(stuck(&Shim::new(right(), &[("SDSP_Turn := SDSP_Next[1];", "SDSP_Turn := 0;")])) > 0);
    assert!(is_broken(right(), &[("SDSP_Turn := SDSP_Next[1];", "SDSP_Turn := SDSP_Next[0];")]));
}

/// Behind each task an edge may be due: a grant that is done with its first task leaves programs out.
#[test]
fn the_event_scheduler_needs_to_look_behind_each_task() {
    let changes = [("SDSP_Next[Rear[k]] := -1;", "SDSP_Next[Rear[k]] := 0;")];
    let checker = Shim::of(&project_with_single(), right(), &changes).checker();
    let checker = checker.finish_when(HasDiscoveries::AnyFailures).spawn_bfs().join();
    checker.assert_any_discovery("nothing is broken");
}

/// A program that counts the grant as done before others of the line have run, or that begins the next one.
#[test]
fn the_execution_controller_needs_to_be_the_last_to_count() {
    assert!(is_broken(right(), &[("IF SDSP_Next[1] = 0 THEN", "IF TRUE THEN")]));
    assert!(is_broken(right(), &[("SDSP_Turn := SDSP_Next[2];", "SDSP_Turn := 1;")]));
}

/// A grant that is counted twice: by the last program, and by the scheduler when it sees that the line is empty.
#[test]
fn a_grant_needs_to_be_counted_once() {
    let seen = "END_IF;\n\n    (* Cold start and reset. *)";
    let again =
        "ELSIF Last <> 0 THEN SDSP_Done := SDSP_Done + 1; Last := 0; END_IF;\n\n    (* Cold start and reset. *)";
    assert!(is_broken(right(), &[(seen, again)]));
    assert!(is_broken(right(), &[("SDSP_Done := SDSP_Done + 1;", "SDSP_Done := SDSP_Done + 2;")]));
}

/// A grant that nobody counts is never seen as done.
#[test]
fn a_grant_needs_to_be_counted() {
    let model = Shim::new(right(), &[("SDSP_Done := SDSP_Done + 1;", ";")]);
    let checker = model.checker().spawn_bfs().join();
    assert!(checker.discovery("the last session is run to its end").is_none());
}

/// A grant that is answered with the number that stands there now, perhaps that of a late one, is never
/// seen as done.
#[test]
fn the_scheduler_needs_to_count() {
    let declared = "SDSP_Turn : INT;\n    SDSP_Done : UDINT;";
    let beside = "SDSP_Turn : INT;\n    SDSP_Grant : UDINT;\n    SDSP_Done : UDINT;";
    let changes = [("SDSP_Done := SDSP_Done + 1;", "SDSP_Done := SDSP_Grant;"), (declared, beside)];
    let model = Shim::new(right(), &changes);
    assert!(stuck(&model) > 0);
}

/// A PLC that is restarted before its first grant joins with that grant, and never runs it.
#[test]
fn the_gateway_needs_the_answer_that_time_stands_still() {
    assert!(stuck(&Shim::new(Gateway { looks_at_time: false, ..right() }, &[])) > 0);
}

/// Outputs are those of whatever was run last.
#[test]
fn the_gateway_needs_the_number_of_its_grant() {
    assert!(is_broken(Gateway { looks_at_done: false, ..right() }, &[]));
}

/// Sessions and grants are numbered in one row. Where they are not, `SDSP_Joined` still distinguishes them; and
/// where they are, `SDSP_Done` alone does: two ropes, and only without both does one fall.
#[test]
fn the_gateway_needs_sessions_numbered_on_or_the_session_that_was_joined() {
    let dense = Gateway::new(&[100, 101], 3);
    assert!(!is_broken(dense, &[]));
    assert!(!is_broken(Gateway { looks_at_joined: false, ..right() }, &[]));
    assert!(is_broken(Gateway { looks_at_joined: false, ..dense }, &[]));
}
