//! Grants that come late, twice, not at all or out of order; stops, single steps, starts of the PLC.

use super::corpus::cases;
use super::driver::{Driver, Tasks, answer, application, own_plan, state};

const STEP: u64 = 5_000_000;

fn counting(form: Tasks) -> Driver {
    let case = cases().remove(1);
    Driver::joined(&application(case.text, &case.tasks), &own_plan(&case.tasks, form))
}

fn runs(driver: &Driver) -> Vec<i64> {
    ["Slow.n", "Fast.n", "Also.n", "Urgent.n"].map(|path| driver.rig.int(path) % 100).to_vec()
}

#[test]
fn a_program_runs_once_for_a_grant_however_often_it_comes() {
    for form in [Tasks::Kept, Tasks::Moved] {
        let mut driver = counting(form);
        (1..=4).for_each(|step| {
            driver.step(step * STEP);
        });
        assert_eq!(runs(&driver), [1, 2, 2, 1]);
        let before = state(&driver.rig.plc);
        // The same once more, older ones, one too early, and the right one with an old time.
        for (number, t_v, expected) in [
            (4, 4 * STEP, answer::READY),
            (3, 3 * STEP, answer::OLD),
            (1, 9 * STEP, answer::OLD),
            (6, 6 * STEP, answer::MISSING),
            (i64::from(u32::MAX) - 1000, 6 * STEP, answer::MISSING),
            (5, 4 * STEP, answer::TIME),
            (5, STEP, answer::TIME),
        ] {
            driver.write_grant(number, t_v);
            driver.cycles(30);
            assert_eq!(driver.answer(), expected, "grant {number} at {t_v}");
            assert_eq!((driver.done(), state(&driver.rig.plc)), (4, before.clone()));
        }
        driver.step(6 * STEP);
        assert_eq!(runs(&driver), [1, 3, 3, 2]);
    }
}

#[test]
fn grants_while_one_is_run_change_nothing() {
    let mut driver = counting(Tasks::Kept);
    driver.write_grant(1, 4 * STEP);
    driver.cycles(1);
    assert_eq!(driver.answer(), answer::RUNNING);
    for (number, t_v) in [(0, STEP), (2, 8 * STEP), (1, 9 * STEP)] {
        driver.write_grant(number, t_v);
        driver.cycles(3);
        assert_eq!(driver.rig.int("SDSP_Now"), 4 * STEP as i64);
    }
    driver.cycles(60);
    assert_eq!((driver.done(), runs(&driver)), (1, vec![1, 1, 1, 1]));
}

#[test]
fn a_limit_stops_and_steps() {
    let mut driver = counting(Tasks::Moved);
    driver.rig.set("SDSP_Limit", 1002);
    driver.step(2 * STEP);
    driver.step(4 * STEP);
    driver.write_grant(3, 6 * STEP);
    driver.cycles(20);
    assert_eq!((driver.answer(), driver.done()), (answer::HELD, 2));
    // A single step.
    driver.rig.set("SDSP_Limit", 1003);
    driver.cycles(20);
    assert_eq!((driver.answer(), driver.done()), (answer::READY, 3));
}

#[test]
fn a_session_begins_before_any_program_has_run() {
    let mut driver = counting(Tasks::Moved);
    driver.step(2 * STEP);
    driver.rig.set("SDSP_Session", 2000);
    driver.cycles(20);
    assert_eq!((driver.answer(), driver.rig.int("SDSP_Joined")), (answer::NOT_FRESH, 1000));
    // Reset: the session is left, and the PLC must be started for the next.
    driver.rig.set("SDSP_Session", 0);
    driver.cycles(20);
    assert_eq!((driver.answer(), driver.rig.int("SDSP_Joined")), (answer::READY, 0));
    driver.write_grant(2, 4 * STEP);
    driver.cycles(20);
    assert_eq!(runs(&driver), [0, 1, 1, 0]);
    driver.rig.set("SDSP_Session", 2000);
    driver.cycles(20);
    assert_eq!((driver.answer(), driver.rig.int("SDSP_Joined")), (answer::NOT_FRESH, 0));
    driver.restart();
    driver.join(2000);
    driver.step(4 * STEP);
    assert_eq!(runs(&driver), [1, 1, 1, 1]);
}

/// A start at any cycle: the PLC takes part no more, which the gateway sees, and nothing runs until a
/// session is joined again.
#[test]
fn a_start_of_the_plc_is_seen() {
    for cycles in 0..25 {
        let mut driver = counting(Tasks::Kept);
        driver.step(STEP);
        driver.write_grant(2, 4 * STEP);
        driver.cycles(cycles);
        driver.restart();
        driver.write_grant(2, 4 * STEP);
        driver.cycles(50);
        assert_eq!((driver.rig.int("SDSP_Joined"), driver.rig.int("SDSP_Done")), (0, 0));
        assert_eq!(runs(&driver), [0; 4], "nothing runs after {cycles} cycles");
        driver.join(7000);
        driver.write_grant(2, 4 * STEP);
        driver.cycles(50);
        assert_eq!((driver.answer(), runs(&driver)), (answer::MISSING, vec![0; 4]));
        // Nor does a grant of the session that is over.
        driver.rig.set("SDSP_Grant", 1001);
        driver.cycles(50);
        assert_eq!((driver.answer(), runs(&driver)), (answer::OLD, vec![0; 4]));
        driver.step(4 * STEP);
        assert_eq!(runs(&driver), [1; 4]);
    }
}

#[test]
fn what_is_not_simulated_is_not_granted() {
    let mut driver = counting(Tasks::Kept);
    driver.rig.set("SDSP_Simulated", 0);
    driver.cycles(40);
    assert_eq!(runs(&driver), [2, 4, 4, 2]);
    assert_eq!((driver.answer(), driver.rig.int("SDSP_Joined")), (answer::NOT_SIMULATED, 0));
    // A machine that has been running is not where a session begins.
    driver.rig.set("SDSP_Simulated", 1);
    driver.cycles(40);
    assert_eq!((driver.answer(), runs(&driver)), (answer::NOT_FRESH, vec![2, 4, 4, 2]));
}
