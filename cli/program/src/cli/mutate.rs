//! `onescan mutate`.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::Args as ClapArgs;
use onescan_iec_project::mutate::MutantKind;
use onescan_server::signal::ClientName;

use super::error::CommandError;
use super::outputs;
use super::value::{FormatArg, client_name, jobs_or_cores};
use super::verdict_output::VerdictOutput;
use onescan_runner::error::ExitCode;
use onescan_search::mutate::{self, MutateConfig};

/// Options of `mutate`.
#[derive(Debug, ClapArgs)]
pub struct MutateArgs {
    /// The scenario: a folder with a scenario.toml
    #[arg(default_value = ".")]
    pub scenario: PathBuf,
    /// The soft PLC in whose program mistakes are made [default: all]
    #[arg(long, value_name = "CLIENT", value_parser = client_name)]
    pub client: Option<ClientName>,
    /// A case that is to notice them; may be given several times [default: all of its cases.toml]
    #[arg(long = "case", value_name = "NAME")]
    pub cases: Vec<String>,
    /// What is changed: `operator`, `constant`, `condition`, `statement`, `timer`; may be given several times [default: all]
    #[arg(long = "kind", value_name = "KIND")]
    pub kinds: Vec<MutantKind>,
    /// Fail unless so many percent are noticed of those that can be distinguished from the program
    #[arg(long, value_name = "PERCENT", value_parser = clap::value_parser!(u8).range(0..=100))]
    pub at_least: Option<u8>,
    /// Write those that survived as cases into this file, each on top of the case in which it shows
    #[arg(long = "cases", value_name = "FILE")]
    pub written: Option<PathBuf>,
    /// How many at a time [default: as many as there are processors]
    #[arg(short, long, value_name = "N")]
    pub jobs: Option<NonZeroUsize>,
    /// For people; or a JSON object a mutant, and one for all
    #[arg(long, value_enum, default_value_t)]
    pub format: FormatArg,
}

/// Makes mistakes in a scenario's programs.
///
/// # Errors
/// See [`CommandError`].
pub fn mutate(args: MutateArgs) -> Result<ExitCode, CommandError> {
    outputs::files([&args.written])?;
    let MutateArgs { scenario, client, cases, kinds, at_least, written, jobs, format } = args;
    let jobs = jobs_or_cores(jobs);
    let format = format.into();
    let progress = format == onescan_runner::format::Format::Human;
    let config = MutateConfig { scenario, client, cases, kinds, at_least, written, jobs, progress, format };
    Ok(mutate::run(&config, &mut VerdictOutput::lock())?)
}
