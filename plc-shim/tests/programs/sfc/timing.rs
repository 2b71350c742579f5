//! Timing diagrams of charts: each action qualifier, step flags and times, divergences; one column per scan of 10 ms.

use crate::diagram::diagram;
use crate::rig::Rig;

/// Presses of two buttons: a short activation, a long one, a reset while it is active elsewhere, one more.
const GO: &str = "..##...########.....#######....";
const STOP: &str = "..................##.......#...";

/// A step `Work` that is active while `go` is TRUE, with a Boolean action and one with statements, both with this
/// qualifier; `Clear` resets them.
fn qualifier(qualifier: &str, time: &str, idle: &str) -> String {
    let time = if time.is_empty() { String::new() } else { format!(", {time}") };
    let text = format!(
        "PROGRAM P
VAR go, stop, action : BOOL; runs, finals : INT; END_VAR
    INITIAL_STEP Idle: {idle} END_STEP
    STEP Work: action({qualifier}{time}); Body({qualifier}{time}); END_STEP
    STEP Clear: action(R); Body(R); END_STEP
    TRANSITION FROM Idle TO Work := go; END_TRANSITION
    TRANSITION FROM Work TO Idle := NOT go; END_TRANSITION
    TRANSITION FROM Idle TO Clear := stop; END_TRANSITION
    TRANSITION FROM Clear TO Idle := NOT stop; END_TRANSITION
    ACTION Body:
        runs := runs + 1;
        IF NOT Body.Q THEN finals := finals + 1; END_IF;
    END_ACTION
END_PROGRAM"
    );
    let outputs = ["Work.X", "Clear.X", "action", "Body.Q", "runs", "finals"];
    diagram(&mut Rig::new(&text), "P", &[("go", GO), ("stop", STOP)], &outputs)
}

/// 2nd ed. Table 45, 3rd ed. Table 57. `runs` counts how often the statements ran, `finals` how often without their flag:
/// the final scan, and what P1 and P0 run once.
#[test]
fn iec2_2_6_4_4_every_qualifier() {
    for (name, time) in [
        ("N", ""),
        ("S", ""),
        ("L", "T#30ms"),
        ("D", "T#30ms"),
        ("P", ""),
        ("P0", ""),
        ("P1", ""),
        ("SD", "T#30ms"),
        ("DS", "T#30ms"),
        ("SL", "T#30ms"),
    ] {
        insta::assert_snapshot!(name, qualifier(name, time, ""));
    }
    insta::assert_snapshot!("R", qualifier("R", "", "action(S); Body(S);"));
}

/// 2nd ed. 2.6.2: `X` is the step's flag, `T` the time since it was activated, which it keeps when it is left.
#[test]
fn iec2_2_6_2_flags_and_times_of_steps() {
    let text = "PROGRAM P
VAR go : BOOL; END_VAR
    INITIAL_STEP a: END_STEP
    STEP b: END_STEP
    TRANSITION FROM a TO b := go; END_TRANSITION
    TRANSITION FROM b TO a := b.T >= T#30ms AND NOT go; END_TRANSITION
END_PROGRAM";
    let outputs = ["a.X", "a.T", "b.X", "b.T"];
    insta::assert_snapshot!(diagram(&mut Rig::new(text), "P", &[("go", "..#......######..#..")], &outputs));
}

/// 2nd ed. 2.6.5, Table 46.2: where two conditions are TRUE at once the priority decides, or the order.
#[test]
fn iec2_2_6_5_sequence_selection() {
    let text = "PROGRAM P
VAR l, r, back : BOOL; END_VAR
    INITIAL_STEP top: END_STEP
    STEP left: END_STEP
    STEP right: END_STEP
    TRANSITION (PRIORITY := 2) FROM top TO left := l; END_TRANSITION
    TRANSITION (PRIORITY := 1) FROM top TO right := r; END_TRANSITION
    TRANSITION FROM left TO top := back; END_TRANSITION
    TRANSITION FROM right TO top := back; END_TRANSITION
END_PROGRAM";
    let inputs = [("l", ".##..##.."), ("r", "....###.."), ("back", "..#.....#")];
    insta::assert_snapshot!(diagram(&mut Rig::new(text), "P", &inputs, &["top.X", "left.X", "right.X"]));
}

/// 2nd ed. 2.6.5, Table 46.4: both begin at once; they end at once, when both have come to their last step.
#[test]
fn iec2_2_6_5_simultaneous_sequences() {
    let text = "PROGRAM P
VAR go, l, r : BOOL; END_VAR
    INITIAL_STEP top: END_STEP
    STEP left: END_STEP
    STEP left_end: END_STEP
    STEP right: END_STEP
    STEP right_end: END_STEP
    TRANSITION FROM top TO (left, right) := go; END_TRANSITION
    TRANSITION FROM left TO left_end := l; END_TRANSITION
    TRANSITION FROM right TO right_end := r; END_TRANSITION
    TRANSITION FROM (left_end, right_end) TO top := TRUE; END_TRANSITION
END_PROGRAM";
    let inputs = [("go", ".#.....#.."), ("l", "...#....#."), ("r", ".....#..#.")];
    let outputs = ["top.X", "left.X", "left_end.X", "right.X", "right_end.X"];
    insta::assert_snapshot!(diagram(&mut Rig::new(text), "P", &inputs, &outputs));
}
