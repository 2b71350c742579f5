//! Bodies that are drawn in TwinCAT: what they do, scan by scan.

use onescan_iec::input::kind::SourceKind;
use onescan_iec::{Dialect, Input, TimeSpan, inspect};
use onescan_iec_run::Application;

use crate::rig::Rig;

pub(crate) const LEVEL: &str = include_str!("../inputs/level.TcPOU");
pub(crate) const RUNGS: &str = include_str!("../inputs/rungs.TcPOU");
pub(crate) const VESSEL: &str = include_str!("../inputs/vessel.TcPOU");

const DECLARED: &str = "TYPE Pair : STRUCT low, high : INT; END_STRUCT END_TYPE
FUNCTION Swapped : Pair VAR_INPUT value : Pair; END_VAR
  Swapped.low := value.high; Swapped.high := value.low;
END_FUNCTION
FUNCTION Half : INT VAR_INPUT whole : INT; END_VAR Half := whole / 2; END_FUNCTION";

pub(crate) fn inputs(text: &str) -> [Input; 2] {
    [
        Input::from_text("Drawing.TcPOU", SourceKind::TwinCat, text),
        Input::from_text("declared.st", SourceKind::Text, DECLARED).in_dialect(Dialect::TwinCat),
    ]
}

pub(crate) fn rig(text: &str) -> Rig {
    let application = match Application::from_inputs(inputs(text)) {
        Ok(application) => application,
        Err(found) => panic!("{found}"),
    };
    Rig::with_plan(&application, &application.single_task(TimeSpan::millis::<10>()))
}

fn made_of(text: &str) -> String {
    Input::from_text("Drawing.TcPOU", SourceKind::TwinCat, text).file().text().to_string()
}

pub(crate) fn findings(text: &str) -> String {
    inspect(inputs(text), None).to_string()
}

/// `text` with the one place where `from` stands changed.
pub(crate) fn changed(text: &str, from: &str, to: &str) -> String {
    assert!(text.contains(from), "{from}");
    text.replacen(from, to, 1)
}

/// What variables are after each of `count` scans.
fn seen(rig: &mut Rig, program: &str, count: usize, names: &[&str]) -> Vec<Vec<i64>> {
    let mut all = Vec::new();
    for _ in 0..count {
        rig.scan().expect("no fault");
        all.push(names.iter().map(|name| rig.int(&format!("{program}.{name}"))).collect());
    }
    all
}

#[test]
fn a_chart_becomes_statements_in_its_order() {
    insta::assert_snapshot!(made_of(LEVEL));
}

#[test]
fn elements_of_a_chart_are_evaluated_in_its_order() {
    let mut rig = rig(LEVEL);
    rig.set("Level.fill", 4);
    rig.set("Level.drain", 1);
    let names = ["level", "full", "room", "before", "behind", "latched", "times", "first", "second", "passes"];
    assert_eq!(
        seen(&mut rig, "Level", 7, &names),
        [
            [3, 0, 1, 0, 0, 0, 0, 4, 3, 1],
            [6, 0, 1, 0, 0, 0, 0, 4, 6, 2],
            [9, 0, 1, 0, 0, 0, 0, 4, 9, 3],
            [12, 1, 0, 0, 0, 0, 1, 4, 12, 4],
            [15, 1, 0, 0, 0, 0, 1, 4, 15, 5],
            // The timer has run for 20 ms; what stands before it has the output of the cycle before.
            [18, 1, 0, 0, 1, 1, 1, 4, 18, 6],
            [21, 1, 0, 1, 1, 1, 1, 4, 21, 7],
        ]
    );
    rig.set("Level.drain", 30);
    rig.set("Level.run", 0);
    // It is set until something resets it; behind the return nothing happens.
    assert_eq!(seen(&mut rig, "Level", 1, &names), [[-5, 0, 1, 1, 0, 1, 1, 4, -5, 7]]);
    rig.set("Level.quit", 1);
    assert_eq!(seen(&mut rig, "Level", 1, &["latched", "passes"]), [[0, 7]]);
}

#[test]
fn networks_become_statements_in_their_order() {
    insta::assert_snapshot!(made_of(RUNGS));
}

/// The comparison is looked at where `go` is TRUE, and a coil takes its value all the same.
pub(crate) fn with_a_condition_at_en() -> String {
    let at = RUNGS.find("t=\"BoxTreeTerminator\"").expect("the rail");
    let (before, behind) = RUNGS.split_at(at);
    let end = behind.find("</o>\n").expect("its flags");
    let operand = "t=\"BoxTreeOperand\"><o n=\"Operand\" t=\"Operand\"><v n=\"Operand\">\"go\"</v></o>";
    format!("{before}{operand}{}", &behind[end + 5..])
}

#[test]
fn a_box_that_is_not_enabled_hands_on_false() {
    let mut rig = rig(&with_a_condition_at_en());
    let mut idle = |go| {
        rig.set("Rungs.go", go);
        rig.scan().expect("no fault");
        rig.int("Rungs.idle")
    };
    assert_eq!([idle(0), idle(1), idle(0)], [0, 1, 0]);
}

#[test]
fn contacts_coils_and_branches_do_what_is_drawn() {
    let mut rig = rig(RUNGS);
    let names = ["motor", "lamp", "dark", "idle", "left", "state"];
    let mut all = seen(&mut rig, "Rungs", 1, &names);
    rig.set("Rungs.start", 1);
    all.extend(seen(&mut rig, "Rungs", 1, &names));
    rig.set("Rungs.start", 0);
    all.extend(seen(&mut rig, "Rungs", 1, &names));
    rig.set("Rungs.stop", 1);
    rig.set("Rungs.go", 1);
    all.extend(seen(&mut rig, "Rungs", 2, &names));
    assert_eq!(
        all,
        [
            [0, 0, 1, 1, 0, 0],
            [1, 1, 1, 1, 0, 0],
            [1, 1, 1, 1, 0, 0],
            // The line that branches keeps its value although the box behind it changes `state`.
            [0, 0, 0, 1, 1, 10],
            [0, 0, 0, 0, 0, 10],
        ]
    );
}

#[test]
fn edges_and_en_do_what_is_drawn() {
    let mut rig = rig(RUNGS);
    let names = ["counted", "presses", "held", "elapsed", "released", "sum", "halved", "bumps"];
    rig.set("Rungs.button", 1);
    let mut all = seen(&mut rig, "Rungs", 3, &names);
    rig.set("Rungs.button", 0);
    rig.set("Rungs.go", 1);
    all.extend(seen(&mut rig, "Rungs", 1, &names));
    rig.set("Rungs.go", 0);
    rig.set("Rungs.button", 1);
    all.extend(seen(&mut rig, "Rungs", 1, &names));
    let ms = 1_000_000;
    assert_eq!(
        all,
        [
            [1, 1, 0, 0, 0, 0, 0, 1],
            [0, 1, 0, 10 * ms, 0, 0, 0, 2],
            [0, 1, 1, 20 * ms, 0, 0, 0, 3],
            [0, 1, 0, 0, 1, 6, 3, 4],
            [1, 2, 0, 0, 1, 6, 3, 5],
        ]
    );
}

#[test]
fn jumps_and_returns_leave_out_what_is_between() {
    let mut rig = rig(RUNGS);
    rig.set("Rungs.hold", 1);
    rig.set("Rungs.go", 1);
    assert_eq!(seen(&mut rig, "Rungs", 1, &["held_back", "sum", "bumps"]), [[1, 0, 1]]);
    rig.set("Rungs.quit", 1);
    assert_eq!(seen(&mut rig, "Rungs", 2, &["held_back", "bumps"]), [[1, 1], [1, 1]]);
}

#[test]
fn a_sequential_chart_becomes_steps_and_transitions() {
    insta::assert_snapshot!(made_of(VESSEL));
}

#[test]
fn a_sequential_chart_takes_its_way() {
    let mut rig = rig(VESSEL);
    let names = ["level", "opened", "closed", "turns", "warnings"];
    rig.set("Vessel.go", 1);
    let mut all = seen(&mut rig, "Vessel", 6, &names);
    rig.set("Vessel.go", 0);
    all.extend(seen(&mut rig, "Vessel", 4, &names));
    assert_eq!(
        all,
        [
            [0, 0, 0, 0, 0],
            // Both legs begin; what is called when a step becomes active is called once.
            [1, 1, 0, 1, 0],
            [2, 1, 0, 2, 0],
            [3, 1, 0, 2, 0],
            // Both legs have ended. The action of the step is not called once more.
            [3, 1, 1, 2, 0],
            [2, 1, 1, 2, 0],
            [1, 1, 1, 2, 0],
            [0, 1, 1, 2, 0],
            [0, 1, 1, 2, 0],
            [0, 1, 1, 2, 0],
        ]
    );
}

#[test]
fn the_first_alternative_whose_condition_is_true_is_taken() {
    let mut rig = rig(VESSEL);
    rig.set("Vessel.go", 1);
    rig.set("Vessel.bad", 1);
    let names = ["level", "warnings"];
    let mut all = seen(&mut rig, "Vessel", 7, &names);
    rig.set("Vessel.quit", 1);
    all.extend(seen(&mut rig, "Vessel", 2, &names));
    assert_eq!(all[4..], [[3, 0], [3, 1], [3, 1], [2, 1], [1, 1]]);
}
