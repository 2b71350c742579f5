//! Projects in PLCopen XML: instrumented in place, read back, taken back, and the same in lockstep.

use onescan_iec::input::kind::SourceKind;
use onescan_iec::{Input, TaskPlan};
use onescan_iec_project::instrument::{Options, Project, Target, diff, instrument, remove};
use onescan_iec_run::{Application, SoftPlc};

use super::driver::{Driver, Tasks, own_plan, scan, state, write};
use crate::plcopen::{block, coil, contact, input, output, pou, project, rail};
use crate::rig::{MS, task};

pub(super) fn read(text: &str) -> Input {
    Input::from_text("line.xml", SourceKind::PlcOpen, text)
}

pub(super) fn text(project: &Project) -> String {
    project.files[0].text.as_deref().expect("a text").to_owned()
}

/// Programs in every language, each with a timer.
pub(super) fn line() -> String {
    let sections = "local go : BOOL, delay : TON, done : BOOL, n : INT";
    let st = "delay(IN := go, PT := T#30ms);\nIF NOT delay.Q THEN\n    RETURN;\nEND_IF;\ndone := delay.Q AND n &lt; 30000;\nn := n + 1;";
    let fbd = [
        input(1, (0, 0), "go"),
        input(2, (0, 20), "T#30ms"),
        block(3, (50, 0), "TON delay", "IN=1 PT=2", "Q ET", ""),
        output(4, (100, 0), "3.Q", "done", ""),
        input(5, (0, 60), "n"),
        input(6, (0, 80), "1"),
        block(7, (50, 60), "ADD", "IN1=5 IN2=6", "OUT", ""),
        output(8, (100, 60), "7.OUT", "n", ""),
    ];
    let ld = [
        rail(1),
        contact(2, (0, 0), "1", "go", ""),
        input(3, (0, 20), "T#30ms"),
        block(4, (50, 0), "TOF delay", "IN=2 PT=3", "Q", ""),
        coil(5, (100, 0), "4.Q", "done", ""),
    ];
    let il = "CAL delay(IN := go, PT := T#30ms)\nLD delay.Q\nST done\nRETCN\nLD n\nADD 1\nST n\n";
    let programs = [
        pou("program", "Text", sections, "ST", st),
        pou("program", "Net", sections, "FBD", &fbd.concat()),
        pou("program", "Rung", &sections.replace("TON", "TOF"), "LD", &ld.concat()),
        pou("program", "List", sections, "IL", il),
    ];
    project(&programs.concat())
}

const PROGRAMS: [&str; 4] = ["Text", "Net", "Rung", "List"];

/// The same, with tasks of its own.
fn configured() -> String {
    let tasks = "<configurations><configuration name=\"Line\"><resource name=\"Station\">\
        <task name=\"Fast\" priority=\"1\" interval=\"PT0.01S\"><pouInstance name=\"text\" typeName=\"Text\"/>\
        <pouInstance name=\"net\" typeName=\"Net\"/></task>\n<task name=\"Slow\" priority=\"2\" interval=\"PT0.02S\">\
        <pouInstance name=\"rung\" typeName=\"Rung\"/><pouInstance name=\"list\" typeName=\"List\"/></task>\
        </resource></configuration></configurations>";
    line().replace("<configurations/>", tasks)
}

fn options(target: Target) -> Options {
    Options { target, tasks: Some(vec![task("main", 10, 1, &PROGRAMS)]), ..Options::default() }
}

/// Instrumented, once more, and taken back.
pub(super) fn round_trip(given: &str, options: &Options) -> Project {
    let project = instrument(&[read(given)], options).unwrap_or_else(|error| panic!("{error}"));
    let again = text(&project);
    let twice = instrument(&[read(&again)], options).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(text(&twice), again);
    assert!(!twice.files[0].is_changed());
    let back = remove(&[read(&again)]).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(text(&back), given);
    project
}

#[test]
fn a_project_is_changed_in_place_and_comes_back_byte_for_byte() {
    for target in [Target::Iec, Target::Codesys, Target::TwinCat] {
        for given in [line(), line().replace('\n', "\r\n")] {
            round_trip(&given, &options(target));
        }
        round_trip(&configured(), &Options { target, tasks: None, ..Options::default() });
    }
    let with_actions = line().replace(
        "</interface><body><FBD>",
        "</interface><actions><action name=\"A\"><body><ST><p>n := 1;</p></ST></body></action></actions><body><FBD>",
    );
    round_trip(&with_actions, &options(Target::Codesys));
    let project = round_trip(&line(), &options(Target::Iec));
    insta::assert_snapshot!(diff::unified(&project.files[0]));
}

#[test]
fn every_language_gives_the_same_at_the_same_time() {
    let tasks = [task("main", 10, 1, &PROGRAMS)];
    let project = instrument(&[read(&line())], &options(Target::Iec)).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(project.warnings.to_string(), "");
    let compiled = |text: &str| match Application::from_inputs([read(text)]) {
        Ok(application) => application,
        Err(found) => panic!("{found}\n{text}"),
    };
    let mut plain = SoftPlc::new(&compiled(&line()), &TaskPlan::new(tasks.to_vec())).expect("the plan suits");
    let instrumented = compiled(&text(&project));
    for form in [Tasks::Kept, Tasks::Moved] {
        plain.cold_start();
        let mut driver = Driver::joined(&instrumented, &own_plan(&tasks, form));
        for step in 1..60_u64 {
            for name in PROGRAMS {
                let value = i64::from(step % 17 > 4);
                write(&mut plain, &format!("{name}.go"), value);
                driver.rig.set(&format!("{name}.go"), value);
            }
            scan(&mut plain, step * 10 * MS);
            driver.step(step * 10 * MS);
            driver.cycles((step % 4) as u32);
            assert_eq!(state(&plain), state(&driver.rig.plc), "{form:?}, step {step}");
        }
        assert!(driver.rig.int("Net.n") > 50 && driver.rig.int("Text.n") > 10 && driver.rig.int("List.n") > 10);
    }
}

#[test]
fn tasks_of_the_project_get_a_scheduler() {
    let project = round_trip(&configured(), &Options { target: Target::Iec, tasks: None, ..Options::default() });
    let text = text(&project);
    assert!(text.contains("<task name=\"SDSP_Cycle\" priority=\"0\" interval=\"PT0.01S\">"), "{text}");
    let application = match Application::from_inputs([read(&text)]) {
        Ok(application) => application,
        Err(found) => panic!("{found}\n{text}"),
    };
    assert!(application.programs().count() >= 4);
}

/// CODESYS keeps declarations as text beside their elements if it is set to, and reads that text.
#[test]
fn declarations_as_plain_text_are_taken_out_and_come_back() {
    let plain = "<addData><data name=\"http://www.3s-software.com/plcopenxml/interfaceasplaintext\" \
                 handleUnknown=\"implementation\"><InterfaceAsPlainText><xhtml xmlns=\"http://www.w3.org/1999/xhtml\">\
                 PROGRAM Text\nVAR\n  delay : TON; // -- &lt;so&gt; --\nEND_VAR</xhtml></InterfaceAsPlainText></data></addData>";
    let given = line().replacen("</pou>", &format!("{plain}</pou>"), 1);
    for target in [Target::Iec, Target::Codesys] {
        let again = text(&round_trip(&given, &options(target)));
        assert!(again.contains("<addData><!--@sdsp cut <data name="), "{again}");
        let shown = Application::from_inputs([read(&again)]).unwrap_or_else(|found| panic!("{found}\n{again}"));
        assert!(shown.variable("Text.SDSP_Granted").is_ok());
    }
}

/// Programs of which the configuration has several instances, in every language and as a chart.
fn with_twins() -> String {
    let fast = "<task name=\"Fast\" priority=\"1\" interval=\"PT0.01S\">";
    let slow = "<task name=\"Slow\" priority=\"2\" interval=\"PT0.02S\">";
    let twin = |name: &str, of: &str| format!("<pouInstance name=\"{name}\" typeName=\"{of}\"/>");
    let given = configured().replace(fast, &[fast, &twin("text2", "Text"), &twin("list2", "List")].concat());
    given.replace(slow, &[slow, &twin("net2", "Net"), &twin("rung2", "Rung")].concat())
}

#[test]
fn several_instances_of_a_program_are_numbered() {
    let given = with_twins();
    let options = Options { target: Target::Iec, tasks: None, ..Options::default() };
    let again = text(&round_trip(&given, &options));
    assert_eq!(again.matches("<configVariable").count(), 8, "{again}");
    // A list that the project has of its own takes them in.
    let own = "<configVars><configVariable instancePathAndName=\"Station.text.n\"><type><INT/></type><initialValue>\
               <simpleValue value=\"5\"/></initialValue></configVariable></configVars></configuration>";
    let own = given.replace("</configuration>", own);
    assert_eq!(text(&round_trip(&own, &options)).matches("<configVars>").count(), 1);
    let compiled =
        |text: &str| Application::from_inputs([read(text)]).unwrap_or_else(|found| panic!("{found}\n{text}"));
    let plain = compiled(&own);
    let mut plain = SoftPlc::new(&plain, &plain.configured_tasks().expect("tasks")).expect("the plan suits");
    let application = compiled(&text(&round_trip(&own, &options)));
    let mut driver = Driver::joined(&application, &application.configured_tasks().expect("tasks"));
    for step in 1..80 {
        for (index, name) in ["text", "text2", "net", "net2", "rung", "rung2", "list", "list2"].iter().enumerate() {
            let value = super::corpus::input(index, step);
            write(&mut plain, &format!("Station.{name}.go"), value);
            driver.rig.set(&format!("Station.{name}.go"), value);
        }
        scan(&mut plain, step * 10 * MS);
        driver.step(step * 10 * MS);
        let mut granted = state(&driver.rig.plc);
        granted.retain(|(path, _)| !path.starts_with("SDSP."));
        assert_eq!(state(&plain), granted, "step {step}");
    }
    assert!(driver.rig.int("Station.text.n") > driver.rig.int("Station.text2.n"));
}

#[test]
fn what_is_not_instrumented_is_reported() {
    let object = "<TcPlcObject><POU Name=\"A\"><Declaration><![CDATA[PROGRAM A]]></Declaration><Implementation><ST>\
                  <![CDATA[]]></ST></Implementation></POU></TcPlcObject>";
    let object = Input::from_text("A.TcPOU", SourceKind::TwinCat, object);
    let error = instrument(&[object], &Options { target: Target::Codesys, tasks: None, ..Options::default() })
        .expect_err("no XML");
    assert!(error.to_string().contains("takes program text or a project in PLCopen XML"), "{error}");
}

#[test]
fn a_list_of_instructions_in_text_is_the_same_in_lockstep() {
    let text = "PROGRAM List\nVAR go, done : BOOL; delay : TON; n : INT; END_VAR\n    CAL delay(IN := go, PT := T#30ms)\n    \
                LD delay.Q\n    ST done\n    RETCN\nagain:\n    LD n\n    ADD 1\n    ST n\nEND_PROGRAM\n";
    let tasks = [task("main", 10, 1, &["List"])];
    let times: Vec<u64> = (1..60).map(|step| step * 10 * MS).collect();
    super::equivalence::assert_equal("list", text, &tasks, &["List.go"], &times, Tasks::Moved);
}
