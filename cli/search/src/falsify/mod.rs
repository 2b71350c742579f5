//! `onescan falsify`: inputs and parameters within their ranges that break what is expected.
//!
//! | module | subject |
//! |---|---|
//! | [`config`] | what is asked for |
//! | `space` | what is varied: a point of a cube is a case |
//! | `optimiser` | which points are simulated next |
//! | `evaluator` | what a point is worth, simulated by a run that forks from others |
//! | `search` | points that the optimiser asks for, simulated, and their worth |
//! | `points` | points that another program chooses |
//! | `picture` | the finding from its start |
//! | `report` | what was found |
//!
//! **Invariants.** A search is a function of the scenario, the optimiser and the seed, not of the number of threads. What
//! is found has the digest of its case run from the start.

pub mod config;
mod evaluator;
mod optimiser;
mod picture;
mod points;
mod report;
mod search;
mod space;

use std::io::{BufRead, Write};

use onescan_report::{OutputError, file};
use onescan_scenario::Scenario;

pub use config::FalsifyConfig;
use report::Case;
use search::Found;
use space::Space;

use onescan_runner::error::{ExitCode, Usage};
use onescan_runner::run::SearchError;

/// Looks for inputs and parameters that break what `config` names, and writes what came of it to `out`. `points` are those
/// of another program, if it chooses them.
///
/// # Errors
/// The scenario is wrong, or a client is not in this process.
pub fn run(config: &FalsifyConfig, points: impl BufRead, out: &mut dyn Write) -> Result<ExitCode, SearchError> {
    let scenario = Scenario::load(&config.scenario)?;
    if scenario.varied().is_empty() {
        let help = "say in `[[falsify.input]]` and `[[falsify.parameter]]` what may be varied (docs/falsify.md)";
        return Err(Usage::new("the scenario does not say what may be varied", Some(help.to_owned())).into());
    }
    let (cased, written) = scenario.case_in_pieces(config.case.as_deref())?;
    let expect = search::expectation(&cased, config.expect.as_deref())?;
    let until = config.until.unwrap_or(cased.until());
    let space = Space::new(&scenario, written, until);
    space.check()?;
    if config.points {
        points::serve(&space, expect, points, out)?;
        return Ok(ExitCode::Ok);
    }
    let found = search::search(config, &space, expect)?;
    let case = kept(config, &space, &found)?;
    report::write(config, &cased, expect, &found, case.as_ref(), out).map_err(OutputError)?;
    Ok(if case.is_some() { ExitCode::Unmet } else { ExitCode::Ok })
}

/// The finding as a case, run from its start, with the files that were asked for. Nothing if there is none.
fn kept(config: &FalsifyConfig, space: &Space<'_>, found: &Found) -> Result<Option<Case>, SearchError> {
    if !found.best.is_finding() {
        return Ok(None);
    }
    let what: Vec<String> = found.best.violated.iter().map(|name| format!("`{name}`")).collect();
    let what = if what.is_empty() { "a client fails".to_owned() } else { format!("{} does not hold", what.join(", ")) };
    let text = space.text(Some(&format!("inputs with which {what}")), &found.best.point);
    let whole = picture::whole(&space.applied(&text)?, space.until)?;
    if let Some(path) = &config.cases {
        file::write_output(path, format!("version = 1\n\n{text}").as_bytes())?;
    }
    if let Some(path) = &config.plot {
        file::write_output(path, whole.plot.to_svg().as_bytes())?;
    }
    Ok(Some(Case { text, digest: whole.digest.map(|digest| digest.to_string()) }))
}
