//! Three phases on a neutral point that nothing holds: the currents of RMS phasors.

use rapier3d::na::{Complex, Matrix2, Vector2};

/// Phases of a three-phase system.
pub(crate) const PHASES: usize = 3;

/// Newton's iteration converges in fewer than 10 turns; more are a reason to stop.
const TURNS: u32 = 60;
/// Halvings of a turn that would make the sum of currents larger.
const HALVINGS: usize = 40;
/// The sum of currents that is taken as none, as a part of the short-circuit current.
const BALANCED: f64 = 1e-13;

/// What stands between a phase and the neutral point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Branch {
    /// Voltage of the arc, in phase with the current, V.
    pub(crate) arc_v: f64,
    pub(crate) resistance_ohm: f64,
    /// Reactance, Ω, greater than 0.
    pub(crate) reactance_ohm: f64,
}

impl Branch {
    fn impedance_ohm(&self) -> Complex<f64> {
        Complex::new(self.resistance_ohm, self.reactance_ohm)
    }

    /// `I` of `(V_a + R I)² + (X I)² = E²`; 0 where the arc holds all of the voltage.
    fn current_a(&self, across_v: f64) -> f64 {
        if across_v <= self.arc_v {
            return 0.0;
        }
        let square = self.impedance_ohm().norm_sqr();
        let against = self.arc_v * self.resistance_ohm;
        let room = across_v * across_v - self.arc_v * self.arc_v;
        ((against * against + square * room).sqrt() - against) / square
    }

    /// Current and its derivative by the real and imaginary part of the voltage over the branch.
    fn phasor(&self, across: Complex<f64>) -> (Complex<f64>, Matrix2<f64>) {
        let across_v = across.norm_sqr().sqrt();
        let current_a = self.current_a(across_v);
        if current_a <= 0.0 {
            return (Complex::new(0.0, 0.0), Matrix2::zeros());
        }
        let held = self.impedance_ohm() * current_a + self.arc_v;
        let admittance = Complex::from(current_a) / held;
        let square = self.impedance_ohm().norm_sqr();
        let growth = across_v / (square * current_a + self.arc_v * self.resistance_ohm);
        // y(e) = I/(V_a + Z I), so dy/de = V_a/(V_a + Z I)² · dI/de
        let bent = across * (Complex::from(self.arc_v * growth) / (held * held));
        let (along_re, along_im) = (across.re / across_v, across.im / across_v);
        let slope = Matrix2::new(
            admittance.re + bent.re * along_re,
            -admittance.im + bent.re * along_im,
            admittance.im + bent.im * along_re,
            admittance.re + bent.im * along_im,
        );
        (admittance * across, slope)
    }

    /// Two branches in series.
    fn and(&self, other: &Self) -> Self {
        Self {
            arc_v: self.arc_v + other.arc_v,
            resistance_ohm: self.resistance_ohm + other.resistance_ohm,
            reactance_ohm: self.reactance_ohm + other.reactance_ohm,
        }
    }
}

/// Currents in A of three phases with `phase_v` from each to the neutral point of a balanced load. A phase without a
/// branch carries nothing; nor does a phase alone.
pub(crate) fn currents_a(phase_v: f64, branches: &[Option<Branch>; PHASES]) -> [f64; PHASES] {
    match branches {
        [Some(one), Some(two), Some(three)] => star(phase_v, [*one, *two, *three]),
        [Some(one), Some(two), None] => series(phase_v, one, two, [1.0, 1.0, 0.0]),
        [Some(one), None, Some(three)] => series(phase_v, one, three, [1.0, 0.0, 1.0]),
        [None, Some(two), Some(three)] => series(phase_v, two, three, [0.0, 1.0, 1.0]),
        _ => [0.0; PHASES],
    }
}

fn series(phase_v: f64, one: &Branch, other: &Branch, carries: [f64; PHASES]) -> [f64; PHASES] {
    let current_a = one.and(other).current_a(phase_v * 3f64.sqrt());
    carries.map(|part| part * current_a)
}

/// The neutral point is where the sum of the currents is 0: Newton's iteration from the middle. Each branch takes more
/// power the more voltage it has, so there is one such point.
fn star(phase_v: f64, branches: [Branch; PHASES]) -> [f64; PHASES] {
    let half_root = 3f64.sqrt() / 2.0;
    let sources =
        [(1.0, 0.0), (-0.5, -half_root), (-0.5, half_root)].map(|(re, im)| Complex::new(re * phase_v, im * phase_v));
    let sum = |neutral: Complex<f64>| {
        let mut sum = (Complex::new(0.0, 0.0), Matrix2::zeros());
        for (source, branch) in sources.iter().zip(&branches) {
            let (current, slope) = branch.phasor(source - neutral);
            sum = (sum.0 + current, sum.1 + slope);
        }
        sum
    };
    let shorted_a = phase_v / branches.iter().map(|branch| branch.reactance_ohm).fold(f64::INFINITY, f64::min);
    let mut neutral = Complex::new(0.0, 0.0);
    for _ in 0..TURNS {
        let (left, slope) = sum(neutral);
        let size_a = left.norm_sqr().sqrt();
        let Some(step) = slope.lu().solve(&Vector2::new(left.re, left.im)) else { break };
        if size_a <= BALANCED * shorted_a {
            break;
        }
        let step = Complex::new(step.x, step.y);
        let shorter = std::iter::successors(Some(step), |step| Some(step * 0.5))
            .take(HALVINGS)
            .map(|step| neutral + step)
            .find(|next| sum(*next).0.norm_sqr().sqrt() < size_a);
        let Some(next) = shorter else { break };
        neutral = next;
    }
    std::array::from_fn(|phase| branches[phase].current_a((sources[phase] - neutral).norm_sqr().sqrt()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use onescan_server::random::Random;

    #[test]
    fn any_three_arcs_leave_no_current_over() {
        let mut random = Random::new(1);
        for _ in 0..2000 {
            let mut branch = || {
                let arc_v = if random.uniform() < 0.2 { 0.0 } else { 40.0 + 420.0 * random.uniform() };
                Branch {
                    arc_v,
                    resistance_ohm: 0.001 * random.uniform(),
                    reactance_ohm: 0.003 + 0.002 * random.uniform(),
                }
            };
            let branches = [branch(), branch(), branch()];
            let currents = currents_a(554.6, &branches.map(Some));
            // the largest is the sum of the others at most, and a phase out leaves two equal ones
            let largest = currents.iter().copied().fold(0.0, f64::max);
            let sum: f64 = currents.iter().sum();
            assert!(largest > 0.0 && 2.0 * largest <= sum * (1.0 + 1e-9), "{branches:?}: {currents:?}");
        }
    }

    #[test]
    fn an_arc_that_no_voltage_carries_leaves_the_others_in_series() {
        let arc = |arc_v| Some(Branch { arc_v, resistance_ohm: 0.0, reactance_ohm: 0.004 });
        let [one, two, three] = currents_a(554.6, &[arc(340.0), arc(340.0), arc(2000.0)]);
        let [alone, ..] = currents_a(554.6, &[arc(340.0), arc(340.0), None]);
        assert!(three == 0.0 && (one / alone - 1.0).abs() < 1e-9 && (two / alone - 1.0).abs() < 1e-9, "{one} {two}");
        assert_eq!(currents_a(554.6, &[arc(100.0), None, None]), [0.0; 3]);
    }
}
