//! Tasks with SINGLE (2nd ed. 2.7.2, Table 50): edges start programs as the PLC's own scheduler has them start.

use std::collections::BTreeMap;

use onescan_iec::input::kind::SourceKind;
use onescan_iec::{Input, Task, TaskPlan};
use onescan_iec_project::instrument::{Options, Target, diff, instrument, remove};
use onescan_iec_run::{Application, SoftPlc};

use super::abreast::Abreast;
use super::driver::{Tasks, state};
use super::equivalence;
use crate::rig::{MS, task};

fn instrumented(text: &str) -> Vec<(String, String)> {
    let input = Input::from_text("cell.st", SourceKind::Text, text);
    let project = instrument(&[input], &Options::default()).unwrap_or_else(|error| panic!("{error}\n{text}"));
    project.files.into_iter().map(|file| (file.name, file.text.expect("a text").to_string())).collect()
}

fn compiled(files: &[(String, String)]) -> (Application, TaskPlan) {
    let application = Application::from_sources(files.to_owned()).unwrap_or_else(|found| panic!("{found}\n{files:#?}"));
    let plan = application.configured_tasks().expect("a configuration");
    (application, plan)
}

/// Every variable of `paths` and of the programs of the project itself.
fn all(plc: &SoftPlc, paths: &[&str]) -> BTreeMap<String, Vec<u8>> {
    let globals = paths.iter().map(|path| {
        let variable = plc.variable(path).expect("it exists");
        let bytes = plc.memory()[variable.offset as usize..][..variable.size as usize].to_vec();
        ((*path).to_owned(), bytes)
    });
    // Inputs are connected in idle scans, too.
    let own = |path: &str| !path.contains("SDSP") && !path.ends_with(".number");
    state(plc).into_iter().filter(|(path, _)| own(path)).chain(globals).collect()
}

/// Runs a project with a CONFIGURATION on its own clock, not simulated, and under the scheduler, side by side.
pub(crate) fn assert_equal(text: &str, globals: &[&str], inputs: &[&str], times: &[u64]) {
    let (plain, plan) = compiled(&[("cell.st".to_owned(), text.to_owned())]);
    let plain = SoftPlc::new(&plain, &plan).expect("the plan suits");
    let (shimmed, plan) = compiled(&instrumented(text));
    let mut plcs = Abreast::new(plain, &shimmed, &plan, &plan);
    for (step, t_v) in (0..).zip(times) {
        plcs.step(step, *t_v, inputs);
        let expected = all(&plcs.plain, globals);
        assert!(expected.len() > globals.len());
        // What falls from outside is seen when the scheduler has run: a cycle late for an interval that is suspended.
        if !text.contains("SINGLE := i, INTERVAL") {
            assert_eq!(expected, all(&plcs.inert, globals), "not simulated, t_v = {t_v}\n{text}");
        }
        assert_eq!(expected, all(plcs.granted(), globals), "granted, t_v = {t_v}\n{text}");
    }
}

const CELL: &str = "
PROGRAM Press
VAR_INPUT number : INT; END_VAR
VAR_OUTPUT n : INT; full, done : BOOL; END_VAR
VAR_EXTERNAL trace : LINT; END_VAR
VAR rest : TON; END_VAR
    n := n + 1;
    full := n MOD 3 = 0;
    rest(IN := NOT rest.Q, PT := T#25ms);
    done := rest.Q;
    trace := trace * 7 + number;
END_PROGRAM
CONFIGURATION Cell
VAR_GLOBAL
    trace : LINT;
    start, ready : BOOL;
END_VAR
    RESOURCE Line ON Soft
        TASK slow (INTERVAL := T#20ms, PRIORITY := 2);
        TASK fast (INTERVAL := T#10ms, PRIORITY := 3);
        TASK event (SINGLE := start, PRIORITY := 1);
        TASK chain (SINGLE := b.full, PRIORITY := 1);
        TASK both (SINGLE := ready, INTERVAL := T#20ms, PRIORITY := 2);
        PROGRAM a WITH slow : Press (number := 1, done => ready);
        PROGRAM b WITH event : Press (number := 2);
        PROGRAM c WITH chain : Press (number := 3);
        PROGRAM d WITH fast : Press (number := 4, done => Packing.go);
        PROGRAM e WITH both : Press (number := 5);
        PROGRAM f WITH event : Press (number := 6); (* behind b *)
        PROGRAM rest : Press;
    END_RESOURCE
    RESOURCE Packing ON Soft
        VAR_GLOBAL go : BOOL; END_VAR
        TASK pack (SINGLE := go, PRIORITY := 4);
        TASK follow (SINGLE := p.full, PRIORITY := 0);
        PROGRAM p WITH pack : Press (number := 7);
        PROGRAM q WITH follow : Press (number := 8);
    END_RESOURCE
END_CONFIGURATION
";

#[test]
fn edges_of_globals_and_outputs_start_their_tasks() {
    let times: Vec<u64> = (1..120).map(|step| step * 10 * MS).collect();
    let globals = ["trace", "start", "ready", "Packing.go"];
    assert_equal(CELL, &globals, &["start"], &times);
    let uneven: Vec<u64> = (1..120_u64).map(|step| (step * 10 + step / 3 * 20 + step / 7 * 50) * MS).collect();
    assert_equal(CELL, &globals, &["start"], &uneven);
}

#[test]
fn tasks_with_single_are_part_of_the_configuration_and_come_out_again() {
    let input = Input::from_text("cell.st", SourceKind::Text, CELL);
    let project = instrument(&[input], &Options::default()).expect("it is right");
    insta::assert_snapshot!("single_configuration", diff::unified(&project.files[0]));
    insta::assert_snapshot!("single_shim", project.files[1].text.as_deref().expect("a text"));
    let again: Vec<_> =
        instrumented(CELL).into_iter().map(|(name, text)| Input::from_text(&name, SourceKind::Text, text)).collect();
    let twice = instrument(&again, &Options::default()).expect("it is right");
    assert!(twice.files.iter().all(|file| !file.is_changed()));
    assert_eq!(remove(&again).expect("it is marked").files[0].text.as_deref(), Some(CELL));
}

/// A program that runs at each edge of a variable, wherever that edge is made.
const EDGES: &str = "
VAR_GLOBAL trace : LINT; a, b : BOOL; END_VAR
PROGRAM Main VAR_INPUT i, j : BOOL; END_VAR VAR_OUTPUT n : INT; END_VAR
    n := n + 1; a := i; IF j THEN b := NOT b; END_IF; trace := trace * 5 + 1;
END_PROGRAM
PROGRAM OnA VAR_OUTPUT n : INT; t : LINT; END_VAR n := n + 1; b := n MOD 2 = 1; trace := trace * 5 + 2; t := trace;
END_PROGRAM
PROGRAM OnB VAR_OUTPUT n : INT; t : LINT; END_VAR n := n + 1; a := NOT a; trace := trace * 5 + 3; t := trace;
END_PROGRAM
PROGRAM Also VAR_OUTPUT n : INT; END_VAR n := n + 1; b := n MOD 5 = 0; trace := trace * 5 + 4; END_PROGRAM";

fn edges() -> Vec<Task> {
    let on = |name: &str, single: &str, ms: u64, priority: u32, programs: &[&str]| Task {
        single: Some(single.to_owned()),
        ..task(name, ms, priority, programs)
    };
    vec![
        on("on_b", "b", 0, 0, &["OnB"]),
        task("main", 10, 1, &["Main"]),
        on("on_a", "a", 15, 1, &["OnA"]),
        on("also", "A", 0, 1, &["Also"]),
    ]
}

#[test]
fn edges_start_tasks_that_are_given() {
    let lengths = [300_000, 7 * MS, 13 * MS, 1, 40 * MS, 19_999_999, 5 * MS, 101 * MS];
    let times = lengths.iter().cycle().take(150).scan(0, |now, length| {
        *now += length;
        Some(*now)
    });
    let times: Vec<u64> = times.collect();
    for form in [Tasks::Kept, Tasks::Moved] {
        equivalence::assert_equal("edges", EDGES, &edges(), &["Main.i", "Main.j"], &times, form);
    }
}

#[test]
fn a_project_without_single_has_nothing_of_it() {
    let text = CELL.replace("SINGLE := start", "INTERVAL := T#50ms").replace("SINGLE := b.full", "INTERVAL := T#50ms");
    let text = text.replace("SINGLE := ready, ", "").replace("SINGLE := go", "INTERVAL := T#50ms");
    let text = text.replace("SINGLE := p.full", "INTERVAL := T#50ms");
    for (_, text) in instrumented(&text) {
        for word in ["SDSP_Single", "SDSP_Event", "SDSP_Follow", "Edge", "Level", "(*$"] {
            assert!(!text.contains(word), "{word}\n{text}");
        }
    }
}

#[test]
fn what_no_edge_can_start_is_refused() {
    let refused = |text: &str, target: Target, tasks: Option<Vec<Task>>| {
        let input = Input::from_text("c.st", SourceKind::Text, text);
        instrument(&[input], &Options { target, tasks, ..Options::default() }).expect_err("refused").to_string()
    };
    let of = |task: &str| {
        format!(
            "PROGRAM P ; END_PROGRAM CONFIGURATION C VAR_GLOBAL g : BOOL; END_VAR
            RESOURCE R ON X {task} PROGRAM p WITH t : P; END_RESOURCE END_CONFIGURATION"
        )
    };
    insta::assert_snapshot!(refused(&of("TASK t (SINGLE := g AND g);"), Target::Iec, None), @"c.st:2:37: error[L0501]: SINGLE other than a variable is not instrumented yet");
    let given = Some(vec![task("t", 10, 1, &["p"])]);
    insta::assert_snapshot!(refused(&of("TASK t (SINGLE := g);"), Target::Iec, given), @"c.st:2:34: error[L0501]: a task with SINGLE is not instrumented where other tasks are given (leave it to the configuration which tasks there are)");
    insta::assert_snapshot!(refused(&of("TASK t (SINGLE := g);"), Target::Codesys, None), @"c.st:2:34: error[L0501]: a task with SINGLE is instrumented in program text for the target iec only (give the task an INTERVAL, or choose that target)");
    insta::assert_snapshot!(refused(&of("TASK t (SINGLE := g);"), Target::Scl, None), @"c.st:2:34: error[L0501]: a task with SINGLE is instrumented in program text for the target iec only (give the task an INTERVAL, or choose that target)");
    let on = |path: &str| Some(vec![Task { single: Some(path.to_owned()), ..task("t", 0, 1, &["Main"]) }]);
    insta::assert_snapshot!(refused(EDGES, Target::Iec, on("Main.i")), @"task `t` is triggered by `Main.i`: the scheduler reads a global variable");
    insta::assert_snapshot!(refused(EDGES, Target::TwinCat, on("a")), @"task `t` is triggered by `a`: tasks of TwinCAT are cyclic");
    let mut none = edges();
    none[0].single = None;
    insta::assert_snapshot!(refused(EDGES, Target::Iec, Some(none)), @"task `on_b` has neither an interval nor a trigger");
}

#[test]
fn a_task_without_an_interval_is_scheduled_as_programs_without_a_task_are() {
    let project = |task: &str| {
        let text = format!(
            "PROGRAM P VAR n : INT; END_VAR n := n + 1; END_PROGRAM
            CONFIGURATION C TASK fast (INTERVAL := T#10ms, PRIORITY := 2); TASK t (PRIORITY := 1);
            PROGRAM q WITH fast : P; PROGRAM p{task} : P; END_CONFIGURATION"
        );
        instrumented(&text).into_iter().map(|(_, text)| text.replace(" WITH t :", " :")).collect::<Vec<_>>()
    };
    assert_eq!(project(" WITH t"), project(""));
}
