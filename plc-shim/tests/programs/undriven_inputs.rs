//! The inputs that nothing in an application gives a value.

use onescan_iec::Input;
use onescan_iec::input::kind::SourceKind;
use onescan_iec_run::Application;

/// The parts of each open input, as paths.
fn open(name: &str, text: &str) -> Vec<String> {
    let input = Input::from_text(name, SourceKind::Text, text);
    let application = Application::from_inputs([input]).unwrap_or_else(|error| panic!("{error}"));
    let inputs = application.open_inputs();
    inputs.iter().flat_map(|input| &input.parts).map(|part| part.path.clone()).collect()
}

#[test]
fn an_input_of_a_program_is_open() {
    let text = "PROGRAM P VAR_INPUT a : BOOL; b : INT := 3; END_VAR VAR c : INT; END_VAR VAR_OUTPUT d : BOOL; END_VAR
        d := a; END_PROGRAM";
    assert_eq!(open("a.st", text), ["P.a", "P.b"]);
}

#[test]
fn a_connection_of_the_configuration_drives_it() {
    let text = "PROGRAM P VAR_INPUT a, b : BOOL; END_VAR VAR_OUTPUT d : BOOL; END_VAR d := a AND b; END_PROGRAM
        CONFIGURATION C VAR_GLOBAL g : BOOL; END_VAR
        TASK t(INTERVAL := T#10ms, PRIORITY := 0); PROGRAM one WITH t : P(a := g); END_CONFIGURATION";
    assert_eq!(open("a.st", text), ["one.b"]);
}

#[test]
fn another_program_drives_it_by_a_call_an_assignment_or_its_address() {
    let inner = "PROGRAM Q VAR_INPUT a, b, c, d : INT; list : ARRAY [0..2] OF INT; END_VAR VAR s : INT; END_VAR
        s := a + b + c + d + list[0]; END_PROGRAM\n";
    let outer = "PROGRAM P VAR i : INT; p : POINTER TO INT; END_VAR
        Q(a := 1); Q.b := 2; p := ADR(Q.c); FOR i := 0 TO 2 DO Q.list[i] := i; END_FOR END_PROGRAM";
    assert_eq!(open("a.exp", &format!("{inner}{outer}")), ["Q.d"]);
    assert_eq!(
        open("a.exp", &format!("{inner}PROGRAM P Q(); Q.list[1] := Q.a; END_PROGRAM")),
        ["Q.a", "Q.b", "Q.c", "Q.d", "Q.list[0]", "Q.list[2]"]
    );
}

#[test]
fn what_is_read_of_the_input_area_is_open() {
    let text = "VAR_GLOBAL spare AT %IX2.0 : BOOL; END_VAR
        PROGRAM P VAR start AT %IX0.0 : BOOL; stop AT %IX0.1 : BOOL; level AT %IW4 : INT; o : BOOL; END_VAR
        o := start AND NOT stop AND level > 3 AND %IX1.5; END_PROGRAM";
    assert_eq!(open("a.st", text), ["P.start", "P.stop", "P.level", "%IX1.5"]);
}

#[test]
fn what_lies_somewhere_in_the_input_area_is_open() {
    let text = "VAR_GLOBAL gone AT %I* : INT; taken AT %I* : INT; END_VAR
        PROGRAM P VAR stop AT %I* : BOOL; lamp AT %Q* : BOOL; END_VAR lamp := stop AND gone > 3; taken := 1; END_PROGRAM";
    assert_eq!(open("a.exp", text), ["gone", "P.stop"]);
}

#[test]
fn a_program_does_not_drive_its_own_input() {
    let text = "PROGRAM P VAR_INPUT reset : BOOL; END_VAR VAR n : INT; END_VAR
        IF reset THEN n := 0; reset := FALSE; END_IF n := n + 1; END_PROGRAM";
    assert_eq!(open("a.exp", text), ["P.reset"]);
}

#[test]
fn what_lies_in_the_input_area_inside_of_instances_is_open() {
    let text = "TYPE Rack : STRUCT door AT %I* : BOOL; n : INT; END_STRUCT END_TYPE
        FUNCTION_BLOCK Axis VAR home AT %I* : BOOL; fixed AT %IX7.0 : BOOL; n : INT; END_VAR
        VAR_OUTPUT o : BOOL; END_VAR o := home AND fixed; END_FUNCTION_BLOCK
        PROGRAM P VAR x : ARRAY [1..2] OF Axis; rack : Rack; lamp : BOOL; END_VAR
        x[1](); x[2](); lamp := rack.door AND x[1].o; END_PROGRAM";
    assert_eq!(open("a.exp", text), ["P.x[1].home", "P.x[1].fixed", "P.x[2].home", "P.rack.door"]);
}

#[test]
fn a_structure_in_the_input_area_that_the_program_writes_is_not_open() {
    let text = "TYPE Rack : STRUCT door AT %I* : BOOL; n : INT; END_STRUCT END_TYPE
        VAR_GLOBAL rack : Rack; END_VAR
        PROGRAM P VAR lamp : BOOL; END_VAR rack.door := TRUE; lamp := rack.door; END_PROGRAM";
    assert_eq!(open("a.exp", text), [""; 0]);
}
