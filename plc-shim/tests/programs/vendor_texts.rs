//! Texts of CODESYS and TwinCAT: functions of strings take and give 255 characters, and an enumeration shows its names.

use onescan_iec::{Code, Dialect};

use crate::rig::{Rig, findings_in};

const DIALECTS: [Dialect; 2] = [Dialect::Codesys, Dialect::TwinCat];

fn codes(dialect: Dialect, text: &str) -> Vec<Code> {
    findings_in(dialect, text).iter().map(|found| found.code).collect()
}

/// CODESYS: library Standard; TwinCAT: `Tc2_Standard`. Each function, with what it takes and what it gives.
#[test]
fn functions_take_and_give_255_characters() {
    let text = "PROGRAM P
        VAR
            i : INT; a, b : STRING(200); long, made : STRING(400); short : STRING(255);
            joined, counted, there, beyond, head, tail, part, inserted, deleted, replaced, first : INT;
        END_VAR
        a := ''; FOR i := 1 TO 20 DO a := CONCAT(a, '0123456789'); END_FOR
        b := a;
        FOR i := 0 TO 398 DO long[i] := 120; END_FOR
        long[399] := 121;
        joined := LEN(CONCAT(a, b));
        counted := LEN(long);
        there := FIND(long, 'x');
        beyond := FIND(long, 'y');
        made := LEFT(long, 300);
        head := 0; WHILE made[head] <> 0 DO head := head + 1; END_WHILE
        made := RIGHT(long, 1);
        tail := made[0];
        part := LEN(MID(long, 10, 300));
        inserted := LEN(INSERT(a, b, 10));
        deleted := LEN(DELETE(long, 5, 1));
        replaced := LEN(REPLACE(a, b, 10, 1));
        short := CONCAT(a, b);
        first := LEN(short);
    END_PROGRAM";
    let names = ["joined", "counted", "there", "beyond", "head", "tail", "part", "inserted", "deleted", "replaced"];
    for dialect in DIALECTS {
        let mut rig = Rig::in_dialect(dialect, text);
        rig.scan().expect("it runs");
        let found = names.map(|name| rig.int(&format!("P.{name}")));
        assert_eq!(found, [255, 255, 1, 0, 255, 120, 0, 255, 250, 255], "{dialect}");
        assert_eq!(rig.int("P.first"), 255, "{dialect}");
    }
    let mut rig = Rig::new(
        "PROGRAM P VAR a, b : STRING[200]; n : INT; END_VAR a := 'ab'; WHILE LEN(a) < 200 DO a := CONCAT(a, 'c'); END_WHILE;
         b := a; n := LEN(CONCAT(a, b)); END_PROGRAM",
    );
    rig.scan().expect("it runs");
    assert_eq!(rig.int("P.n"), 400, "the standard cuts nothing");
}

#[test]
fn a_cut_that_counts_is_reported() {
    let declared = "VAR a, b : STRING(200); long : STRING(400); short : STRING(255); n : INT; c : BOOL; END_VAR";
    let is_reported = |dialect, statement: &str| {
        let text = format!("PROGRAM P {declared} {statement} END_PROGRAM");
        codes(dialect, &text).contains(&Code::CutText)
    };
    for dialect in DIALECTS {
        for statement in [
            "n := LEN(CONCAT(a, b));",
            "n := LEN(long);",
            "n := FIND(long, 'x');",
            "long := CONCAT(a, b);",
            "long := CONCAT(long, 'x');",
            "long := LEFT(long, n);",
            "short := RIGHT(long, 5);",
            "short := RIGHT(CONCAT(a, b), 5);",
            "short := MID(long, 5, 300);",
            "short := DELETE(long, 5, 1);",
            "c := CONCAT(a, b) = long;",
            "n := STRING_TO_INT(CONCAT(a, b));",
        ] {
            assert!(is_reported(dialect, statement), "{dialect}: {statement}");
        }
        // The end is cut off that a variable would cut off as well, or that nobody asks for.
        for statement in [
            "short := CONCAT(a, b);",
            "short := CONCAT(CONCAT(a, b), 'x');",
            "a := LEFT(long, n);",
            "long := LEFT(long, 5);",
            "long := long;",
            "n := LEN(a);",
            "c := long = 'x';",
        ] {
            assert!(!is_reported(dialect, statement), "{dialect}: {statement}");
        }
    }
    assert!(!is_reported(Dialect::Matiec, "n := LEN(CONCAT(a, b));"));
}

/// The example of Beckhoff's manual; a value without a name is its number.
#[test]
fn an_enumeration_shows_its_names() {
    let text = "{attribute 'qualified_only'}
        {attribute 'to_string'}
        TYPE E_Sample : (eInit := 0, eStart, eStop, far := 1000); END_TYPE
        TYPE {attribute 'to_string'} Bits : (low := 16#80, high := 16#FF) BYTE; Plain : (p, q); END_TYPE
        TYPE S : STRUCT inner : E_Sample := E_Sample.eStop; END_STRUCT; END_TYPE
        FUNCTION Shown : STRING VAR_INPUT e : E_Sample; END_VAR Shown := TO_STRING(e); END_FUNCTION
        PROGRAM P
        VAR
            eSample, calls : E_Sample; s : S; b : Bits := Bits.high; plain : Plain := Plain.q; n : INT; w : WSTRING;
            none, component, member, handed, byte_name, other, unnamed, nameless, low, far : STRING;
            cells : ARRAY [0..1] OF E_Sample := [E_Sample.eStart, E_Sample.eInit]; cell : STRING;
        END_VAR
            none := TO_STRING(eSample);
            component := TO_STRING(E_Sample.eStart);
            w := TO_WSTRING(E_Sample.eStop);
            member := TO_STRING(s.inner);
            handed := Shown(E_Sample.far);
            byte_name := TO_STRING(b);
            other := TO_STRING(plain);
            calls := 7;
            unnamed := TO_STRING(calls);
            b := 16#7F;
            nameless := TO_STRING(b);
            b := 16#80;
            low := CONCAT('<', CONCAT(TO_STRING(b), '>'));
            cell := TO_STRING(cells[n]);
            n := 1;
            far := INT_TO_STRING(E_Sample.far);
        END_PROGRAM";
    let wanted = [
        ("none", "eInit"),
        ("component", "eStart"),
        ("w", "eStop"),
        ("member", "eStop"),
        ("handed", "far"),
        ("byte_name", "high"),
        ("other", "1"),
        ("unnamed", "7"),
        ("nameless", "127"),
        ("low", "<low>"),
        ("cell", "eStart"),
        ("far", "1000"),
    ];
    for dialect in DIALECTS {
        assert!(!codes(dialect, text).contains(&Code::AttributeWithoutEffect), "{dialect}");
        let mut rig = Rig::in_dialect(dialect, text);
        rig.scan().expect("it runs");
        for (name, shown) in wanted {
            assert_eq!(rig.text(&format!("P.{name}")), shown, "{dialect} {name}");
        }
    }
    let mut rig = Rig::new(
        "TYPE {attribute 'to_string'} E : (a, b); END_TYPE PROGRAM P VAR e : E := b; s : STRING; END_VAR
         s := TO_STRING(e); END_PROGRAM",
    );
    rig.scan().expect("it runs");
    assert_eq!(rig.text("P.s"), "1", "an attribute of others is a remark");
}

/// As many values as error codes have: the tree of them is low.
#[test]
fn many_names_are_found() {
    let names: Vec<String> = (0..1000).map(|at| format!("e{at} := {}", at * 3)).collect();
    let text = format!(
        "{{attribute 'to_string'}} TYPE Codes : ({}); END_TYPE
         PROGRAM P VAR c : Codes; last, none : STRING; END_VAR c := 2997; last := TO_STRING(c); c := 2998; none := TO_STRING(c);
         END_PROGRAM",
        names.join(", ")
    );
    let mut rig = Rig::in_dialect(Dialect::TwinCat, &text);
    rig.scan().expect("it runs");
    assert_eq!(["last", "none"].map(|name| rig.text(&format!("P.{name}"))), ["e999", "2998"]);
}
