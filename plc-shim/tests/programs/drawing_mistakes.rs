//! What is reported of drawings that cannot be read: the element, and never another program instead.

use onescan_iec::input::kind::SourceKind;
use onescan_iec::{Input, inspect};

use crate::drawings::{LEVEL, RUNGS, VESSEL, changed, findings, with_a_condition_at_en};

/// The findings with one place of a drawing changed.
fn reported(text: &str, from: &str, to: &str) -> String {
    findings(&changed(text, from, to))
}

#[test]
fn sound_drawings_have_no_findings() {
    assert_eq!([LEVEL, RUNGS, VESSEL].map(findings), [""; 3]);
}

#[test]
fn elements_of_a_chart_that_cannot_be_read() {
    insta::assert_snapshot!(reported(LEVEL, "CFCCommentElement", "CFCFancyElement"), @"Drawing.TcPOU:212:19: error[L0501]: element 47 of a chart (`CFCFancyElement`) is not supported yet");
    insta::assert_snapshot!(reported(LEVEL, "<v n=\"EnEno\">false", "<v n=\"EnEno\">true"), @"Drawing.TcPOU:45:19: error[L0501]: EN and ENO of `ADD` (element 25) in a chart is not supported yet");
    insta::assert_snapshot!(reported(LEVEL, "\"SetReset\">Set<", "\"SetReset\">Toggle<"), @"Drawing.TcPOU:464:21: error[L0501]: what a pin does with its value (element 96) is not supported yet");
    insta::assert_snapshot!(reported(LEVEL, "t=\"SetResetRef\">None", "t=\"SetResetRef\">Ref"), @"Drawing.TcPOU:20:21: error[L0501]: an assignment of a reference at a pin (element 13) is not supported yet");
    insta::assert_snapshot!(reported(LEVEL, "\"times + 1\"", "\"times +\""), @"Drawing.TcPOU:586:36: error[S0101]: `times +` is not an expression");
    insta::assert_snapshot!(reported(LEVEL, "\"times + 1\"", "\"LEN(\"x\")\""), @r#"Drawing.TcPOU:586:36: error[L0501]: `"` in an expression of a drawing is not supported yet"#);
}

#[test]
fn lines_of_a_chart_that_lead_nowhere() {
    let without_a_line = LEVEL.replace("SourcePinId", "Nothing");
    insta::assert_snapshot!(findings(&without_a_line).lines().next().unwrap_or(""), @"Drawing.TcPOU:48:25: error[G1102]: the connection to pin 17 has no source");
    let cut = |id: u32| {
        let from = format!("<v n=\"DestPinId\">{id}L</v>");
        reported(LEVEL, &from, "<v n=\"DestPinId\">9999L</v>")
    };
    let first = LEVEL.split("<v n=\"DestPinId\">").nth(1).and_then(|rest| rest.split('L').next());
    insta::assert_snapshot!(cut(first.and_then(|id| id.parse().ok()).expect("a pin")), @"Drawing.TcPOU:48:25: error[G1106]: nothing is connected to input 1 of `ADD` (id 25)");
}

#[test]
fn a_value_that_is_wanted_before_it_is_there() {
    // The output of the operator GE, before the box.
    let at = LEVEL.find("<o t=\"CFCCommentElement\">").expect("a comment");
    let output = |text: &str| text.find("<o t=\"CFCOutputElement\">").map(|from| from + at);
    let from = output(&LEVEL[at..]).expect("an output");
    let to = from + LEVEL[from..].find("<o t=\"CFCConnection\">").expect("a line");
    let first = LEVEL.find("<o t=\"CFCBoxElement\">").expect("a box");
    let moved = [&LEVEL[..first], &LEVEL[from..to], &LEVEL[first..from], &LEVEL[to..]].concat();
    insta::assert_snapshot!(findings(&moved), @"Drawing.TcPOU:46:21: error[G1104]: the value of `GE` (element 59) is wanted before it is there: nothing keeps it from one cycle to the next; change the order, or let the line go through a variable");
}

#[test]
fn a_chart_whose_order_is_not_stored() {
    let properties = "<ObjectProperties><XmlArchive><Data><o xml:space=\"preserve\" t=\"CFCProperty\">\
                      <v n=\"UseExplicitExecutionOrder\">false</v></o></Data></XmlArchive></ObjectProperties></POU>";
    insta::assert_snapshot!(reported(LEVEL, "</POU>", properties), @"Drawing.TcPOU:1024:39: error[L0501]: a chart with a loop or a jump that TwinCAT orders by the flow of its data (set `Explicit Execution Order` in its properties, which stores the order) is not supported yet");
}

#[test]
fn a_block_with_other_pins_than_the_drawing() {
    let other = LEVEL.replace("R_TRIG", "CTU");
    insta::assert_snapshot!(findings(&other), @r"
    Drawing.TcPOU:515:25: error[C0301]: the drawing does not name the inputs of `CTU`, and their number in the declaration is not 1: open the drawing in its editor, update the box and save it
    Drawing.TcPOU:594:25: error[N0104]: the drawing does not name the outputs of CTU, and their number in the declaration is not 1: open the drawing in its editor, update the box and save it
    ");
}

#[test]
fn elements_of_networks_that_cannot_be_read() {
    insta::assert_snapshot!(reported(RUNGS, "t=\"BoxTreeTerminator\"", "t=\"BoxTreeFancy\""), @"Drawing.TcPOU:478:27: error[L0501]: element 59 of a network (`BoxTreeFancy`) is not supported yet");
    insta::assert_snapshot!(reported(RUNGS, "<v n=\"Flags\">16", "<v n=\"Flags\">17"), @"Drawing.TcPOU:253:27: error[L0501]: a value with the flags 17 is not supported yet");
    insta::assert_snapshot!(reported(RUNGS, "<v n=\"Flags\">3", "<v n=\"Flags\">34"), @"Drawing.TcPOU:178:27: error[L0501]: a target (id 30) with the flags 34 is not supported yet");
    insta::assert_snapshot!(reported(RUNGS, "\"ILActive\">false", "\"ILActive\">true"), @"Drawing.TcPOU:18:17: error[L0501]: Instruction List in network 1 is not supported yet");
    insta::assert_snapshot!(reported(RUNGS, "\"Behind\"", "\"Nowhere\""), @"Drawing.TcPOU:689:27: error[G1101]: there is no label `Nowhere` that this jump could lead to");
    insta::assert_snapshot!(reported(RUNGS, "\"stop\"", "\"???\""), @"Drawing.TcPOU:110:27: error[G1106]: nothing is connected to input 2 of `AND` (id 20)");
    insta::assert_snapshot!(reported(RUNGS, "<v n=\"Operand\">\"timer\"", "<v n=\"Operand\">\"\""), @"Drawing.TcPOU:328:23: error[G1106]: the box of `TON` (id 55) has no instance");
    insta::assert_snapshot!(reported(RUNGS, "NWLImplementationObject", "OtherObject"), @"Drawing.TcPOU:12:7: error[F0602]: `<NWL>` has no archive of a `NWLImplementationObject`");
}

#[test]
fn a_value_that_is_taken_while_en_is_false() {
    let text = with_a_condition_at_en();
    insta::assert_snapshot!(findings(&text), @"Drawing.TcPOU:459:23: warning[L0501]: what `EQ` (id 65) hands on while its EN is FALSE is not documented, and is FALSE or 0 here: connect its EN to the power rail, or give its output a variable");
}

#[test]
fn an_edge_in_a_function() {
    let text = RUNGS.replace("PROGRAM Rungs", "FUNCTION Rungs : BOOL").replace("timer : TON;", "");
    let found = findings(&text);
    let edges: Vec<&str> = found.lines().filter(|line| line.contains("G1109")).collect();
    insta::assert_snapshot!(edges.join("\n"), @r"
    Drawing.TcPOU:253:27: error[G1109]: a rising edge needs memory, and a function or method keeps nothing
    Drawing.TcPOU:778:25: error[G1109]: a falling edge needs memory, and a function or method keeps nothing
    ");
}

#[test]
fn elements_of_a_sequential_chart_that_cannot_be_read() {
    insta::assert_snapshot!(reported(VESSEL, "\"Fill\"", "\"\""), @r"
    Drawing.TcPOU:103:33: error[F0602]: `` is not the name of a step (element 28)
    Drawing.TcPOU:364:21: error[F0602]: there is no step before this transition
    Drawing.TcPOU:379:21: error[Q1208]: step `Check` can never be active
    ");
    insta::assert_snapshot!(reported(VESSEL, "t=\"SFCJump\"", "t=\"SFCMacro\""), @r"
    Drawing.TcPOU:691:21: error[L0501]: element 92 of a chart (`SFCMacro`) is not supported yet
    Drawing.TcPOU:676:21: error[F0602]: this transition leads to no step
    Drawing.TcPOU:611:21: warning[Q1212]: no transition leads on from `Drain`
    ");
    insta::assert_snapshot!(reported(VESSEL, "\"Idle\"", "\"Idol\""), @"Drawing.TcPOU:676:21: error[Q1204]: there is no step `Idle`");
    insta::assert_snapshot!(reported(VESSEL, "<v n=\"Value\">\"TRUE\"", "<v n=\"Value\">\"FALSE\""), @"Drawing.TcPOU:17:21: error[Q1203]: no step is the initial one (write `INITIAL_STEP Idle:`)");
    insta::assert_snapshot!(reported(VESSEL, "go, bad", "go, SFCPause, bad"), @"Drawing.TcPOU:4:5: error[L0501]: the variable `SFCPause`, which governs a chart, is not supported yet");
    insta::assert_snapshot!(reported(VESSEL, "turns >= 2;", "Stirred := turns >= 2;"), @r"
    Drawing.TcPOU:744:9: error[L0501]: the transition `Stirred` that is not a single expression is not supported yet
    Drawing.TcPOU:264:33: error[Q1208]: step `Rest` can never be active
    ");
    insta::assert_snapshot!(reported(VESSEL, "\"quit\"", "\"quit AND\""), @r"
    Drawing.TcPOU:537:55: error[S0101]: `quit AND` is not an expression
    Drawing.TcPOU:465:33: warning[Q1212]: no transition leads on from `Alarm`
    ");
}

#[test]
fn drawings_that_are_cut_off_are_reported() {
    for text in [LEVEL, RUNGS, VESSEL] {
        for end in (0..text.len()).step_by(97) {
            let input = Input::from_text("Drawing.TcPOU", SourceKind::TwinCat, &text[..end]);
            assert!(inspect([input], None).to_string().contains("error"), "{end}");
        }
    }
}

#[test]
fn every_line_of_a_drawing_may_be_missing() {
    for text in [LEVEL, RUNGS, VESSEL] {
        let lines: Vec<&str> = text.lines().collect();
        let is_value = |line: &&str| line.trim_start().starts_with("<v ") || line.trim_start().starts_with("<n ");
        for left_out in (0..lines.len()).filter(|at| lines.get(*at).is_some_and(is_value)).step_by(7) {
            let rest: Vec<&str> =
                lines.iter().enumerate().filter(|(at, _)| *at != left_out).map(|(_, line)| *line).collect();
            findings(&rest.join("\n"));
        }
    }
}
