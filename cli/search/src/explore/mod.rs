//! `onescan explore`: every timing that `[timing]` allows, up to a number of deviations at a time.
//!
//! | module | subject |
//! |---|---|
//! | [`config`] | what is asked for |
//! | [`deviation`] | what happens later than it would, and as a case |
//! | `place` | where something may happen later |
//! | `known` | states from which everything is known to hold |
//! | `path` | one way in which the session may go, forked from another |
//! | `search` | which ways are gone, and in what order |
//! | `sample` | random ways beyond those |
//! | [`report`] | what was found, or that nothing was |
//!
//! **Invariants.** What is found does not depend on where a way forked: it has the digest of its case run from the start.
//! What is said to be exhausted was. A way that is not gone to its end would have held.

pub mod config;
pub mod deviation;
mod known;
mod path;
mod place;
mod report;
mod sample;
mod search;

use std::io::Write;

use onescan_report::{OutputError, file};
use onescan_scenario::Scenario;

pub use config::ExploreConfig;

use report::ExploreReport;

use onescan_runner::error::{ExitCode, Usage};
use onescan_runner::run::SearchError;

/// Tries all timings that `config` asks for, and writes what came of it to `out`.
///
/// # Errors
/// The scenario is wrong, or cannot be forked.
pub fn run(config: &ExploreConfig, out: &mut dyn Write) -> Result<ExitCode, SearchError> {
    let scenario = Scenario::load(&config.scenario)?;
    let (scenario, written) = scenario.case_in_pieces(config.case.as_deref())?;
    let tolerances = scenario.timing_tolerances()?;
    if tolerances.is_empty() {
        let help = "say in `[timing]` which signals may be late, and by how much (docs/explore.md)".to_owned();
        return Err(Usage::new("the scenario does not say what its links may do", Some(help)).into());
    }
    if scenario.expectations().named.is_empty() {
        let help = "write an `[[expect]]`: what must hold whenever signals arrive (docs/expectations.md)".to_owned();
        return Err(Usage::new("the scenario expects nothing", Some(help)).into());
    }
    let until = config.until.unwrap_or(scenario.until());
    let found = search::search(config, &scenario, &tolerances, until)?;
    let report =
        ExploreReport { config, scenario: &scenario, tolerances: &tolerances, found: &found, written: &written };
    report.write(out).map_err(OutputError)?;
    if let Some(path) = &config.cases {
        file::write_output(path, report.cases().as_bytes())?;
    }
    Ok(if found.findings.is_empty() { ExitCode::Ok } else { ExitCode::Unmet })
}
