//! A scenario's clients: its files read, checked and made to run.

use std::collections::BTreeMap;
use std::sync::Arc;

use miette::{NamedSource, SourceSpan};
use onescan_base::regular::Limit;
use onescan_iec::input::kind::{FileKind, SourceKind};
use onescan_iec::{Dialect, Input, MemoryLimit, Task, TaskPlan, WordSize};
use onescan_iec_run::{Application, Builder};
use onescan_operator::operator::Operator;
use onescan_plant::{Excess, Inside, Overlap, Plant, Scene, SceneError, SceneFault};
use onescan_server::client::{Client, JoinRequest};
use onescan_server::signal::{ClientName, Port, SignalName, did_you_mean};
use onescan_soft_plc::watch::Sightings;
use onescan_soft_plc::{Bindings, SoftPlcClient, bind};

use super::arrays;
use super::case::value::bytes_of;
use super::compilations::Compilation;
pub use super::compilations::{Compiled, Paths};
use super::error::{PlcReport, ScenarioError, SceneReport};
use super::file::{ClientFile, TaskFile};
use super::load::Scenario;
use super::permission;
use super::places::OfTask;
use super::watch::Watched;

/// A client of a scenario.
pub enum Member {
    /// A plant in this process, or an operator.
    Plant(Box<dyn Client>),
    /// A soft PLC in this process.
    Plc(Box<dyn Client>),
    /// A real PLC, connected, of which this process takes care.
    Gateway(Box<dyn Client>),
    /// A program of its own, with the command that starts it; empty if somebody else does.
    External(Vec<String>),
    /// The same over OPC UA: what it reads and writes, and the command.
    Seated {
        /// What it reads and writes, and how often.
        request: JoinRequest,
        /// The command; empty if somebody else starts it.
        command: Vec<String>,
    },
}

/// The sources of a soft PLC, and how they are compiled.
pub struct PlcSources<'a> {
    pub name: &'a ClientName,
    /// Files, relative to the scenario's folder.
    pub sources: &'a [String],
    /// The dialect of all of them; from each file's name if absent.
    pub dialect: Option<Dialect>,
    /// Bits of its registers; 64 if absent.
    pub word_size: Option<WordSize>,
    /// The tasks that the scenario gives it.
    pub plan: Option<TaskPlan>,
    /// How much memory its variables may take.
    pub memory_limit: MemoryLimit,
}

impl Scenario {
    /// The client `name`, ready to join.
    ///
    /// # Errors
    /// No such client, or its files are wrong.
    pub fn member(&self, name: &ClientName) -> Result<Member, ScenarioError> {
        let Some(entry) = self.file().clients.get(name) else {
            let help = did_you_mean(name.as_str(), self.file().clients.keys().map(ClientName::as_str));
            return Err(self.wrong_client(name, format!("the scenario has no client `{name}`"), help));
        };
        match entry.get_ref() {
            ClientFile::Plant { scene, period, .. } => {
                let scene = self.scene_once(name, scene)?;
                let plant = Plant::new(scene, name.clone(), period.unwrap_or(self.file().step));
                Ok(Member::Plant(Box::new(plant.seeded(self.seed()))))
            }
            ClientFile::Gateway { .. } => self.gateway(name).map(Member::Gateway),
            ClientFile::SoftPlc { .. } if self.gateways.contains_key(name) => self.gateway(name).map(Member::Gateway),
            ClientFile::SoftPlc { .. } => Ok(Member::Plc(Box::new(self.plc(name)?))),
            ClientFile::Operator { initial } => Ok(Member::Plant(Box::new(self.operator(name, initial)?))),
            ClientFile::External { command } => Ok(Member::External(command.clone())),
            ClientFile::OpcUa { command, .. } => {
                Ok(Member::Seated { request: self.request(name)?, command: command.clone() })
            }
        }
    }

    /// Bodies that are in each other at the start, of each plant that has some.
    ///
    /// # Errors
    /// A plant's scene is wrong.
    pub fn overlaps(&self) -> Result<Vec<(ClientName, Vec<Overlap>)>, ScenarioError> {
        let mut found = Vec::new();
        for (name, client) in &self.file().clients {
            let ClientFile::Plant { scene, .. } = client.get_ref() else { continue };
            let overlaps = self.scene_once(name, scene)?.overlaps();
            if !overlaps.is_empty() {
                found.push((name.clone(), overlaps));
            }
        }
        Ok(found)
    }

    /// What the scene of each plant asks for beyond what it can carry at its physics step, of each plant that has such.
    ///
    /// # Errors
    /// A plant's scene is wrong.
    pub fn excesses(&self) -> Result<Vec<(ClientName, Vec<Excess>)>, ScenarioError> {
        let mut found = Vec::new();
        for (name, client) in &self.file().clients {
            let ClientFile::Plant { scene, period, .. } = client.get_ref() else { continue };
            let excesses = self.scene_once(name, scene)?.excesses(period.unwrap_or(self.file().step));
            if !excesses.is_empty() {
                found.push((name.clone(), excesses));
            }
        }
        Ok(found)
    }

    /// Lets soft PLCs show their memories to those who look at the session, however large they are.
    pub fn show_memories(&mut self) {
        self.shows_memories = true;
    }

    /// What the PLCs of a run have seen; the next run begins with nothing.
    pub fn take_sightings(&self) -> Sightings {
        self.watched.as_ref().map_or_else(Sightings::default, Watched::take_sightings)
    }

    /// The soft PLC `name`, ready to join.
    ///
    /// # Errors
    /// No such PLC, or its files are wrong.
    pub(crate) fn plc(&self, name: &ClientName) -> Result<SoftPlcClient, ScenarioError> {
        let Some(ClientFile::SoftPlc { sources, dialect, tasks, bind, ports, .. }) =
            self.file().clients.get(name).map(toml::Spanned::get_ref)
        else {
            return Err(self.wrong_client(name, format!("client `{name}` is not a soft PLC"), None));
        };
        self.check_lines(name, ports)?;
        let compiled = self.compiled_once(name, || self.compiled(name, sources, *dialect, bind))?;
        self.soft_plc(name, &compiled, tasks)
    }

    /// What the scenario says of each soft PLC.
    pub fn plcs(&self) -> impl Iterator<Item = PlcSources<'_>> {
        self.file().clients.iter().filter_map(|(name, client)| match client.get_ref() {
            ClientFile::SoftPlc { sources, dialect, word_size_bits, tasks, .. } => Some(PlcSources {
                name,
                sources,
                dialect: *dialect,
                word_size: *word_size_bits,
                plan: plan_of(tasks),
                memory_limit: self.memory_limit(name),
            }),
            _ => None,
        })
    }

    /// How much memory the variables of PLC `name` may take.
    pub(crate) fn memory_limit(&self, name: &ClientName) -> MemoryLimit {
        match self.file().clients.get(name).map(toml::Spanned::get_ref) {
            Some(ClientFile::SoftPlc { memory_limit_mib, .. }) => memory_limit_mib.unwrap_or_default(),
            _ => MemoryLimit::default(),
        }
    }

    /// Bits of the registers of PLC `name`, if the scenario says so.
    fn word_size(&self, name: &ClientName) -> Option<WordSize> {
        match self.file().clients.get(name).map(toml::Spanned::get_ref) {
            Some(ClientFile::SoftPlc { word_size_bits, .. }) => *word_size_bits,
            _ => None,
        }
    }

    /// The sources of PLC `name`.
    pub(crate) fn inputs(
        &self,
        name: &ClientName,
        sources: &[String],
        dialect: Option<Dialect>,
    ) -> Result<Vec<Input>, ScenarioError> {
        if let Some(program) = self.programs.of(name) {
            return Ok(program.iter().map(|input| input.clone().read_as(dialect, self.word_size(name))).collect());
        }
        sources.iter().map(|source| self.source(name, source, dialect)).collect()
    }

    /// A source of PLC `name`, in whatever form and encoding it is; one of an unknown kind is text.
    fn source(&self, name: &ClientName, source: &str, dialect: Option<Dialect>) -> Result<Input, ScenarioError> {
        let own = source;
        let source = self.source_of_case(name, own).unwrap_or(own);
        let path = self.folder().join(source);
        let kind = match FileKind::of(&path) {
            Some(FileKind::Source(kind)) => kind,
            Some(FileKind::Project) => {
                let help = "name its files, or run `onescan check` on it to see them".to_owned();
                return Err(self.wrong_client(name, format!("`{source}` is a project, not a source"), Some(help)));
            }
            None => SourceKind::Text,
        };
        let bytes = permission::granted().read(self.folder(), &path, Limit::TEXT)?;
        let bytes = bytes.map_err(|why| self.unreadable(name, source, why))?;
        let input = Input::read(source, kind, &bytes).read_as(dialect, self.word_size(name));
        let input = self.with_texts_of_case(name, own, input)?;
        Ok(match self.mistake() {
            Some(mistake) if mistake.client == *name && mistake.source == own => mistake.mutant.applied_to(&input),
            _ => input,
        })
    }

    /// The scene of plant `name` as the scenario wants it, and the case if there is one.
    ///
    /// # Errors
    /// A file that cannot be read or is not a scene; a value that the scene cannot have.
    pub fn scene_of(&self, name: &ClientName, file: &str) -> Result<Scene, ScenarioError> {
        let path = self.folder().join(file);
        let text = permission::granted().read_text(self.folder(), &path)?;
        let text = text.map_err(|why| self.unreadable(name, file, why))?;
        let named = path.display().to_string();
        let error = |error: &SceneError| ScenarioError::from(Box::new(report(error, &named, &text)));
        let (overrides, within) = (self.overrides(name), permission::granted().within(self.folder()));
        let scene = match Scene::parse_with(&text, &named, &overrides, &within) {
            Ok(scene) => scene,
            Err(with) if overrides.is_empty() => return Err(error(&with)),
            Err(with) => {
                // What is wrong with the scene itself comes first.
                Scene::parse_with(&text, &named, &[], &within).map_err(|plain| error(&plain))?;
                let fault = with.faults().first();
                let message = fault.map_or_else(|| with.to_string(), |fault| fault.kind.to_string());
                let (index, help) =
                    (fault.and_then(|fault| fault.overridden), fault.and_then(|fault| fault.hint.clone()));
                return Err(self.wrong_override(name, index, message, help).unwrap_or_else(|| error(&with)));
            }
        };
        self.check_asked_of(name, &scene)?;
        Ok(scene)
    }

    /// The same, read once for all cases that set the same in it.
    pub(crate) fn scene_once(&self, name: &ClientName, file: &str) -> Result<Scene, ScenarioError> {
        permission::granted().check(self.folder(), &self.folder().join(file))?;
        let scene = self.compilations().scene(name, &self.overrides(name), || self.scene_of(name, file))?;
        self.check_asked_of(name, &scene)?;
        Ok(Scene::clone(&scene))
    }

    /// The sources of soft PLC `name`, compiled, and what its `bind` says.
    ///
    /// # Errors
    /// Sources that cannot be read or do not compile; a `bind` that is wrong in itself.
    pub fn compiled(
        &self,
        name: &ClientName,
        sources: &[String],
        dialect: Option<Dialect>,
        bind: &BTreeMap<String, String>,
    ) -> Result<Compiled, ScenarioError> {
        let inputs = self.inputs(name, sources, dialect)?;
        let built = match (self.is_traced(), self.coverage()) {
            (true, _) => self.built(name, &inputs, Builder::traced),
            (false, Some(_)) => self.built(name, &inputs, Builder::covered),
            (false, None) => self.built(name, &inputs, |plain| plain),
        };
        let application = built?.map_err(|findings| Box::new(PlcReport { client: name.clone(), findings }))?;
        for warning in application.warnings().iter() {
            tracing::warn!(code = %warning.code, "{}", warning.message);
        }
        let paths = self.paths(name, bind)?;
        Ok(Compiled { application, paths, inputs })
    }

    /// Soft PLC `name`, compiled as its client is; nothing if it is none, or a real one stands in for it.
    ///
    /// # Errors
    /// See [`compiled`](Self::compiled).
    pub fn compiled_plc(&self, name: &ClientName) -> Result<Option<Arc<Compiled>>, ScenarioError> {
        match self.file().clients.get(name).map(toml::Spanned::get_ref) {
            Some(ClientFile::SoftPlc { sources, dialect, bind, .. }) if !self.gateways.contains_key(name) => {
                self.compiled_once(name, || self.compiled(name, sources, *dialect, bind)).map(Some)
            }
            _ => Ok(None),
        }
    }

    /// The same for all cases that set the same.
    fn compiled_once(
        &self,
        name: &ClientName,
        compile: impl FnOnce() -> Result<Compiled, ScenarioError>,
    ) -> Result<Arc<Compiled>, ScenarioError> {
        // the scenario as it is sets nothing
        let settings = self.case().map(|case| case.settings.as_slice()).unwrap_or_default();
        let of = Compilation {
            client: name.clone(),
            settings: settings
                .iter()
                .filter(|one| one.path.split('.').next() == Some(name.as_str()))
                .map(|one| (one.path.clone(), one.value.to_string()))
                .collect(),
            code: self.code_of_case(name).map(|at| (at.source.clone(), at.change.clone())).collect(),
            is_traced: self.is_traced(),
            is_covered: self.coverage().is_some(),
        };
        self.compilations().once(of, compile)
    }

    fn soft_plc(
        &self,
        name: &ClientName,
        Compiled { application, paths, inputs }: &Compiled,
        tasks: &[TaskFile],
    ) -> Result<SoftPlcClient, ScenarioError> {
        let bindings = self.bindings(name, application, paths)?;
        let plan = self.task_plan(name, application, tasks)?;
        self.fits_step(name, &plan)?;
        let mut client = SoftPlcClient::new(name.clone(), application, &plan, &bindings, self.file().step)
            .map_err(|error| self.not_set_up(name, &error))?;
        client.accept_states_of(self.code_policy(name));
        client = self.connected(name, client)?;
        self.preset(&mut client, name, inputs)?;
        self.check_variables(&client, name)?;
        self.check_tasks(&client, name)?;
        if let Some(sink) = self.coverage() {
            client.cover(sink.clone());
        }
        if let Some((signals, sink)) = self.writers() {
            client.trace(signals, sink.clone());
        }
        if let Some(journalling) = self.journalling() {
            client.journal(journalling);
        }
        if self.shows_memories {
            client.show_whole();
        }
        if let Some(watched) = &self.watched {
            let (watches, changes, sink) = watched.of(name);
            let watched = client.watch(&watches, changes, sink);
            watched.map_err(|unknown| self.wrong_option(format!("--watch: {unknown}"), None))?;
        }
        let own = self.file().map.iter().filter(|map| map.client.get_ref() == name);
        for (map, variable) in own.filter_map(|map| Some((map, map.variable.as_ref()?.get_ref()))) {
            let shown = client.show_table(variable, map.row.unwrap_or(0));
            shown.map_err(|none| self.wrong_client(name, format!("map `{}`: {none}", map.name.get_ref()), None))?;
        }
        Ok(client)
    }

    /// The tasks of PLC `name`: the scenario's, or those of its own CONFIGURATION.
    pub(crate) fn task_plan(
        &self,
        name: &ClientName,
        application: &Application,
        tasks: &[TaskFile],
    ) -> Result<TaskPlan, ScenarioError> {
        plan_of(tasks).or_else(|| application.configured_tasks()).ok_or_else(|| {
            let help = "give it `tasks`, or declare a CONFIGURATION in its sources".to_owned();
            self.wrong_client(name, format!("nothing says when the programs of `{name}` run"), Some(help))
        })
    }

    /// The variables of signals, as `bind` names them.
    pub(crate) fn paths(&self, name: &ClientName, bind: &BTreeMap<String, String>) -> Result<Paths, ScenarioError> {
        let declared: Vec<_> = self.file().signals.keys().collect();
        arrays::bound(bind, &declared).map_err(|found| self.wrong_client(name, found.message, found.help))
    }

    /// Which signal is which variable of the PLC.
    ///
    /// # Errors
    /// A signal without a variable, or with one of another type.
    pub fn bindings(
        &self,
        name: &ClientName,
        application: &Application,
        paths: &Paths,
    ) -> Result<Bindings, ScenarioError> {
        bind(application, name, self.plan().signals(), paths)
            .map_err(|error| self.wrong_signal(&error.signal, error.message, error.help))
    }

    /// The operator of the signals whose writer it is.
    fn operator(
        &self,
        name: &ClientName,
        initial: &std::collections::BTreeMap<SignalName, toml::Value>,
    ) -> Result<Operator, ScenarioError> {
        let own: Vec<_> = self.plan().signals().iter().filter(|signal| signal.writer.as_ref() == Some(name)).collect();
        if let Some(unknown) = initial.keys().find(|wanted| own.iter().all(|signal| signal.name != **wanted)) {
            let help = did_you_mean(unknown.as_str(), own.iter().map(|signal| signal.name.as_str()));
            return Err(self.wrong_client(name, format!("`{name}` writes no signal `{unknown}`"), help));
        }
        let mut signals = Vec::new();
        for signal in own {
            let port = Port { name: signal.name.clone(), ty: signal.ty };
            let bytes = match initial.get(&signal.name) {
                None => vec![0; signal.ty.size()],
                Some(value) => bytes_of(signal.ty, value).map_err(|wanted| {
                    let message = format!("`{}` begins with {value}, which is not {wanted}", signal.name);
                    self.wrong_client(name, message, None)
                })?,
            };
            signals.push((port, bytes));
        }
        Ok(Operator::new(name.clone(), self.file().step, signals))
    }

    /// Whether the tasks of soft PLC `name` suit its program, which was compiled elsewhere, and the session.
    ///
    /// # Errors
    /// Tasks of programs that are not there, or that never run at a step.
    pub fn tasks_suit(&self, name: &ClientName, application: &Application) -> Result<(), ScenarioError> {
        let Some(ClientFile::SoftPlc { tasks, .. }) = self.file().clients.get(name).map(toml::Spanned::get_ref) else {
            return Ok(());
        };
        let plan = self.task_plan(name, application, tasks)?;
        self.fits_step(name, &plan)?;
        application.check_plan(&plan).map_err(|error| self.not_set_up(name, &error))
    }

    /// A task can be due at the steps of the session only.
    fn fits_step(&self, name: &ClientName, plan: &TaskPlan) -> Result<(), ScenarioError> {
        let step = self.file().step;
        let mut intervals = plan.tasks.iter().filter_map(|task| Some((&task.name, task.interval?)));
        let Some((task, span)) = intervals.find(|(_, interval)| !interval.is_multiple_of(step)) else {
            return Ok(());
        };
        let message =
            format!("task `{task}` has an interval of {span}, which is not a multiple of the session's step {step}");
        let help = Some("change the interval, or make the step a divisor of it".to_owned());
        Err(self.wrong_task(name, OfTask { task, key: "interval", program: None }, message, help))
    }
}

/// The tasks of a scenario; nothing if it has none, so that the PLC's own configuration counts.
pub(crate) fn plan_of(tasks: &[TaskFile]) -> Option<TaskPlan> {
    (!tasks.is_empty()).then(|| TaskPlan::new(tasks.iter().map(task).collect()))
}

fn task(file: &TaskFile) -> Task {
    Task {
        name: file.name.clone(),
        interval: file.interval,
        single: file.single.clone(),
        priority: file.priority,
        programs: file.programs.clone(),
    }
}

/// A scene's faults, the first in front.
pub fn report(error: &SceneError, file: &str, text: &str) -> SceneReport {
    // shared by all faults: a large file may have many
    let text: Arc<str> = Arc::from(text);
    let one = |fault: &SceneFault| match &fault.inside {
        None => SceneReport {
            message: fault.kind.to_string(),
            file: NamedSource::new(file, Arc::clone(&text)),
            place: Some(SourceSpan::from(fault.span.clone())),
            help: fault.hint.clone(),
            others: Vec::new(),
        },
        Some(Inside { reported, place }) => SceneReport {
            message: format!("{reported} (named at {})", fault.place),
            file: NamedSource::new(&place.source.file, Arc::clone(&place.source.text)),
            place: Some(SourceSpan::from(place.span.clone())),
            help: fault.hint.clone(),
            others: Vec::new(),
        },
    };
    match error.faults() {
        [] => SceneReport {
            message: error.to_string(),
            file: NamedSource::new(file, Arc::clone(&text)),
            place: None,
            help: None,
            others: Vec::new(),
        },
        [first, others @ ..] => SceneReport { others: others.iter().map(one).collect(), ..one(first) },
    }
}
