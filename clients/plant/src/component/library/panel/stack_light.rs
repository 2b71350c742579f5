//! A stack light: up to five tiers of lenses and a buzzer.
//!
//! # Equations
//! - a tier is lit while its input is on; while its flash input is on, it is lit in the first half of each `1/flash_hz`;
//! - tiers that flash do so together, and begin lit; with `flash_hz = 0` they are steady.
//!
//! # Source
//! IEC 60204-1:2016, 10.3.2 (colours of indicator lights and their meaning); IEC 60073:2002 (flashing, as long on as off).

use serde::{Deserialize, Serialize};

use crate::component::behaviour::{Component, Start, Turn};
use crate::component::declare::{failures, own_types, parameters, signals};

/// A rounding less than half a period is not a reason to be lit for another turn.
const ROUNDING: f64 = 1e-9;

parameters! {
    /// Its parameters.
    Parameters {
        /// how often a second a tier flashes; 0: it is steady
        flash_hz: f64 = 2.0 => 0.0, 50.0;
    }
}

signals! {
    /// What it takes.
    Inputs {
        /// red: emergency, immediate action
        red: bool,
        /// amber: abnormal, a critical condition is near
        amber: bool,
        /// green: normal
        green: bool,
        /// blue: mandatory, the operator has to act
        blue: bool,
        /// white: neutral
        white: bool,
        /// sounds
        buzzer: bool,
        /// red flashes
        red_flash: bool,
        /// amber flashes
        amber_flash: bool,
        /// green flashes
        green_flash: bool,
        /// blue flashes
        blue_flash: bool,
        /// white flashes
        white_flash: bool,
    }
}

signals! {
    /// What can be seen and heard.
    Outputs {
        /// red can be seen
        red_lit: bool,
        /// amber can be seen
        amber_lit: bool,
        /// green can be seen
        green_lit: bool,
        /// blue can be seen
        blue_lit: bool,
        /// white can be seen
        white_lit: bool,
        /// the buzzer can be heard
        sounding: bool,
    }
}

failures! {
    /// How it fails.
    Failure {
        /// red is burnt
        RedBurnt = "red_burnt",
        /// amber is burnt
        AmberBurnt = "amber_burnt",
        /// green is burnt
        GreenBurnt = "green_burnt",
        /// blue is burnt
        BlueBurnt = "blue_burnt",
        /// white is burnt
        WhiteBurnt = "white_burnt",
        /// no supply: nothing is seen or heard
        Dark = "dark",
        /// the buzzer is mute
        Mute = "mute",
    }
}

/// What it remembers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    /// Part of a period of flashing that has gone by; none while no tier flashes.
    phase: Option<f64>,
}

/// A stack light, by its parameters.
pub(crate) struct StackLight {
    p: Parameters,
}

impl Component for StackLight {
    const NAME: &'static str = "stack_light";
    const SUMMARY: &'static str = "stack light: five tiers, steady or flashing, and a buzzer";
    const FORMULA: &'static [&'static str] =
        &["lit while its input is on", "flashing: lit while the part of flash_hz t behind the point is below 1/2"];
    const SOURCE: &'static str = "IEC 60204-1:2016, 10.3.2; IEC 60073:2002 (colours, flashing)";
    own_types!();

    fn new(p: Parameters) -> Self {
        Self { p }
    }

    fn initial(&self, _: &Start) -> State {
        State::default()
    }

    fn sense(&self, state: &mut State, i: &Inputs, turn: &Turn) -> Outputs {
        let flashes = [i.red_flash, i.amber_flash, i.green_flash, i.blue_flash, i.white_flash].contains(&true);
        let goes_on = |phase: f64| {
            let phase = phase + self.p.flash_hz * turn.dt_s;
            phase - (phase + ROUNDING).floor()
        };
        state.phase = flashes.then(|| state.phase.map_or(0.0, goes_on));
        let first_half = state.phase.is_none_or(|phase| phase < 0.5 - ROUNDING);
        let supplied = !turn.failed.has(Failure::Dark);
        let lit = |on: bool, flash: bool, burnt: Failure| {
            supplied && !turn.failed.has(burnt) && if flash { first_half } else { on }
        };
        Outputs {
            red_lit: lit(i.red, i.red_flash, Failure::RedBurnt),
            amber_lit: lit(i.amber, i.amber_flash, Failure::AmberBurnt),
            green_lit: lit(i.green, i.green_flash, Failure::GreenBurnt),
            blue_lit: lit(i.blue, i.blue_flash, Failure::BlueBurnt),
            white_lit: lit(i.white, i.white_flash, Failure::WhiteBurnt),
            sounding: supplied && i.buzzer && !turn.failed.has(Failure::Mute),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::tests::Rig;

    const ALL: Inputs = Inputs {
        red: true,
        amber: true,
        green: true,
        blue: true,
        white: true,
        buzzer: true,
        red_flash: false,
        amber_flash: false,
        green_flash: false,
        blue_flash: false,
        white_flash: false,
    };

    fn rig(flash_hz: f64) -> Rig<StackLight> {
        Rig::new(StackLight::new(Parameters { flash_hz }))
    }

    fn tiers(out: Outputs) -> [bool; 6] {
        [out.red_lit, out.amber_lit, out.green_lit, out.blue_lit, out.white_lit, out.sounding]
    }

    #[test]
    fn a_tier_is_lit_by_its_own_input() {
        assert_eq!(tiers(rig(2.0).run(ALL, 0.01, 1)), [true; 6]);
        assert_eq!(tiers(rig(2.0).run(Inputs::default(), 0.01, 1)), [false; 6]);
        let green = Inputs { green: true, ..Inputs::default() };
        assert_eq!(tiers(rig(2.0).run(green, 0.01, 1)), [false, false, true, false, false, false]);
    }

    #[test]
    fn tiers_flash_together_half_of_the_time_at_any_period() {
        let both = Inputs { red_flash: true, blue_flash: true, ..Inputs::default() };
        for (turns, dt_s) in [(25, 0.01), (5, 0.05), (250, 0.001)] {
            let mut rig = rig(2.0);
            for _ in 0..20 {
                for lit in [true, false] {
                    for _ in 0..turns {
                        let out = rig.run(both, dt_s, 1);
                        assert_eq!((out.red_lit, out.blue_lit, out.green_lit), (lit, lit, false), "{dt_s}");
                    }
                }
            }
        }
        let mut steady = rig(0.0);
        assert!((0..200).all(|_| steady.run(both, 0.01, 1).red_lit));
    }

    #[test]
    fn a_flash_begins_lit() {
        let mut rig = rig(1.0);
        let flash = Inputs { amber_flash: true, ..Inputs::default() };
        assert!(!rig.run(flash, 0.01, 70).amber_lit);
        rig.run(Inputs::default(), 0.01, 1);
        assert!(rig.run(flash, 0.01, 1).amber_lit);
    }

    #[test]
    fn each_failure_has_its_effect() {
        let modes =
            [Failure::RedBurnt, Failure::AmberBurnt, Failure::GreenBurnt, Failure::BlueBurnt, Failure::WhiteBurnt];
        for (tier, mode) in modes.into_iter().enumerate() {
            let mut wanted = [true; 6];
            wanted[tier] = false;
            assert_eq!(tiers(rig(2.0).failing(mode).run(ALL, 0.01, 1)), wanted);
        }
        assert_eq!(tiers(rig(2.0).failing(Failure::Dark).run(ALL, 0.01, 1)), [false; 6]);
        let mute = rig(2.0).failing(Failure::Mute).run(ALL, 0.01, 1);
        assert!(mute.white_lit && !mute.sounding);
    }
}
