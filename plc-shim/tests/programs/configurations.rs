//! CONFIGURATION, RESOURCE, TASK and instances of programs (2nd ed. 2.7, 3rd ed. 6.8).

use std::fmt::Write;

use onescan_iec::input::kind::SourceKind;
use onescan_iec::{Dialect, Input, TaskPlan, VirtualTime};
use onescan_iec_run::{Application, SoftPlc};

use crate::rig::{MS, Rig, application, application_in, findings};

fn configured(text: &str) -> Rig {
    let application = application(text);
    let plan = application.configured_tasks().expect("a configuration");
    Rig::with_plan(&application, &plan)
}

/// The order in which programs ran in each scan of 10 ms, as each of them adds its letter.
fn trace(text: &str, scans: u32, mut act: impl FnMut(u32, &mut Rig)) -> String {
    let mut rig = configured(text);
    rig.step_ns = 10 * MS;
    let mut trace = String::new();
    for scan in 1..=scans {
        act(scan, &mut rig);
        rig.set_bytes("log", &[0; 82]);
        rig.scan().expect("no fault");
        writeln!(trace, "{:>4} ms {}", rig.now_ns / MS, rig.text("log")).expect("a string");
    }
    trace
}

const LOGGER: &str = "
VAR_GLOBAL log : STRING; END_VAR
PROGRAM Logger VAR_INPUT letter : STRING[1]; END_VAR VAR n : INT; END_VAR
    log := CONCAT(log, letter); n := n + 1;
END_PROGRAM";

#[test]
fn iec2_2_7_2_table_50_tasks_run_by_interval_priority_and_edge() {
    let text = format!(
        "{LOGGER}
        CONFIGURATION Cell
            VAR_GLOBAL start : BOOL; END_VAR
            RESOURCE Line ON Soft
                TASK slow (INTERVAL := T#20ms, PRIORITY := 2);
                TASK fast (INTERVAL := T#10ms, PRIORITY := 1);
                TASK event (SINGLE := start, PRIORITY := 0);
                PROGRAM a WITH fast : Logger (letter := 'A');
                PROGRAM b WITH slow : Logger (letter := 'B');
                PROGRAM c WITH event : Logger (letter := 'c');
                PROGRAM d : Logger (letter := 'd');
            END_RESOURCE
        END_CONFIGURATION"
    );
    let start = |scan, rig: &mut Rig| match scan {
        3 | 6 => rig.set("start", 1),
        5 => rig.set("start", 0),
        _ => {}
    };
    insta::assert_snapshot!(trace(&text, 8, start), @r"
    10 ms Ad
    20 ms ABd
    30 ms cAd
    40 ms ABd
    50 ms Ad
    60 ms cABd
    70 ms Ad
    80 ms ABd
    ");
}

#[test]
fn iec2_2_7_2_of_equal_priority_the_one_that_waits_longest_runs_first() {
    let text = format!(
        "{LOGGER}
        CONFIGURATION Cell
            VAR_GLOBAL go : BOOL; END_VAR
            TASK first (INTERVAL := T#40ms); TASK second (INTERVAL := T#30ms); TASK third (SINGLE := go);
            PROGRAM a WITH first : Logger (letter := 'A');
            PROGRAM b WITH second : Logger (letter := 'B');
            PROGRAM c WITH third : Logger (letter := 'c');
        END_CONFIGURATION"
    );
    // Scans only every 50 ms: b has waited since 30 ms, a since 40 ms, the edge is seen now.
    let mut rig = configured(&text);
    rig.step_ns = 50 * MS;
    rig.set("go", 1);
    rig.scan().expect("no fault");
    assert_eq!(rig.text("log"), "BAc");
}

#[test]
fn iec2_2_7_2_an_edge_that_a_task_makes_is_seen_in_the_same_scan() {
    let text = "
        VAR_GLOBAL order : DINT; a, b : BOOL; END_VAR
        PROGRAM P VAR_INPUT d : DINT; END_VAR order := order * 10 + d; a := FALSE; b := TRUE; END_PROGRAM
        PROGRAM Q VAR_INPUT d : DINT; END_VAR order := order * 10 + d; b := FALSE; a := TRUE; END_PROGRAM
        CONFIGURATION c
            TASK t (INTERVAL := T#30ms, PRIORITY := 9); TASK onA (SINGLE := a); TASK onB (SINGLE := b);
            PROGRAM p WITH t : P (d := 1); PROGRAM pA WITH onA : P (d := 2); PROGRAM q WITH onB : Q (d := 3);
        END_CONFIGURATION";
    let mut rig = configured(text);
    rig.step_ns = 30 * MS;
    rig.scan().expect("no fault");
    // p sets b, q runs and sets a, pA runs and sets b: that edge waits, or the two would never end.
    assert_eq!(rig.int("order"), 132);
    rig.set("order", 0);
    rig.scan().expect("no fault");
    assert!(rig.int("order") > 0);
}

const PUMPS: &str = "
FUNCTION_BLOCK Count VAR_INPUT step : INT := 1; END_VAR VAR_OUTPUT n : INT; END_VAR n := n + step; END_FUNCTION_BLOCK
PROGRAM Pump
VAR_INPUT level : INT; END_VAR VAR_OUTPUT double : DINT; END_VAR VAR c : Count; k : INT := 1; END_VAR
    c(); double := level * 2 * k;
END_PROGRAM";

#[test]
fn iec2_2_7_1_table_49_instances_of_one_program_have_their_own_variables() {
    let rig = &mut configured(&format!(
        "{PUMPS}
        CONFIGURATION Plant
            VAR_GLOBAL in1 : INT := 3; out1, out2 : LINT; bits : ARRAY [1..2] OF INT := [5, 6]; END_VAR
            RESOURCE Line ON Soft
                TASK t (INTERVAL := T#10ms);
                PROGRAM P1 WITH t : Pump (level := in1, double => out1);
                PROGRAM P2 WITH t : Pump (level := Plant_k, double => out2);
                PROGRAM P3 WITH t : Pump (level := bits[2] , c.step := 2);
                VAR_GLOBAL CONSTANT Plant_k : INT := 21; END_VAR
            END_RESOURCE
        END_CONFIGURATION"
    ));
    rig.scan().expect("no fault");
    rig.scan().expect("no fault");
    assert_eq!(["out1", "out2", "P3.double"].map(|path| rig.int(path)), [6, 42, 12]);
    assert_eq!(["P1.c.n", "P2.c.n", "P3.c.n"].map(|path| rig.int(path)), [2, 2, 4]);
    // The instance's name, and its path from resource and configuration, are the same variable.
    for path in ["P1.c.n", "line.p1.c.n", "Plant.Line.P1.c.n"] {
        assert_eq!(rig.variable(path).offset, rig.variable("P1.c.n").offset, "{path}");
    }
    assert_eq!(rig.variable("Line.Plant_k").offset, rig.variable("Plant_k").offset);
    let unknown = rig.plc.variable("Line.P4.c.n").expect_err("there are three");
    assert_eq!(unknown.help, None);
    assert_eq!(rig.plc.variable("Lime.P1.k").expect_err("Line").help.as_deref(), Some("did you mean `Line`?"));
}

#[test]
fn iec2_2_7_1_outputs_are_copied_when_their_program_ends() {
    let text = "
        VAR_GLOBAL x : INT; seen : INT; END_VAR
        PROGRAM Source VAR_OUTPUT q : INT; END_VAR q := q + 1; seen := x; END_PROGRAM
        PROGRAM Sink VAR_INPUT i : INT; END_VAR VAR got : INT; END_VAR got := i; i := 99; END_PROGRAM
        CONFIGURATION c
            TASK t (INTERVAL := T#10ms);
            PROGRAM a WITH t : Source (q => x);
            PROGRAM b WITH t : Sink (i := x);
        END_CONFIGURATION";
    let mut rig = configured(text);
    rig.scan().expect("no fault");
    assert_eq!(["x", "seen", "b.got"].map(|path| rig.int(path)), [1, 0, 1]);
    rig.scan().expect("no fault");
    assert_eq!(["x", "seen", "b.got"].map(|path| rig.int(path)), [2, 1, 2]);
}

#[test]
fn iec2_2_7_2_an_instance_of_a_block_has_a_task_of_its_own() {
    let text = "
        FUNCTION_BLOCK Count VAR_INPUT step : INT := 1; END_VAR VAR_OUTPUT n : INT; END_VAR n := n + step; END_FUNCTION_BLOCK
        PROGRAM Main VAR fb : ARRAY [1..2] OF Count; seen : INT; END_VAR fb[2].step := 5; seen := fb[2].n; END_PROGRAM
        CONFIGURATION c
            TASK t (INTERVAL := T#20ms, PRIORITY := 1); TASK u (INTERVAL := T#10ms);
            PROGRAM p WITH t : Main (fb[2] WITH u);
        END_CONFIGURATION";
    let mut rig = configured(text);
    for _ in 0..4 {
        rig.scan().expect("no fault");
    }
    assert_eq!(["p.fb[2].n", "p.fb[1].n", "p.seen"].map(|path| rig.int(path)), [12, 0, 12]);
    insta::assert_snapshot!(findings(&text.replace("seen :=", "fb[2](); seen :=")));
}

#[test]
fn iec2_2_7_1_each_resource_has_its_own_globals() {
    let text = "
        FUNCTION Twice : INT VAR_INPUT x : INT; END_VAR Twice := x * gain; END_FUNCTION
        PROGRAM P VAR_EXTERNAL n : INT; only : DINT; END_VAR VAR r : INT; END_VAR n := n + 1; r := Twice(n); END_PROGRAM
        CONFIGURATION c
            VAR_GLOBAL gain : INT := 2; only : DINT; END_VAR
            RESOURCE A ON Soft
                VAR_GLOBAL n : INT := 10; END_VAR
                TASK t (INTERVAL := T#10ms); PROGRAM P1 WITH t : P;
            END_RESOURCE
            RESOURCE B ON Soft
                VAR_GLOBAL n : INT := 20; gain : INT := 3; END_VAR
                TASK t (INTERVAL := T#10ms); PROGRAM P1 WITH t : P; PROGRAM P2 : P;
            END_RESOURCE
        END_CONFIGURATION";
    let mut rig = configured(text);
    rig.scan().expect("no fault");
    assert_eq!(
        ["A.n", "B.n", "A.P1.r", "B.P1.r", "P2.r", "c.B.gain", "gain"].map(|path| rig.int(path)),
        [11, 22, 22, 63, 66, 3, 2]
    );
    assert!(rig.plc.variable("n").is_err(), "two resources have one");
    assert!(rig.plc.variable("P1.r").is_err(), "two resources have one");
    let names: Vec<String> = rig.plc.application().programs().map(|program| program.name).collect();
    assert_eq!(names, ["A.P1", "B.P1", "P2"]);
}

#[test]
fn iec2_2_7_1_a_resource_does_not_see_the_globals_of_another() {
    insta::assert_snapshot!(findings(
        "FUNCTION_BLOCK Uses n := n + 1; END_FUNCTION_BLOCK
PROGRAM P VAR u : Uses; END_VAR u(); END_PROGRAM
CONFIGURATION c
    RESOURCE A ON Soft VAR_GLOBAL n : INT; END_VAR PROGRAM a : P; END_RESOURCE
    RESOURCE B ON Soft PROGRAM b : P; END_RESOURCE
END_CONFIGURATION"
    ));
}

#[test]
fn iec2_2_7_1_table_49_var_config_gives_instances_their_own_values() {
    let rig = configured(
        "TYPE Pair : STRUCT a, b : INT := 1; END_STRUCT; END_TYPE
        FUNCTION_BLOCK Ramp VAR rate : INT := 1; p : Pair; END_VAR ; END_FUNCTION_BLOCK
        PROGRAM P VAR r : ARRAY [0..1] OF Ramp; t : TON; END_VAR ; END_PROGRAM
        CONFIGURATION c
            RESOURCE Line ON Soft PROGRAM P1 : P; PROGRAM P2 : P; END_RESOURCE
            VAR_CONFIG
                Line.P1.r[1].rate : INT := 7; P2.r[0].p : Pair := (b := 9); c1 : INT := 3; Line.P1.t : TON := (PT := T#3s);
            END_VAR
            VAR_GLOBAL c1 : INT; END_VAR
        END_CONFIGURATION",
    );
    let read = |path| rig.int(path);
    assert_eq!(["P1.r[0].rate", "P1.r[1].rate", "P2.r[1].rate"].map(read), [1, 7, 1]);
    assert_eq!(["P2.r[0].p.a", "P2.r[0].p.b", "P1.r[0].p.b", "c1"].map(read), [1, 9, 1, 3]);
    assert_eq!(["P1.t.PT", "P2.t.PT"].map(read), [3000 * MS as i64, 0]);
}

#[test]
fn iec2_2_4_3_1_var_config_completes_open_addresses() {
    let mut rig = configured(
        "FUNCTION_BLOCK Io VAR lamp AT %Q* : BOOL; END_VAR VAR_INPUT on : BOOL; END_VAR lamp := on; END_FUNCTION_BLOCK
        PROGRAM P VAR key AT %I* : BOOL; n AT %M* : INT; level AT %I* : WORD; io : Io; got : WORD; END_VAR
            io(on := key); n := n + 1; got := level;
        END_PROGRAM
        PROGRAM Area VAR a AT %IX0.0 : BOOL; b AT %IX0.1 : BOOL; c AT %QX0.3 : BOOL; d AT %QX0.4 : BOOL;
            w AT %IW1 : WORD; m AT %MW0 : INT := 7; END_VAR ; END_PROGRAM
        CONFIGURATION c
            TASK t (INTERVAL := T#10ms);
            PROGRAM area WITH t : Area; PROGRAM P1 WITH t : P; PROGRAM P2 WITH t : P;
            VAR_CONFIG
                P1.key AT %IX0.0 : BOOL; P2.key AT %IX0.1 : BOOL; P1.io.lamp AT %QX0.3 : BOOL; P2.io.lamp AT %QX0.4 : BOOL;
                P1.n AT %MW0 : INT; P2.level AT %IW1 : WORD;
            END_VAR
        END_CONFIGURATION",
    );
    rig.plc.write("area.b", "TRUE").expect("a BOOL");
    rig.plc.write("area.w", "16#1234").expect("a WORD");
    rig.scan().expect("no fault");
    rig.scan().expect("no fault");
    let read = |path| rig.plc.read(path).expect(path);
    assert_eq!(
        ["area.c", "area.d", "P2.key", "P1.got", "P2.got"].map(read),
        ["FALSE", "TRUE", "TRUE", "16#0000", "16#1234"]
    );
    assert_eq!(["area.m", "P1.n", "P2.n"].map(read), ["9", "9", "2"]);
    insta::assert_snapshot!(findings(
        "PROGRAM P VAR key AT %I* : BOOL; n : BOOL; w AT %I* : WORD; END_VAR n := key AND w.0; END_PROGRAM
CONFIGURATION c
    PROGRAM P1 : P;
    VAR_CONFIG
        P1.key AT %QX0.0 : BOOL; P1.n AT %IX0.0 : BOOL; P1.w AT %IB3 : WORD; P1.key AT %IX0.9 : BOOL;
    END_VAR
END_CONFIGURATION"
    ));
}

#[test]
fn iec3_table_11_members_at_open_addresses_are_completed_by_var_config() {
    let text = "TYPE Drive : STRUCT ready AT %I* : BOOL; speed AT %QW* : INT; own : INT; END_STRUCT; END_TYPE
        FUNCTION_BLOCK Axis VAR d : Drive; END_VAR
            IF d.ready THEN d.speed := d.speed + 1; END_IF;
        END_FUNCTION_BLOCK
        PROGRAM P VAR axes : ARRAY [1..2] OF Axis; spare : Drive := (speed := 7); END_VAR axes[1](); axes[2](); END_PROGRAM
        PROGRAM Area VAR a AT %IX0.0 : BOOL; b AT %IX0.1 : BOOL; out AT %QW2 : INT; END_VAR ; END_PROGRAM
        CONFIGURATION c
            TASK t (INTERVAL := T#10ms);
            PROGRAM area WITH t : Area; PROGRAM P1 WITH t : P;
            VAR_CONFIG
                P1.axes[1].d.ready AT %IX0.0 : BOOL; P1.axes[2].d.ready AT %IX0.1 : BOOL;
                P1.axes[2].d.speed AT %QW2 : INT;
            END_VAR
        END_CONFIGURATION";
    for dialect in [Dialect::Iec3, Dialect::Codesys, Dialect::TwinCat] {
        let application = application_in(dialect, text);
        let plan = application.configured_tasks().expect("it has tasks");
        let mut rig = Rig::with_plan(&application, &plan);
        rig.plc.write("area.b", "TRUE").expect("a BOOL");
        rig.scan().expect("no fault");
        rig.scan().expect("no fault");
        let read = |path| rig.plc.read(path).expect(path);
        // What VAR_CONFIG does not place lies in its instance.
        assert_eq!(
            ["P1.axes[1].d.speed", "P1.axes[2].d.speed", "P1.axes[2].d.ready", "P1.spare.speed", "area.out"].map(read),
            ["0", "2", "TRUE", "7", "2"],
            "{dialect}"
        );
    }
    insta::assert_snapshot!(findings(
        "TYPE Drive : STRUCT ready AT %I* : BOOL; own : BOOL; END_STRUCT; END_TYPE
PROGRAM P VAR d : Drive; END_VAR ; END_PROGRAM
CONFIGURATION c
    PROGRAM P1 : P;
    VAR_CONFIG P1.d.ready AT %QX0.0 : BOOL; P1.d.own AT %IX0.0 : BOOL; END_VAR
END_CONFIGURATION"
    ));
}

#[test]
fn iec2_2_7_1_table_49_var_access_names_variables() {
    let rig = configured(&format!(
        "{PUMPS} CONFIGURATION c
            RESOURCE Line ON Soft PROGRAM P1 : Pump; END_RESOURCE
            VAR_ACCESS Level : Line.P1.level : INT READ_WRITE; Count1 : P1.c.n : INT; END_VAR
        END_CONFIGURATION"
    ));
    assert_eq!(rig.variable("level").offset, rig.variable("P1.level").offset);
    assert_eq!(rig.variable("c.Count1").offset, rig.variable("P1.c.n").offset);
}

#[test]
fn iec2_2_7_each_rule_has_its_finding() {
    insta::assert_snapshot!(findings(
        "FUNCTION_BLOCK Block VAR_IN_OUT r : INT; END_VAR r := 1; END_FUNCTION_BLOCK
PROGRAM Pump
VAR_INPUT level : INT; END_VAR VAR_OUTPUT full : BOOL; END_VAR VAR n : INT; b : Block; a : ARRAY [1..3] OF INT; END_VAR
VAR CONSTANT k : INT := 1; END_VAR
    b(r := n); full := level > a[1];
END_PROGRAM
PROGRAM Lost ; END_PROGRAM
CONFIGURATION Plant
    VAR_GLOBAL start : BOOL; x, var1 : INT; later : TIME; END_VAR VAR_GLOBAL CONSTANT fixed : BOOL := TRUE; END_VAR
    RESOURCE Line ON Soft
        TASK t1 (INTERVAL := T#10ms, PRIORITY := 1, INTERVAL := T#20ms);
        TASK t2 (INTERVAL := later);
        TASK t3 (SINGLE := x);
        TASK t4 (SINGLE := strat);
        TASK t5 (PRIORITY := 1);
        TASK t6 (INTERVALL := T#1s);
        TASK t7 (INTERVAL := -T#1s, PRIORITY := 70000);
        TASK T1 (INTERVAL := T#1s);
        TASK t8 (INTERVAL := 5);
        PROGRAM p1 WITH t11 : Pump;
        PROGRAM p2 WITH tt : Pump;
        PROGRAM p3 WITH t1 : Pmup;
        PROGRAM p4 WITH t1 : Block;
        PROGRAM P1 WITH t1 : Pump;
        PROGRAM p5 : Pump (level := start);
        PROGRAM p6 : Pump (full := start);
        PROGRAM p7 : Pump (level => x);
        PROGRAM p8 : Pump (full => x);
        PROGRAM p9 : Pump (lvel := 1);
        PROGRAM p10 : Pump (full => fixed);
        PROGRAM p11 : Pump (level := unknown1);
        PROGRAM p12 : Pump (level := 1 + 40000);
        PROGRAM p13 : Pump (b WITH t1);
        PROGRAM p14 : Pump (n WITH t1);
        PROGRAM x : Pump;
    END_RESOURCE
    RESOURCE line ON Soft END_RESOURCE
    VAR_ACCESS
        one : Line.p1.leve : INT; two : Line.p1.level : DINT; one : start : BOOL; three : fixed : BOOL READ_WRITE;
        four : Line.p1.a[4] : INT; five : Linee.p1.n : INT; six : Line : INT; seven : Line.p99.n : INT;
    END_VAR
    VAR_CONFIG
        Line.p1.k : INT := 2; Line.p1 : Pump; Line.p1.n : DINT := 1; Line.p1.n : INT := 70000; Line.p1.n AT %IW3 : INT;
    END_VAR
END_CONFIGURATION
CONFIGURATION Second END_CONFIGURATION"
    ));
}

#[test]
fn a_configured_plc_is_restored_to_the_last_bit() {
    let text = format!(
        "{LOGGER}
        CONFIGURATION Cell
            VAR_GLOBAL start : BOOL; END_VAR
            TASK fast (INTERVAL := T#10ms); TASK event (SINGLE := start, INTERVAL := T#20ms);
            PROGRAM a WITH fast : Logger (letter := 'A');
            PROGRAM c WITH event : Logger (letter := 'c');
            PROGRAM d : Logger (letter := 'd');
        END_CONFIGURATION"
    );
    let mut rig = configured(&text);
    rig.set("start", 1);
    rig.scan().expect("no fault");
    let state = rig.plc.save();
    let mut other = configured(&text);
    other.plc.restore(&state).expect("its own state");
    other.now_ns = rig.now_ns;
    for scan in 0..6 {
        for plc in [&mut rig, &mut other] {
            plc.set("start", i64::from(scan % 3 == 0));
            plc.scan().expect("no fault");
        }
        assert_eq!(rig.plc.save(), other.plc.save(), "scan {scan}");
    }
}

#[test]
fn iec2_2_7_tasks_of_plcopen_xml_run() {
    let project = Input::from_text("line.xml", SourceKind::PlcOpen, include_str!("../inputs/line.xml"));
    let application = Application::from_inputs([project]).unwrap_or_else(|found| panic!("{found}"));
    let plan = application.configured_tasks().expect("a configuration");
    let mut rig = Rig::with_plan(&application, &plan);
    rig.set("Go", 1);
    for _ in 0..3 {
        rig.scan().expect("no fault");
    }
    assert_eq!(rig.now_ns, 60 * MS);
    assert_eq!(
        ["P1.Runs", "P2.Runs", "P3.Runs", "Count", "Line_1.Station.P2.Step"].map(|path| rig.int(path)),
        [3, 5, 3, 3, 5]
    );
}

#[test]
fn tasks_of_a_twincat_project_are_one_configuration() {
    let object = |name: &str, text: String| Input::from_text(name, SourceKind::TwinCat, text);
    let program = |name: &str| {
        let declared = format!("PROGRAM {name} VAR n : INT; END_VAR");
        let text = format!(
            "<TcPlcObject><POU Name=\"{name}\"><Declaration>{declared}</Declaration>
            <Implementation><ST>n := n + 1;</ST></Implementation></POU></TcPlcObject>"
        );
        object(&format!("{name}.TcPOU"), text)
    };
    let task = |name: &str, cycle: u32, called: &str| {
        let text = format!(
            "<TcPlcObject><Task Name=\"{name}\"><CycleTime>{cycle}</CycleTime><Priority>20</Priority>
            <PouCall><Name>{called}</Name></PouCall></Task></TcPlcObject>"
        );
        object(&format!("{name}.TcTTO"), text)
    };
    let files = [program("MAIN"), program("Slow"), task("Fast", 10_000, "MAIN"), task("Other", 20_000, "Slow")];
    let application = Application::from_inputs(files).unwrap_or_else(|found| panic!("{found}"));
    let plan = application.configured_tasks().expect("a configuration");
    let mut rig = Rig::with_plan(&application, &plan);
    for _ in 0..4 {
        rig.scan().expect("no fault");
    }
    assert_eq!(["MAIN.n", "Slow.n"].map(|path| rig.int(path)), [4, 2]);
    let unknown = [program("MAIN"), task("Fast", 10_000, "MIAN")];
    let found = Application::from_inputs(unknown).expect_err("there is no MIAN");
    insta::assert_snapshot!(found.to_string());
}

#[test]
fn without_a_configuration_there_is_no_plan_of_ones_own() {
    let application = application("PROGRAM P ; END_PROGRAM");
    assert_eq!(application.configured_tasks(), None);
    let empty = Application::from_sources([("e.st", "CONFIGURATION c END_CONFIGURATION")]).expect("no errors");
    let plan = empty.configured_tasks().expect("a configuration");
    let error = SoftPlc::new(&empty, &plan).expect_err("nothing runs");
    assert_eq!(error.to_string(), "the plan has no tasks");
}

#[test]
fn a_plan_of_ones_own_goes_before_the_configuration() {
    let application = application(&format!(
        "{PUMPS} CONFIGURATION c TASK t (INTERVAL := T#10ms); PROGRAM P1 WITH t : Pump; PROGRAM P2 : Pump; END_CONFIGURATION"
    ));
    let plan = TaskPlan::new(vec![crate::rig::task("own", 5, 0, &["P2"])]);
    let mut plc = SoftPlc::new(&application, &plan).expect("P2 is an instance");
    plc.scan(VirtualTime::from_nanos(5 * MS)).expect("no fault");
    let read = |path: &str| plc.memory()[plc.variable(path).expect("there").offset as usize];
    assert_eq!((read("P1.c.n"), read("P2.c.n")), (0, 1));
    let plan = TaskPlan::new(vec![crate::rig::task("own", 5, 0, &["Pump"])]);
    let error = SoftPlc::new(&application, &plan).expect_err("the program is not an instance");
    assert_eq!(error.to_string(), "task `own` runs program `Pump`, which is not declared");
}
