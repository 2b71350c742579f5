//! The block in a veneer lathe: what knife, nosebar, rolls and spindles make of it.
//!
//! # Equations
//! With the radius `r` at the knife, and thickness `t` the way of the knife in a turn:
//! - `dr = -t dφ/2π`, ribbon `dL = r dφ`, exact over a period in which knife and spindles keep their speeds, so that
//!   `L = π (r0² - r1²)/t`;
//! - at an angle θ behind the knife the surface is `r + t θ/2π` away from the centre;
//! - torque of the cut `M = k b t r`; where it is greater than `M_max` of the spindles at their pressure, they turn in the
//!   block, which stands: a spin-out, until the knife has gone back;
//! - bending between the ends `w = (F_rolls - F_nosebar) b³/(48 E I)`, `I = π r⁴/4`; rolls press by their stiffness,
//!   the nosebar by `1 - gap/t`.
//!
//! A block off the centre by `e` first gives waste, and a ribbon from `r - e` on.
//!
//! # Source
//! Geometry of the spiral in closed form; tracking, rolls and spin-out: Nyyssönen 2018, 2.1, 3.1.4, 3.3; a beam on two
//! supports with a load in the middle.

use std::f64::consts::PI;

use serde::{Deserialize, Serialize};

use crate::component::behaviour::{Component, Start, Turn};
use crate::component::declare::{failures, own_types, parameters, signals};
use crate::component::fluid::BAR_PA;

/// A slower spindle counts as standing, turns in a period.
const STANDING_TURNS: f64 = 1e-9;
/// A knife that has gone so far from the block ends a spin-out, m.
const CLEAR_M: f64 = 0.002;
/// Surfaces of the rolls lie so far behind the knife, rad.
const TOP_RAD: f64 = 0.5 * PI;
const BOTTOM_RAD: f64 = PI;
/// How far off the centre a block that is not round begins, m.
const OUT_OF_ROUND_M: f64 = 0.005;

parameters! {
    /// Block and lathe.
    Parameters {
        /// one unit of the axes of knife, nosebar and rolls
        unit_m: f64 = 1e-5 => 1e-9, 1.0;
        /// units of the spindles' axis that are one turn
        turn_units: f64 = 100.0 => 1e-6, 1e9;
        /// length of the block
        length_m: f64 = 1.3 => 0.01, 10.0;
        /// specific force of the cut, over the section of the ribbon
        cutting_bar: f64 = 60.0 => 0.0, 1e5;
        /// torque that the spindles hold at 100 % of their pressure
        torque_max_nm: f64 = 6000.0 => 0.0, 1e9;
        /// modulus of elasticity of the block
        elastic_bar: f64 = 1e5 => 1.0, 1e7;
        /// stiffness with which a roll presses
        roll_n_m: f64 = 1e6 => 0.0, 1e12;
        /// force of the nosebar over the length of the block at full compression
        nosebar_n_m: f64 = 20000.0 => 0.0, 1e9;
    }
}

signals! {
    /// Where the axes are.
    Inputs {
        /// the spindles hold a block
        held: bool,
        /// radius of a block that comes
        block_radius_m: f64,
        /// how far off the centre it is held
        off_centre_m: f64,
        /// speed of the spindles, units of their axis per second
        rotation: f64,
        /// knife, units from the centre
        knife: f64,
        /// gap between nosebar and knife, units
        gap: f64,
        /// top roll, units from the centre
        roll_top: f64,
        /// bottom roll, units from the centre
        roll_bottom: f64,
        /// pressure of the spindles
        pressing_pct: f64,
    }
}

signals! {
    /// Block and veneer.
    Outputs {
        /// radius of the block
        radius_m: f64,
        /// of the block while it was cut
        turns: f64,
        /// ribbon of this block
        veneer_m: f64,
        /// ribbon of all blocks
        total_m: f64,
        /// speed of the ribbon
        veneer_m_s: f64,
        /// speed of the block's surface
        surface_m_s: f64,
        /// thickness of the ribbon
        thickness_m: f64,
        /// torque of the cut
        torque_nm: f64,
        /// bending of the block between its ends, away from the rolls
        bending_m: f64,
        /// from the block's surface to the top roll
        gap_top_m: f64,
        /// from the block's surface to the bottom roll
        gap_bottom_m: f64,
        /// the knife cuts
        cutting: bool,
        /// the spindles turn in a block that stands
        spin_out: bool,
        /// the knife is pressed into a block that does not turn
        pressed: bool,
    }
}

failures! {
    /// What is wrong with the block.
    Failure {
        /// a wet block: twice the force of the cut
        Wet = "wet",
        /// a splinter in the gap: three times the force of the nosebar, and half as much again of the cut
        Splinter = "splinter",
        /// blocks that come are not round: 5 mm off the centre
        OutOfRound = "out_of_round",
    }
}

/// What it remembers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[expect(clippy::struct_excessive_bools, reason = "four states of the block that are independent of one another")]
pub(crate) struct State {
    held: bool,
    radius_m: f64,
    /// The ribbon is whole from this radius on.
    whole_m: f64,
    knife_m: f64,
    rotation: f64,
    turns: f64,
    veneer_m: f64,
    total_m: f64,
    veneer_m_s: f64,
    surface_m_s: f64,
    thickness_m: f64,
    torque_nm: f64,
    /// From the surface to the top and the bottom roll, and the bending, when the knife was there.
    gaps_m: [f64; 2],
    bending_m: f64,
    cutting: bool,
    spin_out: bool,
    pressed: bool,
}

/// A block in a lathe by its parameters.
pub(crate) struct VeneerLathe {
    p: Parameters,
}

/// What the knife takes off in a period.
struct Cut {
    /// Radius where it begins.
    from_m: f64,
    turns: f64,
    thickness_m: f64,
}

impl VeneerLathe {
    /// What the knife would take off, if the block turns with the spindles.
    fn cut(state: &State, knife_m: f64, turns: f64) -> Option<Cut> {
        if !state.held || knife_m >= state.radius_m {
            return None;
        }
        let from_m = state.radius_m.min(state.knife_m);
        let advance = state.knife_m - knife_m;
        // the knife may have reached the surface within the period
        let part = if advance > 0.0 { (from_m - knife_m) / advance } else { 1.0 };
        let turns = turns * part;
        let thickness_m = if turns > STANDING_TURNS { (from_m - knife_m).max(0.0) / turns } else { 0.0 };
        Some(Cut { from_m, turns, thickness_m })
    }

    fn torque_nm(&self, cut: &Cut, failed: &Turn) -> f64 {
        let wet = if failed.failed.has(Failure::Wet) { 2.0 } else { 1.0 };
        let splinter = if failed.failed.has(Failure::Splinter) { 1.5 } else { 1.0 };
        self.p.cutting_bar * BAR_PA * wet * splinter * self.p.length_m * cut.thickness_m * cut.from_m
    }

    fn load(state: &mut State, inputs: &Inputs, turn: &Turn) {
        let out_of_round = if turn.failed.has(Failure::OutOfRound) { OUT_OF_ROUND_M } else { 0.0 };
        let off_m = inputs.off_centre_m.abs() + out_of_round;
        state.radius_m = inputs.block_radius_m + off_m;
        state.whole_m = inputs.block_radius_m - off_m;
        (state.turns, state.veneer_m, state.spin_out) = (0.0, 0.0, false);
    }

    fn peel(state: &mut State, cut: &Cut, knife_m: f64, dt_s: f64) {
        state.cutting = true;
        state.turns += cut.turns;
        state.thickness_m = cut.thickness_m;
        let from_m = cut.from_m.min(state.whole_m);
        if from_m > knife_m {
            let turns = cut.turns * (from_m - knife_m) / (cut.from_m - knife_m);
            let ribbon_m = PI * (from_m + knife_m) * turns;
            state.veneer_m += ribbon_m;
            state.total_m += ribbon_m;
            state.veneer_m_s = ribbon_m / dt_s;
        }
        state.radius_m = knife_m;
    }

    /// Force of rolls and nosebar bends the block, m.
    fn bending_m(&self, state: &State, gaps_m: [f64; 2], gap_m: f64, splinter: bool) -> f64 {
        if !state.held || state.radius_m <= 0.0 {
            return 0.0;
        }
        let p = &self.p;
        let rolls_n: f64 = gaps_m.iter().map(|gap_m| p.roll_n_m * (-gap_m).max(0.0)).sum();
        let compression = if state.cutting && state.thickness_m > 0.0 {
            (1.0 - gap_m / state.thickness_m).clamp(0.0, 1.0)
        } else {
            0.0
        };
        let nosebar_n = p.nosebar_n_m * p.length_m * compression * if splinter { 3.0 } else { 1.0 };
        let square_m2 = state.radius_m * state.radius_m;
        let section_m4 = PI * square_m2 * square_m2 / 4.0;
        let cube_m3 = p.length_m * p.length_m * p.length_m;
        (rolls_n - nosebar_n) * cube_m3 / (48.0 * p.elastic_bar * BAR_PA * section_m4)
    }
}

impl Component for VeneerLathe {
    const NAME: &'static str = "veneer_lathe";
    const SUMMARY: &'static str = "block in a veneer lathe: radius, ribbon, torque, spin-out and bending";
    const FORMULA: &'static [&'static str] = &[
        "dr = -t dφ/2π, dL = r dφ, L = π (r0² - r1²)/t",
        "M = k b t r, spin-out where M > M_max p",
        "w = (F_rolls - F_nosebar) b³/(48 E I), I = π r⁴/4",
    ];
    const SOURCE: &'static str = "geometry of the spiral; Nyyssönen 2018, 2.1, 3.1.4, 3.3; a beam on two supports";
    own_types!();

    fn new(p: Parameters) -> Self {
        Self { p }
    }

    fn initial(&self, _: &Start) -> State {
        State::default()
    }

    fn drive(&self, state: &mut State, inputs: &Inputs, turn: &Turn) {
        if turn.dt_s <= 0.0 {
            return;
        }
        let p = &self.p;
        if inputs.held && !state.held {
            Self::load(state, inputs, turn);
        }
        state.held = inputs.held;
        let knife_m = inputs.knife * p.unit_m;
        let turns = 0.5 * (state.rotation + inputs.rotation).abs() / p.turn_units * turn.dt_s;
        (state.cutting, state.pressed, state.veneer_m_s) = (false, false, 0.0);
        (state.thickness_m, state.torque_nm) = (0.0, 0.0);
        if state.spin_out && (knife_m > state.radius_m + CLEAR_M || !state.held) {
            state.spin_out = false;
        }
        if let Some(cut) = Self::cut(state, knife_m, turns).filter(|_| !state.spin_out) {
            if cut.turns <= STANDING_TURNS {
                state.pressed = knife_m < state.knife_m;
            } else {
                state.torque_nm = self.torque_nm(&cut, turn);
                state.spin_out = state.torque_nm > p.torque_max_nm * inputs.pressing_pct.clamp(0.0, 100.0) / 100.0;
                if !state.spin_out {
                    Self::peel(state, &cut, knife_m, turn.dt_s);
                }
            }
        }
        let turning = state.held && !state.spin_out;
        state.surface_m_s = if turning { 2.0 * PI * state.radius_m * turns / turn.dt_s } else { 0.0 };
        (state.knife_m, state.rotation) = (knife_m, inputs.rotation);
        // of the same instant as the knife: a turn later it has gone on
        state.gaps_m = [(inputs.roll_top, TOP_RAD), (inputs.roll_bottom, BOTTOM_RAD)]
            .map(|(roll, behind_rad)| roll * p.unit_m - (state.radius_m + state.thickness_m * behind_rad / (2.0 * PI)));
        let splinter = turn.failed.has(Failure::Splinter);
        state.bending_m = self.bending_m(state, state.gaps_m, inputs.gap * p.unit_m, splinter);
    }

    fn sense(&self, state: &mut State, _: &Inputs, _: &Turn) -> Outputs {
        Outputs {
            radius_m: state.radius_m,
            turns: state.turns,
            veneer_m: state.veneer_m,
            total_m: state.total_m,
            veneer_m_s: state.veneer_m_s,
            surface_m_s: state.surface_m_s,
            thickness_m: state.thickness_m,
            torque_nm: state.torque_nm,
            bending_m: state.bending_m,
            gap_top_m: state.gaps_m[0],
            gap_bottom_m: state.gaps_m[1],
            cutting: state.cutting,
            spin_out: state.spin_out,
            pressed: state.pressed,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::tests::Rig;

    const HELD: Inputs = Inputs {
        held: true,
        block_radius_m: 0.1125,
        off_centre_m: 0.0,
        rotation: 500.0,
        knife: 12_000.0,
        gap: 130.0,
        roll_top: 30_000.0,
        roll_bottom: 30_000.0,
        pressing_pct: 100.0,
    };

    /// A place of the knife that whole periods end at, units.
    const WHOLE: f64 = 8002.5;

    fn rig() -> Rig<VeneerLathe> {
        Rig::new(VeneerLathe::new(Parameters::default()))
    }

    /// Peels with 5 turns a second and a thickness until the knife is at `to` units.
    fn peel(rig: &mut Rig<VeneerLathe>, inputs: Inputs, thickness: f64, to: f64) -> Outputs {
        let mut knife = inputs.knife;
        let mut out = rig.run(inputs, 0.01, 1);
        while knife > to {
            knife = (knife - 0.05 * thickness).max(to);
            out = rig.run(Inputs { knife, ..inputs }, 0.01, 1);
            if out.spin_out {
                break;
            }
        }
        out
    }

    #[test]
    fn the_ribbon_is_that_of_the_spiral() {
        // Ø225 to Ø62 at 1.5 mm: L = π (r0² - r1²)/t = 24.494 m, 54.333 turns
        let mut rig = rig();
        // 3097.5 units are the first whole number of periods behind the core's 3100
        let out = peel(&mut rig, HELD, 150.0, 3097.5);
        let ribbon_m = |core_m: f64| PI * (0.1125 * 0.1125 - core_m * core_m) / 0.0015;
        assert!((ribbon_m(0.031) - 24.494).abs() < 1e-3);
        assert!((out.veneer_m - ribbon_m(0.030_975)).abs() < 1e-9, "{} {}", out.veneer_m, ribbon_m(0.030_975));
        assert!((out.turns - (112.5 - 30.975) / 1.5).abs() < 1e-9, "{out:?}");
    }

    #[test]
    fn a_block_off_the_centre_gives_waste_first() {
        let centred = peel(&mut rig(), HELD, 150.0, 3100.0);
        let off = peel(&mut rig(), Inputs { off_centre_m: 0.004, ..HELD }, 150.0, 3100.0);
        let lost_m = PI * (0.1125 * 0.1125 - 0.1085 * 0.1085) / 0.0015;
        assert!((centred.veneer_m - off.veneer_m - lost_m).abs() < 0.05 && off.turns > centred.turns + 2.0);
    }

    #[test]
    fn too_little_pressure_is_a_spin_out_until_the_knife_is_back() {
        // 60 bar · 1.3 m · 1.5 mm · 0.1125 m = 1316 N·m; 6000 N·m at 100 %
        let held = |pressing_pct: f64| peel(&mut rig(), Inputs { pressing_pct, ..HELD }, 150.0, 11_000.0);
        assert!(!held(23.0).spin_out && held(21.0).spin_out);
        let mut wet = rig().failing(Failure::Wet);
        let out = peel(&mut wet, Inputs { pressing_pct: 40.0, ..HELD }, 150.0, 11_000.0);
        assert!(out.spin_out && out.surface_m_s == 0.0 && out.veneer_m_s == 0.0, "{out:?}");
        assert!(!wet.run(Inputs { knife: 11_500.0, ..HELD }, 0.01, 2).spin_out);
    }

    #[test]
    fn a_knife_in_a_standing_block_is_pressed_into_it() {
        let mut rig = rig();
        rig.run(Inputs { rotation: 0.0, ..HELD }, 0.01, 2);
        assert!(rig.run(Inputs { rotation: 0.0, knife: 11_000.0, ..HELD }, 0.01, 1).pressed);
        assert!(!rig.run(Inputs { rotation: 0.0, knife: 11_500.0, ..HELD }, 0.01, 1).pressed);
    }

    #[test]
    fn the_surface_is_a_spiral_and_rolls_bend_the_block_against_the_nosebar() {
        let at = |roll: f64| {
            let inputs = Inputs { roll_top: roll, roll_bottom: roll, ..HELD };
            peel(&mut rig(), inputs, 150.0, WHOLE)
        };
        let out = at(WHOLE + 100.0);
        // a quarter and half a turn behind the knife
        assert!((out.gap_top_m - (0.001 - 0.000_375)).abs() < 1e-9, "{out:?}");
        assert!((out.gap_bottom_m - (0.001 - 0.000_75)).abs() < 1e-9, "{out:?}");
        assert!(out.bending_m < 0.0, "the nosebar alone");
        assert!(at(WHOLE - 200.0).bending_m > 0.0, "rolls that press");
        let nosebar_n = 20_000.0 * 1.3 * (1.0 - 1.3 / 1.5);
        let square_m2 = WHOLE * 1e-5 * WHOLE * 1e-5;
        let exact_m = -nosebar_n * 1.3 * 1.3 * 1.3 / (48.0 * 1e10 * PI * square_m2 * square_m2 / 4.0);
        assert!((out.bending_m / exact_m - 1.0).abs() < 1e-9, "{} {exact_m}", out.bending_m);
    }

    #[test]
    fn each_failure_has_its_effect() {
        let splinter = peel(&mut rig().failing(Failure::Splinter), HELD, 150.0, WHOLE);
        let healthy = peel(&mut rig(), HELD, 150.0, WHOLE);
        assert!((splinter.torque_nm / healthy.torque_nm - 1.5).abs() < 1e-9);
        assert!((splinter.bending_m / healthy.bending_m - 3.0).abs() < 1e-9);
        assert!(peel(&mut rig().failing(Failure::OutOfRound), HELD, 150.0, WHOLE).veneer_m < healthy.veneer_m - 1.0);
    }
}
