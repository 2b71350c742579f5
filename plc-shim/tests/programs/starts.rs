//! What runs before the first scan: `FB_init`, `FB_exit` (CODESYS, TwinCAT), initial values that are not
//! constants.

use onescan_iec::Dialect;

use crate::rig::{Rig, findings_in};

fn rig(text: &str) -> Rig {
    Rig::in_dialect(Dialect::TwinCat, text)
}

fn findings(text: &str) -> String {
    findings_in(Dialect::TwinCat, text).to_string()
}

/// Notes who is started, as digits in their order.
const NOTE: &str = "VAR_GLOBAL trail : LINT; END_VAR
FUNCTION Note : BOOL
VAR_INPUT n : LINT; END_VAR
  trail := trail * 10 + n; Note := TRUE;
END_FUNCTION
FUNCTION_BLOCK Base
VAR_OUTPUT own : LINT; END_VAR
METHOD FB_init : BOOL
VAR_INPUT bInitRetains, bInCopyCode : BOOL; n : LINT; END_VAR
  own := n;
  FB_init := Note(n);
END_METHOD
END_FUNCTION_BLOCK
";

#[test]
fn fb_init_runs_before_the_first_scan_with_the_declaration_s_arguments() {
    let rig = rig(&format!(
        "{NOTE}PROGRAM P VAR one : Base(n := 1); two : Base(2); copy : LINT; END_VAR
  copy := one.own;
END_PROGRAM
VAR_GLOBAL early : Base(n := 3); END_VAR"
    ));
    assert_eq!((rig.int("trail"), rig.int("P.one.own"), rig.int("P.two.own")), (312, 1, 2));
    assert_eq!(rig.int("P.copy"), 0);
}

#[test]
fn members_come_first_then_the_base_then_the_derived_block() {
    let text = format!(
        "{NOTE}FUNCTION_BLOCK Derived EXTENDS Base
VAR inner : Base(n := 1); END_VAR
METHOD FB_init : BOOL
VAR_INPUT bInitRetains, bInCopyCode : BOOL; n : LINT; more : LINT; END_VAR
  FB_init := Note(more);
END_METHOD
END_FUNCTION_BLOCK
FUNCTION_BLOCK Plain EXTENDS Derived
END_FUNCTION_BLOCK
PROGRAM P VAR d : Derived(n := 2, more := 3); p1 : Plain(4, 5); END_VAR END_PROGRAM"
    );
    let rig = rig(&text);
    assert_eq!(rig.int("trail"), 123_145);
    assert_eq!(rig.int("P.d.own"), 2);
}

#[test]
fn instances_in_arrays_and_structures_are_started_each() {
    let text = format!(
        "{NOTE}TYPE Pair : STRUCT left : Base(n := 7); right : ARRAY [0..1] OF Base(n := 8); END_STRUCT END_TYPE
PROGRAM P VAR
  all : ARRAY [1..2, 1..2] OF Base(n := 1);
  listed : ARRAY [1..3] OF Base[(n := 2), (n := 3), (4)];
  pair : Pair;
END_VAR END_PROGRAM"
    );
    let rig = rig(&text);
    assert_eq!(rig.int("trail"), 1_111_234_788);
    assert_eq!(["P.all[2, 1].own", "P.listed[3].own", "P.pair.right[1].own"].map(|path| rig.int(path)), [1, 4, 8]);
}

#[test]
fn the_declaration_s_values_go_above_what_fb_init_assigns() {
    let text = "FUNCTION_BLOCK Sample
VAR_INPUT a : INT; b : INT; END_VAR
VAR value : INT; END_VAR
METHOD FB_init : BOOL
VAR_INPUT bInitRetains, bInCopyCode : BOOL; n : INT := 5; END_VAR
  a := n; b := n; value := n;
END_METHOD
PROPERTY Level : INT
SET value := value * 10 + Level; END_SET
END_PROPERTY
END_FUNCTION_BLOCK
PROGRAM P VAR
  s : Sample(n := 1) := (a := 2, Level := 3);
  list : ARRAY [1..2] OF Sample[(n := 4), (n := 7)] := [(a := 5, Level := 6), (a := 8, Level := 9)];
  bare : Sample;
END_VAR END_PROGRAM";
    let rig = rig(text);
    let of = |path: &str| ["a", "b", "value"].map(|name| rig.int(&format!("P.{path}.{name}")));
    assert_eq!(of("s"), [2, 1, 13]);
    assert_eq!((of("list[1]"), of("list[2]")), ([5, 4, 46], [8, 7, 79]));
    assert_eq!(of("bare"), [5, 5, 5]);
}

#[test]
fn arguments_are_seen_from_the_declaration() {
    let text = format!(
        "{NOTE}FUNCTION_BLOCK Line
VAR_INPUT first : LINT := 4; END_VAR
VAR next : LINT := first + 1; unit : Base(n := next); own : LINT; there : POINTER TO LINT := ADR(own); END_VAR
  there^ := unit.own;
END_FUNCTION_BLOCK
PROGRAM P VAR a : Line; b : Line := (first := 6); END_VAR a(); b(); END_PROGRAM"
    );
    let mut rig = rig(&text);
    rig.scan().expect("no fault");
    assert_eq!(["P.a.own", "P.b.own", "trail"].map(|path| rig.int(path)), [5, 7, 57]);
}

#[test]
fn each_start_runs_it_and_a_warm_one_keeps_what_is_retained() {
    let text = "FUNCTION_BLOCK Counter
VAR RETAIN starts : INT; END_VAR
VAR fresh : BOOL; END_VAR
METHOD FB_init : BOOL
VAR_INPUT bInitRetains, bInCopyCode : BOOL; END_VAR
  starts := starts + 1; fresh := bInitRetains;
END_METHOD
METHOD FB_exit : BOOL
VAR_INPUT bInCopyCode : BOOL; END_VAR
  starts := starts + 10;
END_METHOD
END_FUNCTION_BLOCK
PROGRAM P VAR RETAIN c : Counter; END_VAR END_PROGRAM";
    let mut rig = rig(text);
    let state = |rig: &Rig| (rig.int("P.c.starts"), rig.int("P.c.fresh"));
    assert_eq!(state(&rig), (1, 1));
    rig.plc.warm_start();
    assert_eq!(state(&rig), (12, 0));
    rig.plc.cold_start();
    assert_eq!(state(&rig), (1, 1));
    rig.plc.reset();
    assert_eq!(state(&rig), (1, 1));
}

#[test]
fn a_fault_in_it_is_that_of_the_first_scan() {
    let text = "FUNCTION_BLOCK Ratio
VAR r : INT; END_VAR
METHOD FB_init : BOOL
VAR_INPUT bInitRetains, bInCopyCode : BOOL; n : INT; END_VAR
  r := 100 / n;
END_METHOD
END_FUNCTION_BLOCK
PROGRAM P VAR zero : INT; f : Ratio(n := zero); END_VAR END_PROGRAM";
    let mut rig = rig(text);
    let fault = rig.scan().expect_err("a division by zero").to_string();
    assert_eq!(
        fault,
        "division by zero at test.st:5:8 in Ratio.FB_init, called by P.start at test.st:8, called by PLC start at \
         test.st:8, t_v = 0.000 s"
    );
}

#[test]
fn references_begin_with_variables_of_the_unit() {
    let text = "FUNCTION_BLOCK Store
VAR value : INT := 3; ref : REF_TO INT := REF(value); END_VAR
VAR_OUTPUT out : INT; END_VAR
  ref^ := ref^ + 1; out := value;
END_FUNCTION_BLOCK
PROGRAM P VAR list : ARRAY [0..1] OF INT := [7, 8]; p : REF_TO INT := REF(list[1]); a, b : Store; x : INT; END_VAR
  a(); b(); b(); x := p^;
END_PROGRAM";
    let mut rig = Rig::new(text);
    rig.scan().expect("no fault");
    assert_eq!(["P.a.out", "P.b.out", "P.x"].map(|path| rig.int(path)), [4, 5, 8]);
}

#[test]
fn variables_of_a_call_begin_with_what_is_computed() {
    let text = "FUNCTION Twice : INT
VAR_INPUT n : INT; END_VAR
VAR first : INT := n + 1; words : STRING := CONCAT('a', 'b'); END_VAR
  Twice := 2 * first + LEN(words);
END_FUNCTION
PROGRAM P VAR x : INT := Twice(1); y : INT; text : STRING := CONCAT('x', 'y'); END_VAR y := Twice(4); END_PROGRAM";
    let mut rig = rig(text);
    rig.scan().expect("no fault");
    assert_eq!((rig.int("P.x"), rig.int("P.y"), rig.text("P.text")), (6, 12, "xy".to_owned()));
}

#[test]
fn instances_of_a_call_restart_with_fb_init() {
    let mut rig = rig(&format!(
        "{NOTE}FUNCTION Make : LINT
VAR_INPUT n : LINT; END_VAR
VAR one : Base(n := n + 1); END_VAR
  Make := one.own;
END_FUNCTION
PROGRAM P VAR x, y : LINT; END_VAR x := Make(1); y := Make(4); END_PROGRAM"
    ));
    rig.scan().expect("no fault");
    assert_eq!(["P.x", "P.y", "trail"].map(|path| rig.int(path)), [2, 5, 25]);
}

#[test]
fn var_inst_is_kept_in_the_instance() {
    let text = "FUNCTION_BLOCK F
VAR t : INT; END_VAR
METHOD Count : INT
VAR_INST n : INT := 10; END_VAR
VAR m : INT; END_VAR
  n := n + 1; m := m + 1; Count := n * 10 + m;
END_METHOD
END_FUNCTION_BLOCK
FUNCTION_BLOCK G EXTENDS F
METHOD Other : INT
VAR_INST n : INT; END_VAR
  n := n + 1; Other := n;
END_METHOD
END_FUNCTION_BLOCK
PROGRAM P VAR a, b : F; g1 : G; x, y, z, w : INT; END_VAR
  a.Count(); x := a.Count(); y := b.Count(); z := g1.Other(); w := g1.Count();
END_PROGRAM";
    let mut rig = rig(text);
    rig.scan().expect("no fault");
    assert_eq!(["x", "y", "z", "w"].map(|name| rig.int(&format!("P.{name}"))), [121, 111, 1, 111]);
}

#[test]
fn fb_reinit_runs_when_it_is_called() {
    let text = "FUNCTION_BLOCK F VAR n, m : INT; END_VAR
METHOD FB_init : BOOL VAR_INPUT bInitRetains, bInCopyCode : BOOL; END_VAR n := 1; END_METHOD
METHOD FB_reinit : BOOL m := m + n; FB_reinit := TRUE; END_METHOD
n := n + 1;
END_FUNCTION_BLOCK
PROGRAM P VAR f1 : F; k : INT; done : BOOL; END_VAR k := k + 1; f1(); IF k = 2 THEN done := f1.FB_reinit(); END_IF; END_PROGRAM";
    let mut rig = rig(text);
    for (n, m) in [(2, 0), (3, 3), (4, 3)] {
        rig.scan().expect("no fault");
        assert_eq!((rig.int("P.f1.n"), rig.int("P.f1.m"), rig.bool("P.done")), (n, m, m > 0));
    }
}

#[test]
fn var_inst_has_a_path_and_is_forced() {
    let text = "FUNCTION_BLOCK F
VAR Total : INT; END_VAR
METHOD PUBLIC Count : INT
VAR_INST n : INT := 10; seen : ARRAY [1..2] OF INT; END_VAR
  n := n + 1; seen[2] := n; Count := n;
END_METHOD
END_FUNCTION_BLOCK
FUNCTION_BLOCK G EXTENDS F
METHOD Other VAR_INST k : BOOL; Count : INT; END_VAR k := NOT k; END_METHOD
END_FUNCTION_BLOCK
PROGRAM P VAR a : ARRAY [0..1] OF F; g1 : G; x : INT; END_VAR
METHOD Own : INT VAR_INST calls : DINT; END_VAR calls := calls + 1; Own := DINT_TO_INT(calls); END_METHOD
  x := a[1].Count(); g1.Count(); g1.Other(); THIS^.Own();
END_PROGRAM";
    let mut rig = rig(text);
    rig.scan().expect("no fault");
    let paths =
        ["P.a[1].Count.n", "P.A[1].count.SEEN[2]", "P.a[0].Count.n", "P.g1.Count.n", "P.g1.Other.k", "P.Own.calls"];
    assert_eq!(paths.map(|path| rig.plc.read(path).expect(path)), ["11", "11", "10", "11", "TRUE", "1"]);
    rig.plc.force("P.a[1].Count.n", "40").expect("it is a variable");
    rig.plc.write("P.Own.calls", "7").expect("it is a variable");
    for _ in 0..3 {
        rig.scan().expect("no fault");
        assert_eq!((rig.int("P.x"), rig.int("P.a[1].Count.n")), (41, 40));
    }
    assert_eq!(rig.int("P.Own.calls"), 10);
    let leaves: Vec<_> = rig.plc.application().leaves().map(|leaf| leaf.path).collect();
    for path in ["P.a[1].Count.n", "P.a[0].Count.seen[1]", "P.g1.Other.k", "P.g1.Count.n", "P.Own.calls"] {
        assert!(leaves.iter().any(|leaf| leaf == path), "{path} in {leaves:?}");
    }
    let wrong = ["P.a[1].Count", "P.a[1].Count.m", "P.a[1].Other.k", "P.Own.calls.x"];
    let said = wrong.map(|path| rig.plc.read(path).expect_err(path).to_string());
    insta::assert_snapshot!(said.join("\n"));
}

#[test]
fn what_is_wrong_with_starts_is_reported() {
    let cases = [
        ("PROGRAM P VAR f : Base; END_VAR END_PROGRAM"),
        ("PROGRAM P VAR f : Base(m := 1); END_VAR END_PROGRAM"),
        ("PROGRAM P VAR f : Base(n := 'x'); END_VAR END_PROGRAM"),
        ("PROGRAM P VAR f : Base(1, 2); END_VAR END_PROGRAM"),
        ("PROGRAM P VAR f : TON(PT := T#1s); END_VAR END_PROGRAM"),
        ("PROGRAM P VAR f : Nobody(n := 1); END_VAR END_PROGRAM"),
        ("TYPE T : STRUCT n : INT; END_STRUCT END_TYPE PROGRAM P VAR f : T(n := 1); END_VAR END_PROGRAM"),
        ("PROGRAM P VAR f : ARRAY [1..3] OF Base[(1), (2)]; END_VAR END_PROGRAM"),
        ("PROGRAM P VAR f : Base[(1), (2)]; END_VAR END_PROGRAM"),
        ("PROGRAM P VAR f : Base(n := 1) := (nowhere := 2); END_VAR END_PROGRAM"),
        ("PROGRAM P VAR a : INT; END_VAR VAR CONSTANT c : INT := a; END_VAR END_PROGRAM"),
        ("PROGRAM P VAR a : INT; b AT %MW0 : INT := a; END_VAR END_PROGRAM"),
        ("FUNCTION F : INT VAR_INPUT a : INT; b : INT := a; END_VAR F := a + b; END_FUNCTION"),
        ("FUNCTION_BLOCK B EXTENDS Base METHOD FB_init : BOOL VAR_INPUT bInitRetains, bInCopyCode : BOOL; END_VAR
END_METHOD END_FUNCTION_BLOCK PROGRAM P VAR f : B; END_VAR END_PROGRAM"),
        ("FUNCTION_BLOCK B METHOD FB_init : BOOL END_METHOD END_FUNCTION_BLOCK"),
        ("FUNCTION_BLOCK B METHOD FB_exit : BOOL VAR_INPUT a : BOOL; END_VAR END_METHOD END_FUNCTION_BLOCK"),
        ("FUNCTION_BLOCK B METHOD FB_reinit : BOOL VAR_INPUT a : BOOL; END_VAR END_METHOD END_FUNCTION_BLOCK"),
        ("FUNCTION_BLOCK B VAR_INST n : INT; END_VAR END_FUNCTION_BLOCK"),
        ("TYPE Pair : STRUCT left : Base(k := 7); END_STRUCT END_TYPE
PROGRAM P VAR a, b : Pair; END_VAR END_PROGRAM"),
    ];
    let reported: String =
        cases.iter().map(|case| format!("{case}\n{}\n", findings(&format!("{NOTE}{case}")))).collect();
    insta::assert_snapshot!(reported);
}

#[test]
fn members_of_a_structure_name_one_another_and_this_is_the_structure() {
    let mut rig = rig("FUNCTION_BLOCK Part
VAR whole : REFERENCE TO ST; before : POINTER TO Part; END_VAR
METHOD FB_init : BOOL
VAR_INPUT bInitRetains, bInCopyCode : BOOL; first : POINTER TO Part; structure : REFERENCE TO ST; END_VAR
  before := first; whole REF= structure;
END_METHOD
METHOD N : INT
  N := whole.n;
END_METHOD
END_FUNCTION_BLOCK
TYPE ABSTRACT ST : STRUCT n : INT := 3; me : Part(0, THIS^); END_STRUCT END_TYPE
TYPE ST2 EXTENDS ST : STRUCT
  inner : ST := (n := n + 4);
  rest : ARRAY [1..2] OF Part(ADR(me), THIS^);
END_STRUCT END_TYPE
PROGRAM P
VAR a : ST2; many : ARRAY [1..2] OF ST2 := [(n := 5)]; r : ARRAY [1..5] OF INT; END_VAR
  r[1] := a.me.N(); r[2] := a.inner.me.N(); r[3] := a.rest[2].before^.N();
  r[4] := many[1].rest[2].N(); r[5] := many[2].inner.n;
END_PROGRAM");
    rig.scan().expect("no fault");
    let found: Vec<i64> = (1..=5).map(|index| rig.int(&format!("P.r[{index}]"))).collect();
    assert_eq!(found, [3, 7, 3, 5, 7]);
}

#[test]
fn an_interface_with_fb_init_is_implemented_by_who_declares_none() {
    let text = "INTERFACE I METHOD FB_init : BOOL VAR_INPUT bInitRetains, bInCopyCode : BOOL; END_VAR END_METHOD
          METHOD Get : INT END_METHOD END_INTERFACE
        FUNCTION_BLOCK Plain IMPLEMENTS I METHOD Get : INT Get := 4; END_METHOD END_FUNCTION_BLOCK
        FUNCTION_BLOCK Own IMPLEMENTS I VAR n : INT; END_VAR METHOD Get : INT Get := n; END_METHOD
          METHOD FB_init : BOOL VAR_INPUT bInitRetains, bInCopyCode : BOOL; END_VAR n := n + 7; END_METHOD END_FUNCTION_BLOCK
        PROGRAM P VAR p : Plain; o : Own; i : I; a, b : INT; END_VAR i := p; a := i.Get(); i := o; b := i.Get(); END_PROGRAM";
    let mut rig = Rig::in_dialect(Dialect::TwinCat, text);
    rig.scan().expect("no fault");
    assert_eq!((rig.int("P.a"), rig.int("P.b")), (4, 7));
}
