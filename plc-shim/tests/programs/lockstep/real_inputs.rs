//! Inputs that the PLC's I/O image writes: the simulated value is seen while the PLC is simulated, the real one else.

use onescan_iec::Input;
use onescan_iec::input::kind::SourceKind;
use onescan_iec_project::instrument::{Inputs, Options, Target, diff, instrument, remove};
use onescan_iec_run::Application;

use super::driver::{Driver, Tasks, original, own_plan, scan, state, write};
use super::rewriting::{inputs, round_trip};
use crate::rig::{MS, task};

const PROGRAM: &str = "VAR_GLOBAL\n    Guard AT %IX0.0 : BOOL := FALSE; (* at the front *)\n    Lamp AT %QX0.0 : BOOL;\nEND_VAR\n\n\
    FUNCTION_BLOCK Drive\nVAR\n    {attribute 'TcLinkTo' := 'Term 2'}\n    Speed AT %I* : INT;\nEND_VAR\nVAR_OUTPUT Out : INT; END_VAR\n\
    Out := Speed;\nEND_FUNCTION_BLOCK\n\n\
    PROGRAM Main\nVAR\n    Raw AT %IW2 : INT;\n    Seen, Direct : BOOL;\n    Copy, Turns : INT;\n    One : Drive;\nEND_VAR\n\
    VAR_EXTERNAL Guard, Lamp : BOOL; END_VAR\n    Seen := Guard;\n    Direct := %IX1.3 OR %I1.3;\n    Copy := Raw;\n\
    One();\n    Turns := One.Out;\n    Lamp := Seen;\nEND_PROGRAM\n";

fn options(target: Target) -> Options {
    Options { target, inputs: Inputs::Taken, tasks: Some(vec![task("main", 10, 0, &["Main"])]), ..Options::default() }
}

fn given() -> Vec<Input> {
    inputs(&[("plc/main.st", SourceKind::Text, PROGRAM)])
}

/// The program with its inputs taken over, compiled.
fn taken() -> Application {
    let project = instrument(&given(), &options(Target::Iec)).unwrap_or_else(|error| panic!("{error}"));
    let texts = project.files.iter().map(|file| {
        let text = file.text.as_deref().expect("a text").to_owned();
        Input::from_text(&file.name, SourceKind::Text, text)
    });
    Application::from_inputs(texts).unwrap_or_else(|found| panic!("{found}"))
}

#[test]
fn inputs_give_their_addresses_away_and_take_them_back() {
    let project = round_trip(&given(), &options(Target::Iec));
    insta::assert_snapshot!("taken_inputs", diff::unified(&project.files[0]));
    let shim = project.files[1].text.as_deref().expect("a text");
    for line in ["SDSP_IX1_3 : BOOL;", "SDSP_IN_IX1_3 AT %IX1.3 : BOOL;", "Guard := SDSP_IN_Guard;"] {
        assert!(shim.contains(line), "{line}\n{shim}");
    }
    let left = Options { inputs: Inputs::Left, ..options(Target::Iec) };
    let left = instrument(&given(), &left).expect("right sources");
    assert!(!left.files[0].text.as_deref().is_some_and(|text| text.contains("SDSP_IN_")));
}

#[test]
fn the_simulated_value_is_seen_in_simulation_and_the_real_one_without() {
    let tasks = [task("main", 10, 0, &["Main"])];
    let application = taken();
    let plan = own_plan(&tasks, Tasks::Moved);

    let mut real = Driver::started(&application, &plan);
    real.rig.set("SDSP_Simulated", 0);
    for (name, value) in
        [("SDSP_IN_Guard", 1), ("SDSP_IN_IX1_3", 1 << 3), ("Main.SDSP_IN_Raw", 7), ("Main.One.SDSP_IN_Speed", 9)]
    {
        real.rig.set(name, value);
    }
    real.cycles(4);
    let seen = ["Main.Seen", "Main.Direct", "Main.Copy", "Main.Turns"].map(|name| real.rig.int(name));
    assert_eq!(seen, [1, 1, 7, 9]);

    let mut simulated = Driver::joined(&application, &plan);
    for (name, value) in [
        ("SDSP_IN_Guard", 0),
        ("Guard", 1),
        ("SDSP_IX1_3", 1),
        ("Main.Raw", 3),
        ("Main.SDSP_IN_Raw", 7),
        ("Main.One.Speed", 4),
    ] {
        simulated.rig.set(name, value);
    }
    simulated.step(10 * MS);
    let seen = ["Main.Seen", "Main.Direct", "Main.Copy", "Main.Turns"].map(|name| simulated.rig.int(name));
    assert_eq!(seen, [1, 1, 3, 4]);
}

#[test]
fn every_grant_gives_the_state_of_the_original() {
    let tasks = [task("main", 10, 0, &["Main"])];
    let mut plain = original(PROGRAM, &tasks);
    let mut driver = Driver::joined(&taken(), &own_plan(&tasks, Tasks::Moved));
    for step in 1..=20_i64 {
        let direct = step >> 1 & 1;
        write(&mut plain, "%IB1", direct << 3);
        driver.rig.set("SDSP_IX1_3", direct);
        for (name, value) in [("Guard", step & 1), ("Main.Raw", step * 3), ("Main.One.Speed", -step)] {
            write(&mut plain, name, value);
            driver.rig.set(name, value);
        }
        let at = step as u64 * 10 * MS;
        scan(&mut plain, at);
        driver.step(at);
        assert_eq!(state(&driver.rig.plc), state(&plain), "step {step}");
    }
}

#[test]
fn what_cannot_be_taken_over_is_refused_or_named() {
    let said = |text: &str, target: Target| {
        let input = Input::from_text("main.st", SourceKind::Text, text);
        match instrument(&[input], &Options { tasks: None, ..options(target) }) {
            Ok(project) => project.warnings.iter().map(|found| found.message.clone()).collect::<Vec<_>>().join("; "),
            Err(error) => error.to_string(),
        }
    };
    let shared = "PROGRAM P VAR a AT %IW0 : INT; b : BOOL; END_VAR b := %IX0.3; END_PROGRAM";
    assert!(said(shared, Target::Iec).contains("another name has, too"), "{}", said(shared, Target::Iec));
    let empty =
        "FUNCTION_BLOCK F VAR a AT %I* : INT; END_VAR END_FUNCTION_BLOCK PROGRAM P VAR f : F; END_VAR f(); END_PROGRAM";
    assert!(said(empty, Target::Iec).contains("no place for an assignment"), "{}", said(empty, Target::Iec));
    let right = "PROGRAM P VAR a AT %IW0 : INT; b : INT; END_VAR b := a; END_PROGRAM";
    assert!(said(right, Target::Scl).contains("not in PLCopen XML or SCL"), "{}", said(right, Target::Scl));
    for target in [Target::Iec, Target::Codesys] {
        assert_eq!(said(right, target), "");
        assert_eq!(said(&PROGRAM.replace("%I*", "%IW8"), target), "");
    }
}

#[test]
fn objects_of_twincat_keep_their_links_with_the_twin() {
    let list = "<?xml version=\"1.0\" encoding=\"utf-8\"?>\r\n<TcPlcObject Version=\"1.1.0.1\">\r\n  <GVL Name=\"GVL\" Id=\"{0}\">\r\n    \
        <Declaration><![CDATA[{attribute 'qualified_only'}\r\nVAR_GLOBAL\r\n    Guard AT %I* : BOOL;\r\nEND_VAR]]></Declaration>\r\n  </GVL>\r\n</TcPlcObject>\r\n";
    let main = "<?xml version=\"1.0\" encoding=\"utf-8\"?>\r\n<TcPlcObject Version=\"1.1.0.1\">\r\n  <POU Name=\"MAIN\" Id=\"{1}\">\r\n    \
        <Declaration><![CDATA[PROGRAM MAIN\r\nVAR\r\n    raw AT %I* : INT;\r\n    seen : BOOL;\r\n    copy : INT;\r\nEND_VAR]]></Declaration>\r\n    \
        <Implementation>\r\n      <ST><![CDATA[seen := GVL.Guard;\r\ncopy := raw;\r\n]]></ST>\r\n    </Implementation>\r\n  </POU>\r\n</TcPlcObject>\r\n";
    let given = inputs(&[("GVL.TcGVL", SourceKind::TwinCat, list), ("MAIN.TcPOU", SourceKind::TwinCat, main)]);
    let project = round_trip(&given, &Options { tasks: None, ..options(Target::TwinCat) });
    let all: String = project.files.iter().take(2).map(diff::unified).collect();
    insta::assert_snapshot!("taken_inputs_twincat", all);
    let shim: String = project.files.iter().filter_map(|file| file.text.as_deref()).collect();
    assert!(shim.contains("GVL.Guard := GVL.SDSP_IN_Guard;"), "{shim}");
    let files = project
        .files
        .iter()
        .map(|file| Input::from_text(&file.name, SourceKind::TwinCat, file.text.clone().expect("a text")));
    let back = remove(&files.collect::<Vec<_>>()).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(back.files[0].text.as_deref(), Some(list));
}
