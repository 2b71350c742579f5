//! A line scanner, or a camera: takes a picture on a trigger and judges it.
//!
//! # Equations
//! - on a rising `trigger` it looks at the targets that touch its field, and answers after `latency_s`;
//! - the answer is good if the count is from `least` to `most`, but with probability `error_pct` it is the wrong one.
//!
//! # Source
//! closed form; errors are Bernoulli trials of the scenario's seed.

use serde::{Deserialize, Serialize};

use crate::component::behaviour::{Component, Start, Turn};
use crate::component::declare::{failures, own_types, parameters, signals};
use crate::component::dynamics::is_over;
use crate::coupling::{Targets, Touch};
use onescan_server::random::Random;

parameters! {
    /// Its parameters.
    Parameters {
        /// from the trigger to the answer
        latency_s: f64 = 0.04 => 0.0, 60.0;
        /// least count that is good
        least: u32 = 1 => 0.0, 1000.0;
        /// greatest count that is good
        most: u32 = 1 => 0.0, 1000.0;
        /// how often the answer is wrong
        error_pct: f64 = 0.0 => 0.0, 100.0;
    }
}

signals! {
    /// What it takes.
    Inputs {
        /// rising: takes a picture
        trigger: bool,
    }
}

signals! {
    /// What it gives.
    Outputs {
        /// an answer is there, until the next trigger
        ready: bool,
        /// what it saw is good
        good: bool,
        /// how many it saw
        count: i32,
        /// pictures taken
        pictures: i32,
    }
}

failures! {
    /// How it fails.
    Failure {
        /// the lens is dirty: it sees nothing
        Dirty = "dirty",
        /// no answer comes
        Hung = "hung",
    }
}

/// What it remembers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    triggered: bool,
    exposed: Option<u32>,
    pending_s: f64,
    answer: Option<(bool, u32)>,
    pictures: i32,
    random: Option<Random>,
}

/// A line scanner, or a camera, by its parameters.
pub(crate) struct LineScanner {
    p: Parameters,
}

impl Component for LineScanner {
    const NAME: &'static str = "line_scanner";
    const SUMMARY: &'static str = "line scanner or camera: counts what is in its field on a trigger";
    const FORMULA: &'static [&'static str] = &["answer after latency_s: count in [least, most]"];
    const SOURCE: &'static str = "closed form; errors are Bernoulli trials of the scenario's seed";
    own_types!(senses Touch);

    fn new(p: Parameters) -> Self {
        Self { p }
    }

    fn initial(&self, start: &Start<Targets>) -> State {
        State { random: Some(Random::new(start.seed)), ..State::default() }
    }

    fn sense(&self, state: &mut State, inputs: &Inputs, turn: &Turn<Targets>) -> Outputs {
        let before = std::mem::replace(&mut state.triggered, inputs.trigger);
        let rising = inputs.trigger && !before;
        state.pending_s += turn.dt_s;
        if rising {
            let count = if turn.failed.has(Failure::Dirty) { 0 } else { turn.seen.count };
            (state.exposed, state.pending_s, state.answer) = (Some(count), 0.0, None);
            state.pictures = state.pictures.saturating_add(1);
        }
        let due = is_over(state.pending_s, self.p.latency_s) && !turn.failed.has(Failure::Hung);
        if let Some(count) = state.exposed.filter(|_| due) {
            let drawn = state.random.as_mut().map_or(1.0, Random::uniform);
            let wrong = drawn <= 0.01 * self.p.error_pct;
            state.answer = Some(((self.p.least..=self.p.most).contains(&count) != wrong, count));
            state.exposed = None;
        }
        let (good, count) = state.answer.unwrap_or_default();
        Outputs { ready: state.answer.is_some(), good, count: count as i32, pictures: state.pictures }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::tests::{Rig, touched};

    const SHOOT: Inputs = Inputs { trigger: true };
    const WAIT: Inputs = Inputs { trigger: false };

    fn rig(p: Parameters) -> Rig<LineScanner> {
        let mut rig = Rig::new(LineScanner::new(p));
        rig.seen = touched(1);
        rig
    }

    #[test]
    fn the_answer_comes_after_its_latency_and_is_of_the_trigger() {
        let mut rig = rig(Parameters::default());
        assert!(!rig.run(SHOOT, 0.01, 1).ready);
        rig.seen = touched(2);
        assert!(!rig.run(SHOOT, 0.01, 3).ready);
        let out = rig.run(SHOOT, 0.01, 1);
        assert!(out.ready && out.good && out.count == 1);
        rig.run(WAIT, 0.01, 1);
        assert!(!rig.run(SHOOT, 0.01, 1).ready && !rig.run(SHOOT, 0.01, 4).good, "two are one too many");
    }

    #[test]
    fn it_errs_as_often_as_it_says() {
        let mut rig = rig(Parameters { latency_s: 0.0, error_pct: 10.0, ..Parameters::default() });
        let wrong = (0..5000).filter(|_| {
            rig.run(WAIT, 0.01, 1);
            !rig.run(SHOOT, 0.01, 1).good
        });
        // five standard errors √(n p (1 - p)) = 21
        assert!((wrong.count() as i64 - 500).abs() < 106);
    }

    #[test]
    fn each_failure_has_its_effect() {
        assert!(!rig(Parameters::default()).failing(Failure::Dirty).run(SHOOT, 0.01, 10).good);
        assert!(!rig(Parameters::default()).failing(Failure::Hung).run(SHOOT, 0.01, 100).ready);
    }
}
