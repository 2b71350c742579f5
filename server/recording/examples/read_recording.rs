//! The last steps of a recording, with the digest up to each. Run it on what `onescan run … --record out` wrote:
//! `cargo run -p onescan-recording --example read_recording -- out`.

#![expect(clippy::print_stdout, reason = "an example is for the terminal")]

use std::error::Error;
use std::path::PathBuf;

use onescan_recording::Recording;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args_os().nth(1).map(PathBuf::from).ok_or("name the folder of a recording")?;
    let recording = Recording::open(&folder)?;
    let header = recording.header();
    println!("{}: steps of {}", header.provenance.scenario, header.step);
    let steps = recording.steps().ok_or("it has no steps")?;
    let from = steps.end().saturating_sub(4).max(*steps.start());
    let rows = recording.rows(&[], from..=*steps.end())?;
    for row in &rows.rows {
        let values: Vec<String> = rows
            .columns
            .iter()
            .map(|column| format!("{}={}", column.name, column.ty.to_text(row.bytes(column))))
            .collect();
        println!("{} {} {}\n  {}", row.step.0, row.t_v, row.digest, values.join(" "));
    }
    Ok(())
}
