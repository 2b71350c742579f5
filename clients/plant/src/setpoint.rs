//! The motion a drive wants: position and velocity of an ideal axis, one period at a time.
//!
//! Ramps are integrated in closed form over a period, so that a setpoint does not depend on how
//! often it is asked.

use serde::{Deserialize, Serialize};

/// What bounds a motion.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds {
    /// Greatest speed, m/s or rad/s.
    pub(super) speed: f64,
    /// Greatest acceleration and deceleration, m/s² or rad/s².
    pub(super) acceleration: f64,
    /// Least position that may be commanded, m or rad.
    pub(super) lower: f64,
    /// Greatest position that may be commanded, m or rad.
    pub(super) upper: f64,
}

impl Bounds {
    /// Bounds that leave every position free.
    pub(super) const fn unlimited(speed: f64, acceleration: f64) -> Self {
        Self { speed, acceleration, lower: f64::NEG_INFINITY, upper: f64::INFINITY }
    }
}

/// Where an ideal axis is and how fast.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Setpoint {
    pub(crate) position: f64,
    pub(crate) velocity: f64,
}

impl Setpoint {
    /// The setpoint `dt_s` later on the way to a velocity: a ramp, then the velocity itself.
    pub(super) fn towards_velocity(self, wanted: f64, bounds: &Bounds, dt_s: f64) -> Self {
        let wanted = wanted.clamp(-bounds.speed, bounds.speed);
        let change = wanted - self.velocity;
        let ramp_s = change.abs() / bounds.acceleration;
        if ramp_s > dt_s {
            let velocity = self.velocity + bounds.acceleration.copysign(change) * dt_s;
            let position = self.position + 0.5 * (self.velocity + velocity) * dt_s;
            return Self { position, velocity };
        }
        let ramped = 0.5 * (self.velocity + wanted) * ramp_s;
        Self { position: self.position + ramped + wanted * (dt_s - ramp_s), velocity: wanted }
    }

    /// The setpoint `dt_s` later on the way to a stop at a position: a trapezoid of velocity.
    pub(super) fn towards_position(self, wanted: f64, bounds: &Bounds, dt_s: f64) -> Self {
        let per_period = bounds.acceleration * dt_s;
        let distance = wanted - self.position;
        if distance.abs() <= 0.5 * per_period * dt_s && self.velocity.abs() <= per_period {
            return Self { position: wanted, velocity: 0.0 };
        }
        let sign = 1.0_f64.copysign(distance);
        // the velocity v from which a stop still fits behind this period: (v0 + v) dt/2 + v²/2a = d
        let left = distance.abs() - 0.5 * self.velocity * sign * dt_s;
        let root = (0.25 * per_period * per_period + 2.0 * bounds.acceleration * left).max(0.0).sqrt();
        let stoppable = (root - 0.5 * per_period).clamp(0.0, bounds.speed);
        let velocity = (stoppable * sign).clamp(self.velocity - per_period, self.velocity + per_period);
        Self { position: self.position + 0.5 * (self.velocity + velocity) * dt_s, velocity }
    }

    /// This setpoint, held within `lag` of where the axis really is. Where it had to be held, it goes
    /// on from the axis's real velocity, so that a drive that was overpowered does not jump when free.
    pub(super) fn near(self, measured: f64, lag: f64, velocity: impl FnOnce() -> f64) -> Self {
        let position = self.position.clamp(measured - lag, measured + lag);
        if position == self.position { self } else { Self { position, velocity: velocity() } }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOUNDS: Bounds = Bounds::unlimited(0.25, 2.5);

    #[test]
    fn a_ramp_is_its_closed_form_at_any_period() {
        for dt_s in [0.001, 0.01, 0.03, 0.07] {
            let mut setpoint = Setpoint::default();
            for k in 1..=100 {
                setpoint = setpoint.towards_velocity(0.25, &BOUNDS, dt_s);
                let t = f64::from(k) * dt_s;
                let exact = if t < 0.1 { 0.5 * 2.5 * t * t } else { 0.0125 + 0.25 * (t - 0.1) };
                // a hundred additions of numbers below 2, each rounded to 2^-52
                assert!((setpoint.position - exact).abs() < 1e-13, "{dt_s} {k}");
            }
        }
    }

    #[test]
    fn a_position_is_reached_within_the_bounds_and_never_overshot() {
        for wanted in [0.3, 0.01, -0.2, 0.0004] {
            let (mut setpoint, mut turns) = (Setpoint::default(), 0);
            while setpoint != (Setpoint { position: wanted, velocity: 0.0 }) {
                let next = setpoint.towards_position(wanted, &BOUNDS, 0.01);
                assert!(next.velocity.abs() <= BOUNDS.speed);
                // one rounding of the velocity, at most 0.25
                assert!((next.velocity - setpoint.velocity).abs() <= BOUNDS.acceleration * 0.01 + 1e-16);
                assert!((wanted - next.position) * wanted.signum() >= -1e-15, "{wanted}: {next:?}");
                (setpoint, turns) = (next, turns + 1);
                assert!(turns < 200, "{wanted} is not reached: {setpoint:?}");
            }
            let distance = f64::abs(wanted);
            let least_s = if distance < 0.025 { 2.0 * (distance / 2.5).sqrt() } else { distance / 0.25 + 0.1 };
            let took_s = f64::from(turns) * 0.01;
            assert!(took_s < least_s + 0.05, "{wanted} took {took_s} s, could take {least_s} s");
        }
    }

    #[test]
    fn a_target_that_moves_behind_is_gone_back_to() {
        let mut setpoint = Setpoint { position: 0.0, velocity: 0.25 };
        for _ in 0..100 {
            setpoint = setpoint.towards_position(0.005, &BOUNDS, 0.01);
        }
        assert_eq!(setpoint, Setpoint { position: 0.005, velocity: 0.0 });
    }
}
