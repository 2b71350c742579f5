//! What a step of each machine to learn on costs, with its solution in text and the inputs of its default case, beside a step of the
//! filling machine in the same run: machines differ by a factor of two, so what counts is the ratio. What judging adds is not in it.
//!
//! `cargo bench -p onescan-tests --bench learn`

use std::path::{Path, PathBuf};
use std::time::Instant;

use onescan_scenario::Scenario;
use onescan_tests::bench::session_of;

const STEP_MS: u64 = 10;
const RUN_S: u64 = 120;
const RUNS: usize = 5;

/// Microseconds of a step.
fn step_us(scenario: &Scenario) -> f64 {
    let mut lockstep = session_of(scenario, RUN_S);
    let started = Instant::now();
    lockstep.run().expect("nothing is recorded");
    started.elapsed().as_secs_f64() * 1e6 * STEP_MS as f64 / (RUN_S * 1000) as f64
}

fn main() {
    let scenarios = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios");
    let mut names: Vec<PathBuf> = std::fs::read_dir(scenarios.join("learn"))
        .expect("a folder")
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| path.join("solution-st.toml").exists())
        .collect();
    names.sort();
    let filling = Scenario::load(&scenarios.join("filling-machine")).expect("a scenario");
    let machines: Vec<(String, Scenario)> = names
        .iter()
        .map(|path| {
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            let case = Scenario::load_case(&path.join("solution-st.toml"), Some("default")).expect("a case");
            (name, case)
        })
        .collect();
    let mut beside_us = f64::INFINITY;
    let mut least_us = vec![f64::INFINITY; machines.len()];
    // In turns, so that whatever else the computer does burdens all alike.
    for _ in 0..RUNS {
        beside_us = beside_us.min(step_us(&filling));
        for (least, (_, scenario)) in least_us.iter_mut().zip(&machines) {
            *least = least.min(step_us(scenario));
        }
    }
    println!("filling machine: {beside_us:.1} µs a step");
    for (least_us, (name, _)) in least_us.iter().zip(&machines) {
        println!("{name}: {least_us:.1} µs, {:.1} %", 100.0 * least_us / beside_us);
    }
}
