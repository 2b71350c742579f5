//! What follows from a mistake is not reported beside it.

use onescan_iec::Dialect;
use onescan_iec::input::kind::SourceKind;
use onescan_iec::{Input, inspect};

use crate::rig::findings_in;

/// Everything in the text that is right, if the unknown were there, is silent.
fn reported(text: &str) -> Vec<String> {
    let found = findings_in(Dialect::Codesys, text);
    found.iter().map(|each| format!("{} {}", each.code, each.message)).collect()
}

#[test]
fn an_unknown_base_is_one_finding() {
    let found = reported(
        "FUNCTION_BLOCK D EXTENDS Missing IMPLEMENTS K
VAR own : INT; END_VAR
METHOD PUBLIC OVERRIDE A : BOOL
  A := SUPER^.A(); A := baseVar; baseMethod(3); A := baseMethod(); baseObj.x := 3; baseObj.m();
  A := THIS^.baseProp; THIS^.baseM(); THIS^.baseProp := 3; baseProp := 3;
  basArr[3] := 4; A := basArr[own]; own := SUPER^.prop; SUPER^.prop := 3;
END_METHOD
  SUPER^(); SUPER^.M(); SUPER^.v := 3; own := SUPER^.v; baseVar := 1; baseFb(IN := TRUE); own := baseFb.Q;
  FOR bi := 1 TO 3 DO own := bi; END_FOR
  CASE baseE OF 1: own := 1; END_CASE
  own := baseFun(3) + 1; own := own + baseV; IF baseB THEN own := 1; END_IF
END_FUNCTION_BLOCK
FUNCTION_BLOCK E EXTENDS D
METHOD PUBLIC OVERRIDE B : BOOL
  B := SUPER^.B(); B := baseVar;
END_METHOD
  SUPER^(); own := 1; baseVar := 3;
END_FUNCTION_BLOCK
INTERFACE J EXTENDS K
METHOD jm : BOOL END_METHOD
END_INTERFACE
INTERFACE K
METHOD km : BOOL END_METHOD
PROPERTY kp : BOOL GET END_GET END_PROPERTY
END_INTERFACE
FUNCTION F : BOOL
VAR_INPUT k : K; END_VAR
VAR_IN_OUT e : E; d : D; END_VAR
  F := k.km();
END_FUNCTION
PROGRAM Main
VAR
  d : D; e : E; j : J; k : K; d2 : D(1, 2); d3 : D := (bx := 3); n : INT; b : BOOL; pe : POINTER TO D;
  ee : ARRAY[0..2] OF E;
END_VAR
  d.x := 3; n := d.y; d.m(3); b := d.m(); d(a := 3, b => n); d(3); e.x := 3; n := e.x.y[3]; b := e.A(); e(i := 3);
  j.jm(); k := d; k := e; k := j; b := F(d, e, d); b := F(k := d, e := e, d := e); b := d.km(); j := d;
  pe := ADR(e); pe^.x := 3; pe^.m(); ee[1].x := ee[2].y; n := ee[1].m().z; b := d = j;
  b := __QUERYINTERFACE(d, k);
END_PROGRAM",
    );
    assert_eq!(found, ["O0807 a function block or class is wanted, and `Missing` is not declared"]);
}

#[test]
fn an_unknown_interface_is_one_finding() {
    let found = reported(
        "INTERFACE J EXTENDS Missing
METHOD jm : BOOL END_METHOD
END_INTERFACE
INTERFACE K
METHOD km : BOOL END_METHOD
END_INTERFACE
FUNCTION_BLOCK D IMPLEMENTS J
METHOD PUBLIC jm : BOOL jm := TRUE; END_METHOD
END_FUNCTION_BLOCK
PROGRAM Main
VAR d : D; j : J; k : K; b : BOOL; END_VAR
  j := d; b := j.other(); b := j.prop; j.prop := b; b := j.jm(); k := j; k := d;
END_PROGRAM",
    );
    assert_eq!(found, ["O0807 an interface is wanted, and `Missing` is not declared"]);
}

#[test]
fn what_a_unit_without_unknown_bases_lacks_is_reported() {
    let found = reported(
        "FUNCTION_BLOCK A END_FUNCTION_BLOCK
FUNCTION_BLOCK B EXTENDS A
METHOD m : BOOL m := SUPER^.m(); missing := 1; END_METHOD
  SUPER^(); other(); THIS^.x := 1;
END_FUNCTION_BLOCK
FUNCTION_BLOCK C SUPER^(); END_FUNCTION_BLOCK
PROGRAM Main VAR b : B; END_VAR b.y := 1; b(z := 1); END_PROGRAM",
    );
    insta::assert_snapshot!(found.join("\n"));
}

#[test]
fn an_unknown_type_is_one_finding() {
    let found = reported(
        "TYPE S : STRUCT a : Unknown1; b : INT; c : POINTER TO S; END_STRUCT END_TYPE
TYPE X : STRUCT EXTENDS Unknown2 c : INT; END_STRUCT END_TYPE
TYPE N : STRUCT next : POINTER TO M; END_STRUCT END_TYPE
TYPE M : STRUCT x : Unknown3; y : INT; END_STRUCT END_TYPE
FUNCTION G : Unknown4
VAR_INPUT i : Unknown5; j : INT; END_VAR
  G := i; G.x := 3;
END_FUNCTION
FUNCTION_BLOCK B
VAR_INPUT p : Unknown6; q : INT; END_VAR
VAR_OUTPUT o : Unknown7; END_VAR
METHOD PUBLIC M : Unknown8
VAR_INPUT z : Unknown9; END_VAR
  M := z;
END_METHOD
PROPERTY P1 : Unknown10
GET P1 := p; END_GET
SET p := P1; END_SET
END_PROPERTY
  p.x := 1; o := p;
END_FUNCTION_BLOCK
FUNCTION_BLOCK B2 EXTENDS B
  p.x := 1; p := o;
END_FUNCTION_BLOCK
INTERFACE I
METHOD X : Unknown11 END_METHOD
END_INTERFACE
VAR_GLOBAL gg : Unknown12; END_VAR
PROGRAM Main
VAR
  s : S; s2 : X; u : Unknown13; ua : ARRAY[0..3] OF Unknown14; up : REF_TO Unknown15; b : B; b2 : B2; it : I;
  n : INT; x : BOOL; ref : POINTER TO Unknown16; dd : ARRAY[0..Unknown17] OF INT; node : N;
END_VAR
  n := s.b; n := s.a.c; s.a.m(); s.a.m(3).x := 4; s.c^.b := 1; n := s2.c; n := s2.d.e;
  node.next^.x := 1; n := node.next^.y;
  u.a := 3; u.m(); n := u.m(1).y; u[3] := 4; u.x[n] := 5; n := u; u := n; u(); u(IN := TRUE, Q => x);
  n := ABS(u); n := MAX(u.x, 3); x := NOT u; n := u + 1; n := -u; IF u THEN n := 1; END_IF
  FOR u := 1 TO 3 DO n := 1; END_FOR
  FOR n := u TO u.x DO n := 1; END_FOR
  CASE u OF 1: n := 1; END_CASE
  CASE u.x OF 1: n := 1; END_CASE
  ua[1].x := 3; ua[n] := ua[2]; n := ua[1]; n := SIZEOF(ua);
  up^.x := 3; n := up^.m(); ref^.x := 3; n := ref^.m(); ref := ADR(n); dd[3] := 1;
  n := G(3, 4); n := G(i := 3, j := 4); n := G(3, 4).x; G(1, 2);
  b(p := 1, q := 3, o => n); b.p := 3; n := b.o; n := b.o.x; n := b.M(z := 3); b.M(3); n := b.M(3).x;
  b.P1 := 3; n := b.P1; n := b.P1.x; b2.p := 1; b2(p := 1);
  n := it.X(); n := it.X().y; gg.x := 3; gg(); n := gg.m(); n := gg; n := u.a.b.c(1, 2).d[3];
  n := SEL(x, u, 3); n := u MOD 3; x := u = 3; x := u.Q AND x; n := INT_TO_WORD(u); n := TO_INT(u);
  REPEAT n := 1; UNTIL u END_REPEAT
  WHILE u.x DO n := 1; END_WHILE
  up := REF(u); ref := ADR(u); x := up = NULL;
END_PROGRAM",
    );
    let wanted: Vec<String> = (1..=17)
        .map(|number| match number {
            17 => format!("N0101 `Unknown{number}` is not declared"),
            _ => format!("N0103 type `Unknown{number}` is not declared"),
        })
        .collect();
    let mut found: Vec<String> = found.into_iter().collect();
    found.sort_by_key(|each| each.split('`').nth(1).map(|name| (name.len(), name.to_owned())));
    // The property's type is written in its GET and its SET.
    found.dedup();
    assert_eq!(found, wanted);
}

#[test]
fn a_name_that_is_not_declared_is_reported_once_for_each_unit() {
    let text = "PROGRAM P VAR a : INT; END_VAR a := misspelt; a := misspelt + misspelt; f(1); f(2); END_PROGRAM
PROGRAM Q VAR a : INT; END_VAR a := misspelt; END_PROGRAM";
    let name = "N0101 `misspelt` is not declared";
    assert_eq!(reported(text), [name, "N0105 there is no function or instance `f`", name]);
}

#[test]
fn too_much_memory_is_one_finding() {
    let found = reported(
        "TYPE Big : STRUCT a : ARRAY[0..30000000] OF LREAL; b : INT; END_STRUCT END_TYPE
FUNCTION F : INT VAR_INPUT p : POINTER TO Big; END_VAR F := p^.b; p^.b := 3; p^.a[3] := 2; END_FUNCTION
VAR_GLOBAL g : ARRAY[0..40000000] OF BYTE; h : ARRAY[0..40000000] OF BYTE; k : INT; END_VAR
PROGRAM Main
VAR s : Big; n : INT; t : ARRAY[0..40000000] OF BYTE; u : ARRAY[0..1] OF Big; END_VAR
  n := s.b; s.a[3] := 1; t[3] := 4; g[3] := 2; h[3] := 3; n := u[1].b; k := 3;
END_PROGRAM",
    );
    assert_eq!(found.len(), 1, "{found:?}");
    assert!(found[0].starts_with("L0502"), "{found:?}");
}

#[test]
fn what_is_no_program_is_one_finding() {
    let texts = [
        "<?xml version=\"1.0\"?>\n<TcPlcObject><POU Name=\"A\"><Declaration>!?</Declaration></POU></TcPlcObject>",
        "<html><body>What? $5 | !</body></html>",
        "{ \"name\": \"x\", \"list\": [1, 2, \"it's\"] }",
        "#include <stdio.h>\nint main() { a ? b : $c; return 1 | ~x \\ 2; } // it's @ the end\n$ ? ! @ \\",
        "PK\u{3}\u{4}\u{14}\u{1}!?$\u{2}~~",
    ];
    for text in texts {
        let found = inspect([Input::from_text("a.st", SourceKind::Text, text)], None);
        assert_eq!(found.len(), 1, "{text}: {found}");
    }
}

#[test]
fn a_keyword_for_a_name_is_one_finding() {
    let found = reported(
        "FUNCTION F : INT
VAR_INPUT at, to : INT; END_VAR
  F := at MOD to;
END_FUNCTION
TYPE S : STRUCT of : INT; END_STRUCT END_TYPE
TYPE E : (do, then := 3); END_TYPE
PROGRAM Main
VAR mod : INT; task : INT; s : S; k : ARRAY[1..3] OF INT; END_VAR
  mod := mod + 1; mod := (mod MOD 5) mod mod; s.of := mod; k[mod] := mod; task := 1;
  mod := F(at := mod, to := MOD(4, 3));
  FOR mod := 1 TO mod BY 2 DO task := mod; END_FOR
END_PROGRAM",
    );
    let words = ["at", "to", "of", "do", "then", "mod"];
    assert_eq!(found, words.map(|word| format!("S0101 `{word}` is a keyword, not a name")));
}
