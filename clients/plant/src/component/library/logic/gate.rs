//! A logic gate: a relay circuit, a safety relay, a small logic module.
//!
//! # Equations
//! - `and`: all used inputs are true; `or`: one of the first `inputs` is; `nand`, `nor`: not so;
//! - after `delay_s` without interruption.
//!
//! # Source
//! ISO/IEC 60617-12, binary logic elements; delay as the on-delay of a relay.

use serde::{Deserialize, Serialize};

use crate::component::behaviour::{Component, Start, Turn};
use crate::component::declare::{choice, failures, own_types, parameters, signals};
use crate::component::dynamics::is_over;

choice! {
    /// What it computes.
    Function {
        /// all inputs
        And = "and",
        /// one input
        Or = "or",
        /// not all inputs
        Nand = "nand",
        /// no input
        Nor = "nor",
    }
}

parameters! {
    /// Its parameters.
    Parameters {
        /// what it computes
        function: Function = Function::And;
        /// how many inputs it has, from `in_1` on
        inputs: u32 = 2 => 1.0, 16.0;
        /// on-delay
        delay_s: f64 = 0.0 => 0.0, 3600.0;
    }
}

signals! {
    /// What it takes.
    Inputs {
        /// first input
        in_1: bool,
        /// second input
        in_2: bool,
        /// third input
        in_3: bool,
        /// fourth input
        in_4: bool,
        /// fifth input
        in_5: bool,
        /// sixth input
        in_6: bool,
        /// seventh input
        in_7: bool,
        /// eighth input
        in_8: bool,
        /// ninth input
        in_9: bool,
        /// tenth input
        in_10: bool,
        /// eleventh input
        in_11: bool,
        /// twelfth input
        in_12: bool,
        /// thirteenth input
        in_13: bool,
        /// fourteenth input
        in_14: bool,
        /// fifteenth input
        in_15: bool,
        /// sixteenth input
        in_16: bool,
    }
}

signals! {
    /// What it gives.
    Outputs {
        /// its result
        out: bool,
    }
}

failures! {
    /// How it fails.
    Failure {
        /// its contact never closes
        Open = "open",
        /// its contact is welded
        Welded = "welded",
    }
}

/// What it remembers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    /// For how long its result would be true.
    since_s: Option<f64>,
}

/// A logic gate, by its parameters.
pub(crate) struct Gate {
    p: Parameters,
}

impl Gate {
    fn result(&self, i: &Inputs) -> bool {
        let all = [
            i.in_1, i.in_2, i.in_3, i.in_4, i.in_5, i.in_6, i.in_7, i.in_8, i.in_9, i.in_10, i.in_11, i.in_12, i.in_13,
            i.in_14, i.in_15, i.in_16,
        ];
        let mut used = all.into_iter().take(self.p.inputs as usize);
        match self.p.function {
            Function::And => used.all(|input| input),
            Function::Or => used.any(|input| input),
            Function::Nand => !used.all(|input| input),
            Function::Nor => !used.any(|input| input),
        }
    }
}

impl Component for Gate {
    const NAME: &'static str = "gate";
    const SUMMARY: &'static str = "logic gate: and, or, nand, nor of up to 16 inputs, with an on-delay";
    const FORMULA: &'static [&'static str] = &["out = function(in_1 … in_n), delay_s after it became true"];
    const SOURCE: &'static str = "IEC 60617-12, binary logic elements";
    own_types!();

    fn new(p: Parameters) -> Self {
        Self { p }
    }

    fn uses(p: &Parameters, input: usize) -> bool {
        input < p.inputs as usize
    }

    fn initial(&self, _: &Start) -> State {
        State::default()
    }

    fn sense(&self, state: &mut State, inputs: &Inputs, turn: &Turn) -> Outputs {
        let since_s = state.since_s.map_or(0.0, |since_s| since_s + turn.dt_s);
        state.since_s = self.result(inputs).then_some(since_s);
        let due = state.since_s.is_some_and(|since_s| is_over(since_s, self.p.delay_s));
        let out = (due || turn.failed.has(Failure::Welded)) && !turn.failed.has(Failure::Open);
        Outputs { out }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::tests::Rig;

    fn gate(function: Function, inputs: u32) -> Rig<Gate> {
        Rig::new(Gate::new(Parameters { function, inputs, ..Parameters::default() }))
    }

    fn reported(function: Function, in_1: bool, in_2: bool) -> bool {
        gate(function, 2).run(Inputs { in_1, in_2, in_16: true, ..Inputs::default() }, 0.01, 1).out
    }

    #[test]
    fn each_function_has_its_table_of_truth() {
        let cases = [(false, false), (false, true), (true, false), (true, true)];
        let table = |function: Function| cases.map(|(a, b)| reported(function, a, b));
        assert_eq!(table(Function::And), [false, false, false, true]);
        assert_eq!(table(Function::Or), [false, true, true, true]);
        assert_eq!(table(Function::Nand), [true, true, true, false]);
        assert_eq!(table(Function::Nor), [true, false, false, false]);
        assert!(gate(Function::Or, 16).run(Inputs { in_16: true, ..Inputs::default() }, 0.01, 1).out);
    }

    #[test]
    fn it_waits_for_its_delay() {
        let mut rig = Rig::new(Gate::new(Parameters { inputs: 1, delay_s: 0.05, ..Parameters::default() }));
        let on = Inputs { in_1: true, ..Inputs::default() };
        assert!(!rig.run(on, 0.01, 5).out && rig.run(on, 0.01, 1).out);
        assert!(!rig.run(Inputs::default(), 0.01, 1).out && !rig.run(on, 0.01, 5).out);
    }

    #[test]
    fn each_failure_has_its_effect() {
        assert!(gate(Function::And, 2).failing(Failure::Welded).run(Inputs::default(), 0.01, 1).out);
        assert!(!gate(Function::Nor, 2).failing(Failure::Open).run(Inputs::default(), 0.01, 1).out);
    }
}
