//! Program text to a PLC that scans. Run it by `cargo run -p onescan-iec --example scan`.

#![expect(clippy::print_stdout, reason = "an example is for the terminal")]

use std::error::Error;

use onescan_iec::{TimeSpan, VirtualTime};
use onescan_iec_run::{Application, SoftPlc};

const BLINK: &str = "
PROGRAM Blink
VAR
    lamp : BOOL;
    pause : TON;
    blinks : INT;
END_VAR
    pause(IN := NOT pause.Q, PT := T#250ms);
    IF pause.Q THEN
        lamp := NOT lamp;
        blinks := blinks + 1;
    END_IF;
END_PROGRAM";

fn main() -> Result<(), Box<dyn Error>> {
    let application = Application::from_sources([("blink.st", BLINK)])?;
    let interval: TimeSpan = "10ms".parse()?;
    let mut plc = SoftPlc::new(&application, &application.single_task(interval))?;
    let blinks = plc.variable("Blink.blinks")?;

    // Virtual time is given to each scan; the PLC has no clock of its own.
    let mut now = VirtualTime::ZERO;
    while now < VirtualTime::ZERO + "2s".parse()? {
        now = now + interval;
        plc.scan(now)?;
    }
    println!("{now}: {} blinks", application.value_text(&blinks, plc.memory()));

    // What is wrong with a text is a list of findings, each with its place.
    if let Err(findings) = Application::from_sources([("wrong.st", BLINK.replace("blinks + 1", "blink + 1"))]) {
        println!("{findings}");
    }
    Ok(())
}
