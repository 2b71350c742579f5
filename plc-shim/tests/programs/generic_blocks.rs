//! Generic blocks of CODESYS and TwinCAT: `VAR_GENERIC CONSTANT`, `FB<8>`.

use onescan_iec::Dialect;
use onescan_iec::syntax::printer::print_unit;
use onescan_iec::syntax::{FileId, parse_in};

use crate::rig::{Rig, findings_in};

fn findings(text: &str) -> String {
    findings_in(Dialect::Codesys, text).to_string()
}

/// Blocks in one another: a base, elements, constants of the unit and of the project, and what has none by itself.
const LISTS: &str = "VAR_GLOBAL CONSTANT
    SIZE : INT := 4;
END_VAR

INTERFACE ICount
METHOD Count : DINT
END_METHOD
END_INTERFACE

FUNCTION_BLOCK Base
VAR_GENERIC CONSTANT
    n : UDINT := 1;
END_VAR
VAR_OUTPUT
    total : UDINT;
END_VAR
    total := n;
END_FUNCTION_BLOCK

FUNCTION_BLOCK List
VAR_GENERIC CONSTANT
    length : DINT;
END_VAR
EXTENDS Base<(length + 1)> IMPLEMENTS ICount
VAR
    items : ARRAY [0..length - 1] OF INT;
    used : DINT;
END_VAR
METHOD Add : BOOL
VAR_INPUT x : INT; END_VAR
    IF used < length THEN
        items[used] := x;
        used := used + 1;
        Add := TRUE;
    END_IF
END_METHOD
METHOD Count : DINT
    Count := used;
END_METHOD
    SUPER^();
END_FUNCTION_BLOCK

FUNCTION_BLOCK Short EXTENDS List<2>
END_FUNCTION_BLOCK

FUNCTION_BLOCK Two
VAR_GENERIC CONSTANT a, b : INT := 1; END_VAR
VAR inner : List<(a * b)>; t : ARRAY [1..a, 1..b] OF BYTE; END_VAR
VAR_OUTPUT r : DINT; s : UDINT; END_VAR
    inner();
    r := SIZEOF(t);
    s := inner.total;
END_FUNCTION_BLOCK

TYPE Holder : STRUCT a : List<SIZE>; END_STRUCT END_TYPE

PROGRAM Main
VAR CONSTANT many : INT := 3; END_VAR
VAR
    small : Short;
    four : List<SIZE>;
    five : List<5>;
    h : Holder;
    two : Two<2, many>;
    alike : ARRAY [0..1] OF Two<2,3>;
    i : ICount;
    n, added : DINT;
    bytes : DINT;
    s : ARRAY [0..3] OF DINT;
    t : UDINT;
END_VAR
    FOR n := 1 TO 10 DO
        IF small.Add(1) THEN added := added + 1; END_IF
        IF four.Add(1) THEN added := added + 1; END_IF
        IF five.Add(1) THEN added := added + 1; END_IF
        h.a.Add(1);
    END_FOR
    i := small; s[0] := i.Count();
    i := four; s[1] := i.Count();
    i := five; s[2] := i.Count();
    i := h.a; s[3] := i.Count();
    h.a := four;
    bytes := SIZEOF(two) - SIZEOF(alike[1]);
    two();
    alike[0] := two;
    t := two.s + small.total;
    four(); t := t + four.total;
END_PROGRAM
";

#[test]
fn each_list_of_constants_makes_a_block_of_its_own() {
    let mut rig = Rig::in_dialect(Dialect::Codesys, LISTS);
    rig.scan().expect("no fault");
    assert_eq!(rig.int("Main.added"), 2 + 4 + 5);
    let counted: Vec<_> = (0..4).map(|index| rig.int(&format!("Main.s[{index}]"))).collect();
    assert_eq!(counted, [2, 4, 5, 4]);
    assert_eq!((rig.int("Main.two.r"), rig.int("Main.two.s")), (6, 7));
    assert_eq!(rig.int("Main.bytes"), 0, "the same constants, the same block");
    assert_eq!(rig.int("Main.alike[0].r"), 6, "a copy");
    assert_eq!(rig.int("Main.t"), 7 + 5);
    assert_eq!(rig.int("Main.five.items[4]"), 1);
    assert_eq!(rig.int("Main.h.a.used"), 4);
}

#[test]
fn a_text_of_generic_blocks_is_printed_as_it_was_read() {
    let tree = |text: &str| {
        let parsed = parse_in(Dialect::Codesys, FileId(0), text);
        assert!(parsed.diagnostics.is_empty(), "{:?}", parsed.diagnostics);
        print_unit(&parsed.unit)
    };
    let printed = tree(LISTS);
    assert!(printed.contains("List<(a*b)>") && printed.contains("EXTENDS Base<(length+1)>"), "{printed}");
    assert_eq!(tree(&printed), printed);
}

#[test]
fn wrong_constants_of_generic_blocks_are_reported() {
    let block = "FUNCTION_BLOCK F
VAR_GENERIC CONSTANT n : USINT := 1; END_VAR
VAR a : ARRAY [0..n] OF BYTE; END_VAR
    a[0] := 1;
END_FUNCTION_BLOCK
";
    let used =
        |uses: &str| findings(&format!("{block}PROGRAM P VAR k : INT; {uses} END_VAR f1(); k := k + 1; END_PROGRAM"));
    insta::assert_snapshot!(used("f1 : F<1, 2>;"), @"test.st:6:29: error[C0303]: `F` has one generic constant, 2 are given");
    insta::assert_snapshot!(used("f1 : F<k>;"), @"test.st:6:31: error[T0204]: a constant is wanted here");
    insta::assert_snapshot!(used("f1 : F<300>;"), @"test.st:6:31: error[T0202]: 300 does not fit USINT (0 to 255)");
    insta::assert_snapshot!(used("f1 : F<1.5>;"), @"test.st:6:31: error[T0201]: an integer is wanted, this is a real number");
    insta::assert_snapshot!(used("f1 : TON<1>;"), @"test.st:6:29: error[C0303]: `TON` is not a generic block");
    insta::assert_snapshot!(used("f1 : G<1>;"), @"test.st:6:29: error[N0103]: type `G<1>` is not declared");
    insta::assert_snapshot!(used("f1 : F<>;"), @"test.st:6:30: error[S0101]: `;` expected, found `<>`");
    insta::assert_snapshot!(used("f1 : F<2>;"), @"");
    let mistake =
        "FUNCTION_BLOCK F VAR_GENERIC CONSTANT n : INT := 1; END_VAR VAR a : BOOL; END_VAR a := n; END_FUNCTION_BLOCK
PROGRAM P VAR x : F<2>; y : F<3>; END_VAR x(); y(); END_PROGRAM";
    insta::assert_snapshot!(findings(mistake), @"test.st:1:88: error[T0201]: BOOL is wanted, this is INT (convert it with INT_TO_BOOL)");
    let endless = "FUNCTION_BLOCK F VAR_GENERIC CONSTANT n : INT := 1; END_VAR VAR a : POINTER TO F<(n + 1)>; END_VAR END_FUNCTION_BLOCK
PROGRAM P VAR x : F<2>; END_VAR x(); END_PROGRAM";
    insta::assert_snapshot!(findings(endless), @"test.st:1:16: error[S0104]: `F<66>` is a generic block that is made of ever more");
}
