//! Programs for lockstep, with their tasks.

use onescan_iec::Task;

use crate::rig::task;

pub(crate) struct Case {
    pub(crate) name: &'static str,
    pub(crate) text: &'static str,
    pub(crate) tasks: Vec<Task>,
    /// Inputs: the BOOLs of these paths change in a pattern.
    pub(crate) inputs: &'static [&'static str],
}

const TIMERS: &str = "
FUNCTION_BLOCK Blinker
VAR_INPUT run : BOOL; END_VAR
VAR_OUTPUT lamp : BOOL; END_VAR
VAR on : TON := (PT := T#30ms); off : ARRAY [1..2] OF TON_TIME; END_VAR
    on(IN := run AND NOT off[2].Q);
    off[2](IN := on.Q, PT := T#20ms);
    lamp := on.Q;
END_FUNCTION_BLOCK
TYPE Pair : STRUCT a : TOF; b : TP; n : INT; END_STRUCT END_TYPE
PROGRAM Main
VAR_INPUT i, j : BOOL; END_VAR
VAR_OUTPUT q, r, s, lamp : BOOL; et, eu, ev : TIME; el : LTIME; n : DINT; cdt : DT; END_VAR
VAR pair : Pair; t : TON; long : TP_LTIME; b : Blinker; clock : RTC; END_VAR
    t(IN := i, PT := T#20ms, Q => q, ET => et);
    pair.a(IN := i, PT := T#25ms); r := pair.a.Q; eu := pair.a.ET;
    pair.b(IN := j, PT := T#30ms); s := pair.b.Q; ev := pair.b.ET;
    long(IN := i XOR j, PT := LT#12ms, ET => el);
    b(run := TRUE); lamp := b.lamp;
    clock(IN := TRUE, PDT := DT#2012-01-15-10:00:00); cdt := clock.CDT;
    IF t.Q THEN n := n + 1; END_IF;
END_PROGRAM";

const TASKS: &str = "
VAR_GLOBAL trace : LINT; END_VAR
PROGRAM Slow VAR_OUTPUT n : INT; t : LINT; END_VAR VAR e : TON; END_VAR
    n := n + 1; trace := trace * 7 + 1; t := trace; e(IN := NOT e.Q, PT := T#35ms); IF e.Q THEN n := n + 100; END_IF;
END_PROGRAM
PROGRAM Fast VAR_OUTPUT n : INT; t : LINT; END_VAR n := n + 1; trace := trace * 7 + 2; t := trace; END_PROGRAM
PROGRAM Also VAR_OUTPUT n : INT; t : LINT; END_VAR n := n + 1; trace := trace * 7 + 3; t := trace; END_PROGRAM
PROGRAM Urgent VAR_OUTPUT n : INT; t : LINT; END_VAR n := n + 1; trace := trace * 7 + 4; t := trace; END_PROGRAM";

const RETURNS: &str = "
PROGRAM Main VAR_INPUT i : BOOL; END_VAR VAR_OUTPUT n, m, k : INT; END_VAR VAR x : INT; END_VAR
    n := n + 1;
    IF i THEN RETURN; END_IF;
    FOR x := 1 TO 10 DO
        CASE x OF
            3: m := m + 1;
            5: IF n > 4 THEN RETURN; END_IF;
        ELSE k := k + 1;
        END_CASE;
    END_FOR;
    m := m + 100; // the end
END_PROGRAM
PROGRAM Empty END_PROGRAM
PROGRAM Blank VAR x : INT; END_VAR ; (* nothing *) END_PROGRAM
PROGRAM Behind VAR_OUTPUT n : INT; END_VAR n := n + 1; RETURN; END_PROGRAM";

const COUNTERS: &str = "
PROGRAM Main VAR_INPUT i, j : BOOL; END_VAR VAR_OUTPUT cv : INT; qu, qd, e : BOOL; END_VAR
VAR c : CTUD; up : CTU; r : R_TRIG; f : F_TRIG; END_VAR
    c(CU := i, CD := j, R := FALSE, LD := FALSE, PV := 3, QU => qu, QD => qd, CV => cv);
    up(CU := i, R := up.Q, PV := 2);
    r(CLK := i); f(CLK := j); e := r.Q OR f.Q OR up.Q;
END_PROGRAM";

const CHART: &str = "
FUNCTION_BLOCK Blink
VAR_INPUT run : BOOL; END_VAR
VAR_OUTPUT lamp, late : BOOL; n : INT; END_VAR
    INITIAL_STEP Off: END_STEP
    STEP On: lamp(N); late(D, T#10ms); Count(P1); END_STEP
    TRANSITION FROM Off TO On := run AND Off.T >= T#15ms; END_TRANSITION
    TRANSITION FROM On TO Off := On.T >= T#20ms; END_TRANSITION
    ACTION Count: n := n + 1; END_ACTION
END_FUNCTION_BLOCK
PROGRAM Main
VAR_INPUT i, j : BOOL; END_VAR
VAR_OUTPUT n, l, d, p, s, sd, ds, sl, lamp, late : BOOL; runs, ends, pulses, leaves, blinks : INT; t : TIME; END_VAR
VAR blink : Blink; delay : TIME := T#25ms; timer : TON; END_VAR
    INITIAL_STEP Idle: Lamps(N); s(R); sd(R); ds(R); sl(R); END_STEP
    STEP A: n(N); l(L, T#20ms); d(D, delay); p(P); Work(N); Lamps(N);
        s(S); Pulse(P1); Leave(P0);
    END_STEP
    STEP B: sd(SD, T#20ms); ds(DS, A.T + T#10ms); sl(SL, T#30ms); (* times *) END_STEP
    STEP C: END_STEP
    TRANSITION FROM Idle TO (A, B) := i AND NOT j; END_TRANSITION
    TRANSITION (PRIORITY := 1) FROM A TO C := A.T >= T#40ms OR j; END_TRANSITION
    TRANSITION both FROM (C, B) TO Idle : both := B.T > T#50ms AND NOT i; END_TRANSITION
    ACTION Work:
        runs := runs + 1;
        IF NOT Work.Q THEN ends := ends + 1; RETURN; END_IF;
        t := A.T;
    END_ACTION
    ACTION Pulse: pulses := pulses + 1; END_ACTION
    ACTION Leave: leaves := leaves + 1; END_ACTION
    ACTION Lamps:
        blink(run := Lamps.Q, lamp => lamp, late => late); blinks := blink.n;
        timer(IN := i, PT := T#10ms);
    END_ACTION
END_PROGRAM";

const MOTION: &str = "
FUNCTION_BLOCK Station
VAR_IN_OUT Axis : AXIS_REF; END_VAR
VAR_INPUT far : LREAL; go : BOOL; END_VAR
VAR_OUTPUT there : BOOL; END_VAR
VAR move : ARRAY [1..2] OF MC_MoveAbsolute := [2((Velocity := 5.0))]; END_VAR
    move[1](Axis := Axis, Execute := go, Position := far, Acceleration := 20.0, Jerk := 200.0, Done => there);
    move[2](Axis := Axis, Execute := move[1].Done, Position := 0.0, Acceleration := 20.0, BufferMode := mcBuffered);
END_FUNCTION_BLOCK
VAR_GLOBAL X, Y : AXIS_REF; END_VAR
PROGRAM Main
VAR_INPUT i, j : BOOL; END_VAR
VAR_OUTPUT px, vx, py : LREAL; there, geared, halted, still : BOOL; id : WORD; n : DINT; END_VAR
VAR
    on, onY : MC_Power; s : Station; run : MC_MoveVelocity; gear : MC_GearIn; halt : MC_Halt; st : MC_ReadStatus;
    rx, ry : MC_ReadActualPosition; rv : MC_ReadActualVelocity;
END_VAR
    on(Axis := X, Enable := TRUE); onY(Axis := Y, Enable := on.Status);
    s(Axis := X, far := 1.5, go := i); there := s.there;
    gear(Master := X, Slave := Y, Execute := j, RatioNumerator := 2, Acceleration := 50.0, InGear => geared);
    run(Axis := X, Execute := i AND j, Velocity := -2.0, Acceleration := 5.0); id := run.ErrorID;
    halt(Axis := X, Execute := NOT i, Deceleration := 30.0, Done => halted);
    rx(Axis := X, Enable := TRUE, Position => px); ry(Axis := Y, Enable := TRUE, Position => py);
    rv(Axis := X, Enable := TRUE, Velocity => vx); st(Axis := X, Enable := TRUE, Standstill => still);
    IF run.InVelocity THEN n := n + 1; END_IF;
END_PROGRAM";

const DERIVED: &str = "
FUNCTION_BLOCK Counting EXTENDS TON
VAR_OUTPUT n : INT; END_VAR
VAR on : BOOL; END_VAR
    SUPER();
    IF Q AND NOT on THEN n := n + 1; END_IF;
    on := Q;
END_FUNCTION_BLOCK
PROGRAM Main VAR_INPUT i : BOOL; END_VAR VAR_OUTPUT n : INT; et : TIME; q : BOOL; END_VAR VAR c : Counting; END_VAR
    c(IN := i, PT := T#12ms); n := c.n; et := c.ET; q := c.Q;
END_PROGRAM";

pub(crate) fn cases() -> Vec<Case> {
    vec![
        Case {
            name: "timers",
            text: TIMERS,
            tasks: vec![task("main", 5, 0, &["Main"])],
            inputs: &["Main.i", "Main.j"],
        },
        Case {
            name: "tasks",
            text: TASKS,
            tasks: vec![
                task("slow", 20, 2, &["Slow"]),
                task("fast", 10, 2, &["Fast", "Also"]),
                task("urgent", 15, 1, &["Urgent"]),
            ],
            inputs: &[],
        },
        Case {
            name: "returns",
            text: RETURNS,
            tasks: vec![task("main", 10, 0, &["Main", "Empty", "Blank"]), task("behind", 10, 1, &["Behind"])],
            inputs: &["Main.i"],
        },
        Case {
            name: "counters",
            text: COUNTERS,
            tasks: vec![task("main", 10, 3, &["Main"])],
            inputs: &["Main.i", "Main.j"],
        },
        Case { name: "derived", text: DERIVED, tasks: vec![task("main", 5, 0, &["Main"])], inputs: &["Main.i"] },
        Case { name: "chart", text: CHART, tasks: vec![task("main", 5, 0, &["Main"])], inputs: &["Main.i", "Main.j"] },
        Case {
            name: "motion",
            text: MOTION,
            tasks: vec![task("main", 5, 0, &["Main"])],
            inputs: &["Main.i", "Main.j"],
        },
    ]
}

/// The value of an input at a step: a pattern without a short period.
pub(crate) fn input(index: usize, step: u64) -> i64 {
    let mixed = (step / 3 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15 ^ (index as u64) << 17);
    (mixed >> 61 & 1) as i64
}
