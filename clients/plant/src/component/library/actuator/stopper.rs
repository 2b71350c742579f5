//! A stopper: a pin that a pneumatic drive raises into a conveyor and lowers below it.
//!
//! # Equations
//! - from lowered (0) to raised (`stroke_m`) in `raise_s`, back in `lower_s`, each at a constant speed: the way is linear
//!   in time;
//! - on a joint it does so with `force_n` at most: what lies on the pin may hold it down.
//!
//! # Source
//! closed form; stroke, times and impact are what makers of stoppers state (Bosch Rexroth VE 2, Festo DFST).

use serde::{Deserialize, Serialize};

use crate::component::behaviour::{Component, Start, Turn};
use crate::component::declare::{choice, failures, own_types, parameters, signals};
use crate::component::dynamics::ramp;
use crate::coupling::{Carried, Follow, Lifts};
use crate::setpoint::Setpoint;

choice! {
    /// What moves the pin.
    Acting {
        /// A spring raises it, the valve lowers it.
        SpringUp = "spring-up",
        /// A spring lowers it, the valve raises it.
        SpringDown = "spring-down",
        /// The valve does both; without a coil it stays.
        Double = "double",
    }
}

parameters! {
    /// A stopper and its valve.
    Parameters {
        /// what moves it: "spring-up" has the coil `lower`, "spring-down" the coil `raise`, "double" has both
        acting: Acting = Acting::SpringUp;
        /// way of the pin from 0
        stroke_m: f64 = 0.03 => 0.001, 10.0;
        /// from lowered to raised
        raise_s: f64 = 0.1 => 0.001, 60.0;
        /// from raised to lowered
        lower_s: f64 = 0.1 => 0.001, 60.0;
        /// greatest force along its way, on a joint
        force_n: f64 = 200.0 => 0.1, 1e6;
        /// how far from its end a switch sees the pin
        switch_m: f64 = 0.002 => 0.0, 0.5;
    }
}

signals! {
    /// The valve's coils.
    Inputs {
        /// coil that lowers the pin
        lower: bool,
        /// coil that raises the pin
        raise: bool,
    }
}

signals! {
    /// The switches, and where it is.
    Outputs {
        /// switch at the upper end
        raised: bool,
        /// switch at the lower end
        lowered: bool,
        /// way of the pin
        position_m: f64,
    }
}

failures! {
    /// Faults of the pin, its drive and its switches.
    Failure {
        /// the pin does not move
        Stuck = "stuck",
        /// a throttle is nearly shut: it takes four times as long
        Slow = "slow",
        /// the spring is broken: it moves nothing
        SpringBroken = "spring_broken",
        /// the switch at the upper end stays off
        RaisedDead = "raised_dead",
        /// the switch at the lower end stays off
        LoweredDead = "lowered_dead",
    }
}

/// The pin at both ends of the period, from 0 to `stroke_m`, and its speed between them.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    /// Where the period began.
    from_m: f64,
    pin_m: f64,
    velocity_m_s: f64,
}

/// A stopper, by its parameters.
pub(crate) struct Stopper {
    p: Parameters,
}

impl Stopper {
    /// Where the pin is to go; nowhere if nothing moves it.
    fn wanted_m(&self, inputs: Inputs, spring: bool) -> Option<f64> {
        let (up, down) = (Some(self.p.stroke_m), Some(0.0));
        match (self.p.acting, inputs.lower, inputs.raise) {
            (Acting::SpringUp, true, _) | (Acting::Double, true, false) => down,
            (Acting::SpringDown, _, true) | (Acting::Double, false, true) => up,
            (Acting::SpringUp, false, _) => up.filter(|_| spring),
            (Acting::SpringDown, _, false) => down.filter(|_| spring),
            (Acting::Double, true, true) | (Acting::Double, false, false) => None,
        }
    }
}

impl Component for Stopper {
    const NAME: &'static str = "stopper";
    const SUMMARY: &'static str = "stopper: a pin that a pneumatic drive raises into a conveyor";
    const FORMULA: &'static [&'static str] =
        &["dx/dt = stroke_m/raise_s up, -stroke_m/lower_s down, within [0, stroke_m]"];
    const SOURCE: &'static str = "closed form; stroke and times as makers state them";
    own_types!(moves Lifts);

    fn new(p: Parameters) -> Self {
        Self { p }
    }

    fn uses(p: &Parameters, input: usize) -> bool {
        match p.acting {
            Acting::SpringUp => input == 0,
            Acting::SpringDown => input == 1,
            Acting::Double => true,
        }
    }

    fn initial(&self, start: &Start<Option<Carried>>) -> State {
        let springs = if self.p.acting == Acting::SpringUp { self.p.stroke_m } else { 0.0 };
        let pin_m = start.seen.map_or(springs, |joint| joint.position.clamp(0.0, self.p.stroke_m));
        State { from_m: pin_m, pin_m, velocity_m_s: 0.0 }
    }

    fn stops(&self) -> Option<[f64; 2]> {
        Some([0.0, self.p.stroke_m])
    }

    fn drive(&self, state: &mut State, inputs: &Inputs, turn: &Turn<Option<Carried>>) {
        let p = &self.p;
        let part = if turn.failed.has(Failure::Slow) { 0.25 } else { 1.0 };
        let [up, down] = [p.raise_s, p.lower_s].map(|time_s| part * p.stroke_m / time_s);
        if let Some(joint) = turn.seen {
            // one that was held does not jump when it comes free
            let slack_m = up.max(down) * turn.dt_s;
            state.pin_m = state.pin_m.clamp(joint.position - slack_m, joint.position + slack_m);
        }
        state.from_m = state.pin_m;
        let wanted_m = self.wanted_m(*inputs, !turn.failed.has(Failure::SpringBroken));
        if let Some(wanted_m) = wanted_m.filter(|_| !turn.failed.has(Failure::Stuck)) {
            let speed = if wanted_m > state.pin_m { up } else { down };
            state.pin_m = ramp(state.pin_m, wanted_m, speed, turn.dt_s);
        }
        state.velocity_m_s = if turn.dt_s > 0.0 { (state.pin_m - state.from_m) / turn.dt_s } else { 0.0 };
    }

    fn effect(&self, state: &State) -> Follow {
        let State { from_m, pin_m, velocity_m_s: velocity } = *state;
        let at = |position: f64| Setpoint { position, velocity };
        Follow { from: at(from_m), to: at(pin_m), effort_max: self.p.force_n }
    }

    fn sense(&self, state: &mut State, _: &Inputs, turn: &Turn<Option<Carried>>) -> Outputs {
        let position_m = turn.seen.map_or(state.pin_m, |joint| joint.position);
        // a rounding short of its end is not a reason for a switch to be off
        let switch_m = self.p.switch_m + 1e-9;
        Outputs {
            raised: position_m >= self.p.stroke_m - switch_m && !turn.failed.has(Failure::RaisedDead),
            lowered: position_m <= switch_m && !turn.failed.has(Failure::LoweredDead),
            position_m,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::tests::Rig;

    const REST: Inputs = Inputs { lower: false, raise: false };
    const LOWER: Inputs = Inputs { lower: true, raise: false };
    const RAISE: Inputs = Inputs { lower: false, raise: true };

    fn rig(acting: Acting) -> Rig<Stopper> {
        Rig::new(Stopper::new(Parameters { acting, raise_s: 0.2, ..Parameters::default() }))
    }

    #[test]
    fn the_way_is_linear_in_time_at_any_period() {
        for dt_s in [0.001, 0.01, 0.025] {
            let turns = (0.05 / dt_s) as u32;
            let mut rig = rig(Acting::SpringUp);
            assert!(rig.run(REST, dt_s, 1).raised);
            // half of 0.1 s down, half of 0.2 s up; a hundred additions, each rounded to 2^-53
            assert!((rig.run(LOWER, dt_s, turns).position_m - 0.015).abs() < 1e-15);
            assert!(rig.run(LOWER, dt_s, turns).lowered);
            assert!((rig.run(REST, dt_s, 2 * turns).position_m - 0.015).abs() < 1e-15);
            let out = rig.run(REST, dt_s, 2 * turns);
            assert!(out.raised && (out.position_m - 0.03).abs() < 1e-15);
        }
    }

    #[test]
    fn a_spring_takes_it_back_and_two_coils_leave_it() {
        let mut down = rig(Acting::SpringDown);
        assert!(down.run(REST, 0.01, 1).lowered && down.run(RAISE, 0.01, 21).raised);
        assert!(down.run(REST, 0.01, 11).lowered);
        let mut double = rig(Acting::Double);
        let half_m = double.run(RAISE, 0.01, 10).position_m;
        assert_eq!(double.run(REST, 0.01, 50).position_m, half_m);
        assert_eq!(double.run(Inputs { lower: true, raise: true }, 0.01, 50).position_m, half_m);
        assert!(double.run(LOWER, 0.01, 6).lowered);
    }

    #[test]
    fn only_its_own_coils_are_of_use() {
        let uses = |acting: Acting| {
            let p = Parameters { acting, ..Parameters::default() };
            [0, 1].map(|input| Stopper::uses(&p, input))
        };
        assert_eq!(uses(Acting::SpringUp), [true, false]);
        assert_eq!(uses(Acting::SpringDown), [false, true]);
        assert_eq!(uses(Acting::Double), [true, true]);
    }

    #[test]
    fn each_failure_has_its_effect() {
        assert!(rig(Acting::SpringUp).failing(Failure::Stuck).run(LOWER, 0.01, 100).raised);
        let slow = rig(Acting::SpringUp).failing(Failure::Slow).run(LOWER, 0.01, 20);
        assert!((slow.position_m - 0.015).abs() < 1e-15, "{slow:?}");
        let mut broken = rig(Acting::SpringUp).failing(Failure::SpringBroken);
        assert!(broken.run(LOWER, 0.01, 11).lowered && broken.run(REST, 0.01, 100).lowered);
        assert!(!rig(Acting::SpringUp).failing(Failure::RaisedDead).run(REST, 0.01, 1).raised);
        assert!(!rig(Acting::SpringUp).failing(Failure::LoweredDead).run(LOWER, 0.01, 50).lowered);
    }
}
