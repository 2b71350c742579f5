//! Steps a second over the share of steps in which somebody is due, and each as a multiple of a session in which somebody
//! always is: what a step costs in which everybody sleeps. At the end it prints the curve, as a table for `docs/rest.md`.
//!
//! `cargo bench -p onescan-tests --bench rest`

use std::time::{Duration, Instant};

use criterion::{BenchmarkId, Criterion, Throughput};
use onescan_server::plan::Coupling;
use onescan_server::time::VirtualTime;
use onescan_tests::bench::{Ledger, two_sleepers};
use onescan_tests::run::{boxed, in_process};

/// What is measured: its name, and how many steps each client sleeps from turn to turn.
const CASES: [(&str, u64); 10] = [
    ("all due", 1),
    ("1 of 2 due", 2),
    ("1 of 5 due", 5),
    ("1 of 10 due", 10),
    ("1 of 20 due", 20),
    ("1 of 50 due", 50),
    ("1 of 100 due", 100),
    ("1 of 1,000 due", 1_000),
    ("1 of 10,000 due", 10_000),
    ("1 of 1,000,000 due", 1_000_000),
];

/// Runs so many steps of two clients that sleep so long, and takes the time.
fn timed(sleep: u64, steps: u64) -> Duration {
    let (plan, sleepers) = two_sleepers(&Coupling::Parallel, [sleep, sleep]);
    let mut lockstep = in_process(plan, boxed(sleepers));
    lockstep.run_to(VirtualTime::ZERO).expect("nothing is recorded");
    let until = VirtualTime::from_nanos(steps * 1_000_000);
    let started = Instant::now();
    lockstep.run_to(until).expect("nothing is recorded");
    started.elapsed()
}

fn main() {
    let ledger = Ledger::default();
    let mut criterion = Criterion::default().configure_from_args().sample_size(20);
    let mut group = criterion.benchmark_group("rest");
    group.throughput(Throughput::Elements(1));
    for (what, sleep) in CASES {
        group.bench_function(BenchmarkId::from_parameter(what), |bencher| {
            bencher.iter_custom(|steps| {
                let time = timed(sleep, steps);
                ledger.note(what, time, steps);
                time
            });
        });
    }
    group.finish();
    criterion.final_summary();
    for (what, _) in CASES {
        ledger.compare(what, CASES[0].0);
    }
    println!("\n| somebody is due in | steps/s | times as many |\n|---|---|---|");
    let rate = |what: &str| ledger.median(what).map(|step_s| 1.0 / step_s);
    for (what, sleep) in CASES {
        if let (Some(own), Some(all)) = (rate(what), rate(CASES[0].0)) {
            println!("| {} % | {:.2} million | {:.1} |", 100.0 / sleep as f64, own / 1e6, own / all);
        }
    }
}
