//! Configurations made at random: tasks that wait for intervals, edges or both, perhaps a program without a task.

use proptest::prelude::*;

use super::single::assert_equal;
use crate::rig::MS;

/// One statement of a program, of a kind and with a number.
fn statement((kind, number): (u32, u32)) -> String {
    match kind % 8 {
        0 => format!("t(IN := i, PT := T#{number}ms); q := q XOR t.Q;"),
        1 => "g := NOT g;".to_owned(),
        2 => format!("h := x MOD {} = 0;", number % 4 + 2),
        3 => "q := NOT q;".to_owned(),
        4 => format!("IF x MOD {} = 1 THEN x := x + 2; RETURN; END_IF;", number % 5 + 2),
        5 => "IF q THEN g := h; END_IF;".to_owned(),
        6 => "h := i XOR q;".to_owned(),
        _ => "shared := shared * 31 + x;".to_owned(),
    }
}

type Statements = Vec<(u32, u32)>;

fn program((number, (name, statements)): (usize, (&&str, &Statements))) -> String {
    let body: String = statements.iter().map(|each| format!("    {}\n", statement(*each))).collect();
    format!(
        "PROGRAM {name}\nVAR_OUTPUT q : BOOL; x : DINT; END_VAR\nVAR t : TON; END_VAR\nVAR_EXTERNAL i, g, h : BOOL; \
         END_VAR\n    x := x + 1; shared := shared * 5 + {number};\n{body}END_PROGRAM\n"
    )
}

const SINGLES: [&str; 6] =
    ["", "SINGLE := i, ", "SINGLE := g, ", "SINGLE := h, ", "SINGLE := a.q, ", "SINGLE := d.q, "];

fn task((index, (single, interval, priority)): (usize, &(u32, u32, u32))) -> String {
    let single = SINGLES[*single as usize % SINGLES.len()];
    let intervals = if single.is_empty() { interval % 4 + 1 } else { interval % 4 };
    let interval = if intervals == 0 { String::new() } else { format!("INTERVAL := T#{}ms, ", intervals * 5) };
    format!("TASK t{index} ({single}{interval}PRIORITY := {});\n", priority % 3 + 1)
}

fn project(tasks: &[(u32, u32, u32)], statements: &[Statements], has_background: bool) -> String {
    let programs: String = ["A", "B", "C", "D"].iter().zip(statements).enumerate().map(program).collect();
    let tasks: String = tasks.iter().enumerate().map(task).collect();
    let last = if has_background { "" } else { " WITH base" };
    format!(
        "VAR_GLOBAL shared : LINT; END_VAR\n{programs}CONFIGURATION Cell\nVAR_GLOBAL i, g, h : BOOL; END_VAR\n\
         TASK base (INTERVAL := T#5ms, PRIORITY := 9);\n{tasks}PROGRAM a WITH t0 : A;\nPROGRAM b WITH t1 : B;\n\
         PROGRAM c WITH t2 : C;\nPROGRAM d{last} : D;\nEND_CONFIGURATION\n"
    )
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    #[test]
    fn random_configurations_give_the_same_at_the_same_time(
        tasks in proptest::collection::vec((0..6_u32, 0..4_u32, 0..3_u32), 3),
        statements in proptest::collection::vec(proptest::collection::vec((0..8_u32, 0..40_u32), 0..5), 4),
        has_background in any::<bool>(),
        lengths in proptest::collection::vec(1..8_u64, 20..40),
    ) {
        let times: Vec<u64> = lengths.iter().scan(0, |now, length| { *now += length * 5 * MS; Some(*now) }).collect();
        assert_equal(&project(&tasks, &statements, has_background), &["shared", "g", "h"], &["i"], &times);
    }
}
