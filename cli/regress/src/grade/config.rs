//! What is asked for.

use std::num::{NonZeroU32, NonZeroUsize};
use std::path::PathBuf;

use onescan_runner::format::Format;
use onescan_server::signal::ClientName;
use onescan_server::time::TimeSpan;

use crate::regress::Selection;

/// What programs are judged by; the grader and its processes read it alike.
#[derive(Clone, Debug, Default)]
pub struct TaskConfig {
    /// The task: a scenario's folder or file.
    pub task: PathBuf,
    /// The soft PLC whose program is handed in; the only one if absent.
    pub client: Option<ClientName>,
    /// Files with cases that only the teacher has, and folders with such files.
    pub hidden: Vec<PathBuf>,
    /// Scenarios with a solution; those beside the task if there are none.
    pub solutions: Vec<PathBuf>,
    /// Which cases count, by their tags.
    pub selection: Selection,
}

/// How much is said of each submission.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Detail {
    /// One line with the marks.
    #[default]
    Line,
    /// All that was missed, and why.
    Full,
}

/// All options of `grade`.
#[derive(Clone, Debug)]
pub struct GradeConfig {
    /// What programs are judged by.
    pub task: TaskConfig,
    /// Folders and files, each one submission.
    pub submissions: Vec<PathBuf>,
    /// How many at a time.
    pub jobs: NonZeroUsize,
    /// How long a submission may take, all cases together.
    pub time_limit: TimeSpan,
    /// How much memory its process may take, MiB.
    pub memory_limit_mib: NonZeroU32,
    /// So many percent of the marks are asked for.
    pub pass_pct: Option<u8>,
    /// How much is said of each.
    pub detail: Detail,
    /// For whom the output is.
    pub format: Format,
    pub html: Option<PathBuf>,
    pub junit: Option<PathBuf>,
    pub csv: Option<PathBuf>,
    /// Whether a bar is shown.
    pub progress: bool,
}

/// What a process is to do.
#[derive(Clone, Debug)]
pub struct WorkConfig {
    /// What the program is judged by.
    pub task: TaskConfig,
    /// The submission's folder or file.
    pub submission: PathBuf,
    /// How much memory the process may take, MiB.
    pub memory_limit_mib: NonZeroU32,
}
