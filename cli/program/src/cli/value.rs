//! What a typed word means, for options of several commands.

use std::num::NonZeroUsize;

use clap::ValueEnum;
use onescan_report::plot::Part;
use onescan_server::signal::{ClientName, SignalName};
use onescan_server::time::VirtualTime;

use onescan_runner::format::Format;

/// Sessions that may go on from moments of another at a time, if nobody says how many.
pub const FORKS: u32 = 8;

/// See [`Format`].
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
pub enum FormatArg {
    /// For people
    #[default]
    Human,
    /// For machines
    Json,
}

impl From<FormatArg> for Format {
    fn from(arg: FormatArg) -> Self {
        match arg {
            FormatArg::Human => Self::Human,
            FormatArg::Json => Self::Json,
        }
    }
}

/// How many are at work at a time: as many as were asked for, else one for each core that can be had.
pub fn jobs_or_cores(asked: Option<NonZeroUsize>) -> NonZeroUsize {
    asked.unwrap_or_else(|| std::thread::available_parallelism().unwrap_or(NonZeroUsize::MIN))
}

/// A signal, as in `axis.x`.
///
/// # Errors
/// Why it is not a name.
pub fn signal_name(text: &str) -> Result<SignalName, String> {
    SignalName::new(text).map_err(|error| error.to_string())
}

/// A client of a session.
///
/// # Errors
/// Why it is not a name.
pub fn client_name(text: &str) -> Result<ClientName, String> {
    ClientName::new(text).map_err(|error| error.to_string())
}

/// Two signals, as in `axis.x,axis.z`.
///
/// # Errors
/// Why they are not two names.
pub fn plane(text: &str) -> Result<[SignalName; 2], String> {
    let (across, up) = text.split_once(',').ok_or("write two signals with a comma between them")?;
    Ok([signal_name(across.trim())?, signal_name(up.trim())?])
}

/// A part of a picture: `2s..2.5s` of one over time, `0.9..1.2,0.3..0.5` of one in a plane.
///
/// # Errors
/// Why it is none.
pub fn part(text: &str) -> Result<Part, String> {
    let Some((across, up)) = text.split_once(',') else {
        let (from, until) = ends(text, |end| end.parse::<VirtualTime>().map_err(|error| error.to_string()))?;
        return Ok(Part::Times { from_ns: from.as_nanos(), until_ns: until.as_nanos() });
    };
    let value = |end: &str| match end.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err(format!("`{end}` is not a number")),
    };
    let (left, right) = ends(across, value)?;
    let (low, high) = ends(up, value)?;
    Ok(Part::Plane { across: [left, right], up: [low, high] })
}

/// Both ends of a range, the lower one first.
fn ends<T: PartialOrd>(text: &str, end: impl Fn(&str) -> Result<T, String>) -> Result<(T, T), String> {
    let (from, to) =
        text.split_once("..").ok_or("write ranges, as in `2s..2.5s` of time, or `0.9..1.2,0.3..0.5` with --xy")?;
    let (from, to) = (end(from.trim())?, end(to.trim())?);
    if from < to { Ok((from, to)) } else { Err(format!("the range `{}` is empty", text.trim())) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_of_a_picture_is_a_range_of_time_or_two_of_values() {
        assert_eq!(part("2s..2500ms"), Ok(Part::Times { from_ns: 2_000_000_000, until_ns: 2_500_000_000 }));
        assert_eq!(part("-0.5..1e-1, 0 .. 2"), Ok(Part::Plane { across: [-0.5, 0.1], up: [0.0, 2.0] }));
        for wrong in [
            "",
            "2s",
            "2..3",
            "2s..2s",
            "3s..2s",
            "0..1,",
            "0..1,2",
            "0..1,1..1",
            "0..x,0..1",
            "0..inf,0..1",
            "NaN..1,0..1",
        ] {
            assert!(part(wrong).is_err(), "{wrong}");
        }
    }
}
