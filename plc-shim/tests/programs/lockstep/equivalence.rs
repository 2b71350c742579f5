//! Original, instrumented and not simulated, instrumented under grants: the same to the last bit.

use onescan_plc_shim::{SoftPlc, Task, TaskPlan};

use super::corpus::{cases, input};
use super::driver::{Driver, Tasks, application, original, own_plan, scan, state, write};

/// Runs all three side by side, and compares all variables after every step.
pub(crate) fn assert_equal(name: &str, text: &str, tasks: &[Task], inputs: &[&str], times: &[u64], form: Tasks) {
    let mut plain = original(text, tasks);
    let application = application(text, tasks);
    let mut inert = SoftPlc::new(&application, &free_plan(tasks)).expect("the plan suits");
    write(&mut inert, "SDSP_Simulated", 0);
    let mut driver = Driver::joined(&application, &own_plan(tasks, form));
    for (step, t_v) in times.iter().enumerate() {
        for (index, path) in inputs.iter().enumerate() {
            let value = input(index, step as u64);
            write(&mut plain, path, value);
            write(&mut inert, path, value);
            driver.rig.set(path, value);
        }
        scan(&mut plain, *t_v);
        scan(&mut inert, *t_v);
        driver.step(*t_v);
        // The PLC idles for a while, as its gateway is slow.
        driver.cycles((step % 4) as u32);
        assert_eq!(state(&plain), state(&inert), "{name}: not simulated, t_v = {t_v}");
        assert_eq!(state(&plain), state(&driver.rig.plc), "{name}: granted, {form:?}, t_v = {t_v}");
    }
}

/// The tasks as they were, and the scheduler.
fn free_plan(tasks: &[Task]) -> TaskPlan {
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
