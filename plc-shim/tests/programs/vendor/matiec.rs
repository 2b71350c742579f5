//! `MatIEC` and Beremiz: controllers, types of the operator's page.

use onescan_iec::Dialect::Matiec;

use super::{Rig, hold};

#[test]
fn controllers() {
    // Two calls of half a second with an error of 2: 2 * 0.5 s * 2; the slope of a ramp of 4 per second.
    hold(
        Matiec,
        "i : INTEGRAL; d : DERIVATIVE; r : RAMP; h : HYSTERESIS; high, low, between : BOOL; k : INT; x : REAL;",
        "i(RUN := FALSE, R1 := TRUE, X0 := 10.0); i(RUN := TRUE, R1 := FALSE, XIN := 2.0, CYCLE := T#500ms); i();
         d(RUN := FALSE, XIN := 0.0);
         FOR k := 1 TO 5 DO x := x + 2.0; d(RUN := TRUE, XIN := x, CYCLE := T#500ms); END_FOR;
         r(RUN := FALSE, X0 := 1.0); r(RUN := TRUE, X1 := 5.0, TR := T#2s, CYCLE := T#1s); r();
         h(XIN1 := 3.0, XIN2 := 1.0, EPS := 0.5); high := h.Q;
         h(XIN1 := 0.7); between := h.Q; h(XIN1 := 0.4); low := h.Q;",
        &["i.XOUT = 12.0 AND i.Q", "d.XOUT = 4.0", "r.XOUT = 3.0 AND r.BUSY", "high AND between AND NOT low"],
    );
}

#[test]
fn a_pid_holds_its_output_by_hand_and_goes_on_from_there() {
    hold(
        Matiec,
        "c : PID; by_hand, first : REAL;",
        "c(AUTO := FALSE, PV := 1.0, SP := 1.0, X0 := 7.0, KP := 1.0, TR := 2.0, TD := 0.0, CYCLE := T#1s); by_hand := c.XOUT;
         c(AUTO := TRUE, PV := 2.0); first := c.XOUT;",
        &["by_hand = 7.0", "first = 8.5"],
    );
}

#[test]
fn types_of_the_operators_page_are_what_they_are_named() {
    let text = "PROGRAM P VAR n : HMI_INT := 5; x : HMI_REAL; s : HMI_STRING := 'ab'; on : HMI_BOOL; page : HMI_NODE;
          r : INT; z : REAL; END_VAR
        x := 1.5; z := x / 0.5; on := TRUE; r := n + LEN(s); page := on; s := CONCAT(s, 'c'); END_PROGRAM";
    let mut rig = Rig::in_dialect(Matiec, text);
    rig.scan().expect("no fault");
    assert_eq!(rig.int("P.r"), 7);
}
