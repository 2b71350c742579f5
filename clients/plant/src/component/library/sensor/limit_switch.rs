//! A limit switch: a cam on a joint operates a contact, which bounces.
//!
//! # Equations
//! Operated from `from` to `to` of the joint's coordinate (m or rad), released `differential` beyond:
//! the differential travel of a snap-action contact. After each change the contact opens and closes
//! `bounces` times within `bounce_s`.
//!
//! # Source
//! IEC 60947-5-1 (control switches), annex K (positive opening).

use serde::{Deserialize, Serialize};

use crate::component::behaviour::{Component, Conflict, Start, Turn};
use crate::component::declare::{failures, own_types, parameters, signals};
use crate::coupling::{Coordinate, Measures};

parameters! {
    /// A switch and its cam; positions in m, or in rad on a revolute joint.
    Parameters {
        /// operated from here, m or rad
        from: f64 = 0.0 => -1e6, 1e6;
        /// operated up to here, m or rad
        to: f64 = 1e6 => -1e6, 1e6;
        /// released so much farther outside, m or rad
        differential: f64 = 0.0005 => 0.0, 1e3;
        /// for so long the contact bounces
        bounce_s: f64 = 0.0 => 0.0, 1.0;
        /// how often it opens again while it bounces
        bounces: u32 = 2 => 0.0, 100.0;
        /// the contact opens where the switch is operated
        normally_closed: bool = false;
    }
}

signals! {
    /// Nothing.
    Inputs {}
}

signals! {
    /// The contact.
    Outputs {
        /// the contact is closed
        contact: bool,
    }
}

failures! {
    /// How it fails.
    Failure {
        /// the contact is welded: it stays closed
        Welded = "welded",
        /// the wire is broken: never closed
        BrokenWire = "broken_wire",
        /// the lever is bent: never operated
        Bent = "bent",
    }
}

/// What it remembers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    operated: bool,
    /// Since the last change; none before the first.
    since_s: Option<f64>,
}

/// A switch by its parameters.
pub(crate) struct LimitSwitch {
    p: Parameters,
}

impl LimitSwitch {
    /// True while a bouncing contact is at its old place.
    fn bounced_back(&self, since_s: Option<f64>) -> bool {
        let Some(since_s) = since_s.filter(|since_s| *since_s < self.p.bounce_s) else { return false };
        // new, old, new, old, … in equal parts, ending at the new place
        let part = (since_s / self.p.bounce_s * f64::from(2 * self.p.bounces + 1)) as u32;
        part % 2 == 1
    }
}

impl Component for LimitSwitch {
    const NAME: &'static str = "limit_switch";
    const SUMMARY: &'static str = "limit switch: a cam on a joint operates a contact";
    const FORMULA: &'static [&'static str] =
        &["operated in [from, to], released outside [from - d, to + d]", "bounces for bounce_s after a change"];
    const SOURCE: &'static str = "IEC 60947-5-1";
    own_types!(senses Measures);

    fn new(p: Parameters) -> Self {
        Self { p }
    }

    fn conflict(p: &Parameters) -> Option<Conflict> {
        (p.from > p.to).then_some(Conflict { key: "to", wanted: "a number from `from` on" })
    }

    fn initial(&self, start: &Start<Coordinate>) -> State {
        let position = start.seen.position;
        State { operated: position >= self.p.from && position <= self.p.to, since_s: None }
    }

    fn sense(&self, state: &mut State, _: &Inputs, turn: &Turn<Coordinate>) -> Outputs {
        let margin = if state.operated { self.p.differential } else { 0.0 };
        let position = turn.seen.position;
        let inside = position >= self.p.from - margin && position <= self.p.to + margin;
        let operated = inside && !turn.failed.has(Failure::Bent);
        state.since_s = if operated == state.operated { state.since_s.map(|since| since + turn.dt_s) } else { Some(0.0) };
        state.operated = operated;
        let acts = operated != self.bounced_back(state.since_s);
        let closed = acts != self.p.normally_closed;
        Outputs { contact: (closed || turn.failed.has(Failure::Welded)) && !turn.failed.has(Failure::BrokenWire) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::tests::Rig;

    fn rig(mut p: Parameters) -> Rig<LimitSwitch> {
        (p.from, p.to) = (0.1, 0.2);
        Rig::new(LimitSwitch::new(p))
    }

    fn at(rig: &mut Rig<LimitSwitch>, position: f64) -> bool {
        rig.seen = Coordinate { position, velocity: 0.0 };
        rig.run(Inputs {}, 0.001, 1).contact
    }

    #[test]
    fn it_has_its_range_and_its_differential_travel() {
        let mut rig = rig(Parameters::default());
        let seen = [0.0999, 0.1, 0.2004, 0.2006, 0.2004, 0.1999, 0.0994].map(|position| at(&mut rig, position));
        assert_eq!(seen, [false, true, true, false, false, true, false]);
    }

    #[test]
    fn a_contact_bounces_and_settles() {
        let mut rig = rig(Parameters { bounce_s: 0.005, bounces: 2, ..Parameters::default() });
        at(&mut rig, 0.0);
        let seen: Vec<_> = (0..8).map(|_| at(&mut rig, 0.15)).collect();
        assert_eq!(seen, [true, false, true, false, true, true, true, true]);
    }

    #[test]
    fn each_failure_has_its_effect() {
        assert!(at(&mut rig(Parameters::default()).failing(Failure::Welded), 0.0));
        assert!(!at(&mut rig(Parameters::default()).failing(Failure::BrokenWire), 0.15));
        assert!(!at(&mut rig(Parameters::default()).failing(Failure::Bent), 0.15));
        let closed = Parameters { normally_closed: true, ..Parameters::default() };
        assert!(at(&mut rig(closed.clone()), 0.0) && !at(&mut rig(closed), 0.15));
    }
}
