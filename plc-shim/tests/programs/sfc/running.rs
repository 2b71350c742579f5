//! Charts in a PLC: faults, coverage, restarts, instances, calls of actions.

use std::fmt::Write as _;

use onescan_iec::input::kind::SourceKind;
use onescan_iec::{Dialect, Input, TimeSpan, VirtualTime};
use onescan_iec_run::{Application, SoftPlc};

use crate::rig::{MS, Rig};

#[test]
fn a_fault_names_step_action_and_transition() {
    let text = "PROGRAM P
VAR n, one, zero : INT; END_VAR
    INITIAL_STEP Idle: END_STEP
    STEP Work: Divide(N); END_STEP
    TRANSITION begin FROM Idle TO Work := 1 / one = 1; END_TRANSITION
    TRANSITION FROM Work TO Idle := FALSE; END_TRANSITION
    ACTION Divide: n := 1 / zero; END_ACTION
END_PROGRAM";
    let fault = |one| {
        let mut rig = Rig::new(text);
        rig.set("P.one", one);
        rig.scan().expect("the initial situation is not tested");
        rig.scan().expect_err("a division by zero").to_string()
    };
    insta::assert_snapshot!([fault(0), fault(1)].join("\n"));
}

/// Two steps that follow each other, and P1, P0 of a BOOL: by the letter, and as `MatIEC` does it.
#[test]
fn pulses_are_those_of_the_action_or_of_the_last_step() {
    let text = "PROGRAM P
VAR lamp, left : BOOL; n : INT; END_VAR
    INITIAL_STEP A: END_STEP
    STEP B: Count(P1); lamp(P); END_STEP
    STEP C: Count(P1); lamp(P1); left(P0); END_STEP
    TRANSITION FROM A TO B := TRUE; END_TRANSITION
    TRANSITION FROM B TO C := TRUE; END_TRANSITION
    TRANSITION FROM C TO A := TRUE; END_TRANSITION
    ACTION Count: n := n + 1; END_ACTION
END_PROGRAM";
    let values = |dialect| -> Vec<(bool, bool, i64)> {
        let mut rig = Rig::in_dialect(dialect, text);
        let scan = |_| {
            rig.scan().expect("no fault");
            (rig.bool("P.lamp"), rig.bool("P.left"), rig.int("P.n"))
        };
        (0..5).map(scan).collect()
    };
    let (none, lamp, left) = ((false, false), (true, false), (false, true));
    let counted = |flags: [(bool, bool); 5], counts: [i64; 5]| -> Vec<(bool, bool, i64)> {
        flags.into_iter().zip(counts).map(|((lamp, left), count)| (lamp, left, count)).collect()
    };
    // The steps of the scans: A, B, C, A, B.
    assert_eq!(values(Dialect::Iec3), counted([none, lamp, none, none, lamp], [0, 1, 1, 1, 2]));
    assert_eq!(values(Dialect::Matiec), counted([none, none, lamp, left, none], [0, 0, 1, 1, 1]));
}

#[test]
fn steps_transitions_and_actions_are_covered() {
    let text = "PROGRAM P
VAR go : BOOL; n : INT; END_VAR
    INITIAL_STEP Idle: END_STEP
    STEP Work:
        Count(N);
    END_STEP
    STEP Rest: END_STEP
    TRANSITION FROM Idle TO Work := go; END_TRANSITION
    TRANSITION FROM Work TO Rest := n > 5; END_TRANSITION
    TRANSITION FROM Rest TO Idle := TRUE; END_TRANSITION
    ACTION Count:
        n := n + 1;
    END_ACTION
END_PROGRAM";
    let input = Input::from_text("test.st", SourceKind::Text, text);
    let application = Application::from_inputs_with_coverage([input]).expect("a sound program");
    let mut plc = SoftPlc::new(&application, &application.single_task(TimeSpan::millis::<10>())).expect("a plan");
    let mut report = String::new();
    for (scan, go) in [(1, 0), (2, 0), (3, 1)] {
        let variable = plc.variable("P.go").expect("a variable");
        plc.memory_mut()[variable.offset as usize] = go;
        plc.scan(VirtualTime::from_nanos(scan * 10 * MS)).expect("no fault");
        if scan != 1 {
            let coverage = plc.coverage().expect("points are noted");
            writeln!(report, "after scan {scan}\n{coverage:#?}").expect("a text takes all");
        }
    }
    insta::assert_snapshot!(report);
}

#[test]
fn iec2_2_6_1_each_instance_of_a_block_has_its_own_steps() {
    let text = "FUNCTION_BLOCK Blink
VAR_INPUT period : TIME; END_VAR
VAR_OUTPUT lamp : BOOL; END_VAR
    INITIAL_STEP Off: END_STEP
    STEP On: lamp(N); END_STEP
    TRANSITION FROM Off TO On := Off.T >= period; END_TRANSITION
    TRANSITION FROM On TO Off := On.T >= period; END_TRANSITION
END_FUNCTION_BLOCK
PROGRAM P VAR fast, slow : Blink; all : ARRAY [1..2] OF Blink; i : INT; END_VAR
    fast(period := T#10ms);
    slow(period := T#30ms);
    FOR i := 1 TO 2 DO
        all[i](period := T#20ms * i);
    END_FOR;
END_PROGRAM";
    let mut rig = Rig::new(text);
    let mut seen = Vec::new();
    for _ in 0..8 {
        rig.scan().expect("no fault");
        let level = |path: &str| if rig.bool(path) { '#' } else { '.' };
        seen.push(["P.fast.lamp", "P.slow.lamp", "P.all[1].lamp", "P.all[2].On.X"].map(level));
    }
    let row = |at: usize| seen.iter().map(|scan| scan[at]).collect::<String>();
    assert_eq!([row(0), row(1), row(2), row(3)], [".#.#.#.#", "...###..", "..##..##", "....####"]);
}

#[test]
fn actions_of_a_chart_are_called_by_name_and_overridden() {
    let text = "FUNCTION_BLOCK Base
VAR_OUTPUT n, called : INT; END_VAR
    INITIAL_STEP A: Act(N); Twice(N); END_STEP
    ACTION Act: n := n + 1; END_ACTION
    ACTION Twice: Act(); called := called + 1; END_ACTION
END_FUNCTION_BLOCK
FUNCTION_BLOCK Derived EXTENDS Base
    SUPER();
END_FUNCTION_BLOCK
PROGRAM P VAR b : Base; d : Derived; END_VAR
    b();
    d();
END_PROGRAM";
    let mut rig = Rig::new(text);
    rig.scan().expect("no fault");
    assert_eq!((rig.int("P.b.n"), rig.int("P.b.called"), rig.int("P.d.n")), (2, 1, 2));
}

/// 2nd ed. Table 42, feature 4.
#[test]
fn iec2_2_6_4_1_a_chart_in_an_action_goes_on_when_the_action_runs() {
    let text = "PROGRAM P VAR go : BOOL; n, m : INT; END_VAR
        ACTION Run:
            INITIAL_STEP A: Count(P1); END_STEP
            STEP B: Deeper(N); END_STEP
            TRANSITION FROM A TO B := A.T >= T#20ms; END_TRANSITION
            TRANSITION FROM B TO A := D.X; END_TRANSITION
        END_ACTION
        ACTION Count: n := n + 1; END_ACTION
        ACTION Deeper:
            INITIAL_STEP C: END_STEP
            STEP D: More(N); END_STEP
            TRANSITION FROM C TO D := TRUE; END_TRANSITION
            TRANSITION FROM D TO C := TRUE; END_TRANSITION
        END_ACTION
        ACTION More: m := m + 1; END_ACTION
        IF go THEN Run(); END_IF;
        END_PROGRAM";
    let mut rig = Rig::new(text);
    let mut seen = Vec::new();
    for go in [1, 0, 1, 1, 1, 1, 0, 1] {
        rig.set("P.go", go);
        rig.scan().expect("no fault");
        let active: String = ["A", "B", "C", "D"].into_iter().filter(|step| rig.bool(&format!("P.{step}.X"))).collect();
        seen.push(format!("{active}{}{}", rig.int("P.n"), rig.int("P.m")));
    }
    // Where a chart stands still its steps keep what they are, and time goes on. The final scan of `Deeper` is one
    // more evolution of its chart, and has that of `More`.
    assert_eq!(seen.join(" "), "AC10 AC10 BC10 BD11 AC22 AC22 AC22 BD23");
}

#[test]
fn a_saved_state_goes_on_where_it_was() {
    let text = "PROGRAM P VAR valve : BOOL; END_VAR
        INITIAL_STEP A: valve(SD, T#30ms); END_STEP
        STEP B: valve(R); END_STEP
        TRANSITION FROM A TO B := A.T >= T#60ms; END_TRANSITION
        TRANSITION FROM B TO A := TRUE; END_TRANSITION
        END_PROGRAM";
    let trace = |rig: &mut Rig| {
        let mut seen = String::new();
        for _ in 0..8 {
            rig.scan().expect("no fault");
            seen.push(if rig.bool("P.valve") { '#' } else { '.' });
        }
        seen
    };
    let mut rig = Rig::new(text);
    rig.scan().expect("no fault");
    let (state, now_ns) = (rig.plc.save(), rig.now_ns);
    let first = trace(&mut rig);
    assert_eq!(first, "..###...");
    rig.plc.restore(&state).expect("its own state");
    rig.now_ns = now_ns;
    assert_eq!(trace(&mut rig), first);
}

#[test]
fn instances_of_the_unit_are_called_in_its_actions() {
    let text = "PROGRAM P VAR timer : TON; n : CTU; END_VAR
        INITIAL_STEP A: Act(N); END_STEP
        ACTION Act: timer(IN := TRUE, PT := T#20ms); n(CU := timer.Q, PV := 3); END_ACTION
        END_PROGRAM";
    let mut rig = Rig::new(text);
    for _ in 0..3 {
        rig.scan().expect("no fault");
    }
    assert_eq!((rig.bool("P.timer.Q"), rig.int("P.n.CV")), (true, 1));
}
