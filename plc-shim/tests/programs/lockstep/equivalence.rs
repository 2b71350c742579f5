//! Original, instrumented and not simulated, instrumented under grants: the same to the last bit.

use onescan_iec::{Task, TaskPlan};

use super::abreast::Abreast;
use super::corpus::cases;
use super::driver::{Tasks, application, original, own_plan, state};

/// Runs all three side by side, and compares all variables after every step.
pub(crate) fn assert_equal(name: &str, text: &str, tasks: &[Task], inputs: &[&str], times: &[u64], form: Tasks) {
    let shimmed = application(text, tasks);
    let mut plcs = Abreast::new(original(text, tasks), &shimmed, &free_plan(tasks), &own_plan(tasks, form));
    for (step, t_v) in (0..).zip(times) {
        plcs.step(step, *t_v, inputs);
        let expected = state(&plcs.plain);
        assert_eq!(expected, state(&plcs.inert), "{name}: not simulated, t_v = {t_v}");
        assert_eq!(expected, state(plcs.granted()), "{name}: granted, {form:?}, t_v = {t_v}");
    }
}

/// The tasks as they were, and the scheduler.
pub(crate) fn free_plan(tasks: &[Task]) -> TaskPlan {
    let mut plan = vec![Task { priority: 0, ..crate::rig::task("sdsp", 1, 0, &["SDSP_Scheduler"]) }];
    plan.extend(tasks.iter().cloned());
    TaskPlan::new(plan)
}

const MS: u64 = 1_000_000;

#[test]
fn every_program_gives_the_same_at_the_same_time() {
    for case in cases() {
        let times: Vec<u64> = (1..120).map(|step| step * 5 * MS).collect();
        for form in [Tasks::Kept, Tasks::Moved] {
            assert_equal(case.name, case.text, &case.tasks, case.inputs, &times, form);
        }
    }
}

/// Steps of any length, from below a millisecond to many intervals: tasks that are late come by how long
/// they have waited.
#[test]
fn steps_may_be_of_any_length() {
    let lengths = [300_000, 7 * MS, 13 * MS, 1, 40 * MS, 19_999_999, 5 * MS, 101 * MS];
    let mut now = 0;
    let times: Vec<u64> = (0..100)
        .map(|step| {
            now += lengths[step % lengths.len()];
            now
        })
        .collect();
    for case in cases() {
        for form in [Tasks::Kept, Tasks::Moved] {
            assert_equal(case.name, case.text, &case.tasks, case.inputs, &times, form);
        }
    }
}
