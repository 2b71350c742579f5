//! Function Block Diagrams in PLCopen XML (2nd ed. 4.3, 3rd ed. 8.3).

mod feedback;
mod languages;
mod random;

use crate::plcopen::{block, findings, input, jump, label, made_of, output, pou, program, project, rig, through};

#[test]
fn iec2_4_3_functions_and_blocks_are_joined() {
    let body = [
        input(1, (0, 10), "a"),
        input(2, (0, 30), "b"),
        block(3, (100, 10), "AND", "IN1=1 !IN2=2", "OUT", ""),
        block(4, (200, 10), "CTU counter", ">CU=3.OUT PV=5", "Q CV", ""),
        input(5, (100, 60), "3"),
        output(6, (300, 10), "4.Q", "full", ""),
        output(7, (300, 30), "4.CV", "count", ""),
        output(8, (300, 50), "3.OUT", "both", "negated=\"true\""),
    ];
    let sections = "local a : BOOL, b : BOOL, counter : CTU, full : BOOL, count : INT, both : BOOL";
    let text = program(sections, "FBD", &body.concat());
    insta::assert_snapshot!(made_of(&text));
    let mut rig = rig(&text);
    for (a, count) in [(0, 0), (1, 1), (1, 1), (0, 1), (1, 2)] {
        rig.set("P.a", a);
        rig.scan().expect("no fault");
        assert_eq!((rig.int("P.count"), rig.int("P.both")), (count, 1 - a));
    }
}

#[test]
fn a_value_is_taken_once_and_handed_to_all() {
    let body = [
        input(1, (0, 10), "n"),
        input(2, (0, 30), "1"),
        block(3, (100, 10), "ADD", "IN1=1 IN2=2", "OUT", ""),
        output(4, (200, 10), "3.OUT", "n", ""),
        output(5, (200, 30), "3.OUT", "copy", ""),
        output(6, (200, 50), "1", "before", ""),
    ];
    let text = program("local n : INT, copy : INT, before : INT", "FBD", &body.concat());
    let mut rig = rig(&text);
    for expected in 1..4 {
        rig.scan().expect("no fault");
        assert_eq!(
            ["n", "copy", "before"].map(|name| rig.int(&format!("P.{name}"))),
            [expected, expected, expected - 1]
        );
    }
}

/// Two networks that each copy one variable to the next: what comes of them shows their order.
fn two(first: (u32, &str), second: (u32, &str)) -> [i64; 2] {
    let block = |id, (y, order): (u32, &str), from, to| {
        [
            input(id, (0, y), from),
            block(id + 1, (50, y), "MOVE", &format!("IN={id}"), "OUT", order),
            output(id + 2, (100, y), &format!("{}.OUT", id + 1), to, ""),
        ]
        .concat()
    };
    let body = block(1, first, "a", "b") + &block(11, second, "b", "c");
    let mut rig = rig(&program("local a : INT = 1, b : INT, c : INT", "FBD", &body));
    rig.scan().expect("no fault");
    ["b", "c"].map(|name| rig.int(&format!("P.{name}")))
}

#[test]
fn iec3_8_1_4_order_is_by_id_then_from_top_to_bottom() {
    assert_eq!(two((10, ""), (50, "")), [1, 1]);
    assert_eq!(two((50, ""), (10, "")), [1, 0]);
    assert_eq!(two((10, ""), (10, "")), [1, 1], "the file's order");
    assert_eq!(two((10, "executionOrderId=\"2\""), (50, "executionOrderId=\"1\"")), [1, 0]);
    assert_eq!(two((10, "executionOrderId=\"0\""), (50, "executionOrderId=\"0\"")), [1, 1]);
    assert_eq!(two((10, ""), (50, "executionOrderId=\"7\"")), [1, 0], "what has an id comes first");
}

#[test]
fn iec2_4_1_1_connectors_and_variables_in_a_line() {
    let body = [
        input(1, (0, 0), "a"),
        "<connector name=\"far\" localId=\"2\"><position x=\"50\" y=\"0\"/><connectionPointIn><connection \
         refLocalId=\"1\"/></connectionPointIn></connector>"
            .to_owned(),
        "<continuation name=\"far\" localId=\"3\"><position x=\"0\" y=\"100\"/><connectionPointOut/></continuation>"
            .to_owned(),
        block(4, (50, 100), "NOT", "IN=3", "OUT", ""),
        through(5, (100, 100), "4.OUT", "middle"),
        output(6, (150, 100), "5", "b", ""),
    ];
    let text = program("local a : BOOL, middle : BOOL, b : BOOL", "FBD", &body.concat());
    insta::assert_snapshot!(made_of(&text));
    let mut rig = rig(&text);
    rig.scan().expect("no fault");
    assert!(rig.bool("P.middle") && rig.bool("P.b"));
}

#[test]
fn iec2_2_5_1_units_of_the_project_are_called_by_name() {
    let twice = pou(
        "function",
        "twice",
        "returns INT; in x : INT, y : INT; out big : BOOL",
        "ST",
        "twice := 2 * x + y; big := x &gt; 10;",
    );
    let step = pou("functionBlock", "step", "inout n : INT; in more : INT; local k : INT", "ST", "n := n + more;");
    let body = [
        input(1, (0, 0), "20"),
        block(2, (50, 0), "twice", "x=1 y=", "twice big", ""),
        output(3, (100, 0), "2.twice", "result", ""),
        output(4, (100, 20), "2.big", "big", ""),
        input(5, (0, 50), "total"),
        "<block localId=\"6\" typeName=\"step\" instanceName=\"s\"><position x=\"50\" y=\"50\"/><inputVariables>\
         <variable formalParameter=\"more\"><connectionPointIn><connection refLocalId=\"1\"/></connectionPointIn></variable>\
         </inputVariables><inOutVariables><variable formalParameter=\"n\"><connectionPointIn>\
         <connection refLocalId=\"5\"/></connectionPointIn></variable></inOutVariables><outputVariables/></block>"
            .to_owned(),
        output(7, (100, 50), "6.n", "seen", ""),
    ];
    let sections = "local result : INT, big : BOOL, total : INT, s : step, seen : INT";
    let text = project(&(twice + &step + &pou("program", "P", sections, "FBD", &body.concat())));
    insta::assert_snapshot!(made_of(&text));
    let mut rig = rig(&text);
    rig.scan().expect("no fault");
    assert_eq!(["result", "big", "total", "seen"].map(|name| rig.int(&format!("P.{name}"))), [40, 1, 20, 20]);
}

#[test]
fn jumps_divide_a_body() {
    let body = [
        input(1, (0, 0), "skip"),
        jump(2, (100, 0), "1", "rest"),
        input(3, (0, 30), "1"),
        output(4, (100, 30), "3", "a", ""),
        label(5, (0, 60), "rest"),
        input(6, (0, 90), "1"),
        output(7, (100, 90), "6", "b", ""),
    ];
    let text = program("local skip : BOOL = TRUE, a : INT, b : INT", "FBD", &body.concat());
    let mut rig = rig(&text);
    rig.scan().expect("no fault");
    assert_eq!((rig.int("P.a"), rig.int("P.b")), (0, 1));
}

#[test]
fn bad_networks_are_reported() {
    let body = [
        input(1, (0, 0), "a"),
        input(2, (0, 20), "b"),
        output(3, (100, 0), "1 2", "c", ""),
        block(4, (50, 40), "ADD", "IN1=1 IN2=", "OUT", ""),
        output(5, (100, 40), "4.SUM", "n", ""),
        block(6, (50, 60), "TON t", "IN=1 XX=1", "Q", ""),
        output(7, (100, 60), "6.Q", "c; b := a", ""),
        block(8, (50, 80), "", "IN=1", "OUT", ""),
        "<vendorElement localId=\"9\"><alternativeText/><connectionPointIn><connection refLocalId=\"1\"/>\
         </connectionPointIn></vendorElement>\n<vendorElement localId=\"10\"><alternativeText/></vendorElement>\n"
            .to_owned(),
        "<outVariable localId=\"11\"><connectionPointIn><connection refLocalId=\"1\"/></connectionPointIn></outVariable>"
            .to_owned(),
    ];
    let sections = "local a : BOOL, b : BOOL, c : BOOL, n : INT, t : TON";
    insta::assert_snapshot!(findings(&program(sections, "FBD", &body.concat())));
}
