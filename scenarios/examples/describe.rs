//! What a scenario's files say, without a run. Run it by
//! `cargo run -p onescan-scenario --example describe -- scenarios/shear`.

#![expect(clippy::print_stdout, reason = "an example is for the terminal")]

use std::error::Error;
use std::path::PathBuf;

use onescan_scenario::Scenario;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args_os().nth(1).map_or_else(|| PathBuf::from("scenarios/shear"), PathBuf::from);
    let scenario = Scenario::load(&folder)?;
    let plan = scenario.plan();
    println!("{}: steps of {} until {}", scenario.name(), plan.step(), scenario.until());
    for signal in plan.signals() {
        let writer = signal.writer.as_ref().map_or_else(|| "nobody".to_owned(), ToString::to_string);
        println!("  {}: {}, written by {writer}", signal.name, signal.ty);
    }
    for (name, _) in &scenario.expectations().named {
        println!("  expects `{name}`");
    }
    Ok(())
}
