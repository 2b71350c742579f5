//! Timing diagrams of the standard function blocks, one column per scan.

use crate::rig::Rig;

/// A block's timing diagram, in scans of 10 ms.
fn diagram(block: &str, preset: &str, inputs: &[(&str, &str)], outputs: &[&str]) -> String {
    let mut rig = Rig::new(&format!("PROGRAM P VAR b : {block} := ({preset}); END_VAR b(); END_PROGRAM"));
    crate::diagram::diagram(&mut rig, "P.b", inputs, outputs)
}

#[test]
fn ton() {
    insta::assert_snapshot!(diagram("TON", "PT := T#30ms", &[("IN", "..######..##..#####")], &["Q", "ET"]));
}

#[test]
fn tof() {
    insta::assert_snapshot!(diagram("TOF", "PT := T#30ms", &[("IN", "..###......###..##....")], &["Q", "ET"]));
}

#[test]
fn tp() {
    insta::assert_snapshot!(diagram("TP", "PT := T#30ms", &[("IN", "..######...#....#.#.##...")], &["Q", "ET"]));
}

#[test]
fn edges() {
    insta::assert_snapshot!(diagram("R_TRIG", "CLK := FALSE", &[("CLK", "#..##.#.")], &["Q"]));
    insta::assert_snapshot!(diagram("F_TRIG", "CLK := FALSE", &[("CLK", "..##.##..")], &["Q"]));
}

#[test]
fn bistables() {
    insta::assert_snapshot!(diagram("SR", "S1 := FALSE", &[("S1", ".#...#.."), ("R", "...#.##.")], &["Q1"]));
    insta::assert_snapshot!(diagram("RS", "S := FALSE", &[("S", ".#...#.#"), ("R1", "...#.##.")], &["Q1"]));
}

#[test]
fn counters() {
    insta::assert_snapshot!(diagram("CTU", "PV := 2", &[("CU", "#.##.#.#.."), ("R", "......##..")], &["Q", "CV"]));
    insta::assert_snapshot!(diagram("CTD", "PV := 2", &[("CD", "#.#.#.#.."), ("LD", ".#.....#.")], &["Q", "CV"]));
    insta::assert_snapshot!(diagram(
        "CTUD",
        "PV := 2",
        &[("CU", "#.#.#..#..."), ("CD", "....#.#...."), ("R", "........#.."), ("LD", ".........#.")],
        &["QU", "QD", "CV"]
    ));
}

#[test]
fn blocks_that_are_not_used_cost_nothing() {
    let size = |declaration: &str, call: &str| {
        let text = format!("PROGRAM P VAR {declaration} END_VAR {call} END_PROGRAM");
        let application = crate::rig::application(&text);
        (application.wasm().len(), application.initial_memory().len())
    };
    let without = size("x : BOOL;", "x := TRUE;");
    let with = size("x : TON;", "x(IN := TRUE);");
    assert!(with.0 > without.0 + 100, "{with:?} {without:?}");
    assert_eq!(without.1, 65);
}

#[test]
fn iec2_2_5_2_3_3_table_36_counters_of_every_type_end_at_its_limits() {
    for (ty, low, high) in [
        ("INT", i64::from(i16::MIN), i64::from(i16::MAX)),
        ("DINT", i64::from(i32::MIN), i64::from(i32::MAX)),
        ("LINT", i64::MIN, i64::MAX),
        ("UDINT", 0, i64::from(u32::MAX)),
        ("ULINT", 0, -1),
    ] {
        let mut rig = Rig::new(&format!(
            "PROGRAM P VAR up : CTU_{ty}; down : CTD_{ty}; both : CTUD_{ty}; k : BOOL; n : {ty}; END_VAR
             k := NOT k; up(CU := k, R := FALSE, PV := 2); down(CD := k, LD := FALSE, PV := 1);
             both(CU := k, CD := FALSE, R := FALSE, LD := FALSE, PV := 1); END_PROGRAM"
        ));
        let high = rig.int("P.n").wrapping_add(high);
        rig.set("P.up.CV", high.wrapping_sub(1));
        rig.set("P.down.CV", low.wrapping_add(1));
        for _ in 0..5 {
            rig.scan().expect("no fault");
        }
        assert_eq!((rig.int("P.up.CV"), rig.int("P.down.CV"), rig.int("P.both.CV")), (high, low, 3), "{ty}");
        assert!(rig.bool("P.up.Q") && rig.bool("P.down.Q") && rig.bool("P.both.QU") && !rig.bool("P.both.QD"));
    }
}

#[test]
fn iec3_table_46_timers_of_either_duration_agree_with_the_plain_ones() {
    let mut rig = Rig::new(
        "PROGRAM P VAR n : INT; in, same : BOOL := TRUE; a : TON; b : TON_TIME; c : TON_LTIME; d : TOF; e : TOF_TIME; f : TOF_LTIME;
           g : TP; h : TP_TIME; i : TP_LTIME; END_VAR
         n := n + 1; in := n MOD 7 > 2;
         a(IN := in, PT := T#25ms); b(IN := in, PT := T#25ms); c(IN := in, PT := LT#25ms);
         d(IN := in, PT := T#25ms); e(IN := in, PT := T#25ms); f(IN := in, PT := LT#25ms);
         g(IN := in, PT := T#25ms); h(IN := in, PT := T#25ms); i(IN := in, PT := LT#25ms);
         same := same AND a.Q = b.Q AND a.Q = c.Q AND d.Q = e.Q AND d.Q = f.Q AND g.Q = h.Q AND g.Q = i.Q
           AND a.ET = c.ET AND d.ET = f.ET AND g.ET = i.ET AND b.ET = c.ET; END_PROGRAM",
    );
    for _ in 0..30 {
        rig.scan().expect("no fault");
        assert!(rig.bool("P.same"));
    }
}

#[test]
fn iec2_2_5_2_3_4_table_37_the_clock_goes_on_from_its_preset() {
    let mut rig = Rig::new(
        "PROGRAM P VAR clock : RTC; in : BOOL; s : STRING[40]; END_VAR
         clock(IN := in, PDT := DT#1999-12-31-23:59:59.98); s := TO_STRING(clock.CDT); END_PROGRAM",
    );
    rig.scan().expect("no fault");
    assert!(!rig.bool("P.clock.Q"));
    rig.set("P.in", 1);
    let mut seen = Vec::new();
    for _ in 0..4 {
        rig.scan().expect("no fault");
        seen.push(rig.text("P.s"));
    }
    assert_eq!(
        seen,
        [
            "DT#1999-12-31-23:59:59.98",
            "DT#1999-12-31-23:59:59.99",
            "DT#2000-01-01-00:00:00",
            "DT#2000-01-01-00:00:00.01"
        ]
    );
}

#[test]
fn iec1_table_34_a_semaphore_is_claimed_once() {
    let mut rig = Rig::new(
        "PROGRAM P VAR s : SEMA; claim, release : BOOL; END_VAR s(CLAIM := claim, RELEASE := release); END_PROGRAM",
    );
    let mut step = |claim: i64, release: i64| {
        rig.set("P.claim", claim);
        rig.set("P.release", release);
        rig.scan().expect("no fault");
        rig.bool("P.s.BUSY")
    };
    assert_eq!([step(1, 0), step(1, 0), step(0, 0), step(0, 1), step(0, 0)], [false, true, true, false, false]);
}

#[test]
fn iec2_2_5_2_2_table_33_inputs_with_edges_are_seen_as_triggers() {
    let mut rig = Rig::new(
        "FUNCTION_BLOCK Counter VAR_INPUT up : BOOL R_EDGE; down : BOOL F_EDGE; END_VAR VAR_OUTPUT n, m : INT; END_VAR
           IF up THEN n := n + 1; END_IF; IF down THEN m := m + 1; END_IF; END_FUNCTION_BLOCK
         PROGRAM P VAR c : Counter; r : R_TRIG; f : F_TRIG; x : BOOL; n, m, k : INT; END_VAR
           k := k + 1; x := k MOD 5 > 2; c(up := x, down := x); r(CLK := x); f(CLK := x);
           IF r.Q THEN n := n + 1; END_IF; IF f.Q THEN m := m + 1; END_IF; END_PROGRAM",
    );
    for _ in 0..20 {
        rig.scan().expect("no fault");
        assert_eq!((rig.int("P.c.n"), rig.int("P.c.m")), (rig.int("P.n"), rig.int("P.m")));
    }
    assert_eq!(rig.int("P.n"), 4);
}
