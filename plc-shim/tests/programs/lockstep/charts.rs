//! Charts on virtual time: what is written, and that it is the same.

use onescan_iec::Input;
use onescan_iec::input::kind::SourceKind;
use onescan_iec_project::instrument::{Options, Target, diff, instrument, remove};
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
    assert!(emitted.contains("END_WHILE; IF SDSP_Left_Count THEN EXIT; END_IF;"), "{emitted}");
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

const WASH: &str = "PROGRAM Wash
VAR_INPUT go : BOOL; END_VAR
VAR_OUTPUT drum : BOOL; turns, rests : INT; END_VAR
    INITIAL_STEP Idle: END_STEP
    STEP Run: Turn(N); Rest(P0); END_STEP
    TRANSITION FROM Idle TO Run := go; END_TRANSITION
    TRANSITION FROM Run TO Idle := NOT go; END_TRANSITION
    ACTION Turn:
        INITIAL_STEP Soak: END_STEP
        STEP Spin: drum(L, T#20ms); Count(P1); END_STEP
        TRANSITION FROM Soak TO Spin := Soak.T >= T#30ms; END_TRANSITION
        TRANSITION FROM Spin TO Soak := TRUE; END_TRANSITION
    END_ACTION
    ACTION Count: turns := turns + 1; END_ACTION
    ACTION Rest: rests := rests + 1; END_ACTION
END_PROGRAM
";

#[test]
fn a_chart_in_an_action_is_put_on_virtual_time() {
    let project = instrument(&[Input::from_text("wash.st", SourceKind::Text, WASH)], &Options::default());
    let project = project.unwrap_or_else(|error| panic!("{error}"));
    insta::assert_snapshot!(diff::unified(&project.files[0]));
}

#[test]
fn the_time_of_an_inner_step_is_read_in_its_chart() {
    let text = WASH.replace("NOT go", "Soak.T > T#1s");
    let refused = instrument(&[Input::from_text("wash.st", SourceKind::Text, text)], &Options::default());
    insta::assert_snapshot!(refused.err().map_or_else(String::new, |error| error.to_string()));
}

#[test]
fn what_cannot_be_put_on_virtual_time_is_reported() {
    let text =
        MIXER.replace("FROM Fill TO Idle", "FROM Fill TO Fill := start; END_TRANSITION TRANSITION FROM Fill TO Idle");
    let input = Input::from_text("mixer.st", SourceKind::Text, text);
    let project = instrument(&[input], &Options::default()).unwrap_or_else(|error| panic!("{error}"));
    insta::assert_snapshot!(project.warnings);
}

/// A chart, or one that is the body of an action: the same under grants.
fn is_the_same(text: &str, inputs: Vec<([bool; INPUTS], bool)>) -> Result<(), TestCaseError> {
    let tasks = [task("main", 10, 0, &["P"])];
    let mut plain = original(text, &tasks);
    let mut driver = Driver::joined(&application(text, &tasks), &own_plan(&tasks, Tasks::Moved));
    for (step, (inputs, go)) in inputs.into_iter().enumerate() {
        let t_v = (step as u64 + 1) * 10 * MS;
        let named = (0..).map(|number| format!("P.c{number}")).zip(inputs);
        let go = text.contains("Inner").then(|| ("P.go".to_owned(), go));
        for (path, value) in named.chain(go) {
            write(&mut plain, &path, i64::from(value));
            driver.rig.set(&path, i64::from(value));
        }
        scan(&mut plain, t_v);
        driver.step(t_v);
        driver.cycles(step as u32 % 3);
        prop_assert_eq!(state(&plain), state(&driver.rig.plc), "t_v = {} ms\n{}", t_v / MS, text);
    }
    Ok(())
}

/// An action that is a chart, called by a program that is not a chart.
#[test]
fn a_chart_that_statements_call_gives_the_same_under_grants() {
    let text = "PROGRAM P
VAR c0, c1, c2, c3, go : BOOL; n : INT; END_VAR
    ACTION Inner:
        INITIAL_STEP A: Count(L, T#20ms); END_STEP
        STEP B: Count(P0); END_STEP
        TRANSITION FROM A TO B := A.T >= T#30ms; END_TRANSITION
        TRANSITION FROM B TO A := c0; END_TRANSITION
    END_ACTION
    ACTION Count: n := n + 1; END_ACTION
    IF go THEN Inner(); END_IF;
END_PROGRAM
";
    let inputs = (0..40).map(|scan| ([scan % 3 == 0, false, false, false], scan % 5 != 0));
    is_the_same(text, inputs.collect()).unwrap_or_else(|error| panic!("{error}"));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 12, ..ProptestConfig::default() })]

    #[test]
    fn random_charts_give_the_same_under_grants(
        part in arbitrary_part(),
        numbers in prop::collection::vec(any::<u32>(), 61),
        inputs in prop::collection::vec((any::<[bool; INPUTS]>(), prop::bool::weighted(0.7)), 40),
    ) {
        let chart = Chart::new(&part, &numbers);
        is_the_same(&chart.text(), inputs.clone())?;
        is_the_same(&chart.nested(), inputs.clone())?;
        is_the_same(&format!("{{dialect 'matiec'}}\n{}", chart.text()), inputs)?;
    }
}
