//! What is asked for.

use std::fmt;
use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::str::FromStr;

use onescan_server::time::{TimeSpan, VirtualTime};
use thiserror::Error;

use onescan_runner::format::Format;

/// All options of a campaign.
#[derive(Clone, Debug)]
pub struct CampaignConfig {
    /// The campaigns, and their scenario.
    pub chosen: Chosen,
    /// How many runs at a time, each in a process of its own.
    pub jobs: NonZeroUsize,
    /// How long a run may take.
    pub timeout: TimeSpan,
    /// The folder in which the work is kept; a temporary one if absent.
    pub keep: Option<PathBuf>,
    /// The part of the runs to be done here; all if absent.
    pub partition: Option<Partition>,
    /// What is written about it.
    pub reports: Reports,
    /// True where a progress bar would be seen.
    pub progress: bool,
}

/// Which campaigns of which scenario.
#[derive(Clone, Debug)]
pub struct Chosen {
    /// The scenario's folder or file.
    pub scenario: PathBuf,
    /// Which campaign; all if absent.
    pub campaign: Option<String>,
    /// Whether each run goes to its end, also where it has come together with the run without faults.
    pub no_merge: bool,
}

/// What is written about campaigns.
#[derive(Clone, Debug, Default)]
pub struct Reports {
    /// For whom the output is.
    pub format: Format,
    /// The file for a page of all campaigns; none if absent.
    pub html: Option<PathBuf>,
    /// A report in the format of `JUnit`.
    pub junit: Option<PathBuf>,
}

/// The parts of a campaign to be put together.
#[derive(Clone, Debug)]
pub struct MergeConfig {
    /// The campaigns, and their scenario.
    pub chosen: Chosen,
    /// The folders in which the parts are.
    pub folders: Vec<PathBuf>,
    /// What is written about it.
    pub reports: Reports,
}

/// One of several parts of a campaign, each for a machine of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Partition {
    number: NonZeroUsize,
    of: NonZeroUsize,
}

/// A text that is not a part: not of the form `K/N`, or not with 1 ≤ K ≤ N.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("a part is `K/N`, as 3/8 for the third of eight")]
pub struct NoPartition;

impl Partition {
    /// True if the case of this number belongs to it, counted from 0. Neighbours go to different parts: the cases of one
    /// fault take about as long as each other.
    pub fn has(self, case: usize) -> bool {
        case % self.of == self.number.get() - 1
    }
}

impl FromStr for Partition {
    type Err = NoPartition;

    fn from_str(text: &str) -> Result<Self, NoPartition> {
        let (number, of) = text.split_once('/').ok_or(NoPartition)?;
        let part = |text: &str| text.parse::<NonZeroUsize>().map_err(|_| NoPartition);
        let (number, of) = (part(number)?, part(of)?);
        if number <= of { Ok(Self { number, of }) } else { Err(NoPartition) }
    }
}

impl fmt::Display for Partition {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.number, self.of)
    }
}

/// What a process is to run.
#[derive(Clone, Debug)]
pub struct WorkerConfig {
    /// The scenario's folder or file.
    pub scenario: PathBuf,
    /// The campaign's name in `cases.toml`.
    pub campaign: String,
    /// The folder of the checkpoints from which runs with faults fork.
    pub forks: PathBuf,
    /// Whether each run goes to its end, also where it has come together with the run without faults.
    pub no_merge: bool,
    /// Which of its runs.
    pub part: Part,
}

/// Runs of a campaign.
#[derive(Clone, Debug)]
pub enum Part {
    /// The one without faults, which leaves the checkpoints.
    Healthy,
    /// Some with faults, one after the other.
    Cases {
        /// Each of them, and where it begins.
        cases: Vec<Begun>,
        /// The journal, in which each is noted when it is done.
        journal: PathBuf,
    },
}

/// A case, and where its run begins. As text it is `START:CASE`, with the checkpoint's nanoseconds or nothing for START.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Begun {
    /// The case's name, `CAMPAIGN/FAULT/ACTIVATION`.
    pub case: String,
    /// Virtual time of the checkpoint from which it forks; from the start if absent.
    pub at: Option<VirtualTime>,
}

/// Not where a case begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("not of the form `NANOSECONDS:CASE` or `:CASE`")]
pub struct NotBegun;

impl FromStr for Begun {
    type Err = NotBegun;

    fn from_str(text: &str) -> Result<Self, NotBegun> {
        let (at, case) = text.split_once(':').ok_or(NotBegun)?;
        let at = match at {
            "" => None,
            at => Some(VirtualTime::from_nanos(at.parse().map_err(|_| NotBegun)?)),
        };
        Ok(Self { case: case.to_owned(), at })
    }
}

impl fmt::Display for Begun {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(at) = self.at {
            write!(f, "{}", at.as_nanos())?;
        }
        write!(f, ":{}", self.case)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_have_each_case_once() {
        let parts: Vec<Partition> = (1..=3).map(|k| format!("{k}/3").parse().unwrap()).collect();
        assert!((0..20).all(|case| parts.iter().filter(|part| part.has(case)).count() == 1));
        for wrong in ["0/3", "4/3", "3", "a/b", "1/0", "-1/2", ""] {
            assert_eq!(wrong.parse::<Partition>(), Err(NoPartition), "{wrong}");
        }
        assert_eq!(parts[2].to_string(), "3/3");
    }

    #[test]
    fn where_a_case_begins_is_read_as_it_is_written() {
        for text in [":a/b/c", "500:a/b/c", "0:a:b"] {
            assert_eq!(text.parse::<Begun>().unwrap().to_string(), text);
        }
        for wrong in ["a", "x:a", "-1:a"] {
            assert_eq!(wrong.parse::<Begun>(), Err(NotBegun), "{wrong}");
        }
    }
}
