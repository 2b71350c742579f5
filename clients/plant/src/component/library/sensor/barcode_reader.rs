//! A barcode reader: reads the code of a body in its field.
//!
//! # Equations
//! - on a rising `trigger`, or if `continuous` whenever another target is the first in its field, it looks, and answers
//!   after `latency_s`;
//! - the code of a target is `first_code` and its place in `targets`: of the first that is named it is `first_code`, of the
//!   next one more. Of several in the field it reads the first of them;
//! - with probability `error_pct` a code that is there is not read.
//!
//! # Source
//! closed form; ISO/IEC 15416 (print quality: part of the scans that decode); misses are Bernoulli trials of the
//! scenario's seed.

use serde::{Deserialize, Serialize};

use crate::component::behaviour::{Component, Start, Turn};
use crate::component::declare::{failures, own_types, parameters, signals};
use crate::component::dynamics::is_over;
use crate::coupling::{Contact, Targets};
use onescan_server::random::Random;

parameters! {
    /// Its parameters.
    Parameters {
        /// from a look to its answer
        latency_s: f64 = 0.05 => 0.0, 60.0;
        /// code of the first target
        first_code: u32 = 1 => 0.0, 1_000_000_000.0;
        /// reads without a trigger
        continuous: bool = false;
        /// how often a code is not read
        error_pct: f64 = 0.0 => 0.0, 100.0;
    }
}

signals! {
    /// What it takes.
    Inputs {
        /// rising: reads
        trigger: bool,
    }
}

signals! {
    /// What it gives.
    Outputs {
        /// a code was read, until the next look
        good: bool,
        /// nothing was read, until the next look
        no_read: bool,
        /// the code; 0 if none was read
        code: i32,
        /// codes that were read
        reads: i32,
        /// looks that read nothing
        no_reads: i32,
    }
}

failures! {
    /// How it fails.
    Failure {
        /// the window is dirty: it reads nothing
        Dirty = "dirty",
        /// no answer comes
        Hung = "hung",
    }
}

/// What a look saw: the first target, unless it was missed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Look {
    place: Option<u32>,
}

/// What it answers to a look.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) enum Answer {
    Code(i32),
    Nothing,
}

/// What it remembers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    triggered: bool,
    /// The first in its field.
    first: Option<u32>,
    /// What it saw when it looked, if it has not answered yet.
    looked: Option<Look>,
    pending_s: f64,
    answer: Option<Answer>,
    reads: i32,
    no_reads: i32,
    random: Random,
}

/// A barcode reader, by its parameters.
pub(crate) struct BarcodeReader {
    p: Parameters,
}

impl BarcodeReader {
    fn code(&self, place: u32) -> i32 {
        i32::try_from(self.p.first_code.saturating_add(place)).unwrap_or(i32::MAX)
    }
}

impl Component for BarcodeReader {
    const NAME: &'static str = "barcode_reader";
    const SUMMARY: &'static str = "barcode reader: the code of a body in its field, on a trigger or always";
    const FORMULA: &'static [&'static str] = &["code = first_code + place of the target, latency_s after the look"];
    const SOURCE: &'static str = "closed form; ISO/IEC 15416; misses are Bernoulli trials of the scenario's seed";
    own_types!(senses Contact);

    fn new(p: Parameters) -> Self {
        Self { p }
    }

    fn uses(p: &Parameters, _: usize) -> bool {
        !p.continuous
    }

    fn initial(&self, start: &Start<Targets>) -> State {
        State {
            triggered: false,
            first: None,
            looked: None,
            pending_s: 0.0,
            answer: None,
            reads: 0,
            no_reads: 0,
            random: Random::new(start.seed),
        }
    }

    fn sense(&self, state: &mut State, inputs: &Inputs, turn: &Turn<Targets>) -> Outputs {
        let seen = turn.seen.first.filter(|_| !turn.failed.has(Failure::Dirty));
        let triggered = std::mem::replace(&mut state.triggered, inputs.trigger);
        let rising = inputs.trigger && !triggered;
        let before = std::mem::replace(&mut state.first, seen);
        let looks = if self.p.continuous { seen.is_some() && seen != before } else { rising };
        state.pending_s += turn.dt_s;
        if looks {
            // drawn for every look, so that what is seen does not move the stream
            let missed = state.random.uniform() <= 0.01 * self.p.error_pct;
            (state.looked, state.pending_s, state.answer) = (Some(Look { place: seen.filter(|_| !missed) }), 0.0, None);
        }
        let due = is_over(state.pending_s, self.p.latency_s) && !turn.failed.has(Failure::Hung);
        if let Some(Look { place }) = state.looked.take_if(|_| due) {
            let counted = if place.is_some() { &mut state.reads } else { &mut state.no_reads };
            *counted = counted.saturating_add(1);
            state.answer = Some(place.map_or(Answer::Nothing, |place| Answer::Code(self.code(place))));
        }
        let code = match state.answer {
            Some(Answer::Code(code)) => Some(code),
            Some(Answer::Nothing) | None => None,
        };
        Outputs {
            good: code.is_some(),
            no_read: state.answer == Some(Answer::Nothing),
            code: code.unwrap_or(0),
            reads: state.reads,
            no_reads: state.no_reads,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::tests::Rig;

    const READ: Inputs = Inputs { trigger: true };
    const WAIT: Inputs = Inputs { trigger: false };

    fn at(place: Option<u32>) -> Targets {
        Targets { first: place, count: u32::from(place.is_some()) }
    }

    fn rig(p: Parameters, place: Option<u32>) -> Rig<BarcodeReader> {
        let mut rig = Rig::new(BarcodeReader::new(p));
        rig.seen = at(place);
        rig
    }

    #[test]
    fn the_code_comes_after_its_latency_and_is_of_the_trigger() {
        let mut rig = rig(Parameters { first_code: 100, ..Parameters::default() }, Some(7));
        assert!(!rig.run(READ, 0.01, 1).good);
        rig.seen = at(None);
        assert!(!rig.run(READ, 0.01, 4).good);
        let out = rig.run(READ, 0.01, 1);
        assert_eq!((out.good, out.code, out.reads, out.no_reads), (true, 107, 1, 0));
        rig.run(WAIT, 0.01, 1);
        let out = rig.run(READ, 0.01, 6);
        assert_eq!((out.good, out.no_read, out.code, out.no_reads), (false, true, 0, 1));
    }

    #[test]
    fn without_a_trigger_each_body_is_read_once() {
        let mut rig = rig(Parameters { continuous: true, ..Parameters::default() }, None);
        rig.run(WAIT, 0.01, 10);
        for (place, reads) in [(0, 1), (3, 2), (3, 2)] {
            rig.seen = at(Some(place));
            let out = rig.run(WAIT, 0.01, 20);
            assert_eq!((out.code, out.reads, out.no_reads), (place as i32 + 1, reads, 0));
        }
        rig.seen = at(None);
        assert!(rig.run(WAIT, 0.01, 20).good, "what was read stays until the next");
        rig.seen = at(Some(3));
        assert_eq!(rig.run(WAIT, 0.01, 20).reads, 3, "it has come again");
    }

    #[test]
    fn it_misses_as_often_as_it_says() {
        let mut rig = rig(Parameters { latency_s: 0.0, error_pct: 10.0, ..Parameters::default() }, Some(0));
        for _ in 0..5000 {
            rig.run(WAIT, 0.01, 1);
            rig.run(READ, 0.01, 1);
        }
        let out = rig.run(WAIT, 0.01, 1);
        // five standard errors √(n p (1 - p)) = 21
        assert!((out.no_reads - 500).abs() < 106 && out.reads + out.no_reads == 5000, "{out:?}");
    }

    #[test]
    fn each_failure_has_its_effect() {
        let dirty = rig(Parameters::default(), Some(0)).failing(Failure::Dirty).run(READ, 0.01, 10);
        assert!(dirty.no_read && !dirty.good);
        let hung = rig(Parameters::default(), Some(0)).failing(Failure::Hung).run(READ, 0.01, 100);
        assert!(!hung.no_read && !hung.good);
    }
}
