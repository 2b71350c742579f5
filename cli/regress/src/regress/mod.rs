//! `onescan test`: all scenarios and cases run and held against what was reviewed; ST test programs run.
//!
//! Modules in the order in which data flows through them:
//!
//! | module | subject |
//! |---|---|
//! | [`config`] | what is asked for |
//! | [`discover`] | which scenarios and sources are meant |
//! | [`selection`] | which tests are meant, by name and tag |
//! | [`plan`] | units of work, filtered |
//! | [`pool`] | units in processes of their own, several at a time |
//! | `limited` | a process that may take so long and no longer |
//! | [`worker`] | one unit, in such a process |
//! | `declared`, `attributes` | tests as sources declare them, and what stands before them |
//! | [`unit_test`], `memory_text` | test programs in ST, each in a fresh PLC |
//! | `tcunit` | the suites of `TcUnit`, and what it stores of them |
//! | [`ran`] | what a process says of its unit |
//! | [`outcome`] | passed, changed, failed: what came of each test |
//! | [`summary`] | for people and as JSON |
//! | [`junit`], [`sarif`], [`page`], [`github`] | reports for others |
//! | `live` | what is said while tests run |
//! | [`coverage`] | what all tests executed together |
//!
//! **Invariants.** The order of tests, and all that is said of them, depends on their names alone, not on
//! who was done first. `--check` writes nothing beside a scenario.

mod attributes;
pub mod cause;
pub mod config;
pub mod coverage;
mod declared;
pub mod discover;
mod error;
pub mod github;
pub mod junit;
pub mod limited;
mod live;
mod memory_text;
pub mod outcome;
pub mod page;
mod place;
pub mod plan;
pub mod pool;
pub mod ran;
mod reference;
pub mod sarif;
pub mod selection;
pub mod summary;
mod tcunit;
pub mod unit_test;
pub mod worker;

use std::io::Write;
use std::path::PathBuf;

use onescan_report::OutputError;
use onescan_report::file;

pub use config::{Policy, Progress, TestConfig, TestFormat};
pub use error::TestError;
pub use selection::Selection;

use crate::check::collect::Reading;
use crate::check::stubs;
use discover::Found;
use onescan_runner::error::ExitCode;
use outcome::Outcome;

/// Refuses tests whose sources call stubs.
///
/// # Errors
/// Some do, or they cannot be read.
pub fn deny_stubs(paths: &[PathBuf], reading: Reading) -> Result<(), TestError> {
    let found = Found::behind(paths)?;
    if !found.sources.is_empty() {
        stubs::deny(&found.sources, reading)?;
    }
    for scenario in found.scenarios {
        stubs::deny(&[scenario], Reading::default())?;
    }
    Ok(())
}

/// Runs all tests that `config` asks for, and writes what came of them to `out`.
///
/// # Errors
/// There is nothing to test, or a report cannot be written. What is wrong with a test is not an error here
/// but an outcome.
pub fn test(config: &TestConfig, out: &mut dyn Write) -> Result<ExitCode, TestError> {
    let started = std::time::Instant::now();
    let units = plan::units(config)?;
    plan::warn_of_programs(&units);
    let worked = pool::work(config, &units)?;
    let mut outcomes: Vec<Outcome> = Vec::new();
    for (unit, worked) in units.iter().zip(&worked) {
        outcomes.extend(outcome::judge(config, unit, worked)?);
    }
    if outcomes.is_empty() {
        return Err(plan::none_chosen("none of the tests").into());
    }
    cause::explain(config, &units, &mut outcomes)?;
    let orphans = plan::orphans(config, &units)?;
    let executed = coverage::merged(&units, &worked);
    let coverage = config.coverage.is_some().then(|| [executed.lines(), executed.branches()]);
    let report = outcome::Report { outcomes, orphans, coverage, wall_time: started.elapsed() };
    write_reports(config, &report, &executed)?;
    match config.format {
        TestFormat::Human => summary::write_human(config, &report, out),
        TestFormat::Json => summary::write_json(&report, out),
        TestFormat::Github => summary::write_human(config, &report, out)
            .and_then(|()| write!(out, "{}", github::annotations(&report)))
            .and_then(|()| out.flush()),
    }
    .map_err(OutputError)?;
    live::end(config.progress, &report);
    Ok(report.exit_code())
}

fn write_reports(
    config: &TestConfig,
    report: &outcome::Report,
    coverage: &onescan_iec_run::Coverage,
) -> Result<(), TestError> {
    if let Some(request) = &config.coverage {
        request.write_report(coverage)?;
    }
    if let Some(path) = &config.junit {
        file::write_output(path, junit::text(report).as_bytes())?;
    }
    if let Some(path) = &config.sarif {
        file::write_output(path, sarif::text(report).as_bytes())?;
    }
    if let Some(path) = &config.job_summary {
        github::append(path, report)?;
    }
    if let Some(path) = &config.html {
        file::write_output(path, page::of_tests(report, coverage).to_html().as_bytes())?;
    }
    Ok(())
}
