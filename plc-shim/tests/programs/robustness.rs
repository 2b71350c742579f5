//! Nothing that is written in a program makes the compiler or the PLC panic.

use onescan_iec::{TimeSpan, VirtualTime};
use onescan_iec_run::{Application, SoftPlc};
use proptest::prelude::*;

const PROGRAM: &str =
    "TYPE T : STRUCT a : INT; b : ARRAY [0..3] OF REAL := [1.0, 3(2.0)]; END_STRUCT; C : (X, Y); U : UNION w : WORD; n : REF_TO U; END_UNION; END_TYPE
VAR_GLOBAL lamp AT %QX0.1 : BOOL; END_VAR
FUNCTION G : DINT VAR_IN_OUT a : ARRAY [*] OF REAL; END_VAR a[UPPER_BOUND(a, 1)] := 1.0; G := LOWER_BOUND(a, 1); END_FUNCTION
FUNCTION F : INT VAR_INPUT a : INT; b : INT := 2; END_VAR F := a * b + 1; END_FUNCTION
FUNCTION_BLOCK B VAR_INPUT x : T; END_VAR VAR_OUTPUT y : REAL; END_VAR VAR_IN_OUT z : INT; END_VAR
y := x.b[x.a]; z := z + 1; END_FUNCTION_BLOCK
PROGRAM P VAR u : U; r : REF_TO U; p : POINTER TO INT; v : REFERENCE TO INT; t : T; fb : B; i, j : INT; c : C; q : TON; w : WORD; END_VAR
FOR i := 0 TO 3 DO t.b[i] := INT_TO_REAL(F(a := i)) / 2.0; END_FOR;
fb(x := t, z := j); q(IN := j > 3, PT := T#1s);
CASE j OF 0: c := Y; 1..5: c := C#X; ELSE w := SHL(w, 1) OR 1; END_CASE;
r := REF(u); u.n := r; r^.n^.w.%X3 := lamp OR %IX0.0; p := ADR(j); p^ := p[0]; v REF= j; v := v + SIZEOF(u);
lamp := u.n <> NULL AND G(t.b) = 0; %MX1.2 := w.3;
WHILE j > 100 DO j := j - 1; IF q.Q THEN EXIT; END_IF; END_WHILE;
END_PROGRAM";

fn run(text: &str) {
    let Ok(application) = Application::from_sources([("mutated.st", text)]) else {
        return;
    };
    let mut plan = application.single_task(TimeSpan::millis::<1>());
    plan.fuel_per_task = 100_000;
    let Ok(mut plc) = SoftPlc::new(&application, &plan) else {
        return;
    };
    for scan in 1..4 {
        if plc.scan(VirtualTime::from_nanos(scan * 1_000_000)).is_err() {
            return;
        }
    }
}

fn words() -> Vec<&'static str> {
    PROGRAM.split_inclusive([' ', ';', '(', ')', '[', ']', '.', ',', '\n', ':']).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn programs_with_words_exchanged(edits in prop::collection::vec((any::<prop::sample::Index>(), any::<prop::sample::Index>()), 1..4)) {
        let mut list = words();
        for (from, to) in edits {
            let (from, to) = (from.index(list.len()), to.index(list.len()));
            list[to] = list[from];
        }
        run(&list.concat());
    }

    #[test]
    fn programs_with_words_missing(edits in prop::collection::vec(any::<prop::sample::Index>(), 1..4)) {
        let mut list = words();
        for edit in edits {
            list.remove(edit.index(list.len()));
        }
        run(&list.concat());
    }
}

#[test]
fn the_program_itself_runs() {
    let application = Application::from_sources([("p.st", PROGRAM)]);
    let application = application.unwrap_or_else(|found| panic!("{found}"));
    assert!(application.warnings().is_empty(), "{}", application.warnings());
    run(PROGRAM);
}

#[test]
fn depth_is_bounded_in_every_pass() {
    let chain = |count: usize| format!("PROGRAM P VAR x : DINT; END_VAR x := x{}; END_PROGRAM", " + x".repeat(count));
    assert!(Application::from_sources([("t.st", chain(240))]).is_ok());
    run(&chain(240));
    assert!(Application::from_sources([("t.st", chain(2600))]).is_ok(), "a row is long, and not deep");
    run(&chain(2600));
    let nested = format!(
        "PROGRAM P VAR x : DINT; END_VAR {} x := {}x{}; {} END_PROGRAM",
        "IF x = 0 THEN ".repeat(60),
        "(1 + ".repeat(60),
        ")".repeat(60),
        "END_IF;".repeat(60),
    );
    assert!(Application::from_sources([("t.st", nested.as_str())]).is_ok());
    run(&nested);
    for (open, close) in [("a[", "]"), ("F(", ")"), ("MAX(1, ", ")"), ("-(", ")"), ("SEL(TRUE, 1, ", ")")] {
        let text = format!(
            "FUNCTION F : DINT VAR_INPUT x : DINT; END_VAR F := x; END_FUNCTION
            PROGRAM P VAR x : DINT; a : ARRAY [0..1] OF DINT; END_VAR x := {}x{}; END_PROGRAM",
            open.repeat(95),
            close.repeat(95),
        );
        let compiled = Application::from_sources([("t.st", text.as_str())]);
        assert!(compiled.is_ok(), "{open}: {}", compiled.err().map(|found| found.to_string()).unwrap_or_default());
        run(&text);
    }
    let list = |count: u32, each: &dyn Fn(u32) -> String| (1..count).map(each).collect::<Vec<_>>().join(" ");
    let types = list(5000, &|n| format!("T{n} : ARRAY [0..0] OF T{};", n + 1));
    let text = format!("TYPE {types} T5000 : INT; END_TYPE");
    assert!(Application::from_sources([("t.st", text)]).is_err());
    let constants = list(5000, &|n| format!("c{n} : INT := c{};", n + 1));
    let text = format!("VAR_GLOBAL CONSTANT {constants} c5000 : INT := 1; END_VAR");
    assert!(Application::from_sources([("t.st", text)]).is_err());
    let calls = list(3000, &|n| format!("FUNCTION f{n} : INT f{n} := f{}(); END_FUNCTION", n + 1));
    run(&format!(
        "{calls} FUNCTION f3000 : INT f3000 := 1; END_FUNCTION PROGRAM P VAR x : INT; END_VAR x := f1(); END_PROGRAM"
    ));
    let elsifs = "ELSIF x = 1 THEN x := 2; ".repeat(3000);
    run(&format!("PROGRAM P VAR x : INT; END_VAR IF x = 0 THEN ; {elsifs} END_IF; END_PROGRAM"));
}

#[test]
fn size_is_bounded() {
    for declaration in [
        "x : ARRAY [0..2147483647] OF LREAL;",
        "x : ARRAY [0..99999, 0..99999, 0..99999] OF INT;",
        "x, y : ARRAY [0..40000000] OF BYTE;",
        "x : ARRAY [0..100] OF ARRAY [0..1000] OF ARRAY [0..1000] OF LINT;",
        "x : ARRAY [-2147483648..2147483647] OF BOOL;",
    ] {
        let text = format!("PROGRAM P VAR {declaration} END_VAR END_PROGRAM");
        let found = Application::from_sources([("t.st", text)]).expect_err("too large");
        assert!(found.to_string().contains("L0502"), "{found}");
    }
}

#[test]
fn what_is_empty_is_no_trap() {
    run("TYPE E : STRUCT END_STRUCT; END_TYPE FUNCTION_BLOCK F END_FUNCTION_BLOCK
        PROGRAM P VAR x : ARRAY [0..3] OF ARRAY [0..1] OF E := [3([])]; f : ARRAY [1..2] OF F; y, z : E; i : INT := 1; END_VAR
        f[i](); y := z; x[i][0] := y; END_PROGRAM");
    let wide = "TYPE E : STRUCT END_STRUCT; END_TYPE PROGRAM P
        VAR x : ARRAY [0..2147483646, 0..2147483646, 0..2147483646] OF E := [1([])]; END_VAR END_PROGRAM";
    assert!(Application::from_sources([("t.st", wide)]).is_err());
    // Each block holds two of the one before: the number of instances doubles with every level.
    let blocks: Vec<String> =
        (1..60).map(|n| format!("FUNCTION_BLOCK F{n} VAR a, b : F{}; END_VAR END_FUNCTION_BLOCK", n - 1)).collect();
    let text =
        format!("FUNCTION_BLOCK F0 END_FUNCTION_BLOCK {} PROGRAM P VAR a : F59; END_VAR END_PROGRAM", blocks.join(" "));
    assert!(Application::from_sources([("t.st", text)]).is_err());
    run("");
    run("PROGRAM P END_PROGRAM");
}
