//! With PLC sources: `onescan check`, `explain` and `instrument`.

use std::path::PathBuf;

use clap::{Args as ClapArgs, ValueEnum};
use onescan_iec::{Dialect, MemoryLimit, Task, WordSize};
use onescan_iec_project::instrument::{Inputs, Target};
use onescan_report::OutputError;
use onescan_server::signal::ClientName;
use onescan_server::time::TimeSpan;

use super::error::CommandError;
use super::value::{FormatArg, client_name};
use super::verdict_output::VerdictOutput;
use crate::instrument::{Destination, Diff, Direction, InstrumentConfig};
use onescan_regress::check::collect::logix;
use onescan_regress::check::stubs::{self, StubsConfig};
use onescan_regress::check::{self, CheckConfig, CheckFormat, Warnings};
use onescan_runner::error::ExitCode;
use onescan_runner::error::Usage;

/// Options of `check`.
#[derive(Debug, ClapArgs)]
pub struct CheckArgs {
    /// Source files (`.st .iec .exp .scl .TcPOU .TcDUT .TcGVL .TcIO .plcproj .xml`), folders with such
    /// files, or scenarios; files and folders are checked together, as one program
    #[arg(default_value = ".", value_name = "FILE|FOLDER|SCENARIO")]
    pub paths: Vec<PathBuf>,
    /// Read all files in this dialect: iec2, iec3, codesys, twincat, siemens-scl or matiec [default: what a file's
    /// name or PLCopen XML says, as in `.scl`, else iec3]
    #[arg(long, value_name = "NAME")]
    pub dialect: Option<Dialect>,
    /// Bits of the registers in which the target computes integers, in the dialects codesys and twincat: 32 or 64
    /// [default: the scenario's or the file's, else 64]
    #[arg(long, value_name = "BITS")]
    pub word_size: Option<WordSize>,
    /// MiB that all variables of a PLC may take together, up to 2047 [default: the scenario's, else 64]
    #[arg(long, value_name = "MIB")]
    pub memory_limit: Option<MemoryLimit>,
    /// A library that the sources use: a folder or a TwinCAT project, read as its source; may be given several times.
    /// A project's folder `libraries` is read without this
    #[arg(long = "library", value_name = "PATH")]
    pub libraries: Vec<PathBuf>,
    /// `human`; `json`: an object a finding with `code`, `severity`, `file`, `line`, `column`,
    /// `end_line`, `end_column`, `message`, `help`; `sarif`: a SARIF 2.1.0 log
    #[arg(long, value_enum, default_value_t)]
    pub format: CheckFormatArg,
    /// Fail with exit code 1 if there are warnings
    #[arg(long)]
    pub deny_warnings: bool,
    /// Fail with exit code 2 if a stub is called: a unit behind `{external}`, which does nothing
    #[arg(long)]
    pub deny_stubs: bool,
    /// Write what the project names and nobody declares as `{external}` declarations to `stubs.st` in this folder,
    /// with types guessed from use; what is in the file stays, what is missing is added [default folder:
    /// `libraries` of the project]
    #[arg(long, value_name = "DIR", num_args = 0..=1, require_equals = true, conflicts_with = "deny_stubs")]
    pub write_stubs: Option<Option<PathBuf>>,
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

/// Checks sources.
///
/// # Errors
/// See [`CommandError`].
pub fn check(args: CheckArgs) -> Result<ExitCode, CommandError> {
    let denied = |is: bool| if is { Warnings::Denied } else { Warnings::Allowed };
    if let Some(folder) = args.write_stubs {
        let config = StubsConfig { paths: args.paths, dialect: args.dialect, libraries: args.libraries, folder };
        return Ok(stubs::write(&config, &mut std::io::stdout().lock())?);
    }
    let (warnings, stubs) = (denied(args.deny_warnings), denied(args.deny_stubs));
    let CheckArgs { paths, dialect, word_size, memory_limit, libraries, format, .. } = args;
    let format = format.into();
    let config = CheckConfig { paths, dialect, word_size, memory_limit, libraries, format, warnings, stubs };
    Ok(check::check(&config, &mut VerdictOutput::lock())?)
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

/// Explains a code.
///
/// # Errors
/// See [`CommandError`].
pub fn explain(args: &ExplainArgs) -> Result<ExitCode, CommandError> {
    let mut out = std::io::stdout().lock();
    match &args.code {
        Some(code) => check::explain::page(code, &mut out)?,
        None => check::explain::list(&mut out).map_err(OutputError)?,
    }
    Ok(ExitCode::Ok)
}

/// Options of `instrument`.
#[derive(Debug, ClapArgs)]
#[expect(clippy::struct_excessive_bools, reason = "each is a flag that is typed or not")]
#[command(group = clap::ArgGroup::new("result").required(true).multiple(true).args(["output", "in_place", "diff"]))]
pub struct InstrumentArgs {
    /// A folder, a source file, a TwinCAT project or a scenario
    pub project: PathBuf,
    /// For whom the shim's own sources are written: `iec`: program text of the standard, or
    /// PLCopen XML if the project is, `twincat`: TwinCAT 3 objects, `codesys`: PLCopen XML for CODESYS, `scl`:
    /// external sources for TIA Portal; to the last two a project in program text is put as a whole; `openplc` and
    /// `beremiz`: one file for MatIEC, with tasks and addresses, and the gateway's mapping beside it
    #[arg(long, value_enum, default_value_t)]
    pub target: TargetArg,
    /// A task and its programs, as in `fast:10ms:0=Main,Alarms`; may be given several times [default: the
    /// scenario's tasks, or one of 10 ms with all programs]
    #[arg(long = "task", value_name = "NAME:INTERVAL:PRIORITY=PROGRAM,...", value_parser = plc_task)]
    pub tasks: Vec<Task>,
    /// The PLC, of a scenario with several that have sources
    #[arg(long, value_name = "CLIENT", value_parser = client_name)]
    pub client: Option<ClientName>,
    /// How often the PLC runs the task that is written for it, as in `1ms`: virtual time goes on by the steps of the
    /// session, however fast that is; for `openplc` and `beremiz` [default: the shortest interval of the tasks]
    #[arg(long, value_name = "TIME", conflicts_with = "remove")]
    pub cycle: Option<TimeSpan>,
    /// The first address of the words of the handshake, as in `%MD100`; for `openplc` and `beremiz` [default: the
    /// first that the project leaves free]
    #[arg(long, value_name = "ADDRESS", conflicts_with = "remove")]
    pub words_at: Option<String>,
    /// Write the result into this folder
    #[arg(short, long, value_name = "DIR", conflicts_with = "in_place")]
    pub output: Option<PathBuf>,
    /// Change the project's own files
    #[arg(long)]
    pub in_place: bool,
    /// Show the changes as a unified diff
    #[arg(long)]
    pub diff: bool,
    /// Take over inputs that the PLC's I/O image writes, `AT %I…` and `%IX0.0` in statements, so that the gateway can
    /// write them: each gives its address to a twin `SDSP_IN_…`, whose value it has while `SDSP_Simulated` is FALSE
    #[arg(long, conflicts_with = "remove")]
    pub take_inputs: bool,
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
    /// One file for OpenPLC v3
    Openplc,
    /// One file for Beremiz
    Beremiz,
    /// Refused with its reason
    #[value(hide = true)]
    L5x,
}

impl TargetArg {
    fn target(self) -> Result<Target, CommandError> {
        match self {
            Self::Iec => Ok(Target::Iec),
            Self::Twincat => Ok(Target::TwinCat),
            Self::Codesys => Ok(Target::Codesys),
            Self::Scl => Ok(Target::Scl),
            Self::Openplc => Ok(Target::OpenPlc),
            Self::Beremiz => Ok(Target::Beremiz),
            Self::L5x => Err(logix("--target l5x").into()),
        }
    }
}

/// Attaches the shim, or takes it off.
///
/// # Errors
/// See [`CommandError`].
pub fn instrument(args: InstrumentArgs) -> Result<ExitCode, CommandError> {
    let destination = match args.output {
        Some(folder) => Destination::Folder(folder),
        None if args.in_place => Destination::InPlace,
        None => Destination::Nowhere,
    };
    let target = args.target.target()?;
    if !matches!(target, Target::OpenPlc | Target::Beremiz)
        && let Some(option) = args.cycle.map(|_| "--cycle").or(args.words_at.as_ref().map(|_| "--words-at"))
    {
        let help = "set it in the PLC's tool, or choose the target openplc or beremiz".to_owned();
        let message = format!("`{option}` is for targets whose tasks and addresses are written");
        return Err(Usage::new(message, Some(help)).into());
    }
    let config = InstrumentConfig {
        project: args.project,
        direction: if args.remove { Direction::Remove } else { Direction::Attach },
        target,
        tasks: args.tasks,
        client: args.client,
        inputs: if args.take_inputs { Inputs::Taken } else { Inputs::Left },
        cycle: args.cycle,
        words_at: args.words_at,
        destination,
        diff: if args.diff { Diff::Shown } else { Diff::Hidden },
        format: args.format.into(),
        warnings: if args.deny_warnings { Warnings::Denied } else { Warnings::Allowed },
    };
    Ok(crate::instrument::instrument(&config, &mut VerdictOutput::lock(), &mut std::io::stderr().lock())?)
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
        interval: Some(interval),
        priority: priority.parse().map_err(|_| format!("`{priority}` is not a priority: 0 comes first"))?,
        programs: programs.split(',').map(|program| program.trim().to_owned()).collect(),
        ..Task::default()
    })
}
