//! What survives a warm start, a cold start and a reset (2nd ed. 2.4.2, 3rd ed. 6.5.6).

use std::fmt::Write;

use onescan_iec::TimeSpan;
use onescan_iec_run::SoftPlc;

use crate::rig::{Rig, application};

/// After two scans, the values after a warm start, a cold start and a reset.
fn starts(text: &str, paths: &[&str]) -> String {
    let application = application(text);
    let plan = application.configured_tasks().unwrap_or_else(|| application.single_task(TimeSpan::millis::<10>()));
    let mut table = String::new();
    let mut rows: Vec<Vec<i64>> = vec![Vec::new(); paths.len()];
    let starts: [fn(&mut SoftPlc); 3] = [SoftPlc::warm_start, SoftPlc::cold_start, SoftPlc::reset];
    for start in starts {
        let mut rig = Rig::with_plan(&application, &plan);
        for _ in 0..2 {
            rig.now_ns += 10_000_000;
            rig.plc.scan(onescan_iec::VirtualTime::from_nanos(rig.now_ns)).expect("no fault");
        }
        start(&mut rig.plc);
        paths.iter().zip(&mut rows).for_each(|(path, row)| row.push(rig.int(path)));
    }
    for (path, row) in paths.iter().zip(rows) {
        let values: Vec<String> = row.iter().map(i64::to_string).collect();
        writeln!(table, "{path}: {}", values.join(" ")).expect("a string");
    }
    table
}

#[test]
fn iec2_2_4_2_each_section_says_what_survives() {
    let text = "
        VAR_GLOBAL g : INT := 1; END_VAR VAR_GLOBAL RETAIN gr : INT := 1; END_VAR VAR_GLOBAL PERSISTENT gp : INT := 1; END_VAR
        VAR_GLOBAL RETAIN PERSISTENT grp : INT := 1; END_VAR
        PROGRAM P
        VAR_INPUT i : INT := 1; END_VAR VAR_INPUT RETAIN ir : INT := 1; END_VAR
        VAR_OUTPUT o : INT := 1; END_VAR VAR_OUTPUT RETAIN or1 : INT := 1; END_VAR
        VAR v : INT := 1; END_VAR VAR RETAIN vr : INT := 1; END_VAR VAR PERSISTENT vp : INT := 1; END_VAR
        VAR NON_RETAIN vn : INT := 1; END_VAR VAR RETAIN a AT %MW3 : INT := 1; END_VAR
            g := 3; gr := 3; gp := 3; grp := 3; i := 3; ir := 3; o := 3; or1 := 3; v := 3; vr := 3; vp := 3; vn := 3; a := 3;
        END_PROGRAM";
    let paths = ["g", "gr", "gp", "grp", "P.i", "P.ir", "P.o", "P.or1", "P.v", "P.vr", "P.vp", "P.vn", "P.a"];
    insta::assert_snapshot!(starts(text, &paths), @r"
    g: 1 1 1
    gr: 3 1 1
    gp: 3 3 1
    grp: 3 3 1
    P.i: 1 1 1
    P.ir: 3 1 1
    P.o: 1 1 1
    P.or1: 3 1 1
    P.v: 1 1 1
    P.vr: 3 1 1
    P.vp: 3 3 1
    P.vn: 1 1 1
    P.a: 3 1 1
    ");
}

#[test]
fn iec3_6_5_6_instances_follow_their_section_unless_their_type_says_otherwise() {
    let text = "
        TYPE Box : STRUCT n : INT := 1; inner : Inner; END_STRUCT; END_TYPE
        FUNCTION_BLOCK Inner VAR n : INT := 1; END_VAR VAR RETAIN r : INT := 1; END_VAR n := n + 1; r := r + 1; END_FUNCTION_BLOCK
        FUNCTION_BLOCK Outer
        VAR n : INT := 1; inner : Inner; END_VAR VAR NON_RETAIN never : INT := 1; END_VAR VAR PERSISTENT always : INT := 1; END_VAR
            n := n + 1; never := never + 1; always := always + 1; inner();
        END_FUNCTION_BLOCK
        PROGRAM P
        VAR plain : Outer; END_VAR VAR RETAIN kept : Outer; many : ARRAY [1..2] OF Outer; box : Box; data : ARRAY [0..1] OF INT; END_VAR
            plain(); kept(); many[2](); box.n := box.n + 1; box.inner(); data[1] := 5;
        END_PROGRAM";
    let paths = [
        "P.plain.n",
        "P.plain.inner.r",
        "P.plain.always",
        "P.kept.n",
        "P.kept.never",
        "P.kept.always",
        "P.kept.inner.n",
        "P.kept.inner.r",
        "P.many[2].n",
        "P.many[2].never",
        "P.many[2].inner.n",
        "P.many[2].inner.r",
        "P.box.n",
        "P.box.inner.n",
        "P.box.inner.r",
        "P.data[1]",
    ];
    insta::assert_snapshot!(starts(text, &paths), @r"
    P.plain.n: 1 1 1
    P.plain.inner.r: 3 1 1
    P.plain.always: 3 3 1
    P.kept.n: 3 1 1
    P.kept.never: 1 1 1
    P.kept.always: 3 3 1
    P.kept.inner.n: 1 1 1
    P.kept.inner.r: 3 1 1
    P.many[2].n: 3 1 1
    P.many[2].never: 1 1 1
    P.many[2].inner.n: 1 1 1
    P.many[2].inner.r: 3 1 1
    P.box.n: 3 1 1
    P.box.inner.n: 3 1 1
    P.box.inner.r: 3 1 1
    P.data[1]: 5 0 0
    ");
}

#[test]
fn iec2_2_7_1_table_49_programs_and_resources_retain() {
    let text = "
        PROGRAM P VAR n : INT := 1; END_VAR VAR NON_RETAIN m : INT := 1; END_VAR n := n + 1; m := m + 1; own := own + 1; END_PROGRAM
        CONFIGURATION c
            RESOURCE R ON Soft
                VAR_GLOBAL RETAIN own : INT := 1; END_VAR
                TASK t (INTERVAL := T#10ms);
                PROGRAM a WITH t : P; PROGRAM RETAIN b WITH t : P; PROGRAM NON_RETAIN d WITH t : P;
            END_RESOURCE
        END_CONFIGURATION";
    insta::assert_snapshot!(starts(text, &["a.n", "b.n", "b.m", "d.n", "own"]), @r"
    a.n: 1 1 1
    b.n: 3 1 1
    b.m: 1 1 1
    d.n: 1 1 1
    own: 7 1 1
    ");
}
