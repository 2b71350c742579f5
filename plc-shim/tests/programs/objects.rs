//! Classes, methods, interfaces (3rd ed. 6.6.5 to 6.6.7), and what vendors add to them.

use onescan_iec::Dialect;

use crate::rig::{Rig, findings_in};

/// After one scan.
fn run(text: &str) -> Rig {
    let mut rig = Rig::new(text);
    rig.scan().expect("no fault");
    rig
}

fn fault(text: &str) -> String {
    let mut rig = Rig::new(text);
    for _ in 0..100 {
        if let Err(fault) = rig.scan() {
            return fault.to_string();
        }
    }
    panic!("no fault");
}

const COUNTER: &str = "CLASS Counter
VAR value : INT; END_VAR
VAR PUBLIC limit : INT := 100; END_VAR
METHOD PUBLIC Up : INT
VAR_INPUT step : INT := 1; END_VAR
VAR before : INT; END_VAR
  before := value;
  value := before + step;
  IF value > limit THEN value := limit; END_IF;
  Up := value;
END_METHOD
METHOD PUBLIC Both
VAR_OUTPUT now : INT; twice : DINT; END_VAR
VAR_IN_OUT sum : INT; END_VAR
  now := value;
  twice := 2 * value;
  sum := sum + value;
END_METHOD
END_CLASS
";

#[test]
fn iec3_6_6_5_2_methods_of_a_class_work_on_their_instance() {
    let rig = run(&format!(
        "{COUNTER}PROGRAM P
VAR a, b : Counter; list : ARRAY [1..3] OF Counter; i, x, y, z, sum : INT; d : DINT; END_VAR
  a.Up(5);
  x := a.Up(step := 2) + b.Up(step := 3);
  b.limit := 4;
  y := b.Up(9);
  FOR i := 1 TO 3 DO list[i].Up(i); z := 10 * z + list[i].Up(1); END_FOR;
  sum := 1;
  a.Both(sum := sum, now => i, twice => d);
END_PROGRAM"
    ));
    let values = ["x", "y", "z", "sum", "i", "d"].map(|name| rig.int(&format!("P.{name}")));
    assert_eq!(values, [10, 4, 234, 8, 7, 14]);
}

const SHAPES: &str = "CLASS ABSTRACT Shape
VAR PROTECTED size : INT; END_VAR
VAR PRIVATE secret : INT := 77; END_VAR
METHOD PUBLIC SetSize VAR_INPUT value : INT; END_VAR size := value; END_METHOD
METHOD PUBLIC ABSTRACT Area : INT END_METHOD
METHOD PUBLIC Twice : INT Twice := 2 * THIS.Area(); END_METHOD
METHOD PUBLIC Hidden : INT Hidden := secret; END_METHOD
END_CLASS
CLASS Square EXTENDS Shape
METHOD PUBLIC OVERRIDE Area : INT Area := size * size; END_METHOD
END_CLASS
CLASS FINAL Cube EXTENDS Square
VAR secret : INT := 5; END_VAR
METHOD PUBLIC OVERRIDE Area : INT Area := 6 * SUPER.Area() + secret - 5; END_METHOD
END_CLASS
CLASS Line EXTENDS Shape
METHOD PUBLIC OVERRIDE Area : INT Area := 0; END_METHOD
END_CLASS
FUNCTION Measure : INT
VAR_IN_OUT shape : Shape; END_VAR
  Measure := shape.Twice() + shape.Area();
END_FUNCTION
";

#[test]
fn iec3_6_6_5_5_calls_find_the_method_of_the_instance() {
    let rig = run(&format!(
        "{SHAPES}PROGRAM P
VAR s : Square; c : Cube; l : Line; a, b, d, e : INT; END_VAR
  s.SetSize(2); c.SetSize(3); l.SetSize(4);
  a := Measure(s); b := Measure(c); d := Measure(l); e := c.Hidden();
END_PROGRAM"
    ));
    let values = ["a", "b", "d", "e"].map(|name| rig.int(&format!("P.{name}")));
    assert_eq!(values, [12, 162, 0, 77]);
}

const DRIVES: &str = "INTERFACE IDrive
METHOD Start : BOOL VAR_INPUT speed : INT; END_VAR VAR_OUTPUT actual : INT; END_VAR END_METHOD
METHOD Name : STRING[10] END_METHOD
PROPERTY Level : INT GET END_GET SET END_SET END_PROPERTY
END_INTERFACE
INTERFACE IBrake EXTENDS IDrive
METHOD Brake END_METHOD
END_INTERFACE
FUNCTION_BLOCK Simple IMPLEMENTS IDrive
VAR height : INT := 1; END_VAR
METHOD Start : BOOL VAR_INPUT speed : INT; END_VAR VAR_OUTPUT actual : INT; END_VAR
  actual := speed; height := speed; Start := speed > 0;
END_METHOD
METHOD Name : STRING[10] Name := 'simple'; END_METHOD
PROPERTY Level : INT GET Level := level_of(); END_GET SET height := Level; END_SET END_PROPERTY
METHOD PRIVATE level_of : INT level_of := height; END_METHOD
END_FUNCTION_BLOCK
FUNCTION_BLOCK Better EXTENDS Simple IMPLEMENTS IBrake
VAR brakes : INT; END_VAR
METHOD Start : BOOL VAR_INPUT speed : INT; END_VAR VAR_OUTPUT actual : INT; END_VAR
  Start := SUPER^.Start(speed := 2 * speed, actual => actual); actual := actual + 1;
END_METHOD
METHOD Name : STRING[10] Name := 'better'; END_METHOD
METHOD Brake brakes := brakes + 1; Level := 0; END_METHOD
METHOD Self : IDrive Self := THIS^; END_METHOD
END_FUNCTION_BLOCK
";

#[test]
fn iec3_6_6_6_interfaces_refer_to_what_implements_them() {
    let rig = run(&format!(
        "{DRIVES}PROGRAM P
VAR s : Simple; b : Better; d : IDrive; k : IBrake; list : ARRAY [0..1] OF IDrive;
  i, x, y, z, before, after : INT; first, second : STRING[10]; none, same, other, ok : BOOL; END_VAR
  none := d = NULL;
  d := s;
  same := d = s; other := d <> b;
  ok := d.Start(7, actual => x);
  first := d.Name();
  k := b; list[0] := s; list[1] := k;
  FOR i := 0 TO 1 DO list[i].Start(speed := 10 * i + 1, actual => y); z := 100 * z + y; END_FOR;
  second := list[1].Name();
  before := k.Level; k.Brake(); after := b.Self().Level;
  b.Self().Level := 40 + s.Level;
END_PROGRAM"
    ));
    let values = ["x", "y", "z", "before", "after", "b.height"].map(|name| rig.int(&format!("P.{name}")));
    assert_eq!(values, [7, 23, 123, 22, 0, 41]);
    assert_eq!((rig.text("P.first").as_str(), rig.text("P.second").as_str()), ("simple", "better"));
    assert!(["none", "same", "other", "ok"].iter().all(|name| rig.bool(&format!("P.{name}"))));
}

#[test]
fn iec3_6_6_6_use_of_an_interface_that_refers_to_nothing_is_a_fault() {
    insta::assert_snapshot!(fault(&format!(
        "{DRIVES}PROGRAM P\nVAR d : IDrive; s : Simple; x : INT; n : INT; END_VAR\n  n := n + 1;\n  IF n = 1 THEN d := s; ELSE d := NULL; END_IF;\n  x := d.Level;\nEND_PROGRAM"
    )), @"use of a NULL reference at test.st:31:8 in P, t_v = 0.020 s");
}

#[test]
fn vendors_derived_statements_replace_those_of_the_base() {
    let rig = run("FUNCTION_BLOCK Base
VAR_INPUT x : INT; END_VAR VAR_OUTPUT y : INT; END_VAR VAR n : INT; END_VAR
  n := n + 1; y := x + 1;
END_FUNCTION_BLOCK
FUNCTION_BLOCK Derived EXTENDS Base
VAR_INPUT z : INT; END_VAR
  IF z > 0 THEN SUPER^(); END_IF;
  y := y * 10 + THIS^.x;
END_FUNCTION_BLOCK
FUNCTION Call : INT VAR_IN_OUT block : Base; END_VAR block(x := 3); Call := block.y; END_FUNCTION
PROGRAM P VAR b : Base; d, e : Derived; r, s, t : INT; END_VAR
  d(x := 5, z := 1, y => r); e(x := 4);
  s := Call(d); t := Call(b);
END_PROGRAM");
    let values = ["r", "s", "t", "d.n", "e.n", "e.y"].map(|name| rig.int(&format!("P.{name}")));
    assert_eq!(values, [65, 43, 4, 2, 0, 4]);
}

#[test]
fn iec2_2_6_4_1_actions_work_on_the_variables_of_their_unit() {
    let rig = run("FUNCTION_BLOCK Valve
VAR_INPUT open : BOOL; END_VAR VAR_OUTPUT n : INT; END_VAR
  IF open THEN Count(); END_IF;
END_FUNCTION_BLOCK
ACTION Count: n := n + 1; END_ACTION
ACTION Reset: n := 100; END_ACTION
PROGRAM P VAR v : Valve; a, b : INT; END_VAR
  v(open := TRUE, n => a); v.Reset(); v.Count(); Note(); P.Note();
END_PROGRAM
ACTION Note: b := b + v.n; END_ACTION");
    assert_eq!(["a", "b"].map(|name| rig.int(&format!("P.{name}"))), [1, 202]);
}

#[test]
fn queries_of_vendors_report_what_an_instance_is() {
    let text = "INTERFACE IRun EXTENDS __SYSTEM.IQueryInterface METHOD Run : INT END_METHOD END_INTERFACE
        INTERFACE IStop EXTENDS __SYSTEM.IQueryInterface METHOD Stop : INT END_METHOD END_INTERFACE
        FUNCTION_BLOCK Motor IMPLEMENTS IRun, IStop VAR_OUTPUT n : INT; END_VAR
          METHOD Run : INT n := n + 1; Run := n; END_METHOD METHOD Stop : INT Stop := -1; END_METHOD END_FUNCTION_BLOCK
        FUNCTION_BLOCK Pump IMPLEMENTS IRun METHOD Run : INT Run := 50; END_METHOD END_FUNCTION_BLOCK
        PROGRAM P VAR m : Motor; q : Pump; r : IRun; s : IStop; p : POINTER TO Motor; a, b, c, d, e : BOOL; x : INT; END_VAR
        a := __QUERYINTERFACE(m, r); r := m; IF __QUERYINTERFACE(r, s) THEN x := s.Stop(); END_IF; b := __QUERYPOINTER(r, p); p^.Run();
        r := q; c := __QUERYINTERFACE(r, s); d := s = 0; r := 0; e := __QUERYPOINTER(r, p) OR p <> 0; __QUERYINTERFACE(q, r); END_PROGRAM";
    for dialect in [Dialect::Codesys, Dialect::TwinCat] {
        let mut rig = Rig::in_dialect(dialect, text);
        rig.scan().expect("no fault");
        let found = ["a", "b", "c", "d", "e"].map(|name| rig.bool(&format!("P.{name}")));
        assert_eq!(found, [true, true, false, true, false], "{dialect}");
        assert_eq!((rig.int("P.x"), rig.int("P.m.n")), (-1, 1));
    }
}

#[test]
fn a_circle_of_dynamic_calls_keeps_its_data_or_stops() {
    let chain = |extra: &str, depth: &str| {
        format!(
            "INTERFACE INode METHOD Sum : INT VAR_INPUT n : INT; END_VAR END_METHOD END_INTERFACE
CLASS Node IMPLEMENTS INode
VAR PUBLIC next : INode; value : INT; END_VAR
METHOD PUBLIC Sum : INT VAR_INPUT n : INT; END_VAR VAR rest : INT; {extra} END_VAR
  rest := 10 * n + value;
  IF next <> NULL THEN Sum := next.Sum(n + 1); END_IF;
  Sum := Sum + rest;
END_METHOD
END_CLASS
PROGRAM P VAR a, b, c : Node; r : INT; END_VAR
  a.value := 1; b.value := 2; c.value := 3; a.next := b; b.next := c; {depth}
  r := a.Sum(1);
END_PROGRAM"
        )
    };
    assert_eq!(run(&chain("", "")).int("P.r"), 66);
    let endless = fault(&chain("", "c.next := a;"));
    insta::assert_snapshot!(
        endless,
        @"calls nested too deep at test.st:4:15 in Node.Sum, called by Node.Sum at test.st:6 (128 times), called by P at test.st:12, t_v = 0.010 s"
    );
    insta::assert_snapshot!(
        fault(&chain("list : ARRAY [0..3] OF INT;", "")),
        @"a unit was called while it ran at test.st:4:15 in Node.Sum, called by Node.Sum at test.st:6, called by P at test.st:12, t_v = 0.010 s"
    );
}

#[test]
fn iec3_6_6_6_7_an_assignment_attempt_gives_null_to_what_does_not_implement() {
    let rig = run(&format!(
        "{DRIVES}CLASS Other IMPLEMENTS IThing END_CLASS INTERFACE IThing END_INTERFACE
PROGRAM P
VAR s : Simple; b : Better; o : Other; d, e : IDrive; k, l, m : IBrake; t : IThing; r : ARRAY [1..5] OF BOOL; END_VAR
  d := s; k ?= d; r[1] := k = NULL;
  d := b; k ?= d; r[2] := k <> NULL AND k = d;
  d := NULL; l := b; l ?= d; r[3] := l = NULL;
  t := o; e ?= t; r[4] := NULL = e;
  m ?= b; r[5] := m = b;
END_PROGRAM"
    ));
    assert!((1..=5).all(|index| rig.bool(&format!("P.r[{index}]"))));
}

#[test]
fn vendors_structures_extend_structures() {
    let rig = run("TYPE
  Point : STRUCT x, y : INT := 2; END_STRUCT;
  Place EXTENDS Point : STRUCT z : DINT := 3; END_STRUCT;
  Spot : STRUCT EXTENDS Place w : INT := 4; END_STRUCT;
END_TYPE
PROGRAM P VAR s : Spot := (x := 1, z := 30); r : DINT; END_VAR
  r := s.x + 10 * s.y + 100 * s.z + s.w;
END_PROGRAM");
    assert_eq!(rig.int("P.r"), 1 + 20 + 3000 + 4);
}

#[test]
fn iec3_6_6_7_a_function_block_extends_a_class_and_its_instances_lie_in_arrays_and_structures() {
    let rig = run(&format!(
        "{COUNTER}FUNCTION_BLOCK Beat EXTENDS Counter
VAR_INPUT go : BOOL R_EDGE; END_VAR
  IF go THEN Up(1); END_IF;
END_FUNCTION_BLOCK
FUNCTION_BLOCK Loud EXTENDS Beat
  SUPER(); value := value + 10;
END_FUNCTION_BLOCK
TYPE Cell : STRUCT beat : Loud; END_STRUCT; END_TYPE
PROGRAM P VAR cells : ARRAY [0..1] OF Cell; l : Loud; b : Beat; r : INT; END_VAR
 l(go := TRUE); b(go := TRUE);
  cells[1].beat(go := TRUE); cells[1].beat(go := TRUE);
  r := cells[1].beat.Up(0) + cells[0].beat.Up(0);
END_PROGRAM"
    ));
    let values = ["l.value", "b.value", "r", "cells[1].beat.value", "cells[1].beat.limit"]
        .map(|name| rig.int(&format!("P.{name}")));
    assert_eq!(values, [11, 1, 21, 21, 100]);
}

#[test]
fn retained_instances_keep_what_is_inherited_over_a_warm_start() {
    let mut rig = Rig::new(&format!(
        "{SHAPES}PROGRAM P VAR RETAIN s : Square; END_VAR VAR t : Cube; a, b : INT; END_VAR
  IF s.Area() = 0 THEN s.SetSize(3); t.SetSize(3); END_IF;
  a := Measure(s); b := Measure(t);
END_PROGRAM"
    ));
    rig.scan().expect("no fault");
    assert_eq!((rig.int("P.a"), rig.int("P.b")), (27, 162));
    rig.plc.warm_start();
    rig.scan().expect("no fault");
    assert_eq!((rig.int("P.a"), rig.int("P.b")), (27, 0));
}

#[test]
fn lints_know_members_and_what_is_derived() {
    let text = format!(
        "{COUNTER}FUNCTION_BLOCK Base
VAR_OUTPUT q : INT; END_VAR VAR used, left : INT; END_VAR
METHOD PROTECTED Set VAR lost : INT; END_VAR used := 1; END_METHOD
METHOD Call used := used + 1; RETURN; used := 0; END_METHOD
END_FUNCTION_BLOCK
FUNCTION_BLOCK Derived EXTENDS Base
METHOD OVERRIDE Set q := 2; END_METHOD
END_FUNCTION_BLOCK
PROGRAM P VAR c : Counter; d : Derived; n : INT; i : Chain; END_VAR
  d.Call(); n := c.Up(1); i.Next().Next(); GVL.used := GVL.used + n;
END_PROGRAM
INTERFACE INext METHOD Next : INext END_METHOD END_INTERFACE
FUNCTION_BLOCK Chain IMPLEMENTS INext METHOD Next : INext Next := THIS; END_METHOD END_FUNCTION_BLOCK
NAMESPACE GVL VAR_GLOBAL used, unused : INT; END_VAR END_NAMESPACE"
    );
    let input = onescan_iec::Input::from_text("test.st", onescan_iec::input::kind::SourceKind::Text, text);
    insta::assert_snapshot!(onescan_iec::inspect([input], None), @r#"
    test.st:16:12: warning[W0713]: this product is cut to INT before it becomes DINT (convert a factor, as in `INT_TO_DINT(a) * b`)
    test.st:21:39: warning[W0706]: variable `left` is never used
    test.st:22:26: warning[W0706]: variable `lost` is never used
    test.st:23:39: warning[W0705]: this is never reached
    test.st:33:32: warning[W0706]: variable `unused` is never used
    "#);
}

#[test]
fn each_rule_of_objects_has_its_finding() {
    insta::assert_snapshot!(crate::rig::findings(&format!(
        "{SHAPES}{DRIVES}CLASS Bad EXTENDS Cube IMPLEMENTS IBrake, Square END_CLASS
CLASS Wrong EXTENDS Shape
VAR PRIVATE mine : INT; END_VAR
METHOD PUBLIC OVERRIDE Area : DINT Area := 1; END_METHOD
METHOD OVERRIDE Nothing END_METHOD
METHOD PUBLIC FINAL Done END_METHOD
METHOD ABSTRACT Never END_METHOD
METHOD PRIVATE Own END_METHOD
END_CLASS
CLASS After EXTENDS Wrong
METHOD PUBLIC Done Own(); mine := 1; size := 1; SUPER.Oops(); END_METHOD
END_CLASS
CLASS Loop1 EXTENDS Loop2 END_CLASS
CLASS Loop2 EXTENDS Loop1 END_CLASS
FUNCTION F : INT F := THIS.x; END_FUNCTION
PROGRAM P
VAR s : Square; h : Shape; w : Wrong; d : IDrive; f : Simple; i : INT; k : IBrake; END_VAR
  s.size := 3;
  s.Aera();
  s.Area;
  i := s.Area;
  w.Own();
  f.level_of();
  s();
  d := s;
  d := i;
  k := d;
  d := 5;
  IF d < d THEN i := 1; END_IF;
  SUPER.Area();
  s.SetSize();
  s.SetSize(1, 2);
  s.SetSize(size := 1);
  d.Start(speed := 1, actual => s);
  Square.Area();
  i := Measure(i);
  i := d.Level + f.height;
  f.Level := TRUE;
END_PROGRAM
FUNCTION_BLOCK Self METHOD Again : INT Again := Again(); END_METHOD END_FUNCTION_BLOCK
METHOD Alone END_METHOD"
    )), @r#"
    test.st:49:7: error[O0803]: `Bad` lacks the method `Start` of `IDrive`
    test.st:49:7: error[O0803]: `Bad` lacks the method `Name` of `IDrive`
    test.st:49:7: error[O0803]: `Bad` lacks GET of the property `Level` of `IDrive`
    test.st:49:7: error[O0803]: `Bad` lacks SET of the property `Level` of `IDrive`
    test.st:49:7: error[O0803]: `Bad` lacks the method `Brake` of `IBrake`
    test.st:49:19: error[O0805]: `Cube` is FINAL and cannot be extended
    test.st:49:43: error[O0807]: `Square` is not an interface
    test.st:52:24: error[O0804]: `Area` has other parameters or another result than what it overrides
    test.st:53:17: error[O0806]: no base has a method `Nothing` to override
    test.st:55:17: error[O0802]: `Wrong` has an ABSTRACT method and is not ABSTRACT itself
    test.st:58:7: error[O0803]: `After` lacks the method `Never` of `Wrong`
    test.st:59:15: error[O0805]: `Done` is FINAL in its base
    test.st:59:20: error[O0801]: `Wrong.Own` is PRIVATE
    test.st:59:27: error[N0101]: `mine` is not declared
    test.st:59:55: error[N0104]: Wrong has no method `Oops`
    test.st:61:7: error[D0404]: `Loop1` extends itself
    test.st:63:23: error[O0808]: THIS is used where no instance runs
    test.st:65:21: error[O0802]: `Shape` is ABSTRACT and has no instances (declare an instance of what extends it)
    test.st:66:5: error[N0104]: `size` is internal to Square
    test.st:67:5: error[N0104]: Square has no member `Aera` (did you mean `Area`?)
    test.st:68:3: error[S0110]: a value as a statement is not part of iec3 (it is part of codesys and twincat: --dialect chooses)
    test.st:69:10: error[N0106]: `Area` is a method: call it as `Area()`
    test.st:70:5: error[O0801]: `Wrong.Own` is PRIVATE
    test.st:71:5: error[O0801]: `Simple.level_of` is PRIVATE
    test.st:72:3: error[C0306]: a class has no statements of its own; call one of its methods
    test.st:73:8: error[T0201]: Square does not implement IDrive
    test.st:74:8: error[T0201]: IDrive is wanted, this is INT
    test.st:75:8: error[T0201]: IBrake is wanted, this is IDrive (assign it with `?=`, which gives NULL if it is something else)
    test.st:76:8: error[T0201]: IDrive is wanted, this is an integer
    test.st:77:6: error[T0203]: references are compared with `=` and `<>` only
    test.st:78:3: error[O0808]: SUPER is used in what extends nothing
    test.st:79:3: warning[C0302]: parameter `value` is missing: it is what its type begins with (write `value := ...`, or give it a value in its declaration)
    test.st:80:16: error[C0303]: `SetSize` takes 1 arguments
    test.st:81:13: error[C0301]: `SetSize` has no such parameter `size`
    test.st:82:33: error[T0201]: Square is wanted, this is INT
    test.st:83:3: error[N0106]: `Square` is a class, not an instance (declare an instance, `square_1 : Square;`, and write `square_1` here)
    test.st:84:16: error[C0305]: VAR_IN_OUT `shape` is Shape, this is INT
    test.st:85:20: error[N0104]: `height` is internal to Simple
    test.st:86:14: error[T0201]: INT is wanted, this is BOOL (convert it with BOOL_TO_INT)
    test.st:88:49: error[D0404]: this call makes `Self.Again` call itself
    "#);
}

#[test]
fn en_and_eno_of_methods() {
    let rig = run("INTERFACE ICount METHOD Up : INT VAR_INPUT n : INT; END_VAR END_METHOD END_INTERFACE
FUNCTION_BLOCK Count IMPLEMENTS ICount
VAR_OUTPUT value : INT; END_VAR
METHOD Up : INT
VAR_INPUT n : INT; END_VAR
  value := value + n; Up := value;
END_METHOD
METHOD Check : BOOL
VAR_INPUT EN : BOOL; limit : INT; END_VAR
VAR_OUTPUT ENO : BOOL; END_VAR
  ENO := value < limit; Check := TRUE;
END_METHOD
END_FUNCTION_BLOCK
PROGRAM P VAR c : Count; i : ICount; a, b, d : INT; yes, no, low, high, skipped : BOOL; END_VAR
  i := c;
  a := c.Up(EN := TRUE, n := 5, ENO => yes);
  no := TRUE; b := 7;
  b := i.Up(EN := FALSE, n := 5, ENO => no);
  c.Up(EN := a = 5, n := 2);
  d := c.value;
  c.Check(limit := 10, ENO => low);
  c.Check(limit := 3, ENO => high);
  skipped := TRUE;
  c.Check(EN := FALSE, limit := 10, ENO => skipped);
END_PROGRAM");
    let values = ["a", "b", "d", "yes", "no", "low", "high", "skipped"].map(|name| rig.int(&format!("P.{name}")));
    assert_eq!(values, [5, 0, 7, 1, 0, 1, 0, 0]);
}

#[test]
fn parts_of_what_properties_and_calls_give() {
    let rig = run("TYPE Pose : STRUCT x, y : INT; list : ARRAY [1..3] OF INT := [7, 8, 9]; END_STRUCT END_TYPE
INTERFACE IPose
PROPERTY Here : Pose GET END_GET END_PROPERTY
END_INTERFACE
FUNCTION_BLOCK Axis IMPLEMENTS IPose
VAR at_x : INT := 4; own : Pose := (y := 6); END_VAR
PROPERTY Here : Pose GET Here.x := at_x; END_GET END_PROPERTY
PROPERTY There : REFERENCE TO Pose GET There REF= own; END_GET END_PROPERTY
PROPERTY Self : IPose GET Self := THIS; END_GET END_PROPERTY
METHOD Give : Pose
  Give.x := Here.x + 1; Give.list[2] := Here.list[3];
END_METHOD
END_FUNCTION_BLOCK
FUNCTION Origin : Pose
  Origin.x := 40;
END_FUNCTION
PROGRAM P VAR a : Axis; i : IPose; v, w, x, y, z, u : INT; END_VAR
  i := a;
  v := a.Here.x; w := i.Here.list[2]; x := a.Give().list[2]; y := a.Self.Here.x + a.There.y;
  a.There.y := 20; z := a.There.y; u := Origin().x;
END_PROGRAM");
    assert_eq!(["v", "w", "x", "y", "z", "u"].map(|name| rig.int(&format!("P.{name}"))), [4, 8, 9, 10, 20, 40]);
}

#[test]
fn members_that_are_not_there_are_reported_with_the_nearest() {
    insta::assert_snapshot!(crate::rig::findings(
        "INTERFACE IValve METHOD Open : BOOL END_METHOD PROPERTY Level : INT GET END_GET END_PROPERTY END_INTERFACE
TYPE Pose : STRUCT x : INT; END_STRUCT END_TYPE
FUNCTION_BLOCK Axis PROPERTY Here : Pose GET Here.x := 1; END_GET END_PROPERTY
PROPERTY Count : INT GET Count := 1; END_GET END_PROPERTY END_FUNCTION_BLOCK
PROGRAM P VAR v : IValve; a : Axis; n : INT; END_VAR
  v.Opn();
  n := v.Lvel;
  n := a.Here.z;
  a.Here.x := 3;
  n := a.Count.x;
END_PROGRAM"
    ));
}

#[test]
fn actions_of_vendors_take_the_inputs_of_their_unit() {
    let text = "FUNCTION_BLOCK F VAR_INPUT a, b : INT; END_VAR VAR_OUTPUT sum : INT; END_VAR
            ACTION Add: sum := a + b; END_ACTION
        END_FUNCTION_BLOCK
        PROGRAM P VAR f1 : ARRAY [0..1] OF F; x, y : INT; END_VAR
            f1[1].Add(a := 3, b := 4, sum => x); f1[1].Add(b := 10); y := f1[1].sum; END_PROGRAM";
    let mut rig = Rig::in_dialect(Dialect::TwinCat, text);
    rig.scan().expect("no fault");
    assert_eq!((rig.int("P.x"), rig.int("P.y")), (7, 13));
    let reported = findings_in(Dialect::TwinCat, &text.replace("b := 10", "c := 10")).to_string();
    assert!(reported.contains("`Add` has no such parameter `c`"), "{reported}");
}

/// 3rd ed. 6.6.5.9: what is PRIVATE to the base is not overridden, whatever its parameters are.
#[test]
fn a_private_method_of_the_base_stays_beside_that_of_the_derived_block() {
    let text = "FUNCTION_BLOCK Base
VAR n, m : INT; END_VAR
METHOD PRIVATE Step : INT Step := 1; END_METHOD
METHOD Run n := THIS^.Step(); m := Step(); END_METHOD
END_FUNCTION_BLOCK
FUNCTION_BLOCK Derived EXTENDS Base
VAR own : INT; END_VAR
METHOD Step : INT VAR_INPUT x : INT; END_VAR Step := 10 * x; END_METHOD
METHOD Work own := Step(2); END_METHOD
END_FUNCTION_BLOCK
FUNCTION_BLOCK Last EXTENDS Derived
METHOD Step : INT VAR_INPUT x : INT; END_VAR Step := 100 * x; END_METHOD
END_FUNCTION_BLOCK
PROGRAM P
VAR d : Last; p : POINTER TO Derived; given : INT; END_VAR
  p := ADR(d); p^.Run(); p^.Work(); given := p^.Step(3);
END_PROGRAM";
    assert_eq!(findings_in(Dialect::Codesys, text).to_string(), "");
    let mut rig = Rig::in_dialect(Dialect::Codesys, text);
    rig.scan().expect("no fault");
    assert_eq!(["d.n", "d.m", "d.own", "given"].map(|name| rig.int(&format!("P.{name}"))), [1, 1, 200, 300]);
}
