//! The same logic in all languages gives the same trace.

use crate::plcopen::{block, coil, contact, input, output, program, rail, rig};

const SECTIONS: &str = "local start : BOOL, stop : BOOL, motor : BOOL, delay : TON, on : BOOL, n : INT";

/// A motor that keeps itself on, is shown as on 20 ms later, and counts its scans.
fn written() -> [(&'static str, String); 4] {
    let st = "motor := (start OR motor) AND NOT stop; delay(IN := motor, PT := T#20ms); on := delay.Q; IF on THEN n := n + 1; \
              END_IF;";
    let il = "LD start\nOR motor\nANDN stop\nST motor\nCAL delay(IN := motor, PT := T#20ms)\nLD delay.Q\nST on\n\
              JMPCN off\nLD n\nADD 1\nST n\noff:\n";
    let ld = [
        rail(1),
        contact(2, (50, 0), "1", "start", ""),
        contact(3, (50, 20), "1", "motor", ""),
        contact(4, (100, 0), "2 3", "stop", "negated=\"true\""),
        coil(5, (150, 0), "4", "motor", ""),
        contact(6, (50, 60), "1", "motor", ""),
        input(7, (50, 80), "T#20ms"),
        block(8, (100, 60), "TON delay", "IN=6 PT=7", "Q", ""),
        coil(9, (150, 60), "8.Q", "on", ""),
        contact(10, (50, 120), "1", "on", ""),
        input(11, (50, 140), "n"),
        input(12, (50, 160), "1"),
        block(13, (100, 120), "ADD", "EN=10 IN1=11 IN2=12", "ENO OUT", ""),
        block(14, (150, 120), "SEL", "G=13.ENO IN0=11 IN1=13.OUT", "OUT", ""),
        output(15, (200, 120), "14.OUT", "n", ""),
    ];
    let fbd = [
        input(1, (0, 0), "start"),
        input(2, (0, 20), "motor"),
        input(3, (0, 40), "stop"),
        block(4, (50, 0), "OR", "IN1=1 IN2=2", "OUT", ""),
        block(5, (100, 0), "AND", "IN1=4.OUT !IN2=3", "OUT", ""),
        output(6, (150, 0), "5.OUT", "motor", ""),
        input(7, (50, 80), "T#20ms"),
        block(8, (150, 60), "TON delay", "IN=5.OUT PT=7", "Q", ""),
        output(9, (200, 60), "8.Q", "on", ""),
        input(11, (50, 140), "n"),
        input(12, (50, 160), "1"),
        block(13, (100, 140), "ADD", "IN1=11 IN2=12", "OUT", ""),
        block(14, (250, 120), "SEL", "G=8.Q IN0=11 IN1=13.OUT", "OUT", ""),
        output(15, (300, 120), "14.OUT", "n", ""),
    ];
    [("ST", st.to_owned()), ("IL", il.to_owned()), ("LD", ld.concat()), ("FBD", fbd.concat())]
}

#[test]
fn the_same_logic_has_the_same_trace_in_every_language() {
    let inputs = [(0, 0), (1, 0), (0, 0), (0, 0), (0, 0), (1, 1), (0, 0), (1, 0), (1, 0), (0, 0), (0, 0)];
    let traces = written().map(|(language, body)| {
        let mut rig = rig(&program(SECTIONS, language, &body));
        inputs.map(|(start, stop)| {
            rig.set("P.start", start);
            rig.set("P.stop", stop);
            rig.scan().expect("no fault");
            ["motor", "on", "n", "delay.Q"].map(|name| rig.int(&format!("P.{name}")))
        })
    });
    assert!(traces[0].iter().any(|seen| seen[2] > 2));
    for trace in &traces {
        assert_eq!(*trace, traces[0]);
    }
}
