//! Where `MatIEC` is known to differ, each with the smallest program that shows it: why the random programs leave it out.
//!
//! By the 2nd edition, the soft PLC is [`Verdict::Right`], or both are allowed ([`Verdict::Open`]).

use onescan_iec::Dialect;

use super::peer_program::PeerProgram;

/// What the 2nd edition says of a difference.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Verdict {
    /// What the soft PLC does is what is written; the peer does something else.
    Right,
    /// It calls it an error, or leaves it to the implementation.
    Open,
}

use Verdict::{Open, Right};

/// A program whose variable `r` differs, first in a certain scan.
pub(super) struct Known {
    /// What differs.
    pub(super) what: &'static str,
    pub(super) verdict: Verdict,
    /// Of the 2nd edition.
    pub(super) clause: &'static str,
    /// The type of `r`.
    ty: &'static str,
    /// Declarations, then a line with `---`, then the body.
    text: &'static str,
    /// The first scan that differs, what `r` is here, and what it is there.
    pub(super) found: &'static str,
}

impl Known {
    pub(super) fn program(&self) -> PeerProgram {
        let (declared, body) = self.text.split_once("---").expect("it has both parts");
        let text = format!("PROGRAM P\nVAR r : {}; {declared} END_VAR\n{body}\nEND_PROGRAM\n", self.ty);
        let outputs = vec![("r".to_owned(), self.ty)];
        PeerProgram { dialect: Dialect::Iec2, family: "known", text, inputs: Vec::new(), outputs, rounded: Vec::new() }
    }

    /// The line of the comparison.
    pub(super) fn line(&self, name: &str) -> String {
        let (scan, values) = self.found.split_once(' ').expect("a scan and two values");
        format!("difference {name}: scan {scan} r:{} {values}", self.ty)
    }
}

const fn known(
    what: &'static str,
    (verdict, clause): (Verdict, &'static str),
    ty: &'static str,
    text: &'static str,
    found: &'static str,
) -> Known {
    Known { what, verdict, clause, ty, text, found }
}

const FOR: (Verdict, &str) = (Open, "3.3.2.4");
const OVERFLOW: (Verdict, &str) = (Open, "2.5.1.5.2");
const STRINGS: (Verdict, &str) = (Open, "2.5.1.5.5");
const CONTROL: (Verdict, &str) = (Right, "2.6.4.5");

pub(super) const KNOWN: &[Known] = &[
    known(
        "FOR with one turn",
        (Right, "3.3.2.4"),
        "INT",
        "k : INT; --- FOR k := 1 TO 1 DO r := r + 1; END_FOR;",
        "1 0001 0000",
    ),
    known(
        "a control variable after its loop",
        FOR,
        "INT",
        "k, n : INT; --- FOR k := 1 TO 3 DO n := n + 1; END_FOR; r := k;",
        "1 0004 0003",
    ),
    known(
        "a last value that the loop changes",
        FOR,
        "INT",
        "k, n : INT := 4; --- r := 0; n := 4; FOR k := 1 TO n DO n := 2; r := r + 1; END_FOR;",
        "1 0004 0002",
    ),
    known(
        "an INT beyond its range inside of an expression",
        OVERFLOW,
        "INT",
        "i : INT := 32767; --- r := (i + 1) / 2;",
        "1 c000 4000",
    ),
    known(
        "a REAL with a literal, which C computes as double",
        (Right, "2.5.1.5.2"),
        "REAL",
        "x : REAL := 0.7; --- r := x * 1.01;",
        "1 3f34fdf3 3f34fdf4",
    ),
    known(
        "a REAL beyond the integer it becomes",
        (Open, "2.5.1.5.1"),
        "INT",
        "x : REAL := 1.0E6; --- r := REAL_TO_INT(x);",
        "1 7fff 4240",
    ),
    known("LIMIT with MN > MX", (Right, "2.5.1.5.4"), "INT", "i : INT := 3; --- r := LIMIT(5, i, 1);", "1 0001 0005"),
    known(
        "a shift by the width",
        (Right, "2.5.1.5.3"),
        "DWORD",
        "w : DWORD := 1; n : INT := 32; --- r := SHL(w, n);",
        "1 00000000 00000001",
    ),
    known("bit strings as BOOL", (Open, "2.5.1.5.1"), "BOOL", "w : DWORD := 2; --- r := DWORD_TO_BOOL(w);", "1 00 01"),
    known(
        "REPLACE",
        (Right, "2.5.1.5.5"),
        "STRING",
        "s : STRING := 'abcde'; --- r := REPLACE(s, 'XY', 1, 2);",
        "1 615859636465 6158636465",
    ),
    known(
        "INSERT behind the end",
        STRINGS,
        "STRING",
        "s : STRING := 'ab'; --- r := INSERT(s, 'c', 5);",
        "1 6162 616263",
    ),
    known(
        "FIND of what begins within a first try",
        (Right, "2.5.1.5.5"),
        "INT",
        "s : STRING := 'aab'; --- r := FIND(s, 'ab');",
        "1 0002 0000",
    ),
    known(
        "the sign of FIND",
        (Right, "2.5.1.5.5"),
        "INT",
        "s : STRING := 'a'; --- CASE FIND(s, 'b') OF -1..1: r := 1; ELSE r := 2; END_CASE;",
        "1 0001 0002",
    ),
    known(
        "T#1ms",
        (Right, "2.2.3.1"),
        "TIME",
        "t : TIME; --- t := T#1ms; r := t;",
        "1 00000000000f4240 00000000000f423f",
    ),
    known(
        "durations as numbers",
        (Open, "2.5.1.5.1"),
        "REAL",
        "t : TIME := T#5s; --- r := TIME_TO_REAL(t);",
        "1 459c4000 40a00000",
    ),
    known(
        "a duration multiplied beyond 2^31 ns",
        (Right, "2.5.1.5.6"),
        "TIME",
        "t : TIME := T#500ms; n : INT := 6; --- r := t * n;",
        "1 00000000b2d05e00 ffffffff80000000",
    ),
    known(
        "durations that add up to a second exactly",
        (Right, "2.5.1.5.6"),
        "BOOL",
        "t : TIME := T#990ms; --- r := t + T#10ms < T#1s;",
        "1 00 01",
    ),
    known(
        "a date after 2038",
        (Right, "2.2.3.2"),
        "DT",
        "d : DT := DT#2050-01-01-00:00:00; --- r := d;",
        "1 230935999d1c0000 e76e6b999d1c0000",
    ),
    known(
        "a day before 1970",
        (Open, "2.2.3.2"),
        "DATE",
        "d : DT := DT#1970-01-01-00:00:00; --- r := DATE_AND_TIME_TO_DATE(d - T#100ms);",
        "1 ffffb16b6eb10000 0000000000000000",
    ),
    known(
        "CTU beyond PV",
        (Right, "2.5.2.3.3"),
        "INT",
        "b : BOOL; c : CTU; --- b := NOT b; c(CU := b, PV := 1); r := c.CV;",
        "3 0002 0001",
    ),
    known(
        "CTD below 0",
        (Right, "2.5.2.3.3"),
        "INT",
        "b : BOOL; c : CTD; --- b := NOT b; c(CD := b, PV := 1); r := c.CV;",
        "1 ffff 0000",
    ),
    known(
        "TON with PT of 0",
        (Right, "2.5.2.3.4"),
        "BOOL",
        "t : TON; --- t(IN := TRUE, PT := T#0s); r := t.Q;",
        "1 01 00",
    ),
    known(
        "a transition in the first scan",
        (Open, "2.6.5"),
        "BOOL",
        "x : BOOL; ---
INITIAL_STEP s0: END_STEP
STEP s1: r(N); END_STEP
TRANSITION FROM s0 TO s1 := TRUE; END_TRANSITION",
        "1 00 01",
    ),
    known(
        "two transitions of a step that are cleared at once",
        (Right, "2.6.5"),
        "BOOL",
        "go : BOOL; x : INT; ---
INITIAL_STEP s0: a(N); END_STEP
STEP s1: END_STEP
STEP s2: r(N); END_STEP
TRANSITION FROM s0 TO s1 := x >= 1; END_TRANSITION
TRANSITION FROM s0 TO s2 := x >= 1; END_TRANSITION
ACTION a: x := x + 1; END_ACTION",
        "2 00 01",
    ),
    known(
        "an action that two steps use, one after the other",
        CONTROL,
        "BOOL",
        "x : INT; ---
INITIAL_STEP s0: a(N); END_STEP
STEP s1: r(N); END_STEP
STEP s2: r(N); END_STEP
TRANSITION FROM s0 TO s2 := x >= 1; END_TRANSITION
TRANSITION FROM s2 TO s1 := TRUE; END_TRANSITION
ACTION a: x := x + 1; END_ACTION",
        "3 01 00",
    ),
    known(
        "a pulse of the initial step",
        CONTROL,
        "BOOL",
        "x : INT; ---
INITIAL_STEP s0: r(P); END_STEP
STEP s1: END_STEP
TRANSITION FROM s0 TO s1 := x > 1; END_TRANSITION",
        "1 01 00",
    ),
    known(
        "P1 of a BOOL",
        CONTROL,
        "BOOL",
        "x : INT; ---
INITIAL_STEP s0: a(N); END_STEP
STEP s1: r(P1); END_STEP
TRANSITION FROM s0 TO s1 := x >= 1; END_TRANSITION
ACTION a: x := x + 1; END_ACTION",
        "2 00 01",
    ),
    known(
        "the order of actions in a scan",
        (Open, "2.6.4.5"),
        "INT",
        "x : INT; ---
INITIAL_STEP s0: a(N); END_STEP
STEP s1: b(N); c(P1); END_STEP
TRANSITION FROM s0 TO s1 := x >= 1; END_TRANSITION
ACTION a: x := x + 1; END_ACTION
ACTION b: IF s1.X THEN r := r * 2 + 1; END_IF; END_ACTION
ACTION c: r := r * 2; END_ACTION",
        "2 0001 0002",
    ),
    known(
        "the final scan",
        (Open, "2.6.4.5"),
        "INT",
        "x : INT; ---
INITIAL_STEP s0: a(N); END_STEP
STEP s1: END_STEP
TRANSITION FROM s0 TO s1 := x >= 1; END_TRANSITION
ACTION a: x := x + 1; r := r + 1; END_ACTION",
        "2 0002 0001",
    ),
    known(
        "SL of a step that is active again",
        CONTROL,
        "BOOL",
        "x : INT; ---
INITIAL_STEP s0: a(N); END_STEP
STEP s1: r(SL, T#10ms); END_STEP
TRANSITION FROM s0 TO s1 := x >= 1; END_TRANSITION
TRANSITION FROM s1 TO s0 := s1.T >= T#20ms; END_TRANSITION
ACTION a: x := x + 1; END_ACTION",
        "5 00 01",
    ),
    known(
        "DS with a time of 0",
        CONTROL,
        "BOOL",
        "x : INT; ---
INITIAL_STEP s0: a(N); END_STEP
STEP s1: r(DS, T#0ms); END_STEP
TRANSITION FROM s0 TO s1 := x >= 1; END_TRANSITION
ACTION a: x := x + 1; END_ACTION",
        "2 01 00",
    ),
    known(
        "DS of a step that is left when its time is over",
        CONTROL,
        "BOOL",
        "x : INT; ---
INITIAL_STEP s0: a(N); END_STEP
STEP s1: r(DS, T#10ms); END_STEP
STEP s2: END_STEP
TRANSITION FROM s0 TO s1 := x >= 1; END_TRANSITION
TRANSITION FROM s1 TO s2 := s1.T >= T#10ms; END_TRANSITION
ACTION a: x := x + 1; END_ACTION",
        "3 00 01",
    ),
    known(
        "SD of a step that is active again before its time is over",
        CONTROL,
        "BOOL",
        "x : INT; ---
INITIAL_STEP s0: a(N); END_STEP
STEP s1: r(SD, T#50ms); END_STEP
TRANSITION FROM s0 TO s1 := x >= 1; END_TRANSITION
TRANSITION FROM s1 TO s0 := TRUE; END_TRANSITION
ACTION a: x := x + 1; END_ACTION",
        "7 01 00",
    ),
];
