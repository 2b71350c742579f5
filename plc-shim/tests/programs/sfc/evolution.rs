//! Steps and transitions (2nd ed. 2.6.2, 2.6.3 and 2.6.5; 3rd ed. 6.7.2, 6.7.3 and 6.7.6).

use crate::rig::{MS, Rig};

/// The names of the active steps after each of `scans` scans; `before` sets inputs.
fn active(text: &str, steps: &[&str], scans: u64, mut before: impl FnMut(u64, &mut Rig)) -> Vec<String> {
    let mut rig = Rig::new(text);
    let mut seen = Vec::new();
    for scan in 1..=scans {
        before(scan, &mut rig);
        rig.scan().expect("no fault");
        let now: Vec<&str> = steps.iter().copied().filter(|step| rig.bool(&format!("P.{step}.X"))).collect();
        seen.push(now.join("+"));
    }
    seen
}

#[test]
fn iec2_2_6_5_one_evolution_in_a_scan() {
    let text = "PROGRAM P VAR go : BOOL := TRUE; END_VAR
        INITIAL_STEP a: END_STEP
        STEP b: END_STEP
        STEP c: END_STEP
        TRANSITION FROM a TO b := go; END_TRANSITION
        TRANSITION FROM b TO c := go; END_TRANSITION
        TRANSITION FROM c TO a := go; END_TRANSITION
        END_PROGRAM";
    assert_eq!(active(text, &["a", "b", "c"], 5, |_, _| {}), ["a", "b", "c", "a", "b"]);
}

#[test]
fn iec2_2_6_2_t_holds_after_the_step() {
    let text = "PROGRAM P
        INITIAL_STEP a: END_STEP
        STEP b: END_STEP
        TRANSITION FROM a TO b := a.T >= T#30ms; END_TRANSITION
        TRANSITION FROM b TO a := b.T >= T#20ms; END_TRANSITION
        END_PROGRAM";
    let mut rig = Rig::new(text);
    let mut seen = Vec::new();
    for _ in 0..8 {
        rig.scan().expect("no fault");
        let time = |step: &str| rig.int(&format!("P.{step}.T")) / MS as i64;
        seen.push((rig.bool("P.a.X"), time("a"), rig.bool("P.b.X"), time("b")));
    }
    assert_eq!(
        seen,
        [
            (true, 0, false, 0),
            (true, 10, false, 0),
            (true, 20, false, 0),
            (false, 30, true, 0),
            (false, 30, true, 10),
            (true, 0, false, 20),
            (true, 10, false, 20),
            (true, 20, false, 20),
        ]
    );
}
