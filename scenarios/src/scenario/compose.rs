//! A scenario's clients: its files read, checked and made to run.

use std::collections::BTreeMap;
use std::path::PathBuf;

use miette::{NamedSource, SourceSpan};
use onescan_clients::plant::{Plant, SceneError, SceneFault};
use onescan_clients::soft_plc::{Bindings, SoftPlcClient, bind};
use onescan_plc_shim::input::kind::{FileKind, SourceKind};
use onescan_plc_shim::{Application, Dialect, Input, Task, TaskPlan};
use onescan_server::client::Client;
use onescan_server::signal::{ClientName, SignalName, did_you_mean};

use super::error::{PlcReport, ScenarioError, SceneReport};
use super::file::{ClientFile, TaskFile};
use super::load::Scenario;

/// A client of a scenario.
pub enum Member {
    /// A plant in this process.
    Plant(Box<dyn Client>),
    /// A soft PLC in this process.
    Plc(Box<dyn Client>),
    /// A real PLC, connected, of which this process takes care.
    Gateway(Box<dyn Client>),
    /// A program of its own, with the command that starts it; empty if somebody else does.
    External(Vec<String>),
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
            ClientFile::Plant { scene, period } => {
                let path = self.folder().join(scene);
                let text = read(&path)?;
                let period = period.unwrap_or(self.file().step);
                let plant = Plant::parse(&text, &path.display().to_string(), name.clone(), period);
                let plant = plant.map_err(|error| Box::new(report(&error, &path.display().to_string(), &text)))?;
                Ok(Member::Plant(Box::new(plant.seeded(self.file().seed))))
            }
            ClientFile::Gateway { .. } => self.gateway(name).map(Member::Gateway),
            ClientFile::SoftPlc { .. } if self.gateways.contains_key(name) => self.gateway(name).map(Member::Gateway),
            ClientFile::SoftPlc { sources, dialect, tasks, bind, .. } => {
                let inputs = self.inputs(name, sources, *dialect)?;
                self.soft_plc(name, inputs, tasks, bind).map(|plc| Member::Plc(Box::new(plc)))
            }
            ClientFile::External { command } => Ok(Member::External(command.clone())),
        }
    }

    /// The sources of each soft PLC, their dialect, and the tasks that the scenario gives it.
    pub(crate) fn plcs(&self) -> impl Iterator<Item = (&[String], Option<Dialect>, Option<TaskPlan>)> {
        self.file().clients.values().filter_map(|client| match client.get_ref() {
            ClientFile::SoftPlc { sources, dialect, tasks, .. } => Some((sources.as_slice(), *dialect, plan_of(tasks))),
            _ => None,
        })
    }

    /// The sources of PLC `name`.
    pub(super) fn inputs(
        &self,
        name: &ClientName,
        sources: &[String],
        dialect: Option<Dialect>,
    ) -> Result<Vec<Input>, ScenarioError> {
        sources.iter().map(|source| self.source(name, source, dialect)).collect()
    }

    /// A source of PLC `name`, in whatever form and encoding it is; one of an unknown kind is text.
    fn source(&self, name: &ClientName, source: &str, dialect: Option<Dialect>) -> Result<Input, ScenarioError> {
        let path = self.folder().join(source);
        let kind = match FileKind::of(&path) {
            Some(FileKind::Source(kind)) => kind,
            Some(FileKind::Project) => {
                let help = "name its files, or run `onescan check` on it to see them".to_owned();
                return Err(self.wrong_client(name, format!("`{source}` is a project, not a source"), Some(help)));
            }
            None => SourceKind::Text,
        };
        let bytes = std::fs::read(&path).map_err(|source| ScenarioError::Unreadable { path, source, help: None })?;
        let input = Input::read(source, kind, &bytes);
        Ok(match dialect {
            Some(dialect) => input.in_dialect(dialect),
            None => input,
        })
    }

    fn soft_plc(
        &self,
        name: &ClientName,
        inputs: Vec<Input>,
        tasks: &[TaskFile],
        paths: &BTreeMap<SignalName, String>,
    ) -> Result<SoftPlcClient, ScenarioError> {
        let compiled = match self.coverage() {
            Some(_) => Application::from_inputs_with_coverage(inputs),
            None => Application::from_inputs(inputs),
        };
        let application = compiled.map_err(|findings| Box::new(PlcReport { client: name.clone(), findings }))?;
        for warning in application.warnings().iter() {
            tracing::warn!(code = %warning.code, "{}", warning.message);
        }
        let bindings = self.bindings(name, &application, paths)?;
        let plan = self.task_plan(name, &application, tasks)?;
        self.fits_step(name, &plan)?;
        let mut client = SoftPlcClient::new(name.clone(), &application, &plan, &bindings, self.file().step)
            .map_err(|error| self.wrong_client(name, error.to_string(), None))?;
        if let Some(sink) = self.coverage() {
            client.cover(sink.clone());
        }
        Ok(client)
    }

    /// The tasks of PLC `name`: the scenario's, or those of its own CONFIGURATION.
    pub(super) fn task_plan(
        &self,
        name: &ClientName,
        application: &Application,
        tasks: &[TaskFile],
    ) -> Result<TaskPlan, ScenarioError> {
        plan_of(tasks).or_else(|| TaskPlan::configured(application)).ok_or_else(|| {
            let help = "give it `tasks`, or declare a CONFIGURATION in its sources".to_owned();
            self.wrong_client(name, format!("nothing says when the programs of `{name}` run"), Some(help))
        })
    }

    /// Which signal is which variable of the PLC.
    pub(super) fn bindings(
        &self,
        name: &ClientName,
        application: &Application,
        paths: &BTreeMap<SignalName, String>,
    ) -> Result<Bindings, ScenarioError> {
        if let Some(unknown) = paths.keys().find(|signal| !self.file().signals.contains_key(*signal)) {
            let help = did_you_mean(unknown.as_str(), self.file().signals.keys().map(SignalName::as_str));
            let message = format!("`bind` names a signal `{unknown}` that is not declared");
            return Err(self.wrong_client(name, message, help));
        }
        bind(application, name, self.plan().signals(), paths)
            .map_err(|error| self.wrong_signal(&error.signal, error.message, error.help))
    }

    /// A task can be due at the steps of the session only.
    fn fits_step(&self, name: &ClientName, plan: &TaskPlan) -> Result<(), ScenarioError> {
        let step = self.file().step;
        let Some(wrong) = plan.tasks.iter().find(|task| !task.interval_ns.is_multiple_of(step.as_nanos())) else {
            return Ok(());
        };
        let (task, span) = (&wrong.name, onescan_server::time::TimeSpan::from_nanos(wrong.interval_ns));
        let span = span.map(|span| span.to_string()).unwrap_or_default();
        let message =
            format!("task `{task}` has an interval of {span}, which is no multiple of the session's step {step}");
        Err(self.wrong_client(name, message, Some("change the interval, or make the step a divisor of it".to_owned())))
    }
}

/// The tasks of a scenario; nothing if it has none, so that the PLC's own configuration counts.
pub(super) fn plan_of(tasks: &[TaskFile]) -> Option<TaskPlan> {
    (!tasks.is_empty()).then(|| TaskPlan::new(tasks.iter().map(task).collect()))
}

fn task(file: &TaskFile) -> Task {
    Task {
        name: file.name.clone(),
        interval_ns: file.interval.map_or(0, onescan_server::time::TimeSpan::as_nanos),
        single: file.single.clone(),
        priority: file.priority,
        programs: file.programs.clone(),
    }
}

fn read(path: &PathBuf) -> Result<String, ScenarioError> {
    std::fs::read_to_string(path).map_err(|source| ScenarioError::Unreadable { path: path.clone(), source, help: None })
}

/// A scene's faults, the first in front.
pub(crate) fn report(error: &SceneError, file: &str, text: &str) -> SceneReport {
    let one = |fault: &SceneFault| SceneReport {
        message: fault.kind.to_string(),
        file: NamedSource::new(file, text.to_owned()),
        place: Some(SourceSpan::from(fault.span.clone())),
        help: fault.hint.clone(),
        others: Vec::new(),
    };
    match error.faults() {
        [] => SceneReport {
            message: error.to_string(),
            file: NamedSource::new(file, text.to_owned()),
            place: None,
            help: None,
            others: Vec::new(),
        },
        [first, others @ ..] => SceneReport { others: others.iter().map(one).collect(), ..one(first) },
    }
}
