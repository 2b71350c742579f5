//! Projects in text for CODESYS: one file in PLCopen XML that is the same program, with the shim.

use std::path::Path;

use onescan_iec::input::kind::{FileKind, SourceKind};
use onescan_iec::{Dialect, Input, Severity, Task, TaskPlan};
use onescan_iec_project::instrument::{File, Options, Project, Target, instrument, remove};
use onescan_iec_run::{Application, SoftPlc};

use super::corpus::{cases, input};
use super::driver::{Driver, Tasks, own_plan, scan, state, write};
use crate::rig::{MS, task};

/// Programs that use what CODESYS' own data says in PLCopen XML.
const PRESS: &str = include_str!("../../inputs/press.st");

fn given(text: &str) -> Input {
    Input::from_text("plc/line.st", SourceKind::Text, text).in_dialect(Dialect::Codesys)
}

fn options(tasks: &[Task]) -> Options {
    Options { target: Target::Codesys, tasks: Some(tasks.to_vec()), ..Options::default() }
}

fn read(file: &File) -> Input {
    let kind = match FileKind::of(Path::new(&file.name)) {
        Some(FileKind::Source(kind)) => kind,
        other => panic!("{}: {other:?}", file.name),
    };
    Input::from_text(&file.name, kind, file.text.clone().expect("a text")).in_dialect(Dialect::Codesys)
}

/// Instrumented, once more, and taken back.
fn ported(text: &str, options: &Options) -> Result<Project, String> {
    let project = instrument(&[given(text)], options).map_err(|error| error.to_string())?;
    let names: Vec<&str> = project.files.iter().map(|file| file.name.as_str()).collect();
    assert_eq!((names, project.whole.as_deref()), (vec!["plc/line.st", "plc/sdsp.xml"], Some("plc/sdsp.xml")));
    assert!(!project.files[0].is_changed());
    let all: Vec<Input> = project.files.iter().map(read).collect();
    let twice = instrument(&all, options).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(twice.files.iter().filter(|file| file.is_changed()).count(), 0);
    let back = remove(&all).unwrap_or_else(|error| panic!("{error}"));
    let left: Vec<_> = back.files.iter().map(|file| (file.name.as_str(), file.text.as_deref())).collect();
    assert_eq!(left, [("plc/line.st", Some(text)), ("plc/sdsp.xml", None)]);
    Ok(project)
}

fn application(project: &Project) -> Application {
    let program = project.program().map(read).collect::<Vec<_>>();
    let text = program[0].file().text().clone();
    Application::from_inputs(program).unwrap_or_else(|found| panic!("{found}\n{text}"))
}

/// The original on its own tasks, and its port under grants: the same after every step.
///
/// # Errors
/// It has no form.
pub(super) fn assert_equal(
    text: &str,
    tasks: &[Task],
    inputs: &[&str],
    times: &[u64],
    form: Tasks,
) -> Result<(), String> {
    let plain = Application::from_inputs([given(text)]).unwrap_or_else(|found| panic!("{found}\n{text}"));
    let mut plain = SoftPlc::new(&plain, &TaskPlan::new(tasks.to_vec())).expect("the plan suits");
    let application = application(&ported(text, &options(tasks))?);
    let mut driver = Driver::joined(&application, &own_plan(tasks, form));
    for (step, t_v) in (0..).zip(times) {
        for (index, path) in inputs.iter().enumerate() {
            write(&mut plain, path, input(index, step));
            driver.rig.set(path, input(index, step));
        }
        scan(&mut plain, *t_v);
        driver.step(*t_v);
        driver.cycles((step % 4) as u32);
        assert_eq!(state(&plain), state(&driver.rig.plc), "{form:?}, t_v = {t_v}\n{text}");
    }
    Ok(())
}

#[test]
fn every_program_is_the_same_in_plcopen_xml() {
    let mut outcomes = Vec::new();
    let times: Vec<u64> = (1..=120).map(|step| step * 5 * MS).collect();
    for case in cases() {
        let mut forms = [Tasks::Kept, Tasks::Moved].into_iter();
        let outcome = forms.try_for_each(|form| assert_equal(case.text, &case.tasks, case.inputs, &times, form));
        let outcome = outcome.err().unwrap_or_else(|| "the same".to_owned());
        outcomes.push(format!("{}: {outcome}", case.name));
    }
    insta::assert_snapshot!(outcomes.join("\n"));
}

#[test]
fn the_file_holds_project_shim_and_tasks() {
    let text = "(* A line. *)\r\nPROGRAM Line\r\nVAR\r\n    go : BOOL; (* the button *)\r\n    delay : TON;\r\nEND_VAR\r\n    \
                delay(IN := go, PT := T#1s);\r\n    IF delay.Q THEN RETURN; END_IF; // so far\r\nEND_PROGRAM\r\n";
    let tasks = [task("fast", 10, 0, &["Line"])];
    let project = ported(text, &options(&tasks)).expect("it has a form");
    let xml = project.program().next().and_then(|file| file.text.as_deref()).expect("a text");
    // The scheduler and the timers are the shim's, and read elsewhere.
    let (line, shim) = xml.split_once("<pou name=\"SDSP_Scheduler\"").expect("the scheduler");
    let (_, tasks) = shim.split_once("<instances>").expect("tasks");
    insta::assert_snapshot!([line, "...\n<instances>", tasks].concat());
}

#[test]
fn everything_that_has_a_form_is_a_program() {
    let tasks = [task("main", 10, 0, &["Main", "List"])];
    let project = ported(PRESS, &options(&tasks)).expect("it has a form");
    let found = onescan_iec::inspect(project.program().map(read), None);
    assert!(found.iter().all(|each| each.severity != Severity::Error), "{found}");
}

#[test]
fn what_has_no_form_is_reported_with_its_place() {
    let text = "TYPE T : STRUCT n : INT; END_STRUCT; END_TYPE\nCLASS C END_CLASS\nPROGRAM P\nVAR r : REF_TO T; END_VAR\n    ;\nEND_PROGRAM\n";
    let refused = instrument(&[given(text)], &options(&[task("main", 10, 0, &["P"])])).expect_err("no form");
    insta::assert_snapshot!(refused);
    // Nothing of the kind is asked of a target that takes text.
    let iec = Options { target: Target::Iec, ..options(&[task("main", 10, 0, &["P"])]) };
    assert!(instrument(&[given(text)], &iec).is_ok());
}

/// A task with SINGLE is periodic in the file, and runs at the same edges.
#[test]
fn a_variable_starts_a_task() {
    let text = "VAR_GLOBAL go : BOOL; END_VAR\nPROGRAM P VAR_INPUT i : BOOL; END_VAR VAR n : INT; END_VAR\n    go := i;\n    \
                n := n + 1;\nEND_PROGRAM\nPROGRAM Q VAR n : INT; END_VAR n := n + 1; END_PROGRAM\n";
    let edges = Task { single: Some("go".to_owned()), ..task("edges", 0, 0, &["Q"]) };
    let tasks = [edges, task("main", 10, 1, &["P"])];
    let project = ported(text, &options(&tasks)).expect("it has a form");
    let xml = project.program().next().and_then(|file| file.text.as_deref()).expect("a text");
    let task = "<task name=\"edges\" interval=\"PT0.01S\" priority=\"1\">\n<pouInstance name=\"Q\"";
    assert!(xml.contains(task), "{xml}");
    let times: Vec<u64> = (1..=60).map(|step| step * 5 * MS).collect();
    assert_eq!(assert_equal(text, &tasks, &["P.i"], &times, Tasks::Moved), Ok(()));
    let configured = "PROGRAM P VAR n : INT; END_VAR n := n + 1; END_PROGRAM\nCONFIGURATION C\nVAR_GLOBAL go : BOOL; END_VAR\n\
                      RESOURCE r ON p\nTASK t (SINGLE := go);\nPROGRAM q WITH t : P;\nEND_RESOURCE\nEND_CONFIGURATION\n";
    let options = Options { target: Target::Codesys, tasks: None, ..Options::default() };
    let refused = instrument(&[given(configured)], &options).expect_err("no connections");
    assert!(refused.to_string().starts_with("plc/line.st:5:6: error[L0501]: a task with SINGLE is"), "{refused}");
}

/// A shim of another form that was there before goes.
#[test]
fn another_target_takes_the_place_of_the_one_before() {
    let text = "PROGRAM P VAR t : TON; END_VAR t(IN := TRUE, PT := T#1s); END_PROGRAM\n";
    let tasks = [task("main", 10, 0, &["P"])];
    let mut inputs = vec![given(text)];
    for (target, own, gone) in [
        (Target::Iec, "plc/sdsp.st", None),
        (Target::Codesys, "plc/sdsp.xml", Some("plc/sdsp.st")),
        (Target::Iec, "plc/sdsp.st", Some("plc/sdsp.xml")),
    ] {
        let options = Options { target, ..options(&tasks) };
        let project = instrument(&inputs, &options).unwrap_or_else(|error| panic!("{error}"));
        let (left, deleted): (Vec<_>, Vec<_>) = project.files.iter().partition(|file| file.text.is_some());
        assert_eq!(left.iter().map(|file| file.name.as_str()).collect::<Vec<_>>(), ["plc/line.st", own]);
        assert_eq!(deleted.first().map(|file| file.name.as_str()), gone);
        inputs = left.into_iter().map(read).collect();
    }
    let back = remove(&inputs).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(back.files[0].text.as_deref(), Some(text));
}
