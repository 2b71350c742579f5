//! `scenario.toml` read and checked.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::{Path, PathBuf};

use miette::{NamedSource, SourceSpan};
use onescan_clients::soft_plc::CoverageSink;
use onescan_server::plan::{Coupling, PlanError, SessionPlan};
use onescan_server::signal::{ClientName, SignalDecl, SignalName, did_you_mean};
use onescan_server::time::TimeSpan;

use super::error::ScenarioError;
use super::expectations::Expectations;
use super::file::{ClientFile, CouplingFile, ScenarioFile, VERSION};

/// The file that makes a folder a scenario.
pub const FILE_NAME: &str = "scenario.toml";

/// A scenario, checked as far as that is possible without its plant and its PLC.
#[derive(Clone, Debug)]
pub struct Scenario {
    name: String,
    folder: PathBuf,
    path: PathBuf,
    text: String,
    file: ScenarioFile,
    plan: SessionPlan,
    expectations: Expectations,
    /// Where soft PLCs give what they executed, if that is asked for.
    coverage: Option<CoverageSink>,
    /// The soft PLCs that a real one stands in for, with its URL where the file's does not count.
    pub(super) gateways: BTreeMap<ClientName, Option<String>>,
}

impl Scenario {
    /// The scenario in `path`, a folder or its `scenario.toml`.
    ///
    /// # Errors
    /// See [`ScenarioError`].
    pub fn load(path: &Path) -> Result<Self, ScenarioError> {
        let path = if path.is_dir() { path.join(FILE_NAME) } else { path.to_owned() };
        let text = std::fs::read_to_string(&path).map_err(|source| ScenarioError::Unreadable {
            path: path.clone(),
            help: (source.kind() == std::io::ErrorKind::NotFound)
                .then(|| format!("a scenario is a folder with a `{FILE_NAME}`; give the folder")),
            source,
        })?;
        let folder = path.parent().map(Path::to_owned).unwrap_or_default();
        Self::parse(text, path, folder)
    }

    fn parse(text: String, path: PathBuf, folder: PathBuf) -> Result<Self, ScenarioError> {
        let wrong = |message: String, place: Option<Range<usize>>, help| wrong(&path, &text, message, place, help);
        let file: ScenarioFile =
            toml::from_str(&text).map_err(|e| wrong(e.message().trim().to_owned(), e.span(), None))?;
        if file.version != VERSION {
            let message = format!("version {} of the scenario format is not known", file.version);
            return Err(wrong(message, place_of(&text, "version"), Some(format!("write `version = {VERSION}`"))));
        }
        let plan = plan_of(&file).map_err(|error| {
            let place = place_of_plan_error(&error, &file, &text);
            wrong(error.to_string(), place, None)
        })?;
        for signal in &file.plot.signals {
            if !file.signals.contains_key(signal.get_ref()) {
                let message = format!("the plot shows a signal `{}` that is not declared", signal.get_ref());
                let help = did_you_mean(signal.get_ref().as_str(), file.signals.keys().map(SignalName::as_str));
                return Err(wrong(message, Some(signal.span()), help));
            }
        }
        let expectations =
            Expectations::bind(&file, &text).map_err(|found| wrong(found.message, Some(found.place), found.help))?;
        let name = std::path::absolute(&folder)
            .ok()
            .and_then(|folder| folder.file_name().map(|name| name.to_string_lossy().into_owned()))
            .unwrap_or_else(|| "scenario".to_owned());
        Ok(Self { name, folder, path, text, file, plan, expectations, coverage: None, gateways: BTreeMap::new() })
    }

    /// Lets soft PLCs note what they execute.
    pub fn cover(&mut self) {
        self.coverage.get_or_insert_default();
    }

    /// What soft PLCs have executed, if they note it; complete once they are gone.
    pub fn coverage(&self) -> Option<&CoverageSink> {
        self.coverage.as_ref()
    }

    /// The folder's name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The folder, to which all other files are relative.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// The file as it is written.
    pub fn file(&self) -> &ScenarioFile {
        &self.file
    }

    /// The plan of its sessions.
    pub fn plan(&self) -> &SessionPlan {
        &self.plan
    }

    /// What every run must show.
    pub fn expectations(&self) -> &Expectations {
        &self.expectations
    }

    /// An error at the entry of client `name`.
    pub(crate) fn wrong_client(&self, name: &ClientName, message: String, help: Option<String>) -> ScenarioError {
        let place = self.file.clients.get(name).map(toml::Spanned::span);
        wrong(&self.path, &self.text, message, place, help)
    }

    /// An error at the entry of signal `name`.
    pub(super) fn wrong_signal(&self, name: &SignalName, message: String, help: Option<String>) -> ScenarioError {
        let place = self.file.signals.get(name).map(toml::Spanned::span);
        wrong(&self.path, &self.text, message, place, help)
    }
}

fn wrong(path: &Path, text: &str, message: String, place: Option<Range<usize>>, help: Option<String>) -> ScenarioError {
    ScenarioError::Wrong {
        message,
        file: NamedSource::new(path.display().to_string(), text.to_owned()),
        place: place.map(SourceSpan::from),
        help,
    }
}

/// The line that begins with `key`.
fn place_of(text: &str, key: &str) -> Option<Range<usize>> {
    let mut start = 0;
    for line in text.split_inclusive('\n') {
        if line.trim_start().starts_with(key) {
            return Some(start..start + line.trim_end().len());
        }
        start += line.len();
    }
    None
}

fn plan_of(file: &ScenarioFile) -> Result<SessionPlan, PlanError> {
    let coupling = match &file.coupling {
        CouplingFile::Parallel => Coupling::Parallel,
        CouplingFile::Sequential(order) => Coupling::Sequential { order: order.clone() },
    };
    let signals = file.signals.iter().map(|(name, signal)| {
        let signal = signal.get_ref();
        SignalDecl { name: name.clone(), ty: signal.ty, writer: Some(signal.writer.clone()), unit: signal.unit.clone() }
    });
    SessionPlan::new(file.step, &coupling, signals.collect(), file.clients.keys().cloned().collect())
}

fn place_of_plan_error(error: &PlanError, file: &ScenarioFile, text: &str) -> Option<Range<usize>> {
    match error {
        PlanError::NoClients => place_of(text, "[clients"),
        PlanError::DoubleClient(name) => file.clients.get(name).map(toml::Spanned::span),
        PlanError::DoubleSignal(name) | PlanError::CaseTwins(_, name) => {
            file.signals.get(name).map(toml::Spanned::span)
        }
        PlanError::UnknownWriter { signal, .. } => file.signals.get(signal).map(toml::Spanned::span),
        PlanError::Order(_) => place_of(text, "coupling"),
    }
}

/// The period of the client `name` as far as the scenario says it.
pub fn period_of(client: &ClientFile, step: TimeSpan) -> Option<TimeSpan> {
    match client {
        ClientFile::Plant { period, .. } | ClientFile::Gateway { period, .. } => Some(period.unwrap_or(step)),
        ClientFile::SoftPlc { .. } | ClientFile::External { .. } => None,
    }
}
