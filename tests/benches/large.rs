//! What a session costs by the number of its signals and clients: read and checked, compiled and bound, a step.
//!
//! `cargo bench -p onescan-tests --bench large`. Each column divided by the number of signals should not grow.

use std::time::Instant;

use onescan_scenario::Scenario;
use onescan_scenario::compose::Member;
use onescan_server::formation::Formation;
use onescan_server::time::VirtualTime;
use onescan_tests::large;

const STEPS: u64 = 1_000;

fn main() {
    println!("{:>8} {:>8} {:>12} {:>12} {:>12}", "signals", "clients", "read µs/sig", "form µs/sig", "step ns/sig");
    for (signals, clients) in [(1_000, 1), (10_000, 1), (30_000, 1), (100_000, 1), (10_000, 64), (100_000, 64)] {
        let folder = tempfile::tempdir().expect("a folder");
        large::write(folder.path(), signals, clients);
        let started = Instant::now();
        let scenario = Scenario::load(folder.path()).expect("a scenario");
        let read_s = started.elapsed().as_secs_f64();
        let started = Instant::now();
        let mut formation = Formation::new(scenario.plan().clone());
        for name in scenario.plan().clients() {
            let Member::Plc(client) = scenario.member(name).expect("it compiles") else { panic!("a soft PLC") };
            formation.join(client).expect("the plan has a place");
        }
        let mut lockstep = formation.start().expect("all have joined");
        let form_s = started.elapsed().as_secs_f64();
        lockstep.set_until(Some(VirtualTime::from_nanos(STEPS * 1_000_000)));
        let started = Instant::now();
        let outcome = lockstep.run().expect("nothing is recorded");
        let run_s = started.elapsed().as_secs_f64();
        assert_eq!(outcome.steps.0, STEPS);
        let each = |seconds: f64, unit: f64| seconds * unit / signals as f64;
        println!(
            "{signals:>8} {clients:>8} {:>12.2} {:>12.2} {:>12.2}",
            each(read_s, 1e6),
            each(form_s, 1e6),
            each(run_s / STEPS as f64, 1e9)
        );
    }
}
