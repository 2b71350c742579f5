//! `onescan minimise`: of what a failing case does, the fewest entries with which it still fails, then the smallest, then
//! the earliest.
//!
//! | module | subject |
//! |---|---|
//! | [`config`] | what is asked for |
//! | `target` | what fails, so that nothing else is taken for it |
//! | `trial` | a set of entries tried, forked from trials before it |
//! | `fewest` | which entries are needed |
//! | `smallest` | entries made shorter, less and earlier |
//! | `report` | what is left, as a case |
//!
//! **Invariants.** What is left was tried, and fails in the same way. Each entry of it was left out by itself, and nothing
//! failed, unless the limit of trials was reached, which is said.

pub mod config;
mod fewest;
mod report;
mod smallest;
mod target;
mod trial;

use std::io::Write;

use onescan_report::{OutputError, file};
use onescan_scenario::Scenario;
use onescan_scenario::case::written::Entry;

pub use config::MinimiseConfig;
use report::Minimised;
use trial::Trials;

use onescan_runner::error::ExitCode;
use onescan_runner::operated;
use onescan_runner::run::{SearchError, operator_inputs};

/// Looks for the least that still fails, and writes it to `out`.
///
/// # Errors
/// The scenario or the case is wrong, nothing fails, or a client is not in this process.
pub fn run(config: &MinimiseConfig, out: &mut dyn Write) -> Result<ExitCode, SearchError> {
    let mut scenario = Scenario::load(&config.scenario)?;
    for client in &config.operated {
        scenario.operate(client)?;
    }
    let (mut whole, mut written) = scenario.case_in_pieces(config.case.as_deref())?;
    if let Some(path) = &config.replay_operator {
        written.entries.extend(operated::entries(&operator_inputs(path)?, &scenario)?);
        whole = scenario.with_last_of(&written.to_toml("operated", &written.entries))?;
    }
    let until = config.until.unwrap_or(whole.until());
    let mut forest = trial::forest(&written.entries, scenario.plan().step());
    let first = target::first(whole, until, config.expect.as_deref(), &mut forest)?;
    let mut entries = written.entries.clone();
    // In the order in which they make a difference; what begins after the failure makes none.
    entries.sort_by_key(Entry::begin);
    entries.retain(|entry| entry.begin() <= first.at);
    let all = written.entries.len();
    let mut trials = Trials::new(&scenario, written, &first, (until, forest), config.runs_max);
    // A name that no case can have is reported before the search.
    trials.applied(&trials.text(&config.name, &[], None, None))?;
    let fewest = fewest::fewest(&mut trials, &entries)?;
    let trials_to_fewest = trials.done();
    let left = smallest::smallest(&mut trials, fewest)?;
    let at = trials.fails(&left)?.unwrap_or(first.at);
    let minimised = Minimised { target: first.target, before: all, left, at, trials_to_fewest };
    let case = minimised.case(config, until, &trials)?;
    report::write(config, &scenario, &minimised, &case, &trials, out).map_err(OutputError)?;
    if let Some(path) = &config.cases {
        file::write_output(path, format!("version = 1\n\n{}", case.text).as_bytes())?;
    }
    Ok(ExitCode::Ok)
}
