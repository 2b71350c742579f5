//! SCL sources of Siemens' TIA Portal.

use onescan_iec::Dialect::SiemensScl;

use crate::rig::{Rig, findings_in};

const PLANT: &str = r#"TYPE "Limits"
VERSION : 0.1
   STRUCT
      low { ExternalWritable := 'False'} : Int := 1;   // lower
      "high limit" : Int := 10;
      names : Array[0..2] of String[8];
   END_STRUCT;

END_TYPE

DATA_BLOCK "Settings"
{ S7_Optimized_Access := 'TRUE' }
VERSION : 0.1
AUTHOR : me
NON_RETAIN
   STRUCT
      speed : Int := 3;
      limits : "Limits";
      list : Array[1..3] of DInt := [1, 2, 3];
   END_STRUCT;

BEGIN
   speed := 4;
   limits.low := 2;
   limits."high limit" := 20;
END_DATA_BLOCK

FUNCTION "clamp" : Int
TITLE = It's the limiter's "title"
{ S7_Optimized_Access := 'TRUE' }
VERSION : 0.1
   VAR_INPUT
      x : Int;
      limits : "Limits";
   END_VAR
BEGIN
	#clamp := #x;
	IF #x > #limits."high limit" THEN
	    "clamp" := #limits."high limit";
	ELSIF #x < #limits.low THEN
	    #clamp := #limits.low;
	END_IF;
END_FUNCTION

FUNCTION "tally" : Void
   VAR_IN_OUT
      count : DInt;
   END_VAR
BEGIN
	#count += 1;
END_FUNCTION

FUNCTION_BLOCK "Counter 1"
{ S7_Optimized_Access := 'TRUE' }
AUTHOR : someone
FAMILY : Examples
NAME : counter
VERSION : 0.1
   VAR_INPUT
      up : Bool;
   END_VAR
   VAR_OUTPUT
      count : Int;
   END_VAR
   VAR
      edge {InstructionName := 'R_TRIG'; LibVersion := '1.0'} : R_TRIG;
      Settings : Int := 100;
   END_VAR
   VAR_TEMP
      next : Int;
   END_VAR
   VAR CONSTANT
      STEP : Int := 2;
   END_VAR
BEGIN
	REGION Init isn't needed
	    (* block *) // line
	    (/* multi
	        language */)
	END_REGION
	#edge(CLK := #up);
	IF #edge.Q THEN
	    #next := #count + "Settings".speed * #STEP;
	    #count := "clamp"(x := #next, limits := "Settings".limits);
	END_IF;
	#Settings := #Settings + 1;
END_FUNCTION_BLOCK

DATA_BLOCK "counter_DB"
{ S7_Optimized_Access := 'TRUE' }
VERSION : 0.1
"Counter 1"
BEGIN
   count := 7;
END_DATA_BLOCK

DATA_BLOCK "delay" TON_TIME
BEGIN
END_DATA_BLOCK

ORGANIZATION_BLOCK "Main"
TITLE = "Main Program Sweep (Cycle)"
{ S7_Optimized_Access := 'TRUE' }
VERSION : 0.1
   VAR_TEMP
      mask : Word;
      calls : DInt;
   END_VAR
BEGIN
	"counter_DB"(up := TRUE);
	"delay".TON(IN := TRUE, PT := S5T#20ms);
	#mask := W#16#FF AND WORD#16#0F;
	#calls := L#1;
	"tally"(#calls);
	"Settings".list[1] := "Settings".list[2] := #calls;
	"Settings".list[3] := 7 DIV 2;
END_ORGANIZATION_BLOCK
"#;

#[test]
fn blocks_of_an_external_source_run() {
    let mut rig = Rig::in_dialect(SiemensScl, PLANT);
    rig.scan().expect("no fault");
    // 7 + 4 * 2
    assert_eq!(rig.int("counter_DB.count"), 15);
    assert_eq!(rig.int("counter_DB.Settings"), 101);
    assert_eq!(["Settings.speed", "Settings.limits.low"].map(|path| rig.int(path)), [4, 2]);
    assert_eq!([1, 2, 3].map(|index| rig.int(&format!("Settings.list[{index}]"))), [2, 2, 3]);
    assert!(!rig.bool("delay.Q"));
    rig.scan().expect("no fault");
    rig.scan().expect("no fault");
    assert!(rig.bool("delay.Q"), "20 ms have passed");
}

#[test]
fn a_good_source_has_no_findings() {
    assert_eq!(findings_in(SiemensScl, PLANT).to_string(), "");
}

#[test]
fn what_is_of_s7_alone_is_reported() {
    let text = r#"ORGANIZATION_BLOCK OB40
BEGIN
END_ORGANIZATION_BLOCK
ORGANIZATION_BLOCK OB1
   VAR_TEMP
      done : Bool;
      w : Word;
   END_VAR
BEGIN
	#w := S_ODT(T_NO := T1, S := #done, TV := S5T#2s);
	#w := PEEK_WORD(area := 16#84, dbNumber := 1, byteOffset := 2);
	#w := C#100;
	#done := P#DB1.DBX0.0;
	IF #done THEN GOTO ende; END_IF;
	#done := "Missing";
ende:
	#done := #missing;
END_ORGANIZATION_BLOCK
DATA_BLOCK "d"
   STRUCT a : Array[0..1] of Int; END_STRUCT;
BEGIN
   a[5] := 5;
END_DATA_BLOCK
"#;
    insta::assert_snapshot!(findings_in(SiemensScl, text), @r#"
    test.st:1:20: error[L0513]: an organization block that is called on an event is not supported (OB1 and OB30 to OB38 become programs, OB100 runs once at the start)
    test.st:10:8: error[L0512]: `S_ODT` is a function of a vendor's controllers (use TON)
    test.st:11:8: error[L0513]: `PEEK_WORD` is a function of a vendor's controllers (declare a variable and use that)
    test.st:12:8: error[L0512]: a counter's value of S5 is not supported
    test.st:13:11: error[L0513]: a pointer of S7 is not supported
    test.st:15:11: error[N0101]: `"Missing"` is not declared
    test.st:17:11: error[N0101]: `missing` is not declared
    test.st:22:6: error[T0205]: index 5 is outside of 0..1
    "#);
}

/// Start values of single elements, of structures in arrays, and of what an instance holds.
#[test]
fn data_blocks_begin_with_the_values_of_single_elements() {
    let text = r#"TYPE "Place"
   STRUCT
      X : LReal := 1.5;
      Dwell : Time;
   END_STRUCT;
END_TYPE
FUNCTION_BLOCK "Arm"
   VAR
      state : Int := 7;
      path : Array[1..2] of "Place";
   END_VAR
BEGIN
END_FUNCTION_BLOCK
FUNCTION_BLOCK "Machine"
   VAR
      arms : Array[0..1, 1..2] of "Arm";
      list : Array[1..3] of Int := [1, 2, 3];
   END_VAR
BEGIN
END_FUNCTION_BLOCK
DATA_BLOCK "Machine_DB"
"Machine"
BEGIN
   arms[1, 2].path[2].Dwell := T#20ms;
   arms[1, 2].state := 9;
   arms[0, 1].state := 8;
   list[2] := 20;
   list[3] := 30;
END_DATA_BLOCK
ORGANIZATION_BLOCK "Main"
BEGIN
	"Machine_DB"();
END_ORGANIZATION_BLOCK
"#;
    let rig = Rig::in_dialect(SiemensScl, text);
    let shown = |path: &str| rig.plc.read(path).expect("it is there");
    let paths = ["arms[0,1].state", "arms[0,2].state", "arms[1,2].state", "list[1]", "list[2]", "list[3]"];
    let values = paths.map(|path| rig.int(&format!("Machine_DB.{path}")));
    assert_eq!(values, [8, 7, 9, 1, 20, 30]);
    let dwell = ["Machine_DB.arms[1,2].path[2].Dwell", "Machine_DB.arms[1,2].path[2].X"].map(shown);
    assert_eq!(dwell, ["T#20ms", "1.5"]);
}

/// TIA Portal, without IEC check: a TIME is compared with a number of milliseconds.
#[test]
fn a_time_is_compared_with_milliseconds() {
    let text = "PROGRAM P VAR t : TIME := T#-5ms; a, b, c : BOOL; END_VAR
        a := t < 0; b := t = -5; c := 10 > t; END_PROGRAM";
    let mut rig = crate::rig::Rig::in_dialect(onescan_iec::Dialect::SiemensScl, text);
    rig.scan().expect("no fault");
    assert_eq!(["a", "b", "c"].map(|name| rig.bool(&format!("P.{name}"))), [true; 3]);
}
