//! A scenario's real PLCs: the link of each, its points, and the instrumented program that it runs.

use onescan_clients::gateway::exchange::{SystemWords, is_word};
use onescan_clients::gateway::{Exchange, FreeGateway, Gateway, LinkFault, Settings, SettingsFault};
use onescan_clients::soft_plc::{Bindings, SoftPlcClient};
use onescan_plc_shim::input::kind::{FileKind, SourceKind};
use onescan_plc_shim::instrument::{File, InstrumentError, Options, Project, Target, instrument};
use onescan_plc_shim::{Application, BuildError, Input, Task, TaskPlan, TimeSpan};
use onescan_server::client::{Client, JoinRequest};
use onescan_server::signal::{ClientName, Port, SignalName, did_you_mean};

use super::compose::{Compiled, Paths, plan_of};
use super::error::{PlcReport, ScenarioError};
use super::file::ClientFile;
use super::load::Scenario;
use super::mode::Mode;

/// What a real PLC of a scenario runs.
pub struct Instrumented {
    /// The instrumented program.
    pub application: Application,
    /// Its tasks: scheduler first, in every cycle.
    pub plan: TaskPlan,
    /// Which signal is which variable.
    pub bindings: Bindings,
    /// Signals and synchronisation words.
    pub exchange: Exchange,
    /// Its link.
    pub settings: Settings,
}

impl Scenario {
    /// Lets a real PLC stand in for the soft PLC `name`, at `url` if that is not where the scenario says.
    ///
    /// # Errors
    /// No such client, or one that is no PLC.
    pub fn commission(&mut self, name: &ClientName, url: Option<String>) -> Result<(), ScenarioError> {
        let help = || did_you_mean(name.as_str(), self.file().clients.keys().map(ClientName::as_str));
        match self.file().clients.get(name).map(toml::Spanned::get_ref) {
            Some(ClientFile::SoftPlc { .. } | ClientFile::Gateway { .. }) => {}
            Some(_) => return Err(self.wrong_client(name, format!("client `{name}` is no PLC"), None)),
            None => return Err(self.wrong_client(name, format!("the scenario has no client `{name}`"), help())),
        }
        self.gateways.insert(name.clone(), url);
        Ok(())
    }

    /// The client that speaks for the PLC `name`, connected.
    pub(crate) fn gateway(&self, name: &ClientName) -> Result<Box<dyn Client>, ScenarioError> {
        let settings = self.settings(name)?;
        let request = self.request(name)?;
        let exchange = self.exchange(name, &settings, &request)?;
        let link = settings.link(&exchange).map_err(|fault| self.wrong_settings(name, fault))?;
        let mut gateway = Gateway::new(request, exchange, link, settings.patience());
        gateway.connect().map_err(|fault| self.wrong_settings(name, fault.into()))?;
        Ok(Box::new(gateway))
    }

    /// The client that exchanges values with a PLC that free-wheels, if a real one stands in for `name`.
    ///
    /// # Errors
    /// As [`Scenario::member`].
    pub fn free_gateway(&self, name: &ClientName) -> Option<Result<Box<dyn Client>, ScenarioError>> {
        let client = self.file().clients.get(name).map(toml::Spanned::get_ref);
        let is_real = matches!(client, Some(ClientFile::Gateway { .. })) || self.gateways.contains_key(name);
        is_real.then(|| {
            let settings = self.settings(name)?;
            let request = self.request(name)?;
            let exchange = self.exchange(name, &settings, &request)?;
            let link = settings.link(&exchange).map_err(|fault| self.wrong_settings(name, fault))?;
            Ok(Box::new(FreeGateway::new(request, exchange, link)) as Box<dyn Client>)
        })
    }

    /// The link of PLC `name`, with the URL that counts.
    pub(crate) fn settings(&self, name: &ClientName) -> Result<Settings, ScenarioError> {
        let declared = match self.file().clients.get(name).map(toml::Spanned::get_ref) {
            Some(ClientFile::SoftPlc { gateway, .. }) => gateway.clone().unwrap_or_default(),
            Some(ClientFile::Gateway { gateway, .. }) => gateway.clone(),
            _ => Settings::default(),
        };
        let url = self.gateways.get(name).cloned().flatten().unwrap_or(declared.url);
        if url.is_empty() {
            let help =
                format!("write `[clients.{name}.gateway]` with `url = \"tcp://…\"`, or use `--gateway {name}=URL`");
            return Err(self.wrong_client(name, format!("nothing says where the PLC `{name}` is"), Some(help)));
        }
        Ok(Settings { url, ..declared })
    }

    /// What the client `name`, a PLC or one that comes over OPC UA, reads and writes, and how often.
    pub(crate) fn request(&self, name: &ClientName) -> Result<JoinRequest, ScenarioError> {
        let signals = self.plan().signals();
        let port = |name: &SignalName, ty| Port { name: name.clone(), ty };
        match self.file().clients.get(name).map(toml::Spanned::get_ref) {
            Some(ClientFile::SoftPlc { sources, dialect, tasks, bind, .. }) => {
                let Compiled { application, paths, .. } = self.compiled(name, sources, *dialect, bind)?;
                let bindings = self.bindings(name, &application, &paths)?;
                let plan = self.task_plan(name, &application, tasks)?;
                let plc = SoftPlcClient::new(name.clone(), &application, &plan, &bindings, self.file().step);
                Ok(plc.map_err(|error| self.wrong_client(name, error.to_string(), None))?.join())
            }
            Some(ClientFile::Gateway { period, reads, .. } | ClientFile::OpcUa { period, reads, .. }) => {
                let known = || signals.iter().map(|signal| signal.name.as_str());
                let read = |wanted: &SignalName| {
                    let found = signals.iter().find(|signal| signal.name == *wanted);
                    found.map(|signal| port(wanted, signal.ty)).ok_or_else(|| {
                        let message = format!("`reads` names a signal `{wanted}` that is not declared");
                        self.wrong_client(name, message, did_you_mean(wanted.as_str(), known()))
                    })
                };
                let is_own = |signal: &&onescan_server::signal::SignalDecl| signal.writer.as_ref() == Some(name);
                Ok(JoinRequest {
                    name: name.clone(),
                    period: period.unwrap_or(self.file().step),
                    reads: reads.iter().map(read).collect::<Result<_, _>>()?,
                    writes: signals.iter().filter(is_own).map(|signal| port(&signal.name, signal.ty)).collect(),
                })
            }
            _ => Err(self.wrong_client(name, format!("client `{name}` is no PLC"), None)),
        }
    }

    fn exchange(
        &self,
        name: &ClientName,
        settings: &Settings,
        request: &JoinRequest,
    ) -> Result<Exchange, ScenarioError> {
        let names = || request.reads.iter().chain(&request.writes).map(|port| port.name.as_str());
        if let Some(unknown) = settings.map.keys().find(|key| !is_word(key) && !names().any(|name| name == *key)) {
            let message = format!("`map` names `{unknown}`, in which `{name}` takes no part");
            return Err(self.wrong_client(name, message, did_you_mean(unknown, names())));
        }
        Ok(Exchange::new(&request.reads, &request.writes, settings.system(), &settings.map))
    }

    /// The instrumented program of the soft PLC `name`, to be run by a controller of its own, with words about
    /// itself.
    ///
    /// # Errors
    /// The client is no soft PLC, or its sources or its link are wrong.
    pub fn instrumented(&self, name: &ClientName, mode: Mode) -> Result<Instrumented, ScenarioError> {
        self.instrumented_for(Target::default(), name, mode)
    }

    /// The same as another target takes it.
    ///
    /// # Errors
    /// As above, or the target cannot carry the program.
    pub fn instrumented_for(
        &self,
        target: Target,
        name: &ClientName,
        mode: Mode,
    ) -> Result<Instrumented, ScenarioError> {
        let Some(ClientFile::SoftPlc { sources, dialect, tasks, bind, gateway, .. }) =
            self.file().clients.get(name).map(toml::Spanned::get_ref)
        else {
            let help = Some("only the sources of a soft PLC can be run".to_owned());
            return Err(self.wrong_client(name, format!("client `{name}` is no soft PLC"), help));
        };
        let inputs = self.inputs(name, sources, *dialect)?;
        let asked = plan_of(tasks);
        let options = Options { target, tasks: asked.clone().map(|plan| plan.tasks), ..Options::default() };
        let project = instrument(&inputs, &options).map_err(|error| match error {
            InstrumentError::Text(findings) => Box::new(PlcReport { client: name.clone(), findings }).into(),
            other => self.wrong_client(name, other.to_string(), None),
        })?;
        let application = self.built_anew(name, project.program().filter_map(input).collect())?;
        let paths = self.paths(name, bind)?;
        let paths = if project.tasks.is_some() { self.moved_paths(name, inputs, &paths, &project)? } else { paths };
        let bindings = self.bindings(name, &application, &paths)?;
        let plan = match project.tasks.map(TaskPlan::new).or(asked) {
            Some(plan) if mode == Mode::Lockstep => in_one_task(&plan),
            Some(plan) => plan,
            None => self.task_plan(name, &application, tasks)?,
        };
        let settings = gateway.clone().unwrap_or_default();
        let ports = |bound: &[onescan_clients::soft_plc::bind::Bound]| -> Vec<Port> {
            bound.iter().map(|bound| bound.port.clone()).collect()
        };
        let (reads, writes) = (ports(&bindings.inputs), ports(&bindings.outputs));
        let exchange = Exchange::new(&reads, &writes, SystemWords::Present, &settings.map);
        Ok(Instrumented { application, plan, bindings, exchange, settings })
    }

    /// The paths of all signals in a project that was written in another form: signals are found by their names in the
    /// project's own programs.
    fn moved_paths(
        &self,
        name: &ClientName,
        inputs: Vec<Input>,
        paths: &Paths,
        project: &Project,
    ) -> Result<Paths, ScenarioError> {
        let own = self.bindings(name, &self.built_anew(name, inputs)?, paths)?;
        let moved = own.inputs.into_iter().chain(own.outputs).map(|bound| {
            let paths = bound.variables.iter().map(|path| project.path(path)).collect();
            (bound.port.name, paths)
        });
        Ok(moved.collect())
    }

    /// The instrumented sources of PLC `name`, compiled.
    fn built_anew(&self, name: &ClientName, inputs: Vec<Input>) -> Result<Application, ScenarioError> {
        let builder = Application::builder().memory_limit(self.memory_limit(name)).inputs(inputs);
        builder.build().map_err(|error| match error {
            BuildError::Sources(findings) => Box::new(PlcReport { client: name.clone(), findings }).into(),
            BuildError::Constant(error) => self.wrong_client(name, error.to_string(), None),
        })
    }

    fn wrong_settings(&self, name: &ClientName, fault: SettingsFault) -> ScenarioError {
        match fault {
            SettingsFault::Url(bad) => self.wrong_client(name, bad.to_string(), bad.help),
            SettingsFault::Mapping(fault) | SettingsFault::Link(LinkFault::Mapping(fault)) => {
                self.wrong_client(name, fault.message, fault.help)
            }
            SettingsFault::Link(LinkFault::Setting(text)) => self.wrong_client(name, text, None),
            SettingsFault::Link(fault) => ScenarioError::Link { client: name.clone(), fault },
        }
    }
}

/// A file of the instrumented project as the compiler takes it.
fn input(file: &File) -> Option<Input> {
    let kind = match FileKind::of(std::path::Path::new(&file.name)) {
        Some(FileKind::Source(kind)) => kind,
        _ => SourceKind::Text,
    };
    file.text.clone().map(|text| Input::from_text(&file.name, kind, text))
}

/// Scheduler and programs in one task, in this order, in every cycle: when a program is due is the scheduler's
/// business.
fn in_one_task(plan: &TaskPlan) -> TaskPlan {
    const CYCLE: TimeSpan = TimeSpan::nanos::<1>();
    let scheduler = std::iter::once("SDSP_Scheduler".to_owned());
    let programs = scheduler.chain(plan.tasks.iter().flat_map(|task| task.programs.iter().cloned())).collect();
    TaskPlan::new(vec![Task { name: "cycle".to_owned(), interval: Some(CYCLE), programs, ..Task::default() }])
}
