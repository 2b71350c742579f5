//! What is compiled is what the standard says, step by step, on random charts.

use proptest::prelude::*;

use super::chart::{BOOLEAN, Chart, INPUTS, arbitrary_part};
use super::interpret::Interpreter;
use crate::rig::{MS, Rig};

const SCANS: usize = 60;

proptest! {
    #![proptest_config(ProptestConfig { cases: 32, ..ProptestConfig::default() })]

    #[test]
    fn compiled_charts_do_what_the_interpreter_does(
        part in arbitrary_part(),
        numbers in prop::collection::vec(any::<u32>(), 61),
        inputs in prop::collection::vec(any::<[bool; INPUTS]>(), SCANS),
    ) {
        let chart = Chart::new(&part, &numbers);
        let text = chart.text();
        let mut rig = Rig::new(&text);
        let mut interpreter = Interpreter::new(&chart);
        for (scan, inputs) in inputs.into_iter().enumerate() {
            for (number, value) in inputs.into_iter().enumerate() {
                rig.set(&format!("P.c{number}"), i64::from(value));
            }
            rig.scan().expect("no fault");
            interpreter.scan(rig.now_ns / MS, inputs);
            let steps = 0..chart.steps;
            let flags: Vec<bool> = steps.clone().map(|step| rig.bool(&format!("P.s{step}.X"))).collect();
            prop_assert_eq!(&flags, &interpreter.active, "steps in scan {}\n{}", scan + 1, text);
            let times: Vec<u64> = steps.map(|step| rig.int(&format!("P.s{step}.T")) as u64 / MS).collect();
            prop_assert_eq!(&times, &interpreter.elapsed_ms, "times in scan {}\n{}", scan + 1, text);
            for action in (0..BOOLEAN).filter(|action| chart.uses.iter().any(|used| used.action == *action)) {
                let flag = rig.bool(&format!("P.b{action}"));
                prop_assert_eq!(flag, interpreter.flag(action), "b{} in scan {}\n{}", action, scan + 1, text);
            }
            prop_assert_eq!(rig.int("P.log") as u32, interpreter.log, "actions in scan {}\n{}", scan + 1, text);
        }
    }
}
