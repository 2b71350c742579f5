//! SCL as classic STEP 7, PCS 7 and TIA Portal have it beside what `scl` shows.

use onescan_iec::Dialect::{self, SiemensScl};

use onescan_iec::input::kind::SourceKind;
use onescan_iec::{Input, TaskPlan, TimeSpan, inspect};
use onescan_iec_run::SoftPlc;

use crate::rig::{Rig, application_in, findings_in, task};

fn after_a_scan(text: &str) -> Rig {
    let mut rig = Rig::in_dialect(SiemensScl, text);
    rig.scan().expect("no fault");
    rig
}

#[test]
fn headers_are_what_the_editors_write() {
    for version in ["0.1", "'1.5'", "\" 1.5\"", "' 2.0'"] {
        let text = format!(
            "FUNCTION_BLOCK FB41\nTITLE ='PID'\nAUTHOR : SIMATIC\nFAMILY : ICONT\nNAME : CONT_C\nVERSION : {version}
             VAR_INPUT a : INT; END_VAR VAR n : INT; END_VAR BEGIN n := a + 1; END_FUNCTION_BLOCK
             PROGRAM P VAR f : FB41; END_VAR f(a := 4); END_PROGRAM"
        );
        assert_eq!(after_a_scan(&text).int("P.f.n"), 5, "{version}");
    }
}

#[test]
fn the_last_statement_may_lack_its_semicolon() {
    let text = "PROGRAM P VAR a, b, c, d, i : INT; END_VAR BEGIN
        IF a = 0 THEN b := 1 ELSE b := 2 END_IF;
        CASE a OF 0: c := 3 ELSE c := 4 END_CASE;
        FOR i := 1 TO 3 DO d := d + i END_FOR; WHILE a < 5 DO a := a + 2 END_WHILE;
        REPEAT a := a + 1 UNTIL a > 8 END_REPEAT; END_PROGRAM";
    let rig = after_a_scan(text);
    assert_eq!(["a", "b", "c", "d"].map(|name| rig.int(&format!("P.{name}"))), [9, 1, 3, 6]);
}

#[test]
fn arrays_begin_with_values_without_brackets() {
    let text = "PROGRAM P VAR e : ARRAY [1..4] OF INT := 3 (7); f : ARRAY [0..2] OF INT := 1, 2 (5); r : INT; END_VAR
        BEGIN r := 1000 * e[1] + 100 * e[3] + 10 * e[4] + f[0] + f[1] + f[2]; END_PROGRAM";
    assert_eq!(after_a_scan(text).int("P.r"), 7711);
}

#[test]
fn variables_of_the_data_block_alone() {
    let text = "FUNCTION_BLOCK F VAR DB_SPECIFIC n : INT := 3; END_VAR BEGIN n := n + 1; END_FUNCTION_BLOCK
        PROGRAM P VAR f1 : F; END_VAR BEGIN f1(); END_PROGRAM";
    assert_eq!(after_a_scan(text).int("P.f1.n"), 4);
}

#[test]
fn constants_without_a_type_take_that_of_their_use() {
    let text = "FUNCTION_BLOCK F
        CONST LIM := 3; HALF := LIM / 2.0; MASK := W#16#0F; END_CONST
        VAR a : ARRAY [1..LIM] OF INT; r : REAL; w : WORD := W#16#1234; i, n : INT; END_VAR
        BEGIN
        FOR i := 1 TO LIM DO a[i] := LIM * i; END_FOR;
        r := HALF * 2.0; w := w AND MASK;
        CASE a[1] OF LIM: n := 1; ELSE n := 2; END_CASE;
        END_FUNCTION_BLOCK
        FUNCTION_BLOCK G VAR LIM : INT := 8; n : INT; END_VAR BEGIN n := LIM; END_FUNCTION_BLOCK
        PROGRAM P VAR f1 : F; g1 : G; END_VAR BEGIN f1(); g1(); END_PROGRAM";
    let rig = after_a_scan(text);
    assert_eq!(["f1.a[3]", "f1.w", "f1.n", "g1.n"].map(|name| rig.int(&format!("P.{name}"))), [9, 4, 1, 8]);
    assert!((rig.real("P.f1.r") - 3.0).abs() < 1e-6);
    let twice = "FUNCTION_BLOCK F CONST k := 1; END_CONST VAR k : INT; END_VAR BEGIN k := 2; END_FUNCTION_BLOCK";
    assert!(findings_in(SiemensScl, twice).iter().any(|found| found.code.text() == "N0102"));
}

#[test]
fn structures_without_a_name_are_alike_by_their_members() {
    let text = "TYPE T : STRUCT x : INT; y : BYTE; END_STRUCT END_TYPE
        PROGRAM P VAR a : STRUCT x : INT; y : BYTE; END_STRUCT; b : STRUCT X : INT; Y : BYTE; END_STRUCT; c : T; END_VAR
        BEGIN a.x := 7; a.y := B#16#2; b := a; c := b; END_PROGRAM";
    let rig = after_a_scan(text);
    assert_eq!(["b.x", "b.y", "c.x", "c.y"].map(|name| rig.int(&format!("P.{name}"))), [7, 2, 7, 2]);
    for other in ["X : INT; Z : BYTE", "X : UINT; Y : BYTE", "X : INT", "Y : BYTE; X : INT"] {
        let text = text.replace("X : INT; Y : BYTE", other);
        assert!(findings_in(SiemensScl, &text).iter().any(|found| found.code.text() == "T0201"), "{other}");
    }
}

#[test]
fn a_dint_becomes_a_real_by_itself() {
    let text = "PROGRAM P VAR n : REAL := 6.7; d : DINT := 16777217; r : REAL; i : DINT; END_VAR
        BEGIN n := ROUND(n + 0.4); r := d; i := REAL_TO_DINT(r); END_PROGRAM";
    let rig = after_a_scan(text);
    assert_eq!((rig.real("P.n"), rig.int("P.i")), (7.0, 16_777_216));
    let beside = "PROGRAM P VAR d : DINT := 3; r, q : REAL := 4.5; END_VAR BEGIN r := (q - r) / d + q * d; END_PROGRAM";
    assert_eq!(after_a_scan(beside).real("P.r"), 13.5);
    let lossy = "PROGRAM P VAR l : LREAL; r : REAL; END_VAR BEGIN r := l; END_PROGRAM";
    assert!(findings_in(SiemensScl, lossy).iter().any(|found| found.code.text() == "T0201"));
}

/// What a block makes of views, where the highest byte of a value is its first.
#[test]
fn views_show_bytes_and_bits_as_siemens_has_them() {
    let text = "PROGRAM P VAR d : DWORD := DW#16#12345678; n : INT; hi, lo : BYTE; w : WORD; bits : ARRAY [0..7] OF BOOL; i : INT; END_VAR
        VAR bytes AT d : ARRAY [0..3] OF BYTE; flags AT d : ARRAY [0..31] OF BOOL;
          parts AT d : STRUCT first : WORD; second : INT; END_STRUCT; END_VAR
        BEGIN hi := bytes[0]; lo := bytes[3]; w := parts.first; n := parts.second;
          FOR i := 0 TO 7 DO bits[i] := flags[i + 8]; END_FOR; END_PROGRAM";
    let rig = after_a_scan(text);
    assert_eq!(["hi", "lo", "w", "n"].map(|name| rig.int(&format!("P.{name}"))), [0x12, 0x78, 0x1234, 0x5678]);
    // Byte 1 is 16#34.
    let bits = [0, 1, 2, 3, 4, 5, 6, 7].map(|bit| rig.bool(&format!("P.bits[{bit}]")));
    assert_eq!(bits, [false, false, true, false, true, true, false, false]);
}

#[test]
fn what_is_written_through_a_view_is_in_the_variable_and_in_its_other_views() {
    let text = "FUNCTION Packed : DWORD VAR_INPUT a : BYTE; b : BYTE; END_VAR
          VAR_TEMP d : DWORD; bytes AT d : ARRAY [0..3] OF BYTE; flags AT d : ARRAY [0..31] OF BOOL; END_VAR
          BEGIN d := 0; bytes[0] := a; bytes[3] := b; flags[8] := TRUE; d := d OR DW#16#0000_0100; Packed := d; END_FUNCTION
        FUNCTION_BLOCK Swap VAR_INPUT on : BOOL; END_VAR VAR_IN_OUT r : STRUCT x : INT; y : INT; END_STRUCT; END_VAR
          VAR_TEMP v AT r : STRUCT y : INT; x : INT; END_STRUCT; k : INT; END_VAR
          BEGIN IF on THEN k := v.x; v.x := v.y; v.y := k; END_IF; END_FUNCTION_BLOCK
        PROGRAM P VAR d : DWORD; s : Swap; r : STRUCT x : INT := 3; y : INT := 40; END_STRUCT; f : REAL := 1.0; w : WORD;
          words AT f : ARRAY [0..1] OF WORD; END_VAR
          BEGIN d := Packed(a := 16#AB, b := 16#CD); s(on := TRUE, r := r); w := words[0]; words[1] := 1; END_PROGRAM";
    let rig = after_a_scan(text);
    assert_eq!(rig.int("P.d"), 0xAB01_01CD);
    assert_eq!(["r.x", "r.y", "w"].map(|name| rig.int(&format!("P.{name}"))), [40, 3, 0x3f80]);
    assert!((rig.real("P.f") - f64::from(f32::from_bits(0x3f80_0001))).abs() < f64::EPSILON);
}

#[test]
fn an_output_is_written_through_its_view() {
    let text = "FUNCTION_BLOCK F VAR_OUTPUT q : WORD; flags AT q : ARRAY [0..15] OF BOOL; END_VAR
          BEGIN flags[0] := TRUE; END_FUNCTION_BLOCK
        PROGRAM P VAR f1 : F; w : WORD; END_VAR BEGIN f1(q => w); END_PROGRAM";
    assert_eq!(after_a_scan(text).int("P.w"), 0x0100);
    assert!(findings_in(SiemensScl, text).is_empty());
}

#[test]
fn a_view_of_one_byte() {
    let text = "PROGRAM P VAR b : BYTE := B#16#81; flags AT b : ARRAY [0..7] OF BOOL; r : BOOL; one : BOOL; ob AT one : ARRAY [0..0] OF BOOL; END_VAR
        BEGIN r := flags[7]; flags[0] := FALSE; ob[0] := TRUE; END_PROGRAM";
    let rig = after_a_scan(text);
    assert_eq!((rig.int("P.b"), rig.bool("P.r"), rig.bool("P.one")), (0x80, true, true));
}

#[test]
fn a_call_writes_through_a_view() {
    let text = "FUNCTION Fill : VOID VAR_OUTPUT q : BYTE; END_VAR VAR_IN_OUT list : ARRAY [0..1] OF BYTE; END_VAR
          BEGIN q := 5; list[0] := 1; list[1] := 2; END_FUNCTION
        PROGRAM P VAR w : WORD; k : WORD; bytes AT w : ARRAY [0..1] OF BYTE; kb AT k : ARRAY [0..1] OF BYTE; END_VAR
          BEGIN Fill(list := bytes, q => kb[1]); END_PROGRAM";
    let rig = after_a_scan(text);
    assert_eq!((rig.int("P.w"), rig.int("P.k")), (0x0102, 5));
}

#[test]
fn views_that_would_show_something_else_are_refused() {
    let text = "FUNCTION_BLOCK F VAR a : STRING[9]; c : WORD; i : INT; END_VAR VAR ab AT a : ARRAY [0..9] OF BYTE;
          big AT c : DWORD; none AT x : WORD; t AT i : BYTE; END_VAR
        BEGIN FOR i := 1 TO 2 DO ab[0] := 1; END_FOR; END_FUNCTION_BLOCK
        FUNCTION G : VOID VAR_IN_OUT a : WORD; b : WORD; END_VAR BEGIN a := b; END_FUNCTION
        FUNCTION_BLOCK H VAR a : WORD; b AT a : WORD; END_VAR BEGIN G(a := a, b := b); END_FUNCTION_BLOCK";
    insta::assert_snapshot!(findings_in(SiemensScl, text), @r"
    test.st:1:74: error[L0501]: a view `AT` of or as STRING[9] is not supported (BOOL, bit strings, integers, reals, CHAR, and arrays and structures of them have the same form there)
    test.st:2:11: error[R0902]: `big` has 4 bytes, and `c` 2 (a view is no larger than what it looks at)
    test.st:2:37: error[N0101]: `x` is not a variable of this block
    test.st:3:19: error[L0501]: `i` has a view, and counts turns (count with another variable)
    test.st:5:69: error[L0501]: A, B lie in the same memory, and each may be written here (write one of them, or hand over a copy)
    ");
    let other = "PROGRAM P VAR a : WORD; b AT a : BYTE; END_VAR b := 1; END_PROGRAM";
    insta::assert_snapshot!(findings_in(Dialect::Iec3, other), @"test.st:1:30: error[S0110]: a view of another variable's memory, `b AT a : DWORD` is not part of iec3 (it is part of siemens-scl: --dialect chooses)");
}

/// Timers as TIA Portal inserts them: a data block of each, or a variable of the block.
#[test]
fn timers_and_counters_are_called_by_what_they_do() {
    let text = r#"
DATA_BLOCK "IEC_Timer_0_DB"
{InstructionName := 'IEC_TIMER';
LibVersion := '1.0';
S7_Optimized_Access := 'TRUE' }
AUTHOR : Simatic
FAMILY : IEC
NAME : IEC_TMR
VERSION : 1.0
NON_RETAIN
IEC_TIMER

BEGIN

END_DATA_BLOCK

DATA_BLOCK "IEC_Counter_0_DB"
{InstructionName := 'IEC_COUNTER';
LibVersion := '1.0';
S7_Optimized_Access := 'TRUE' }
VERSION : 1.0
IEC_COUNTER
BEGIN
END_DATA_BLOCK

FUNCTION_BLOCK "Line"
{ S7_Optimized_Access := 'TRUE' }
VERSION : 0.1
   VAR_INPUT
      run : Bool;
      reset : Bool;
   END_VAR
   VAR_OUTPUT
      on : Bool;
      off : Bool;
      pulse : Bool;
      kept : Bool;
      passed : Time;
      full : Bool;
      empty : Bool;
      count : Int;
   END_VAR
   VAR
      t {InstructionName := 'IEC_TIMER'; LibVersion := '1.0'} : IEC_TIMER;
      u : IEC_TIMER;
      v : Array[0..1] of IEC_TIMER;
      w : TONR_TIME;
      c {InstructionName := 'IEC_COUNTER'; LibVersion := '1.0'} : IEC_COUNTER;
      d : IEC_DCOUNTER;
   END_VAR
BEGIN
	"IEC_Timer_0_DB".TON(IN := #run,
	                     PT := T#30ms,
	                     Q => #on);
	#t.TOF(IN := #run, PT := T#20ms, Q => #off);
	#u.TP(IN := #run, PT := T#20ms);
	#pulse := #u.Q;
	#v[1].TONR(IN := #run, R := #reset, PT := T#40ms, Q => #kept, ET => #passed);
	#w.TONR(IN := #run, R := #reset, PT := T#40ms);
	"IEC_Counter_0_DB".CTUD(CU := #run, CD := #reset, R := FALSE, LD := FALSE, PV := 2, QU => #full, QD => #empty, CV => #count);
	#c.CTU(CU := #run, R := FALSE, PV := 1);
	#d.CTD(CD := #run, LD := #reset, PV := 5);
END_FUNCTION_BLOCK

DATA_BLOCK "Line_DB"
"Line"
BEGIN
END_DATA_BLOCK

ORGANIZATION_BLOCK "Main"
VERSION : 0.1
BEGIN
	"Line_DB"();
END_ORGANIZATION_BLOCK
"#;
    assert_eq!(findings_in(SiemensScl, text).to_string(), "");
    let mut rig = Rig::in_dialect(SiemensScl, text);
    let drawn = |rig: &mut Rig, run: bool, reset: bool| {
        rig.plc.write("Line_DB.run", if run { "TRUE" } else { "FALSE" }).expect("an input");
        rig.plc.write("Line_DB.reset", if reset { "TRUE" } else { "FALSE" }).expect("an input");
        rig.scan().expect("no fault");
        assert_eq!(rig.bool("Line_DB.w.Q"), rig.bool("Line_DB.kept"), "both retain");
        let level = |name: &str| if rig.bool(&format!("Line_DB.{name}")) { '#' } else { '.' };
        ["on", "off", "pulse", "kept"].map(level).into_iter().collect::<String>()
    };
    let scans = [true, true, true, true, false, false, false, true, true].map(|run| drawn(&mut rig, run, false));
    assert_eq!(scans, [".##.", ".##.", ".#..", "##..", ".#..", ".#..", "....", ".##.", ".###"]);
    assert_eq!(rig.plc.read("Line_DB.passed").expect("a duration"), "T#40ms");
    assert_eq!(drawn(&mut rig, true, true), ".#..");
    assert_eq!([rig.int("Line_DB.count"), rig.int("IEC_Counter_0_DB.CV"), rig.int("Line_DB.c.CV")], [1, 1, 2]);
    assert_eq!(rig.int("Line_DB.d.CV"), 5);
    assert!(rig.bool("Line_DB.c.QU") && !rig.bool("Line_DB.full"));
}

/// By its number, or by the title that TIA Portal gives it under any name.
#[test]
fn a_block_of_the_start_runs_once() {
    let blocks = [
        ("OB100", "ORGANIZATION_BLOCK OB100"),
        (
            "Startup",
            "ORGANIZATION_BLOCK \"Startup\"\nTITLE = \"Complete Restart\"\n{ S7_Optimized_Access := 'TRUE' }\nVERSION : 0.1",
        ),
    ];
    for (name, head) in blocks {
        let text = format!(
            "DATA_BLOCK \"data\" STRUCT speed : INT := 1; starts : INT; END_STRUCT; BEGIN speed := 2; END_DATA_BLOCK
{head}
VAR_TEMP twice : INT; END_VAR BEGIN twice := \"data\".speed * 2; \"data\".speed := twice + 40; \"data\".starts += 1;
END_ORGANIZATION_BLOCK
ORGANIZATION_BLOCK \"Main\"\nTITLE = \"Main Program Sweep (Cycle)\"\nVERSION : 0.1
BEGIN \"data\".speed := \"data\".speed + 1; END_ORGANIZATION_BLOCK"
        );
        assert_eq!(findings_in(SiemensScl, &text).to_string(), "", "{name}");
        let application = application_in(SiemensScl, &text);
        let plan = application.single_task(TimeSpan::millis::<10>());
        assert_eq!(plan.tasks[0].programs, ["Main"]);
        let mut rig = Rig::with_plan(&application, &plan);
        assert_eq!(rig.int("data.speed"), 44, "{name}: before the first scan");
        rig.scan().expect("no fault");
        rig.scan().expect("no fault");
        assert_eq!((rig.int("data.speed"), rig.int("data.starts")), (46, 1), "{name}");
        let both = task("cycle", 10, 0, &["Main", name]);
        let wrong = SoftPlc::new(&application, &TaskPlan::new(vec![both])).map(|_| ()).expect_err("it has no task");
        assert_eq!(
            wrong.to_string(),
            format!("task `cycle` runs `{name}`, which every start runs once; take it out of the task")
        );
    }
}

/// Its division goes on with 0, and is another operation: the product before it is cut as well.
#[test]
fn a_product_before_a_division_is_cut() {
    let text = "FUNCTION \"Scale\" : DInt VAR_INPUT raw, span : Int; END_VAR BEGIN #Scale := #raw * 1000 / #span; END_FUNCTION
        ORGANIZATION_BLOCK OB1 VAR_TEMP d : DInt; END_VAR BEGIN #d := \"Scale\"(raw := 3, span := 4); END_ORGANIZATION_BLOCK";
    let found = findings_in(SiemensScl, text).to_string();
    assert!(found.contains("warning[W0713]: this product is cut to INT before it becomes DINT"), "{found}");
}

#[test]
fn a_block_of_the_start_may_write_what_a_task_writes() {
    let text = "DATA_BLOCK \"data\" STRUCT n : INT; END_STRUCT; BEGIN END_DATA_BLOCK
        ORGANIZATION_BLOCK OB100 BEGIN \"data\".n := 1; END_ORGANIZATION_BLOCK
        ORGANIZATION_BLOCK OB1 BEGIN \"data\".n := 2; END_ORGANIZATION_BLOCK";
    let input = Input::from_text("main.scl", SourceKind::Text, text).in_dialect(SiemensScl);
    assert_eq!(inspect([input], None).to_string(), "");
}

#[test]
fn the_first_call_of_an_organization_block_is_known_to_it() {
    let text = "DATA_BLOCK \"g\" STRUCT first, calls, start : Int; END_STRUCT; BEGIN END_DATA_BLOCK
        ORGANIZATION_BLOCK \"OB100\" VAR_INPUT Initial_Call : Bool; END_VAR
        BEGIN IF #Initial_Call THEN \"g\".start := \"g\".start + 1; END_IF; END_ORGANIZATION_BLOCK
        ORGANIZATION_BLOCK \"Main\" VAR_INPUT Initial_Call : Bool; Remanence : Bool; END_VAR
        BEGIN
        \"g\".calls := \"g\".calls + 1;
        IF #Initial_Call THEN \"g\".first := \"g\".first + \"g\".calls; RETURN; END_IF;
        END_ORGANIZATION_BLOCK";
    let mut rig = Rig::in_dialect(SiemensScl, text);
    for _ in 0..3 {
        rig.scan().expect("no fault");
    }
    assert_eq!(["g.calls", "g.first", "g.start"].map(|name| rig.int(name)), [3, 1, 1]);
}

#[test]
fn a_quoted_name_is_a_block_of_the_project() {
    let text = "FUNCTION \"Mid\" : Int VAR_INPUT a : Int; END_VAR BEGIN #Mid := #a + 1; END_FUNCTION
        FUNCTION \"Move\" : Void VAR_INPUT a : Int; END_VAR VAR_OUTPUT b : Int; END_VAR BEGIN #b := #a + 2; END_FUNCTION
        FUNCTION_BLOCK \"F\" VAR r, n : Int; s : String[10]; END_VAR
        BEGIN #r := \"Mid\"(a := 3); \"Move\"(a := 4, b => #n); #s := MID(IN := 'abc', L := 1, P := 2); END_FUNCTION_BLOCK
        DATA_BLOCK \"d\" \"F\" BEGIN END_DATA_BLOCK
        ORGANIZATION_BLOCK \"Main\" BEGIN \"d\"(); END_ORGANIZATION_BLOCK";
    let rig = after_a_scan(text);
    assert_eq!((rig.int("d.r"), rig.int("d.n"), rig.text("d.s").as_str()), (4, 6, "b"));
}
