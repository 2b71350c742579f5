//! What is asked for.

use std::num::{NonZeroU64, NonZeroUsize};
use std::path::PathBuf;

use onescan_server::time::VirtualTime;

use onescan_runner::format::Format;

/// How points are chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OptimiserKind {
    /// Evolution of a normal distribution by the adaptation of its covariances, begun again where it ends.
    CmaEs,
    /// Simulated annealing, hot again where nothing better comes.
    Annealing,
    /// Each point by itself, evenly.
    Random,
}

impl OptimiserKind {
    /// As it is typed.
    pub fn word(self) -> &'static str {
        match self {
            Self::CmaEs => "cma-es",
            Self::Annealing => "annealing",
            Self::Random => "random",
        }
    }
}

/// What is made small.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Objective {
    /// The margin by which an expectation holds.
    Robustness,
    /// How often the branches that a run takes were taken before.
    Coverage,
    /// The margin, less where a run takes branches that none took before.
    Both,
}

impl Objective {
    /// As it is typed.
    pub fn word(self) -> &'static str {
        match self {
            Self::Robustness => "robustness",
            Self::Coverage => "coverage",
            Self::Both => "both",
        }
    }
}

/// All options of a falsification.
#[derive(Clone, Debug)]
pub struct FalsifyConfig {
    /// The scenario's folder or file.
    pub scenario: PathBuf,
    /// The case to which inputs and parameters come; the scenario as it is if absent.
    pub case: Option<String>,
    /// The expectation that is to be broken; all of them if absent.
    pub expect: Option<String>,
    /// When a run is complete; the case says so if absent.
    pub until: Option<VirtualTime>,
    /// How points are chosen.
    pub optimiser: OptimiserKind,
    /// What is made small.
    pub objective: Objective,
    /// Seed of the search.
    pub seed: u64,
    /// So many simulations at most.
    pub runs_max: NonZeroU64,
    /// So many simulations at a time.
    pub jobs: NonZeroUsize,
    /// Whether somebody else chooses the points, and asks for what they are worth.
    pub points: bool,
    /// The file for the finding as a case.
    pub cases: Option<PathBuf>,
    /// The file for a picture of it.
    pub plot: Option<PathBuf>,
    /// For whom the output is.
    pub format: Format,
}
