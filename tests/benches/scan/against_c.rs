//! Time of one scan of six programs, beside the same programs in C by `gcc -O2`.
//!
//! `cargo bench -p onescan-tests --bench against_c`; names after `--` choose programs.
//!
//! Every program makes its own inputs from a random sequence, other ones in each scan, and ends
//! with a checksum over what it computed, which must be the same in both. The two take turns;
//! each figure is its fastest round, which
//! other work on the machine disturbs least. The time of a scan of ours includes the scheduler
//! and the call from the host, which a scan in C does not have.

mod native;
mod random;
mod rungs;
mod timers;

use std::time::Instant;

use native::Native;
use onescan_iec::{TimeSpan, VirtualTime};
use onescan_iec_run::{Application, SoftPlc};

const INTERVAL_NS: u64 = 10_000_000;
const ROUNDS: usize = 40;
/// Time that one round should take.
const ROUND_NS: f64 = 4e6;

struct Case {
    name: &'static str,
    st: String,
    c: String,
}

fn cases() -> Vec<Case> {
    let case = |name, [st, c]: [String; 2]| Case { name, st, c };
    let files = |st: &str, c: &str| [st.to_owned(), c.to_owned()];
    vec![
        case("rungs", rungs::programs(1)),
        case("control", files(include_str!("control.st"), include_str!("control.c"))),
        case("strings", files(include_str!("strings.st"), include_str!("strings.c"))),
        case("arrays", files(include_str!("arrays.st"), include_str!("arrays.c"))),
        case("timers", timers::programs(2, include_str!("timers.c"))),
        case("nest", files(include_str!("nest.st"), include_str!("nest.c"))),
    ]
}

/// Nanoseconds and the final checksum of so many scans after a cold start.
fn run(plc: &mut SoftPlc, scans: u64) -> (f64, u64) {
    let program = plc.application().programs().next().expect("a case is one program").name;
    let sum = plc.variable(&format!("{program}.sum")).expect("a case has a checksum").offset as usize;
    plc.cold_start();
    let started = Instant::now();
    for scan in 1..=scans {
        plc.scan(VirtualTime::from_nanos(scan * INTERVAL_NS)).expect("it runs");
    }
    let time = started.elapsed().as_nanos() as f64;
    let bytes = plc.memory()[sum..].first_chunk().expect("a checksum is an ULINT");
    (time, u64::from_le_bytes(*bytes))
}

fn median(mut ratios: Vec<f64>) -> f64 {
    ratios.sort_by(f64::total_cmp);
    let middle = ratios.len() / 2;
    if ratios.len() % 2 == 1 { ratios[middle] } else { f64::midpoint(ratios[middle - 1], ratios[middle]) }
}

/// Nanoseconds of one scan, ours and in C.
fn compare(case: &Case) -> [f64; 2] {
    let application = Application::from_sources([(format!("{}.st", case.name), case.st.as_str())]);
    let application = application.unwrap_or_else(|found| panic!("{}: {found}", case.name));
    let plan = application.single_task(TimeSpan::from_nanos(INTERVAL_NS).expect("not zero"));
    let mut plc = SoftPlc::new(&application, &plan).expect("it can run");
    let native = Native::compile(case.name, &case.c);
    let (trial, _) = run(&mut plc, 100);
    let scans = (ROUND_NS / (trial / 100.0)).clamp(100.0, 100_000.0) as u64;
    let mut times = [f64::INFINITY; 2];
    for _ in 0..ROUNDS {
        let ((ours, sum), (theirs, expected)) = (run(&mut plc, scans), native.run(scans));
        assert_eq!(sum, expected, "{}: both compute the same", case.name);
        times = [times[0].min(ours / scans as f64), times[1].min(theirs / scans as f64)];
    }
    times
}

fn main() {
    let wanted: Vec<String> = std::env::args().skip(1).filter(|argument| !argument.starts_with('-')).collect();
    println!("{:10} {:>12} {:>12} {:>7}", "program", "ours ns", "gcc -O2 ns", "ratio");
    let mut ratios = Vec::new();
    for case in cases() {
        if !wanted.is_empty() && !wanted.iter().any(|name| name == case.name) {
            continue;
        }
        let [ours, theirs] = compare(&case);
        println!("{:10} {ours:>12.0} {theirs:>12.0} {:>7.2}", case.name, ours / theirs);
        ratios.push(ours / theirs);
    }
    let worst = ratios.iter().copied().fold(0.0, f64::max);
    println!("median {:.2}, worst {worst:.2}", median(ratios));
}
