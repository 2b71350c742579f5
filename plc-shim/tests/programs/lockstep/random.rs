//! Programs made at random of timers, counters, branches and RETURN, at random times.

use proptest::prelude::*;

use super::driver::Tasks;
use super::equivalence::assert_equal;
use super::ported;
use crate::rig::{MS, task};

/// One statement of program `Main`, with instance and number `n`.
fn statement(kind: u32, n: usize, ms: u32) -> String {
    match kind % 10 {
        0 => format!("t{n}(IN := i, PT := T#{ms}ms, ET => e); q := q XOR t{n}.Q;"),
        1 => format!("o{n}(IN := j, PT := T#{ms}ms, ET => e); q := o{n}.Q;"),
        2 => format!("p{n}(IN := i XOR j, PT := T#{ms}ms, ET => e); x := x + BOOL_TO_DINT(p{n}.Q);"),
        3 => format!("c{n}(CU := q, R := c{n}.Q, PV := {}); x := x * 3 + INT_TO_DINT(c{n}.CV);", ms % 5),
        4 => format!("IF q THEN x := x + {ms}; END_IF;"),
        5 => format!("IF x MOD {} = 1 THEN x := x + 1; RETURN; END_IF;", ms + 2),
        6 => format!("t{n}(IN := NOT t{n}.Q, PT := T#{ms}ms); IF t{n}.Q THEN x := x + 1; END_IF;"),
        7 => format!("FOR k := 1 TO {} DO IF k = x THEN EXIT; END_IF; x := x + k; END_FOR;", ms % 7),
        8 => "shared := shared * 31 + x; x := shared MOD 1000;".to_owned(),
        _ => format!("CASE x MOD 4 OF 0: x := x + {ms}; 1, 2: q := NOT q; ELSE RETURN; END_CASE;"),
    }
}

pub(crate) fn program(name: &str, statements: &[(u32, u32)]) -> String {
    let count = statements.len();
    let instances: String = (0..count).map(|n| format!("t{n} : TON; o{n} : TOF; p{n} : TP; c{n} : CTU; ")).collect();
    let body: String =
        statements.iter().enumerate().map(|(n, (kind, ms))| format!("    {}\n", statement(*kind, n, *ms))).collect();
    format!(
        "PROGRAM {name}\nVAR_INPUT i, j : BOOL; END_VAR\nVAR_OUTPUT q : BOOL; x : DINT; e : TIME; END_VAR\n\
         VAR k : DINT; {instances}END_VAR\n{body}END_PROGRAM\n"
    )
}

type Statements = Vec<(u32, u32)>;

/// Programs `First` and `Second` with a variable in common.
pub(crate) fn two_programs(first: &[(u32, u32)], second: &[(u32, u32)]) -> String {
    let globals = "VAR_GLOBAL shared : DINT; END_VAR\n";
    format!("{globals}{}{}", program("First", first), program("Second", second))
}

pub(crate) fn statements() -> impl Strategy<Value = Statements> {
    proptest::collection::vec((0..10_u32, 0..40_u32), 0..8)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    #[test]
    fn random_programs_give_the_same_at_the_same_time(
        first in statements(),
        second in statements(),
        (slow, fast) in (1..5_u64, 1..4_u64),
        priorities in (0..3_u32, 0..3_u32),
        lengths in proptest::collection::vec(1..30_000_000_u64, 20..40),
    ) {
        let text = two_programs(&first, &second);
        let tasks = [
            task("slow", slow * 5, priorities.0, &["First"]),
            task("fast", fast * 3, priorities.1, &["Second"]),
        ];
        let times: Vec<u64> = lengths.iter().scan(0, |now, length| { *now += length; Some(*now) }).collect();
        let inputs = ["First.i", "First.j", "Second.i", "Second.j"];
        for form in [Tasks::Kept, Tasks::Moved] {
            assert_equal("random", &text, &tasks, &inputs, &times, form);
        }
    }

    /// A TIME of CODESYS counts milliseconds.
    #[test]
    fn random_programs_are_the_same_in_plcopen_xml(
        first in statements(),
        second in statements(),
        (slow, fast) in (1..5_u64, 1..4_u64),
        lengths in proptest::collection::vec(1..30_u64, 20..40),
    ) {
        let globals = "VAR_GLOBAL shared : DINT; END_VAR\n";
        let text = format!("{globals}{}{}", program("First", &first), program("Second", &second));
        let tasks = [task("slow", slow * 5, 1, &["First"]), task("fast", fast * 3, 0, &["Second"])];
        let times: Vec<u64> = lengths.iter().scan(0, |now, length| { *now += length * MS; Some(*now) }).collect();
        let inputs = ["First.i", "First.j", "Second.i", "Second.j"];
        let same = ported::assert_equal(&text, &tasks, &inputs, &times, Tasks::Moved);
        prop_assert_eq!(same, Ok(()));
    }
}
