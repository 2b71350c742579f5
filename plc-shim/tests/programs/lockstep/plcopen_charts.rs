//! Charts that are drawn, on virtual time: instrumented in place, taken back, and the same in lockstep.

use onescan_iec::{Task, TaskPlan};
use onescan_iec_project::instrument::{Options, Target, diff, instrument};
use onescan_iec_run::{Application, SoftPlc};
use proptest::prelude::*;

use super::abreast::Abreast;
use super::driver::{Driver, Tasks, own_plan, scan, state, write};
use super::equivalence::free_plan;
use super::plcopen_xml::{read, round_trip, text};
use crate::plcopen::{block, contact, input as variable, output, pou, project, rail};
use crate::rig::{MS, task};
use crate::sfc::chart::{Chart, INPUTS, arbitrary_part};
use crate::sfc::drawn::{Step, Transition, chart, condition, negated};
use crate::sfc::plcopen::chart_in_an_action;

const MIXER: &str = include_str!("../../inputs/mixer.xml");

fn compiled(text: &str) -> Application {
    Application::from_inputs([read(text)]).unwrap_or_else(|found| panic!("{found}\n{text}"))
}

/// Original, instrumented and not simulated, instrumented under grants, with BOOL inputs in a pattern.
pub(super) fn assert_equal(given: &str, tasks: &[Task], inputs: &[&str]) {
    for target in [Target::Iec, Target::Codesys] {
        let options = Options { target, tasks: Some(tasks.to_vec()), ..Options::default() };
        let project = round_trip(given, &options);
        assert_eq!(project.warnings.to_string(), "");
        if target == Target::Codesys {
            // Its conversions of times are CODESYS' own.
            continue;
        }
        let shimmed = compiled(&text(&project));
        let plain = SoftPlc::new(&compiled(given), &TaskPlan::new(tasks.to_vec())).expect("the plan suits");
        let mut plcs = Abreast::new(plain, &shimmed, &free_plan(tasks), &own_plan(tasks, Tasks::Moved));
        for step in 1..120_u64 {
            let t_v = step * 5 * MS;
            plcs.step(step, t_v, inputs);
            let expected = changing(&plcs.plain);
            assert_eq!(expected, changing(&plcs.inert), "not simulated, t_v = {t_v}\n{}", text(&project));
            assert_eq!(expected, changing(plcs.granted()), "granted, t_v = {t_v}\n{}", text(&project));
        }
    }
}

/// All but what a chart notes of transitions that were cleared, in idle scans too.
fn changing(plc: &SoftPlc) -> Vec<(String, Vec<u8>)> {
    let is_note = |path: &str| {
        let name = path.rsplit('.').next().unwrap_or(path);
        name.starts_with("transition_") || ["full", "mixed", "ready", "listed", "cleared"].contains(&name)
    };
    state(plc).into_iter().filter(|(path, _)| !is_note(path)).collect()
}

#[test]
fn a_drawn_chart_is_changed_in_place_and_comes_back_byte_for_byte() {
    let options =
        Options { target: Target::Iec, tasks: Some(vec![task("main", 10, 1, &["Mixer"])]), ..Options::default() };
    let project = round_trip(MIXER, &options);
    assert_eq!(project.warnings.to_string(), "");
    let (chart, _) =
        text(&project).split_once("SDSP_Scheduler").map(|(chart, rest)| (chart.to_owned(), rest.len())).unwrap();
    assert!(chart.contains("<reference name=\"SDSP_Own_valve\"/><!--@sdsp was valve-->"), "{chart}");
    let shown = diff::unified(&project.files[0]);
    let shown = shown.split_once("<pou name=\"SDSP_Scheduler\"").map_or("", |(shown, _)| shown);
    insta::assert_snapshot!(shown);
    for target in [Target::Iec, Target::Codesys] {
        round_trip(
            &MIXER.replace('\n', "\r\n"),
            &Options { target, tasks: options.tasks.clone(), ..Options::default() },
        );
    }
}

#[test]
fn a_drawn_chart_gives_the_same_at_the_same_time() {
    let given = MIXER.replace("level &gt;= 80", "NOT start OR Fill.T &gt; T#40ms");
    assert_equal(&given, &[task("main", 10, 1, &["Mixer"])], &["Mixer.start"]);
}

/// Actions of every qualifier, `Q` of one, times of steps in actions and durations, a chart in a function block,
/// conditions of every form.
fn forms() -> String {
    let action = |qualifier, time: &str, does: &str| (qualifier, time.to_owned(), does.to_owned());
    let steps = [
        Step { name: "Idle", actions: vec![action("R", "", "s"), action("R", "", "sd"), action("R", "", "sl")] },
        Step {
            name: "A",
            actions: vec![
                action("N", "", "Work"),
                action("L", "T#20ms", "l"),
                action("D", "T#15ms", "d"),
                action("P", "", "p"),
                action("S", "", "s"),
                action(
                    "P1",
                    "",
                    "<inline><ST><p xmlns=\"http://www.w3.org/1999/xhtml\">pulses := pulses + 1; (* -- &amp;amp; --- *)</p></ST></inline>",
                ),
            ],
        },
        Step {
            name: "B",
            actions: vec![
                action("SD", "A.T + T#10ms", "sd"),
                action("DS", "T#20ms", "ds"),
                action("SL", "T#30ms", "sl"),
                action(
                    "P0",
                    "",
                    "<inline><ST><![CDATA[IF B.T > T#1ms & TRUE THEN\n pulses := pulses + 10;\nEND_IF;]]></ST></inline>",
                ),
            ],
        },
    ];
    let wired = |id: u32| {
        format!("<connectionPointIn><connection refLocalId=\"{id}\" formalParameter=\"OUT\"/></connectionPointIn>")
    };
    let go = |from: usize, to: usize, condition: String, elements: String| Transition {
        from: vec![from],
        to: vec![to],
        priority: None,
        condition,
        elements,
    };
    let late = variable(50, (0, 0), "A.T")
        + &variable(51, (0, 20), "T#25ms")
        + &block(52, (50, 0), "GE", "IN1=50 IN2=51", "OUT", "");
    let rung = rail(55) + &contact(53, (0, 0), "55", "i", "") + &contact(54, (0, 20), "55", "j", "negated=\"true\"");
    let either =
        "<connectionPointIn><connection refLocalId=\"53\"/><connection refLocalId=\"54\"/></connectionPointIn>";
    let transitions = [
        go(0, 1, condition("<reference name=\"ready\"/>"), String::new()),
        go(1, 2, condition(&wired(52)), late),
        go(1, 0, condition("<reference name=\"listed\"/>"), String::new()),
        go(2, 0, negated("<reference name=\"i\"/>"), String::new()),
        go(2, 1, negated(either), rung),
        go(2, 1, negated("<reference name=\"cleared\"/>"), String::new()),
    ];
    let fbd = variable(1, (0, 0), "i")
        + &variable(2, (0, 20), "j")
        + &block(3, (50, 0), "AND", "IN1=1 !IN2=2", "OUT", "")
        + &output(4, (90, 0), "3.OUT", "ready", "");
    let parts = format!(
        "</interface><actions><action name=\"Work\"><body><ST><p>n := n + 1; q := Work.Q; t := A.T;\n</p></ST></body></action>\
         </actions><transitions><transition name=\"ready\"><body><FBD>{fbd}</FBD></body></transition>\
         <transition name=\"cleared\"><body><ST><p>cleared := i;\nIF B.T &lt; T#10ms THEN\n cleared := TRUE;\nEND_IF;\n</p></ST>\
         </body></transition><transition name=\"listed\"><body><IL>\nLD i\nAND j\n</IL></body></transition></transitions>"
    );
    let sections = "in i : BOOL, j : BOOL; out n : INT, pulses : INT, t : TIME, q : BOOL, l : BOOL, d : BOOL, p : BOOL, s : BOOL, sd : BOOL, ds : BOOL, sl : BOOL";
    let sfc = chart(&steps, &transitions);
    let block = pou("functionBlock", "Blink", sections, "SFC", &sfc).replace("</interface>", &parts);
    let caller = "b(i := i, j := NOT j); n := b.n; late := b.sl;";
    let main = pou("program", "Main", "in i : BOOL, j : BOOL; local b : Blink, n : INT, late : BOOL", "ST", caller);
    project(&(block + &pou("program", "P", sections, "SFC", &sfc).replace("</interface>", &parts) + &main))
}

#[test]
fn conditions_and_actions_of_every_form_give_the_same() {
    let tasks = [task("main", 5, 1, &["P", "Main"])];
    assert_equal(&forms(), &tasks, &["P.i", "P.j", "Main.i", "Main.j"]);
}

/// With statements in a step of the inner one; with the time of its step; and in a unit that is not a chart itself.
#[test]
fn a_chart_in_an_action_gives_the_same() {
    let tasks = [task("main", 5, 1, &["P"])];
    let inputs = ["P.i", "P.stop"];
    let given = chart_in_an_action();
    assert_equal(&given, &tasks, &inputs);
    let timed = given.replace("n := n + 1;", "IF Spin.T &gt; T#7ms THEN n := n + 1; END_IF;");
    assert_ne!(timed, given);
    assert_equal(&timed, &tasks, &inputs);
    let (before, rest) = given.rsplit_once("<body><SFC>").expect("the unit's own chart");
    let (_, behind) = rest.split_once("</body>").expect("its end");
    let called = "IF i OR stop THEN Turn(); END_IF;";
    let text = format!("{before}<body><ST><p xmlns=\"http://www.w3.org/1999/xhtml\">{called}</p></ST></body>{behind}");
    assert_equal(&text, &tasks, &inputs);
}

/// The project that `tests/program/plcopen_schema.rs` holds against TC6's schema.
#[test]
fn a_project_in_every_language_gives_the_same() {
    let tasks =
        [task("Fast", 5, 1, &["Chart", "Caller", "Drives"]), task("Slow", 10, 2, &["Text", "Net", "Rung", "List"])];
    let inputs = [
        "Chart.i", "Chart.j", "Caller.i", "Caller.j", "Drives.i", "Drives.j", "Text.go", "Net.go", "Rung.go", "List.go",
    ];
    // Without its own tasks, so that programs have the same names in both.
    let given = include_str!("../../inputs/languages.xml");
    let cut = |name: &str| given.split_once(name).expect("it has tasks");
    let ((before, _), (_, behind)) = (cut("<configurations>"), cut("</configurations>"));
    assert_equal(&format!("{before}<configurations/>{behind}"), &tasks, &inputs);
}

#[test]
fn what_of_a_drawn_chart_is_not_instrumented_is_reported() {
    let reported = |from: &str, to: &str| {
        let given = forms().replace(from, to);
        assert_ne!(given, forms());
        let options =
            Options { target: Target::Iec, tasks: Some(vec![task("main", 5, 1, &["P"])]), ..Options::default() };
        match instrument(&[read(&given)], &options) {
            Ok(_) => panic!("it is instrumented: {to}"),
            Err(error) => error.to_string(),
        }
    };
    let plain = block(52, (50, 0), "GE", "IN1=50 IN2=51", "OUT", "");
    let all = [
        reported(&plain, &plain.replace("formalParameter=\"IN1\"", "formalParameter=\"IN1\" edge=\"rising\"")),
        reported("LD i\nAND j\n", "LD i\nST l\n"),
        reported(
            &output(4, (90, 0), "3.OUT", "ready", ""),
            &(output(4, (90, 0), "3.OUT", "ready", "") + &output(5, (90, 40), "3.OUT", "l", "")),
        ),
    ];
    insta::assert_snapshot!(all.join("\n"));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 12, ..ProptestConfig::default() })]

    #[test]
    fn random_drawn_charts_give_the_same_under_grants(
        part in arbitrary_part(),
        numbers in prop::collection::vec(any::<u32>(), 61),
        inputs in prop::collection::vec(any::<[bool; INPUTS]>(), 40),
    ) {
        let given = Chart::new(&part, &numbers).drawn();
        let tasks = [task("main", 10, 0, &["P"])];
        let project = round_trip(&given, &Options { target: Target::Iec, tasks: Some(tasks.to_vec()), ..Options::default() });
        let mut plain = SoftPlc::new(&compiled(&given), &TaskPlan::new(tasks.to_vec())).expect("the plan suits");
        let mut driver = Driver::joined(&compiled(&text(&project)), &own_plan(&tasks, Tasks::Moved));
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
            prop_assert_eq!(changing(&plain), changing(&driver.rig.plc), "t_v = {} ms\n{}", t_v / MS, given);
        }
    }
}
