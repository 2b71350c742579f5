//! What is asked for.
//!
//! Each part is what one room of a run needs to know; only [`super::execute`] sees the whole.

use std::collections::BTreeMap;
use std::net::SocketAddr;
use std::path::{Path, PathBuf};
use std::time::Duration;

use onescan_links::opcua::Access;
use onescan_recording::Choice;
use onescan_report::plot::Part;
use onescan_scenario::watch::WatchRequest;
use onescan_scenario::{Mode, Scenario};
use onescan_server::pacing::Pace;
use onescan_server::signal::pattern::SignalPattern;
use onescan_server::signal::{ClientName, SignalName};
use onescan_server::time::VirtualTime;
use onescan_server::timeline::When;

use super::coverage::CoverageRequest;
use crate::access::admission::Admission;
use crate::format::Format;
use crate::past::Budget;
use crate::web::Stay;

/// All options of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct RunConfig {
    pub subject: Subject,
    /// In lockstep or not.
    pub mode: Mode,
    /// Without lockstep: the seed of the clocks, if they are computed.
    pub seed: Option<u64>,
    pub runs: u32,
    /// How the scenario's clients are reached.
    pub reach: Reach,
    /// Who else may come, and where.
    pub doors: Doors,
    /// Where it begins, what is repeated, what is kept of it.
    pub course: Course,
    pub picture: Picture,
    /// What is looked at inside of soft PLCs.
    pub watch: Watch,
    /// What is written about it.
    pub reports: Reports,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Subject {
    /// The scenario's folder or file.
    pub scenario: PathBuf,
    /// The case to run; the scenario as it is if absent.
    pub case: Option<String>,
    /// When a run is complete; the scenario says so if absent.
    pub until: Option<VirtualTime>,
}

/// How the server reaches the scenario's clients.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Transport {
    /// Function calls in one process.
    #[default]
    Inproc,
    /// A process and a TCP connection a client.
    Tcp,
}

/// How the scenario's clients are reached.
#[derive(Clone, Debug, PartialEq)]
pub struct Reach {
    /// How its own clients are.
    pub transport: Transport,
    /// Real PLCs that stand in for soft ones, with their URL.
    pub gateways: Vec<(ClientName, Option<String>)>,
    /// Clients in whose place people operate.
    pub operated: Vec<ClientName>,
    /// Clients in whose place somebody takes part over OPC UA.
    pub opcua_clients: Vec<ClientName>,
    /// How long to wait for clients to join.
    pub join_timeout: Duration,
    /// How long a client may leave a grant unanswered.
    pub reply_timeout: Duration,
    /// Whether it is noted how long each client takes.
    pub latency: bool,
}

/// Where others than the scenario's own clients come in.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Doors {
    /// Where clients and operators may connect.
    pub listen: Option<SocketAddr>,
    /// Who is let in there.
    pub admission: Admission,
    /// Where the session is served as a page.
    pub web: Option<SocketAddr>,
    /// Whether the session begins only when somebody looks at the page.
    pub awaits_viewer: bool,
    /// How long the page stays when the session is over; without, viewers get the end, and that is all.
    pub stay: Option<Stay>,
    /// How much memory the past takes that the page shows.
    pub past: Budget,
    /// How many sessions may go on from moments of that past at a time.
    pub forks: u32,
    /// Whether operators may write what they did into the scenario's file of cases.
    pub saves_cases: bool,
    /// Where variables of the soft PLCs are served over ADS.
    pub ads: Option<SocketAddr>,
    /// Where the session is served over OPC UA.
    pub opcua: Option<SocketAddr>,
    /// Who is let in there.
    pub access: Access,
}

/// The course of a run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Course {
    /// How fast virtual time may run.
    pub pace: Pace,
    /// A checkpoint to go on from.
    pub resume: Option<PathBuf>,
    /// Whether that may be of other PLC code with the same variables and tasks.
    pub accept_code: bool,
    /// A recording, or a file of events, whose operator's inputs are repeated.
    pub replay_operator: Option<PathBuf>,
    /// A checkpoint to take.
    pub save: Option<SaveRequest>,
    /// Where others are to fork from it.
    pub forks: Option<ForkRequest>,
    /// Whether its state at the end is wanted, as a hash.
    pub state_at_end: bool,
    /// The states of another run, by virtual time: where this one is in the same state it ends, because it would do the
    /// same as that one.
    pub join: BTreeMap<VirtualTime, String>,
}

/// Checkpoints from which other cases fork.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ForkRequest {
    /// Where they go, each named after its virtual time: [`fork_file`](Self::fork_file).
    pub folder: PathBuf,
    /// The boundaries at which they are taken, in order.
    pub times: Vec<VirtualTime>,
    /// The boundaries at which its state is wanted, in order: others may come together with it there.
    pub states: Vec<VirtualTime>,
    /// Conditions: a checkpoint is taken at the last boundary before each comes true.
    pub conditions: Vec<When>,
}

impl ForkRequest {
    /// The file of the checkpoint that is taken at `t_v`.
    pub fn fork_file(folder: &Path, t_v: VirtualTime) -> PathBuf {
        folder.join(format!("{}.checkpoint", t_v.as_nanos()))
    }
}

/// A checkpoint to be taken.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SaveRequest {
    /// When: the first step boundary at or after this.
    pub at: VirtualTime,
    pub path: PathBuf,
}

/// What is drawn of the runs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Picture {
    /// Whether there is a plot, and where it goes.
    pub drawing: Drawing,
    /// The signals of the plot, those of the first pattern first; the scenario's choice if empty.
    pub signals: Vec<SignalPattern>,
    /// Two signals to be drawn against each other in the plot, across and up, in place of all over time.
    pub plane: Option<[SignalName; 2]>,
    /// A part of the plot to be drawn enlarged beside the whole.
    pub enlarged: Option<Part>,
    /// How several runs share it.
    pub runs: RunsDrawn,
}

/// How several runs share a plot over time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RunsDrawn {
    /// Over each other, a panel a signal.
    #[default]
    Overlaid,
    /// Each in panels of its own, one run beneath the other.
    Apart,
}

/// Whether there is a plot, and where it goes.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Drawing {
    #[default]
    Nothing,
    /// It is handed to the caller.
    Kept,
    /// It is written to a file.
    File(PathBuf),
}

/// What is looked at inside of soft PLCs.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Watch {
    pub variables: Vec<WatchRequest>,
    /// When they are reported.
    pub on: WatchOn,
}

/// When watched variables are reported.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum WatchOn {
    /// What they are last.
    #[default]
    End,
    Change,
}

/// What is written about the runs.
#[derive(Clone, Debug, PartialEq)]
pub struct Reports {
    /// For whom reports are.
    pub format: Format,
    /// True where a progress bar would be seen.
    pub progress: bool,
    pub record: Option<RecordRequest>,
    /// A coverage report to write.
    pub coverage: Option<CoverageRequest>,
    /// File for a page about all runs.
    pub html: Option<PathBuf>,
    /// Folder for the scenario's maps at the end of the last run.
    pub maps: Option<PathBuf>,
    /// A folder for the files that the soft PLCs have at the end.
    pub files: Option<PathBuf>,
}

/// What is to be recorded, and where.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RecordRequest {
    /// The folder of all runs.
    pub folder: PathBuf,
    /// Whether an earlier recording there may be replaced.
    pub overwrite: bool,
    pub choice: Choice,
}

impl RunConfig {
    /// One run in this process, as fast as it goes, that nobody looks at.
    pub fn headless(scenario: PathBuf, case: Option<String>) -> Self {
        Self {
            subject: Subject { scenario, case, until: None },
            mode: Mode::Lockstep,
            seed: None,
            runs: 1,
            reach: Reach {
                transport: Transport::Inproc,
                gateways: Vec::new(),
                operated: Vec::new(),
                opcua_clients: Vec::new(),
                join_timeout: Duration::from_mins(1),
                reply_timeout: Duration::from_secs(10),
                latency: false,
            },
            doors: Doors::default(),
            course: Course::default(),
            picture: Picture::default(),
            watch: Watch::default(),
            reports: Reports {
                format: Format::Json,
                progress: false,
                record: None,
                coverage: None,
                html: None,
                maps: None,
                files: None,
            },
        }
    }

    /// True if trajectories are drawn, in a picture or in a page.
    pub(super) fn is_drawn(&self) -> bool {
        self.picture.drawing != Drawing::Nothing || self.reports.html.is_some()
    }
}

impl Reports {
    /// True if something is made of what clients show when a run is over.
    pub(super) fn want_the_end(&self) -> bool {
        self.maps.is_some() || self.files.is_some() || self.html.is_some()
    }
}

impl Subject {
    /// When a run is complete.
    pub fn end(&self, scenario: &Scenario) -> VirtualTime {
        self.until.unwrap_or(scenario.until())
    }
}

impl Reach {
    /// True if turns are noted: on demand, and wherever a real PLC takes part.
    pub fn is_watched(&self) -> bool {
        self.latency || !self.gateways.is_empty()
    }
}

impl Picture {
    /// The signals of the plot with their panels' order.
    pub fn plotted(&self, scenario: &Scenario) -> Vec<SignalName> {
        let all = || scenario.file().signals.keys().cloned();
        if !self.signals.is_empty() {
            let mut names: Vec<SignalName> = Vec::new();
            for pattern in &self.signals {
                let matched = |name: &SignalName| pattern.matches(name.as_str()) && !names.contains(name);
                let more: Vec<SignalName> = all().filter(matched).collect();
                names.extend(more);
            }
            return names;
        }
        let chosen: Vec<SignalName> =
            scenario.file().plot.signals.iter().map(|signal| signal.get_ref().clone()).collect();
        if chosen.is_empty() { all().collect() } else { chosen }
    }

    /// The signals that are sampled: those of the plot and of its plane.
    pub(super) fn sampled(&self, scenario: &Scenario) -> Vec<SignalName> {
        let mut names = self.plotted(scenario);
        for name in self.plane.iter().flatten() {
            if !names.contains(name) {
                names.push(name.clone());
            }
        }
        names
    }
}
