//! Charts on virtual time: what is written, and that it is the same.

use onescan_plc_shim::Input;
use onescan_plc_shim::input::kind::SourceKind;
use onescan_plc_shim::instrument::{Options, diff, instrument};
use proptest::prelude::*;

use super::driver::{Driver, Tasks, application, original, own_plan, scan, state, write};
use crate::rig::{MS, task};
use crate::sfc::chart::{Chart, INPUTS, arbitrary_part};

const MIXER: &str = "PROGRAM Mixer
VAR_INPUT start : BOOL; END_VAR
VAR_OUTPUT valve, motor : BOOL; batches : INT; END_VAR
    INITIAL_STEP Idle: END_STEP
    STEP Fill:
        valve(L, T#2s);
        Count(P1);
    END_STEP
    TRANSITION FROM Idle TO Fill := start; END_TRANSITION
    TRANSITION FROM Fill TO Idle := Fill.T >= T#5s; END_TRANSITION
    ACTION Count:
        batches := batches + 1;
        motor := Count.Q;
    END_ACTION
END_PROGRAM
";

#[test]
fn a_chart_is_put_on_virtual_time() {
    let input = Input::from_text("mixer.st", SourceKind::Text, MIXER);
    let project = instrument(&[input], &Options::default()).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(project.warnings.to_string(), "");
    insta::assert_snapshot!(diff::unified(&project.files[0]));
}

#[test]
fn what_cannot_be_put_on_virtual_time_is_told() {
    let text =
        MIXER.replace("FROM Fill TO Idle", "FROM Fill TO Fill := start; END_TRANSITION TRANSITION FROM Fill TO Idle");
    let input = Input::from_text("mixer.st", SourceKind::Text, text);
    let project = instrument(&[input], &Options::default()).unwrap_or_else(|error| panic!("{error}"));
    insta::assert_snapshot!(project.warnings);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 12, ..ProptestConfig::default() })]

    #[test]
    fn random_charts_give_the_same_under_grants(
        part in arbitrary_part(),
        numbers in prop::collection::vec(any::<u32>(), 61),
        inputs in prop::collection::vec(any::<[bool; INPUTS]>(), 40),
    ) {
        let text = Chart::new(&part, &numbers).text();
        let tasks = [task("main", 10, 0, &["P"])];
        let mut plain = original(&text, &tasks);
        let mut driver = Driver::joined(&application(&text, &tasks), &own_plan(&tasks, Tasks::Moved));
        for (step, inputs) in inputs.into_iter().enumerate() {
            let t_v = (step as u64 + 1) * 10 * MS;
            for (number, value) in inputs.into_iter().enumerate() {
                let path = format!("P.c{number}");
                write(&mut plain, &path, i64::from(value));
                driver.rig.set(&path, i64::from(value));
            }
            scan(&mut plain, t_v);
            driver.step(t_v);
            driver.cycles(step as u32 % 3);
            prop_assert_eq!(state(&plain), state(&driver.rig.plc), "t_v = {} ms\n{}", t_v / MS, text);
        }
    }
}
