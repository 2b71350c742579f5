//! `onescan minimise`.

use std::num::NonZeroU64;
use std::path::PathBuf;

use clap::Args as ClapArgs;
use onescan_server::signal::ClientName;
use onescan_server::time::VirtualTime;

use super::error::CommandError;
use super::outputs;
use super::value::{FormatArg, client_name};
use super::verdict_output::VerdictOutput;
use onescan_runner::error::ExitCode;
use onescan_search::minimise::{self, MinimiseConfig};

/// Options of `minimise`.
#[derive(Debug, ClapArgs)]
pub struct MinimiseArgs {
    /// The scenario: a folder with a scenario.toml
    #[arg(default_value = ".")]
    pub scenario: PathBuf,
    /// The case of its cases.toml that fails, also one of a matrix or a campaign
    #[arg(long, value_name = "NAME", required_unless_present = "replay_operator")]
    pub case: Option<String>,
    /// What operators did is what fails: a recording, or a file like its `events.jsonl`
    #[arg(long, value_name = "PATH")]
    pub replay_operator: Option<PathBuf>,
    /// Operators stood in for this client; may be given several times
    #[arg(long = "operator", value_name = "CLIENT", value_parser = client_name)]
    pub operators: Vec<ClientName>,
    /// The expectation that is to fail [default: the first that does]
    #[arg(long, value_name = "NAME")]
    pub expect: Option<String>,
    /// End of the run, in virtual time [default: that of the case]
    #[arg(long, value_name = "TIME")]
    pub until: Option<VirtualTime>,
    /// So many trials at most
    #[arg(long, default_value = "1000", value_name = "N")]
    pub runs: NonZeroU64,
    /// Name of the case that is left
    #[arg(long, default_value = "minimised", value_name = "NAME")]
    pub name: String,
    /// Write the case that is left into this file
    #[arg(long, value_name = "FILE")]
    pub cases: Option<PathBuf>,
    /// For people; or a JSON object
    #[arg(long, value_enum, default_value_t)]
    pub format: FormatArg,
}

/// Minimises a case.
///
/// # Errors
/// See [`CommandError`].
pub fn minimise(args: MinimiseArgs) -> Result<ExitCode, CommandError> {
    outputs::files([&args.cases])?;
    let MinimiseArgs { scenario, case, replay_operator, operators, expect, until, runs, name, cases, format } = args;
    let config = MinimiseConfig {
        scenario,
        case,
        operated: operators,
        replay_operator,
        expect,
        until,
        runs_max: runs,
        name,
        cases,
        format: format.into(),
    };
    Ok(minimise::run(&config, &mut VerdictOutput::lock())?)
}
