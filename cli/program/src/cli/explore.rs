//! `onescan explore`.

use std::num::NonZeroU64;
use std::path::PathBuf;

use clap::Args as ClapArgs;
use onescan_server::time::VirtualTime;

use super::error::CommandError;
use super::outputs;
use super::value::FormatArg;
use super::verdict_output::VerdictOutput;
use onescan_runner::error::ExitCode;
use onescan_runner::how_far::{HowFar, Total};
use onescan_search::explore::{self, ExploreConfig};

/// Options of `explore`.
#[derive(Debug, ClapArgs)]
pub struct ExploreArgs {
    /// The scenario: a folder with a scenario.toml
    #[arg(default_value = ".")]
    pub scenario: PathBuf,
    /// The case of its cases.toml to which deviations come [default: the scenario as it is]
    #[arg(long, value_name = "NAME")]
    pub case: Option<String>,
    /// End of each run, in virtual time [default: that of the scenario]
    #[arg(long, value_name = "TIME")]
    pub until: Option<VirtualTime>,
    /// So much is late at a time, at most
    #[arg(long, default_value_t = 1, value_name = "N")]
    pub bound: u32,
    /// Go on after the first finding
    #[arg(long)]
    pub all: bool,
    /// So many runs at most
    #[arg(long, default_value = "100000", value_name = "N")]
    pub runs: NonZeroU64,
    /// Go every way to its end, also where it has come to a state that is known
    #[arg(long)]
    pub no_merge: bool,
    /// Then so many random schedules with more deviations at a time
    #[arg(long, default_value_t = 0, value_name = "N")]
    pub samples: u64,
    /// What they are drawn with
    #[arg(long, default_value_t = 1, value_name = "SEED")]
    pub seed: u64,
    /// So many deviations at a time have random schedules, at most
    #[arg(long, default_value_t = 8, value_name = "N")]
    pub most: u32,
    /// Write what is found as cases into this file
    #[arg(long, value_name = "FILE")]
    pub cases: Option<PathBuf>,
    /// For people; or a JSON object a finding, and one for all
    #[arg(long, value_enum, default_value_t)]
    pub format: FormatArg,
}

/// Tries all timings of a scenario.
///
/// # Errors
/// See [`CommandError`].
pub fn explore(args: ExploreArgs) -> Result<ExitCode, CommandError> {
    outputs::files([&args.cases])?;
    let ExploreArgs { scenario, case, until, bound, all, runs, no_merge, samples, seed, most, cases, format } = args;
    let config = ExploreConfig {
        scenario,
        case,
        until,
        bound,
        all,
        runs_max: runs,
        no_merge,
        samples,
        seed,
        most,
        cases,
        format: format.into(),
        how_far: HowFar::of(["run", "runs"], Total::Most),
    };
    config.how_far.on_signals();
    Ok(explore::run(&config, &mut VerdictOutput::lock())?)
}
