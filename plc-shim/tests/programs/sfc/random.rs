//! What is compiled is what the standard says, step by step, on random charts.

use proptest::prelude::*;

use super::chart::{BOOLEAN, Chart, INPUTS, arbitrary_part};
use super::interpret::Interpreter;
use crate::plcopen::rig;
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

    /// 2nd ed. Table 42, feature 4: a chart in an action goes on whenever that runs, and keeps its steps in between.
    #[test]
    fn a_chart_in_an_action_does_what_the_interpreter_does_when_it_runs(
        part in arbitrary_part(),
        numbers in prop::collection::vec(any::<u32>(), 61),
        inputs in prop::collection::vec((any::<[bool; INPUTS]>(), prop::bool::weighted(0.7)), SCANS),
    ) {
        let chart = Chart::new(&part, &numbers);
        let text = chart.nested();
        let mut rig = Rig::new(&text);
        let mut interpreter = Interpreter::new(&chart);
        let (mut on, mut ran) = (false, 0);
        for (scan, (inputs, go)) in inputs.into_iter().enumerate() {
            for (number, value) in inputs.into_iter().enumerate() {
                rig.set(&format!("P.c{number}"), i64::from(value));
            }
            rig.set("P.go", i64::from(go));
            rig.scan().expect("no fault");
            // Nothing is tested in the first scan; an action that ends has its final scan.
            let before = std::mem::replace(&mut on, scan > 0 && go);
            if on || before {
                interpreter.scan(rig.now_ns / MS, inputs);
                ran += 1;
            }
            let flags: Vec<bool> = (0..chart.steps).map(|step| rig.bool(&format!("P.s{step}.X"))).collect();
            prop_assert_eq!(&flags, &interpreter.active, "steps in scan {}\n{}", scan + 1, text);
            prop_assert_eq!(rig.int("P.log") as u32, interpreter.log, "actions in scan {}\n{}", scan + 1, text);
        }
        prop_assert!(ran > 0);
    }

    /// A drawn chart does what the same chart in text does.
    #[test]
    fn drawn_charts_are_the_same_as_charts_in_text(
        part in arbitrary_part(),
        numbers in prop::collection::vec(any::<u32>(), 61),
        inputs in prop::collection::vec(any::<[bool; INPUTS]>(), SCANS),
    ) {
        let chart = Chart::new(&part, &numbers);
        let (mut text, mut drawn) = (Rig::new(&chart.text()), rig(&chart.drawn()));
        for (scan, inputs) in inputs.into_iter().enumerate() {
            for (number, value) in inputs.into_iter().enumerate() {
                text.set(&format!("P.c{number}"), i64::from(value));
                drawn.set(&format!("P.c{number}"), i64::from(value));
            }
            text.scan().expect("no fault");
            drawn.scan().expect("no fault");
            let state = |rig: &Rig| {
                let steps = (0..chart.steps).map(|step| (rig.bool(&format!("P.s{step}.X")), rig.int(&format!("P.s{step}.T"))));
                let flags = (0..BOOLEAN).map(|action| rig.bool(&format!("P.b{action}")));
                (steps.collect::<Vec<_>>(), flags.collect::<Vec<_>>(), rig.int("P.log"))
            };
            prop_assert_eq!(state(&text), state(&drawn), "scan {}\n{}\n{}", scan + 1, chart.text(), chart.drawn());
        }
    }
}
