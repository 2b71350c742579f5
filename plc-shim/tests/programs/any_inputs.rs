//! Inputs of type `ANY`, `ANY_NUM` and the like (CODESYS, TwinCAT).

use onescan_iec::Dialect;

use crate::rig::{Rig, findings_in};

const UNITS: &str = "
FUNCTION Class : UDINT VAR_INPUT v : ANY; END_VAR Class := TO_UDINT(v.TypeClass) + 1000 * TO_UDINT(v.diSize); END_FUNCTION
FUNCTION Same : BOOL VAR_INPUT a, b : ANY; END_VAR VAR i : DINT; END_VAR
  Same := a.TypeClass = b.typeclass AND a.diSize = b.DISIZE;
  IF Same THEN FOR i := 0 TO a.diSize - 1 DO Same := Same AND a.pValue[i] = b.pValue[i]; END_FOR; END_IF; END_FUNCTION
FUNCTION Number : LREAL VAR_INPUT x : ANY_NUM; END_VAR VAR pi : POINTER TO INT; pr : POINTER TO REAL; END_VAR
  IF x.TypeClass = __SYSTEM.TYPE_CLASS.TYPE_INT THEN pi := x.pValue; Number := pi^;
  ELSIF x.TypeClass = __SYSTEM.TYPE_CLASS.TYPE_REAL THEN pr := x.pValue; Number := pr^; ELSE Number := -1; END_IF; END_FUNCTION
FUNCTION Passed : UDINT VAR_INPUT x : ANY_NUM; END_VAR Passed := Class(x); END_FUNCTION
TYPE S : STRUCT a : INT; b : LREAL; END_STRUCT END_TYPE
TYPE E : (One, Two) BYTE; END_TYPE
FUNCTION_BLOCK Zero
  METHOD Clear VAR_INPUT v : ANY_INT; END_VAR MEMSET(v.pValue, 0, TO_UDINT(v.diSize)); END_METHOD
END_FUNCTION_BLOCK
FUNCTION_BLOCK Watch VAR_INPUT v : ANY; END_VAR VAR_OUTPUT size : DINT; first : BYTE; END_VAR
  size := v.diSize; first := v.pValue^; END_FUNCTION_BLOCK
";

fn rig(dialect: Dialect, declarations: &str, statements: &str) -> Rig {
    let mut rig =
        Rig::in_dialect(dialect, &format!("{UNITS}PROGRAM P VAR {declarations} END_VAR {statements} END_PROGRAM"));
    rig.scan().expect("no fault");
    rig
}

#[test]
fn an_input_of_any_type_is_its_class_address_and_size() {
    for dialect in [Dialect::Codesys, Dialect::TwinCat] {
        let types = [
            ("BOOL", 1_000),
            ("BYTE", 1_002),
            ("INT", 2_007),
            ("ULINT", 8_013),
            ("LREAL", 8_015),
            ("STRING(9)", 10_016),
            ("WSTRING(4)", 10_017),
            ("LTIME", 8_037),
            ("E", 1_025),
            ("ARRAY [0..3] OF INT", 8_026),
            ("S", 16_028),
            ("POINTER TO INT", 4_022),
            ("INT (1..5)", 2_024),
        ];
        for (ty, expected) in types {
            let rig = rig(dialect, &format!("v : {ty}; n : UDINT;"), "n := Class(v);");
            assert_eq!(rig.int("P.n"), expected, "{ty} in {dialect}");
        }
    }
}

#[test]
fn units_read_and_write_through_the_address() {
    let rig = rig(
        Dialect::TwinCat,
        "a, b : S; x, y, z : BOOL; i : INT := -5; r : REAL := 2.5; d : DINT := 7; p, q, s : LREAL; n : UDINT; o : Zero; w : Watch;
         list : ARRAY [1..3] OF BYTE := [1, 2, 3]; k : INT := 2; size : DINT; first : BYTE; f : BOOL := TRUE;",
        "x := Same(a, b); a.b := 1.5; y := Same(a, b); z := Same(i, d); p := Number(i); q := Number(r); s := Number(d);
         n := Passed(r); o.Clear(d); w(v := list[k], size => size, first => first);",
    );
    assert_eq!(["x", "y", "z"].map(|name| rig.bool(&format!("P.{name}"))), [true, false, false]);
    assert_eq!(["p", "q", "s"].map(|name| rig.real(&format!("P.{name}"))), [-5.0, 2.5, -1.0]);
    assert_eq!(["n", "d", "size", "first"].map(|name| rig.int(&format!("P.{name}"))), [4_014, 0, 1, 2]);
}

#[test]
fn wrong_generic_inputs_are_reported() {
    let reported = |statement: &str| {
        let text = format!(
            "{UNITS}PROGRAM P VAR b : BOOL; n : UDINT; r : LREAL; t : STRING; z : Zero; END_VAR\n{statement}\nEND_PROGRAM"
        );
        findings_in(Dialect::Codesys, &text)
            .to_string()
            .lines()
            .find(|line| line.contains("error"))
            .unwrap_or_default()
            .to_owned()
    };
    let statements = [
        "n := Class(5);",
        "n := Class(n + 1);",
        "r := Number(b);",
        "r := Number(t);",
        "n := Class();",
        "z.Clear(v := r);",
        "r := Number(x := n, y := 1);",
    ];
    let units = [
        "FUNCTION F VAR_IN_OUT v : ANY; END_VAR END_FUNCTION",
        "FUNCTION F VAR v : ANY_NUM; END_VAR END_FUNCTION",
        "FUNCTION F : ANY VAR_INPUT v : INT; END_VAR END_FUNCTION",
        "PROGRAM P VAR_INPUT v : ANY; END_VAR END_PROGRAM",
        "FUNCTION F VAR_INPUT v : ARRAY [0..1] OF ANY_INT; END_VAR END_FUNCTION",
    ];
    let units = units.map(|unit| format!("{unit}\n    {}", findings_in(Dialect::Codesys, unit)));
    let statements = statements.map(|statement| format!("{statement}\n    {}", reported(statement)));
    insta::assert_snapshot!([&statements[..], &units[..]].concat().join("\n"));
}

#[test]
fn a_project_s_own_declarations_go_before() {
    let text = "TYPE T_MaxString : STRING(10); END_TYPE TYPE AnyType : STRUCT a : INT; END_STRUCT END_TYPE
        PROGRAM P VAR s : T_MaxString; a : AnyType; p : T_AmsPort; TYPE_INT : INT; END_VAR
        s := 'x'; a.a := 1; p := 851; TYPE_INT := 3; END_PROGRAM";
    let rig = Rig::in_dialect(Dialect::TwinCat, text);
    assert_eq!(rig.variable("P.s").type_name, "STRING[10]");
    let values = "TYPE Kind : (TYPE_BOOL, TYPE_REAL); END_TYPE (* not ANY *) PROGRAM P VAR k : Kind; END_VAR k := TYPE_REAL; END_PROGRAM";
    assert_eq!(Rig::in_dialect(Dialect::TwinCat, values).variable("P.k").type_name, "Kind");
}
