//! What is wrong with a chart, and where.

use onescan_iec::Dialect;

use crate::rig::{findings, findings_in};

fn chart(body: &str) -> String {
    findings(&format!("PROGRAM P\nVAR go, valve, lamp : BOOL; n : INT; delay : TIME; END_VAR\n{body}\nEND_PROGRAM"))
}

#[test]
fn iec2_2_6_each_rule_of_charts_has_its_finding() {
    let two = "INITIAL_STEP A: END_STEP STEP B: END_STEP\n";
    let back = "TRANSITION FROM B TO A := go; END_TRANSITION\n";
    let there = "TRANSITION FROM A TO B := go; END_TRANSITION\n";
    let all = [
        ("step named twice", format!("{two}{there}{back}STEP a: END_STEP")),
        ("step named like a variable", format!("{two}{there}{back}STEP valve: END_STEP")),
        ("action named like a variable", "INITIAL_STEP A: Valve(N); END_STEP ACTION Valve: ; END_ACTION".to_owned()),
        ("unknown step", format!("{two}{there}TRANSITION FROM B TO Bb := go; END_TRANSITION")),
        ("step twice in a list", format!("{two}{back}TRANSITION FROM A TO (B, b) := go; END_TRANSITION")),
        ("no initial step", format!("STEP A: END_STEP STEP B: END_STEP {there}{back}")),
        ("two initial steps", format!("INITIAL_STEP A: END_STEP INITIAL_STEP B: END_STEP {there}{back}")),
        ("two networks", format!("{two}{there}{back}INITIAL_STEP C: END_STEP")),
        ("a step alone", format!("{two}{there}{back}STEP C: END_STEP")),
        ("no condition", format!("{two}{there}TRANSITION FROM B TO A := n; END_TRANSITION")),
        (
            "assigned step",
            "INITIAL_STEP A: Act(N); END_STEP ACTION Act: A.X := TRUE; Act.Q := go; END_ACTION".to_string(),
        ),
        (
            "assigned transition",
            format!("{two}{back}TRANSITION t FROM A TO B : t := go; END_TRANSITION ACTION x: t := go; END_ACTION"),
        ),
        ("nameless network", format!("{two}{back}TRANSITION FROM A TO B : n := 1; END_TRANSITION")),
        ("unknown action", "INITIAL_STEP A: vale(N); END_STEP".to_owned()),
        ("action of another type", "INITIAL_STEP A: n(N); END_STEP".to_owned()),
        ("unknown qualifier", "INITIAL_STEP A: valve(SS); END_STEP".to_owned()),
        ("missing time", "INITIAL_STEP A: valve(SD); END_STEP".to_owned()),
        ("needless time", "INITIAL_STEP A: valve(N, T#1s); END_STEP".to_owned()),
        ("time of another type", "INITIAL_STEP A: valve(L, n); END_STEP".to_owned()),
        ("indicator of another type", "INITIAL_STEP A: valve(L, delay, n); END_STEP".to_owned()),
        ("two times", "INITIAL_STEP A: valve(L, delay); valve(D, delay); END_STEP".to_owned()),
        ("statements", format!("{two}{there}{back}n := 1;")),
        (
            "step of two charts",
            "INITIAL_STEP A: Act(N); END_STEP ACTION Act: INITIAL_STEP a: END_STEP END_ACTION".to_owned(),
        ),
        (
            "action of two charts",
            "INITIAL_STEP A: Act(N); valve(R); END_STEP
            ACTION Act: INITIAL_STEP B: Valve(S); Valve(N); END_STEP END_ACTION"
                .to_owned(),
        ),
        (
            "statements beside a chart in an action",
            "INITIAL_STEP A: Act(N); END_STEP ACTION Act: INITIAL_STEP B: END_STEP n := 1; END_ACTION".to_owned(),
        ),
        (
            "transition from one chart to another",
            format!(
                "{two}{there}{back}ACTION x: INITIAL_STEP C: END_STEP STEP D: END_STEP
            TRANSITION FROM C TO A := go; END_TRANSITION END_ACTION"
            ),
        ),
        (
            "action in its own chart",
            "INITIAL_STEP A: Act(N); END_STEP ACTION Act: INITIAL_STEP B: Again(N); END_STEP END_ACTION
            ACTION Again: Act(); END_ACTION"
                .to_owned(),
        ),
        (
            "chart of a function",
            "END_PROGRAM FUNCTION F : BOOL INITIAL_STEP B: END_STEP F := TRUE; END_FUNCTION PROGRAM Q".to_owned(),
        ),
        ("end", format!("{two}{there}")),
        (
            "halt",
            format!(
                "{two}STEP C: END_STEP STEP D: END_STEP
            STEP E: END_STEP
            TRANSITION FROM A TO (B, C) := go; END_TRANSITION
            TRANSITION FROM B TO D := go; END_TRANSITION
            TRANSITION FROM C TO E := go; END_TRANSITION
            TRANSITION FROM (D, C) TO A := go; END_TRANSITION
            TRANSITION FROM (B, E) TO A := go; END_TRANSITION"
            ),
        ),
    ];
    let report: Vec<String> = all.iter().map(|(what, body)| format!("{what}\n{}", chart(body))).collect();
    insta::assert_snapshot!(report.join("\n\n"));
}

#[test]
fn iec2_b_1_6_a_slip_in_a_chart_is_reported_once() {
    let good = "TRANSITION FROM B TO A := go; END_TRANSITION";
    let slips = [
        "STEP B valve(N); END_STEP TRANSITION FROM A TO B := go; END_TRANSITION",
        "STEP B: valve(N) END_STEP TRANSITION FROM A TO B := go; END_TRANSITION",
        "STEP B: valve N; END_STEP TRANSITION FROM A TO B := go; END_TRANSITION",
        "STEP B: valve(N; END_STEP TRANSITION FROM A TO B := go; END_TRANSITION",
        "STEP B: valve(N); TRANSITION FROM A TO B := go; END_TRANSITION",
        "STEP B: END_STEP TRANSITION FROM A B := go; END_TRANSITION",
        "STEP B: END_STEP TRANSITION A TO B := go; END_TRANSITION",
        "STEP B: END_STEP TRANSITION FROM A TO := go; END_TRANSITION",
        "STEP B: END_STEP TRANSITION FROM A TO B := ; END_TRANSITION",
        "STEP B: END_STEP TRANSITION FROM A TO B go; END_TRANSITION",
        "STEP B: END_STEP TRANSITION FROM (A TO B := go; END_TRANSITION",
        "STEP B: END_STEP TRANSITION (PRIORITY := x) FROM A TO B := go; END_TRANSITION",
        "STEP B: END_STEP TRANSITION FROM A TO B := go;",
    ];
    let each = slips.iter().map(|slip| {
        let text = format!("INITIAL_STEP A: END_STEP\n{slip}\n{good}");
        format!("{slip}\n{}", chart(&text))
    });
    insta::assert_snapshot!(each.collect::<Vec<_>>().join("\n\n"));
}

/// What the letter of the standard gives, and what the code of `MatIEC` does.
#[test]
fn a_pulse_that_is_never_given_is_reported() {
    let text = "PROGRAM P
VAR go, lamp : BOOL; n : INT; END_VAR
    INITIAL_STEP A: lamp(P0); END_STEP
    STEP B: Count(P1); lamp(P1); END_STEP
    STEP C: Count(P1); END_STEP
    STEP D: Other(P0); END_STEP
    TRANSITION FROM A TO B := go; END_TRANSITION
    TRANSITION FROM B TO C := go; END_TRANSITION
    TRANSITION FROM C TO D := go; END_TRANSITION
    TRANSITION FROM D TO A := go; END_TRANSITION
    ACTION Count: n := n + 1; END_ACTION
    ACTION Other: n := 0; END_ACTION
END_PROGRAM";
    let [iec3, matiec] = [Dialect::Iec3, Dialect::Matiec].map(|dialect| findings_in(dialect, text).to_string());
    insta::assert_snapshot!(format!("iec3\n{iec3}\n\nmatiec\n{matiec}"));
}

/// A step that follows itself stays active, and one that names an action twice has one pulse.
#[test]
fn a_pulse_of_one_step_is_lost() {
    let text = "PROGRAM P
VAR go : BOOL; n : INT; END_VAR
    INITIAL_STEP A: END_STEP
    STEP B: Count(P1); Count(P0); END_STEP
    TRANSITION FROM A TO B := go; END_TRANSITION
    TRANSITION FROM B TO B := NOT go; END_TRANSITION
    TRANSITION FROM B TO A := n > 9; END_TRANSITION
    ACTION Count: n := n + 1; END_ACTION
END_PROGRAM";
    let found = findings_in(Dialect::Iec3, text).to_string();
    assert!(found.contains("`Count` gets no pulse from `B` where `B` follows `B`"), "{found}");
    let found = findings_in(Dialect::Matiec, text).to_string();
    assert!(
        found.contains("`B` names `Count` by two pulses: MatIEC's code of the last takes this one back"),
        "{found}"
    );
}

#[test]
fn words_of_charts_are_names_elsewhere() {
    let text = "PROGRAM P VAR step, transition, initial_step, from : INT; END_VAR
        step := transition + 1;
        transition := step;
        initial_step := from;
        from := initial_step;
        END_PROGRAM";
    assert_eq!(findings(text), "");
}

/// A detector that sees a step of one branch does not see that one of the other begins or ends meanwhile.
#[test]
fn pulses_of_parallel_branches_cover_each_other() {
    let chart = |left: &str, right: &str| {
        let text = format!(
            "PROGRAM P
VAR go : BOOL; n : INT; END_VAR
    INITIAL_STEP A: END_STEP
    STEP L1: {left} END_STEP
    STEP L2: END_STEP
    STEP R1: END_STEP
    STEP R2: {right} END_STEP
    TRANSITION FROM A TO (L1, R1) := go; END_TRANSITION
    TRANSITION FROM L1 TO L2 := n > 3; END_TRANSITION
    TRANSITION FROM R1 TO R2 := NOT go; END_TRANSITION
    TRANSITION FROM (L2, R2) TO A := n > 9; END_TRANSITION
    ACTION Count: n := n + 1; END_ACTION
    ACTION Other: n := n + 2; END_ACTION
END_PROGRAM"
        );
        let found = findings_in(Dialect::Iec3, &text).to_string();
        found.lines().filter(|line| line.contains("Q1214")).count()
    };
    assert_eq!(chart("Count(P1);", "Count(P1);"), 1, "`L1` begins when `R2` is not active");
    assert_eq!(chart("Count(P0);", "Count(P0);"), 1, "`R2` ends when `L1` is not active");
    assert_eq!(chart("Count(P1);", "Other(P1);"), 0);
    assert_eq!(chart("Count(P1);", "Count(N);"), 0);
}
