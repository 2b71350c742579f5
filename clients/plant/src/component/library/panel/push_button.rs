//! A push button with its contacts, pressed by an operator.
//!
//! # Equations
//! - make contact closed while pressed, break contact open, each `bounce_s` unsteady after a change.
//!
//! # Source
//! IEC 60947-5-1.

use serde::{Deserialize, Serialize};

use crate::component::behaviour::{Component, Start, Turn};
use crate::component::declare::{failures, own_types, parameters, signals};

parameters! {
    /// Its parameters.
    Parameters {
        /// for so long a contact bounces, changing in each period
        bounce_s: f64 = 0.0 => 0.0, 1.0;
        /// stays pressed until it is pressed again
        latching: bool = false;
    }
}

signals! {
    /// What it takes.
    Inputs {
        /// a finger is on it
        press: bool,
    }
}

signals! {
    /// What it gives.
    Outputs {
        /// make contact
        make: bool,
        /// break contact
        break_contact: bool,
    }
}

failures! {
    /// How it fails.
    Failure {
        /// it stays pressed
        Stuck = "stuck",
        /// the make contact does not close
        MakeBroken = "make_broken",
    }
}

/// What it remembers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    finger: bool,
    pressed: bool,
    since_s: Option<f64>,
    flips: bool,
}

/// A push button with its contacts, pressed by an operator, by its parameters.
pub(crate) struct PushButton {
    p: Parameters,
}

impl Component for PushButton {
    const NAME: &'static str = "push_button";
    const SUMMARY: &'static str = "push button with a make and a break contact";
    const FORMULA: &'static [&'static str] = &["make = pressed, break = not pressed"];
    const SOURCE: &'static str = "IEC 60947-5-1";
    own_types!();

    fn new(p: Parameters) -> Self {
        Self { p }
    }

    fn initial(&self, _: &Start) -> State {
        State::default()
    }

    fn sense(&self, state: &mut State, inputs: &Inputs, turn: &Turn) -> Outputs {
        let before = std::mem::replace(&mut state.finger, inputs.press);
        let rising = inputs.press && !before;
        let wanted = if self.p.latching { state.pressed != rising } else { inputs.press };
        let pressed = wanted || turn.failed.has(Failure::Stuck);
        state.since_s = if pressed == state.pressed { state.since_s.map(|since_s| since_s + turn.dt_s) } else { Some(0.0) };
        state.pressed = pressed;
        let bounces = state.since_s.is_some_and(|since_s| since_s < self.p.bounce_s);
        state.flips = bounces && !state.flips;
        let closed = pressed != (bounces && !state.flips);
        Outputs { make: closed && !turn.failed.has(Failure::MakeBroken), break_contact: !closed }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::tests::Rig;

    fn made(rig: &mut Rig<PushButton>, presses: &[bool]) -> Vec<bool> {
        presses.iter().map(|press| rig.run(Inputs { press: *press }, 0.001, 1).make).collect()
    }

    fn rig(p: Parameters) -> Rig<PushButton> {
        Rig::new(PushButton::new(p))
    }

    #[test]
    fn contacts_follow_the_finger() {
        assert_eq!(made(&mut rig(Parameters::default()), &[false, true, true, false]), [false, true, true, false]);
        let latching = Parameters { latching: true, ..Parameters::default() };
        let pressed = [true, true, false, false, true, false];
        assert_eq!(made(&mut rig(latching), &pressed), [true, true, true, true, false, false]);
    }

    #[test]
    fn a_contact_bounces_and_settles() {
        let mut rig = rig(Parameters { bounce_s: 0.004, ..Parameters::default() });
        assert_eq!(made(&mut rig, &[false, true, true, true, true, true]), [false, true, false, true, false, true]);
    }

    #[test]
    fn each_failure_has_its_effect() {
        assert_eq!(made(&mut rig(Parameters::default()).failing(Failure::Stuck), &[false]), [true]);
        let out = rig(Parameters::default()).failing(Failure::MakeBroken).run(Inputs { press: true }, 0.01, 1);
        assert!(!out.make && !out.break_contact);
    }
}
