//! Projects of TwinCAT with bodies that are drawn: what is drawn stays as it is.

use onescan_iec::Input;
use onescan_iec::input::kind::SourceKind;
use onescan_iec_project::instrument::{Options, Target, instrument};

use super::rewriting::round_trip;
use crate::drawings::{LEVEL, RUNGS, VESSEL, inputs};

fn options() -> Options {
    Options { target: Target::TwinCat, ..Options::default() }
}

fn refused(text: &str) -> String {
    instrument(&inputs(text), &options()).expect_err("a controller has no place").to_string()
}

#[test]
fn programs_of_tasks_and_charts_that_are_drawn_are_refused() {
    insta::assert_snapshot!(refused(LEVEL), @"Drawing.TcPOU:4:35: error[L0501]: `Level` is drawn in CFC, where the program of a task cannot be controlled (call it from a program in Structured Text, and let the task call that one)");
    insta::assert_snapshot!(refused(RUNGS), @"Drawing.TcPOU:4:35: error[L0501]: `Rungs` is drawn in LD or FBD, where the program of a task cannot be controlled (call it from a program in Structured Text, and let the task call that one)");
    insta::assert_snapshot!(refused(VESSEL), @"Drawing.TcPOU:4:35: error[L0501]: `Vessel` is drawn in SFC, where a chart cannot be controlled (write the chart in PLCopen XML, or as a CASE statement in Structured Text)");
}

const MAIN: &str = "<TcPlcObject><POU Name=\"Main\"><Declaration><![CDATA[PROGRAM Main
VAR
    level : Level;
END_VAR
]]></Declaration><Implementation><ST><![CDATA[level();
]]></ST></Implementation></POU></TcPlcObject>";

#[test]
fn a_drawn_body_stays_as_it_is() {
    let block = LEVEL.replace("PROGRAM Level", "FUNCTION_BLOCK Level");
    let [drawing, declared] = inputs(&block);
    let given = [Input::from_text("Main.TcPOU", SourceKind::TwinCat, MAIN), drawing, declared];
    let project = round_trip(&given, &options());
    let changed = project.files.iter().find(|file| file.name == "Drawing.TcPOU").expect("the drawing");
    let text = changed.text.as_deref().expect("a text");
    let body = |text: &str| text.split("<Implementation>").nth(1).map(str::to_owned);
    assert_eq!(body(text), body(&block));
    // The declaration is that of the shim's timer.
    assert!(text.contains("timer : (*@sdsp begin*)") || text.contains("SDSP_TON"), "{text}");
}
