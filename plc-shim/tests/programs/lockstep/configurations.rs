//! Projects with a CONFIGURATION (2nd ed. 2.7): the scheduler is part of it.

use onescan_iec::input::kind::SourceKind;
use onescan_iec::{Input, TaskPlan};
use onescan_iec_project::instrument::{Options, diff, instrument, remove};
use onescan_iec_run::{Application, SoftPlc};

use super::driver::{Driver, scan};
use crate::rig::MS;

const TEXT: &str = "
PROGRAM Station
VAR_INPUT number : INT; END_VAR
VAR_OUTPUT count : INT; ready : BOOL; END_VAR
VAR_EXTERNAL trace : LINT; END_VAR
VAR rest : TON; END_VAR
    rest(IN := NOT rest.Q, PT := T#25ms);
    ready := rest.Q;
    count := count + 1;
    trace := trace * 5 + number;
END_PROGRAM
PROGRAM Watch
VAR_EXTERNAL trace : LINT; END_VAR
VAR_OUTPUT last : LINT; END_VAR
    last := trace;
    trace := trace * 5;
END_PROGRAM
CONFIGURATION Cell
VAR_GLOBAL
    trace : LINT;
    first : BOOL;
END_VAR
    RESOURCE Line ON Soft
        TASK slow (INTERVAL := T#20ms, PRIORITY := 1);
        (* the fast one *)
        TASK fast (INTERVAL := T#10ms, PRIORITY := 1);
        PROGRAM a WITH fast : Station (number := 1, ready => first);
        PROGRAM b WITH slow : Station (number := 2);
        PROGRAM c WITH fast : Station(* alone *)();
        PROGRAM watch : Watch;
    END_RESOURCE
END_CONFIGURATION
";

fn instrumented(text: &str) -> Vec<(String, String)> {
    let input = Input::from_text("cell.st", SourceKind::Text, text);
    let project = instrument(&[input], &Options::default()).unwrap_or_else(|error| panic!("{error}"));
    project.files.into_iter().map(|file| (file.name, file.text.expect("a text").to_string())).collect()
}

fn compiled(files: Vec<(String, String)>) -> (Application, TaskPlan) {
    let application = Application::from_sources(files).unwrap_or_else(|found| panic!("{found}"));
    let plan = application.configured_tasks().expect("a configuration");
    (application, plan)
}

#[test]
fn instances_of_one_program_take_their_own_turns() {
    let (plain, plan) = compiled(vec![("cell.st".to_owned(), TEXT.to_owned())]);
    let mut plain = SoftPlc::new(&plain, &plan).expect("the plan suits");
    let (shimmed, plan) = compiled(instrumented(TEXT));
    let mut driver = Driver::joined(&shimmed, &plan);
    for step in 1..60 {
        scan(&mut plain, step * 10 * MS);
        driver.step(step * 10 * MS);
        for path in ["trace", "first", "Line.a.count", "Line.b.count", "Line.c.ready", "Line.watch.last"] {
            let bytes = |plc: &SoftPlc| {
                let variable = plc.variable(path).expect("it exists");
                plc.memory()[variable.offset as usize..][..variable.size as usize].to_vec()
            };
            assert_eq!(bytes(&plain), bytes(&driver.rig.plc), "{path} in step {step}");
        }
    }
}

#[test]
fn the_scheduler_is_part_of_the_configuration_and_comes_out_again() {
    let input = Input::from_text("cell.st", SourceKind::Text, TEXT);
    let project = instrument(&[input], &Options::default()).expect("it is right");
    insta::assert_snapshot!(diff::unified(&project.files[0]));
    assert!(!project.files[1].text.as_deref().expect("a text").contains("VAR_GLOBAL"));
    let again: Vec<_> =
        instrumented(TEXT).into_iter().map(|(name, text)| Input::from_text(&name, SourceKind::Text, text)).collect();
    let twice = instrument(&again, &Options::default()).expect("it is right");
    assert!(twice.files.iter().all(|file| !file.is_changed()));
    assert_eq!(remove(&again).expect("it is marked").files[0].text.as_deref(), Some(TEXT));
}

/// Intervals and priorities are constant expressions (2nd ed. 2.7.2).
#[test]
fn intervals_may_be_constant_expressions() {
    let table = |declared: &str| {
        let text = format!(
            "VAR_GLOBAL CONSTANT cycle : TIME := 2 * T#5ms; half : TIME := cycle / 2; n : INT := 3; END_VAR
            VAR_GLOBAL other : TIME := T#1s; END_VAR
            PROGRAM P ; END_PROGRAM CONFIGURATION C
            RESOURCE R ON X TASK t ({declared}); PROGRAM p WITH t : P; END_RESOURCE END_CONFIGURATION"
        );
        let input = Input::from_text("c.st", SourceKind::Text, text);
        let project = instrument(&[input], &Options::default()).map_err(|error| error.to_string())?;
        let shim = project.files[1].text.as_deref().expect("a text").to_owned();
        let line = |name: &str| shim.lines().find(|line| line.contains(name)).unwrap_or("").trim().to_owned();
        Ok::<_, String>((line("Period :"), line("Rank :")))
    };
    let (period, rank) = table("INTERVAL := half + T#1ms, PRIORITY := (n - 1) * 2").expect("constants");
    assert!(period.contains(":= [6000000];") && rank.contains(":= [4];"), "{period} {rank}");
    for (declared, reported) in [
        ("INTERVAL := other, PRIORITY := 1", "INTERVAL other than a constant"),
        ("INTERVAL := T#1ms, PRIORITY := n - 4", "PRIORITY below 0"),
        ("INTERVAL := T#0s - half, PRIORITY := 1", "INTERVAL below 0"),
    ] {
        assert!(table(declared).is_err_and(|error| error.contains(reported)), "{declared}");
    }
}
