//! What instrumentation does to text: nothing but what is marked, and back again.

use onescan_iec::Input;
use onescan_iec::input::kind::SourceKind;
use onescan_iec_project::instrument::{InstrumentError, Options, Project, Target, diff, instrument, remove};

use super::corpus::cases;
use crate::rig::task;

pub(super) fn inputs(files: &[(&str, SourceKind, &str)]) -> Vec<Input> {
    files.iter().map(|(name, kind, text)| Input::from_text(name, *kind, *text)).collect()
}

pub(super) fn again(project: &Project) -> Vec<Input> {
    let kind = |name: &str| if name.contains(".Tc") { SourceKind::TwinCat } else { SourceKind::Text };
    let text = |file: &onescan_iec_project::instrument::File| file.text.clone().expect("a text");
    project.files.iter().map(|file| Input::from_text(&file.name, kind(&file.name), text(file))).collect()
}

fn texts(project: &Project) -> Vec<Option<String>> {
    project.files.iter().map(|file| file.text.as_deref().map(str::to_owned)).collect()
}

/// Instrumented, once more, and taken back.
pub(super) fn round_trip(given: &[Input], options: &Options) -> Project {
    let project = instrument(given, options).unwrap_or_else(|error| panic!("{error}"));
    let twice = instrument(&again(&project), options).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(texts(&twice), texts(&project));
    assert!(twice.files.iter().all(|file| !file.is_changed()));
    let back = remove(&again(&project)).unwrap_or_else(|error| panic!("{error}"));
    let before: Vec<_> = given.iter().map(|input| Some(input.file().shown_text().to_string())).collect();
    assert_eq!(texts(&back)[..given.len()], before);
    assert!(back.files[given.len()..].iter().all(|file| file.text.is_none()));
    project
}

const PROGRAM: &str = "(* F\u{f6}rderband *)\nPROGRAM Main // the only one\nVAR\n    Dwell, Rest : TON; (* TON *)\n\
    END_VAR\n    Dwell(IN := TRUE, PT := T#1s);   // TON\n    IF Dwell.Q THEN\n        RETURN;\n    END_IF;\n\
    END_PROGRAM\n";

#[test]
fn changes_are_few_and_read_well() {
    let project = round_trip(&inputs(&[("plc/main.st", SourceKind::Text, PROGRAM)]), &Options::default());
    insta::assert_snapshot!(diff::unified(&project.files[0]));
    let names: Vec<_> = project.files.iter().map(|file| file.name.as_str()).collect();
    assert_eq!(names, ["plc/main.st", "plc/sdsp.st"]);
    insta::assert_snapshot!("shim", project.files[1].text.as_deref().expect("a text"));
}

#[test]
fn everything_comes_back_byte_for_byte() {
    for case in cases() {
        let options = Options { tasks: Some(case.tasks), ..Options::default() };
        for text in [
            case.text.to_owned(),
            case.text.replace('\n', "\r\n"),
            case.text.replace('\n', " ").replace("// the end", ""),
        ] {
            round_trip(&inputs(&[("a.st", SourceKind::Text, &text)]), &options);
        }
    }
}

#[test]
fn lines_lead_back() {
    let project = round_trip(&inputs(&[("main.st", SourceKind::Text, PROGRAM)]), &Options::default());
    let (old, file) = (PROGRAM.lines().collect::<Vec<_>>(), &project.files[0]);
    let new = file.text.as_deref().expect("a text").lines();
    let mut found = 0;
    for (at, line) in new.enumerate() {
        if let Some(original) = file.lines.original(at as u32 + 1) {
            let original = old.get(original as usize - 1).copied().unwrap_or("");
            assert!(line == original || line.contains("@sdsp"), "{line:?} is not {original:?}");
            found += 1;
        }
    }
    assert!(found >= old.len());
}

const POU: &str = "<?xml version=\"1.0\" encoding=\"utf-8\"?>\r\n<TcPlcObject Version=\"1.1.0.1\">\r\n  \
    <POU Name=\"MAIN\" Id=\"{0}\">\r\n    <Declaration><![CDATA[PROGRAM MAIN\r\nVAR\r\n    t : TON;\r\nEND_VAR\r\n]]>\
    </Declaration>\r\n    <Implementation>\r\n      <ST><![CDATA[BODY]]></ST>\r\n    </Implementation>\r\n  \
    </POU>\r\n</TcPlcObject>";

#[test]
fn twincat_objects_stay_objects() {
    let options = Options { target: Target::TwinCat, ..Options::default() };
    for body in ["", "t(IN := TRUE, PT := T#1s);\r\nIF t.Q THEN RETURN; END_IF; // done", "\r\n// nothing\r\n"] {
        let text = POU.replace("BODY", body);
        let given = inputs(&[("POUs/MAIN.TcPOU", SourceKind::TwinCat, &text)]);
        let project = round_trip(&given, &options);
        let names: Vec<_> = project.files.iter().map(|file| file.name.as_str()).collect();
        assert_eq!(names, ["POUs/MAIN.TcPOU", "POUs/SDSP.TcGVL", "POUs/SDSP_Scheduler.TcPOU", "POUs/SDSP_TON.TcPOU"]);
        let found = onescan_iec::inspect(again(&project), None);
        assert!(!found.has_errors(), "{found}");
    }
    let given = inputs(&[("MAIN.TcPOU", SourceKind::TwinCat, &POU.replace("BODY", "t(IN := TRUE);"))]);
    insta::assert_snapshot!("twincat", diff::unified(&round_trip(&given, &options).files[0]).replace('\r', ""));
}

/// The scheduler comes first in the task that comes first.
#[test]
fn tasks_of_twincat_call_the_scheduler() {
    let task = |name: &str, cycle: u32, priority: u32, program: &str| {
        format!(
            "<?xml version=\"1.0\" encoding=\"utf-8\"?>\r\n<TcPlcObject Version=\"1.1.0.1\">\r\n  <Task Name=\"{name}\" \
             Id=\"{{0}}\">\r\n    <!--CycleTime in micro seconds.-->\r\n    <CycleTime>{cycle}</CycleTime>\r\n    \
             <Priority>{priority}</Priority>\r\n    <PouCall>\r\n      <Name>{program}</Name>\r\n    </PouCall>\r\n  \
             </Task>\r\n</TcPlcObject>"
        )
    };
    let pou = |name: &str| POU.replace("MAIN", name).replace("BODY", "t(IN := TRUE, PT := T#1s);");
    let (slow, fast) = (task("Slow", 20_000, 20, "MAIN"), task("Fast", 5_000, 10, "Quick"));
    let (main, quick) = (pou("MAIN"), pou("Quick"));
    let given = inputs(&[
        ("Slow.TcTTO", SourceKind::TwinCat, &slow),
        ("Fast.TcTTO", SourceKind::TwinCat, &fast),
        ("MAIN.TcPOU", SourceKind::TwinCat, &main),
        ("Quick.TcPOU", SourceKind::TwinCat, &quick),
    ]);
    let project = round_trip(&given, &Options { target: Target::TwinCat, ..Options::default() });
    assert!(!project.files[0].is_changed());
    insta::assert_snapshot!("twincat_task", diff::unified(&project.files[1]).replace('\r', ""));
    let scheduler = project.files.iter().find(|file| file.name == "SDSP_Scheduler.TcPOU").expect("a scheduler");
    let scheduler = scheduler.text.as_deref().expect("a text");
    assert!(scheduler.contains(":= [5000000, 20000000]; (* ns *)"), "{scheduler}");
    let found = onescan_iec::inspect(again(&project), None);
    assert!(!found.has_errors(), "{found}");
    let application =
        onescan_iec_run::Application::from_inputs(again(&project)).unwrap_or_else(|found| panic!("{found}"));
    let plan = application.configured_tasks().expect("it has tasks");
    assert_eq!(plan.tasks[1].programs, ["SDSP_Scheduler", "Quick"]);
}

#[test]
fn a_twincat_project_lists_the_shim() {
    let options = Options { target: Target::TwinCat, ..Options::default() };
    let listing = "<?xml version=\"1.0\"?>\r\n<Project>\r\n  <ItemGroup>\r\n    \
        <Compile Include=\"POUs\\MAIN.TcPOU\"/>\r\n  </ItemGroup>\r\n</Project>";
    let given = [
        Input::from_text("plc/POUs/MAIN.TcPOU", SourceKind::TwinCat, POU.replace("BODY", "t(IN := TRUE);")),
        Input::from_text("plc/plc.plcproj", SourceKind::Text, listing),
    ];
    let project = instrument(&given, &options).expect("it is right");
    let listed = project.files.last().expect("files");
    let names = onescan_iec::input::project::files(listed.text.as_deref().expect("a text").as_bytes());
    assert_eq!(
        names.expect("a project"),
        ["POUs/MAIN.TcPOU", "POUs/SDSP.TcGVL", "POUs/SDSP_Scheduler.TcPOU", "POUs/SDSP_TON.TcPOU"]
    );
    let twice = instrument(&again(&project), &options).expect("it is right");
    assert!(twice.files.iter().all(|file| !file.is_changed()));
    let back = remove(&again(&project)).expect("it is marked");
    assert_eq!(back.files.last().expect("files").text.as_deref(), Some(listing));
}

#[test]
fn what_cannot_be_replaced_is_reported() {
    let text = "
        FUNCTION_BLOCK F VAR a : MC_MoveAbsolute; b : GETSYSTEMTIME; c : Strange; TIME : INT; END_VAR
            a(); x := SysTimeGetMs() + F_Unknown(1) + TIME; END_FUNCTION_BLOCK
        FUNCTION_BLOCK BLINK END_FUNCTION_BLOCK
        PROGRAM P VAR f : F; own : BLINK; t : TIME; END_VAR VAR_EXTERNAL ONESCAN_TV : TIME; END_VAR
            t := TIME(); t := ONESCAN_TV; t := MAX(t, t); END_PROGRAM";
    let project = instrument(&inputs(&[("p.st", SourceKind::Text, text)]), &Options::default()).expect("warnings only");
    insta::assert_snapshot!(project.warnings.to_string());
    assert!(project.files[0].text.as_deref().expect("a text").contains("t := SDSP_TIME(*@sdsp was TIME*)();"));
}

/// Motion control is taken over as a whole or not at all.
#[test]
fn motion_control_that_cannot_be_replaced_is_reported() {
    for (statement, declaration) in [
        ("probe();", "probe : MC_TouchProbe;"),
        ("on(Axis := X, Enable := TRUE, bRegulatorOn := TRUE);", ""),
        ("on(X, TRUE);", ""),
        ("IF X.NcToPlc.Error THEN ; END_IF;", ""),
        ("cam(Axis := X);", "cam : MC_CamIn; t : MC_CAM_REF;"),
        ("", "Y : AXIS_REF_SM3;"),
        ("IF on.Fault THEN ; END_IF;", ""),
    ] {
        let text = format!(
            "PROGRAM P VAR X : AXIS_REF; on : MC_Power; {declaration} END_VAR on(Axis := X); {statement} END_PROGRAM"
        );
        let project = round_trip(&inputs(&[("p.st", SourceKind::Text, &text)]), &Options::default());
        let reported = project.warnings.to_string();
        assert!(reported.contains("I1002") && reported.contains("`MC_Power` is left"), "{statement}: {reported}");
        assert!(!project.files.iter().any(|file| file.text.as_deref().is_some_and(|text| text.contains("SDSP_MC_"))));
    }
    for declaration in ["g : AXES_GROUP_REF;", "g : AXES_GROUP_REF; line : MC_MoveLinearAbsolute;"] {
        let text = format!(
            "PROGRAM P VAR X : AXIS_REF; on : MC_Power; {declaration} END_VAR on(Axis := X, Enable := TRUE); END_PROGRAM"
        );
        let project = round_trip(&inputs(&[("p.st", SourceKind::Text, &text)]), &Options::default());
        assert!(project.warnings.is_empty(), "{}", project.warnings);
        let has =
            |word: &str| project.files.iter().any(|file| file.text.as_deref().is_some_and(|text| text.contains(word)));
        assert!(has("FUNCTION_BLOCK MC_MoveLinearAbsolute") && has("FUNCTION_BLOCK SDSP_MC_Power"), "{declaration}");
    }
    let derived =
        "FUNCTION_BLOCK Mine EXTENDS MC_Power END_FUNCTION_BLOCK PROGRAM P VAR m : Mine; END_VAR ; END_PROGRAM";
    let project = round_trip(&inputs(&[("p.st", SourceKind::Text, derived)]), &Options::default());
    assert!(project.warnings.to_string().contains("`MC_Power` is not replaced: a function block is derived from it"));
    let text = "PROGRAM P VAR X : AXIS_REF; on : MC_Power; go : MC_GearIn; probe : MC_TouchProbe; END_VAR
        on(Axis := X, Enable := TRUE, bDriveStart := TRUE); probe(Axis := X); END_PROGRAM";
    let project = round_trip(&inputs(&[("p.st", SourceKind::Text, text)]), &Options::default());
    insta::assert_snapshot!("motion_reported", project.warnings.to_string());
}

#[test]
fn motion_control_of_twincat_keeps_its_names() {
    let options = Options { target: Target::TwinCat, ..Options::default() };
    let text =
        POU.replace("    t : TON;", "    X : AXIS_REF;\r\n    on : MC_Power;\r\n    go : MC_MoveAbsolute;").replace(
            "BODY",
            "on(Axis := X, Enable := TRUE);\r\ngo(Axis := X, Execute := on.Status, Position := 1.0, Velocity := 1.0, \
         BufferMode := MC_Buffered);\r\n",
        );
    let given = inputs(&[("MAIN.TcPOU", SourceKind::TwinCat, &text)]);
    let project = round_trip(&given, &options);
    assert_eq!(project.warnings.to_string(), "");
    let text_of = |name: &str| {
        let file = project.files.iter().find(|file| file.name == name);
        file.and_then(|file| file.text.as_deref()).unwrap_or_else(|| panic!("{name} is missing")).to_owned()
    };
    assert!(text_of("SDSP_AXIS_REF.TcDUT").contains("Own : AXIS_REF;"));
    let block = text_of("SDSP_MC_MoveAbsolute.TcPOU");
    assert!(block.contains("BufferMode : MC_BufferMode;") && block.contains("ErrorID : UDINT;"), "{block}");
    assert!(block.contains("BufferMode := BufferMode);") && !block.contains("Direction := Direction);"), "{block}");
    assert!(text_of("SDSP_Accept.TcPOU").contains("MC_Aborting"));
    // A block that Tc2_MC2 has in another form.
    let gear = text.replace("go : MC_MoveAbsolute;", "go : MC_GearIn;");
    let project = instrument(&inputs(&[("MAIN.TcPOU", SourceKind::TwinCat, &gear)]), &options).expect("warnings only");
    assert!(
        project.warnings.to_string().contains("`MC_GearIn` is not replaced: the ratio is of other types in Tc2_MC2")
    );
}

#[test]
fn programs_that_others_call_are_not_scheduled() {
    let text = "PROGRAM Sub ; END_PROGRAM PROGRAM Main Sub(); END_PROGRAM";
    let project = round_trip(&inputs(&[("p.st", SourceKind::Text, text)]), &Options::default());
    let text = project.files[0].text.as_deref().expect("a text");
    assert!(text.starts_with("PROGRAM Sub ; END_PROGRAM PROGRAM Main (*@sdsp begin*)\n"), "{text}");
}

#[test]
fn wrong_projects_are_refused() {
    let refused = |text: &str, tasks| {
        let options = Options { tasks, ..Options::default() };
        let error: InstrumentError =
            instrument(&inputs(&[("p.st", SourceKind::Text, text)]), &options).expect_err("wrong");
        error.to_string()
    };
    insta::assert_snapshot!(refused("FUNCTION_BLOCK F END_FUNCTION_BLOCK", None), @"there is no PROGRAM that a task could run");
    insta::assert_snapshot!(refused("PROGRAM P x := ; END_PROGRAM", None), @"p.st:1:16: error[S0101]: an expression expected, found `;`");
    let damaged = refused("PROGRAM P (*@sdsp begin*) ; END_PROGRAM", None);
    assert!(damaged.starts_with("p.st:1:11: error[I1004]: what begins here has no end"), "{damaged}");
    let taken = refused("VAR_GLOBAL sdsp_turn : INT; END_VAR PROGRAM P ; END_PROGRAM", None);
    assert!(taken.starts_with("p.st:1:12: error[I1003]: `sdsp_turn`: names that begin"), "{taken}");
    insta::assert_snapshot!(refused("PROGRAM Main ; END_PROGRAM", Some(vec![task("a", 1, 0, &["Mian"])])), @"task `a` runs program `Mian`, which is not declared (did you mean `Main`?)");
}

/// Asserts are of onescan's own tests.
#[test]
fn asserts_are_refused_where_no_tool_has_them() {
    let text =
        "PROGRAM P VAR n : INT; END_VAR n := n + 1; ASSERT(n > 0, 'n'); ASSERT_EQUAL_INT(1, n, 'n'); END_PROGRAM";
    for target in [Target::Codesys, Target::TwinCat, Target::Scl, Target::OpenPlc, Target::Beremiz] {
        let options = Options { target, ..Options::default() };
        let refused = instrument(&inputs(&[("p.st", SourceKind::Text, text)]), &options).expect_err("no tool has them");
        let refused = refused.to_string();
        assert_eq!(refused.matches("is a function of onescan for tests").count(), 2, "{target:?}: {refused}");
    }
    let project = instrument(&inputs(&[("p.st", SourceKind::Text, text)]), &Options::default()).expect("it runs here");
    assert!(project.warnings.to_string().contains("is a function of onescan for tests"), "{}", project.warnings);
}
