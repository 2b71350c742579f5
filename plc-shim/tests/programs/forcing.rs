//! Reading, writing and forcing variables by their path.

use std::fmt::Write;

use onescan_iec::VirtualTime;
use onescan_iec_run::{Application, SoftPlc};

use crate::rig::{MS, Rig, application};

const VALUES: &str = "
TYPE Colour : (Red, Green := 5, Blue); Pair : STRUCT a : INT; b : ARRAY [0..1] OF BOOL; END_STRUCT; Percent : INT (0..100); END_TYPE
FUNCTION_BLOCK Ramp VAR_INPUT up : BOOL; END_VAR VAR_OUTPUT level : INT := 3; END_VAR VAR pairs : ARRAY [1..2] OF Pair; END_VAR
    IF up THEN level := level + 1; END_IF;
END_FUNCTION_BLOCK
PROGRAM P
VAR
    b : BOOL; si : SINT := -5; u : ULINT; byt : BYTE := 15; lw : LWORD; r : REAL := 0.1; l : LREAL := 1.0e300;
    t : TIME := T#1s500ms; lt : LTIME := -LT#5ns; d : DATE := D#2024-02-29; tod : TOD := TOD#12:30:00.25;
    dt : DT := DT#2024-02-29-12:30:00; s : STRING[8] := 'it$'s$N'; w : WSTRING[8] := \"a€$\"\"; c : CHAR := 'x'; wc : WCHAR := \"€\";
    e : Colour; p : Percent; fb : Ramp; many : ARRAY [0..1, -1..0] OF INT := [1, 2, 3, 4];
    i AT %IX0.3 : BOOL; q AT %QX0.1 : BOOL;
END_VAR
VAR CONSTANT k : INT := 4; END_VAR
    fb(up := TRUE); q := i;
END_PROGRAM";

fn rig() -> Rig {
    Rig::new(VALUES)
}

#[test]
fn every_variable_is_shown_as_a_literal() {
    let rig = rig();
    let application = rig.plc.application().clone();
    let leaves = application.leaves().filter(|leaf| leaf.path != "ONESCAN_TV");
    let shown = leaves.map(|leaf| {
        let value = application.value_text(&leaf, rig.plc.memory());
        format!("{} : {} = {value}\n", leaf.path, leaf.type_name)
    });
    insta::assert_snapshot!(shown.collect::<String>());
    let read = |path: &str| rig.plc.read(path).expect(path);
    assert_eq!(
        read("P.fb"),
        "(up := FALSE, level := 3, pairs := [(a := 0, b := [FALSE, FALSE]), (a := 0, b := [FALSE, FALSE])])"
    );
    assert_eq!(read("p.FB.pairs[2]"), "(a := 0, b := [FALSE, FALSE])");
}

#[test]
fn what_is_shown_can_be_written_back() {
    let mut rig = rig();
    let application = rig.plc.application().clone();
    for leaf in application.leaves().filter(|leaf| leaf.path != "P.k" && leaf.path != "ONESCAN_TV") {
        let value = rig.plc.read(&leaf.path).expect("it exists");
        let before = rig.plc.memory().to_vec();
        rig.plc.write(&leaf.path, &value).unwrap_or_else(|error| panic!("{error}"));
        assert!(rig.plc.memory() == before, "{} := {value}", leaf.path);
    }
}

#[test]
fn literals_are_written_by_their_type() {
    let mut rig = rig();
    for (path, text, shown) in [
        ("P.b", "TRUE", "TRUE"),
        ("P.b", "0", "FALSE"),
        ("P.b", "BOOL#true", "TRUE"),
        ("P.si", "SINT#-128", "-128"),
        ("P.si", "16#7F", "127"),
        ("P.u", "18446744073709551615", "18446744073709551615"),
        ("P.byt", "255", "16#FF"),
        ("P.lw", "LWORD#16#FFFF_FFFF_FFFF_FFFF", "16#FFFFFFFFFFFFFFFF"),
        ("P.r", "-1.5e10", "-15000000000.0"),
        ("P.r", "3", "3.0"),
        ("P.l", "-INF", "-INF"),
        ("P.t", "T#-1h30m", "T#-1h30m"),
        ("P.lt", "LTIME#1ns", "LT#1ns"),
        ("P.d", "DATE#1970-01-01", "D#1970-01-01"),
        ("P.s", "'$$'", "'$$'"),
        ("P.w", "\"\"", "\"\""),
        ("P.c", "CHAR#'y'", "'y'"),
        ("P.e", "green", "Green"),
        ("P.e", "Colour#Blue", "Blue"),
        ("P.e", "0", "Red"),
        ("P.many[1,-1]", " -7 ", "-7"),
        ("P.i", "TRUE", "TRUE"),
        ("%QX0.1", "TRUE", "TRUE"),
    ] {
        rig.plc.write(path, text).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(rig.plc.read(path).as_deref(), Ok(shown), "{path} := {text}");
    }
    assert_eq!(rig.plc.read("P.many").as_deref(), Ok("[1, 2, -7, 4]"));
    assert_eq!(rig.plc.read("P.q").as_deref(), Ok("TRUE"));
}

#[test]
fn what_is_no_value_of_the_type_is_reported() {
    let mut rig = rig();
    let before = rig.plc.save();
    let mut refused = String::new();
    for (path, text) in [
        ("P.b", "2"),
        ("P.b", "-TRUE"),
        ("P.si", "128"),
        ("P.si", "1.5"),
        ("P.si", "INT#5"),
        ("P.si", "1 + 1"),
        ("P.si", ""),
        ("P.r", "TRUE"),
        ("P.t", "5"),
        ("P.t", "D#2024-01-01"),
        ("P.d", "D#2024-02-30"),
        ("P.s", "'123456789'"),
        ("P.s", "\"wide\""),
        ("P.s", "plain"),
        ("P.c", "'ab'"),
        ("P.e", "Yellow"),
        ("P.e", "1"),
        ("P.p", "101"),
        ("P.k", "5"),
        ("P.fb", "5"),
        ("P.many", "5"),
        ("P.fb.leval", "5"),
        ("Q.x", "5"),
    ] {
        let error = rig.plc.write(path, text).expect_err(text);
        writeln!(refused, "{error}").expect("a string");
    }
    insta::assert_snapshot!(refused);
    assert_eq!(rig.plc.save(), before);
}

const CHAIN: &str = "
VAR_GLOBAL x, y, z : INT; seen : INT; END_VAR
PROGRAM First VAR_INPUT i : INT; END_VAR VAR_OUTPUT o : INT; END_VAR VAR n : INT; END_VAR
    n := n + 1; seen := i; i := 99; o := 7; y := n;
END_PROGRAM
PROGRAM Second VAR got, own : INT; END_VAR got := y; y := 50; own := y; END_PROGRAM
CONFIGURATION c
    TASK t (INTERVAL := T#10ms);
    PROGRAM a WITH t : First (i := x, o => z); PROGRAM b WITH t : Second;
END_CONFIGURATION";

fn chain() -> Rig {
    let application = application(CHAIN);
    let plan = application.configured_tasks().expect("a configuration");
    Rig::with_plan(&application, &plan)
}

#[test]
fn a_forced_value_stands_where_programs_begin_and_end() {
    let mut rig = chain();
    // An input that is connected, an output that is connected, a global that two programs write.
    for (path, value) in [("a.i", "11"), ("a.o", "22"), ("y", "33")] {
        rig.plc.force(path, value).expect("an INT");
    }
    rig.scan().expect("no fault");
    let read = |path| rig.int(path);
    assert_eq!(["seen", "a.i"].map(read), [11, 11], "after the connection's value, and at the end");
    assert_eq!(["z", "a.o"].map(read), [22, 22], "before the connection takes it");
    assert_eq!(["b.got", "y"].map(read), [33, 33], "between programs, and at the end");
    assert_eq!(read("b.own"), 50, "within a program it is what the program writes");
    assert_eq!(rig.plc.forced().map(|variable| variable.path.as_str()).collect::<Vec<_>>(), ["a.i", "a.o", "y"]);
    assert_eq!(rig.plc.unforce("A.I"), Ok(true));
    assert_eq!(rig.plc.unforce("a.i"), Ok(false));
    rig.plc.unforce("a.x").expect_err("no such variable");
    rig.scan().expect("no fault");
    assert_eq!(["seen", "z"].map(|path| rig.int(path)), [0, 22]);
    for path in ["a.o", "y"] {
        assert_eq!(rig.plc.unforce(path), Ok(true));
    }
    rig.scan().expect("no fault");
    assert_eq!(["z", "y"].map(|path| rig.int(path)), [7, 50]);
}

#[test]
fn a_forced_input_goes_before_what_is_written_from_outside() {
    let mut rig = chain();
    rig.plc.force("x", "5").expect("an INT");
    rig.set("x", 6);
    rig.scan().expect("no fault");
    assert_eq!(["x", "seen"].map(|path| rig.int(path)), [5, 5]);
    rig.plc.write("x", "9").expect("an INT");
    assert_eq!(rig.int("x"), 5);
    rig.plc.force("x", "8").expect("an INT");
    assert_eq!((rig.int("x"), rig.plc.forced().len()), (8, 1));
}

#[test]
fn a_forced_bit_leaves_its_neighbours() {
    let mut rig = Rig::new(
        "PROGRAM P VAR a AT %QX0.0 : BOOL; b AT %QX0.1 : BOOL; w AT %QB0 : BYTE; END_VAR b := NOT b; a := FALSE; END_PROGRAM",
    );
    rig.plc.force("P.a", "TRUE").expect("a BOOL");
    for shown in ["16#03", "16#01", "16#03"] {
        rig.scan().expect("no fault");
        assert_eq!(rig.plc.read("P.w").as_deref(), Ok(shown));
    }
}

#[test]
fn forces_are_part_of_the_state() {
    let mut rig = chain();
    rig.plc.force("y", "33").expect("an INT");
    rig.plc.force("a.n", "4").expect("an INT");
    rig.scan().expect("no fault");
    let state = rig.plc.save();
    let mut other = chain();
    other.plc.force("x", "1").expect("an INT");
    other.plc.restore(&state).expect("its own state");
    assert_eq!(other.plc.save(), state);
    other.now_ns = rig.now_ns;
    for _ in 0..3 {
        rig.scan().expect("no fault");
        other.scan().expect("no fault");
        assert_eq!(rig.plc.save(), other.plc.save());
    }
    assert_eq!(other.plc.unforce("y"), Ok(true));
    assert_ne!(rig.plc.save(), other.plc.save());
}

#[test]
fn forces_outlive_starts_and_end_with_a_reset() {
    let mut rig = chain();
    rig.plc.force("y", "33").expect("an INT");
    for start in [SoftPlc::cold_start, SoftPlc::warm_start] {
        start(&mut rig.plc);
        assert_eq!(rig.int("y"), 33);
    }
    rig.plc.reset();
    assert_eq!((rig.int("y"), rig.plc.forced().len()), (0, 0));
    assert_eq!(rig.plc.save(), chain().plc.save());
}

#[test]
fn iec2_2_7_1_table_49_read_only_access_is_kept() {
    let text = "
        PROGRAM P VAR_INPUT level : INT; END_VAR ; END_PROGRAM
        CONFIGURATION c
            PROGRAM p : P;
            VAR_ACCESS Level : p.level : INT READ_ONLY; Set : p.level : INT READ_WRITE; END_VAR
        END_CONFIGURATION";
    let application = Application::from_sources([("t.st", text)]).expect("no errors");
    let plan = application.configured_tasks().expect("a configuration");
    let mut plc = SoftPlc::new(&application, &plan).expect("a plan");
    assert_eq!(plc.write("Level", "5").expect_err("read only").to_string(), "`Level` is READ_ONLY");
    assert_eq!(plc.force("Level", "5").expect_err("read only").to_string(), "`Level` is READ_ONLY");
    plc.write("Set", "5").expect("it may be written");
    assert_eq!(plc.read("Level").as_deref(), Ok("5"));
    plc.scan(VirtualTime::from_nanos(MS)).expect("no fault");
}

#[test]
fn parts_of_bit_strings_have_paths() {
    let mut rig = Rig::new(
        "PROGRAM P VAR w : ARRAY [1..2] OF WORD := [16#1234, 0]; n : INT := -2; b : BOOL; END_VAR END_PROGRAM",
    );
    let read = |rig: &Rig, path: &str| rig.plc.read(path).unwrap_or_else(|unknown| unknown.to_string());
    let values = ["P.w[1].%X2", "P.w[1].3", "P.w[1].%B1", "P.n.0", "P.n.15"].map(|path| read(&rig, path));
    assert_eq!(values, ["TRUE", "FALSE", "16#12", "FALSE", "TRUE"]);
    rig.plc.write("P.w[2].%X9", "TRUE").expect("a bit");
    rig.plc.force("P.w[2].%B0", "16#FF").expect("a byte");
    assert_eq!(read(&rig, "P.w[2]"), "16#02FF");
    for wrong in ["P.w[1].%X16", "P.w[1].%W0", "P.n.%X3", "P.b.0", "P.w[1].%Q1"] {
        assert!(rig.plc.read(wrong).is_err(), "{wrong}");
    }
}
