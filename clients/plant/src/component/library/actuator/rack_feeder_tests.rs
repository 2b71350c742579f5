use super::*;
use crate::component::tests::Rig;

const REST: Inputs =
    Inputs { target_x: 0, target_y: 0, execute: false, fork_left: false, fork_right: false, quit: false };

fn to(target_x: i32, target_y: i32) -> Inputs {
    Inputs { target_x, target_y, execute: true, ..REST }
}

fn rig() -> Rig<RackFeeder> {
    let mut rig = Rig::new(RackFeeder::new(Parameters::default()));
    rig.run(REST, 0.01, 1);
    rig
}

/// Turns until a condition holds.
fn until(rig: &mut Rig<RackFeeder>, inputs: Inputs, dt_s: f64, holds: impl Fn(&Outputs) -> bool) -> u32 {
    (1..100_000).find(|_| holds(&rig.run(inputs, dt_s, 1))).expect("in the end")
}

#[test]
fn a_cycle_takes_the_time_of_the_slower_axis() {
    // column 19: 9.5 m, 9.5/2 + 2/0.5 = 8.75 s; row 7: 2.8 m, 2.8/0.8 + 0.8/0.8 = 4.5 s;
    // column 1: 0.5 m below v²/a = 8 m, 2 √(0.5/0.5) = 2 s
    for (target, time_s) in [((19, 7), 8.75), ((0, 7), 4.5), ((1, 0), 2.0)] {
        for dt_s in [0.001, 0.01, 0.05] {
            let turns = until(&mut rig(), to(target.0, target.1), dt_s, |out| out.in_position);
            assert!((f64::from(turns) * dt_s - time_s).abs() < 0.5 * dt_s, "{target:?} {dt_s}: {turns}");
        }
    }
}

#[test]
fn half_way_it_is_where_the_trapezoid_is() {
    let mut rig = rig();
    let out = rig.run(to(19, 7), 0.01, 400);
    // travel: a/2 t² = 4 m after 4 s, just at its speed; lift: v (t - v/2a) = 0.8 (4 - 0.5) = 2.8 less what it still brakes
    assert!((out.x_m - 4.0).abs() < 1e-12 && out.busy && !out.in_position, "{out:?}");
    // 0.5 s before its end: a/2 0.5² = 0.1 m are left
    assert!((out.y_m - 2.7).abs() < 1e-12, "{out:?}");
}

#[test]
fn the_fork_moves_while_the_axes_stand_alone() {
    let mut rig = rig();
    let left = Inputs { fork_left: true, ..to(1, 0) };
    rig.run(left, 0.01, 150);
    assert_eq!(rig.state.real_m[FORK], 0.0, "the travel moves");
    rig.run(left, 0.01, 50);
    // 1.2/0.6 + 0.6/1.0 = 2.6 s
    let turns = until(&mut rig, left, 0.01, |out| out.fork_left_out);
    assert_eq!(turns, 260);
    let out = rig.run(left, 0.01, 1);
    assert!(!out.fork_centred && out.fork_m == 1.2 && out.in_position);
    assert!(rig.run(REST, 0.01, 261).fork_centred);
    assert!(rig.run(Inputs { fork_right: true, ..REST }, 0.01, 261).fork_right_out);
    let both = Inputs { fork_left: true, fork_right: true, ..REST };
    assert!(rig.run(both, 0.01, 261).fork_centred);
}

#[test]
fn what_it_cannot_do_is_an_error_until_it_is_acknowledged() {
    for (x, y) in [(-1, 0), (20, 0), (0, 8), (0, -1)] {
        let mut rig = rig();
        let out = rig.run(to(x, y), 0.01, 5);
        assert!(out.error && !out.busy && out.x_m == 0.0);
        assert!(rig.run(REST, 0.01, 5).error && !rig.run(Inputs { quit: true, ..REST }, 0.01, 1).error);
    }
    let mut rig = rig();
    rig.run(Inputs { fork_left: true, ..REST }, 0.01, 100);
    let out = rig.run(Inputs { fork_left: true, ..to(3, 3) }, 0.01, 1);
    assert!(out.error && out.x_m == 0.0, "with the fork out it stays: {out:?}");
}

#[test]
fn each_failure_has_its_effect() {
    let mut blocked = rig().failing(Failure::TravelBlocked);
    // a/2 t² = 0.05 m after 0.447 s
    let turns = until(&mut blocked, to(5, 0), 0.01, |out| out.error);
    assert!((45..=47).contains(&turns) && blocked.state.real_m[TRAVEL] == 0.0, "{turns}");
    let mut stuck = rig().failing(Failure::ForkStuck);
    let out = stuck.run(Inputs { fork_left: true, ..REST }, 0.01, 100);
    assert!(out.error && out.fork_m == 0.0);
    let mut lost = rig().failing(Failure::PositionLost);
    assert!(lost.run(Inputs { quit: true, ..REST }, 0.01, 5).error);
    lost.failed = crate::component::declare::Failed::default();
    lost.run(REST, 0.01, 1);
    assert!(!lost.run(Inputs { quit: true, ..REST }, 0.01, 1).error);
}
