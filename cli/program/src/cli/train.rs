//! `onescan train`.

use std::net::SocketAddr;
use std::path::PathBuf;

use clap::Args as ClapArgs;
use onescan_server::pacing::Pace;
use onescan_server::signal::ClientName;

use super::error::CommandError;
use super::outputs;
use super::run::{gateway, pace};
use super::value::FormatArg;
use super::verdict_output::VerdictOutput;
use onescan_runner::access::admission::Admission;
use onescan_runner::error::ExitCode;
use onescan_runner::interrupt::Interrupt;
use onescan_runner::train::config::Served;
use onescan_runner::train::{self, TrainConfig};

/// Options of `train`.
#[derive(Debug, ClapArgs)]
pub struct TrainArgs {
    /// The scenario: a folder with a `scenario.toml` and a `lessons.toml`
    #[arg(default_value = ".")]
    pub scenario: PathBuf,
    /// The lesson [default: list all of them]
    pub lesson: Option<String>,
    /// Who takes it, as it stands in reports
    #[arg(long, default_value = "trainee", value_name = "NAME")]
    pub trainee: String,
    /// Let a real PLC stand in for a soft PLC, as in `plc=s7://192.168.0.1`: it is started cold and driven to where the lesson
    /// begins [default URL: the scenario's]
    #[arg(long = "gateway", value_name = "CLIENT[=URL]", value_parser = gateway)]
    pub gateways: Vec<(ClientName, Option<String>)>,
    /// Serve the trainee's page, to browsers of this machine unless there is `--access`, and beside it the trainer's, each at an address of its own
    /// [default ADDRESS: a free port]
    #[arg(long, value_name = "ADDRESS:PORT", num_args = 0..=1, require_equals = true, default_missing_value = "127.0.0.1:0", conflicts_with = "replay_operator")]
    pub web: Option<SocketAddr>,
    /// Where the trainer's page is [default: a free port]
    #[arg(long, value_name = "ADDRESS:PORT", default_value = "127.0.0.1:0", hide_default_value = true)]
    pub trainer: SocketAddr,
    /// Let in whoever shows a token of this folder, under TLS if it has a certificate: operators and viewers to the trainee's
    /// page, trainers to both
    #[arg(long, value_name = "DIR", requires = "web")]
    pub access: Option<PathBuf>,
    /// How fast virtual time may run on the pages: `max`, or a factor of real time
    #[arg(long, default_value = "1", value_name = "max|FACTOR", value_parser = pace)]
    pub pace: Pace,
    /// Take the lesson from what operators did: a recording, a file like its `events.jsonl`, or the record of a session,
    /// all of whose attempts are repeated
    #[arg(long, value_name = "PATH")]
    pub replay_operator: Option<PathBuf>,
    /// Record the session in this folder: `session.json`, and each attempt in a folder `run-N`
    #[arg(long, value_name = "DIR")]
    pub record: Option<PathBuf>,
    /// Replace an earlier session in this folder
    #[arg(long, requires = "record")]
    pub overwrite: bool,
    /// Keep prepared states in this folder [default: below the user's cache]
    #[arg(long, value_name = "DIR")]
    pub starts: Option<PathBuf>,
    /// Write a page about the session
    #[arg(long, value_name = "FILE")]
    pub html: Option<PathBuf>,
    /// Set the sessions recorded in the folders below this one side by side, and do nothing else
    #[arg(long, value_name = "DIR", conflicts_with_all = ["lesson", "web", "replay_operator", "record", "html", "gateways"])]
    pub table: Option<PathBuf>,
    /// For people, or one JSON object for machines
    #[arg(long, value_enum, default_value_t)]
    pub format: FormatArg,
}

/// Lets somebody take a lesson.
///
/// # Errors
/// See [`CommandError`].
pub fn train(args: TrainArgs) -> Result<ExitCode, CommandError> {
    outputs::files([&args.html])?;
    outputs::folders([&args.record])?;
    let mut out = VerdictOutput::lock();
    if let Some(folder) = &args.table {
        return Ok(train::table(&args.scenario, folder, args.format.into(), &mut out)?);
    }
    let admission = args.access.map_or(Admission::ThisMachine, Admission::Holders);
    let config = TrainConfig {
        scenario: args.scenario,
        lesson: args.lesson,
        trainee: args.trainee,
        gateways: args.gateways,
        served: args.web.map(|trainee| Served { trainee, trainer: args.trainer, admission, pace: args.pace }),
        replay_operator: args.replay_operator,
        record: args.record,
        overwrite: args.overwrite,
        starts: args.starts,
        html: args.html,
        format: args.format.into(),
    };
    let interrupt = Interrupt::new();
    interrupt.on_signals();
    Ok(train::run(&config, &interrupt, &mut out)?)
}
