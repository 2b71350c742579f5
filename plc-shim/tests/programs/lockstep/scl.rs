//! Target `scl`: external sources of TIA Portal.

use onescan_iec::input::kind::SourceKind;
use onescan_iec::{Input, Task, TaskPlan};
use onescan_iec_project::instrument::{Options, Project, Target, diff, instrument};
use onescan_iec_run::{Application, SoftPlc};

use super::corpus::input;
use super::driver::{Driver, Tasks, own_plan, scan, state, write};
use super::rewriting::{again, round_trip};
use crate::rig::{MS, task};

/// A machine with timers as parts of a block, as instances of their own and in a structure.
const PLANT: &str = r#"DATA_BLOCK "Inputs"
{ S7_Optimized_Access := 'TRUE' }
VERSION : 0.1
   STRUCT
      i : Bool;   // Förderband
      j : Bool;
   END_STRUCT;
BEGIN
END_DATA_BLOCK

DATA_BLOCK "Rest"
{InstructionName := 'TON_TIME';
LibVersion := '1.0';
S7_Optimized_Access := 'TRUE' }
AUTHOR : Simatic
FAMILY : IEC
NAME : IEC_TMR
VERSION : 1.0
NON_RETAIN
TON_TIME

BEGIN
END_DATA_BLOCK

FUNCTION_BLOCK "Station"
{ S7_Optimized_Access := 'TRUE' }
VERSION : 0.1
   VAR_INPUT
      run : Bool;
      stop : Bool;
   END_VAR
   VAR_OUTPUT
      lamp : Bool;
      count : Int;
      elapsed : Time;
   END_VAR
   VAR
      on {InstructionName := 'TON_TIME'; LibVersion := '1.0'} : TON_TIME;
      off : Array[1..2] of TOF_TIME;
      pulse {InstructionName := 'TP_TIME'; LibVersion := '1.0'} : TP_TIME;
   END_VAR
BEGIN
	REGION Timers
	    #on(IN := #run AND NOT #on.Q, PT := T#30ms);
	    #off[2](IN := #on.Q, PT := T#20ms);
	    #pulse.TP(IN := #stop, PT := T#15ms, ET => #elapsed);
	END_REGION
	#lamp := #off[2].Q OR #pulse.Q;
	IF #on.Q THEN
	    #count += 1;
	END_IF;
END_FUNCTION_BLOCK

DATA_BLOCK "Station_DB"
{ S7_Optimized_Access := 'TRUE' }
VERSION : 0.1
"Station"
BEGIN
END_DATA_BLOCK

DATA_BLOCK "Out"
   STRUCT
      fast : DInt;
      lamp : Bool;
      rested : Bool;
      order : DInt;
   END_STRUCT;
BEGIN
END_DATA_BLOCK

ORGANIZATION_BLOCK "Main"
TITLE = "Main Program Sweep (Cycle)"
{ S7_Optimized_Access := 'TRUE' }
VERSION : 0.1
   VAR_TEMP
      here : Bool;
   END_VAR
BEGIN
	REGION All of it
	"Station_DB"(run := "Inputs".i, stop := "Inputs".j);
	"Rest".TON(IN := "Inputs".i, PT := T#25ms);
	END_REGION
	"Out".order := "Out".order * 3 + 1;
	IF "Inputs".j THEN RETURN; END_IF;
	"Out".lamp := "Station_DB".lamp;
	"Out".rested := "Rest".Q; // done
END_ORGANIZATION_BLOCK

ORGANIZATION_BLOCK "OB37"
TITLE = "every 20 ms"
VERSION : 0.1
BEGIN
	"Out".fast := "Out".fast + 1;
	"Out".order := "Out".order * 3 + 2;
END_ORGANIZATION_BLOCK

ORGANIZATION_BLOCK OB30
BEGIN
END_ORGANIZATION_BLOCK

ORGANIZATION_BLOCK "Startup"
TITLE = "Complete Restart"
VERSION : 0.1
BEGIN
	"Out".order := 7;
END_ORGANIZATION_BLOCK
"#;

fn options() -> Options {
    Options { target: Target::Scl, ..Options::default() }
}

fn given(text: &str) -> [Input; 1] {
    [Input::from_text("plc/plant.scl", SourceKind::Text, text)]
}

fn compiled(project: &Project) -> Application {
    let inputs = again(project);
    let found = onescan_iec::inspect(inputs.clone(), None);
    assert!(!found.has_errors(), "{found}");
    Application::from_inputs(inputs).unwrap_or_else(|found| panic!("{found}"))
}

fn tasks() -> Vec<Task> {
    vec![task("OB30", 5000, 8, &["OB30"]), task("OB37", 20, 1, &["OB37"]), task("OB1", 10, 9, &["Main"])]
}

#[test]
fn blocks_are_changed_in_place_and_come_back_byte_for_byte() {
    for text in [PLANT.to_owned(), PLANT.replace('\n', "\r\n")] {
        let project = round_trip(&given(&text), &options());
        assert_eq!(project.warnings.to_string(), "");
        compiled(&project);
    }
    let project = round_trip(&given(PLANT), &options());
    insta::assert_snapshot!("scl", diff::unified(&project.files[0]));
    assert_eq!(project.files[1].name, "plc/sdsp.scl");
    insta::assert_snapshot!("scl_shim", project.files[1].text.as_deref().expect("a text"));
}

/// All data blocks, with their bytes; timers are other blocks there.
fn blocks(plc: &SoftPlc) -> Vec<(String, Vec<u8>)> {
    let leaves = plc.application().leaves();
    let own = |path: &str| {
        ["Out.", "Inputs.", "Station_DB.lamp", "Station_DB.count", "Station_DB.elapsed", "Rest.Q", "Rest.ET"]
            .iter()
            .any(|known| path.starts_with(known))
    };
    let bytes = |leaf: &onescan_iec_run::Variable| plc.memory()[leaf.offset as usize..][..leaf.size as usize].to_vec();
    leaves.into_iter().filter(|leaf| own(&leaf.path)).map(|leaf| (leaf.path.clone(), bytes(&leaf))).collect()
}

#[test]
fn it_runs_as_the_original_does() {
    let [given] = given(PLANT);
    let plain = Application::from_inputs([given.clone()]).unwrap_or_else(|found| panic!("{found}"));
    let mut plain = SoftPlc::new(&plain, &TaskPlan::new(tasks())).expect("the plan suits");
    let shimmed = compiled(&instrument(&[given], &options()).expect("it is right"));
    let free = [vec![task("sdsp", 1, 0, &["SDSP_Scheduler"])], tasks()].concat();
    let mut inert = SoftPlc::new(&shimmed, &TaskPlan::new(free)).expect("the plan suits");
    write(&mut inert, "SDSP.SDSP_Simulated", 0);
    for form in [Tasks::Kept, Tasks::Moved] {
        plain.cold_start();
        inert.cold_start();
        write(&mut inert, "SDSP.SDSP_Simulated", 0);
        let mut driver = Driver::joined_in("SDSP.", &shimmed, &own_plan(&tasks(), form));
        for step in 1..200 {
            let now = step * 5 * MS;
            for (index, path) in ["Inputs.i", "Inputs.j"].into_iter().enumerate() {
                let value = input(index, step / 6);
                write(&mut plain, path, value);
                write(&mut inert, path, value);
                driver.rig.set(path, value);
            }
            scan(&mut plain, now);
            scan(&mut inert, now);
            driver.step(now);
            driver.cycles((step % 4) as u32);
            assert_eq!(blocks(&plain), blocks(&inert), "not simulated, t_v = {now}");
            assert_eq!(blocks(&plain), blocks(&driver.rig.plc), "granted, {form:?}, t_v = {now}");
        }
        assert_ne!(plain.read("Station_DB.count").expect("it is there"), "0");
    }
    assert!(blocks(&plain).len() > 8 && state(&plain).is_empty());
}

/// `IEC_TIMER` is what it is called as.
#[test]
fn timers_without_a_kind_take_that_of_their_calls() {
    let block = |declared: &str, statements: &str| {
        format!(
            "FUNCTION_BLOCK \"F\"\nVAR\n{declared}\nEND_VAR\nBEGIN\n{statements}\nEND_FUNCTION_BLOCK\n\
             ORGANIZATION_BLOCK \"Main\"\nBEGIN\nEND_ORGANIZATION_BLOCK\n"
        )
    };
    let one = block(
        "t, u : IEC_TIMER; w : Array[0..1] of IEC_TIMER;",
        "#t.TOF(IN := TRUE, PT := T#1s);\n#u.TOF();\n#w[1].TP();",
    );
    let project = round_trip(&given(&one), &options());
    let text = project.files[0].text.as_deref().expect("a text");
    assert!(text.contains("t, u : \"SDSP_TOF_TIME\"(*@sdsp was IEC_TIMER*);"), "{text}");
    assert!(text.contains("#t(*@sdsp cut .TOF*)(IN := TRUE") && text.contains("#w[1](*@sdsp cut .TP*)();"), "{text}");
    assert_eq!(project.warnings.to_string(), "");
    for statements in [
        "#t.TON();\n#t.TOF();",
        "",
        "#t.TON();\nRESET_TIMER(#t);",
        "\"G\".t.TON();",
        "#t.TONR();",
        "#t.TON();\n#t.TONR();",
    ] {
        let project = round_trip(&given(&block("t : IEC_TIMER;", statements)), &options());
        assert!(project.warnings.to_string().contains("I1001"), "{statements}: {}", project.warnings);
    }
    let global = block("r : Bool;", "\"IEC_Timer_0_DB\".TON(IN := TRUE, PT := T#1s, Q => #r);")
        + "DATA_BLOCK \"IEC_Timer_0_DB\"\nVERSION : 1.0\nIEC_TIMER\nBEGIN\nEND_DATA_BLOCK\n";
    let project = round_trip(&given(&global), &options());
    let text = project.files[0].text.as_deref().expect("a text");
    assert!(text.contains("\"SDSP_TON_TIME\"(*@sdsp was IEC_TIMER*)"), "{text}");
    assert!(text.contains("\"IEC_Timer_0_DB\"(*@sdsp cut .TON*)(IN := TRUE, PT := T#1s, Q => #r)"), "{text}");
    assert_eq!(project.warnings.to_string(), "");
    let project = round_trip(&given(&block("t : IEC_TIMER;", "#t.TON();\n#t.TOF();")), &options());
    assert!(!project.files[0].text.as_deref().expect("a text").contains("cut"), "{:?}", project.files[0].text);
}

#[test]
fn what_cannot_be_carried_is_reported() {
    let refused = |files: &[(&str, &str)], target| {
        let inputs: Vec<_> = files.iter().map(|(name, text)| Input::from_text(name, SourceKind::Text, *text)).collect();
        instrument(&inputs, &Options { target, ..Options::default() }).expect_err("refused").to_string()
    };
    let st = ("p.st", "PROGRAM P ; END_PROGRAM");
    let scl = ("p.scl", "ORGANIZATION_BLOCK OB1 BEGIN END_ORGANIZATION_BLOCK");
    let reported = [refused(&[scl, st], Target::Scl), refused(&[scl], Target::Iec)];
    insta::assert_snapshot!("scl_refused", reported.join("\n"));
    let text = "FUNCTION_BLOCK \"F\"\nVAR_TEMP t : Time; d : DTL; r : Int; END_VAR\nVAR on : TONR_TIME; x : MC_Power; END_VAR\nBEGIN\n\
        #t := TIME_TCK();\n#r := RD_SYS_T(#d);\nPRESET_TIMER(PT := #t, TIMER := #on);\nEND_FUNCTION_BLOCK\n\
        ORGANIZATION_BLOCK OB1\nBEGIN\nEND_ORGANIZATION_BLOCK\n";
    insta::assert_snapshot!("scl_reported", round_trip(&given(text), &options()).warnings.to_string());
}

/// PLCopen's axes in SCL: what is written there moves as in text, and no technology object is touched.
#[test]
fn axes_of_plcopen_move_on_virtual_time() {
    let text = r#"DATA_BLOCK "Line"
   STRUCT
      X : AXIS_REF;
      go : Bool;
      position : LReal;
      done : Bool;
   END_STRUCT;
BEGIN
   X.MaxVelocity := 2.0;
END_DATA_BLOCK
FUNCTION_BLOCK "Station"
   VAR_IN_OUT
      Axis : AXIS_REF;
   END_VAR
   VAR
      power {InstructionName := 'MC_POWER'; LibVersion := '3.0'} : MC_Power;
      move : MC_MoveAbsolute;
      actual : MC_ReadActualPosition;
   END_VAR
BEGIN
	#power(Axis := #Axis, Enable := TRUE);
	#move(Axis := #Axis, Execute := "Line".go, Position := 1.5, Velocity := 1.0, Acceleration := 10.0);
	#actual(Axis := #Axis, Enable := TRUE);
	"Line".position := #actual.Position;
	"Line".done := #move.Done;
END_FUNCTION_BLOCK
DATA_BLOCK "Station_DB"
"Station"
BEGIN
END_DATA_BLOCK
ORGANIZATION_BLOCK "Main"
BEGIN
	"Station_DB"(Axis := "Line".X);
END_ORGANIZATION_BLOCK
"#;
    let tasks = [task("OB1", 10, 1, &["Main"])];
    let project = round_trip(&given(text), &options());
    assert_eq!(project.warnings.to_string(), "");
    let changed = project.files[0].text.as_deref().expect("a text");
    assert!(changed.contains("X : \"SDSP_AXIS_REF\"(*@sdsp was AXIS_REF*);"), "{changed}");
    assert!(
        changed.contains(": \"SDSP_MC_Power\"(*@sdsp was MC_Power*);") && !changed.contains("LibVersion := '3.0'} :")
    );
    let plain = Application::from_inputs(given(text)).unwrap_or_else(|found| panic!("{found}"));
    let mut plain = SoftPlc::new(&plain, &TaskPlan::new(tasks.to_vec())).expect("the plan suits");
    let mut driver = Driver::joined_in("SDSP.", &compiled(&project), &own_plan(&tasks, Tasks::Moved));
    for step in 1..250 {
        let (now, go) = (step * 10 * MS, i64::from(step > 5));
        write(&mut plain, "Line.go", go);
        driver.rig.set("Line.go", go);
        scan(&mut plain, now);
        driver.step(now);
        let held = |plc: &SoftPlc| ["Line.position", "Line.done"].map(|path| plc.read(path).expect("it is there"));
        assert_eq!(held(&plain), held(&driver.rig.plc), "t_v = {now}");
    }
    assert_eq!(plain.read("Line.done").expect("it is there"), "TRUE");
}
