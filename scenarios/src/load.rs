//! `scenario.toml` read and checked.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use onescan_iec_run::{CodePolicy, RunError};
use onescan_links::gateway::Settings;
use onescan_server::plan::{Coupling, PlanError, SessionPlan};
use onescan_server::signal::{ClientName, SignalDecl, SignalName, did_you_mean};
use onescan_server::time::{TimeSpan, VirtualTime};
use onescan_soft_plc::journal::{Journalling, Wanted};
use onescan_soft_plc::{CoverageSink, TraceSink};
use serde::Deserialize;
use toml::de::{DeTable, Deserializer};

use super::base::{self, Chain};
use super::case::{self, Applied, Catalogue};
use super::compilations::Compilations;
use super::error::{ScenarioError, Wrong, wrong};
use super::expectations::Expectations;
use super::falsify::{self, Varied, VariedParameter};
pub use super::file::FILE_NAME;
use super::file::{ClientFile, CouplingFile, ScenarioFile, VERSION};
use super::look::Looks;
use super::map;
use super::missing;
use super::mistake::Mistake;
use super::places::{self, OfTask};
use super::programs::Programs;
use super::report::Measures;
use super::start::{self, StartLogic};
use super::timing::Timing;
use super::watch::{WatchRequest, Watched};
use super::{arrays, panel, structure, timing};

/// Where in `folder` the scenario `name` is that was kept there. `file` is its file if that is not called as usual; recordings
/// of earlier versions do not say it, but have one scenario alone, which has given them its name.
pub fn kept_as(folder: &Path, name: &str, file: Option<&str>) -> PathBuf {
    // A recording is somebody else's: its file is one of this folder, whatever it says.
    if let Some(file) = file.and_then(|file| Path::new(file).file_name()) {
        return folder.join(file);
    }
    let usual = folder.join(FILE_NAME);
    if usual.is_file() { usual } else { folder.join(format!("{name}.toml")) }
}

/// A scenario, checked as far as that is possible without its plant and its PLC.
///
/// ```
/// use onescan_scenario::Scenario;
///
/// let scenario = Scenario::load("shear".as_ref())?;
/// assert_eq!(scenario.plan().step().to_string(), "10 ms");
/// assert_eq!(scenario.plan().clients().len(), 2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Scenario {
    name: String,
    folder: PathBuf,
    path: PathBuf,
    /// Its file, and those that it takes in.
    chain: Chain,
    file: ScenarioFile,
    plan: SessionPlan,
    expectations: Expectations,
    measures: Option<Measures>,
    looks: Looks,
    /// The case that is tried; nothing for the scenario as it is.
    applied: Option<Arc<Applied>>,
    /// Where soft PLCs give what they executed, if that is asked for.
    coverage: Option<CoverageSink>,
    /// Where soft PLCs report which statements wrote these signals, if that is asked for.
    writers: Option<(BTreeSet<SignalName>, TraceSink)>,
    /// What soft PLCs hand over of their scans, if that is asked for.
    journalling: Option<Journalling>,
    /// The soft PLCs that a real one stands in for, with its URL where the file's does not count.
    /// What must hold before virtual time runs.
    pub start: Option<StartLogic>,
    pub(crate) gateways: BTreeMap<ClientName, Option<String>>,
    /// Their links, where files of their own say them.
    pub(crate) links: BTreeMap<ClientName, LinkSource>,
    /// What soft PLCs look at, if that is asked for.
    pub(crate) watched: Option<Watched>,
    /// Whether soft PLCs show their memories, however large they are.
    pub(crate) shows_memories: bool,
    /// What may happen at other times.
    timing: Timing,
    /// Whose states its soft PLCs take.
    code_policy: CodePolicy,
    /// What may be varied.
    varied: Varied,
    /// Its soft PLCs, as far as they have been compiled.
    pub(crate) compilations: Compilations,
    /// What is wrong on purpose with the program of one of them.
    mistake: Option<Arc<Mistake>>,
    /// Programs in the place of those that its file names.
    pub(crate) programs: Programs,
}

/// True if a path is that of a scenario: a folder with a `scenario.toml`, or a file in TOML.
pub fn is_scenario(path: &Path) -> bool {
    path.join(FILE_NAME).is_file() || path.is_file() && path.extension().is_some_and(|extension| extension == "toml")
}

impl Scenario {
    /// The scenario in `path`, a folder or its `scenario.toml`.
    ///
    /// # Errors
    /// See [`ScenarioError`].
    pub fn load(path: &Path) -> Result<Self, ScenarioError> {
        let path = if path.is_dir() { path.join(FILE_NAME) } else { path.to_owned() };
        let folder = path.parent().map(Path::to_owned).unwrap_or_default();
        Self::of(base::read(&path)?, path, folder)
    }

    fn of(chain: Chain, path: PathBuf, folder: PathBuf) -> Result<Self, ScenarioError> {
        let texts = chain.texts();
        let wrong = |message: String, place: Option<Range<usize>>, help| texts.wrong(message, place, help);
        let mut file = ScenarioFile::deserialize(Deserializer::from(chain.tree()?))
            .map_err(|e| wrong(e.message().trim().to_owned(), e.span(), None))?;
        if file.version != VERSION {
            let message = format!("version {} of the scenario format is not known", file.version);
            let place = place_of(texts.text(), "version");
            return Err(wrong(message, place, Some(format!("write `version = {VERSION}`"))));
        }
        // Before the plan is made, and the plot last: names are looked up as they are after the expansion.
        structure::expand(&mut file)
            .and_then(|()| arrays::expand_plot(&mut file))
            .map_err(|found| wrong(found.message, found.place, found.help))?;
        let plan = plan_of(&file).map_err(|error| {
            let place = place_of_plan_error(&error, &file, texts.text());
            wrong(error.to_string(), place, None)
        })?;
        for signal in file.signals.values() {
            if let Some((message, help)) = signal.get_ref().names.misfit(signal.get_ref().ty) {
                return Err(wrong(message, Some(signal.span()), Some(help)));
            }
        }
        for signal in &file.plot.signals {
            if !file.signals.contains_key(signal.get_ref()) {
                let message = format!("the plot shows a signal `{}` that is not declared", signal.get_ref());
                let help = did_you_mean(signal.get_ref().as_str(), file.signals.keys().map(SignalName::as_str));
                return Err(wrong(message, Some(signal.span()), help));
            }
        }
        let placed = |found: Wrong| wrong(found.message, Some(found.place), found.help);
        panel::check(&file).map_err(placed)?;
        map::check(&file).map_err(placed)?;
        let timing = timing::bind(&file).map_err(placed)?;
        let varied = falsify::bind(&file).map_err(placed)?;
        let start = start::bind(&file, texts.text()).map_err(placed)?;
        let expectations = Expectations::bind(&file, texts.text()).map_err(placed)?;
        let measures = Measures::bind(&file, texts.text()).map_err(placed)?;
        let looks = Looks::bind(&file, texts.text()).map_err(placed)?;
        let name = name_of(&path);
        let scenario = Self {
            name,
            folder,
            path,
            chain,
            file,
            plan,
            expectations,
            measures,
            looks,
            applied: None,
            coverage: None,
            writers: None,
            journalling: None,
            start,
            gateways: BTreeMap::new(),
            links: BTreeMap::new(),
            watched: None,
            shows_memories: false,
            timing,
            code_policy: CodePolicy::default(),
            varied,
            compilations: Compilations::default(),
            mistake: None,
            programs: Programs::default(),
        };
        scenario.panel_disturbances()?;
        scenario.checked()?.pictured()
    }

    /// The scenario's own file as if it were one of cases: for what both can say.
    pub(crate) fn own_catalogue(&self) -> Catalogue {
        Catalogue::without_cases(self.chain.texts().clone())
    }

    /// The case that is tried.
    pub fn case(&self) -> Option<&case::Case> {
        self.applied().map(|applied| &applied.case)
    }

    /// Lets soft PLCs take states of other sources with the same variables and tasks.
    pub fn accept_code(&mut self) {
        self.code_policy = CodePolicy::AnyCode;
    }

    /// Whose states PLC `name` takes: a case with another program in it goes on from where the scenario's own was.
    pub(crate) fn code_policy(&self, name: &ClientName) -> CodePolicy {
        if self.code_of_case(name).next().is_some() { CodePolicy::AnyCode } else { self.code_policy }
    }

    /// What `[timing]` says.
    pub(crate) fn timing(&self) -> &Timing {
        &self.timing
    }

    /// An error in `[timing]` that is found when PLCs are made.
    pub(crate) fn wrong_timing(&self, message: String, place: &Range<usize>, help: Option<String>) -> ScenarioError {
        self.chain.texts().wrong(message, Some(place.clone()), help)
    }

    /// What may be varied, by `[falsify]`.
    pub fn varied(&self) -> &Varied {
        &self.varied
    }

    /// An error of a parameter that is varied.
    pub fn wrong_parameter(&self, parameter: &VariedParameter, message: String, help: Option<String>) -> ScenarioError {
        self.chain.texts().wrong(message, Some(parameter.place.clone()), help)
    }

    pub(crate) fn mistake(&self) -> Option<&Mistake> {
        self.mistake.as_deref()
    }

    /// What was compiled without the mistake is not what runs with it.
    pub(crate) fn set_mistake(&mut self, mistake: Arc<Mistake>, compilations: Compilations) {
        (self.mistake, self.compilations) = (Some(mistake), compilations);
    }

    pub(crate) fn compilations(&self) -> &Compilations {
        &self.compilations
    }

    pub(crate) fn applied(&self) -> Option<&Applied> {
        self.applied.as_deref()
    }

    pub(crate) fn put_on(&mut self, applied: Applied) {
        self.applied = Some(Arc::new(applied));
    }

    /// Lets a component fail by somebody's hand: it is looked for when its plant is read.
    pub(crate) fn may_fail(&mut self, failure: case::FailureAt) {
        if let Some(applied) = &mut self.applied {
            Arc::make_mut(applied).failures.push(failure);
        }
    }

    pub(crate) fn set_expectations(&mut self, expectations: Expectations) {
        self.expectations = expectations;
    }

    /// When a run is complete.
    pub fn until(&self) -> VirtualTime {
        self.case().and_then(|case| case.until).unwrap_or(self.file.until)
    }

    /// What chance begins with.
    pub fn seed(&self) -> u64 {
        self.case().and_then(|case| case.seed).unwrap_or(self.file.seed)
    }

    /// Lets a plant that follows a PLC correct so much of its error at each communication, %.
    pub fn follow_with(&mut self, gain_pct: u8) {
        self.file.freewheel.synchronizer_gain_pct = gain_pct;
    }

    /// The same, of which nothing is noted, traced or watched: what it does again was seen the first time.
    #[must_use]
    pub fn unobserved(&self) -> Self {
        Self { coverage: None, writers: None, journalling: None, watched: None, ..self.clone() }
    }

    /// Lets soft PLCs note what they execute.
    pub fn cover(&mut self) {
        self.coverage.get_or_insert_default();
    }

    /// Lets soft PLCs report which statements write `signals`; returns where they do.
    pub fn trace(&mut self, signals: BTreeSet<SignalName>) -> TraceSink {
        let sink = TraceSink::default();
        self.writers = Some((signals, sink.clone()));
        sink
    }

    /// Lets soft PLCs hand over what their scans do.
    pub fn journal(&mut self, journalling: Journalling) {
        self.journalling = Some(journalling);
    }

    /// Lets soft PLCs look at variables, at all their changes if `changes`, else at what they are last.
    ///
    /// # Errors
    /// A PLC is not named, or is none of the scenario's. Paths are looked at when the PLCs are made.
    pub fn watch(&mut self, requests: &[WatchRequest], changes: bool) -> Result<(), ScenarioError> {
        let is_plc = |client: &ClientFile| matches!(client, ClientFile::SoftPlc { .. });
        let plcs = self.file.clients.iter().filter(|(_, each)| is_plc(each.get_ref())).map(|(name, _)| name.clone());
        let watched = Watched::new(requests, &plcs.collect::<Vec<_>>(), changes);
        self.watched = Some(watched.map_err(|unclear| self.wrong_option(unclear.message, Some(unclear.help)))?);
        Ok(())
    }

    /// The signals whose writers are asked for, and where they are reported.
    pub fn writers(&self) -> Option<&(BTreeSet<SignalName>, TraceSink)> {
        self.writers.as_ref()
    }

    /// What soft PLCs hand over of their scans.
    pub(crate) fn journalling(&self) -> Option<&Journalling> {
        self.journalling.as_ref()
    }

    /// True if statements report what they do.
    pub(crate) fn is_traced(&self) -> bool {
        self.writers.is_some() || self.journalling.as_ref().is_some_and(|each| matches!(each.wanted, Wanted::Acts(_)))
    }

    /// What soft PLCs have executed, if they note it; complete once they are gone.
    pub fn coverage(&self) -> Option<&CoverageSink> {
        self.coverage.as_ref()
    }

    /// The folder's name, or the file's if that is not the folder's only one.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The folder, to which all other files are relative.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    pub(crate) fn chain(&self) -> &Chain {
        &self.chain
    }

    /// The files that it takes in, the nearest first.
    pub fn bases(&self) -> impl Iterator<Item = &Path> {
        self.chain.texts().paths().skip(1)
    }

    /// The file as it is written, with everything of its bases.
    pub fn file(&self) -> &ScenarioFile {
        &self.file
    }

    /// What is in the place of client `name` from now on.
    pub(crate) fn set_client(&mut self, name: ClientName, client: toml::Spanned<ClientFile>) {
        self.file.clients.insert(name, client);
    }

    /// The plan of its sessions.
    pub fn plan(&self) -> &SessionPlan {
        &self.plan
    }

    /// What every run must show.
    pub fn expectations(&self) -> &Expectations {
        &self.expectations
    }

    /// What bodies look like, and what is drawn beside them.
    pub fn looks(&self) -> &Looks {
        &self.looks
    }

    /// An error at a place of the scenario's file.
    pub(crate) fn wrong_at(&self, found: Wrong) -> ScenarioError {
        self.chain.texts().wrong(found.message, Some(found.place), found.help)
    }

    /// What is counted and timed in every run, if that is asked for.
    pub fn measures(&self) -> Option<&Measures> {
        self.measures.as_ref()
    }

    /// An error at the entry of client `name`.
    pub fn wrong_client(&self, name: &ClientName, message: String, help: Option<String>) -> ScenarioError {
        let place = self.file.clients.get(name).map(toml::Spanned::span);
        self.chain.texts().wrong(message, place, help)
    }

    /// A file that client `name` names and that cannot be read; one that is missing, where it is named.
    pub(crate) fn unreadable(&self, name: &ClientName, file: &str, source: std::io::Error) -> ScenarioError {
        let path = self.folder().join(file);
        if source.kind() != std::io::ErrorKind::NotFound {
            return ScenarioError::Unreadable { path, source, help: None };
        }
        let client = self.file.clients.get(name).map(toml::Spanned::span);
        let texts = self.chain.texts();
        let place = client.map(|client| {
            let quoted = format!("\"{file}\"");
            let from = texts.text().get(client.start..).and_then(|text| text.find(&quoted));
            from.map_or(client.clone(), |from| client.start + from..client.start + from + quoted.len())
        });
        texts.wrong(format!("there is no {}", path.display()), place, missing::help_for_file(self.folder(), file))
    }

    /// Why the soft PLC `name` cannot be set up, at its entry if that is wrong.
    pub fn not_set_up(&self, name: &ClientName, error: &RunError) -> ScenarioError {
        let message = error.to_string();
        match error {
            RunError::Memory(_) => ScenarioError::Memory { client: name.clone(), message },
            RunError::UnknownProgram { task, program, .. }
            | RunError::RunsAtStart { task, program }
            | RunError::ProgramTwice { task, program } => {
                self.wrong_task(name, OfTask { task, key: "programs", program: Some(program) }, message, None)
            }
            RunError::Trigger { task, .. } => {
                self.wrong_task(name, OfTask { task, key: "single", program: None }, message, None)
            }
            RunError::NeverDue(task) | RunError::DuplicateTask(task) => {
                self.wrong_task(name, OfTask { task, key: "name", program: None }, message, None)
            }
            RunError::NoTasks | RunError::Module(_) => self.wrong_client(name, message, None),
        }
    }

    /// An error at a task of client `name`; at the client where the task is not written there.
    pub(crate) fn wrong_task(
        &self,
        name: &ClientName,
        of: OfTask<'_>,
        message: String,
        help: Option<String>,
    ) -> ScenarioError {
        // The files were read before, so that they are TOML.
        let root = match self.chain.tree() {
            Ok(root) => root,
            Err(error) => return error,
        };
        match places::of_task(root.get_ref(), name, of) {
            Some(place) => self.chain.texts().wrong(message, Some(place), help),
            None => self.wrong_client(name, message, help),
        }
    }

    /// An error at the line of `key` in the mapping of client `name`: in the file of its link, or in the scenario. Nothing if
    /// it is not mapped there.
    pub(crate) fn wrong_entry(
        &self,
        name: &ClientName,
        key: &str,
        (message, help): (&str, Option<&String>),
    ) -> Option<ScenarioError> {
        if let Some(link) = self.links.get(name) {
            let root = DeTable::parse(&link.text).ok()?;
            let place = places::of_mapping(root.get_ref(), name, key)?;
            Some(wrong(&link.path, &link.text, message.to_owned(), Some(place), help.cloned()))
        } else {
            // The files were read before, so that they are TOML.
            let root = match self.chain.tree() {
                Ok(root) => root,
                Err(error) => return Some(error),
            };
            let place = places::of_mapping(root.get_ref(), name, key)?;
            Some(self.chain.texts().wrong(message.to_owned(), Some(place), help.cloned()))
        }
    }

    /// An error of an option, which has no place in the file.
    pub(crate) fn wrong_option(&self, message: String, help: Option<String>) -> ScenarioError {
        self.chain.texts().wrong(message, None, help)
    }

    /// An error at the entry of signal `name`.
    pub(crate) fn wrong_signal(&self, name: &SignalName, message: String, help: Option<String>) -> ScenarioError {
        let place = self.file.signals.get(name).map(toml::Spanned::span);
        self.chain.texts().wrong(message, place, help)
    }
}

/// The link of a PLC from a file of its own.
#[derive(Clone, Debug)]
pub(crate) struct LinkSource {
    pub(crate) settings: Settings,
    pub(crate) path: PathBuf,
    pub(crate) text: String,
}

/// The name of the folder of a `scenario.toml`; any other file has its own.
fn name_of(path: &Path) -> String {
    let named = if path.file_name().is_some_and(|name| name == FILE_NAME) {
        std::path::absolute(path).ok().and_then(|path| Some(path.parent()?.file_name()?.to_owned()))
    } else {
        path.file_stem().map(ToOwned::to_owned)
    };
    named.map_or_else(|| "scenario".to_owned(), |name| name.to_string_lossy().into_owned())
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
        ClientFile::Plant { period, .. } | ClientFile::Gateway { period, .. } | ClientFile::OpcUa { period, .. } => {
            Some(period.unwrap_or(step))
        }
        ClientFile::Operator { .. } => Some(step),
        ClientFile::SoftPlc { .. } | ClientFile::External { .. } => None,
    }
}
