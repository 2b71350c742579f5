//! `onescan run`.

use std::io::IsTerminal;
use std::net::SocketAddr;
use std::path::PathBuf;
use std::time::Duration;

use clap::builder::ArgPredicate;
use clap::{Args as ClapArgs, ValueEnum};
use onescan_recording::Choice;
use onescan_report::plot::Part;
use onescan_scenario::Mode;
use onescan_scenario::watch::WatchRequest;
use onescan_server::pacing::Pace;
use onescan_server::signal::pattern::SignalPattern;
use onescan_server::signal::{ClientName, SignalName};
use onescan_server::time::{TimeSpan, VirtualTime};

use super::error::CommandError;
use super::opcua::AccessArgs;
use super::outputs;
use super::value::{FORKS, FormatArg, client_name, part, plane};
use super::verdict_output::VerdictOutput;
use onescan_regress::check::collect::Reading;
use onescan_regress::check::stubs;
use onescan_runner::access::admission::Admission;
use onescan_runner::error::ExitCode;
use onescan_runner::format::Format;
use onescan_runner::interrupt::Interrupt;
use onescan_runner::past::Budget;
use onescan_runner::run::config::{
    Course, Doors, Drawing, Picture, Reach, RecordRequest, Reports, RunsDrawn, SaveRequest, Subject, Watch, WatchOn,
};
use onescan_runner::run::coverage::{CoverageFormat, CoverageRequest};
use onescan_runner::run::{RunConfig, Transport, execute};
use onescan_runner::web::Stay;

// The headings under which the help lists the options.
const RECORDINGS: &str = "Recordings and operators";
const DRAWINGS: &str = "Plots, reports, watched variables";
const PAGE: &str = "The page";
const CLIENTS: &str = "Real PLCs and clients of other processes";
const OPC_UA: &str = "OPC UA";
const CHECKPOINTS: &str = "Checkpoints";

/// Options of `run`.
#[derive(Debug, ClapArgs)]
#[command(after_help = "`onescan help verdicts` says what met, open, violated and a margin are.")]
#[expect(clippy::struct_excessive_bools, reason = "switches, as they are typed")]
pub struct RunArgs {
    /// The scenario: a folder with a `scenario.toml`
    #[arg(default_value = ".")]
    pub scenario: PathBuf,
    /// A case of the scenario's `cases.toml` [default: the scenario as it is]
    #[arg(long, value_name = "NAME")]
    pub case: Option<String>,
    /// Refuse PLC sources that call a stub: a unit behind `{external}`, which does nothing
    #[arg(long)]
    pub deny_stubs: bool,
    /// Virtual time at which a run is complete, as in `2.5s` [default: the scenario's `until`]
    #[arg(long, value_name = "TIME")]
    pub until: Option<VirtualTime>,
    /// How fast virtual time may run: `max`, or a factor of real time
    #[arg(long, default_value = "max", default_value_if("web", ArgPredicate::IsPresent, "1"), value_name = "max|FACTOR", value_parser = pace)]
    pub pace: Pace,
    /// `lockstep`, or `freewheel` to see what it is good for: plant and PLC in real time, each on its
    /// own clock, with an OPC-like link between them
    #[arg(long, value_enum, default_value_t)]
    pub mode: ModeArg,
    /// Without lockstep: compute the clocks from this seed, each run with others, the same on every machine, and take no real
    /// time (`docs/freewheel.md`)
    #[arg(long, value_name = "N")]
    pub seed: Option<u64>,
    /// Run so many times, and compare the digests
    #[arg(long, default_value_t = 1, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub runs: u32,
    /// `inproc`: all clients in this process; `tcp`: each in a process of its own
    #[arg(help_heading = CLIENTS, long, value_enum, default_value_t)]
    pub transport: TransportArg,
    /// Let a real PLC stand in for a soft PLC, as in `plc=tcp://192.168.0.1:2000`; it runs the instrumented
    /// program; `tcp-listen://ADDRESS:PORT` for one that connects to onescan [default URL: the scenario's]
    #[arg(help_heading = CLIENTS, long = "gateway", value_name = "CLIENT[=URL]", value_parser = gateway)]
    pub gateways: Vec<(ClientName, Option<String>)>,
    /// Record each run in a folder `run-N` of this folder: the scenario's files, every signal and digest of
    /// every step as Parquet, events
    #[arg(help_heading = RECORDINGS, long, value_name = "DIR")]
    pub record: Option<PathBuf>,
    /// Record the trajectory as `csv` or `mcap` too; both may be given, as in `csv,mcap`
    #[arg(help_heading = RECORDINGS, long, value_enum, value_name = "FORMAT", requires = "record", value_delimiter = ',')]
    pub record_also: Vec<RecordAlso>,
    /// Record these signals only: a name, or a pattern with `*` and `?`; may be given several times
    #[arg(help_heading = RECORDINGS, long = "record-signals", value_name = "PATTERN", requires = "record")]
    pub record_signals: Vec<SignalPattern>,
    /// Replace an earlier recording in this folder
    #[arg(help_heading = RECORDINGS, long, requires = "record")]
    pub overwrite: bool,
    /// Repeat what an operator did: a recording, or a file like its `events.jsonl`
    #[arg(help_heading = RECORDINGS, long, value_name = "PATH")]
    pub replay_operator: Option<PathBuf>,
    /// For people, or one JSON object a run for machines
    #[arg(long, value_enum, default_value_t)]
    pub format: FormatArg,
    /// Draw chosen signals of all runs into this SVG file
    #[arg(help_heading = DRAWINGS, long, value_name = "FILE")]
    pub plot: Option<PathBuf>,
    /// Draw these signals only: a name, or a pattern with `*` and `?`; may be given several times [default: the
    /// scenario's choice]
    #[arg(help_heading = DRAWINGS, long, alias = "signal", value_name = "PATTERN", requires = "plot")]
    pub signals: Vec<SignalPattern>,
    /// Draw each run in panels of its own, one run beneath the other
    #[arg(help_heading = DRAWINGS, long, requires = "plot", conflicts_with = "xy")]
    pub apart: bool,
    /// Draw two signals against each other, across and up, as `x.position,z.position`: the paths of all runs
    #[arg(help_heading = DRAWINGS, long, value_name = "X,Y", requires = "plot", conflicts_with = "signals", value_parser = plane)]
    pub xy: Option<[SignalName; 2]>,
    /// Draw a part of the plot enlarged beside the whole: `2s..2.5s`, or `0.9..1.2,0.3..0.5`, across and up, with `--xy`
    #[arg(help_heading = DRAWINGS, long, value_name = "RANGE[,RANGE]", requires = "plot", value_parser = part, allow_hyphen_values = true)]
    pub enlarge: Option<Part>,
    /// Write which statements and branches of the soft PLCs were executed, in all runs together
    #[arg(help_heading = DRAWINGS, long, value_name = "FILE")]
    pub coverage: Option<PathBuf>,
    /// `lcov` or `cobertura` [default: by the file's name: `.xml` is Cobertura]
    #[arg(help_heading = DRAWINGS, long, value_enum, requires = "coverage", value_name = "FORMAT")]
    pub coverage_format: Option<CoverageArg>,
    /// Write a page with trajectories, expectations, events and coverage of all runs, all in one file
    #[arg(help_heading = DRAWINGS, long, value_name = "FILE")]
    pub html: Option<PathBuf>,
    /// Draw the scenario's maps as they are at the end into this folder: each as a picture `NAME.svg` and as text `NAME.csv`;
    /// of several runs, those of the last one
    #[arg(help_heading = DRAWINGS, long, alias = "map", value_name = "DIR")]
    pub maps: Option<PathBuf>,
    /// Write the files that the programs of the soft PLCs have at the end into this folder, each in one of its PLC's name; of several
    /// runs, those of the last one
    #[arg(help_heading = DRAWINGS, long, value_name = "DIR")]
    pub files: Option<PathBuf>,
    /// A variable of a soft PLC to look at, as `Main.axis[2].x`, with its PLC in front if there are several, as
    /// `plc2:Main.x`, and with a format for whole numbers behind, as `Main.status=bin`: `hex`, `dec` or `bin`;
    /// may be given several times
    #[arg(help_heading = DRAWINGS, long, value_name = "[PLC:]PATH[=FORMAT]")]
    pub watch: Vec<WatchRequest>,
    /// `end`: what watched variables are at the end; `change`: all their changes
    #[arg(help_heading = DRAWINGS, long, value_enum, default_value_t, requires = "watch", value_name = "WHEN")]
    pub watch_on: WatchOnArg,
    /// Where clients and operators may connect [default: a free port of this machine, if one is needed]
    #[arg(help_heading = CLIENTS, long, value_name = "ADDRESS:PORT")]
    pub listen: Option<SocketAddr>,
    /// Let in whoever shows a token of this folder, under TLS if it has a certificate (`onescan token`, `onescan
    /// certificate`)
    #[arg(help_heading = CLIENTS, long, value_name = "DIR", conflicts_with = "listen_insecure")]
    pub access: Option<PathBuf>,
    /// Let in whoever reaches the address of `--listen`, also from other machines: without TLS, without a token
    #[arg(help_heading = CLIENTS, long, requires = "listen")]
    pub listen_insecure: bool,
    /// Serve the session as a page to browsers of this machine: machine, panels, trends, programs (`docs/web.md`); in real
    /// time unless `--pace` says otherwise [default ADDRESS: a free port]
    #[arg(help_heading = PAGE, long, value_name = "ADDRESS:PORT", num_args = 0..=1, require_equals = true, default_missing_value = "127.0.0.1:0")]
    pub web: Option<SocketAddr>,
    /// Begin when the first viewer of the page looks [default: on a terminal]
    #[arg(help_heading = PAGE, long, requires = "web", overrides_with = "no_await_viewer")]
    pub await_viewer: bool,
    /// Begin at once, whether somebody looks at the page or not [default: without a terminal]
    #[arg(help_heading = PAGE, long, requires = "web")]
    pub no_await_viewer: bool,
    /// Keep the page when the run is over, to look back and go on from there: until Ctrl-C, or without a terminal until its last
    /// viewer has left [default: on a terminal]
    #[arg(help_heading = PAGE, long, requires = "web", overrides_with = "no_stay")]
    pub stay: bool,
    /// End the page with the run [default: without a terminal]
    #[arg(help_heading = PAGE, long, requires = "web")]
    pub no_stay: bool,
    /// How much memory the past may take that the page of `--web` shows, as in `256MiB`; `0` for none
    #[arg(help_heading = PAGE, long, default_value_t, requires = "web", value_name = "MEMORY")]
    pub past_memory: Budget,
    /// How many sessions may go on from moments of this one at a time, each in a process of its own
    #[arg(help_heading = PAGE, long, default_value_t = FORKS, requires = "web", value_name = "COUNT")]
    pub forks: u32,
    /// Let operators save what they did on the page as a case, in the scenario's file of cases
    #[arg(help_heading = PAGE, long, requires = "web")]
    pub save_cases: bool,
    /// Let people stand in for this client: its signals are operated, on the page, by `onescan control` or over OPC UA; may be
    /// given several times
    #[arg(help_heading = CLIENTS, long = "operator", value_name = "CLIENT", value_parser = client_name)]
    pub operators: Vec<ClientName>,
    /// Let others read variables of the soft PLCs over ADS at this address, as they read those of a TwinCAT PLC (`docs/gateway.md`)
    #[arg(help_heading = CLIENTS, long, value_name = "ADDRESS:PORT")]
    pub ads: Option<SocketAddr>,
    /// Serve the session over OPC UA at this address, for operators and clients (`docs/opcua.md`) [default: a free
    /// port of this machine, if a client needs one]
    #[arg(help_heading = OPC_UA, long, value_name = "ADDRESS:PORT")]
    pub opcua: Option<SocketAddr>,
    /// Let a program with an OPC UA client stand in for this client; may be given several times
    #[arg(help_heading = OPC_UA, long = "opcua-client", value_name = "CLIENT", value_parser = client_name)]
    pub opcua_clients: Vec<ClientName>,
    /// Who is let in over OPC UA
    #[command(flatten, next_help_heading = OPC_UA)]
    pub opcua_access: AccessArgs,
    /// How long to wait for clients to join
    #[arg(help_heading = CLIENTS, long, default_value = "60s", value_name = "TIME")]
    pub join_timeout: TimeSpan,
    /// How long a client in another process may leave a grant unanswered, wall clock
    #[arg(help_heading = CLIENTS, long, default_value = "10s", value_name = "TIME")]
    pub reply_timeout: TimeSpan,
    /// Take a checkpoint at this virtual time
    #[arg(help_heading = CHECKPOINTS, long, value_name = "TIME", requires = "save")]
    pub save_at: Option<VirtualTime>,
    /// The file for the checkpoint
    #[arg(help_heading = CHECKPOINTS, long, value_name = "FILE", requires = "save_at")]
    pub save: Option<PathBuf>,
    /// Go on from this checkpoint
    #[arg(help_heading = CHECKPOINTS, long, value_name = "FILE")]
    pub resume: Option<PathBuf>,
    /// Go on from there with other PLC code: sources and constants may differ, variables and tasks may not
    #[arg(help_heading = CHECKPOINTS, long, requires = "resume")]
    pub accept_code: bool,
    /// Report how long the session waited for each client of this process; always with --gateway
    #[arg(help_heading = CLIENTS, long)]
    pub latency: bool,
}

/// See [`Mode`].
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
pub enum ModeArg {
    /// One scan, one step
    #[default]
    Lockstep,
    /// Each on its own clock
    Freewheel,
    /// The same, the plant held to the PLC's cycle by a timer
    Halt,
    /// The same, the plant following the PLC's clock
    Follow,
}

impl From<ModeArg> for Mode {
    fn from(arg: ModeArg) -> Self {
        match arg {
            ModeArg::Lockstep => Self::Lockstep,
            ModeArg::Freewheel => Self::Freewheel,
            ModeArg::Halt => Self::Halt,
            ModeArg::Follow => Self::Follow,
        }
    }
}

/// See [`Transport`].
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
pub enum TransportArg {
    /// Function calls in this process
    #[default]
    Inproc,
    /// A process and a TCP connection a client
    Tcp,
}

impl From<TransportArg> for Transport {
    fn from(arg: TransportArg) -> Self {
        match arg {
            TransportArg::Inproc => Self::Inproc,
            TransportArg::Tcp => Self::Tcp,
        }
    }
}

/// When watched variables are reported.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum WatchOnArg {
    /// What they are at the end
    #[default]
    End,
    /// All their changes
    Change,
}

impl From<WatchOnArg> for WatchOn {
    fn from(arg: WatchOnArg) -> Self {
        match arg {
            WatchOnArg::End => Self::End,
            WatchOnArg::Change => Self::Change,
        }
    }
}

/// A form of trajectory that is recorded beside Parquet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum RecordAlso {
    /// For spreadsheets
    Csv,
    /// For viewers of robots and their logs: Foxglove, `PlotJuggler`
    Mcap,
}

/// See [`CoverageFormat`].
#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum CoverageArg {
    /// An lcov tracefile
    Lcov,
    /// A Cobertura report
    Cobertura,
}

impl From<CoverageArg> for CoverageFormat {
    fn from(arg: CoverageArg) -> Self {
        match arg {
            CoverageArg::Lcov => Self::Lcov,
            CoverageArg::Cobertura => Self::Cobertura,
        }
    }
}

/// Runs a scenario.
///
/// # Errors
/// See [`CommandError`].
pub fn run(args: RunArgs) -> Result<ExitCode, CommandError> {
    if args.deny_stubs {
        stubs::deny(std::slice::from_ref(&args.scenario), Reading::default())?;
    }
    outputs::files([&args.plot, &args.coverage, &args.html, &args.save])?;
    outputs::folders([&args.record, &args.maps, &args.files])?;
    let interrupt = Interrupt::new();
    interrupt.on_signals();
    let verdict = execute(&config(args)?, &interrupt, &mut VerdictOutput::lock())?;
    Ok(verdict.exit_code())
}

/// True where somebody sits who opens the page: on a terminal, unless a machine reads the report, or an operator's inputs are
/// repeated from a recording.
fn is_watched(args: &RunArgs) -> bool {
    on_terminal() && matches!(args.format, FormatArg::Human) && args.replay_operator.is_none()
}

fn on_terminal() -> bool {
    std::io::stdin().is_terminal() && std::io::stderr().is_terminal()
}

fn config(args: RunArgs) -> Result<RunConfig, CommandError> {
    let is_watched = is_watched(&args);
    let access = match &args.access {
        Some(folder) if args.opcua.is_some() => args.opcua_access.access_with_tokens(folder)?,
        _ => args.opcua_access.access()?,
    };
    let admission = match args.access {
        Some(folder) => Admission::Holders(folder),
        None if args.listen_insecure => Admission::Anybody,
        None => Admission::ThisMachine,
    };
    let format = args.format.into();
    let record = args.record.map(|folder| RecordRequest {
        folder,
        overwrite: args.overwrite,
        choice: Choice {
            signals: args.record_signals,
            csv: args.record_also.contains(&RecordAlso::Csv),
            mcap: args.record_also.contains(&RecordAlso::Mcap),
        },
    });
    Ok(RunConfig {
        subject: Subject { scenario: args.scenario, case: args.case, until: args.until },
        mode: args.mode.into(),
        seed: args.seed,
        runs: args.runs,
        reach: Reach {
            transport: args.transport.into(),
            gateways: args.gateways,
            operated: args.operators,
            opcua_clients: args.opcua_clients,
            join_timeout: Duration::from_nanos(args.join_timeout.as_nanos()),
            reply_timeout: Duration::from_nanos(args.reply_timeout.as_nanos()),
            latency: args.latency,
        },
        doors: Doors {
            listen: args.listen,
            admission,
            web: args.web,
            awaits_viewer: args.await_viewer || is_watched && !args.no_await_viewer,
            stay: (args.stay || is_watched && !args.no_stay)
                .then(|| if on_terminal() { Stay::UntilInterrupted } else { Stay::ForViewers }),
            past: args.past_memory,
            forks: args.forks,
            saves_cases: args.save_cases,
            ads: args.ads,
            opcua: args.opcua,
            access,
        },
        course: Course {
            pace: args.pace,
            resume: args.resume,
            accept_code: args.accept_code,
            replay_operator: args.replay_operator,
            save: args.save_at.zip(args.save).map(|(at, path)| SaveRequest { at, path }),
            ..Course::default()
        },
        picture: Picture {
            drawing: args.plot.map_or(Drawing::Nothing, Drawing::File),
            signals: args.signals,
            plane: args.xy,
            enlarged: args.enlarge,
            runs: if args.apart { RunsDrawn::Apart } else { RunsDrawn::Overlaid },
        },
        watch: Watch { variables: args.watch, on: args.watch_on.into() },
        reports: Reports {
            format,
            progress: format == Format::Human && std::io::stderr().is_terminal(),
            record,
            coverage: args.coverage.map(|path| CoverageRequest::new(path, args.coverage_format.map(Into::into))),
            html: args.html,
            maps: args.maps,
            files: args.files,
        },
    })
}

/// How fast virtual time may run.
///
/// # Errors
/// Why it is not a pace.
pub(super) fn pace(text: &str) -> Result<Pace, String> {
    if text == "max" {
        return Ok(Pace::Max);
    }
    match text.parse::<f64>() {
        Ok(factor) if factor.is_finite() && factor > 0.0 => Ok(Pace::Factor(factor)),
        _ => Err("write `max` or a factor over 0, as in `1` for real time or `0.1` for slow motion".to_owned()),
    }
}

pub(super) fn gateway(text: &str) -> Result<(ClientName, Option<String>), String> {
    match text.split_once('=') {
        Some((name, url)) => Ok((client_name(name)?, Some(url.to_owned()))),
        None => Ok((client_name(text)?, None)),
    }
}
