//! A head that reads and writes the radio tags of bodies in its field.
//!
//! # Equations
//! - a rising `read` or `write` begins an access to the first target in the field, which ends after `cycle_s`;
//! - it is done if that target has been the first for all of the time, else an error: none was there, it was lost, or
//!   both were asked for at once.
//!
//! A tag holds a DINT, 0 at first. It belongs to its body: every head that the body comes to finds what another has
//! written, and a body that a sink takes out and a source puts in again keeps it.
//!
//! # Source
//! closed form; ISO/IEC 15693-3 (one access takes a time; anti-collision).

use serde::{Deserialize, Serialize};

use crate::component::behaviour::{Component, Start, Turn};
use crate::component::declare::{failures, own_types, parameters, signals};
use crate::component::dynamics::{is_over, rising};
use crate::coupling::{InTags, Tags, WriteTag};

parameters! {
    /// Its parameters.
    Parameters {
        /// time of an access
        cycle_s: f64 = 0.03 => 0.0, 60.0;
    }
}

signals! {
    /// What it takes.
    Inputs {
        /// rising: reads
        read: bool,
        /// rising: writes `data`
        write: bool,
        /// what is written
        data: i32,
    }
}

signals! {
    /// What it gives.
    Outputs {
        /// a tag is in the field
        present: bool,
        /// an access goes on
        busy: bool,
        /// the last access has succeeded, until the next
        done: bool,
        /// the last access has failed, until the next
        error: bool,
        /// what was read last
        data_read: i32,
    }
}

failures! {
    /// How it fails.
    Failure {
        /// the field is off: there are no tags
        NoField = "no_field",
        /// a foreign tag answers too: every access fails
        Collision = "collision",
    }
}

/// An access that goes on.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Access {
    place: u32,
    /// What is written; nothing while it reads.
    data: Option<i32>,
    since_s: f64,
}

/// What it remembers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    /// `read` and `write` of the last period.
    before: [bool; 2],
    access: Option<Access>,
    /// Whether the last access has succeeded.
    ended: Option<bool>,
    data_read: i32,
    /// What is written in the period that begins.
    written: Option<(u32, i32)>,
}

impl State {
    fn end(&mut self, succeeded: bool) {
        (self.access, self.ended) = (None, Some(succeeded));
    }
}

/// A head for radio tags, by its parameters.
pub(crate) struct RfidHead {
    p: Parameters,
}

/// The first tag that the head sees.
fn first(turn: &Turn<InTags>) -> Option<u32> {
    turn.seen.targets.first.filter(|_| !turn.failed.has(Failure::NoField))
}

impl Component for RfidHead {
    const NAME: &'static str = "rfid_head";
    const SUMMARY: &'static str = "head that reads and writes the radio tags of bodies";
    const FORMULA: &'static [&'static str] = &["an access takes cycle_s, in which the tag must stay in the field"];
    const SOURCE: &'static str = "closed form; ISO/IEC 15693-3";
    own_types!(moves Tags);

    fn new(p: Parameters) -> Self {
        Self { p }
    }

    fn initial(&self, _: &Start<InTags>) -> State {
        State::default()
    }

    fn drive(&self, state: &mut State, inputs: &Inputs, turn: &Turn<InTags>) {
        state.written = None;
        let [read, write] = rising(&mut state.before, [inputs.read, inputs.write]);
        let seen = first(turn);
        if state.access.is_none() && (read || write) {
            state.ended = None;
            match seen.filter(|_| !(read && write)) {
                Some(place) => {
                    state.access = Some(Access { place, data: write.then_some(inputs.data), since_s: 0.0 });
                }
                None => state.end(false),
            }
        }
        let Some(access) = &mut state.access else { return };
        access.since_s += turn.dt_s;
        let Access { place, data, since_s } = *access;
        if seen != Some(place) {
            state.end(false);
        } else if is_over(since_s, self.p.cycle_s) {
            let succeeds = !turn.failed.has(Failure::Collision);
            if succeeds {
                state.written = data.map(|data| (place, data));
                state.data_read = if data.is_none() { turn.seen.data } else { state.data_read };
            }
            state.end(succeeds);
        }
    }

    fn effect(&self, state: &State) -> WriteTag {
        WriteTag(state.written)
    }

    fn sense(&self, state: &mut State, _: &Inputs, turn: &Turn<InTags>) -> Outputs {
        Outputs {
            present: first(turn).is_some(),
            busy: state.access.is_some(),
            done: state.ended == Some(true),
            error: state.ended == Some(false),
            data_read: state.data_read,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::tests::{Rig, touched};

    const REST: Inputs = Inputs { read: false, write: false, data: 42 };
    const READ: Inputs = Inputs { read: true, ..REST };
    const WRITE: Inputs = Inputs { write: true, ..REST };

    fn rig(count: u32) -> Rig<RfidHead> {
        let mut rig = Rig::new(RfidHead::new(Parameters::default()));
        rig.seen = InTags { targets: touched(count), data: 7 };
        rig
    }

    fn said(out: Outputs) -> (bool, bool, bool) {
        (out.busy, out.done, out.error)
    }

    #[test]
    fn an_access_takes_its_time() {
        let mut rig = rig(1);
        let seen: Vec<_> = (0..4).map(|_| said(rig.run(READ, 0.01, 1))).collect();
        let (busy, done) = ((true, false, false), (false, true, false));
        assert_eq!(seen, [busy, busy, done, done]);
        assert_eq!(rig.run(READ, 0.01, 1).data_read, 7);
        rig.run(WRITE, 0.01, 2);
        assert_eq!(rig.state.written, None);
        rig.run(WRITE, 0.01, 1);
        assert_eq!(rig.component.effect(&rig.state), WriteTag(Some((0, 42))));
        rig.run(WRITE, 0.01, 1);
        assert_eq!(rig.component.effect(&rig.state), WriteTag(None), "it is written once");
    }

    #[test]
    fn a_tag_that_is_not_there_or_leaves_is_an_error() {
        assert_eq!(said(rig(0).run(READ, 0.01, 1)), (false, false, true));
        let mut rig = rig(1);
        rig.run(WRITE, 0.01, 2);
        rig.seen.targets = touched(0);
        let out = rig.run(WRITE, 0.01, 1);
        assert_eq!((said(out), out.present), ((false, false, true), false));
        assert_eq!(rig.state.written, None);
        rig.seen.targets = touched(1);
        rig.run(REST, 0.01, 1);
        assert_eq!(said(rig.run(READ, 0.01, 1)), (true, false, false), "the next access clears the error");
        rig.seen.targets.first = Some(3);
        assert!(rig.run(READ, 0.01, 1).error, "another tag has come");
    }

    #[test]
    fn both_at_once_are_an_error() {
        assert!(rig(1).run(Inputs { read: true, write: true, data: 1 }, 0.01, 1).error);
    }

    #[test]
    fn each_failure_has_its_effect() {
        let off = rig(1).failing(Failure::NoField).run(READ, 0.01, 1);
        assert!(off.error && !off.present);
        let mut rig = rig(1).failing(Failure::Collision);
        let out = rig.run(WRITE, 0.01, 3);
        assert!(out.error && out.present && rig.state.written.is_none());
    }
}
