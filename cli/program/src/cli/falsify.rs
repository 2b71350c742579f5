//! `onescan falsify`.

use std::num::{NonZeroU64, NonZeroUsize};
use std::path::PathBuf;

use clap::{Args as ClapArgs, ValueEnum};
use onescan_server::time::VirtualTime;

use super::error::CommandError;
use super::outputs;
use super::value::{FormatArg, jobs_or_cores};
use super::verdict_output::VerdictOutput;
use onescan_runner::error::ExitCode;
use onescan_search::falsify::config::{Objective, OptimiserKind};
use onescan_search::falsify::{self, FalsifyConfig};

/// See [`OptimiserKind`].
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
pub enum OptimiserArg {
    /// CMA-ES: a normal distribution that learns where it is better, begun again where it ends
    #[default]
    CmaEs,
    /// Simulated annealing: jumps that get shorter, also to worse points as long as it is hot
    Annealing,
    /// Each point by itself, evenly
    Random,
}

/// See [`Objective`].
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
pub enum ObjectiveArg {
    /// The margin by which the expectation holds
    #[default]
    Robustness,
    /// Branches of the PLC's program that few runs took
    Coverage,
    /// The margin, less where a run takes branches that none took before
    Both,
}

/// Options of `falsify`.
#[derive(Debug, ClapArgs)]
pub struct FalsifyArgs {
    /// The scenario: a folder with a scenario.toml
    #[arg(default_value = ".")]
    pub scenario: PathBuf,
    /// The case of its cases.toml to which inputs and parameters come [default: the scenario as it is]
    #[arg(long, value_name = "NAME")]
    pub case: Option<String>,
    /// The expectation that is to be broken [default: any]
    #[arg(long, value_name = "NAME")]
    pub expect: Option<String>,
    /// End of each run, in virtual time [default: that of the case]
    #[arg(long, value_name = "TIME")]
    pub until: Option<VirtualTime>,
    /// How inputs and parameters are chosen
    #[arg(long, value_enum, default_value_t)]
    pub optimiser: OptimiserArg,
    /// What is made small
    #[arg(long, value_enum, default_value_t)]
    pub objective: ObjectiveArg,
    /// Seed of the search
    #[arg(long, default_value_t = 1, value_name = "N")]
    pub seed: u64,
    /// So many simulations at most
    #[arg(long, default_value = "300", value_name = "N")]
    pub runs: NonZeroU64,
    /// How many at a time [default: as many as there are processors]
    #[arg(short, long, value_name = "N")]
    pub jobs: Option<NonZeroUsize>,
    /// Do not search: print what the points of standard input are worth, a JSON array of numbers from 0 to 1 a line
    #[arg(long, conflicts_with_all = ["cases", "plot", "runs", "jobs", "seed", "optimiser", "objective"])]
    pub points: bool,
    /// Write what is found as a case into this file
    #[arg(long, value_name = "FILE")]
    pub cases: Option<PathBuf>,
    /// Draw what is found as SVG
    #[arg(long, value_name = "FILE")]
    pub plot: Option<PathBuf>,
    /// For people; or a JSON object
    #[arg(long, value_enum, default_value_t)]
    pub format: FormatArg,
}

/// Looks for inputs and parameters that break what a scenario expects.
///
/// # Errors
/// See [`CommandError`].
pub fn falsify(args: FalsifyArgs) -> Result<ExitCode, CommandError> {
    outputs::files([&args.cases, &args.plot])?;
    let config = FalsifyConfig {
        scenario: args.scenario,
        case: args.case,
        expect: args.expect,
        until: args.until,
        optimiser: match args.optimiser {
            OptimiserArg::CmaEs => OptimiserKind::CmaEs,
            OptimiserArg::Annealing => OptimiserKind::Annealing,
            OptimiserArg::Random => OptimiserKind::Random,
        },
        objective: match args.objective {
            ObjectiveArg::Robustness => Objective::Robustness,
            ObjectiveArg::Coverage => Objective::Coverage,
            ObjectiveArg::Both => Objective::Both,
        },
        seed: args.seed,
        runs_max: args.runs,
        jobs: jobs_or_cores(args.jobs),
        points: args.points,
        cases: args.cases,
        plot: args.plot,
        format: args.format.into(),
    };
    Ok(falsify::run(&config, std::io::stdin().lock(), &mut VerdictOutput::lock())?)
}
