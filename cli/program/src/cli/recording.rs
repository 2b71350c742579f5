//! What is done with recordings: `onescan export`, `diff`, `view`, `report`, and `bisect`, which makes its own.

use std::net::SocketAddr;
use std::path::PathBuf;

use clap::{Args as ClapArgs, ValueEnum};
use onescan_recording::ExportFormat;
use onescan_server::signal::pattern::SignalPattern;
use onescan_server::time::VirtualTime;

use super::error::CommandError;
use super::outputs;
use super::value::{FORKS, FormatArg};
use super::verdict_output::VerdictOutput;
use crate::export::ExportConfig;
use onescan_regress::bisect::BisectConfig;
use onescan_regress::diff::DiffConfig;
use onescan_runner::access::admission::Admission;
use onescan_runner::error::ExitCode;
use onescan_runner::error::Usage;
use onescan_runner::interrupt::Interrupt;
use onescan_runner::past::Budget;
use onescan_runner::report::ReportConfig;
use onescan_runner::view::ViewConfig;

/// Options of `export`.
#[derive(Debug, ClapArgs)]
pub struct ExportArgs {
    /// The recording: a folder with a `recording.json`, or with one such folder in it
    pub recording: PathBuf,
    /// The form [default: by the file's name]
    #[arg(long, value_enum, value_name = "FORMAT")]
    pub format: Option<ExportArg>,
    /// The file to write
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Only these signals: a name, or a pattern with `*` and `?`; may be given several times
    #[arg(long, value_name = "PATTERN")]
    pub signals: Vec<SignalPattern>,
    /// From this virtual time on, as in `2.5s`
    #[arg(long, value_name = "TIME")]
    pub from: Option<VirtualTime>,
    /// Up to this virtual time
    #[arg(long, value_name = "TIME")]
    pub to: Option<VirtualTime>,
}

/// A form that a recording is written in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ExportArg {
    /// For spreadsheets
    Csv,
    /// For analysis, as one file
    Parquet,
    /// For viewers of robots and their logs: Foxglove, `PlotJuggler`
    Mcap,
}

/// Writes a recording in another form.
///
/// # Errors
/// See [`CommandError`].
pub fn export(args: ExportArgs) -> Result<ExitCode, CommandError> {
    let extension = args.output.extension().map(|extension| extension.to_string_lossy().to_ascii_lowercase());
    let format = match (args.format, extension.as_deref()) {
        (Some(ExportArg::Csv), _) | (None, Some("csv")) => ExportFormat::Csv,
        (Some(ExportArg::Parquet), _) | (None, Some("parquet")) => ExportFormat::Parquet,
        (Some(ExportArg::Mcap), _) | (None, Some("mcap")) => ExportFormat::Mcap,
        (None, _) => {
            let message = format!("the name `{}` does not say in which form to write", args.output.display());
            return Err(Usage::new(message, Some("add `--format csv`, `parquet` or `mcap`".to_owned())).into());
        }
    };
    let times = [args.from.unwrap_or(VirtualTime::ZERO), args.to.unwrap_or(VirtualTime::MAX)];
    let ExportArgs { recording, output, signals, .. } = args;
    crate::export::export(&ExportConfig { recording, format, output, signals, times })?;
    Ok(ExitCode::Ok)
}

/// Options of `diff`.
#[derive(Debug, ClapArgs)]
pub struct DiffArgs {
    /// A recording: a folder with a `recording.json`, or with one such folder in it; or a snapshot
    pub a: PathBuf,
    /// Another
    pub b: PathBuf,
    /// What was before this virtual time does not count; then signals are compared, not digests
    #[arg(long = "from", alias = "since", default_value = "0s", value_name = "TIME")]
    pub since: VirtualTime,
    /// Compare these signals only: a name, or a pattern with `*` and `?`; may be given several times
    #[arg(long, value_name = "PATTERN")]
    pub signals: Vec<SignalPattern>,
    /// For people, or a JSON object for machines
    #[arg(long, value_enum, default_value_t)]
    pub format: FormatArg,
}

/// Compares two recordings.
///
/// # Errors
/// See [`CommandError`].
pub fn diff(args: DiffArgs) -> Result<ExitCode, CommandError> {
    let DiffArgs { a, b, since, signals, format } = args;
    let config = DiffConfig { recordings: [a, b], since, signals, format: format.into() };
    Ok(onescan_regress::diff::diff(&config, &mut VerdictOutput::lock())?)
}

/// Options of `report`.
#[derive(Debug, ClapArgs)]
pub struct ReportArgs {
    /// Recordings: folders with a `recording.json`, or with one such folder in it
    #[arg(required = true)]
    pub recordings: Vec<PathBuf>,
    /// Report what the `[report]` of this scenario asks for [default: the recorded scenario's own]
    #[arg(long, value_name = "SCENARIO")]
    pub scenario: Option<PathBuf>,
    /// For people, or one JSON object a recording for machines
    #[arg(long, value_enum, default_value_t)]
    pub format: FormatArg,
    /// Write a page with the reports of all recordings, all in one file
    #[arg(long, value_name = "FILE")]
    pub html: Option<PathBuf>,
}

/// Reports what recorded runs produced.
///
/// # Errors
/// See [`CommandError`].
pub fn report(args: ReportArgs) -> Result<ExitCode, CommandError> {
    outputs::files([&args.html])?;
    let ReportArgs { recordings, scenario, format, html } = args;
    let config = ReportConfig { recordings, scenario, format: format.into(), html };
    onescan_runner::report::report(&config, &mut std::io::stdout().lock())?;
    Ok(ExitCode::Ok)
}

/// Options of `view`.
#[derive(Debug, ClapArgs)]
pub struct ViewArgs {
    /// The recording: a folder with a `recording.json`, or with one such folder in it
    pub recording: PathBuf,
    /// Let in whoever shows a token of this folder, under TLS if it has a certificate
    #[arg(long, value_name = "DIR")]
    pub access: Option<PathBuf>,
    /// Where the page is served: an address of this machine, or any with `--access` [default: a free port]
    #[arg(long, value_name = "ADDRESS:PORT", default_value = "127.0.0.1:0", hide_default_value = true)]
    pub web: SocketAddr,
    /// How much memory moments of the re-run may take, as in `256MiB`
    #[arg(long, default_value_t, value_name = "MEMORY")]
    pub past_memory: Budget,
    /// How many sessions may go on from moments of this one at a time, each in a process of its own
    #[arg(long, default_value_t = FORKS, value_name = "COUNT")]
    pub forks: u32,
}

/// Shows a recording as a page.
///
/// # Errors
/// See [`CommandError`].
pub fn view(args: ViewArgs) -> Result<ExitCode, CommandError> {
    let interrupt = Interrupt::new();
    interrupt.on_signals();
    let ViewArgs { recording, access, web, past_memory: past, forks } = args;
    let admission = access.map_or(Admission::ThisMachine, Admission::Holders);
    let config = ViewConfig { recording, web, admission, past, forks };
    Ok(onescan_runner::view::view(&config, &interrupt, &mut std::io::stdout().lock())?)
}

/// Options of `bisect`.
#[derive(Debug, ClapArgs)]
pub struct BisectArgs {
    /// The scenario: a folder with a `scenario.toml`, in a working tree of git
    #[arg(default_value = ".")]
    pub scenario: PathBuf,
    /// A commit whose runs are as they should be
    #[arg(long, value_name = "COMMIT")]
    pub good: String,
    /// A later commit whose runs are not
    #[arg(long, value_name = "COMMIT", default_value = "HEAD")]
    pub bad: String,
    /// Virtual time at which a run is complete [default: the scenario's `until`]
    #[arg(long, value_name = "TIME")]
    pub until: Option<VirtualTime>,
    /// For people, or a JSON object for machines
    #[arg(long, value_enum, default_value_t)]
    pub format: FormatArg,
}

/// Finds the commit that first changed a run.
///
/// # Errors
/// See [`CommandError`].
pub fn bisect(args: BisectArgs) -> Result<ExitCode, CommandError> {
    let interrupt = Interrupt::new();
    interrupt.on_signals();
    let BisectArgs { scenario, good, bad, until, format } = args;
    let config = BisectConfig { scenario, good, bad, until, format: format.into() };
    Ok(onescan_regress::bisect::bisect(&config, &interrupt, &mut VerdictOutput::lock(), &mut std::io::stderr().lock())?)
}
