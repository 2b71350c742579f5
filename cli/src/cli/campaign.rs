//! `onescan campaign` with its processes.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::Args as ClapArgs;
use onescan_server::time::TimeSpan;

use super::error::CommandError;
use super::value::FormatArg;
use crate::campaign::config::{CampaignConfig, WorkerConfig};
use crate::error::ExitCode;
use crate::format::Format;

/// Options of `campaign`.
#[derive(Debug, ClapArgs)]
pub struct CampaignArgs {
    /// The scenario: a folder with a scenario.toml
    #[arg(default_value = ".")]
    pub scenario: PathBuf,
    /// Which campaign of its cases.toml [default: all]
    pub campaign: Option<String>,
    /// How many runs at a time, each in a process of its own [default: as many as there are processors]
    #[arg(short, long, value_name = "N")]
    pub jobs: Option<NonZeroUsize>,
    /// Time that one run may take, wall clock
    #[arg(long, default_value = "10min", value_name = "TIME")]
    pub timeout: TimeSpan,
    /// For people; or a JSON object a run, and one for each campaign
    #[arg(long, value_enum, default_value_t)]
    pub format: FormatArg,
    /// Write a page with the matrix of verdicts and what was read out of each run, all in one file
    #[arg(long, value_name = "FILE")]
    pub html: Option<PathBuf>,
    /// Write a report in the format of `JUnit`
    #[arg(long, value_name = "FILE")]
    pub junit: Option<PathBuf>,
}

/// Options of a process of `campaign`.
#[derive(Debug, ClapArgs)]
pub struct CampaignWorkerArgs {
    /// The scenario
    #[arg(long)]
    pub scenario: PathBuf,
    /// The campaign
    #[arg(long)]
    pub campaign: String,
    /// The case; the run without faults if absent
    #[arg(long)]
    pub case: Option<String>,
}

impl CampaignArgs {
    fn config(self) -> CampaignConfig {
        let format: Format = self.format.into();
        CampaignConfig {
            scenario: self.scenario,
            campaign: self.campaign,
            jobs: self.jobs.unwrap_or_else(|| std::thread::available_parallelism().unwrap_or(NonZeroUsize::MIN)),
            timeout: self.timeout,
            progress: format == Format::Human && std::io::IsTerminal::is_terminal(&std::io::stderr()),
            format,
            html: self.html,
            junit: self.junit,
        }
    }
}

/// Runs campaigns.
///
/// # Errors
/// See [`CommandError`].
pub fn campaign(args: CampaignArgs) -> Result<ExitCode, CommandError> {
    Ok(crate::campaign::run(&args.config(), &mut std::io::stdout().lock())?)
}

/// One run of a campaign, as a process of [`campaign`].
///
/// # Errors
/// See [`CommandError`].
pub fn work(args: CampaignWorkerArgs) -> Result<ExitCode, CommandError> {
    let CampaignWorkerArgs { scenario, campaign, case } = args;
    crate::campaign::worker::work(&WorkerConfig { scenario, campaign, case }, &mut std::io::stdout().lock())?;
    Ok(ExitCode::Ok)
}
