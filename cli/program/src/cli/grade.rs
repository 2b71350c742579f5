//! `onescan grade`, and its processes.

use std::num::{NonZeroU32, NonZeroUsize};
use std::path::PathBuf;

use clap::Args as ClapArgs;
use onescan_server::signal::ClientName;
use onescan_server::time::TimeSpan;

use super::error::CommandError;
use super::outputs;
use super::value::{FormatArg, client_name, jobs_or_cores};
use onescan_regress::grade::{self, Detail, GradeConfig, TaskConfig, WorkConfig};
use onescan_regress::regress::Selection;
use onescan_runner::error::ExitCode;
use onescan_runner::format::Format;

/// Options of `grade`.
#[derive(Debug, ClapArgs)]
#[command(
    after_help = "Exit codes: 0 all were graded, whatever their marks; 1 one has fewer than `--pass`; 2 the task is wrong,\n\
    or a submission is not there; 3 a process of a submission failed by this program's fault."
)]
pub struct GradeArgs {
    /// The task: a folder with a scenario.toml whose expectations have `marks`
    pub task: PathBuf,
    /// Folders or files with PLC sources, each one submission, as in `class/*`
    #[arg(required = true, value_name = "SUBMISSION")]
    pub submissions: Vec<PathBuf>,
    /// The soft PLC whose program is handed in [default: the only one]
    #[arg(long, value_name = "CLIENT", value_parser = client_name)]
    pub client: Option<ClientName>,
    /// More cases, in the form of cases.toml, which only the teacher has: a file, or a folder with such files; may be given
    /// several times
    #[arg(long, value_name = "FILE|DIR")]
    pub hidden: Vec<PathBuf>,
    /// A scenario with a solution, so that a report names the statement in which a program like it parts from it; may be
    /// given several times [default: solution-*.toml beside the task]
    #[arg(long = "solution", value_name = "FILE")]
    pub solutions: Vec<PathBuf>,
    /// Only cases with this tag; may be given several times
    #[arg(long = "tag", value_name = "TAG")]
    pub tags: Vec<String>,
    /// No cases with this tag; may be given several times
    #[arg(long = "skip-tag", value_name = "TAG")]
    pub skipped_tags: Vec<String>,
    /// How many submissions at a time, each in a process of its own [default: as many as there are processors]
    #[arg(short, long, value_name = "N")]
    pub jobs: Option<NonZeroUsize>,
    /// Time that a submission may take, all cases together; one that takes longer is ended, and what was run counts
    #[arg(long, default_value = "2min", value_name = "TIME")]
    pub time_limit: TimeSpan,
    /// MiB of memory that the process of a submission may take; on Linux
    #[arg(long, default_value = "1024", value_name = "MIB")]
    pub memory_limit: NonZeroU32,
    /// Fail with exit code 1 if a submission has fewer percent of the marks
    #[arg(long = "pass", value_name = "PERCENT", value_parser = clap::value_parser!(u8).range(0..=100))]
    pub pass_pct: Option<u8>,
    /// For people, with all details of a single submission or with `-v`; or a JSON object a submission, and one for all
    #[arg(long, value_enum, default_value_t)]
    pub format: FormatArg,
    /// Write a page about the class and each submission, all in one file
    #[arg(long, value_name = "FILE")]
    pub html: Option<PathBuf>,
    /// Write a report in the format of `JUnit`: a suite a submission, a test an expectation
    #[arg(long, value_name = "FILE")]
    pub junit: Option<PathBuf>,
    /// Write the marks of the class for a spreadsheet
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
}

impl GradeArgs {
    fn config(self, verbose: u8) -> GradeConfig {
        let format: Format = self.format.into();
        GradeConfig {
            task: TaskConfig {
                task: self.task,
                client: self.client,
                hidden: self.hidden,
                solutions: self.solutions,
                selection: Selection { tags: self.tags, skipped_tags: self.skipped_tags, ..Selection::default() },
            },
            submissions: self.submissions,
            jobs: jobs_or_cores(self.jobs),
            time_limit: self.time_limit,
            memory_limit_mib: self.memory_limit,
            pass_pct: self.pass_pct,
            detail: if verbose > 0 { Detail::Full } else { Detail::Line },
            progress: format == Format::Human && std::io::IsTerminal::is_terminal(&std::io::stderr()),
            format,
            html: self.html,
            junit: self.junit,
            csv: self.csv,
        }
    }
}

/// Options of a process of `grade`.
#[derive(Debug, ClapArgs)]
pub struct GradeWorkerArgs {
    /// The task
    #[arg(long)]
    pub task: PathBuf,
    /// Its soft PLC
    #[arg(long, value_parser = client_name)]
    pub client: Option<ClientName>,
    /// More cases
    #[arg(long)]
    pub hidden: Vec<PathBuf>,
    /// Solutions
    #[arg(long = "solution")]
    pub solutions: Vec<PathBuf>,
    /// Cases with one of these tags
    #[arg(long = "tag")]
    pub tags: Vec<String>,
    /// Cases with none of these
    #[arg(long = "skip-tag")]
    pub skipped_tags: Vec<String>,
    /// MiB of memory
    #[arg(long)]
    pub memory_limit: NonZeroU32,
    /// What was handed in
    pub submission: PathBuf,
}

/// Grades submissions; with all details where somebody asked for more to be said.
///
/// # Errors
/// See [`CommandError`].
pub fn grade(args: GradeArgs, verbose: u8) -> Result<ExitCode, CommandError> {
    outputs::files([&args.html, &args.junit, &args.csv])?;
    Ok(grade::grade(&args.config(verbose), &mut std::io::stdout().lock())?)
}

/// Grades one submission, as a process of [`grade`].
///
/// # Errors
/// See [`CommandError`].
pub fn work(args: GradeWorkerArgs) -> Result<ExitCode, CommandError> {
    let GradeWorkerArgs { task, client, hidden, solutions, tags, skipped_tags, memory_limit, submission } = args;
    let selection = Selection { tags, skipped_tags, ..Selection::default() };
    let task = TaskConfig { task, client, hidden, solutions, selection };
    let config = WorkConfig { task, submission, memory_limit_mib: memory_limit };
    grade::worker::work(&config, &mut std::io::stdout().lock())?;
    Ok(ExitCode::Ok)
}
