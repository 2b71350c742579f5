//! A two-hand control station: two buttons with a make and a break contact each, and what evaluates them.
//!
//! # Equations
//! - a hand counts if its make contact is closed and its break contact is open, and is away in the reverse case; contacts
//!   that agree otherwise are a fault, and the hand is neither;
//! - `valid` from when both hands count, at most `synchronous_s` after the first, until one of them is let go;
//! - again only after both were away.
//!
//! # Source
//! ISO 13851:2019, type III C: synchronous actuation within 0.5 s, re-initiation, contacts of both kinds for each hand.

use serde::{Deserialize, Serialize};

use crate::component::behaviour::{Component, Start, Turn};
use crate::component::declare::{failures, own_types, parameters, signals};

parameters! {
    /// Its parameters.
    Parameters {
        /// greatest time between the two hands
        synchronous_s: f64 = 0.5 => 0.0, 10.0;
    }
}

signals! {
    /// What it takes.
    Inputs {
        /// the left hand is on its button
        left: bool,
        /// the right hand is on its button
        right: bool,
    }
}

signals! {
    /// What it gives.
    Outputs {
        /// make contact of the left button
        left_make: bool,
        /// break contact of the left button
        left_break: bool = true,
        /// make contact of the right button
        right_make: bool,
        /// break contact of the right button
        right_break: bool = true,
        /// both hands are on it, as the standard wants it
        valid: bool,
        /// contacts of a hand do not agree
        fault: bool,
    }
}

failures! {
    /// How it fails.
    Failure {
        /// the make contact of the left button is welded
        LeftWelded = "left_welded",
        /// the make contact of the right button is welded
        RightWelded = "right_welded",
        /// the make contact of the left button does not close
        LeftBroken = "left_broken",
        /// the make contact of the right button does not close
        RightBroken = "right_broken",
        /// the output of the evaluation stays as it is
        EvaluationStuck = "evaluation_stuck",
    }
}

/// What the contacts say of a hand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Hand {
    On,
    Away,
    Fault,
}

impl Hand {
    fn of(make: bool, break_contact: bool) -> Self {
        match (make, break_contact) {
            (true, false) => Self::On,
            (false, true) => Self::Away,
            (true, true) | (false, false) => Self::Fault,
        }
    }
}

/// What the evaluation does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) enum Doing {
    /// Both hands are away.
    #[default]
    Ready,
    /// One hand has been on for so long, and waits for the other.
    One {
        since_s: f64,
    },
    Valid,
    /// Both hands must be away first.
    Blocked,
}

/// What it remembers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    doing: Doing,
    /// What the evaluation shows.
    valid: bool,
}

/// A two-hand control station, by its parameters.
pub(crate) struct TwoHandStation {
    p: Parameters,
}

impl TwoHandStation {
    fn next(&self, doing: Doing, hands: [Hand; 2], dt_s: f64) -> Doing {
        let since_s = match doing {
            _ if hands == [Hand::Away; 2] => return Doing::Ready,
            _ if hands.contains(&Hand::Fault) => return Doing::Blocked,
            Doing::Valid if hands == [Hand::On; 2] => return Doing::Valid,
            Doing::Valid | Doing::Blocked => return Doing::Blocked,
            Doing::Ready => 0.0,
            Doing::One { since_s } => since_s + dt_s,
        };
        // a rounding more than the time is not a reason to be late
        match hands {
            _ if since_s > self.p.synchronous_s * (1.0 + 1e-12) => Doing::Blocked,
            [Hand::On, Hand::On] => Doing::Valid,
            _ => Doing::One { since_s },
        }
    }
}

impl Component for TwoHandStation {
    const NAME: &'static str = "two_hand_station";
    const SUMMARY: &'static str = "two-hand control station: four contacts, and their evaluation";
    const FORMULA: &'static [&'static str] =
        &["valid from both hands within synchronous_s until one is let go, again after both were away"];
    const SOURCE: &'static str = "ISO 13851:2019, type III C";
    own_types!();

    fn new(p: Parameters) -> Self {
        Self { p }
    }

    fn initial(&self, _: &Start) -> State {
        State::default()
    }

    fn sense(&self, state: &mut State, inputs: &Inputs, turn: &Turn) -> Outputs {
        let make = |hand: bool, welded: Failure, broken: Failure| {
            (hand || turn.failed.has(welded)) && !turn.failed.has(broken)
        };
        let left_make = make(inputs.left, Failure::LeftWelded, Failure::LeftBroken);
        let right_make = make(inputs.right, Failure::RightWelded, Failure::RightBroken);
        let (left_break, right_break) = (!inputs.left, !inputs.right);
        let hands = [Hand::of(left_make, left_break), Hand::of(right_make, right_break)];
        state.doing = self.next(state.doing, hands, turn.dt_s);
        if !turn.failed.has(Failure::EvaluationStuck) {
            state.valid = state.doing == Doing::Valid;
        }
        let fault = hands.contains(&Hand::Fault);
        Outputs { left_make, left_break, right_make, right_break, valid: state.valid, fault }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::tests::Rig;

    const AWAY: Inputs = Inputs { left: false, right: false };
    const LEFT: Inputs = Inputs { left: true, right: false };
    const BOTH: Inputs = Inputs { left: true, right: true };

    fn rig() -> Rig<TwoHandStation> {
        Rig::new(TwoHandStation::new(Parameters::default()))
    }

    #[test]
    fn both_hands_within_half_a_second() {
        for (turns, valid) in [(1, true), (50, true), (51, false), (200, false)] {
            let mut rig = rig();
            rig.run(LEFT, 0.01, turns);
            assert_eq!(rig.run(BOTH, 0.01, 1).valid, valid, "{turns}");
            assert_eq!(rig.run(BOTH, 0.01, 100).valid, valid, "it stays so: {turns}");
        }
        assert!(rig().run(BOTH, 0.01, 1).valid);
    }

    #[test]
    fn it_begins_again_only_after_both_were_away() {
        let mut rig = rig();
        assert!(rig.run(BOTH, 0.01, 1).valid && !rig.run(LEFT, 0.01, 1).valid);
        assert!(!rig.run(BOTH, 0.01, 10).valid, "the other hand was never away");
        rig.run(AWAY, 0.01, 1);
        assert!(rig.run(BOTH, 0.01, 1).valid);
    }

    #[test]
    fn hands_that_alternate_are_late_too() {
        let mut rig = rig();
        rig.run(LEFT, 0.01, 40);
        rig.run(Inputs { left: false, right: true }, 0.01, 20);
        assert!(!rig.run(BOTH, 0.01, 1).valid);
    }

    #[test]
    fn contacts_are_those_of_the_buttons() {
        let contacts = |out: Outputs| [out.left_make, out.left_break, out.right_make, out.right_break];
        assert_eq!(contacts(rig().run(AWAY, 0.01, 1)), [false, true, false, true]);
        assert_eq!(contacts(rig().run(LEFT, 0.01, 1)), [true, false, false, true]);
    }

    #[test]
    fn each_failure_has_its_effect() {
        for mode in [Failure::LeftWelded, Failure::RightWelded] {
            let out = rig().failing(mode).run(AWAY, 0.01, 1);
            assert!(out.fault && !out.valid && (out.left_make || out.right_make));
            let mut later = rig().failing(mode);
            later.run(AWAY, 0.01, 1);
            assert!(!later.run(BOTH, 0.01, 1).valid, "a fault is found at rest");
        }
        for mode in [Failure::LeftBroken, Failure::RightBroken] {
            let out = rig().failing(mode).run(BOTH, 0.01, 1);
            assert!(out.fault && !out.valid && !(out.left_make && out.right_make));
        }
        assert!(!rig().failing(Failure::EvaluationStuck).run(BOTH, 0.01, 1).valid);
        let mut rig = rig();
        rig.run(BOTH, 0.01, 1);
        assert!(rig.failing(Failure::EvaluationStuck).run(AWAY, 0.01, 10).valid);
    }
}
