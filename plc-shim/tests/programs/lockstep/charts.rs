//! Charts on virtual time: what is written, and that it is the same.

use onescan_plc_shim::Input;
use onescan_plc_shim::input::kind::SourceKind;
use onescan_plc_shim::instrument::{Options, Target, diff, instrument, remove};
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

/// A RETURN in a loop, comments in comments and an action without statements.
#[test]
fn statements_of_actions_come_back_byte_for_byte() {
    let text = MIXER.replace(
        "batches := batches + 1;",
        "WHILE batches < 9 DO (* & (**) *) batches := batches + 1; // no\r\nIF start THEN RETURN; END_IF; END_WHILE;",
    );
    let text = text.replace("END_PROGRAM", "ACTION Nothing: (* yet *) END_ACTION END_PROGRAM");
    let text = text.replace("Count(P1);", "Count(P1); Nothing(S);");
    let given = Input::from_text("mixer.st", SourceKind::Text, text.as_str());
    let project = instrument(&[given], &Options::default()).unwrap_or_else(|error| panic!("{error}"));
    let emitted = project.files[0].text.clone().expect("a text");
    assert!(emitted.contains("END_WHILE; IF SDSP_Left THEN EXIT; END_IF;"), "{emitted}");
    // Each line that has been moved knows where it was.
    let at = emitted.lines().position(|line| line.contains("motor := SDSP_Ctl_Count.Q")).expect("it is there");
    let was = text.lines().position(|line| line.contains("motor := Count.Q")).expect("it is there");
    assert_eq!(project.files[0].lines.original(at as u32 + 1), Some(was as u32 + 1));
    let back = remove(&[Input::from_text("mixer.st", SourceKind::Text, emitted)]).expect("its marks are whole");
    assert_eq!(back.files[0].text.as_deref(), Some(text.as_str()));
}

/// What vendors have goes on as it is: an action that is called by its name stays.
#[test]
fn an_action_that_is_called_stays_where_it_is() {
    let text = MIXER.replace("motor := Count.Q;", "motor := Count.Q; END_ACTION ACTION Again: Count();");
    let text = text.replace("Count(P1);", "Count(P1); Again(P0);");
    let project = instrument(&[Input::from_text("mixer.st", SourceKind::Text, text)], &Options::default());
    let emitted = project.unwrap_or_else(|error| panic!("{error}")).files[0].text.clone().expect("a text");
    assert!(emitted.contains("\n    ACTION Count:") && emitted.contains("        Count();\n    END_IF;"), "{emitted}");
    assert!(emitted.contains("(*@sdsp cut ACTION Again:"), "{emitted}");
}

/// CODESYS draws a chart as one network.
#[test]
fn every_step_of_a_chart_for_codesys_has_the_control() {
    let options = Options { target: Target::Codesys, ..Options::default() };
    let input = Input::from_text("mixer.st", SourceKind::Text, MIXER);
    let project = instrument(&[input], &options).unwrap_or_else(|error| panic!("{error}"));
    let drawn = project.files.last().and_then(|file| file.text.as_deref()).expect("a text");
    assert_eq!(drawn.matches("<reference name=\"SDSP_Control\"/>").count(), 2, "{drawn}");
    assert!(!drawn.contains("SDSP_Always"), "{drawn}");
}

#[test]
fn a_chart_in_an_action_is_refused() {
    let text = MIXER.replace("batches := batches + 1;", "INITIAL_STEP One: END_STEP").replace("motor := Count.Q;", "");
    let refused = instrument(&[Input::from_text("mixer.st", SourceKind::Text, text)], &Options::default());
    let told = refused.err().map_or_else(String::new, |error| error.to_string());
    assert!(told.contains("the chart in action `Count` is not put on virtual time"), "{told}");
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
