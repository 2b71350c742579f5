//! What is asked for.

use std::net::SocketAddr;
use std::path::PathBuf;
use std::time::Duration;

use onescan_clients::opcua_server::Access;
use onescan_scenario::file::ClientFile;
use onescan_scenario::watch::WatchRequest;
use onescan_scenario::{Mode, Scenario};
use onescan_server::pacing::Pace;
use onescan_server::signal::pattern::choose;
use onescan_server::signal::{ClientName, SignalName, did_you_mean};
use onescan_server::time::VirtualTime;

use super::coverage::CoverageRequest;
use super::error::RunError;
use super::recorded::RecordRequest;

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

/// For whom the output is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Format {
    /// People.
    #[default]
    Human,
    /// Machines: one JSON object a run and line.
    Json,
}

/// A checkpoint to be taken.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SaveRequest {
    /// When: the first step boundary at or after this.
    pub at: VirtualTime,
    /// Where to.
    pub path: PathBuf,
}

/// All options of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct RunConfig {
    /// The scenario's folder or file.
    pub scenario: PathBuf,
    /// The case to run; the scenario as it is if absent.
    pub case: Option<String>,
    /// When a run is complete; the scenario says so if absent.
    pub until: Option<VirtualTime>,
    /// How fast virtual time may run.
    pub pace: Pace,
    /// In lockstep or not.
    pub mode: Mode,
    /// How many runs.
    pub runs: u32,
    /// How the scenario's own clients are reached.
    pub transport: Transport,
    /// Real PLCs that stand in for soft ones, with their URL.
    pub gateways: Vec<(ClientName, Option<String>)>,
    /// What is recorded.
    pub record: Option<RecordRequest>,
    /// A recording, or a file of events, whose operator's inputs are repeated.
    pub replay_operator: Option<PathBuf>,
    /// For whom reports are.
    pub format: Format,
    /// File for a plot.
    pub plot: Option<PathBuf>,
    /// The signals of the plot; the scenario's choice if empty.
    pub signals: Vec<SignalName>,
    /// Two signals to be drawn against each other in the plot, across and up, in place of all over time.
    pub plane: Option<[SignalName; 2]>,
    /// A coverage report to write.
    pub coverage: Option<CoverageRequest>,
    /// File for a page about all runs.
    pub html: Option<PathBuf>,
    /// Variables of soft PLCs to look at.
    pub watch: Vec<WatchRequest>,
    /// True if all their changes are wanted, not only what they are last.
    pub watch_changes: bool,
    /// Where clients and operators may connect.
    pub listen: Option<SocketAddr>,
    /// Where the session is served over OPC UA.
    pub opcua: Option<SocketAddr>,
    /// Clients in whose place somebody takes part over OPC UA.
    pub opcua_clients: Vec<ClientName>,
    /// Who is let in there.
    pub opcua_access: Access,
    /// How long to wait for clients to join.
    pub join_timeout: Duration,
    /// How long a client may leave a grant unanswered.
    pub reply_timeout: Duration,
    /// A checkpoint to take.
    pub save: Option<SaveRequest>,
    /// A checkpoint to go on from.
    pub resume: Option<PathBuf>,
    /// Whether it is noted how long each client takes.
    pub latency: bool,
    /// True where a progress bar would be seen.
    pub progress: bool,
}

impl RunConfig {
    /// One run in this process, as fast as it goes, that nobody looks at.
    pub fn headless(scenario: PathBuf, case: Option<String>) -> Self {
        Self {
            scenario,
            case,
            until: None,
            pace: Pace::Max,
            mode: Mode::Lockstep,
            runs: 1,
            transport: Transport::Inproc,
            gateways: Vec::new(),
            latency: false,
            record: None,
            replay_operator: None,
            format: Format::Json,
            plot: None,
            signals: Vec::new(),
            plane: None,
            coverage: None,
            html: None,
            watch: Vec::new(),
            watch_changes: false,
            listen: None,
            opcua: None,
            opcua_clients: Vec::new(),
            opcua_access: Access::default(),
            join_timeout: Duration::from_mins(1),
            reply_timeout: Duration::from_secs(10),
            save: None,
            resume: None,
            progress: false,
        }
    }

    /// True if turns are noted: on demand, and wherever a real PLC takes part.
    pub fn is_watched(&self) -> bool {
        self.latency || !self.gateways.is_empty()
    }

    /// When a run is complete.
    pub fn end(&self, scenario: &Scenario) -> VirtualTime {
        self.until.unwrap_or(scenario.until())
    }

    /// The signals of the plot with their panels' order.
    pub fn plotted(&self, scenario: &Scenario) -> Vec<SignalName> {
        if !self.signals.is_empty() {
            return self.signals.clone();
        }
        let chosen: Vec<SignalName> =
            scenario.file().plot.signals.iter().map(|signal| signal.get_ref().clone()).collect();
        if chosen.is_empty() { scenario.file().signals.keys().cloned().collect() } else { chosen }
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

    /// Refuses options that contradict each other or the scenario, before anything has begun.
    pub(super) fn check(&self, scenario: &Scenario) -> Result<(), RunError> {
        for signal in self.signals.iter().chain(self.plane.iter().flatten()) {
            if !scenario.file().signals.contains_key(signal) {
                let known = scenario.file().signals.keys().map(SignalName::as_str);
                let help = did_you_mean(signal.as_str(), known);
                return Err(RunError::usage(format!("the scenario has no signal `{signal}`"), help));
            }
        }
        if let Some(record) = &self.record {
            choose(&record.choice.signals, scenario.file().signals.keys())
                .map_err(|unmatched| RunError::usage(format!("--record-signals: {unmatched}"), None))?;
        }
        let step = scenario.file().step;
        if let Some(save) = self.save.as_ref().filter(|save| save.at >= self.end(scenario)) {
            let message = format!("--save-at {} is not before the end of the run at {}", save.at, self.end(scenario));
            return Err(RunError::usage(message, Some(format!("the step is {step}"))));
        }
        let inside = [("--coverage", self.coverage.is_some()), ("--watch", !self.watch.is_empty())];
        if let Some((option, _)) = inside.iter().find(|(_, given)| *given && self.transport == Transport::Tcp) {
            let help = "what a client in another process does is not seen here".to_owned();
            return Err(RunError::usage(format!("{option} means nothing with --transport tcp"), Some(help)));
        }
        self.check_opcua(scenario)?;
        match self.mode {
            Mode::Lockstep => Ok(()),
            Mode::Freewheel | Mode::Halt | Mode::Follow => self.check_freewheel(scenario),
        }
    }

    /// Who is to come over OPC UA must be somebody of the scenario, and come as he is.
    fn check_opcua(&self, scenario: &Scenario) -> Result<(), RunError> {
        for name in &self.opcua_clients {
            match scenario.file().clients.get(name).map(toml::Spanned::get_ref) {
                None => {
                    let help = did_you_mean(name.as_str(), scenario.file().clients.keys().map(ClientName::as_str));
                    return Err(RunError::usage(format!("the scenario has no client `{name}`"), help));
                }
                Some(ClientFile::External { .. } | ClientFile::OpcUa { .. }) => {
                    let message = format!("--opcua-client {name}: it is a program of its own anyway");
                    return Err(RunError::usage(message, None));
                }
                Some(_) => {}
            }
            if self.gateways.iter().any(|(gateway, _)| gateway == name) {
                let message =
                    format!("`{name}` cannot be a real PLC (--gateway) and come over OPC UA (--opcua-client)");
                return Err(RunError::usage(message, None));
            }
        }
        if self.case.is_some() && !self.opcua_clients.is_empty() {
            let help = "what a case changes in a client does not reach a program that stands in for it".to_owned();
            return Err(RunError::usage("--opcua-client means nothing with --case", Some(help)));
        }
        Ok(())
    }

    /// Free-wheeling has no server: what only a server can do is refused, not ignored.
    fn check_freewheel(&self, scenario: &Scenario) -> Result<(), RunError> {
        let options = [
            ("--transport tcp", self.transport == Transport::Tcp),
            ("--pace", self.pace != Pace::Max),
            ("--listen", self.listen.is_some()),
            ("--opcua", self.opcua.is_some()),
            ("--opcua-client", !self.opcua_clients.is_empty()),
            ("--save-at", self.save.is_some()),
            ("--resume", self.resume.is_some()),
            ("--replay-operator", self.replay_operator.is_some()),
        ];
        if let Some((option, _)) = options.iter().find(|(_, given)| *given) {
            let help = "free-wheeling clients run in real time in this process, each on its own clock".to_owned();
            let mode = self.mode.name();
            return Err(RunError::usage(format!("{option} means nothing with --mode {mode}"), Some(help)));
        }
        let external = |client: &toml::Spanned<ClientFile>| {
            matches!(client.get_ref(), ClientFile::External { .. } | ClientFile::OpcUa { .. })
        };
        match scenario.file().clients.iter().find(|(_, client)| external(client)) {
            Some((name, _)) => {
                Err(RunError::usage(format!("the external client `{name}` can only take part in lockstep"), None))
            }
            None => Ok(()),
        }
    }
}
