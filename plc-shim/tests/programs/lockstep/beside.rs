//! PLCopen XML beside program text in one project: each file gets what is its own of the shim, and a tool that imports
//! PLCopen XML gets one file.

use std::path::Path;

use onescan_iec::input::kind::{FileKind, SourceKind};
use onescan_iec::{Dialect, Input, Severity, Task, TaskPlan};
use onescan_iec_project::instrument::{Options, Project, Target, instrument, remove};
use onescan_iec_run::{Application, SoftPlc};

use super::driver::{Driver, Tasks, own_plan, scan, state, write};
use super::plcopen_xml::line;
use crate::plcopen::{block, input, output, pou, project};
use crate::rig::{MS, task};

const PROGRAMS: [&str; 5] = ["Text", "Net", "Rung", "List", "Plain"];

/// A program, its variables, and what the drawings need, in text; it needs a block that is drawn.
const PLAIN: &str = "VAR_GLOBAL total : INT; END_VAR
FUNCTION_BLOCK Delay
VAR_INPUT go : BOOL; END_VAR
VAR_OUTPUT done : BOOL; END_VAR
VAR t : TON; END_VAR
    t(IN := go, PT := T#30ms);
    done := t.Q;
END_FUNCTION_BLOCK
PROGRAM Plain
VAR go, done, late : BOOL; d : Delay; w : Watch; n : INT; END_VAR
VAR_EXTERNAL total : INT; END_VAR
    w(go := go);
    late := w.late;
    d(go := go);
    IF NOT d.done THEN RETURN; END_IF;
    n := n + 1;
    total := n;
END_PROGRAM
";

/// A block that is drawn, in a file of its own.
fn watch() -> String {
    let fbd = [
        input(1, (0, 0), "go"),
        input(2, (0, 20), "T#50ms"),
        block(3, (50, 0), "TOF off", "IN=1 PT=2", "Q ET", ""),
        output(4, (100, 0), "3.Q", "late", ""),
    ];
    project(&pou("functionBlock", "Watch", "in go : BOOL; out late : BOOL; local off : TOF", "FBD", &fbd.concat()))
}

type Named = (&'static str, String);

fn files() -> Vec<Named> {
    vec![("plc/line.xml", line()), ("plc/plain.st", PLAIN.to_owned()), ("plc/watch.xml", watch())]
}

fn read(name: &str, text: &str) -> Input {
    let kind = match FileKind::of(Path::new(name)) {
        Some(FileKind::Source(kind)) => kind,
        _ => SourceKind::Text,
    };
    Input::from_text(name, kind, text)
}

fn inputs(files: &[Named]) -> Vec<Input> {
    files.iter().map(|(name, text)| read(name, text)).collect()
}

fn emitted(project: &Project) -> Vec<Input> {
    project.program().map(|file| read(&file.name, file.text.as_deref().expect("a text"))).collect()
}

fn tasks() -> [Task; 2] {
    [task("fast", 10, 1, &["Text", "Net", "Plain"]), task("slow", 20, 2, &["Rung", "List"])]
}

/// Instrumented, once more, and taken back.
fn round_trip(files: &[Named], options: &Options) -> Project {
    let project = instrument(&inputs(files), options).unwrap_or_else(|error| panic!("{error}"));
    let all = |project: &Project| -> Vec<(String, String)> {
        let left = project.files.iter().filter_map(|file| Some((file.name.clone(), file.text.as_deref()?.to_owned())));
        left.collect()
    };
    let made = all(&project);
    let again: Vec<Input> = made.iter().map(|(name, text)| read(name, text)).collect();
    let twice = instrument(&again, options).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(all(&twice), made);
    let back = remove(&again).unwrap_or_else(|error| panic!("{error}"));
    let given: Vec<(String, String)> = files.iter().map(|(name, text)| ((*name).to_owned(), text.clone())).collect();
    assert_eq!(all(&back), given);
    project
}

fn compiled(files: Vec<Input>) -> Application {
    Application::from_inputs(files).unwrap_or_else(|found| panic!("{found}"))
}

/// The original on its own tasks, and the instrumented one under grants: the same after every step.
fn assert_equal(plain: &Application, plan: &TaskPlan, shimmed: &Application, own: &TaskPlan, prefix: &str) {
    let mut plain = SoftPlc::new(plain, plan).expect("the plan suits");
    let mut driver = Driver::joined(shimmed, own);
    for step in 1..80_u64 {
        for (index, name) in PROGRAMS.iter().enumerate() {
            let (path, value) = (format!("{prefix}{name}.go"), i64::from((step + 3 * index as u64) % 17 > 4));
            write(&mut plain, &path, value);
            driver.rig.set(&path, value);
        }
        scan(&mut plain, step * 10 * MS);
        driver.step(step * 10 * MS);
        driver.cycles((step % 4) as u32);
        let mut granted = state(&driver.rig.plc);
        granted.retain(|(path, _)| !path.starts_with("SDSP."));
        assert_eq!(state(&plain), granted, "step {step}");
    }
    assert!(driver.rig.int(&format!("{prefix}Plain.n")) > 10 && driver.rig.int(&format!("{prefix}Net.n")) > 50);
}

#[test]
fn every_file_has_its_part_of_the_shim() {
    for target in [Target::Iec, Target::TwinCat, Target::Codesys] {
        let options = Options { target, tasks: Some(tasks().to_vec()), ..Options::default() };
        let project = round_trip(&files(), &options);
        assert_eq!(project.warnings.to_string(), "", "{target:?}");
        let changed: Vec<&str> =
            project.files.iter().filter(|file| file.is_changed()).map(|file| file.name.as_str()).collect();
        let expected: &[&str] = match target {
            Target::Codesys => &["plc/sdsp.xml"],
            Target::TwinCat => &[
                "plc/line.xml",
                "plc/plain.st",
                "plc/watch.xml",
                "plc/SDSP.TcGVL",
                "plc/SDSP_Scheduler.TcPOU",
                "plc/SDSP_TOF.TcPOU",
                "plc/SDSP_TON.TcPOU",
            ],
            _ => &["plc/line.xml", "plc/plain.st", "plc/watch.xml", "plc/sdsp.st"],
        };
        assert_eq!(changed, expected, "{target:?}");
        assert_eq!(project.whole.as_deref(), (target == Target::Codesys).then_some("plc/sdsp.xml"));
        let plain = compiled(inputs(&files()));
        let shimmed = compiled(emitted(&project));
        for form in [Tasks::Kept, Tasks::Moved] {
            assert_equal(&plain, &TaskPlan::new(tasks().to_vec()), &shimmed, &own_plan(&tasks(), form), "");
        }
    }
}

/// The whole project is one file, and what was drawn is in it as it was.
#[test]
fn the_whole_project_keeps_its_drawings() {
    let options = Options { target: Target::Codesys, tasks: Some(tasks().to_vec()), ..Options::default() };
    let project = round_trip(&files(), &options);
    let whole = project.program().next().and_then(|file| file.text.as_deref()).expect("a text");
    let text = line();
    let (_, rest) = text.split_once("<FBD>").expect("a network");
    let (network, _) = rest.split_once("</FBD>").expect("its end");
    assert!(whole.contains(&network.replace("typeName=\"TON\"", "typeName=\"SDSP_TON\"")), "{whole}");
    assert!(!whole.contains("@sdsp begin") && !whole.contains("@sdsp was"), "marks are of no use there");
    for unit in ["Text", "Net", "Rung", "List", "Plain", "Delay", "Watch", "SDSP_Scheduler", "SDSP_TON", "SDSP_TOF"] {
        assert_eq!(whole.matches(&format!("<pou name=\"{unit}\"")).count(), 1, "{unit}");
    }
    let found = onescan_iec::inspect(emitted(&project), None);
    assert!(found.iter().all(|each| each.severity != Severity::Error), "{found}");
}

/// Two drawings alone, without any text.
#[test]
fn a_project_may_be_several_files_of_plcopen_xml() {
    let files = vec![("line.xml", line()), ("watch.xml", watch())];
    let tasks = [task("main", 10, 1, &["Text", "Net", "Rung", "List"])];
    for (target, own) in [(Target::Iec, "sdsp.st"), (Target::Codesys, "sdsp.xml")] {
        let project = round_trip(&files, &Options { target, tasks: Some(tasks.to_vec()), ..Options::default() });
        assert_eq!(project.files.last().map(|file| file.name.as_str()), Some(own));
        assert!(compiled(emitted(&project)).programs().count() >= 5);
    }
}

/// The configuration is drawn or written, and runs the programs of both.
#[test]
fn a_configuration_runs_programs_of_all_files() {
    let drawn = "<configurations><configuration name=\"Line\"><resource name=\"Cell\">\
        <task name=\"Fast\" priority=\"1\" interval=\"PT0.01S\"><pouInstance name=\"text\" typeName=\"Text\"/>\
        <pouInstance name=\"net\" typeName=\"Net\"/><pouInstance name=\"plain\" typeName=\"Plain\"/></task>\n\
        <task name=\"Slow\" priority=\"2\" interval=\"PT0.02S\"><pouInstance name=\"rung\" typeName=\"Rung\"/>\
        <pouInstance name=\"list\" typeName=\"List\"/></task></resource></configuration></configurations>";
    let written = "CONFIGURATION Line\nRESOURCE Cell ON PLC\nTASK Fast (INTERVAL := T#10ms, PRIORITY := 1);\n\
        TASK Slow (INTERVAL := T#20ms, PRIORITY := 2);\nPROGRAM text WITH Fast : Text;\nPROGRAM net WITH Fast : Net;\n\
        PROGRAM plain WITH Fast : Plain;\nPROGRAM rung WITH Slow : Rung;\nPROGRAM list WITH Slow : List;\n\
        END_RESOURCE\nEND_CONFIGURATION\n";
    let in_xml = vec![
        ("line.xml", line().replace("<configurations/>", drawn)),
        ("plain.st", PLAIN.to_owned()),
        ("watch.xml", watch()),
    ];
    let in_text = [files(), vec![("plc/cell.st", written.to_owned())]].concat();
    for files in [in_xml, in_text] {
        for target in [Target::Iec, Target::Codesys] {
            let project = round_trip(&files, &Options { target, ..Options::default() });
            let text: String = project.program().filter_map(|file| file.text.as_deref()).collect();
            assert_eq!(text.matches("SDSP_Simulated : BOOL := TRUE").count(), usize::from(is_written(&files, target)));
            let (plain, shimmed) = (compiled(inputs(&files)), compiled(emitted(&project)));
            let plans = [&plain, &shimmed].map(|each| each.configured_tasks().expect("tasks"));
            assert_equal(&plain, &plans[0], &shimmed, &plans[1], "Cell.");
        }
    }
}

/// True if the shim's variables are program text.
fn is_written(files: &[Named], target: Target) -> bool {
    target == Target::Iec && files.iter().any(|(_, text)| text.starts_with("CONFIGURATION"))
}

/// A target that takes text gets the text of a drawing.
#[test]
fn a_drawing_becomes_text_for_a_target_without_drawings() {
    let files = vec![("plain.st", PLAIN.to_owned()), ("watch.xml", watch())];
    let tasks = [task("main", 10, 1, &["Plain"])];
    for (target, own) in [(Target::Scl, "sdsp.scl"), (Target::OpenPlc, "sdsp.st"), (Target::Beremiz, "sdsp.st")] {
        let project = round_trip(&files, &Options { target, tasks: Some(tasks.to_vec()), ..Options::default() });
        assert_eq!(project.whole.as_deref(), Some(own));
        let whole = project.program().next().and_then(|file| file.text.as_deref()).expect("a text");
        assert!(whole.contains("Watch") && whole.contains("SDSP_TOF"), "{target:?}: {whole}");
    }
}

#[test]
fn what_cannot_be_done_is_reported_with_its_place() {
    let twice = [
        input(1, (0, 0), "n"),
        input(2, (0, 20), "1"),
        block(3, (50, 0), "ADD", "IN1=1 IN2=2", "OUT", ""),
        output(4, (100, 0), "3.OUT", "n", ""),
        output(5, (100, 20), "3.OUT", "m", ""),
    ];
    let wired = project(&pou("program", "Wired", "local n : INT, m : INT", "FBD", &twice.concat()));
    let prefixed = watch().replace("<pou ", "<p:pou ").replace("</pou>", "</p:pou>");
    let prefixed = prefixed.replace("<project xmlns=", "<p:project xmlns:p=\"http://p\" xmlns=");
    let prefixed = prefixed.replace("</project>", "</p:project>");
    let wide = watch().replace("<expression>go</expression>", "<expression>i + i &gt; 32767</expression>");
    let wide = wide
        .replace("<variable name=\"go\">", "<variable name=\"i\"><type><INT/></type></variable><variable name=\"go\">");
    let scl = "ORGANIZATION_BLOCK \"Main\"\nBEGIN\nEND_ORGANIZATION_BLOCK\n";
    let plain = ("plain.st", PLAIN.to_owned());
    let cases: [(Target, Vec<Named>); 6] = [
        (Target::Scl, vec![("a.st", "PROGRAM A END_PROGRAM".to_owned()), ("wired.xml", wired.clone())]),
        (Target::OpenPlc, vec![("wired.xml", wired)]),
        (Target::Codesys, vec![plain.clone(), ("watch.xml", prefixed)]),
        (Target::Codesys, vec![plain, ("watch.xml", wide)]),
        (Target::Scl, vec![("main.scl", scl.to_owned()), ("watch.xml", watch())]),
        (Target::Iec, vec![("main.scl", scl.to_owned()), ("watch.xml", watch())]),
    ];
    let refused =
        cases.map(|(target, files)| match instrument(&inputs(&files), &Options { target, ..Options::default() }) {
            Ok(project) => panic!("{target:?}: {:?}", project.files),
            Err(error) => format!("{target:?}: {error}"),
        });
    insta::assert_snapshot!(refused.join("\n"));
}

/// A computation that registers of CODESYS would not cut is written with a conversion in text, also beside a drawing.
#[test]
fn text_beside_a_drawing_gets_conversions() {
    let text = PLAIN.replace("total := n;", "total := n;\n    done := n + n > 40;");
    let files = vec![("plain.st", text), ("watch.xml", watch())];
    let tasks = [task("main", 10, 1, &["Plain"])];
    let project =
        round_trip(&files, &Options { target: Target::Codesys, tasks: Some(tasks.to_vec()), ..Options::default() });
    let whole = project.program().next().and_then(|file| file.text.as_deref()).expect("a text");
    let read = Input::from_text("sdsp.xml", SourceKind::PlcOpen, whole);
    assert_eq!(read.file().dialect(), Dialect::Codesys);
    assert!(whole.contains("TO_INT(n + n) &gt; 40"), "{whole}");
}
