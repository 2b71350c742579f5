//! Types, values and times as the session and the PLC have them. Run it by
//! `cargo run -p onescan-base --example types_and_times`.

#![expect(clippy::print_stdout, reason = "an example is for the terminal")]

use std::error::Error;

use onescan_base::duration::IecDuration;
use onescan_base::{SignalType, TimeSpan, VirtualTime, did_you_mean};

fn main() -> Result<(), Box<dyn Error>> {
    // A type by any of its names, and a value of it: its bytes in an image and back.
    let ty: SignalType = "LTIME_OF_DAY".parse()?;
    let bytes = ty.parse_text("3600000000000")?;
    println!("{ty}: {} bytes, {} ns since midnight", ty.size(), ty.to_text(&bytes));

    // One grammar for the times of scenario files, one for those of PLC programs.
    let step: TimeSpan = "2.5ms".parse()?;
    let preset: IecDuration = "1m30s".parse()?;
    let end = VirtualTime::ZERO + step.times(4).ok_or("too long")?;
    println!("four steps of {step} end at {end}; T#{preset} is {} ns", preset.nanos());

    // A task of 10 ms and one of 15 ms are due at multiples of 5 ms.
    let (fast, slow): (TimeSpan, TimeSpan) = ("10ms".parse()?, "15ms".parse()?);
    println!("the period of both is {}", fast.common_divisor(slow));

    println!("{}", did_you_mean("Senosr_1", ["Sensor_1", "Position_1"]).unwrap_or_default());
    Ok(())
}
