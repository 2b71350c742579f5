//! Loops (3rd ed. 8.1.4.3): an element in one takes what the feedback variable was in the evaluation before.

use crate::plcopen::{block, findings, input, made_of, output, program, rig, through};

#[test]
fn an_output_of_an_instance_feeds_back() {
    // The latch resets itself one scan after it was set.
    let body = [
        input(1, (0, 0), "a"),
        block(2, (100, 0), "RS latch", "S=1 R1=3", "Q1", ""),
        block(3, (200, 0), "AND", "IN1=2.Q1 IN2=1", "OUT", ""),
        output(4, (200, 40), "2.Q1", "q", ""),
    ];
    let text = program("local a : BOOL, latch : RS, q : BOOL", "FBD", &body.concat());
    insta::assert_snapshot!(made_of(&text));
    let mut rig = rig(&text);
    rig.set("P.a", 1);
    let mut seen = Vec::new();
    for _ in 0..4 {
        rig.scan().expect("no fault");
        seen.push(rig.bool("P.q"));
    }
    assert_eq!(seen, [true, false, true, false]);
}

#[test]
fn a_variable_in_the_line_feeds_back() {
    let body = [
        input(1, (0, 0), "2"),
        block(2, (100, 0), "ADD", "IN1=1 IN2=3", "OUT", ""),
        through(3, (200, 0), "2.OUT", "sum"),
        output(4, (300, 0), "3", "copy", ""),
    ];
    let text = program("local sum : INT = 5, copy : INT", "FBD", &body.concat());
    insta::assert_snapshot!(made_of(&text));
    let mut rig = rig(&text);
    for expected in [7, 9, 11] {
        rig.scan().expect("no fault");
        assert_eq!((rig.int("P.sum"), rig.int("P.copy")), (expected, expected));
    }
}

/// Two blocks that each take what the other gives.
fn ring(first: &str, second: &str) -> String {
    let body = [
        input(1, (0, 0), "a"),
        block(2, (100, 0), "SR x", "S1=1 R=3.Q1", "Q1", first),
        block(3, (200, 0), "SR y", "S1=2.Q1 R=", "Q1", second),
    ];
    program("local a : BOOL = TRUE, x : SR, y : SR", "FBD", &body.concat())
}

#[test]
fn ids_order_the_blocks_of_a_loop() {
    let after = |text: String| {
        let mut rig = rig(&text);
        rig.scan().expect("no fault");
        ["x", "y"].map(|name| rig.bool(&format!("P.{name}.Q1")))
    };
    assert_eq!(after(ring("executionOrderId=\"1\"", "executionOrderId=\"2\"")), [true, true]);
    assert_eq!(after(ring("executionOrderId=\"2\"", "executionOrderId=\"1\"")), [true, false]);
}

/// Elements with an id come first, then those that stand higher or further left, as outside of loops.
#[test]
fn places_order_the_blocks_of_a_loop_without_ids() {
    let after = |text: String| {
        let mut rig = rig(&text);
        rig.scan().expect("no fault");
        ["x", "y"].map(|name| rig.bool(&format!("P.{name}.Q1")))
    };
    assert_eq!(after(ring("", "")), [true, true]);
    assert_eq!(after(ring("", "executionOrderId=\"2\"")), [true, false]);
    insta::assert_snapshot!(findings(&ring("", "")), @"p.xml:6:1: warning[G1105]: several elements keep values in this loop, and `executionOrderId` does not say of each when it comes: those without come last, the highest first, then the one furthest left (give each of them an `executionOrderId`)");
}

#[test]
fn loops_without_a_variable_are_reported() {
    let body = [
        block(2, (100, 0), "NOT", "IN=3.OUT", "OUT", ""),
        block(3, (200, 0), "NOT", "IN=2.OUT", "OUT", ""),
        output(4, (300, 0), "3.OUT", "a", ""),
    ];
    let text = program("local a : BOOL", "FBD", &body.concat());
    insta::assert_snapshot!(findings(&text), @"p.xml:5:1: error[G1104]: this loop has no feedback variable: no instance and no variable keeps a value in it");
}
