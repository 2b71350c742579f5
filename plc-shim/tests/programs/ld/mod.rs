//! Ladder Diagrams in PLCopen XML (2nd ed. 4.2, 3rd ed. 8.2).

use crate::plcopen::{
    block, coil, contact, findings, input, jump, label, leave, made_of, output, pou, program, project, rail, rig,
};

/// A rung of contacts in series and a coil.
fn start_stop() -> String {
    let body = [
        rail(1),
        contact(2, (50, 20), "1", "start", ""),
        contact(3, (50, 60), "1", "motor", ""),
        contact(4, (120, 20), "2 3", "stop", "negated=\"true\""),
        coil(5, (200, 20), "4", "motor", ""),
    ];
    program("local start : BOOL, stop : BOOL, motor : BOOL", "LD", &body.concat())
}

#[test]
fn iec2_4_2_6_a_rung_is_evaluated_from_left_to_right() {
    let text = start_stop();
    insta::assert_snapshot!(made_of(&text));
    let mut rig = rig(&text);
    let mut motor = |start: bool, stop: bool| {
        rig.set("P.start", i64::from(start));
        rig.set("P.stop", i64::from(stop));
        rig.scan().expect("no fault");
        rig.bool("P.motor")
    };
    let seen = [motor(false, false), motor(true, false), motor(false, false), motor(false, true), motor(false, false)];
    assert_eq!(seen, [false, true, true, false, false]);
}

#[test]
fn iec2_table_61_contacts() {
    let body = [
        rail(1),
        contact(2, (50, 0), "1", "a", ""),
        coil(3, (200, 0), "2", "no", ""),
        contact(4, (50, 20), "1", "a", "negated=\"true\""),
        coil(5, (200, 20), "4", "nc", ""),
        contact(6, (50, 40), "1", "a", "edge=\"rising\""),
        coil(7, (200, 40), "6", "p", ""),
        contact(8, (50, 60), "1", "a", "edge=\"falling\""),
        coil(9, (200, 60), "8", "n", ""),
    ];
    let text = program("local a : BOOL, no : BOOL, nc : BOOL, p : BOOL, n : BOOL", "LD", &body.concat());
    insta::assert_snapshot!(made_of(&text));
    let mut rig = rig(&text);
    let mut seen = Vec::new();
    for a in [0, 1, 1, 0, 0] {
        rig.set("P.a", a);
        rig.scan().expect("no fault");
        seen.push(["no", "nc", "p", "n"].map(|name| rig.int(&format!("P.{name}"))));
    }
    assert_eq!(seen, [[0, 1, 0, 1], [1, 0, 1, 0], [1, 0, 0, 0], [0, 1, 0, 1], [0, 1, 0, 0]]);
}

#[test]
fn iec2_table_62_coils() {
    let mut body = rail(1) + &contact(2, (50, 0), "1", "a", "");
    let coils = [
        ("plain", ""),
        ("negated", "negated=\"true\""),
        ("set", "storage=\"set\""),
        ("reset", "storage=\"reset\""),
        ("p", "edge=\"rising\""),
        ("n", "edge=\"falling\""),
    ];
    for (id, (name, modifiers)) in (3..).zip(coils) {
        body += &coil(id, (200, 20 * id), "2", name, modifiers);
    }
    let sections = "local a : BOOL, plain : BOOL, negated : BOOL, set : BOOL, reset : BOOL = TRUE, p : BOOL, n : BOOL";
    let text = program(sections, "LD", &body);
    insta::assert_snapshot!(made_of(&text));
    let mut rig = rig(&text);
    let mut seen = Vec::new();
    for a in [0, 1, 1, 0] {
        rig.set("P.a", a);
        rig.scan().expect("no fault");
        seen.push(coils.map(|(name, _)| rig.int(&format!("P.{name}"))));
    }
    let expected = [[0, 1, 0, 1, 0, 1], [1, 0, 1, 0, 1, 0], [1, 0, 1, 0, 0, 0], [0, 1, 1, 0, 0, 1]];
    assert_eq!(seen, expected);
}

#[test]
fn iec2_4_2_5_functions_and_blocks_in_a_rung() {
    let body = [
        rail(1),
        contact(2, (50, 0), "1", "a", ""),
        input(3, (50, 40), "T#20ms"),
        block(4, (100, 0), "TON delay", "IN=2 PT=3", "Q ET", ""),
        input(5, (50, 60), "count"),
        input(6, (50, 80), "1"),
        block(7, (200, 0), "ADD", "EN=4.Q IN1=5 IN2=6", "ENO OUT", ""),
        output(8, (300, 20), "7.OUT", "sum", ""),
        coil(9, (300, 0), "7.ENO", "counted", ""),
    ];
    let sections = "local a : BOOL, delay : TON, count : INT = 41, sum : INT, counted : BOOL";
    let text = program(sections, "LD", &body.concat());
    insta::assert_snapshot!(made_of(&text));
    let mut rig = rig(&text);
    rig.set("P.a", 1);
    let mut seen = Vec::new();
    for _ in 0..4 {
        rig.scan().expect("no fault");
        seen.push((rig.int("P.sum"), rig.bool("P.counted")));
    }
    assert_eq!(seen, [(0, false), (0, false), (42, true), (42, true)]);
}

#[test]
fn iec2_4_1_4_jumps_and_returns() {
    let body = [
        rail(1),
        label(10, (0, 0), "again"),
        input(11, (50, 5), "n"),
        input(12, (50, 6), "1"),
        block(13, (100, 5), "ADD", "IN1=11 IN2=12", "OUT", ""),
        output(14, (200, 5), "13.OUT", "n", ""),
        input(21, (50, 20), "n"),
        input(22, (50, 21), "limit"),
        block(23, (100, 20), "LT", "IN1=21 IN2=22", "OUT", ""),
        jump(24, (200, 20), "23.OUT", "again"),
        contact(30, (50, 40), "1", "skip", ""),
        jump(31, (200, 40), "30", "end"),
        contact(40, (50, 60), "1", "quit", ""),
        leave(41, (200, 60), "40"),
        coil(50, (200, 80), "1", "reached", ""),
        label(60, (0, 100), "end"),
        coil(61, (200, 120), "1", "ended", ""),
    ];
    let sections = "local n : INT, limit : INT, skip : BOOL, quit : BOOL, reached : BOOL, ended : BOOL";
    let text = program(sections, "LD", &body.concat());
    insta::assert_snapshot!(made_of(&text));
    let mut rig = rig(&text);
    let mut scan = |limit, skip, quit| {
        for (name, value) in [("n", 0), ("limit", limit), ("skip", skip), ("quit", quit), ("reached", 0), ("ended", 0)]
        {
            rig.set(&format!("P.{name}"), value);
        }
        rig.scan().map(|()| ["n", "reached", "ended"].map(|name| rig.int(&format!("P.{name}"))))
    };
    assert_eq!(scan(5, 0, 0).expect("no fault"), [5, 1, 1]);
    assert_eq!(scan(3, 1, 0).expect("no fault"), [3, 0, 1]);
    assert_eq!(scan(3, 0, 1).expect("no fault"), [3, 0, 0]);
}

#[test]
fn an_endless_jump_is_a_fault_at_the_jump() {
    let body = rail(1) + &label(2, (0, 0), "again") + &jump(3, (50, 10), "1", "again");
    let text = program("local a : BOOL", "LD", &body);
    let fault = rig(&text).scan().expect_err("an endless loop");
    insta::assert_snapshot!(fault.to_string());
}

#[test]
fn bad_rungs_are_reported() {
    let body = [
        rail(1),
        contact(2, (50, 0), "", "a", ""),
        coil(2, (100, 0), "2 77", "b", ""),
        coil(4, (100, 20), "", "b", ""),
        coil(5, (100, 40), "1", "missing", ""),
        jump(6, (100, 60), "1", "nowhere"),
        coil(7, (100, 80), "4.X 8", "b", ""),
        output(8, (100, 90), "1", "b", ""),
    ];
    insta::assert_snapshot!(findings(&program("local a : BOOL, b : BOOL", "LD", &body.concat())));
    let body = rail(1) + &contact(2, (50, 0), "1", "a", "edge=\"rising\"") + &coil(3, (80, 0), "2", "F", "");
    let function = pou("function", "F", "returns BOOL; in a : BOOL", "LD", &body);
    insta::assert_snapshot!(findings(&project(&function)));
}
