//! References (3rd ed. 6.4.4.10, Table 12), and the pointers of vendors.

use crate::rig::{Rig, findings};
use onescan_iec::Dialect;

fn run(text: &str) -> Rig {
    let mut rig = Rig::new(text);
    rig.scan().unwrap_or_else(|fault| panic!("{fault}"));
    rig
}

fn fault(text: &str) -> String {
    let mut rig = Rig::new(text);
    let fault = rig.scan().expect_err("the program fails");
    assert_eq!(rig.scan(), Err(fault.clone()));
    fault.to_string()
}

#[test]
fn this_is_a_pointer_to_the_own_instance_and_its_bases() {
    let text = "FUNCTION_BLOCK Base VAR n : INT; p : POINTER TO Base; END_VAR
        METHOD Add VAR_INPUT by1 : INT; END_VAR n := n + by1; END_METHOD
        METHOD Me : POINTER TO Base Me := THIS; END_METHOD
        METHOD Keep p := THIS; END_METHOD END_FUNCTION_BLOCK
        FUNCTION_BLOCK Derived EXTENDS Base VAR q : POINTER TO Base; d : POINTER TO Derived; END_VAR
        METHOD Own q := THIS; d := THIS; q := d; q^.Add(10); d^.Add(100); END_METHOD END_FUNCTION_BLOCK
        PROGRAM P VAR b : Base; d : Derived; p : POINTER TO Base; END_VAR
        b.Keep(); p := b.Me(); p^.Add(1); d.Own(); END_PROGRAM";
    for dialect in [onescan_iec::Dialect::Codesys, onescan_iec::Dialect::TwinCat] {
        let mut rig = Rig::in_dialect(dialect, text);
        rig.scan().expect("no fault");
        assert_eq!((rig.int("P.b.n"), rig.int("P.d.n")), (1, 110), "{dialect}");
        let found = crate::rig::findings_in(dialect, &text.replace("d := THIS; q := d;", "d := THIS; d := q;"));
        assert!(found.to_string().contains("R0906"), "{found}");
        let found = crate::rig::findings_in(dialect, &text.replace("p := b.Me();", "p := b;"));
        assert!(found.to_string().contains("T0201"), "{found}");
    }
}

#[test]
fn iec3_6_4_4_10_table_12_references_are_declared_assigned_and_followed() {
    let rig = run("TYPE R : REF_TO INT; S : STRUCT a, b : INT; END_STRUCT END_TYPE
        VAR_GLOBAL g : INT := 40; r0 : R := REF(g); END_VAR
        PROGRAM P VAR a : ARRAY [1..3] OF INT := [1, 2, 3]; s : S := (a := 5, b := 6); r : REF_TO INT; q : R := NULL;
          rs : REF_TO S; ra : REF_TO ARRAY [1..3] OF INT; list : ARRAY [0..1] OF REF_TO INT; i, x, y : INT;
          same, none, other : BOOL; END_VAR
        none := q = NULL; i := 2; r := REF(a[i]); x := r^; r^ := r^ + 10; q := r; same := q = r; q := REF(s.b);
        other := q <> r AND NULL <> q; rs := REF(s); rs^.a := 50; ra := REF(a); ra^[i + 1] := rs^.b; list[0] := REF(rs^.b); list[i - 1] := r0;
        y := list[1]^ + list[0]^; r0^ := 41; END_PROGRAM");
    assert_eq!((rig.int("P.x"), rig.int("P.a[2]"), rig.int("P.a[3]"), rig.int("P.s.a")), (2, 12, 6, 50));
    assert_eq!((rig.bool("P.none"), rig.bool("P.same"), rig.bool("P.other")), (true, true, true));
    assert_eq!((rig.int("P.y"), rig.int("g")), (46, 41));
    assert_eq!((rig.variable("P.r").type_name.as_str(), rig.variable("P.r").size), ("REF_TO INT", 4));
}

#[test]
fn iec3_6_4_4_10_structures_refer_to_themselves() {
    let rig = run("TYPE Node : STRUCT value : INT; next : REF_TO Node; owner : REF_TO Tree; END_STRUCT;
          Tree : STRUCT first : REF_TO Node; count : INT; END_STRUCT; END_TYPE
        PROGRAM P VAR nodes : ARRAY [1..4] OF Node; tree : Tree; now : REF_TO Node; i, sum : INT; END_VAR
        tree.first := NULL;
        FOR i := 1 TO 4 DO nodes[i].value := i * i; nodes[i].next := tree.first; nodes[i].owner := REF(tree);
          tree.first := REF(nodes[i]); END_FOR;
        now := tree.first; WHILE now <> NULL DO sum := sum + now^.value; now^.owner^.count := now^.owner^.count + 1; now := now^.next; END_WHILE;
        END_PROGRAM");
    assert_eq!((rig.int("P.sum"), rig.int("P.tree.count")), (30, 4));
}

#[test]
fn iec3_6_4_4_10_references_go_in_and_out_of_units_and_call_instances() {
    let rig = run("FUNCTION_BLOCK Counter VAR_INPUT step : INT; END_VAR VAR_OUTPUT n : INT; END_VAR n := n + step; END_FUNCTION_BLOCK
        FUNCTION Greater : REF_TO INT VAR_INPUT a, b : REF_TO INT; END_VAR
        IF a^ > b^ THEN Greater := a; ELSE Greater := b; END_IF; END_FUNCTION
        FUNCTION_BLOCK Adder VAR_INPUT sum : REF_TO INT; END_VAR VAR c : INT := 1; END_VAR sum^ := sum^ + c; END_FUNCTION_BLOCK
        FUNCTION_BLOCK Hand VAR_INPUT c : REF_TO Counter; END_VAR c^(step := 3); END_FUNCTION_BLOCK
        PROGRAM P VAR x : INT := 3; y : INT := 7; n : INT; add : Adder; c : Counter; h : Hand; r : REF_TO Counter; END_VAR
        n := Greater(REF(x), REF(y))^; add(sum := REF(x)); r := REF(c); r^(step := 2); h(c := r); n := n * 10 + r^.n;
        END_PROGRAM");
    assert_eq!((rig.int("P.n"), rig.int("P.x"), rig.int("P.c.n")), (75, 4, 5));
}

#[test]
fn iec3_6_6_6_7_assignment_attempts_give_null_for_another_type() {
    let rig = run("PROGRAM P VAR a : INT; r, s : REF_TO INT; d : REF_TO DINT; l : DINT; x, y, z : BOOL; END_VAR
        r := REF(a); d := REF(l); s ?= r; x := s = r; s ?= d; y := s = NULL; d ?= NULL; z := d = NULL; END_PROGRAM");
    assert_eq!((rig.bool("P.x"), rig.bool("P.y"), rig.bool("P.z")), (true, true, true));
}

#[test]
fn iec3_6_4_4_10_4_the_use_of_null_stops_the_plc() {
    insta::assert_snapshot!(fault("PROGRAM P\nVAR r : REF_TO INT; x : INT; END_VAR\n  x := 1 +\n    r^;\nEND_PROGRAM"),
        @"use of a NULL reference at test.st:4:5 in P, t_v = 0.010 s");
    insta::assert_snapshot!(fault("PROGRAM P\nVAR r : REF_TO INT; x : INT; END_VAR\n  r^ := 1;\nEND_PROGRAM"),
        @"use of a NULL reference at test.st:3:3 in P, t_v = 0.010 s");
    insta::assert_snapshot!(fault("TYPE S : STRUCT a : LREAL; n : REF_TO S; END_STRUCT END_TYPE\nPROGRAM P\nVAR r : REF_TO S; s, t : S; END_VAR\n  r := REF(s);\n  r^.n^.a := 1.0;\nEND_PROGRAM"),
        @"use of a NULL reference at test.st:5:3 in P, t_v = 0.010 s");
    insta::assert_snapshot!(fault("TYPE S : STRUCT a : LREAL; n : REF_TO S; END_STRUCT END_TYPE\nPROGRAM P\nVAR r : REF_TO S; s, t : S; END_VAR\n  t := r^;\nEND_PROGRAM"),
        @"use of a NULL reference at test.st:4:8 in P, t_v = 0.010 s");
    insta::assert_snapshot!(fault("PROGRAM P\nVAR r : REF_TO TON; END_VAR\n  r^(IN := TRUE);\nEND_PROGRAM"),
        @"use of a NULL reference at test.st:3:3 in P, t_v = 0.010 s");
    insta::assert_snapshot!(fault("PROGRAM P\nVAR r : REFERENCE TO INT; END_VAR\n  r := 1;\nEND_PROGRAM"),
        @"use of a NULL reference at test.st:3:3 in P, t_v = 0.010 s");
}

#[test]
fn a_pointer_out_of_memory_stops_the_plc() {
    insta::assert_snapshot!(fault("PROGRAM P\nVAR p : POINTER TO DINT; END_VAR\n  p := 16#FFFFFFFF;\n  p^ := 1;\nEND_PROGRAM"),
        @"pointer out of memory at test.st:4:3 in P, t_v = 0.010 s");
    insta::assert_snapshot!(fault("PROGRAM P\nVAR p : POINTER TO BYTE; x : BYTE; END_VAR\n  p := ADR(x);\n  WHILE TRUE DO\n    p^ := 0; p := p + 1;\n  END_WHILE;\nEND_PROGRAM"),
        @"pointer out of memory at test.st:5:5 in P, t_v = 0.010 s");
    insta::assert_snapshot!(fault("PROGRAM P\nVAR p : POINTER TO INT; i : DINT; END_VAR\n  p := 1000; i := -501;\n  p[i] := 1;\nEND_PROGRAM"),
        @"pointer out of memory at test.st:4:3 in P, t_v = 0.010 s");
}

#[test]
fn pointers_of_vendors_are_numbers_of_bytes() {
    let rig = run("TYPE S : STRUCT a : INT; b : DINT; END_STRUCT END_TYPE
        FUNCTION Sum : DINT VAR_INPUT p : POINTER TO INT; n : INT; END_VAR VAR i : INT; END_VAR
        FOR i := 0 TO n - 1 DO Sum := Sum + p[i]; END_FOR; END_FUNCTION
        FUNCTION Low : BYTE VAR_INPUT w : WORD; END_VAR VAR p : POINTER TO BYTE; END_VAR p := ADR(w); Low := p^; END_FUNCTION
        PROGRAM P VAR a : ARRAY [1..4] OF INT := [1, 2, 3, 4]; p, q : POINTER TO INT; b : POINTER TO BYTE; s : S; ps : POINTER TO S;
          n : DINT; d : DWORD; u, size : UDINT; x, y, z : BOOL; w : WORD; k, m : INT; END_VAR
        n := Sum(ADR(a), 4); p := ADR(a[2]); k := p^; p := p + SIZEOF(INT); p^ := 30; q := ADR(a); u := p - q; d := ADR(a);
        x := p > q; y := d = q; z := p <> 0; q := d; q := q + 6; m := q^; b := ADR(w); b[1] := 16#12; b^ := 16#34;
        ps := ADR(s); ps^.b := SIZEOF(S); size := SIZEOF(a) + SIZEOF(s.b); q := 0; y := y AND q = NULL; s.a := BYTE_TO_INT(Low(16#FF07));
        END_PROGRAM");
    assert_eq!((rig.int("P.n"), rig.int("P.k"), rig.int("P.a[3]"), rig.int("P.u")), (10, 2, 30, 4));
    assert_eq!((rig.bool("P.x"), rig.bool("P.y"), rig.bool("P.z")), (true, true, true));
    assert_eq!(
        (rig.int("P.m"), rig.int("P.w"), rig.int("P.s.b"), rig.int("P.size"), rig.int("P.s.a")),
        (4, 0x1234, 8, 12, 7)
    );
    assert_eq!(rig.int("P.d"), i64::from(rig.variable("P.a").offset));
}

#[test]
fn functions_of_vendors_work_on_bytes_at_addresses() {
    let rig = run("PROGRAM P VAR a : ARRAY [0..3] OF INT := [1, 2, 3, 4]; b : ARRAY [0..3] OF INT; c : ARRAY [0..3] OF INT; n, size : UDINT;
          less, same, more : DINT; x : __XWORD; END_VAR
        n := MEMCPY(ADR(b), ADR(a), SIZEOF(a)); MEMMOVE(destAddr := ADR(a[1]), srcAddr := ADR(a), n := 6); MEMSET(ADR(c), 16#11, 4);
        less := MEMCMP(ADR(a), ADR(b), SIZEOF(a)); same := MEMCMP(ADR(a), ADR(b), 2); SysMemSet(ADR(c[3]), 255, 2);
        more := MEMCMP(ADR(c), ADR(a), 8); x := ADR(a); size := SIZEOF(x); MEMCPY(ADR(a), ADR(b), 0); END_PROGRAM");
    let list = |name: &str| [0, 1, 2, 3].map(|index| rig.int(&format!("P.{name}[{index}]")));
    assert_eq!((list("a"), list("b"), list("c")), ([1, 1, 2, 3], [1, 2, 3, 4], [0x1111, 0x1111, 0, -1]));
    assert_eq!((rig.int("P.n"), rig.int("P.size")), (8, 8));
    assert_eq!((rig.int("P.less"), rig.int("P.same"), rig.int("P.more")), (-1, 0, 1));
    insta::assert_snapshot!(fault("PROGRAM P\nVAR a : INT; END_VAR\n  MEMSET(ADR(a), 0, 16#FFFFFFFF);\nEND_PROGRAM"),
        @"pointer out of memory at test.st:3:3 in P, t_v = 0.010 s");
    insta::assert_snapshot!(fault("PROGRAM P\nVAR a : INT; p : POINTER TO INT; END_VAR\n  MEMCPY(ADR(a), p, 2);\nEND_PROGRAM"),
        @"use of a NULL reference at test.st:3:3 in P, t_v = 0.010 s");
}

#[test]
fn this_alone_is_a_pointer_and_literals_have_addresses() {
    let text = "FUNCTION_BLOCK F VAR_OUTPUT same, alike : BOOL; n : LWORD; END_VAR
          VAR p : POINTER TO F; q : POINTER TO BYTE; x : INT := 7; END_VAR
        p := THIS; q := THIS; same := p = THIS; alike := THIS^.x = p^.x; n := THIS; p^.x := p^.x + 1; END_FUNCTION_BLOCK
        PROGRAM P VAR f1 : F; t : POINTER TO BYTE; b, c, d, e : BYTE; own : BOOL; END_VAR
        f1(); own := f1.n = ADR(f1); t := ADR('abc'); b := t^; c := t[2]; d := t[3]; t := ADR(''); e := t^; END_PROGRAM";
    for dialect in [Dialect::Codesys, Dialect::TwinCat] {
        let mut rig = Rig::in_dialect(dialect, text);
        rig.scan().expect("no fault");
        let flags = ["P.f1.same", "P.f1.alike", "P.own"].map(|name| rig.bool(name));
        assert_eq!((flags, rig.int("P.f1.x")), ([true; 3], 8), "{dialect}");
        assert_eq!(["P.b", "P.c", "P.d", "P.e"].map(|name| rig.int(name)), [0x61, 0x63, 0, 0], "{dialect}");
    }
}

#[test]
fn types_as_wide_as_pointers_are_as_wide_as_the_targets_registers() {
    let text = "PROGRAM P VAR x : __XWORD; u : __UXINT; i : __XINT; p : PVOID; size, bits : INT; small : BOOL; t : DINT; END_VAR
        t := -2; size := SIZEOF(x) + SIZEOF(u) + SIZEOF(i) + SIZEOF(p); i := TO___XINT(t); x := ADR(t); small := i < 0 AND x > 0;
        bits := TO_INT(__SYSTEM.Constants.nRegisterSize); END_PROGRAM";
    let mut rig = Rig::in_dialect(Dialect::Codesys, text);
    rig.scan().expect("no fault");
    assert_eq!((rig.int("P.size"), rig.bool("P.small"), rig.int("P.bits")), (32, true, 64));
    let rig = run(&format!("{{dialect 'codesys' 32}}\n{}", text.replace("i := TO___XINT(t)", "i := t")));
    assert_eq!((rig.int("P.size"), rig.bool("P.small")), (16, true));
}

#[test]
fn references_of_vendors_stand_for_what_they_refer_to() {
    let rig = run("FUNCTION_BLOCK B VAR_INPUT r : REFERENCE TO INT; END_VAR VAR_OUTPUT valid : BOOL; END_VAR
        valid := __ISVALIDREF(r); IF valid THEN r := r + 1; END_IF; END_FUNCTION_BLOCK
        FUNCTION Twice VAR_INPUT x : REFERENCE TO INT; END_VAR x := 2 * x; END_FUNCTION
        FUNCTION Local : INT VAR n : INT; r : REFERENCE TO INT; END_VAR n := 4; r REF= n; r := r + 1; Twice(n); Local := n; END_FUNCTION
        PROGRAM P VAR a : ARRAY [0..2] OF INT := [1, 2, 3]; i : INT := 1; r, q : REFERENCE TO INT; b, c : B; t : REFERENCE TO ARRAY [0..2] OF INT;
          none, taken, back : BOOL; x, y : INT; f : REFERENCE TO B; END_VAR
        none := __ISVALIDREF(r); r REF= a[i]; taken := __ISVALIDREF(r); r := r * 10; q REF= r; x := q; t REF= a; t[0] := 7;
        f REF= b; f(r := a[2]); y := Local(); Twice(r); c(); q REF= NULL; back := NOT __ISVALIDREF(q); END_PROGRAM");
    assert_eq!((rig.int("P.a[0]"), rig.int("P.a[1]"), rig.int("P.a[2]")), (7, 40, 4));
    assert_eq!((rig.bool("P.none"), rig.bool("P.taken"), rig.bool("P.back"), rig.int("P.x")), (false, true, true, 20));
    assert_eq!((rig.int("P.y"), rig.bool("P.b.valid"), rig.bool("P.c.valid")), (10, true, false));
}

#[test]
fn a_variable_whose_address_is_taken_is_used_and_written() {
    let text = "PROGRAM P VAR a, b, c : INT; p : POINTER TO INT; r : REFERENCE TO INT; s : REF_TO INT; END_VAR
        VAR_OUTPUT o : INT; END_VAR p := ADR(a); p^ := 1; r REF= b; r := 2; s := REF(o); s^ := 3; p := ADR(c); END_PROGRAM";
    let found = onescan_iec::inspect(
        [onescan_iec::Input::from_text("t.st", onescan_iec::input::kind::SourceKind::Text, text)],
        None,
    );
    assert_eq!(found.to_string(), "");
}

#[test]
fn wrong_references_are_reported() {
    let reported = |statement: &str| {
        let declarations = "r : REF_TO INT; d : REF_TO DINT; p : POINTER TO INT; q : POINTER TO REAL; v : REFERENCE TO INT; x : INT; w : WORD; b : BOOL; t : TON;
END_VAR VAR_TEMP tmp : INT; END_VAR VAR CONSTANT k : INT := 1;";
        let text = format!("PROGRAM P VAR {declarations} END_VAR\n{statement}\nEND_PROGRAM");
        findings(&text).lines().next().unwrap_or_default().to_owned()
    };
    for (statement, expected) in [
        ("d := r;", "test.st:3:6: error[T0201]: REF_TO DINT is wanted, this is REF_TO INT"),
        ("r := REF(w);", "test.st:3:6: error[T0201]: REF_TO INT is wanted, this is REF_TO WORD"),
        ("r := x;", "test.st:3:6: error[T0201]: REF_TO INT is wanted, this is INT"),
        ("r := ADR(x);", "test.st:3:6: error[T0201]: REF_TO INT is wanted, this is the address of INT"),
        ("x := r;", "test.st:3:6: error[T0201]: INT is wanted, this is REF_TO INT"),
        ("r := REF(k);", "test.st:3:10: error[R0904]: a constant is not referred to"),
        ("r := REF(tmp);", "test.st:3:10: error[R0904]: a variable that does not outlive the call is not referred to"),
        ("v REF= k;", "test.st:3:8: error[R0904]: a constant is not referred to"),
        ("v REF= w.%X1;", "test.st:3:8: error[T0201]: INT is wanted, this is BOOL"),
        ("p := ADR(w.3);", "test.st:3:10: error[R0904]: a bit has no address of its own"),
        ("r := REF(1 + 2);", "test.st:3:10: error[N0106]: a variable is wanted here"),
        ("x := x^;", "test.st:3:6: error[R0905]: INT refers to nothing, so `^` leads nowhere"),
        ("x := NULL^;", "test.st:3:6: error[R0905]: NULL refers to nothing, so `^` leads nowhere"),
        ("x REF= x;", "test.st:3:1: error[R0905]: `REF=` is for REFERENCE TO, this is INT"),
        ("v REF= w;", "test.st:3:8: error[T0201]: INT is wanted, this is WORD"),
        ("x ?= r;", "test.st:3:1: error[R0905]: `?=` assigns references"),
        ("r ?= x;", "test.st:3:6: error[R0905]: `?=` assigns references"),
        ("b := __ISVALIDREF(x);", "test.st:3:19: error[R0905]: a reference is wanted, this is INT"),
        ("p := q;", "test.st:3:6: warning[R0906]: a pointer to INT is made of one to REAL"),
        ("b := r = d;", "test.st:3:6: error[T0203]: this operator does not join REF_TO INT and REF_TO DINT"),
        ("b := r < r;", "test.st:3:6: error[T0203]: this operator does not join REF_TO INT and REF_TO INT"),
        ("r := r + 1;", "test.st:3:6: error[T0203]: this operator does not join REF_TO INT and an integer"),
        ("p := p * 2;", "test.st:3:6: error[T0203]: this operator does not join POINTER TO INT and an integer"),
        ("r[0] := 1;", "test.st:3:1: error[T0206]: REF_TO INT is not an array"),
        ("x := SIZEOF();", "test.st:3:6: error[C0302]: SIZEOF takes one variable"),
        (
            "CASE r OF 1: ; END_CASE;",
            "test.st:3:6: error[T0201]: an integer or enumeration is wanted, this is REF_TO INT",
        ),
        ("MEMSET(x, 0);", "test.st:3:1: error[C0302]: MEMSET takes 3 arguments, not 2"),
        ("MEMSET(ADR(x), 0, 1, 2);", "test.st:3:22: error[C0301]: MEMSET has no such parameter here"),
        ("MEMSET(ADR(x), 0, 1.5);", "test.st:3:19: error[T0201]: UDINT is wanted, this is a real number"),
        ("t := NULL;", "test.st:3:6: error[T0201]: TON is wanted, this is NULL"),
        ("NULL := r;", "test.st:3:1: error[N0106]: `NULL` is not a variable"),
    ] {
        assert_eq!(reported(statement), expected, "{statement}");
    }
    let unknown = findings("PROGRAM P VAR r : REF_TO Nothing; END_VAR r^ := 1; END_PROGRAM");
    assert_eq!(unknown, "test.st:1:26: error[N0103]: type `Nothing` is not declared");
}
