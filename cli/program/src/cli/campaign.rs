//! `onescan campaign` with its processes.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::{Args as ClapArgs, Subcommand};
use onescan_server::time::TimeSpan;

use super::error::CommandError;
use super::outputs;
use super::value::{FormatArg, jobs_or_cores};
use super::verdict_output::VerdictOutput;
use onescan_runner::error::ExitCode;
use onescan_runner::format::Format;
use onescan_search::campaign::config::{
    Begun, CampaignConfig, Chosen, MergeConfig, Part, Partition, Reports, WorkerConfig,
};

/// Options of `campaign`.
#[derive(Debug, ClapArgs)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub struct CampaignArgs {
    /// What else is done with campaigns.
    #[command(subcommand)]
    pub command: Option<CampaignCommand>,
    /// The campaigns, and their scenario.
    #[command(flatten)]
    pub chosen: ChosenArgs,
    /// How many runs at a time, each in a process of its own [default: as many as there are processors]
    #[arg(short, long, value_name = "N")]
    pub jobs: Option<NonZeroUsize>,
    /// Time that one run may take, wall clock
    #[arg(long, default_value = "10min", value_name = "TIME")]
    pub timeout: TimeSpan,
    /// Keep the work in this folder: the same command goes on with it after it was stopped or killed
    #[arg(long, value_name = "FOLDER")]
    pub keep: Option<PathBuf>,
    /// Do only part K of N, as `3/8`; `onescan campaign merge` puts the parts together
    #[arg(long, value_name = "K/N", requires = "keep", conflicts_with_all = ["html", "junit"])]
    pub partition: Option<Partition>,
    /// What is written about it.
    #[command(flatten)]
    pub reports: ReportArgs,
}

/// What else is done with campaigns.
#[derive(Debug, Subcommand)]
pub enum CampaignCommand {
    /// Put the parts of a campaign together that were done with `--partition`, on whatever machines
    Merge(MergeArgs),
}

/// Options of `campaign merge`.
#[derive(Debug, ClapArgs)]
pub struct MergeArgs {
    /// The scenario: a folder with a scenario.toml
    pub scenario: PathBuf,
    /// The folders of `--keep`
    #[arg(required = true, value_name = "FOLDER")]
    pub folders: Vec<PathBuf>,
    /// Which campaign of its cases.toml [default: all]
    #[arg(long, value_name = "NAME")]
    pub campaign: Option<String>,
    /// What is written about it.
    #[command(flatten)]
    pub reports: ReportArgs,
}

/// Which campaigns.
#[derive(Debug, ClapArgs)]
pub struct ChosenArgs {
    /// The scenario: a folder with a scenario.toml
    #[arg(default_value = ".")]
    pub scenario: PathBuf,
    /// Which campaign of its cases.toml [default: all]
    pub campaign: Option<String>,
    /// Run each fault to the end, also where its state has come together with the run without faults
    #[arg(long)]
    pub no_merge: bool,
}

/// What is written about campaigns.
#[derive(Debug, ClapArgs)]
pub struct ReportArgs {
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
    /// Where the checkpoints are
    #[arg(long)]
    pub forks: PathBuf,
    /// A case, and where it begins; the run without faults if there is none
    #[arg(long, requires = "journal")]
    pub case: Vec<Begun>,
    /// The journal of the cases
    #[arg(long)]
    pub journal: Option<PathBuf>,
    /// Run to the end
    #[arg(long)]
    pub no_merge: bool,
}

impl From<ChosenArgs> for Chosen {
    fn from(ChosenArgs { scenario, campaign, no_merge }: ChosenArgs) -> Self {
        Self { scenario, campaign, no_merge }
    }
}

impl From<ReportArgs> for Reports {
    fn from(ReportArgs { format, html, junit }: ReportArgs) -> Self {
        Self { format: format.into(), html, junit }
    }
}

impl CampaignArgs {
    fn config(self) -> CampaignConfig {
        let reports: Reports = self.reports.into();
        CampaignConfig {
            chosen: self.chosen.into(),
            jobs: jobs_or_cores(self.jobs),
            timeout: self.timeout,
            keep: self.keep,
            partition: self.partition,
            progress: reports.format == Format::Human && std::io::IsTerminal::is_terminal(&std::io::stderr()),
            reports,
        }
    }
}

/// Runs campaigns, or puts the parts of some together.
///
/// # Errors
/// See [`CommandError`].
pub fn campaign(mut args: CampaignArgs) -> Result<ExitCode, CommandError> {
    outputs::files([&args.reports.html, &args.reports.junit])?;
    let out = &mut VerdictOutput::lock();
    Ok(match args.command.take() {
        None => onescan_search::campaign::run(&args.config(), out)?,
        Some(CampaignCommand::Merge(MergeArgs { scenario, folders, campaign, reports })) => {
            let chosen = Chosen { scenario, campaign, no_merge: false };
            onescan_search::campaign::merge(&MergeConfig { chosen, folders, reports: reports.into() }, out)?
        }
    })
}

/// One run of a campaign, as a process of [`campaign`].
///
/// # Errors
/// See [`CommandError`].
pub fn work(args: CampaignWorkerArgs) -> Result<ExitCode, CommandError> {
    let CampaignWorkerArgs { scenario, campaign, forks, case: cases, journal, no_merge } = args;
    let part = match journal {
        Some(journal) => Part::Cases { cases, journal },
        None => Part::Healthy,
    };
    onescan_search::campaign::worker::work(
        &WorkerConfig { scenario, campaign, forks, no_merge, part },
        &mut std::io::stdout().lock(),
    )?;
    Ok(ExitCode::Ok)
}
