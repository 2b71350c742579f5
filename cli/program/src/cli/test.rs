//! `onescan test` with its processes, and `onescan review`.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::{Args as ClapArgs, ValueEnum};
use onescan_iec::{Dialect, MemoryLimit, WordSize};
use onescan_server::time::{TimeSpan, VirtualTime};

use super::error::CommandError;
use super::outputs;
use super::run::CoverageArg;
use super::value::jobs_or_cores;
use super::verdict_output::VerdictOutput;
use onescan_regress::check::collect::Reading;
use onescan_regress::regress::config::WorkerConfig;
use onescan_regress::regress::{Policy, Progress, Selection, TestConfig, TestFormat};
use onescan_regress::review::{Choice, ReviewConfig};
use onescan_runner::error::ExitCode;
use onescan_runner::how_far::{HowFar, Total};
use onescan_runner::run::coverage::CoverageRequest;

/// Options of `test`.
#[derive(Debug, ClapArgs)]
pub struct TestArgs {
    /// Scenarios, folders with scenarios below them, or PLC sources with test programs (`TEST_…`), which
    /// are compiled together
    #[arg(value_name = "PATH", default_value = ".")]
    pub paths: Vec<PathBuf>,
    /// Only tests whose name, as in `scenarios/shear/default`, has this text in it; may be given several times
    #[arg(short, long = "filter", value_name = "TEXT")]
    pub filters: Vec<String>,
    /// Only tests with this tag; may be given several times
    #[arg(long = "tag", value_name = "TAG")]
    pub tags: Vec<String>,
    /// No tests with this tag; may be given several times
    #[arg(long = "skip-tag", value_name = "TAG")]
    pub skipped_tags: Vec<String>,
    /// How many tests at a time, each in a process of its own [default: as many as there are processors]
    #[arg(short, long, value_name = "N")]
    pub jobs: Option<NonZeroUsize>,
    /// Time that one test, or all test programs of one call, may take; what takes longer is ended and has failed
    #[arg(long, default_value = "10min", value_name = "TIME")]
    pub timeout: TimeSpan,
    /// Accept every snapshot that is new or has changed, unseen
    #[arg(long, conflicts_with = "check")]
    pub bless: bool,
    /// For CI: write no snapshot, and fail if one is missing
    #[arg(long)]
    pub check: bool,
    /// The commit with the reviewed program, to name the statement in which a test parts from it [default: HEAD,
    /// else the commit that last changed the snapshot]
    #[arg(long, value_name = "COMMIT")]
    pub against: Option<String>,
    /// For people; a JSON object a test, and one for all; or for a job of GitHub
    #[arg(long, value_enum, default_value_t)]
    pub format: TestFormatArg,
    /// Write a report in the format of `JUnit`
    #[arg(long, value_name = "FILE")]
    pub junit: Option<PathBuf>,
    /// Write PLC faults, failed asserts and where a PLC parts from what was reviewed as a SARIF 2.1.0 log
    #[arg(long, value_name = "FILE")]
    pub sarif: Option<PathBuf>,
    /// Write a page with trajectories, expectations, events and coverage, all in one file
    #[arg(long, value_name = "FILE")]
    pub html: Option<PathBuf>,
    /// Write which statements and branches were executed, by all tests together
    #[arg(long, value_name = "FILE")]
    pub coverage: Option<PathBuf>,
    /// `lcov` or `cobertura` [default: by the file's name: `.xml` is Cobertura]
    #[arg(long, value_enum, requires = "coverage", value_name = "FORMAT")]
    pub coverage_format: Option<CoverageArg>,
    /// The cycle of test programs
    #[arg(long, default_value = "10ms", value_name = "TIME")]
    pub scan: TimeSpan,
    /// Virtual time at which a test program with an output `Done`, and all suites of `TcUnit`, must be done
    #[arg(long, default_value = "1min", value_name = "TIME")]
    pub until: VirtualTime,
    /// The dialect of sources with test programs [default: what a file's name says, else iec3]
    #[arg(long, value_name = "NAME")]
    pub dialect: Option<Dialect>,
    /// Bits of the registers in which the target of these sources computes integers, in the dialects codesys and
    /// twincat: 32 or 64 [default: 64]
    #[arg(long, value_name = "BITS")]
    pub word_size: Option<WordSize>,
    /// Refuse PLC sources that call a stub: a unit behind `{external}`, which does nothing
    #[arg(long)]
    pub deny_stubs: bool,
    /// MiB that all variables of these sources may take together, up to 2047 [default: 64]
    #[arg(long, value_name = "MIB")]
    pub memory_limit: Option<MemoryLimit>,
    /// A library that the sources use, as `TcUnit`: a folder or a TwinCAT project, read as its source; may be given
    /// several times. A project's folder `libraries` is read without this
    #[arg(long = "library", value_name = "PATH")]
    pub libraries: Vec<PathBuf>,
}

/// See [`TestFormat`].
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
pub enum TestFormatArg {
    /// For people
    #[default]
    Human,
    /// For machines
    Json,
    /// As for people, with marks at the lines of a pull request, and a table on the page of the job, which
    /// `GITHUB_STEP_SUMMARY` names
    Github,
}

impl From<TestFormatArg> for TestFormat {
    fn from(arg: TestFormatArg) -> Self {
        match arg {
            TestFormatArg::Human => Self::Human,
            TestFormatArg::Json => Self::Json,
            TestFormatArg::Github => Self::Github,
        }
    }
}

/// A bar where somebody sees it, lines where a CI server takes them down, all of which set `CI`; else a line when long nothing was
/// said.
fn progress(format: TestFormat) -> Progress {
    if format == TestFormat::Json {
        Progress::None
    } else if std::io::IsTerminal::is_terminal(&std::io::stderr()) {
        Progress::Bar
    } else if format == TestFormat::Github || std::env::var_os("CI").is_some() {
        Progress::Lines
    } else {
        Progress::Sparse
    }
}

impl TestArgs {
    fn config(self, how_far: HowFar) -> TestConfig {
        let format: TestFormat = self.format.into();
        TestConfig {
            paths: self.paths,
            selection: Selection { filters: self.filters, tags: self.tags, skipped_tags: self.skipped_tags },
            timeout: self.timeout,
            jobs: jobs_or_cores(self.jobs),
            policy: match (self.bless, self.check) {
                (true, _) => Policy::Bless,
                (_, true) => Policy::Check,
                _ => Policy::Pending,
            },
            progress: progress(format),
            how_far,
            job_summary: std::env::var_os("GITHUB_STEP_SUMMARY")
                .filter(|_| format == TestFormat::Github)
                .map(PathBuf::from),
            format,
            against: self.against,
            scan: self.scan,
            until: self.until,
            dialect: self.dialect,
            word_size: self.word_size,
            memory_limit: self.memory_limit,
            libraries: self.libraries,
            junit: self.junit,
            sarif: self.sarif,
            html: self.html,
            coverage: self.coverage.map(|path| CoverageRequest::new(path, self.coverage_format.map(Into::into))),
        }
    }
}

/// Options of `review`.
#[derive(Debug, ClapArgs)]
#[command(group = clap::ArgGroup::new("choice").args(["accept_all", "reject_all", "list"]))]
pub struct ReviewArgs {
    /// Scenarios, or folders with scenarios below them
    #[arg(value_name = "SCENARIO", default_value = ".")]
    pub paths: Vec<PathBuf>,
    /// Accept all
    #[arg(long)]
    pub accept_all: bool,
    /// Reject all: what was reviewed before stays
    #[arg(long)]
    pub reject_all: bool,
    /// Name them, and decide nothing
    #[arg(long)]
    pub list: bool,
    /// Write all as a page, old over new and their difference, in one file
    #[arg(long, value_name = "FILE")]
    pub html: Option<PathBuf>,
}

impl ReviewArgs {
    fn config(self) -> ReviewConfig {
        let choice = match (self.accept_all, self.reject_all, self.list) {
            (true, ..) => Choice::AcceptAll,
            (_, true, _) => Choice::RejectAll,
            (_, _, true) => Choice::List,
            _ => Choice::Ask,
        };
        ReviewConfig { paths: self.paths, choice, html: self.html }
    }
}

/// Options of a process of `test`.
#[derive(Debug, ClapArgs)]
pub struct WorkerArgs {
    /// The scenario
    #[arg(long)]
    pub scenario: Option<PathBuf>,
    /// The case
    #[arg(long)]
    pub case: Option<String>,
    /// Sources with test programs
    #[arg(long = "source")]
    pub sources: Vec<PathBuf>,
    /// Their cycle
    #[arg(long)]
    pub scan: Option<TimeSpan>,
    /// Their bound
    #[arg(long, default_value = "1min")]
    pub until: VirtualTime,
    /// Their dialect
    #[arg(long)]
    pub dialect: Option<Dialect>,
    /// Their registers
    #[arg(long)]
    pub word_size: Option<WordSize>,
    /// Their memory
    #[arg(long)]
    pub memory_limit: Option<MemoryLimit>,
    /// Their libraries
    #[arg(long = "library")]
    pub libraries: Vec<PathBuf>,
    /// With one of these tags
    #[arg(long = "tag")]
    pub tags: Vec<String>,
    /// With none of these
    #[arg(long = "skip-tag")]
    pub skipped_tags: Vec<String>,
    /// Note what is executed
    #[arg(long)]
    pub cover: bool,
    /// Draw trajectories
    #[arg(long)]
    pub draw: bool,
}

impl WorkerArgs {
    fn config(self) -> WorkerConfig {
        let Self { scenario, case, sources, scan, until, dialect, word_size, memory_limit, cover, draw, .. } = self;
        let (libraries, tags, skipped_tags) = (self.libraries, self.tags, self.skipped_tags);
        let selection = Selection { tags, skipped_tags, ..Selection::default() };
        WorkerConfig {
            scenario,
            case,
            sources,
            scan,
            until,
            dialect,
            word_size,
            memory_limit,
            libraries,
            selection,
            cover,
            draw,
        }
    }
}

/// Runs tests.
///
/// # Errors
/// See [`CommandError`].
pub fn test(args: TestArgs) -> Result<ExitCode, CommandError> {
    outputs::files([&args.junit, &args.sarif, &args.html, &args.coverage])?;
    if args.deny_stubs {
        let reading = Reading { dialect: args.dialect, libraries: &args.libraries, ..Reading::default() };
        onescan_regress::regress::deny_stubs(&args.paths, reading)?;
    }
    let how_far = HowFar::of(["test", "tests"], Total::Exact);
    how_far.on_signals();
    Ok(onescan_regress::regress::test(&args.config(how_far), &mut VerdictOutput::lock())?)
}

/// Decides on snapshots.
///
/// # Errors
/// See [`CommandError`].
pub fn review(args: ReviewArgs) -> Result<ExitCode, CommandError> {
    outputs::files([&args.html])?;
    Ok(onescan_regress::review::review(&args.config(), &mut std::io::stdout().lock())?)
}

/// Runs one test, as a process of [`test`].
///
/// # Errors
/// See [`CommandError`].
pub fn work(args: WorkerArgs) -> Result<ExitCode, CommandError> {
    onescan_regress::regress::worker::work(&args.config(), &mut std::io::stdout().lock())?;
    Ok(ExitCode::Ok)
}
