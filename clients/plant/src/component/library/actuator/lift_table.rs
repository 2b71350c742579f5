//! A lift table: a platform on scissors, which a hydraulic ram spreads.
//!
//! # Equations
//! - `h = n L sin θ`: height of n pairs of arms of length L, θ from the level to an arm;
//! - `s² = a² + b² - 2 a b cos θ`: length of the ram, from a foot `a` beside the fixed end of the lowest arm to a head `b`
//!   along that arm;
//! - `ds/dt = ±u`: constant flow of oil, so that `dh/dt = ± u s n L cos θ / (a b sin θ)`: fast when low, slow when high;
//! - above `capacity_kg` the relief valve opens and it does not rise; a check valve holds it. On a joint this is the load
//!   that its motion takes, smoothed by 0.1 s of the hoses.
//!
//! The joint's coordinate is the height above the lowest.
//!
//! # Source
//! EN 1570-1:2011+A1:2014 (lift tables: relief valve, check valve); the law of cosines.

use serde::{Deserialize, Serialize};

use crate::component::behaviour::{Component, Conflict, Start, Turn};
use crate::component::declare::{failures, own_types, parameters, signals};
use crate::component::dynamics::lag;
use crate::coupling::{Carried, Follow, Lifts};
use crate::setpoint::Setpoint;

/// Time constant of oil and hoses.
const HOSES_S: f64 = 0.1;
/// What a capacity in kg weighs, m/s².
const FALL_M_S2: f64 = 9.81;

parameters! {
    /// A table and its ram.
    Parameters {
        /// length of an arm
        arm_m: f64 = 1.2 => 0.05, 20.0;
        /// pairs of arms above each other
        stages: u32 = 1 => 1.0, 4.0;
        /// angle of the arms at the lowest
        lowest_deg: f64 = 8.0 => 2.0, 80.0;
        /// angle of the arms at the highest
        highest_deg: f64 = 50.0 => 3.0, 85.0;
        /// from the fixed end of the lowest arm to the foot of the ram
        ram_foot_m: f64 = 0.9 => 0.01, 20.0;
        /// from the fixed end of the lowest arm to the head of the ram on it
        ram_head_m: f64 = 0.35 => 0.01, 20.0;
        /// speed of the ram, both ways
        ram_speed_m_s: f64 = 0.02 => 1e-6, 10.0;
        /// mass of platform and load at which the relief valve opens
        capacity_kg: f64 = 1000.0 => 0.1, 1e6;
        /// how fast it sinks if it leaks
        leak_m_s: f64 = 0.005 => 0.0, 10.0;
        /// how far from its end a switch sees it
        switch_m: f64 = 0.002 => 0.0, 1.0;
    }
}

signals! {
    /// Coils of the valve; without one the check valve holds it.
    Inputs {
        /// rises
        up: bool,
        /// sinks; with both it stands
        down: bool,
    }
}

signals! {
    /// Height above the feet, end switches, relief valve.
    Outputs {
        /// height of the platform above the feet of the arms
        height_m: f64,
        /// switch at the highest
        at_top: bool,
        /// switch at the lowest
        at_bottom: bool,
        /// the relief valve is open
        overload: bool,
    }
}

failures! {
    /// Faults of the oil, the scissors and the relief valve.
    Failure {
        /// it leaks, and sinks by `leak_m_s`
        Leak = "leak",
        /// it does not move
        Stuck = "stuck",
        /// the relief valve opens at any load: it does not rise
        Overload = "overload",
    }
}

/// A height of the platform and the length of the ram there.
#[derive(Clone, Copy, Debug, PartialEq)]
struct End {
    height_m: f64,
    ram_m: f64,
}

/// What it remembers. Ways are heights above the lowest.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    ram_m: f64,
    /// Where the period began.
    from_m: f64,
    way_m: f64,
    velocity_m_s: f64,
    load_n: f64,
    relieved: bool,
}

/// A lift table, by its parameters.
pub(crate) struct LiftTable {
    p: Parameters,
    /// n L
    reach_m: f64,
    low: End,
    high: End,
}

impl LiftTable {
    /// Height of the platform with the ram so long.
    fn height_m(&self, ram_m: f64) -> f64 {
        let (a, b) = (self.p.ram_foot_m, self.p.ram_head_m);
        let cos = ((a * a + b * b - ram_m * ram_m) / (2.0 * a * b)).clamp(-1.0, 1.0);
        self.reach_m * (1.0 - cos * cos).sqrt()
    }

    /// Length of the ram with the platform so high.
    fn ram_m(&self, height_m: f64) -> f64 {
        let (a, b) = (self.p.ram_foot_m, self.p.ram_head_m);
        let sin = (height_m / self.reach_m).clamp(0.0, 1.0);
        (a * a + b * b - 2.0 * a * b * (1.0 - sin * sin).sqrt()).max(0.0).sqrt()
    }

    fn end(&self, angle_deg: f64) -> End {
        let height_m = self.reach_m * libm::sin(angle_deg.to_radians());
        End { height_m, ram_m: self.ram_m(height_m) }
    }

    /// Where the ram is after a period in which oil flows so.
    fn flow(&self, state: &mut State, flow_m: f64) {
        if flow_m == 0.0 {
            return;
        }
        let low_m = self.low.ram_m.min(self.high.ram_m);
        state.ram_m = (state.ram_m + flow_m).clamp(low_m, self.high.ram_m.max(low_m));
        state.way_m = (self.height_m(state.ram_m) - self.low.height_m).clamp(0.0, self.stroke_m());
    }

    fn stroke_m(&self) -> f64 {
        self.high.height_m - self.low.height_m
    }
}

impl Component for LiftTable {
    const NAME: &'static str = "lift_table";
    const SUMMARY: &'static str = "lift table: scissors that a hydraulic ram spreads";
    const FORMULA: &'static [&'static str] =
        &["h = n L sin θ", "s² = a² + b² - 2 a b cos θ", "ds/dt = ±u, dh/dt = ± u s n L cos θ / (a b sin θ)"];
    const SOURCE: &'static str = "EN 1570-1:2011+A1:2014; the law of cosines";
    own_types!(moves Lifts);

    fn new(p: Parameters) -> Self {
        let none = End { height_m: 0.0, ram_m: 0.0 };
        let reach_m = f64::from(p.stages) * p.arm_m;
        let table = Self { p, reach_m, low: none, high: none };
        let [low, high] = [table.p.lowest_deg, table.p.highest_deg].map(|angle_deg| table.end(angle_deg));
        Self { low, high, ..table }
    }

    fn conflict(p: &Parameters) -> Option<Conflict> {
        let wrong = p.highest_deg <= p.lowest_deg;
        wrong.then_some(Conflict { key: "highest_deg", wanted: "a number above `lowest_deg`" })
    }

    fn initial(&self, start: &Start<Option<Carried>>) -> State {
        let way_m = start.seen.map_or(0.0, |joint| joint.position.clamp(0.0, self.stroke_m()));
        let ram_m = self.ram_m(self.low.height_m + way_m);
        State { ram_m, from_m: way_m, way_m, ..State::default() }
    }

    fn stops(&self) -> Option<[f64; 2]> {
        Some([0.0, self.stroke_m()])
    }

    fn drive(&self, state: &mut State, inputs: &Inputs, turn: &Turn<Option<Carried>>) {
        let flow_m = self.p.ram_speed_m_s * turn.dt_s;
        if let Some(joint) = turn.seen {
            state.load_n = lag(state.load_n, joint.force_n, HOSES_S, turn.dt_s);
            // one that was held does not jump when it comes free
            let slack_m = 2.0 * state.velocity_m_s.abs() * turn.dt_s + 1e-6;
            let held_m = state.way_m.clamp(joint.position - slack_m, joint.position + slack_m);
            if held_m != state.way_m {
                (state.way_m, state.ram_m) = (held_m, self.ram_m(self.low.height_m + held_m));
            }
        }
        state.from_m = state.way_m;
        let heavy = state.load_n > self.p.capacity_kg * FALL_M_S2 || turn.failed.has(Failure::Overload);
        let (up, down) = (inputs.up && !inputs.down, inputs.down && !inputs.up);
        state.relieved = up && heavy;
        if !turn.failed.has(Failure::Stuck) {
            let flow_m = if down {
                -flow_m
            } else if up && !heavy {
                flow_m
            } else {
                0.0
            };
            self.flow(state, flow_m);
            if turn.failed.has(Failure::Leak) {
                state.way_m = (state.way_m - self.p.leak_m_s * turn.dt_s).max(0.0);
                state.ram_m = self.ram_m(self.low.height_m + state.way_m);
            }
        }
        state.velocity_m_s = if turn.dt_s > 0.0 { (state.way_m - state.from_m) / turn.dt_s } else { 0.0 };
    }

    fn effect(&self, state: &State) -> Follow {
        let at = |position: f64| Setpoint { position, velocity: state.velocity_m_s };
        // a column of oil holds whatever stands on it
        Follow { from: at(state.from_m), to: at(state.way_m), effort_max: f64::INFINITY }
    }

    fn sense(&self, state: &mut State, _: &Inputs, turn: &Turn<Option<Carried>>) -> Outputs {
        let way_m = turn.seen.map_or(state.way_m, |joint| joint.position);
        // a rounding short of its end is not a reason for a switch to be off
        let switch_m = self.p.switch_m + 1e-9;
        Outputs {
            height_m: self.low.height_m + way_m,
            at_top: way_m >= self.stroke_m() - switch_m,
            at_bottom: way_m <= switch_m,
            overload: state.relieved,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::tests::Rig;

    const UP: Inputs = Inputs { up: true, down: false };
    const DOWN: Inputs = Inputs { up: false, down: true };
    const REST: Inputs = Inputs { up: false, down: false };

    fn rig(stages: u32) -> Rig<LiftTable> {
        Rig::new(LiftTable::new(Parameters { stages, ..Parameters::default() }))
    }

    /// The height after the ram has gone a way from the lowest, by the angle.
    fn height_m(stages: f64, ram_m: f64) -> f64 {
        let (a, b) = (0.9_f64, 0.35_f64);
        let lowest = libm::sqrt(a * a + b * b - 2.0 * a * b * libm::cos(8.0_f64.to_radians()));
        let s = lowest + ram_m;
        stages * 1.2 * libm::sin(libm::acos((a * a + b * b - s * s) / (2.0 * a * b)))
    }

    #[test]
    fn the_height_is_that_of_the_ram_at_any_period() {
        for (stages, dt_s) in [(1, 0.001), (1, 0.01), (2, 0.1)] {
            let mut rig = rig(stages);
            assert!(rig.run(REST, dt_s, 1).at_bottom);
            for seconds in 1..6 {
                let out = rig.run(UP, dt_s, (1.0 / dt_s).round() as u32);
                let exact_m = height_m(f64::from(stages), 0.02 * f64::from(seconds));
                // thousands of additions below 1, each rounded to 2^-53
                assert!((out.height_m - exact_m).abs() < 1e-11, "{stages} {dt_s}: {out:?} {exact_m}");
            }
        }
    }

    #[test]
    fn it_rises_fast_when_low_and_slowly_when_high() {
        let mut rig = rig(1);
        let heights: Vec<_> = (0..7).map(|_| rig.run(UP, 0.01, 100).height_m).collect();
        let steps: Vec<_> = heights.windows(2).map(|pair| pair[1] - pair[0]).collect();
        assert!(steps.windows(2).all(|pair| pair[1] < pair[0]), "{steps:?}");
        // dh/dt = u s L cos θ / (a b sin θ) half way through a step, whose square adds less than 1 %
        let s = rig.state.ram_m - 0.01;
        let cos = (0.9 * 0.9 + 0.35 * 0.35 - s * s) / (2.0 * 0.9 * 0.35);
        let rate_m_s = 0.02 * s * 1.2 * cos / (0.9 * 0.35 * (1.0 - cos * cos).sqrt());
        assert!((steps[5] / rate_m_s - 1.0).abs() < 0.01, "{} {rate_m_s}", steps[5]);
    }

    #[test]
    fn it_stops_at_its_ends_and_with_both_valves() {
        let mut rig = rig(1);
        let top = rig.run(UP, 0.01, 2000);
        let exact_m = 1.2 * libm::sin(50.0_f64.to_radians());
        assert!(top.at_top && !top.at_bottom && (top.height_m - exact_m).abs() < 1e-12, "{top:?}");
        assert_eq!(rig.run(Inputs { up: true, down: true }, 0.01, 100).height_m, top.height_m);
        assert!(rig.run(DOWN, 0.01, 2000).at_bottom);
    }

    #[test]
    fn beyond_its_capacity_it_does_not_rise() {
        let mut rig = rig(1);
        rig.seen = Some(Carried { position: 0.0, force_n: 1001.0 * 9.81 });
        rig.run(REST, 0.01, 200);
        let out = rig.run(UP, 0.01, 100);
        assert!(out.overload && rig.state.way_m == 0.0, "{out:?}");
        rig.seen = Some(Carried { position: 0.0, force_n: 999.0 * 9.81 });
        rig.run(REST, 0.01, 200);
        assert!(!rig.run(UP, 0.01, 1).overload && rig.state.way_m > 0.0);
    }

    #[test]
    fn each_failure_has_its_effect() {
        let mut leaks = rig(1);
        let before_m = leaks.run(UP, 0.01, 300).height_m;
        let mut leaks = leaks.failing(Failure::Leak);
        let lost_m = before_m - leaks.run(REST, 0.01, 1000).height_m;
        assert!((lost_m - 0.05).abs() < 1e-12, "{lost_m}");
        assert!(leaks.run(REST, 0.1, 2000).at_bottom);
        assert!(rig(1).failing(Failure::Stuck).run(UP, 0.01, 500).at_bottom);
        let out = rig(1).failing(Failure::Overload).run(UP, 0.01, 500);
        assert!(out.at_bottom && out.overload);
    }
}
