//! What may be typed.

use std::net::SocketAddr;
use std::path::PathBuf;

use clap::{ArgAction, Args as ClapArgs, Parser, Subcommand, ValueEnum};
use onescan_plc_shim::instrument::Target;
use onescan_plc_shim::{Dialect, Task};
use onescan_server::operation::Operation;
use onescan_server::pacing::Pace;
use onescan_server::signal::pattern::SignalPattern;
use onescan_server::signal::{ClientName, SignalName};
use onescan_server::time::{TimeSpan, VirtualTime};

use super::test_args::{ReviewArgs, TestArgs, WorkerArgs};
use crate::check::CheckFormat;
use crate::new::Template;
use crate::plc::Cycle;
use crate::run::coverage::CoverageFormat;
use crate::run::{Format, Mode, Transport};
use crate::scenario::watch::WatchRequest;

/// Deterministic lockstep virtual commissioning.
///
/// A PLC program and the model of its machine run against each other on one virtual clock: every scan
/// sees exactly one simulation step, and every run of a scenario gives the same bits.
#[derive(Debug, Parser)]
#[command(name = "onescan", bin_name = "onescan", version, after_help = EXIT_CODES)]
pub struct Args {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
    /// Say more on standard error: -v what happens, -vv why, -vvv everything
    #[arg(short, long, action = ArgAction::Count, global = true)]
    pub verbose: u8,
}

const EXIT_CODES: &str = "Exit codes:
  0  all is well
  1  a run is not what its scenario expects; runs that must be equal are not; a test failed;
     a check found warnings that are denied
  2  wrong input: options, scenario, PLC source, scene, checkpoint
  3  a client or a link failed, or the PLC program stopped on a fault";

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Run a scenario and print the digest of its trajectories
    Run(Box<RunArgs>),
    /// Run a scenario in lockstep and in the other ways that are in use, and set them side by side: how far
    /// trajectories and edges are off, what is lost, how fast it is
    Compare(CompareArgs),
    /// Run all scenarios and cases, and hold them against their reviewed snapshots; run test programs in ST
    Test(Box<TestArgs>),
    /// Look at snapshots that are new or have changed, and accept or reject them
    Review(ReviewArgs),
    /// One test, for `test`
    #[command(hide = true)]
    TestWorker(WorkerArgs),
    /// Take part in a session that another process serves, as one client of a scenario
    Join(JoinArgs),
    /// Ask a running session (see `run --listen`) how it is, or to pause, step, go on, reset or stop
    Control(ControlArgs),
    /// Write a recording's trajectory as CSV, Parquet or MCAP
    Export(ExportArgs),
    /// Compare two recordings: where they first differ, in which signals, and which statement wrote them
    Diff(DiffArgs),
    /// Find the commit that first changed what a scenario does, and the statement that did
    Bisect(BisectArgs),
    /// Check PLC sources without running them
    Check(CheckArgs),
    /// Make a PLC project run in lockstep on any PLC: scheduler, execution controllers and timers on virtual
    /// time are attached; or take them off again
    Instrument(Box<InstrumentArgs>),
    /// Run a soft PLC of a scenario as a process of its own: it free-wheels, serves its variables over the
    /// protocols of real PLCs, and is started and stopped by commands that are typed
    Plc(PlcArgs),
    /// List what a real PLC has, and write a mapping to start from
    Browse(BrowseArgs),
    /// List the library of components, or tell all about one kind
    Components(ComponentsArgs),
    /// Tell what a scene is made of: bodies, joints, components, signals
    Describe(DescribeArgs),
    /// Tell and draw how the signals of a scenario connect its clients, and what is unconnected, doubly written
    /// or of unequal type
    Wiring(WiringArgs),
    /// Write a small scenario that runs at once, to begin with
    New(NewArgs),
    /// Explain a code of `check`, with an example that is wrong and one that is right
    Explain(ExplainArgs),
}

/// Options of `run`.
#[derive(Debug, ClapArgs)]
pub struct RunArgs {
    /// The scenario: a folder with a `scenario.toml`
    pub scenario: PathBuf,
    /// A case of the scenario's `cases.toml` [default: the scenario as it is]
    #[arg(long, value_name = "NAME")]
    pub case: Option<String>,
    /// Virtual time at which a run is complete, as in `2.5s` [default: the scenario's `until`]
    #[arg(long, value_name = "TIME")]
    pub until: Option<VirtualTime>,
    /// How fast virtual time may run: `max`, or a factor of real time
    #[arg(long, default_value = "max", value_name = "max|FACTOR", value_parser = pace)]
    pub pace: Pace,
    /// `lockstep`, or `freewheel` to see what it is good for: plant and PLC in real time, each on its
    /// own clock, with an OPC-like link between them
    #[arg(long, value_enum, default_value_t)]
    pub mode: ModeArg,
    /// Run so many times, and compare the digests
    #[arg(long, default_value_t = 1, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub runs: u32,
    /// `inproc`: all clients in this process; `tcp`: each in a process of its own
    #[arg(long, value_enum, default_value_t)]
    pub transport: TransportArg,
    /// Let a real PLC stand in for a soft PLC, as in `plc=tcp://192.168.0.1:2000`; it runs the instrumented
    /// program [default URL: the scenario's]
    #[arg(long = "gateway", value_name = "CLIENT[=URL]", value_parser = gateway)]
    pub gateways: Vec<(ClientName, Option<String>)>,
    /// Record each run in a folder `run-N` of this folder: the scenario's files, every signal and digest of
    /// every step as Parquet, events
    #[arg(long, value_name = "DIR")]
    pub record: Option<PathBuf>,
    /// Record the trajectory as `csv` or `mcap` too; both may be given, as in `csv,mcap`
    #[arg(long, value_enum, value_name = "FORMAT", requires = "record", value_delimiter = ',')]
    pub record_also: Vec<RecordAlso>,
    /// Record these signals only: a name, or a pattern with `*` and `?`; may be given several times
    #[arg(long = "record-signals", value_name = "PATTERN", requires = "record")]
    pub record_signals: Vec<SignalPattern>,
    /// Repeat what an operator did: a recording, or a file like its `events.jsonl`
    #[arg(long, value_name = "PATH")]
    pub replay_operator: Option<PathBuf>,
    /// For people, or one JSON object a run for machines
    #[arg(long, value_enum, default_value_t)]
    pub format: FormatArg,
    /// Draw chosen signals of all runs into this SVG file
    #[arg(long, value_name = "FILE")]
    pub plot: Option<PathBuf>,
    /// A signal to draw; may be given several times [default: the scenario's choice]
    #[arg(long = "signal", value_name = "NAME", requires = "plot", value_parser = signal_name)]
    pub signals: Vec<SignalName>,
    /// Write which statements and branches of the soft PLCs were executed, in all runs together
    #[arg(long, value_name = "FILE")]
    pub coverage: Option<PathBuf>,
    /// `lcov` or `cobertura` [default: by the file's name: `.xml` is Cobertura]
    #[arg(long, value_enum, requires = "coverage", value_name = "FORMAT")]
    pub coverage_format: Option<CoverageArg>,
    /// Write a page with trajectories, expectations, events and coverage of all runs, all in one file
    #[arg(long, value_name = "FILE")]
    pub html: Option<PathBuf>,
    /// A variable of a soft PLC to look at, as `Main.axis[2].x`, with its PLC in front if there are several, as
    /// `plc2:Main.x`, and with a format for whole numbers behind, as `Main.status=bin`: `hex`, `dec` or `bin`;
    /// may be given several times
    #[arg(long, value_name = "[PLC:]PATH[=FORMAT]")]
    pub watch: Vec<WatchRequest>,
    /// `end`: what watched variables are at the end; `change`: all their changes
    #[arg(long, value_enum, default_value_t, requires = "watch", value_name = "WHEN")]
    pub watch_on: WatchOnArg,
    /// Where clients and operators may connect [default: a free port of this machine, if one is needed]
    #[arg(long, value_name = "ADDRESS:PORT")]
    pub listen: Option<SocketAddr>,
    /// How long to wait for clients to join
    #[arg(long, default_value = "60s", value_name = "TIME")]
    pub join_timeout: TimeSpan,
    /// How long a client in another process may leave a grant unanswered, wall clock
    #[arg(long, default_value = "10s", value_name = "TIME")]
    pub reply_timeout: TimeSpan,
    /// Take a checkpoint at this virtual time
    #[arg(long, value_name = "TIME", requires = "save")]
    pub save_at: Option<VirtualTime>,
    /// The file for the checkpoint
    #[arg(long, value_name = "FILE", requires = "save_at")]
    pub save: Option<PathBuf>,
    /// Go on from this checkpoint
    #[arg(long, value_name = "FILE")]
    pub resume: Option<PathBuf>,
    /// Report how long the session waited for each client of this process; always with --gateway
    #[arg(long)]
    pub latency: bool,
}

/// Options of `compare`.
#[derive(Debug, ClapArgs)]
pub struct CompareArgs {
    /// The scenario: a folder with a `scenario.toml`
    pub scenario: PathBuf,
    /// Virtual time at which a run is complete [default: the scenario's `until`]
    #[arg(long, value_name = "TIME")]
    pub until: Option<VirtualTime>,
    /// Runs of each way
    #[arg(long, default_value_t = 3, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_000))]
    pub runs: u32,
    /// Draw the signals of the scenario's plot, a run of each way over each other, into this SVG file
    #[arg(long, value_name = "FILE")]
    pub plot: Option<PathBuf>,
    /// For people, or one JSON object a way for machines
    #[arg(long, value_enum, default_value_t)]
    pub format: FormatArg,
}

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

/// Options of `diff`.
#[derive(Debug, ClapArgs)]
pub struct DiffArgs {
    /// A recording: a folder with a `recording.json`, or with one such folder in it
    pub a: PathBuf,
    /// Another
    pub b: PathBuf,
    /// What was before this virtual time does not count; then signals are compared, not digests
    #[arg(long, default_value = "0s", value_name = "TIME")]
    pub since: VirtualTime,
    /// Compare these signals only: a name, or a pattern with `*` and `?`; may be given several times
    #[arg(long, value_name = "PATTERN")]
    pub signals: Vec<SignalPattern>,
    /// For people, or a JSON object for machines
    #[arg(long, value_enum, default_value_t)]
    pub format: FormatArg,
}

/// Options of `bisect`.
#[derive(Debug, ClapArgs)]
pub struct BisectArgs {
    /// The scenario: a folder with a `scenario.toml`, in a working tree of git
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

/// Options of `join`.
#[derive(Debug, ClapArgs)]
pub struct JoinArgs {
    /// The scenario: a folder with a `scenario.toml`
    pub scenario: PathBuf,
    /// The client to be
    #[arg(value_parser = client_name)]
    pub client: ClientName,
    /// The server's address
    #[arg(long, value_name = "ADDRESS:PORT")]
    pub server: SocketAddr,
    /// The case that the server runs [default: the scenario as it is]
    #[arg(long, value_name = "NAME")]
    pub case: Option<String>,
}

/// Options of `control`.
#[derive(Debug, ClapArgs)]
pub struct ControlArgs {
    /// The server's address
    pub server: SocketAddr,
    /// What to ask for
    #[arg(value_enum, default_value_t)]
    pub wish: WishArg,
    /// The signal to write, force or release
    #[arg(required_if_eq_any([("wish", "write"), ("wish", "force"), ("wish", "release")]), value_parser = signal_name)]
    pub signal: Option<SignalName>,
    /// Its value, as in `TRUE`, `-3` or `1.5`
    #[arg(required_if_eq_any([("wish", "write"), ("wish", "force")]), allow_hyphen_values = true)]
    pub value: Option<String>,
    /// For people, or a JSON object for machines
    #[arg(long, value_enum, default_value_t)]
    pub format: FormatArg,
}

/// Options of `check`.
#[derive(Debug, ClapArgs)]
pub struct CheckArgs {
    /// Source files (`.st .iec .exp .scl .TcPOU .TcDUT .TcGVL .TcIO .plcproj .xml`), folders with such
    /// files, or scenarios; files and folders are checked together, as one program
    #[arg(required = true, value_name = "FILE|FOLDER|SCENARIO")]
    pub paths: Vec<PathBuf>,
    /// Read all files in this dialect: iec2, iec3, codesys, twincat or siemens-scl [default: what a file's
    /// name or PLCopen XML tells, as in `.scl`, else iec3]
    #[arg(long, value_name = "NAME")]
    pub dialect: Option<Dialect>,
    /// `human`; `json`: an object a finding with `code`, `severity`, `file`, `line`, `column`,
    /// `end_line`, `end_column`, `message`, `help`; `sarif`: a SARIF 2.1.0 log
    #[arg(long, value_enum, default_value_t)]
    pub format: CheckFormatArg,
    /// Fail with exit code 1 if there are warnings
    #[arg(long)]
    pub deny_warnings: bool,
}

/// Options of `instrument`.
#[derive(Debug, ClapArgs)]
#[expect(clippy::struct_excessive_bools, reason = "each is a flag that is typed or not")]
#[command(group = clap::ArgGroup::new("result").required(true).multiple(true).args(["output", "in_place", "diff"]))]
pub struct InstrumentArgs {
    /// A folder, a source file, a TwinCAT project or a scenario
    pub project: PathBuf,
    /// For whom the shim's own sources are written: `iec`: program text of the standard, or
    /// PLCopen XML if the project is, `twincat`: TwinCAT 3 objects, `codesys`: PLCopen XML for CODESYS,
    /// `scl`: external sources for TIA Portal
    #[arg(long, value_enum, default_value_t)]
    pub target: TargetArg,
    /// A task and its programs, as in `fast:10ms:0=Main,Alarms`; may be given several times [default: the
    /// scenario's tasks, or one of 10 ms with all programs]
    #[arg(long = "task", value_name = "NAME:INTERVAL:PRIORITY=PROGRAM,...", value_parser = plc_task)]
    pub tasks: Vec<Task>,
    /// Write the result into this folder
    #[arg(short, long, value_name = "DIR", conflicts_with = "in_place")]
    pub output: Option<PathBuf>,
    /// Change the project's own files
    #[arg(long)]
    pub in_place: bool,
    /// Show the changes as a unified diff
    #[arg(long)]
    pub diff: bool,
    /// Take the shim off: every file as it was, byte for byte
    #[arg(long)]
    pub remove: bool,
    /// Write nothing and fail with exit code 1 if a source of time cannot be replaced
    #[arg(long)]
    pub deny_warnings: bool,
    /// For people, or one JSON object for machines: `files` with `file`, `change`, `lines`, and `findings`
    #[arg(long, value_enum, default_value_t)]
    pub format: FormatArg,
}

/// Options of `plc`.
#[derive(Debug, ClapArgs)]
#[command(after_help = PLC_COMMANDS)]
pub struct PlcArgs {
    /// The scenario: a folder with a `scenario.toml`
    pub scenario: PathBuf,
    /// Which of its soft PLCs [default: the only one]
    #[arg(long, value_name = "CLIENT", value_parser = client_name)]
    pub client: Option<ClientName>,
    /// `lockstep`: its programs run when they are granted; `freewheel`: by its own clock and tasks, as if there
    /// were no shim
    #[arg(long, value_enum, default_value_t)]
    pub mode: ModeArg,
    /// How often it scans, wall clock: a time, or `max` for one scan behind the other
    #[arg(long, default_value = "1ms", value_name = "TIME|max")]
    pub cycle: Cycle,
    /// Where data blocks are served over raw TCP [default, if no protocol is named: each at a free port of
    /// this machine]
    #[arg(long, value_name = "ADDRESS:PORT")]
    pub tcp: Option<SocketAddr>,
    /// Where registers are served over Modbus TCP
    #[arg(long, value_name = "ADDRESS:PORT")]
    pub modbus: Option<SocketAddr>,
    /// Where variables are served over OPC UA
    #[arg(long, value_name = "ADDRESS:PORT")]
    pub opcua: Option<SocketAddr>,
    /// The only OPC UA user, whose password is in the environment variable `ONESCAN_OPCUA_PASSWORD` [default:
    /// anybody]
    #[arg(long, value_name = "NAME")]
    pub opcua_user: Option<String>,
    /// Folder with the OPC UA server's certificates and those it trusts; with it nobody is let in without
    /// security
    #[arg(long, value_name = "DIR")]
    pub opcua_pki: Option<PathBuf>,
    /// Trust the certificate of any OPC UA client
    #[arg(long, requires = "opcua_pki")]
    pub opcua_trust: bool,
}

/// Options of `browse`.
#[derive(Debug, ClapArgs)]
pub struct BrowseArgs {
    /// The PLC, as in `opc.tcp://192.168.0.1:4840`
    pub url: String,
    /// Map the signals of this scenario, and use what it says of the link
    #[arg(long, value_name = "SCENARIO")]
    pub scenario: Option<PathBuf>,
    /// The client of the scenario that speaks for the PLC
    #[arg(long, value_name = "CLIENT", value_parser = client_name, default_value = "plc")]
    pub client: ClientName,
    /// Write the mapping into this file, as a part of a `scenario.toml`
    #[arg(long, value_name = "FILE")]
    pub map: Option<PathBuf>,
    /// For people, or one JSON object a variable for machines
    #[arg(long, value_enum, default_value_t)]
    pub format: FormatArg,
}

const PLC_COMMANDS: &str = "Commands on standard input:
  run, stop    the switch: RUN or STOP
  cold, warm   start it anew: all variables with their initial values, or RETAIN kept
  status       how it is
  quit         end it";

/// Options of `components`.
#[derive(Debug, ClapArgs)]
pub struct ComponentsArgs {
    /// A kind, for its equations, parameters, signals and failure modes
    pub kind: Option<String>,
    /// For people, or JSON for machines
    #[arg(long, value_enum, default_value_t)]
    pub format: FormatArg,
}

/// Options of `describe`.
#[derive(Debug, ClapArgs)]
pub struct DescribeArgs {
    /// The scene, a `plant.toml`
    pub scene: PathBuf,
    /// For people, or JSON for machines
    #[arg(long, value_enum, default_value_t)]
    pub format: FormatArg,
}

/// Options of `explain`.
#[derive(Debug, ClapArgs)]
pub struct ExplainArgs {
    /// The code, as in `N0101`
    #[arg(required_unless_present = "list")]
    pub code: Option<String>,
    /// Name every code
    #[arg(long, conflicts_with = "code")]
    pub list: bool,
}

/// See [`CheckFormat`].
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
pub enum CheckFormatArg {
    /// For people
    #[default]
    Human,
    /// For machines
    Json,
    /// For code hosts and editors
    Sarif,
}

impl From<CheckFormatArg> for CheckFormat {
    fn from(arg: CheckFormatArg) -> Self {
        match arg {
            CheckFormatArg::Human => Self::Human,
            CheckFormatArg::Json => Self::Json,
            CheckFormatArg::Sarif => Self::Sarif,
        }
    }
}

/// See [`Target`].
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
pub enum TargetArg {
    /// Program text of the standard
    #[default]
    Iec,
    /// TwinCAT 3 objects
    Twincat,
    /// PLCopen XML as CODESYS imports it
    Codesys,
    /// SCL as TIA Portal imports it
    Scl,
}

impl From<TargetArg> for Target {
    fn from(arg: TargetArg) -> Self {
        match arg {
            TargetArg::Iec => Self::Iec,
            TargetArg::Twincat => Self::TwinCat,
            TargetArg::Codesys => Self::Codesys,
            TargetArg::Scl => Self::Scl,
        }
    }
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

/// When watched variables are told.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum WatchOnArg {
    /// What they are at the end
    #[default]
    End,
    /// All their changes
    Change,
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

/// Options of `wiring`.
#[derive(Debug, ClapArgs)]
pub struct WiringArgs {
    /// The scenario: a folder with a `scenario.toml`
    pub scenario: PathBuf,
    /// For people, or JSON for machines
    #[arg(long, value_enum, default_value_t)]
    pub format: FormatArg,
    /// Draw it into this SVG file, too
    #[arg(long, value_name = "FILE")]
    pub svg: Option<PathBuf>,
}

/// Options of `new`.
#[derive(Debug, ClapArgs)]
pub struct NewArgs {
    /// The folder to make; its name is the scenario's
    pub folder: PathBuf,
    /// What to begin with
    #[arg(long, value_enum, default_value_t)]
    pub template: TemplateArg,
}

/// See [`Template`].
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
pub enum TemplateArg {
    /// A cylinder pushes boxes off a belt: bodies, a conveyor, a sensor, pneumatics
    #[default]
    Cell,
    /// A tank with a pump, a valve and a level: process engineering, no bodies
    Tank,
    /// A plant of your own in Python, over TCP
    Python,
}

impl From<TemplateArg> for Template {
    fn from(arg: TemplateArg) -> Self {
        match arg {
            TemplateArg::Cell => Self::Cell,
            TemplateArg::Tank => Self::Tank,
            TemplateArg::Python => Self::Python,
        }
    }
}

/// See [`Format`].
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
pub enum FormatArg {
    /// For people
    #[default]
    Human,
    /// For machines
    Json,
}

impl From<FormatArg> for Format {
    fn from(arg: FormatArg) -> Self {
        match arg {
            FormatArg::Human => Self::Human,
            FormatArg::Json => Self::Json,
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

/// What an operator may ask for.
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
pub enum WishArg {
    /// How it is
    #[default]
    Status,
    /// Hold virtual time at the next step boundary
    Pause,
    /// Let it run again
    Resume,
    /// Run exactly one step, then hold
    Step,
    /// Begin anew at virtual time 0
    Reset,
    /// End the session
    Stop,
    /// Give a signal a value until its writer writes it again
    Write,
    /// Hold a signal at a value, whatever its writer writes
    Force,
    /// Let a forced signal's writer write it again
    Release,
}

impl ControlArgs {
    /// What is asked, for the server; `None` asks only for the status.
    ///
    /// # Errors
    /// A signal or a value where none belongs.
    pub fn operation(&self) -> Result<Option<Operation>, String> {
        let (signal, value) = (self.signal.clone(), self.value.clone());
        Ok(Some(match (self.wish, signal, value) {
            (WishArg::Write, Some(signal), Some(value)) => Operation::Write { signal, value },
            (WishArg::Force, Some(signal), Some(value)) => Operation::Force { signal, value },
            (WishArg::Release, Some(signal), None) => Operation::Release { signal },
            (WishArg::Release, Some(_), Some(value)) => return Err(format!("`{value}` means nothing with `release`")),
            (_, Some(signal), _) => return Err(format!("`{signal}` means nothing here")),
            (WishArg::Pause, ..) => Operation::Pause,
            (WishArg::Resume, ..) => Operation::Resume,
            (WishArg::Step, ..) => Operation::Step,
            (WishArg::Reset, ..) => Operation::Reset,
            (WishArg::Stop, ..) => Operation::Stop,
            (WishArg::Status | WishArg::Write | WishArg::Force | WishArg::Release, ..) => return Ok(None),
        }))
    }
}

fn pace(text: &str) -> Result<Pace, String> {
    if text == "max" {
        return Ok(Pace::Max);
    }
    match text.parse::<f64>() {
        Ok(factor) if factor.is_finite() && factor > 0.0 => Ok(Pace::Factor(factor)),
        _ => Err("write `max` or a factor over 0, as in `1` for real time or `0.1` for slow motion".to_owned()),
    }
}

fn plc_task(text: &str) -> Result<Task, String> {
    let wanted = || "write `NAME:INTERVAL:PRIORITY=PROGRAM,PROGRAM`, as in `fast:10ms:0=Main,Alarms`".to_owned();
    let (head, programs) = text.split_once('=').ok_or_else(wanted)?;
    let [name, interval, priority] = head.split(':').collect::<Vec<_>>()[..] else {
        return Err(wanted());
    };
    let interval: TimeSpan = interval.parse().map_err(|error| format!("{interval}: {error}"))?;
    Ok(Task {
        name: name.to_owned(),
        interval_ns: interval.as_nanos(),
        priority: priority.parse().map_err(|_| format!("`{priority}` is no priority: 0 comes first"))?,
        programs: programs.split(',').map(|program| program.trim().to_owned()).collect(),
        ..Task::default()
    })
}

fn gateway(text: &str) -> Result<(ClientName, Option<String>), String> {
    match text.split_once('=') {
        Some((name, url)) => Ok((client_name(name)?, Some(url.to_owned()))),
        None => Ok((client_name(text)?, None)),
    }
}

fn signal_name(text: &str) -> Result<SignalName, String> {
    SignalName::new(text).map_err(|error| error.to_string())
}

fn client_name(text: &str) -> Result<ClientName, String> {
    ClientName::new(text).map_err(|error| error.to_string())
}
