//! A light curtain: parallel beams that protect a field, with two switching outputs.
//!
//! # Equations
//! - beam k begins `k pitch_m` along the curtain from its point, and is dark while targets within `range_m` cover all of
//!   its width `beam_m`. A body that covers `pitch_m + beam_m` of the field, the resolution, always darkens one; of a
//!   smaller one it depends on where it is;
//! - the outputs are off `response_s` after a beam is dark, on again `free_s` after the field is free;
//! - while `mute` is on, for `muting_max_s` at most, they stay on.
//!
//! Width is looked at in three rays a beam: its edges and its middle.
//!
//! # Source
//! IEC 61496-2:2020 (resolution, response time); IEC 61496-1:2020, annex A (muting, blanking).

use serde::{Deserialize, Serialize};

use crate::component::behaviour::{Component, Conflict, Start, Turn};
use crate::component::declare::{failures, own_types, parameters, signals};
use crate::component::dynamics::{OnDelay, is_over};
use crate::coupling::{Beams, Curtain, Interrupted};

parameters! {
    /// A sender and its receiver.
    Parameters {
        /// how many beams
        beams: u32 = 16 => 2.0, 64.0;
        /// from one beam to the next
        pitch_m: f64 = 0.02 => 0.001, 10.0;
        /// width of a beam; 0: a line
        beam_m: f64 = 0.01 => 0.0, 1.0;
        /// length of the beams
        range_m: f64 = 1.0 => 1e-4, 1000.0;
        /// how long a beam must be dark
        response_s: f64 = 0.01 => 0.0, 10.0;
        /// how long the field must be free
        free_s: f64 = 0.05 => 0.0, 60.0;
        /// greatest time of muting; 0: none
        muting_max_s: f64 = 0.0 => 0.0, 3600.0;
        /// so many beams from the first on are blanked
        blank_first: u32 = 0 => 0.0, 63.0;
        /// so many beams back from the last are blanked
        blank_last: u32 = 0 => 0.0, 63.0;
    }
}

signals! {
    /// What it takes.
    Inputs {
        /// muting is asked for
        mute: bool,
    }
}

signals! {
    /// What it gives.
    Outputs {
        /// first switching output: true while the field is free
        ossd_1: bool,
        /// second switching output: true while the field is free
        ossd_2: bool,
        /// beams that are dark and not blanked
        interrupted: i32,
        /// it is muted
        muted: bool,
    }
}

failures! {
    /// How it fails.
    Failure {
        /// the first output stays on
        Ossd1Welded = "ossd_1_welded",
        /// the second output stays on
        Ossd2Welded = "ossd_2_welded",
        /// no light arrives: all beams are dark
        Dirty = "dirty",
        /// the receiver sees foreign light: no beam is ever dark
        Dazzled = "dazzled",
    }
}

/// What it remembers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    on: bool,
    change: OnDelay,
    /// For how long muting has been asked for.
    muting_s: Option<f64>,
}

/// The first so many beams.
const fn first(count: u32) -> u64 {
    if count == 0 { 0 } else { !0 >> (64 - count) }
}

/// A light curtain, by its parameters.
pub(crate) struct LightCurtain {
    p: Parameters,
    /// The beams that count.
    watched: u64,
}

impl Component for LightCurtain {
    const NAME: &'static str = "light_curtain";
    const SUMMARY: &'static str = "light curtain: parallel beams and two switching outputs, with muting and blanking";
    const FORMULA: &'static [&'static str] = &[
        "dark: all of beam_m covered within range_m; resolution d = pitch_m + beam_m",
        "off response_s after a beam is dark, on free_s after all are free",
    ];
    const SOURCE: &'static str = "IEC 61496-2:2020; IEC 61496-1:2020, annex A (muting, blanking)";
    own_types!(senses Curtain);

    fn new(p: Parameters) -> Self {
        let kept = p.beams.saturating_sub(p.blank_last);
        let watched = first(kept) & !first(p.blank_first);
        Self { p, watched }
    }

    fn conflict(p: &Parameters) -> Option<Conflict> {
        let all = p.blank_first + p.blank_last >= p.beams;
        all.then_some(Conflict { key: "blank_last", wanted: "so many that with `blank_first` a beam is left" })
    }

    fn arrange(&self, curtain: &mut Curtain) {
        let Parameters { beams, pitch_m, beam_m, range_m, .. } = self.p;
        curtain.set(Beams { count: beams, pitch_m, wide_m: beam_m, range_m });
    }

    fn initial(&self, _: &Start<Interrupted>) -> State {
        State::default()
    }

    fn sense(&self, state: &mut State, inputs: &Inputs, turn: &Turn<Interrupted>) -> Outputs {
        let dark = if turn.failed.has(Failure::Dirty) { first(self.p.beams) } else { turn.seen.0 };
        let dark = if turn.failed.has(Failure::Dazzled) { 0 } else { dark & self.watched };
        state.muting_s = inputs.mute.then(|| state.muting_s.map_or(0.0, |muting_s| muting_s + turn.dt_s));
        let muted = state.muting_s.is_some_and(|muting_s| !is_over(muting_s, self.p.muting_max_s));
        let free = dark == 0 || muted;
        let delay_s = if free { self.p.free_s } else { self.p.response_s };
        if state.change.holds(free != state.on, delay_s, turn.dt_s) {
            state.on = free;
            state.change = OnDelay::default();
        }
        Outputs {
            ossd_1: state.on || turn.failed.has(Failure::Ossd1Welded),
            ossd_2: state.on || turn.failed.has(Failure::Ossd2Welded),
            interrupted: dark.count_ones() as i32,
            muted,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::tests::Rig;

    const WATCH: Inputs = Inputs { mute: false };
    const MUTE: Inputs = Inputs { mute: true };

    fn rig(p: Parameters) -> Rig<LightCurtain> {
        let mut rig = Rig::new(LightCurtain::new(p));
        rig.run(WATCH, 0.01, 10);
        rig
    }

    fn outputs(out: Outputs) -> (bool, bool) {
        (out.ossd_1, out.ossd_2)
    }

    #[test]
    fn it_is_off_after_its_response_and_on_after_the_field_is_free() {
        let mut rig = rig(Parameters { response_s: 0.02, ..Parameters::default() });
        rig.seen = Interrupted(0b110);
        assert_eq!(outputs(rig.run(WATCH, 0.01, 1)), (true, true));
        let out = rig.run(WATCH, 0.01, 1);
        assert_eq!((outputs(out), out.interrupted), ((false, false), 2));
        rig.seen = Interrupted(0);
        assert_eq!(outputs(rig.run(WATCH, 0.01, 4)), (false, false));
        assert_eq!(outputs(rig.run(WATCH, 0.01, 1)), (true, true));
    }

    #[test]
    fn the_last_of_64_beams_counts_unless_it_is_blanked() {
        let p = || Parameters { beams: 64, ..Parameters::default() };
        let dark = |p: Parameters, seen: u64| {
            let mut rig = rig(p);
            rig.seen = Interrupted(seen);
            rig.run(WATCH, 0.01, 5).interrupted
        };
        assert_eq!(dark(p(), 1 << 63 | 1), 2);
        assert_eq!(dark(Parameters { blank_last: 1, ..p() }, 1 << 63 | 1), 1);
        assert_eq!(dark(Parameters { blank_first: 2, blank_last: 1, ..p() }, 1 << 63 | 0b11), 0);
        assert_eq!(dark(Parameters { blank_first: 63, ..p() }, !0), 1);
        assert!(LightCurtain::conflict(&Parameters { blank_first: 63, blank_last: 1, ..p() }).is_some());
    }

    #[test]
    fn muting_ends_after_its_time() {
        let mut rig = rig(Parameters { muting_max_s: 0.5, ..Parameters::default() });
        rig.seen = Interrupted(1);
        let out = rig.run(MUTE, 0.01, 50);
        assert!(out.ossd_1 && out.muted);
        let out = rig.run(MUTE, 0.01, 1);
        assert!(!out.ossd_1 && !out.muted, "{out:?}");
        rig.run(WATCH, 0.01, 1);
        assert!(rig.run(MUTE, 0.01, 10).ossd_2, "asked for again");
        let mut never = Rig::new(LightCurtain::new(Parameters::default()));
        never.seen = Interrupted(1);
        assert!(!never.run(MUTE, 0.01, 1).muted, "without a time there is none");
    }

    #[test]
    fn each_failure_has_its_effect() {
        let seen = |mode: Failure, dark: u64| {
            let mut rig = rig(Parameters::default()).failing(mode);
            rig.seen = Interrupted(dark);
            outputs(rig.run(WATCH, 0.01, 10))
        };
        assert_eq!(seen(Failure::Ossd1Welded, 1), (true, false));
        assert_eq!(seen(Failure::Ossd2Welded, 1), (false, true));
        assert_eq!(seen(Failure::Dirty, 0), (false, false));
        assert_eq!(seen(Failure::Dazzled, !0), (true, true));
    }
}
