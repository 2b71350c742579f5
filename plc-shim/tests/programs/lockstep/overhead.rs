//! What the shim costs in a scan. It asserts nothing: run it on an idle machine, and read.
//!
//! `cargo test --release -p onescan-plc-shim --test programs overhead -- --ignored --nocapture`

use std::time::Instant;

use onescan_plc_shim::{SoftPlc, TaskPlan, VirtualTime};

use super::driver::{application, original, write};
use crate::rig::{MS, task};

/// Some work between timers: about the size of a small machine's program.
const TEXT: &str = "
PROGRAM Main
VAR_INPUT i : BOOL; END_VAR
VAR_OUTPUT q : BOOL; sum : LREAL; n : DINT; END_VAR
VAR t, u, v : TON; o : TOF; table : ARRAY [0..63] OF LREAL; k : DINT; END_VAR
    t(IN := NOT t.Q, PT := T#50ms); u(IN := t.Q, PT := T#1s); v(IN := i, PT := T#20ms); o(IN := v.Q, PT := T#1s);
    q := o.Q;
    FOR k := 0 TO 63 DO
        table[k] := table[k] * 0.5 + DINT_TO_LREAL(k + n);
        sum := sum * 0.999 + table[k];
    END_FOR;
    n := n + 1;
END_PROGRAM";

const SCANS: u32 = 20_000;

/// The best of some rounds, in nanoseconds a scan.
fn time(mut scan: impl FnMut(u64)) -> f64 {
    let mut now = 0;
    let mut round = || {
        let started = Instant::now();
        for _ in 0..SCANS {
            now += MS;
            scan(now);
        }
        started.elapsed().as_nanos() as f64 / f64::from(SCANS)
    };
    (0..15).map(|_| round()).fold(f64::MAX, f64::min)
}

#[test]
#[ignore = "it measures time"]
#[expect(clippy::print_stdout, reason = "this is what it is for")]
fn overhead_of_the_shim_in_a_scan() {
    let tasks = [task("main", 1, 0, &["Main"])];
    let mut plain = original(TEXT, &tasks);
    let application = application(TEXT, &tasks);
    let scheduled = TaskPlan::new(vec![task("main", 1, 0, &["SDSP_Scheduler", "Main"])]);
    let mut inert = SoftPlc::new(&application, &scheduled).expect("the plan suits");
    write(&mut inert, "SDSP_Simulated", 0);
    let mut granted = SoftPlc::new(&application, &scheduled).expect("the plan suits");
    write(&mut granted, "SDSP_Limit", i64::from(u32::MAX));
    write(&mut granted, "SDSP_Session", 1);
    granted.scan(VirtualTime::from_ns(MS)).expect("no fault");
    let place = |path| granted.variable(path).expect("it exists").offset as usize;
    let (tv, grant, done) = (place("SDSP_TV"), place("SDSP_Grant"), place("SDSP_Done"));
    let mut number = 1_u32;

    let base = time(|now| plain.scan(VirtualTime::from_ns(now)).expect("no fault"));
    let off = time(|now| inert.scan(VirtualTime::from_ns(now)).expect("no fault"));
    let on = time(|now| {
        number += 1;
        granted.memory_mut()[tv..tv + 8].copy_from_slice(&now.to_le_bytes());
        granted.memory_mut()[grant..grant + 4].copy_from_slice(&number.to_le_bytes());
        granted.scan(VirtualTime::from_ns(now)).expect("no fault");
    });
    assert_eq!(granted.memory()[done..done + 4], (number - 1).to_le_bytes());
    for (what, ns) in [("original", base), ("not simulated", off), ("granted", on)] {
        println!("{what:>14}: {ns:8.1} ns a scan, {:+7.1} ns, {:+5.1} %", ns - base, (ns / base - 1.0) * 100.0);
    }
}
