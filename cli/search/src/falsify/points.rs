//! Points that somebody else chooses: what each is worth, line by line, for optimisers of other programs.

use std::io::{BufRead, Write};

use onescan_report::OutputError;
use serde_json::json;

use super::evaluator::{Evaluator, Forks, Wanted};
use super::space::{Point, Space};
use onescan_runner::error::Usage;
use onescan_runner::run::SearchError;

/// Simulates the point of each line of `points`, and writes what it is worth to `out` before it reads the next.
///
/// # Errors
/// A line is not a point, or a session cannot be formed or go on.
pub(super) fn serve(
    space: &Space<'_>,
    expect: Option<usize>,
    points: impl BufRead,
    out: &mut dyn Write,
) -> Result<(), SearchError> {
    let mut evaluator = Evaluator::new(space, expect, Wanted::Margins, Forks::Everywhere);
    for (number, line) in points.lines().enumerate() {
        let wrong = |what: String| {
            let help = format!("a point has {} numbers from 0 to 1, as a JSON array on a line", space.dimensions());
            Usage::new(format!("line {} of the points: {what}", number + 1), Some(help))
        };
        let line = line.map_err(|error| wrong(error.to_string()))?;
        let point: Point = serde_json::from_str(&line).map_err(|error| wrong(error.to_string()))?;
        if point.len() != space.dimensions() {
            return Err(wrong(format!("it has {} numbers", point.len())).into());
        }
        if let Some(outside) = point.iter().find(|x| !(0.0..=1.0).contains(*x)) {
            return Err(wrong(format!("{outside} is not from 0 to 1")).into());
        }
        let sample = evaluator.simulate(&point)?;
        let line = json!({ "robustness": sample.robustness, "violated": sample.violated, "failure": sample.failure,
            "digest": sample.digest.map(|digest| digest.to_string()), "forked_ns": sample.forked });
        writeln!(out, "{line}").and_then(|()| out.flush()).map_err(OutputError)?;
    }
    Ok(())
}
