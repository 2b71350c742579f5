//! What moves in time: lags, masses with friction and stops, sub-steps.

use serde::{Deserialize, Serialize};

pub(crate) use crate::effort::substeps;

use crate::effort::Motion;

/// A first-order lag, exact for an input that is constant over the period:
/// `x(t + dt) = u + (x(t) - u) exp(-dt / τ)`.
pub(crate) fn lag(value: f64, input: f64, time_constant_s: f64, dt_s: f64) -> f64 {
    if time_constant_s <= 0.0 {
        return if dt_s > 0.0 { input } else { value };
    }
    input + (value - input) * libm::exp(-dt_s / time_constant_s)
}

/// The multiple of a quantum that is nearest to a value; the value itself without a quantum.
pub(crate) fn quantised(value: f64, quantum: f64) -> f64 {
    if quantum > 0.0 { (value / quantum).round() * quantum } else { value }
}

/// A value on its way to another at a limited rate.
pub(crate) fn ramp(value: f64, wanted: f64, rate_1_s: f64, dt_s: f64) -> f64 {
    let step = rate_1_s * dt_s;
    value + (wanted - value).clamp(-step, step)
}

/// Whether a time has passed: a rounding less than it is not a reason to wait for another period.
pub(crate) fn is_over(since_s: f64, time_s: f64) -> bool {
    since_s >= time_s * (1.0 - 1e-12)
}

/// Which commands have risen since the last period, which `before` keeps.
pub(crate) fn rising<const N: usize>(before: &mut [bool; N], now: [bool; N]) -> [bool; N] {
    let before = std::mem::replace(before, now);
    std::array::from_fn(|command| now[command] && !before[command])
}

/// Switches after a condition has lasted for a time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct OnDelay {
    lasted_s: f64,
}

impl OnDelay {
    /// True if `condition` has held for `delay_s` by the end of this period.
    pub(crate) fn holds(&mut self, condition: bool, delay_s: f64, dt_s: f64) -> bool {
        self.lasted_s = if condition { self.lasted_s + dt_s } else { 0.0 };
        condition && is_over(self.lasted_s, delay_s)
    }

    /// True if `condition`, which holds for this period or not, has held for `delay_s` as it begins.
    pub(crate) fn has_held(&mut self, condition: bool, delay_s: f64, dt_s: f64) -> bool {
        let over = condition && is_over(self.lasted_s, delay_s);
        self.lasted_s = if condition { self.lasted_s + dt_s } else { 0.0 };
        over
    }
}

/// A mass on a line, or about an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Travel {
    pub(crate) position: f64,
    pub(crate) velocity: f64,
}

/// What a travelling mass meets.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Resistance {
    /// kg or kg·m²
    pub(crate) mass: f64,
    /// Coulomb friction, N or N·m.
    pub(crate) dry: f64,
    /// Viscous friction, N·s/m or N·m·s.
    pub(crate) viscous: f64,
    /// Stops, m or rad.
    pub(crate) range: (f64, f64),
}

impl Travel {
    /// Moves under a force for one sub-step: `m dv/dt = F - d v - F_c sgn(v)`.
    ///
    /// Viscous friction is taken implicitly and dry friction can stop the mass but never turn it,
    /// so the step is stable for any mass; first order in `dt_s`.
    pub(crate) fn push(&mut self, force: f64, resistance: &Resistance, dt_s: f64) {
        let Resistance { mass, dry, viscous, range } = *resistance;
        let free = (mass * self.velocity + force * dt_s) / (mass + viscous * dt_s);
        let braked = (free.abs() - dry * dt_s / (mass + viscous * dt_s)).max(0.0);
        self.velocity = braked.copysign(free);
        let reached = self.position + self.velocity * dt_s;
        self.position = reached.clamp(range.0, range.1);
        if self.position != reached {
            self.velocity = 0.0;
        }
    }

    /// Where a joint has it.
    pub(crate) fn of(motion: &Motion) -> Self {
        Self { position: motion.position, velocity: motion.velocity }
    }

    /// Where a joint has it, between stops.
    pub(crate) fn on_joint(motion: &Motion, range: (f64, f64)) -> Self {
        Self { position: motion.position.clamp(range.0, range.1), ..Self::of(motion) }
    }
}

/// What a mass in a body feels along three axes, through a lag of `lag_s`; at the first look as it is. If it `stands`, what
/// was felt before.
pub(crate) fn felt(before: &mut Option<[f64; 3]>, now: [f64; 3], lag_s: f64, dt_s: f64, stands: bool) -> [f64; 3] {
    let last = before.unwrap_or(now);
    let felt = if stands { last } else { [0, 1, 2].map(|axis| lag(last[axis], now[axis], lag_s, dt_s)) };
    *before = Some(felt);
    felt
}

/// By how much a spring's force falls with the velocity in a sub-step that is taken implicitly: for a
/// spring too stiff for the mass at its end, which would else swing up. For all others nothing: taken
/// semi-implicitly they keep their energy.
pub(crate) fn slope_of(stiffness: f64, motion: &Motion, dt_s: f64) -> f64 {
    if stiffness * dt_s * dt_s > motion.mass { stiffness * dt_s } else { 0.0 }
}

/// Whether a proximity switch sees what is so far away: within its switching distance, and by the
/// hysteresis beyond it as long as it sees it (IEC 60947-5-2, 7.2.1.6).
pub(crate) fn in_reach(distance_m: Option<f64>, seen: bool, switching_m: f64, hysteresis_pct: f64) -> bool {
    let reach_m = if seen { switching_m * (1.0 + 0.01 * hysteresis_pct) } else { switching_m };
    distance_m.is_some_and(|distance_m| distance_m <= reach_m)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lag_does_not_depend_on_the_period() {
        let mut value = 0.0;
        for _ in 0..100 {
            value = lag(value, 1.0, 0.3, 0.01);
        }
        // a hundred factors, each rounded to 2^-53
        assert!((value - (1.0 - libm::exp(-1.0 / 0.3))).abs() < 1e-13);
    }

    #[test]
    fn a_mass_falls_by_its_closed_form_and_halving_the_step_halves_the_error() {
        // m dv/dt = F - d v from rest: v = F/d (1 - exp(-d t / m))
        let resistance = Resistance { mass: 2.0, dry: 0.0, viscous: 3.0, range: (-1e9, 1e9) };
        let exact = 10.0 / 3.0 * (1.0 - libm::exp(-1.5));
        let errors: Vec<_> = [100, 200, 400]
            .iter()
            .map(|count| {
                let mut travel = Travel::default();
                for _ in 0..*count {
                    travel.push(10.0, &resistance, 1.0 / f64::from(*count));
                }
                (travel.velocity - exact).abs()
            })
            .collect();
        assert!(errors[0] < 0.01, "{errors:?}");
        // first order: the ratio tends to 2
        assert!(errors.windows(2).all(|pair| (pair[0] / pair[1] - 2.0).abs() < 0.05), "{errors:?}");
    }

    #[test]
    fn dry_friction_stops_a_mass_and_holds_it() {
        // v0² / 2a with a = 4 N / 2 kg
        let resistance = Resistance { mass: 2.0, dry: 4.0, viscous: 0.0, range: (-1e9, 1e9) };
        let mut travel = Travel { position: 0.0, velocity: 1.0 };
        for _ in 0..10_000 {
            travel.push(0.0, &resistance, 1e-4);
        }
        assert_eq!(travel.velocity, 0.0);
        // first order: half of the first step's way, 1e-4 m/2
        assert!((travel.position - 0.25).abs() < 1e-4, "{travel:?}");
        travel.push(3.9, &resistance, 1e-4);
        assert_eq!(travel.velocity, 0.0, "less than the friction moves nothing");
    }

    #[test]
    fn a_delay_is_over_on_time() {
        let mut delay = OnDelay::default();
        let on: Vec<_> = (0..5).map(|_| delay.holds(true, 0.03, 0.01)).collect();
        assert_eq!(on, [false, false, true, true, true]);
        assert!(!delay.holds(false, 0.03, 0.01));
        let begun: Vec<_> = (0..5).map(|_| delay.has_held(true, 0.03, 0.01)).collect();
        assert_eq!(begun, [false, false, false, true, true]);
        assert!(!delay.has_held(false, 0.03, 0.01) && delay.has_held(true, 0.0, 0.01));
    }
}
