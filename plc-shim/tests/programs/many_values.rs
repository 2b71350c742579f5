//! Loops over more variables than registers are kept for: a turn sees what the one before left.

use std::fmt::Write;

use crate::rig::Rig;

/// More than are remembered at once, and than are kept before some are given up.
const MANY: usize = 80;

/// A loop that reads `same`, which nothing changes, then an inner loop and many others.
fn program(head: &str, end: &str) -> String {
    let names: Vec<String> = (0..MANY).map(|number| format!("x{number}")).collect();
    let mut body = String::new();
    for name in &names {
        writeln!(body, "other := {name};").expect("a string takes all");
    }
    // Those that are read most often stay in registers as long as the loop runs; `same` is none of them.
    for name in &names[..12] {
        writeln!(body, "other := {name} + {name} * {name};").expect("a string takes all");
    }
    format!(
        "PROGRAM P
VAR same : LINT := 17; {}, other, seen : LINT; k, turns, n, wrong : INT; END_VAR
    turns := turns + 3; k := 0; seen := same;
    {head}
        IF same <> 17 THEN wrong := wrong + 1; END_IF;
        n := 0; WHILE n < 1 DO n := n + 1; END_WHILE;
        {body}
    {end}
END_PROGRAM",
        names.join(", ")
    )
}

#[test]
fn what_is_read_in_every_turn_is_what_is_there() {
    for (head, end) in [
        ("FOR k := 1 TO turns DO", "END_FOR;"),
        ("WHILE k < turns DO k := k + 1;", "END_WHILE;"),
        ("REPEAT k := k + 1;", "UNTIL k >= turns END_REPEAT;"),
    ] {
        let mut rig = Rig::new(&program(head, end));
        for _ in 0..2 {
            rig.scan().expect("no fault");
        }
        assert_eq!(rig.int("P.wrong"), 0, "{head}");
    }
}
