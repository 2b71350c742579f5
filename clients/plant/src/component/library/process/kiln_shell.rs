//! The shell of a rotary kiln in its riding ring: both turn, the shell a little slower, and a cam on each passes a switch.
//!
//! # Equations
//! The ring drives the shell by friction, and the shell lags. The lag is stated as a gap `δ`, as a kiln's creep is:
//! - in each of its turns the shell of diameter `D` is left behind by `πδ` along its circumference;
//! - so `T_shell/T_ring = 1 + δ/D`.
//!
//! A shell that is bent runs out: its axis is off by `e(x) = a·exp(−(x−x_b)²/2w²)` towards the angle `φ_b` of its own, so that
//! where `φ` passes who looks at it, the surface at the bend is nearer by `r = e·cos ψ + √(R² − e²·sin²ψ) − R`, `ψ = φ_b − φ`
//! ([`Bend`]). The run-out does not act on creep or cams: rings and piers hold the shell as if it were straight.
//!
//! A switch sees its cam while the angle of ring or shell is less than the cam's width, so for `T·width/360°` of each turn.
//! Angles are kept within a turn, with whole turns beside them: after months a turn is as fine as at the start.
//!
//! # Source
//! Closed form; drive by friction, two inductive switches, their quotient as the slip: the thesis on the shell scanner
//! *Jacket*, 2009, ch. 14; faults of the shell: ch. 2.2.

use std::f64::consts::PI;

use serde::{Deserialize, Serialize};

use crate::bend::Bend;
use crate::component::behaviour::{Component, Start, Turn};
use crate::component::declare::{failures, own_types, parameters, signals};
use crate::coupling::Bends;

/// Seconds of an hour.
const HOUR_S: f64 = 3600.0;
const TURN_DEG: f64 = 360.0;

parameters! {
    /// Kiln and cams.
    Parameters {
        /// outer diameter of the shell
        shell_m: f64 = 4.0 => 0.1, 20.0;
        /// lag of the shell, as the gap between its diameter and the ring's
        gap_m: f64 = 0.016 => 0.0, 1.0;
        /// how far the cam of the ring reaches
        ring_cam_deg: f64 = 6.0 => 0.0, 360.0;
        /// how far the cam of the shell reaches
        shell_cam_deg: f64 = 3.0 => 0.0, 360.0;
        /// how far the cam of the ring is behind its switch at the start
        ring_start_deg: f64 = 300.0 => 0.0, 360.0;
        /// how far the cam of the shell is behind its switch at the start
        shell_start_deg: f64 = 300.0 => 0.0, 360.0;
        /// a bent shell: how far its axis is off where that is most
        bend_m: f64 = 0.0 => 0.0, 1.0;
        /// a bent shell: where that is along the kiln
        bend_at_m: f64 = 30.0 => 0.0, 300.0;
        /// a bent shell: towards which angle of the shell
        bend_at_deg: f64 = 0.0 => -360.0, 360.0;
        /// a bent shell: standard deviation along the kiln
        bend_width_m: f64 = 15.0 => 0.1, 300.0;
        /// a shell that has been bent: by how much its axis is further off
        bent_more_m: f64 = 0.1 => 0.0, 1.0;
    }
}

signals! {
    /// The drive.
    Inputs {
        /// revolutions of the ring per hour, 30 to 250 in operation
        speed_turns_h: f64,
    }
}

signals! {
    /// What is seen of it.
    Outputs {
        /// the switch at the ring sees its cam
        ring_switch: bool,
        /// the switch at the shell sees its cam
        shell_switch: bool,
        /// angle of the shell within its turn
        shell_rad: f64,
        /// turns of the ring since the start
        ring_turns: f64,
        /// turns of the shell since the start
        shell_turns: f64,
        /// by how much the shell has crept back, along its circumference
        creep_m: f64,
        /// by how much the surface is nearer to who looks at it, at the bend
        run_out_m: f64,
    }
}

failures! {
    /// What is wrong with it.
    Failure {
        /// the ring slides: it turns, and the shell stands
        Sliding = "sliding",
        /// the switch at the ring is dead
        RingSwitchDead = "ring_switch_dead",
        /// the switch at the shell is dead
        ShellSwitchDead = "shell_switch_dead",
        /// the shell has been bent: it runs out
        Bent = "bent",
    }
}

/// An angle that grows for months: whole turns, and the part of one.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Angle {
    whole: u64,
    /// Of a turn, at least 0 and less than 1.
    part: f64,
}

impl Angle {
    fn from_degrees(degrees: f64) -> Self {
        Self { whole: 0, part: (degrees / TURN_DEG).fract() }
    }

    /// Goes on by so many turns, which are not negative.
    fn advance(&mut self, turns: f64) {
        let part = self.part + turns;
        let whole = part.floor();
        self.part = part - whole;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a whole number of turns of a period")]
        let whole = whole as u64;
        self.whole = self.whole.saturating_add(whole);
    }

    fn turns(&self) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "2^53 turns are more than a kiln makes")]
        let whole = self.whole as f64;
        whole + self.part
    }

    fn is_within(&self, width_deg: f64) -> bool {
        self.part * TURN_DEG < width_deg
    }
}

/// Where ring and shell are.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    ring: Angle,
    shell: Angle,
    /// Turns by which the shell is behind the ring.
    behind: f64,
    /// How far the axis of the shell is off, m.
    off_m: f64,
}

/// A kiln by its parameters.
pub(crate) struct KilnShell {
    p: Parameters,
}

impl KilnShell {
    fn bend(&self, off_m: f64) -> Bend {
        let p = &self.p;
        Bend { off_m, at_m: p.bend_at_m, width_m: p.bend_width_m, at_rad: p.bend_at_deg.to_radians() }
    }
}

impl Component for KilnShell {
    const NAME: &'static str = "kiln_shell";
    const SUMMARY: &'static str = "rotary kiln: shell in its riding ring, with creep and run-out, and a switch at each";
    const FORMULA: &'static [&'static str] = &[
        "creep πδ a turn of the shell",
        "T_shell/T_ring = 1 + δ/D",
        "switch on for T·width/360°",
        "bent: axis off by e(x) = a exp(-(x - x_b)²/2w²) towards φ_b",
        "nearer by r = e cos ψ + (R² - e² sin²ψ)^½ - R, ψ = φ_b - φ",
    ];
    const SOURCE: &'static str = "closed form; Jacket, 2009, ch. 14, faults ch. 2.2";
    const INITIAL: &'static [&'static str] = &["ring_start_deg", "shell_start_deg"];
    own_types!(moves Bends);

    fn new(p: Parameters) -> Self {
        Self { p }
    }

    fn initial(&self, _: &Start) -> State {
        State {
            ring: Angle::from_degrees(self.p.ring_start_deg),
            shell: Angle::from_degrees(self.p.shell_start_deg),
            behind: 0.0,
            off_m: self.p.bend_m,
        }
    }

    fn drive(&self, state: &mut State, inputs: &Inputs, turn: &Turn) {
        let ring = inputs.speed_turns_h.max(0.0) / HOUR_S * turn.dt_s;
        let shell =
            if turn.failed.has(Failure::Sliding) { 0.0 } else { ring / (1.0 + self.p.gap_m / self.p.shell_m) };
        state.ring.advance(ring);
        state.shell.advance(shell);
        state.behind += ring - shell;
        let more_m = if turn.failed.has(Failure::Bent) { self.p.bent_more_m } else { 0.0 };
        state.off_m = self.p.bend_m + more_m;
    }

    fn effect(&self, state: &State) -> Bend {
        self.bend(state.off_m)
    }

    fn sense(&self, state: &mut State, _: &Inputs, turn: &Turn) -> Outputs {
        let sees = |angle: &Angle, cam_deg: f64, dead| angle.is_within(cam_deg) && !turn.failed.has(dead);
        let shell_rad = 2.0 * PI * state.shell.part;
        Outputs {
            ring_switch: sees(&state.ring, self.p.ring_cam_deg, Failure::RingSwitchDead),
            shell_switch: sees(&state.shell, self.p.shell_cam_deg, Failure::ShellSwitchDead),
            shell_rad,
            ring_turns: state.ring.turns() - Angle::from_degrees(self.p.ring_start_deg).part,
            shell_turns: state.shell.turns() - Angle::from_degrees(self.p.shell_start_deg).part,
            creep_m: PI * self.p.shell_m * state.behind,
            run_out_m: self.bend(state.off_m).nearer_m(self.p.bend_at_m, shell_rad, self.p.shell_m / 2.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::tests::Rig;

    /// A turn a minute.
    const MINUTE: Inputs = Inputs { speed_turns_h: 60.0 };

    fn rig() -> Rig<KilnShell> {
        Rig::new(KilnShell::new(Parameters::default()))
    }

    #[test]
    fn the_shell_creeps_by_the_gap() {
        let out = rig().run(MINUTE, 0.01, 600_000);
        assert!((out.ring_turns - 100.0).abs() < 1e-6, "{out:?}");
        assert!((out.shell_turns - 100.0 / 1.004).abs() < 1e-6, "{out:?}");
        assert!((out.creep_m - PI * 0.016 * out.shell_turns).abs() < 1e-6, "{out:?}");
    }

    #[test]
    fn a_start_behind_a_whole_turn_is_one_at_the_switch() {
        let whole = Parameters { ring_start_deg: 360.0, ..Parameters::default() };
        let out = Rig::new(KilnShell::new(whole)).run(Inputs { speed_turns_h: 0.0 }, 0.01, 1);
        assert!(out.ring_turns == 0.0 && out.ring_switch, "{out:?}");
    }

    #[test]
    fn switches_see_their_cams_for_their_part_of_a_turn() {
        let mut rig = rig();
        let (mut ring, mut shell, mut before) = (0, 0, false);
        let mut edges = Vec::new();
        for step in 0..20_000 {
            let out = rig.run(MINUTE, 0.01, 1);
            if out.shell_switch && !before {
                edges.push(step);
            }
            before = out.shell_switch;
            if step < 12_000 {
                ring += i32::from(out.ring_switch);
                shell += i32::from(out.shell_switch);
            }
        }
        // two passes each: 6° of 60 s are 1 s, 3° of 60.24 s are 0.502 s, to a step
        assert!((ring - 200).abs() <= 2 && (shell - 100).abs() <= 2, "{ring} {shell}");
        assert!((edges[1] - edges[0] - 6024i32).abs() <= 1, "{edges:?}");
    }

    #[test]
    fn a_ring_that_slides_leaves_the_shell_and_a_dead_switch_sees_nothing() {
        let out = rig().failing(Failure::Sliding).run(MINUTE, 0.1, 6000);
        assert!(out.shell_turns == 0.0 && (out.ring_turns - 10.0).abs() < 1e-9, "{out:?}");
        let mut dead = rig().failing(Failure::ShellSwitchDead);
        assert!((0..2000).all(|_| !dead.run(MINUTE, 0.1, 1).shell_switch));
    }

    #[test]
    fn a_bent_shell_runs_out_by_the_closed_form_whatever_the_step() {
        let p = Parameters { bend_m: 0.05, bend_at_deg: 40.0, shell_start_deg: 0.0, ..Parameters::default() };
        for (dt_s, turns) in [(0.001, 23_000), (0.01, 2_300)] {
            let mut rig = Rig::new(KilnShell::new(p.clone())).failing(Failure::Bent);
            let out = rig.run(MINUTE, dt_s, turns);
            // 23 s of the 60.24 s of a turn; 5 cm and the 10 cm of the failure
            let (behind, off) = (40_f64.to_radians() - 2.0 * PI * 23.0 / 60.24, 0.15);
            let nearer = off * behind.cos() + (4.0 - (off * behind.sin()).powi(2)).sqrt() - 2.0;
            assert!((out.run_out_m - nearer).abs() < 1e-9, "{dt_s}: {out:?} {nearer}");
            assert!((rig.component.effect(&rig.state).off_m - 0.15).abs() < 1e-15);
        }
        assert_eq!(rig().run(MINUTE, 0.01, 1234).run_out_m, 0.0, "a straight one does not");
    }

    #[test]
    fn months_leave_a_turn_as_fine_as_at_the_start() {
        // 18 months at 250 turns an hour, then one turn in steps of 10 ms
        let mut rig = rig();
        rig.run(Inputs { speed_turns_h: 250.0 }, 3600.0, 13_140);
        let before = rig.run(Inputs { speed_turns_h: 0.0 }, 0.01, 1).shell_rad;
        let after = rig.run(Inputs { speed_turns_h: 250.0 }, 0.01, 1).shell_rad;
        let step_rad = 2.0 * PI * 250.0 / 3600.0 * 0.01 / 1.004;
        assert!((after - before - step_rad).abs() < 1e-12, "{before} {after}");
    }
}
