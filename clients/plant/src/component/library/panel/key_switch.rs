//! A switch that a key turns, with a contact for each of its positions.
//!
//! # Equations
//! - with the key in it stands where the operator turns it; without the key it stays;
//! - after each turn all contacts are open for `gap_s`, then that of the new position closes: break before make;
//! - the key comes out in the positions that `drawn` says; in others it stays in.
//!
//! # Source
//! IEC 60947-5-1:2016 (control switches); ISO 12100:2010, 6.2.11.10 (selection of modes).

use serde::{Deserialize, Serialize};

use crate::component::behaviour::{Component, Start, Turn};
use crate::component::declare::{choice, failures, own_types, parameters, signals};
use crate::component::dynamics::is_over;

choice! {
    /// Where the key comes out.
    Drawn {
        /// In every position.
        Any = "any",
        /// In the first alone.
        First = "first",
        /// In the last alone.
        Last = "last",
    }
}

parameters! {
    /// Its parameters.
    Parameters {
        /// how many positions it has
        positions: u32 = 2 => 2.0, 3.0;
        /// for so long all contacts are open after a turn
        gap_s: f64 = 0.02 => 0.0, 10.0;
        /// where the key comes out: in "any" position, in the "first" or the "last"
        drawn: Drawn = Drawn::Any;
    }
}

signals! {
    /// What it takes.
    Inputs {
        /// where the operator turns it, from 0; beyond the last it stays
        position: i32,
        /// the operator has the key in it
        key: bool,
    }
}

signals! {
    /// What it gives.
    Outputs {
        /// contact of the first position
        at_0: bool = true,
        /// contact of the second position
        at_1: bool,
        /// contact of the third position
        at_2: bool,
        /// the key is in it
        key_in: bool,
    }
}

failures! {
    /// How it fails.
    Failure {
        /// it cannot be turned
        Stuck = "stuck",
        /// no contact closes
        Broken = "broken",
    }
}

/// What it remembers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    position: i32,
    key: bool,
    /// Since the last turn of the key; none before the first.
    since_s: Option<f64>,
}

/// A switch that a key turns, by its parameters.
pub(crate) struct KeySwitch {
    p: Parameters,
}

impl Component for KeySwitch {
    const NAME: &'static str = "key_switch";
    const SUMMARY: &'static str = "key switch with two or three positions, break before make";
    const FORMULA: &'static [&'static str] =
        &["at_k = (position = k), gap_s after it was turned", "without key it stays"];
    const SOURCE: &'static str = "IEC 60947-5-1:2016; ISO 12100:2010, 6.2.11.10";
    own_types!();

    fn new(p: Parameters) -> Self {
        Self { p }
    }

    fn initial(&self, _: &Start) -> State {
        State::default()
    }

    fn sense(&self, state: &mut State, inputs: &Inputs, turn: &Turn) -> Outputs {
        let last = self.p.positions as i32 - 1;
        let comes_out = match self.p.drawn {
            Drawn::Any => true,
            Drawn::First => state.position == 0,
            Drawn::Last => state.position >= last,
        };
        state.key = inputs.key || state.key && !comes_out;
        let wanted = inputs.position;
        let can = state.key && (0..=last).contains(&wanted) && !turn.failed.has(Failure::Stuck);
        if can && wanted != state.position {
            (state.position, state.since_s) = (wanted, Some(0.0));
        } else {
            state.since_s = state.since_s.map(|since_s| since_s + turn.dt_s);
        }
        let open = state.since_s.is_some_and(|since_s| !is_over(since_s, self.p.gap_s));
        let at = |position: i32| state.position == position && !open && !turn.failed.has(Failure::Broken);
        Outputs { at_0: at(0), at_1: at(1), at_2: at(2), key_in: state.key }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::tests::Rig;

    fn rig(p: Parameters) -> Rig<KeySwitch> {
        Rig::new(KeySwitch::new(p))
    }

    fn turned(position: i32) -> Inputs {
        Inputs { position, key: true }
    }

    fn contacts(out: Outputs) -> [bool; 3] {
        [out.at_0, out.at_1, out.at_2]
    }

    #[test]
    fn contacts_break_before_they_make() {
        let mut rig = rig(Parameters { positions: 3, ..Parameters::default() });
        assert_eq!(contacts(rig.run(turned(0), 0.01, 1)), [true, false, false]);
        let seen: Vec<_> = (0..4).map(|_| contacts(rig.run(turned(2), 0.01, 1))).collect();
        let (open, at_2) = ([false; 3], [false, false, true]);
        assert_eq!(seen, [open, open, at_2, at_2]);
        assert_eq!(contacts(rig.run(turned(3), 0.01, 5)), at_2, "there is not a fourth position");
    }

    #[test]
    fn without_its_key_it_stays() {
        let mut rig = rig(Parameters { gap_s: 0.0, ..Parameters::default() });
        assert_eq!(contacts(rig.run(Inputs { position: 1, key: false }, 0.01, 5)), [true, false, false]);
        assert_eq!(contacts(rig.run(turned(1), 0.01, 1)), [false, true, false]);
        assert_eq!(contacts(rig.run(Inputs { position: 0, key: false }, 0.01, 5)), [false, true, false]);
        assert_eq!(contacts(rig.run(turned(2), 0.01, 5)), [false, true, false], "it has two positions");
    }

    #[test]
    fn the_key_comes_out_where_it_may() {
        let out = |drawn: Drawn, position: i32| {
            let mut rig = rig(Parameters { positions: 3, drawn, ..Parameters::default() });
            rig.run(turned(position), 0.01, 5);
            !rig.run(Inputs { position, key: false }, 0.01, 1).key_in
        };
        assert_eq!([0, 1, 2].map(|position| out(Drawn::Any, position)), [true; 3]);
        assert_eq!([0, 1, 2].map(|position| out(Drawn::First, position)), [true, false, false]);
        assert_eq!([0, 1, 2].map(|position| out(Drawn::Last, position)), [false, false, true]);
    }

    #[test]
    fn each_failure_has_its_effect() {
        let stuck = rig(Parameters::default()).failing(Failure::Stuck).run(turned(1), 0.01, 10);
        assert_eq!(contacts(stuck), [true, false, false]);
        let broken = rig(Parameters::default()).failing(Failure::Broken).run(turned(0), 0.01, 10);
        assert_eq!(contacts(broken), [false; 3]);
    }
}
