//! Index checks are left out where the compiler knows the index's range: never where it could fail.

use crate::rig::Rig;

const LENGTH: i64 = 8;

/// What a scan comes to: the variables, or a fault.
type Outcome = Option<(i64, i64)>;

fn run(text: &str) -> Outcome {
    let mut rig = Rig::new(text);
    match rig.scan() {
        Ok(()) => Some((rig.int("P.j"), rig.int("P.sum"))),
        Err(fault) => {
            assert!(fault.to_string().starts_with("array index out of range"), "{text}\n{fault}");
            None
        }
    }
}

fn inside(index: i64) -> Option<i64> {
    (0..LENGTH).contains(&index).then_some(index)
}

/// A loop that counts `j` from `start` by `step` as long as the comparison with `limit` holds.
fn counted(start: i64, (operator, limit): (&str, i64), step: i64, offset: i64) -> (String, Outcome) {
    let sign = if step < 0 { '-' } else { '+' };
    let text = format!(
        "PROGRAM P
VAR j, sum : DINT; a : ARRAY [0..7] OF DINT := [0, 1, 2, 3, 4, 5, 6, 7]; END_VAR
    j := {start};
    WHILE j {operator} {limit} DO
        IF sum > 20 THEN EXIT; END_IF;
        sum := sum + a[j + {offset}] + 1;
        j := j {sign} {};
        IF a[j + {offset}] = 5 THEN CONTINUE; END_IF;
        sum := sum + 1;
    END_WHILE;
    sum := sum + a[j];
END_PROGRAM",
        step.abs()
    );
    let direct = || {
        let (mut j, mut sum) = (start, 0);
        while if operator == ">=" { j >= limit } else { j < limit } {
            if sum > 20 {
                break;
            }
            sum += inside(j + offset)? + 1;
            j += step;
            if inside(j + offset)? != 5 {
                sum += 1;
            }
        }
        Some((j, sum + inside(j)?))
    };
    (text, direct())
}

#[test]
fn loops_that_count_fail_where_their_indices_do() {
    let mut faults = 0;
    for start in [-1, 0, 3, 7, 8] {
        for offset in [-1, 0, 1] {
            for (condition, step) in
                [((">=", 0), -1), ((">=", 1), -1), ((">=", -1), -1), ((">=", 2), -3), (("<", 7), 1), (("<", 8), 2)]
            {
                let (text, expected) = counted(start, condition, step, offset);
                assert_eq!(run(&text), expected, "{text}");
                faults += u32::from(expected.is_none());
            }
        }
    }
    assert!((20..80).contains(&faults), "both ways are tried: {faults}");
}

#[test]
fn conditions_say_what_holds_on_both_of_their_ways() {
    type Holds = fn(&i64, &i64) -> bool;
    let operators: [(&str, Holds); 6] =
        [("<", i64::lt), ("<=", i64::le), (">", i64::gt), (">=", i64::ge), ("=", i64::eq), ("<>", i64::ne)];
    for (operator, holds) in operators {
        for limit in [-1, 0, 4, 7, 8] {
            for j in [-1, 0, 7, 8] {
                // The variable is set where the compiler cannot see to what.
                let text = format!(
                    "FUNCTION Given : DINT VAR_INPUT x : DINT; END_VAR Given := x; END_FUNCTION
PROGRAM P
VAR j, sum, k : DINT; a : ARRAY [0..7] OF DINT := [0, 1, 2, 3, 4, 5, 6, 7]; END_VAR
    k := {j};
    j := SEL(k > 100, Given(k), 3);
    IF j {operator} {limit} AND j < 8 THEN
        sum := a[j];
    ELSIF NOT (j < 0 OR j > 7) THEN
        sum := 10 + a[j];
    ELSE
        sum := 20 + a[k];
    END_IF;
END_PROGRAM"
                );
                let direct = || {
                    let first = holds(&j, &limit) && j < 8;
                    let second = (0..8).contains(&j);
                    Some((
                        j,
                        if first {
                            inside(j)?
                        } else if second {
                            10 + j
                        } else {
                            20 + inside(j)?
                        },
                    ))
                };
                assert_eq!(run(&text), direct(), "{text}");
            }
        }
    }
}

#[test]
fn a_range_ends_where_its_variable_is_set_elsewhere() {
    let text = |inside: &str| {
        format!(
            "FUNCTION Sets : DINT VAR_IN_OUT x : DINT; END_VAR x := 9; Sets := 0; END_FUNCTION
FUNCTION_BLOCK Setter VAR_OUTPUT out : DINT := 9; END_VAR END_FUNCTION_BLOCK
PROGRAM P
VAR j, sum, n : DINT; s : Setter; a, b : ARRAY [0..7] OF DINT; END_VAR
    j := 3;
    IF j >= 0 AND j < 8 THEN
        {inside}
        sum := a[j];
    END_IF;
END_PROGRAM"
        )
    };
    for inside in ["n := Sets(j);", "s(out => j);", "FOR j := 0 TO 7 DO n := n + 1; END_FOR;", "j := n + 9;"] {
        assert_eq!(run(&text(inside)), None, "{inside}");
    }
    assert_eq!(run(&text("n := 9;")), Some((3, 0)));
    // What an index changes itself is not known of it before.
    let own = "FUNCTION Sets : DINT VAR_IN_OUT x : DINT; END_VAR x := 9; Sets := 0; END_FUNCTION
PROGRAM P VAR j, sum : DINT; a : ARRAY [0..7] OF DINT; END_VAR
    j := 3;
    sum := a[Sets(j) MOD 2 + j];
END_PROGRAM";
    assert_eq!(run(own), None);
}
