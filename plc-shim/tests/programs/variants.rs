//! Parameters of type `VARIANT` (Siemens): what they point to, and what asks for that.

use onescan_iec::Dialect::{self, SiemensScl};

use crate::rig::{Rig, findings_in};

const UNITS: &str = "TYPE \"Recipe\" STRUCT speed : Int; name : String[8]; END_STRUCT; END_TYPE
DATA_BLOCK \"now\" \"Recipe\" BEGIN speed := 7; END_DATA_BLOCK
FUNCTION \"Kind\" : Int
VAR_INPUT v : Variant; END_VAR
BEGIN
  CASE TypeOf(#v) OF
    Bool: #Kind := 1;
    Int, DInt: #Kind := 2;
    String: #Kind := 3;
    \"Recipe\": #Kind := 4;
    ELSE #Kind := 9;
  END_CASE;
  IF IS_ARRAY(#v) AND TypeOfElements(#v) = Real THEN #Kind := 100 + UDINT_TO_INT(CountOfElements(#v)); END_IF;
END_FUNCTION
FUNCTION \"Handed\" : Int VAR_IN_OUT v : Variant; END_VAR BEGIN #Handed := \"Kind\"(#v); END_FUNCTION
FUNCTION \"Given\" : Bool VAR_INPUT v : Variant; END_VAR BEGIN #Given := #v <> NULL AND NOT (NULL = #v); END_FUNCTION
FUNCTION \"Double\" : Bool
VAR_IN_OUT v : Variant; n : Int; END_VAR
VAR_TEMP i : Int; r : Real; END_VAR
BEGIN
  #n := #n + 1;
  IF TypeOf(#v) = Int THEN
    VariantGet(SRC := #v, DST => #i); #i := #i * 2; VariantPut(SRC := #i, DST := #v); #Double := TRUE;
  ELSIF TypeOf(#v) <> Real THEN
    #Double := FALSE;
  ELSE
    VariantGet(SRC := #v, DST => #r); #r := #r * 2.0; VariantPut(SRC := #r, DST := #v); #Double := TRUE;
  END_IF;
END_FUNCTION
";

fn rig(declarations: &str, statements: &str) -> Rig {
    let text = format!(
        "{UNITS}FUNCTION_BLOCK \"F\" VAR {declarations} END_VAR BEGIN {statements} END_FUNCTION_BLOCK
DATA_BLOCK \"d\" \"F\" BEGIN END_DATA_BLOCK
ORGANIZATION_BLOCK \"Main\" BEGIN \"d\"(); END_ORGANIZATION_BLOCK"
    );
    let found = findings_in(SiemensScl, &text).to_string();
    let others: Vec<&str> = found.lines().filter(|line| !line.contains("is never used")).collect();
    assert_eq!(others.concat(), "");
    let mut rig = Rig::in_dialect(SiemensScl, &text);
    rig.scan().expect("no fault");
    rig
}

#[test]
fn the_type_of_what_is_given_is_asked_for() {
    let rig = rig(
        "b : Bool; i : Int; l : LReal; s : String[20]; a : Array[1..4, 0..1] of Real; r : \"Recipe\";
         kb, ki, kl, ks, ka, kr, kd, kh, ke : Int;",
        "#kb := \"Kind\"(#b); #ki := \"Kind\"(#i); #kl := \"Kind\"(#l); #ks := \"Kind\"(#s); #ka := \"Kind\"(#a);
         #kr := \"Kind\"(#r); #kd := \"Kind\"(\"now\"); #kh := \"Handed\"(#i); #ke := \"Kind\"(#r.speed);",
    );
    let found = ["kb", "ki", "kl", "ks", "ka", "kr", "kd", "kh", "ke"].map(|name| rig.int(&format!("d.{name}")));
    assert_eq!(found, [1, 2, 9, 3, 108, 4, 4, 2, 2]);
}

#[test]
fn what_it_points_to_is_read_and_written() {
    let rig = rig(
        "i : Int := 21; r : Real := 1.5; l : LReal := 1.5; n : Int; x, y, z, same, other, given : Bool; u : UInt;",
        "#x := \"Double\"(v := #i, n := #n); #y := \"Double\"(v := #r, n := #n); #z := \"Double\"(v := #l, n := #n);
         #same := TypeOf(#i) = TypeOf(#n); #other := TypeOf(#i) = TypeOf(#u);
         #given := \"Given\"(#u);",
    );
    assert_eq!((rig.int("d.i"), rig.real("d.r"), rig.real("d.l"), rig.int("d.n")), (42, 3.0, 1.5, 3));
    let flags = ["x", "y", "z", "same", "other", "given"].map(|name| rig.bool(&format!("d.{name}")));
    assert_eq!(flags, [true, true, false, true, false, true]);
}

#[test]
fn a_copy_of_another_type_is_not_made_and_clears_eno() {
    let rig = rig(
        "i : Int := 5; w : Word := 16#77; ok : Bool := TRUE; p : Bool := TRUE;",
        "VariantGet(SRC := #i, DST => #w, ENO => #ok); VariantGet(SRC := #i, DST => #i, ENO => #p);",
    );
    assert_eq!((rig.int("d.w"), rig.bool("d.ok"), rig.bool("d.p")), (0x77, false, true));
}

#[test]
fn elements_of_arrays_are_moved() {
    let rig = rig(
        "a : Array[1..5] of Int := [1, 2, 3, 4, 5]; b : Array[0..3] of Int; w : Array[0..3] of DInt; one : Int;
         r, same, far, back, single : Int;",
        "#r := MOVE_BLK_VARIANT(SRC := #a, COUNT := 2, SRC_INDEX := 1, DEST_INDEX := 2, DEST => #b);
         #same := MOVE_BLK_VARIANT(SRC := #a, COUNT := 2, SRC_INDEX := 0, DEST_INDEX := 0, DEST => #w);
         #far := MOVE_BLK_VARIANT(SRC := #a, COUNT := 2, SRC_INDEX := 4, DEST_INDEX := 0, DEST => #b);
         #back := MOVE_BLK_VARIANT(SRC := #a, COUNT := 1, SRC_INDEX := 0, DEST_INDEX := -1, DEST => #b);
         #single := MOVE_BLK_VARIANT(SRC := #a, COUNT := 1, SRC_INDEX := 4, DEST_INDEX := 0, DEST => #one);",
    );
    let b = [0, 1, 2, 3].map(|index| rig.int(&format!("d.b[{index}]")));
    assert_eq!((b, rig.int("d.one"), rig.int("d.single")), ([0, 0, 2, 3], 5, 0));
    let codes = ["r", "same", "far", "back"].map(|name| rig.int(&format!("d.{name}")) as u16);
    assert_eq!(codes, [0, 0x80B4, 0x8151, 0x8351]);
}

#[test]
fn a_variant_is_handed_on_to_be_written() {
    let text = "FUNCTION \"Moved\" : Int VAR_INPUT src : Variant; END_VAR VAR_IN_OUT dst : Variant; END_VAR
        BEGIN #Moved := MOVE_BLK_VARIANT(SRC := #src, COUNT := 2, SRC_INDEX := 0, DEST_INDEX := 1, DEST => #dst); END_FUNCTION
        FUNCTION_BLOCK \"F\" VAR a, b : Array[1..3] of Int := [7, 8, 9]; r : Int; END_VAR
        BEGIN #r := \"Moved\"(src := #a, dst := #b); END_FUNCTION_BLOCK
        DATA_BLOCK \"d\" \"F\" BEGIN END_DATA_BLOCK
        ORGANIZATION_BLOCK \"Main\" BEGIN \"d\"(); END_ORGANIZATION_BLOCK";
    assert_eq!(findings_in(SiemensScl, text).to_string(), "");
    let mut rig = Rig::in_dialect(SiemensScl, text);
    rig.scan().expect("no fault");
    assert_eq!([1, 2, 3].map(|index| rig.int(&format!("d.b[{index}]"))), [7, 7, 8]);
}

#[test]
fn what_is_wrong_with_a_variant_is_reported() {
    let reported = |dialect: Dialect, text: &str| findings_in(dialect, text).to_string();
    let temporary = "FUNCTION \"F\" : Int VAR_TEMP v : Variant; END_VAR BEGIN #F := 1; END_FUNCTION";
    let literal = format!("{UNITS}FUNCTION \"G\" : Int BEGIN #G := \"Kind\"(5); END_FUNCTION");
    let constant = format!(
        "{UNITS}FUNCTION \"G\" : Int VAR CONSTANT c : Int := 1; END_VAR VAR_TEMP i : Int; END_VAR
BEGIN VariantGet(SRC := #i, DST => #c); #G := 1; END_FUNCTION"
    );
    let elsewhere = "FUNCTION F : INT VAR_INPUT v : VARIANT; END_VAR F := 1; END_FUNCTION";
    insta::assert_snapshot!(
        [
            reported(SiemensScl, temporary),
            reported(SiemensScl, &literal),
            reported(SiemensScl, &constant),
            reported(Dialect::TwinCat, elsewhere),
        ]
        .join("\n---\n")
    );
}

#[test]
fn strings_of_other_lengths_are_one_type() {
    let rig = rig(
        "long : String[20] := 'abcdefghij'; short : String[4]; wide : WString[12] := WSTRING#\"kurz\"; other : WString[40]; ok : Bool;",
        "VariantGet(SRC := #long, DST => #short, ENO => #ok); VariantPut(SRC := #wide, DST := #other);",
    );
    assert_eq!((rig.text("d.short").as_str(), rig.text("d.other").as_str(), rig.bool("d.ok")), ("abcd", "kurz", true));
}

#[test]
fn what_is_no_type_and_what_is_constant_is_refused() {
    let reported = |statement: &str| {
        let text = format!(
            "{UNITS}FUNCTION \"G\" : Int VAR CONSTANT c : Int := 1; END_VAR VAR_TEMP i, n : Int; b : Bool; END_VAR
BEGIN {statement} #G := 1; END_FUNCTION"
        );
        let found = findings_in(SiemensScl, &text).to_string();
        found.lines().filter(|line| line.contains("error")).collect::<Vec<_>>().join("\n")
    };
    assert_eq!(reported("#b := TypeOf(#i) = TypeOf(#n) OR TypeOf(#i) <> Int;"), "");
    assert!(reported("#b := TypeOf(#i) = 5;").contains("this is not a type"), "{}", reported("#b := TypeOf(#i) = 5;"));
    let given = reported("#b := \"Double\"(v := #c, n := #n);");
    assert!(given.contains("`v` is VAR_IN_OUT, which takes no constant"), "{given}");
    assert_eq!(reported("#n := \"Handed\"(#i);"), "");
}
