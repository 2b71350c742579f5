//! The electric circuit of an arc furnace: tap changer, breaker, reactance and three arcs on one bath.
//!
//! # Equations
//! Values are RMS of the fundamental. The bath is a neutral point that nothing holds, so a phase is felt by the others:
//! - an arc of length `L` has the voltage `V_a = V_0 + G L`, in phase with its current; an electrode that touches has none;
//! - a phase with the voltage `E` over it carries `I` with `(V_a + R I)² + (X I)² = E²`, and nothing if `E ≤ V_a`;
//! - `Σ I = 0` places the neutral point. With three equal arcs it stands still, so `P = 3 (V_a + R I) I`, and without
//!   resistance `I = √(V² - V_a²)/X`.
//!
//! An arc is struck by touching, and goes out when the voltage over it does not carry it. A phase alone carries nothing.
//!
//! # Source
//! Closed form; sizes of the furnace: `[Vergnano]` sec. 4 (90 MW at 60 kA).

use onescan_server::random::Random;
use serde::{Deserialize, Serialize};

use crate::component::behaviour::{Component, Conflict, Start, Turn};
use crate::component::declare::{failures, own_types, parameters, signals};
use crate::component::dynamics::{lag, ramp};
use crate::component::three_phase::{Branch, PHASES, currents_a};

/// J in a kWh.
const KWH_J: f64 = 3.6e6;

parameters! {
    /// Transformer, conductors and arcs.
    Parameters {
        /// voltage between two phases at the highest tap
        highest_v: f64 = 960.6 => 10.0, 3000.0;
        /// voltage between two phases at tap 1
        lowest_v: f64 = 600.0 => 10.0, 3000.0;
        /// number of taps, with equal steps between them
        taps: u32 = 6 => 1, 40;
        /// time of the tap changer from one tap to the next
        tap_time_s: f64 = 3.0 => 0.0, 60.0;
        /// reactance of a phase
        reactance_ohm: f64 = 0.004 => 1e-6, 1.0;
        /// resistance of a phase up to the arc
        resistance_ohm: f64 = 0.0 => 0.0, 1.0;
        /// voltage of an arc without length
        drop_v: f64 = 40.0 => 0.0, 200.0;
        /// what a metre of arc adds
        gradient_v_m: f64 = 1000.0 => 1.0, 1e5;
        /// an arc is struck where an electrode is closer than this
        strike_m: f64 = 0.002 => 0.0, 0.1;
        /// how far an arc strays from its length, as a standard deviation
        stray_m: f64 = 0.0 => 0.0, 1.0;
        /// how long it strays in one direction
        stray_s: f64 = 0.2 => 1e-3, 60.0;
    }
}

signals! {
    /// What it takes.
    Inputs {
        /// breaker of the furnace
        on: bool,
        /// tap that is wanted, 1 is the lowest voltage
        tap: i32 = 1,
        /// length of the arc of phase 1
        arc_1_m: f64 = 10.0,
        /// length of the arc of phase 2
        arc_2_m: f64 = 10.0,
        /// length of the arc of phase 3
        arc_3_m: f64 = 10.0,
    }
}

signals! {
    /// What it gives.
    Outputs {
        /// current of phase 1
        current_1_a: f64,
        /// current of phase 2
        current_2_a: f64,
        /// current of phase 3
        current_3_a: f64,
        /// voltage from electrode 1 to the bath, that of its phase where there is no arc and it does not touch
        voltage_1_v: f64,
        /// voltage from electrode 2 to the bath
        voltage_2_v: f64,
        /// voltage from electrode 3 to the bath
        voltage_3_v: f64,
        /// power of arc 1
        arc_1_w: f64,
        /// power of arc 2
        arc_2_w: f64,
        /// power of arc 3
        arc_3_w: f64,
        /// power of the three arcs
        arc_w: f64,
        /// mean length of the arcs that burn
        arc_m: f64,
        /// real power, with what the conductors lose
        power_w: f64,
        /// reactive power
        reactive_var: f64,
        /// real over apparent power, 0 without a current
        power_factor: f64,
        /// real energy since the start
        energy_kwh: f64,
        /// tap that is reached
        tap_reached: i32,
        /// the breaker is closed
        closed: bool,
    }
}

failures! {
    /// How it fails.
    Failure {
        /// the breaker does not open any more once it is closed
        BreakerWelded = "breaker_welded",
        /// the breaker does not close
        BreakerOpen = "breaker_open",
        /// the tap changer stays where it is
        TapStuck = "tap_stuck",
        /// phase 2 is broken
        PhaseLost = "phase_lost",
        /// the arc of phase 1 is blown out as soon as it does not touch
        ArcLost = "arc_lost",
    }
}

/// What it remembers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    closed: bool,
    /// Tap, between two while it moves.
    tap: f64,
    /// Which arcs burn.
    lit: [bool; PHASES],
    /// How far each arc has strayed, in standard deviations.
    strayed: [f64; PHASES],
    random: Random,
    current_a: [f64; PHASES],
    voltage_v: [f64; PHASES],
    energy_j: f64,
}

/// A circuit by its parameters.
pub(crate) struct ArcCircuit {
    p: Parameters,
}

impl ArcCircuit {
    /// Voltage from a phase to the neutral point of a balanced load.
    fn phase_v(&self, tap: f64) -> f64 {
        let steps = f64::from(self.p.taps.saturating_sub(1)).max(1.0);
        let between = (tap - 1.0) / steps;
        (self.p.lowest_v + between * (self.p.highest_v - self.p.lowest_v)) / 3f64.sqrt()
    }

    fn mean_m(state: &State, lengths_m: [f64; PHASES]) -> f64 {
        let burning =
            || lengths_m.iter().zip(&state.lit).filter(|(_, lit)| **lit).map(|(length_m, _)| length_m.max(0.0));
        let count = burning().map(|_| 1.0).sum::<f64>();
        if count > 0.0 { burning().sum::<f64>() / count } else { 0.0 }
    }

    /// What an arc of this length holds against its current.
    fn arc_v(&self, length_m: f64) -> f64 {
        if length_m <= 0.0 { 0.0 } else { self.p.drop_v + self.p.gradient_v_m * length_m }
    }

    fn switch(&self, state: &mut State, inputs: &Inputs, turn: &Turn) {
        let welded = state.closed && turn.failed.has(Failure::BreakerWelded);
        state.closed = welded || (inputs.on && !turn.failed.has(Failure::BreakerOpen));
        let highest = i32::try_from(self.p.taps).unwrap_or(i32::MAX);
        let wanted = f64::from(inputs.tap.clamp(1, highest));
        if self.p.tap_time_s <= 0.0 {
            state.tap = if turn.failed.has(Failure::TapStuck) { state.tap } else { wanted };
        } else if !turn.failed.has(Failure::TapStuck) {
            state.tap = ramp(state.tap, wanted, 1.0 / self.p.tap_time_s, turn.dt_s);
        }
    }

    /// The tap whose contacts carry the current: the next one takes over when the changer is there.
    fn contact(state: &State) -> f64 {
        state.tap.floor()
    }

    /// Lengths with what the arcs stray. An electrode that touches, touches.
    fn lengths_m(&self, state: &mut State, inputs: &Inputs, dt_s: f64) -> [f64; PHASES] {
        let set = [inputs.arc_1_m, inputs.arc_2_m, inputs.arc_3_m];
        if self.p.stray_m <= 0.0 {
            return set;
        }
        let kept = libm::exp(-dt_s / self.p.stray_s);
        for strayed in &mut state.strayed {
            *strayed = lag(*strayed, 0.0, self.p.stray_s, dt_s) + (1.0 - kept * kept).sqrt() * state.random.normal();
        }
        std::array::from_fn(|phase| {
            let length_m = set[phase];
            if length_m <= 0.0 { length_m } else { (length_m + self.p.stray_m * state.strayed[phase]).max(0.0) }
        })
    }

    /// Voltage of electrodes that carry nothing: by it a regulator feels that one touches before the others do.
    fn open_v(&self, closed: bool, phase_v: f64, lengths_m: [f64; PHASES], turn: &Turn) -> [f64; PHASES] {
        std::array::from_fn(|phase| {
            let live = closed && !(phase == 1 && turn.failed.has(Failure::PhaseLost));
            if live && lengths_m[phase] > self.p.strike_m { phase_v } else { 0.0 }
        })
    }

    /// Which phases may carry a current, by what touches and what burnt before.
    fn branches(&self, state: &State, lengths_m: [f64; PHASES], turn: &Turn) -> [Option<Branch>; PHASES] {
        std::array::from_fn(|phase| {
            let touches = lengths_m[phase] <= self.p.strike_m;
            let blown = phase == 0 && turn.failed.has(Failure::ArcLost) && lengths_m[phase] > 0.0;
            let broken = phase == 1 && turn.failed.has(Failure::PhaseLost);
            let carries = state.closed && (touches || state.lit[phase]) && !blown && !broken;
            carries.then(|| Branch {
                arc_v: self.arc_v(lengths_m[phase]),
                resistance_ohm: self.p.resistance_ohm,
                reactance_ohm: self.p.reactance_ohm,
            })
        })
    }
}

impl Component for ArcCircuit {
    const NAME: &'static str = "arc_circuit";
    const SUMMARY: &'static str = "three arcs on one bath, behind a breaker, a tap changer and a reactance";
    const FORMULA: &'static [&'static str] = &[
        "V_a = V_0 + G L; nothing where an electrode touches",
        "(V_a + R I)² + (X I)² = E², no current where E ≤ V_a",
        "Σ I = 0 in the neutral point, which nothing holds",
    ];
    const SOURCE: &'static str = "closed form; sizes: Vergnano et al., 2012, sec. 4";
    own_types!();

    fn new(p: Parameters) -> Self {
        Self { p }
    }

    fn conflict(p: &Parameters) -> Option<Conflict> {
        (p.lowest_v > p.highest_v).then_some(Conflict { key: "lowest_v", wanted: "at most highest_v" })
    }

    fn initial(&self, start: &Start) -> State {
        State {
            closed: false,
            tap: 1.0,
            lit: [false; PHASES],
            strayed: [0.0; PHASES],
            random: Random::new(start.seed),
            current_a: [0.0; PHASES],
            voltage_v: [0.0; PHASES],
            energy_j: 0.0,
        }
    }

    fn drive(&self, state: &mut State, inputs: &Inputs, turn: &Turn) {
        self.switch(state, inputs, turn);
        let lengths_m = self.lengths_m(state, inputs, turn.dt_s);
        let branches = self.branches(state, lengths_m, turn);
        let phase_v = self.phase_v(Self::contact(state));
        let open_v = self.open_v(state.closed, phase_v, lengths_m, turn);
        state.current_a = currents_a(phase_v, &branches);
        for phase in 0..PHASES {
            let current_a = state.current_a[phase];
            state.lit[phase] = current_a > 0.0;
            state.voltage_v[phase] = if current_a > 0.0 { self.arc_v(lengths_m[phase]) } else { open_v[phase] };
        }
        state.energy_j += self.power_w(state) * turn.dt_s;
    }

    fn sense(&self, state: &mut State, inputs: &Inputs, _: &Turn) -> Outputs {
        let [current_1_a, current_2_a, current_3_a] = state.current_a;
        let [voltage_1_v, voltage_2_v, voltage_3_v] = state.voltage_v;
        let arcs_w: [f64; PHASES] = std::array::from_fn(|phase| state.voltage_v[phase] * state.current_a[phase]);
        let [arc_1_w, arc_2_w, arc_3_w] = arcs_w;
        let power_w = self.power_w(state);
        let reactive_var = self.p.reactance_ohm * squares(state.current_a);
        let apparent_va = (power_w * power_w + reactive_var * reactive_var).sqrt();
        Outputs {
            current_1_a,
            current_2_a,
            current_3_a,
            voltage_1_v,
            voltage_2_v,
            voltage_3_v,
            arc_1_w,
            arc_2_w,
            arc_3_w,
            arc_w: arcs_w.iter().sum(),
            arc_m: Self::mean_m(state, [inputs.arc_1_m, inputs.arc_2_m, inputs.arc_3_m]),
            power_w,
            reactive_var,
            power_factor: if apparent_va > 0.0 { power_w / apparent_va } else { 0.0 },
            energy_kwh: state.energy_j / KWH_J,
            #[expect(clippy::cast_possible_truncation, reason = "a tap is between 1 and 40")]
            tap_reached: Self::contact(state) as i32,
            closed: state.closed,
        }
    }
}

impl ArcCircuit {
    fn power_w(&self, state: &State) -> f64 {
        let arcs_w: f64 = (0..PHASES).map(|phase| state.voltage_v[phase] * state.current_a[phase]).sum();
        arcs_w + self.p.resistance_ohm * squares(state.current_a)
    }
}

/// `Σ I²`, A².
fn squares(current_a: [f64; PHASES]) -> f64 {
    current_a.iter().map(|current| current * current).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::tests::Rig;

    /// Without steps of the tap changer.
    fn rig(mut p: Parameters) -> Rig<ArcCircuit> {
        p.tap_time_s = 0.0;
        Rig::new(ArcCircuit::new(p))
    }

    fn inputs(tap: i32, lengths_m: [f64; 3]) -> Inputs {
        Inputs { on: true, tap, arc_1_m: lengths_m[0], arc_2_m: lengths_m[1], arc_3_m: lengths_m[2] }
    }

    /// Strikes three arcs, and draws them to these lengths.
    fn struck(rig: &mut Rig<ArcCircuit>, tap: i32, lengths_m: [f64; 3]) -> Outputs {
        rig.run(inputs(tap, [0.0; 3]), 0.01, 1);
        rig.run(inputs(tap, lengths_m), 0.01, 1)
    }

    #[test]
    fn current_and_power_follow_the_impedance_at_each_tap_and_length() {
        for tap in 1..=6 {
            for k in 1..=7 {
                let length_m = 0.05 * f64::from(k);
                let out = struck(&mut rig(Parameters::default()), tap, [length_m; 3]);
                let phase_v = (600.0 + f64::from(tap - 1) * 360.6 / 5.0) / 3f64.sqrt();
                let arc_v = 40.0 + 1000.0 * length_m;
                let expected_a = if phase_v > arc_v { (phase_v * phase_v - arc_v * arc_v).sqrt() / 0.004 } else { 0.0 };
                assert!((out.current_1_a - expected_a).abs() <= 1e-9 * phase_v / 0.004, "{tap} {length_m} {out:?}");
                if expected_a > 0.0 {
                    let ohm = arc_v / expected_a;
                    let by_impedance_w = 3.0 * expected_a * expected_a * ohm;
                    assert!((out.power_w / by_impedance_w - 1.0).abs() < 1e-9, "{out:?}");
                    assert!((phase_v / (ohm * ohm + 1.6e-5).sqrt() / expected_a - 1.0).abs() < 1e-9);
                }
            }
        }
    }

    #[test]
    fn ninety_megawatts_at_sixty_kiloamperes_and_the_greatest_power() {
        let out = struck(&mut rig(Parameters::default()), 6, [0.46; 3]);
        assert!((out.current_2_a - 60e3).abs() < 20.0 && (out.power_w - 90e6).abs() < 30e3, "{out:?}");
        assert!((out.power_factor - 0.9015).abs() < 1e-4, "{out:?}");
        // an electrode on the scrap: nothing but the reactance
        let shorted = rig(Parameters::default()).run(inputs(6, [0.0; 3]), 0.01, 1);
        assert!((shorted.current_3_a - 138.65e3).abs() < 10.0 && shorted.power_w == 0.0, "{shorted:?}");
        // R = X: V_a = V/√2
        let greatest_m = (960.6 / 6f64.sqrt() - 40.0) / 1000.0;
        let [below, at, above] = [greatest_m - 0.01, greatest_m, greatest_m + 0.01]
            .map(|length_m| struck(&mut rig(Parameters::default()), 6, [length_m; 3]));
        assert!((at.power_w - 115.35e6).abs() < 0.02e6 && (at.current_1_a - 98.04e3).abs() < 20.0, "{at:?}");
        assert!(below.power_w < at.power_w && above.power_w < at.power_w);
    }

    #[test]
    fn arcs_of_different_length_feel_each_other_and_nothing_stays_in_the_neutral_point() {
        let mut equal = rig(Parameters::default());
        let before = struck(&mut equal, 6, [0.3; 3]);
        let after = equal.run(inputs(6, [0.3, 0.3, 0.4]), 0.01, 1);
        assert!(after.current_3_a < before.current_3_a && after.current_1_a != before.current_1_a, "{after:?}");
        // one touches while two burn
        let shorted = equal.run(inputs(6, [0.0, 0.3, 0.3]), 0.01, 1);
        assert!(shorted.current_1_a > shorted.current_2_a && shorted.arc_1_w == 0.0, "{shorted:?}");
    }

    #[test]
    fn with_a_lost_phase_two_arcs_are_in_series() {
        let mut rig = rig(Parameters::default()).failing(Failure::PhaseLost);
        let out = struck(&mut rig, 6, [0.3; 3]);
        let expected_a = (960.6f64 * 960.6 - 680.0 * 680.0).sqrt() / 0.008;
        assert!((out.current_1_a - expected_a).abs() < 1e-6 && out.current_2_a == 0.0, "{out:?}");
        assert_eq!(out.current_1_a, out.current_3_a);
    }

    #[test]
    fn an_arc_too_long_goes_out_and_is_struck_by_touching() {
        let mut rig = rig(Parameters::default());
        assert!(struck(&mut rig, 6, [0.6; 3]).current_1_a == 0.0);
        assert!(rig.run(inputs(6, [0.3; 3]), 0.01, 1).current_1_a == 0.0, "nothing strikes it");
        assert!(struck(&mut rig, 6, [0.3; 3]).current_1_a > 0.0);
        let off = rig.run(Inputs { on: false, ..inputs(6, [0.0; 3]) }, 0.01, 1);
        assert!(off.current_1_a == 0.0 && !off.closed);
    }

    #[test]
    fn the_tap_changer_takes_its_time_and_energy_is_counted() {
        let mut slow = Rig::new(ArcCircuit::new(Parameters::default()));
        assert_eq!(slow.run(inputs(6, [0.3; 3]), 0.01, 1499).tap_reached, 5);
        assert_eq!(slow.run(inputs(6, [0.3; 3]), 0.01, 2).tap_reached, 6);
        let mut rig = rig(Parameters::default());
        let power_w = struck(&mut rig, 6, [0.46; 3]).power_w;
        let out = rig.run(inputs(6, [0.46; 3]), 0.01, 359_999);
        assert!((out.energy_kwh / (power_w / 1000.0) - 1.0).abs() < 1e-9, "{out:?}");
    }

    #[test]
    fn arcs_stray_about_their_length_by_the_seed() {
        let mut rig = rig(Parameters { stray_m: 0.02, ..Parameters::default() });
        struck(&mut rig, 6, [0.3; 3]);
        let (mut sum, mut squares) = (0.0, 0.0);
        for _ in 0..20_000 {
            let length_m = (rig.run(inputs(6, [0.3; 3]), 0.01, 1).voltage_1_v - 40.0) / 1000.0 - 0.3;
            (sum, squares) = (sum + length_m, squares + length_m * length_m);
        }
        // 200 s hold 500 times 2 τ: 5 σ of the mean are 0.02·5/√500
        assert!((sum / 20_000.0).abs() < 0.0045 && ((squares / 20_000.0).sqrt() / 0.02 - 1.0).abs() < 0.2);
    }
}
