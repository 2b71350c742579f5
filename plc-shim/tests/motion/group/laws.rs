//! What holds for any moves of a group at any time.

use proptest::prelude::*;

use super::bench::{GroupState, place, six, standby, state, velocity};
use crate::bench::Bench;

#[derive(Debug, Clone)]
struct Move {
    block: &'static str,
    to: [f64; 3],
    aux: [f64; 3],
    values: Vec<(&'static str, f64)>,
    parameter: f64,
    scans: usize,
}

fn any_move() -> impl Strategy<Value = Move> {
    let block = prop::sample::select(vec![
        "Linear",
        "Linear2",
        "Linear3",
        "Relative",
        "Circular",
        "Direct",
        "Halt",
        "Interrupt",
        "GoOn",
    ]);
    let places = (prop::array::uniform3(-1.0..1.0_f64), prop::array::uniform3(-1.0..1.0_f64));
    let dynamics = (0.1..3.0_f64, 0.5..30.0_f64, prop_oneof![Just(0.0), 5.0..500.0_f64]);
    (block, places, dynamics, (0..6_i32, 0..5_i32), 0.01..0.6_f64, 1..90_usize).prop_map(
        |(block, (to, aux), (velocity, acceleration, jerk), (mode, transition), parameter, scans)| {
            let mut values = vec![("Deceleration", acceleration), ("Jerk", jerk)];
            let moves = [("Velocity", velocity), ("Acceleration", acceleration)];
            let modes = [("BufferMode", f64::from(mode)), ("TransitionMode", f64::from(transition))];
            match block {
                "GoOn" => values.clear(),
                "Halt" => values.push(modes[0]),
                "Interrupt" => {}
                "Direct" => values = modes.to_vec(),
                _ => values.extend(moves.into_iter().chain(modes)),
            }
            Move { block, to, aux, values, parameter, scans }
        },
    )
}

/// Begins a move; it may be refused.
fn begin(bench: &mut Bench, order: &Move) {
    bench.set(&format!("{}.Execute", order.block), false);
    let input = match order.block {
        "Relative" => "Relative.Distance".to_owned(),
        "Circular" => "Circular.EndPoint".to_owned(),
        "Halt" | "Interrupt" | "GoOn" => String::new(),
        block => format!("{block}.Position"),
    };
    if !input.is_empty() {
        six(bench, &input, &order.to);
        six(bench, &format!("{}.TransitionParameter", order.block), &[order.parameter]);
    }
    if order.block == "Circular" {
        six(bench, "Circular.AuxPoint", &order.aux);
    }
}

/// No axis is faster than it may be, nor does its velocity change faster; places follow from velocities.
fn obeys(bench: &mut Bench, last: &mut ([f64; 3], [f64; 3])) -> Result<(), TestCaseError> {
    bench.scan();
    let now = (place(bench), velocity(bench));
    for k in 0..3 {
        prop_assert!(now.0[k].is_finite() && now.1[k].abs() <= 2.0 * 1.01, "{:?}", now.1);
        let change = (now.1[k] - last.1[k]).abs();
        prop_assert!(change <= 20.0 * 1.1 * 0.01 + 1e-6, "{change} m/s in a scan: {:?} to {:?}", last.1, now.1);
        let mean = (now.0[k] - last.0[k]) / 0.01;
        let (low, high) = (now.1[k].min(last.1[k]) - 0.21, now.1[k].max(last.1[k]) + 0.21);
        prop_assert!(low <= mean && mean <= high, "axis {k} at {mean}, {:?} to {:?}", last.1, now.1);
    }
    *last = now;
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(120))]

    #[test]
    fn axes_keep_to_their_limits_and_the_group_comes_to_rest(moves in prop::collection::vec(any_move(), 1..14)) {
        let mut bench = standby(3);
        let mut last = (place(&bench), velocity(&bench));
        for order in &moves {
            begin(&mut bench, order);
            obeys(&mut bench, &mut last)?;
            bench.start(order.block, &order.values);
            for _ in 0..order.scans {
                obeys(&mut bench, &mut last)?;
            }
        }
        bench.set("Halt.Execute", false);
        obeys(&mut bench, &mut last)?;
        bench.start("Halt", &[("Deceleration", 1.0), ("Jerk", 0.0), ("BufferMode", 0.0)]);
        for _ in 0..400 {
            obeys(&mut bench, &mut last)?;
        }
        prop_assert_eq!(bench.int("G.ErrorID"), 0);
        prop_assert_eq!(last.1.map(f64::abs).iter().fold(0.0, |most: f64, each| most.max(*each)), 0.0);
        prop_assert_eq!(state(&bench), GroupState::Standby);
    }
}
