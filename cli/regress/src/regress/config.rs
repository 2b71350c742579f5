//! What is asked for.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use onescan_iec::{Dialect, MemoryLimit, WordSize};
use onescan_server::time::{TimeSpan, VirtualTime};

use super::selection::Selection;
use crate::check::collect::Reading;
use onescan_runner::how_far::HowFar;
use onescan_runner::run::coverage::CoverageRequest;

/// What becomes of snapshots that are new or have changed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Policy {
    /// They wait for a review.
    #[default]
    Pending,
    /// They are accepted unseen.
    Bless,
    /// Nothing is written; one that is missing is a failure.
    Check,
}

/// For whom the output is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TestFormat {
    #[default]
    Human,
    /// Machines: a JSON object a test, and one for all.
    Json,
    /// People who read it in a job of GitHub.
    Github,
}

/// What is said while tests run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Progress {
    /// Nothing: what is said depends on the tests alone.
    #[default]
    None,
    /// A bar on a terminal, and at the end how long it took.
    Bar,
    /// A line a test, and one now and then while none ends: CI servers stop jobs that say nothing.
    Lines,
    /// A line now and then, with how far it has come: for who reads a pipe.
    Sparse,
}

/// All options of a test run.
#[derive(Clone, Debug)]
pub struct TestConfig {
    /// Scenarios, folders with scenarios, PLC sources.
    pub paths: Vec<PathBuf>,
    /// Which of their tests.
    pub selection: Selection,
    /// How many processes at a time.
    pub jobs: NonZeroUsize,
    /// How long a process may take.
    pub timeout: TimeSpan,
    /// What becomes of snapshots.
    pub policy: Policy,
    /// The commit with the reviewed program; found in the repository if absent.
    pub against: Option<String>,
    /// For whom the output is.
    pub format: TestFormat,
    /// The cycle of test programs.
    pub scan: TimeSpan,
    /// When a test program that is not done has failed.
    pub until: VirtualTime,
    /// The dialect of test sources.
    pub dialect: Option<Dialect>,
    /// Bits of the registers of the target.
    pub word_size: Option<WordSize>,
    /// How much memory their variables may take.
    pub memory_limit: Option<MemoryLimit>,
    /// Sources of libraries that they use.
    pub libraries: Vec<PathBuf>,
    /// A report in the format of `JUnit`.
    pub junit: Option<PathBuf>,
    pub sarif: Option<PathBuf>,
    pub html: Option<PathBuf>,
    pub coverage: Option<CoverageRequest>,
    /// Markdown for people is added to this file.
    pub job_summary: Option<PathBuf>,
    /// What is said on standard error meanwhile.
    pub progress: Progress,
    /// Counts what is done, for one whom a signal interrupts.
    pub how_far: HowFar,
}

impl TestConfig {
    /// True if processes are to note what PLCs execute.
    pub fn covers(&self) -> bool {
        self.coverage.is_some() || self.html.is_some()
    }
}

/// What a process is to do.
#[derive(Clone, Debug, Default)]
pub struct WorkerConfig {
    /// A scenario to run, and
    pub scenario: Option<PathBuf>,
    /// which case of it.
    pub case: Option<String>,
    /// Sources with test programs.
    pub sources: Vec<PathBuf>,
    pub scan: Option<TimeSpan>,
    /// When a test program that is not done has failed.
    pub until: VirtualTime,
    pub dialect: Option<Dialect>,
    /// Bits of the registers of the target.
    pub word_size: Option<WordSize>,
    /// How much memory their variables may take.
    pub memory_limit: Option<MemoryLimit>,
    /// Sources of libraries that they use.
    pub libraries: Vec<PathBuf>,
    /// Which of their tests; names are held against filters elsewhere.
    pub selection: Selection,
    /// Whether to note what is executed.
    pub cover: bool,
    /// Whether to draw trajectories.
    pub draw: bool,
}

impl WorkerConfig {
    /// How its sources are read.
    pub fn reading(&self) -> Reading<'_> {
        let Self { dialect, word_size, memory_limit, .. } = *self;
        Reading { dialect, word_size, memory_limit, libraries: &self.libraries }
    }
}
