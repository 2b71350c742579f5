//! A scenario's real PLCs: the link of each, its points, and the instrumented program that it runs.

use std::collections::BTreeMap;
use std::path::Path;

use onescan_base::regular;
use onescan_iec::input::kind::{FileKind, SourceKind};
use onescan_iec::{Diagnostics, Dialect, Input, Task, TaskPlan, TimeSpan};
use onescan_iec_project::instrument::{
    Address as DirectAddress, Exchanged, File, InstrumentError, Options, Project, Target, Way, instrument,
};
use onescan_iec_run::{Application, BuildError};
use onescan_links::gateway::exchange::{Direction, Words};
use onescan_links::gateway::layout_number::layout_number;
use onescan_links::gateway::mapping::{self, Variables};
use onescan_links::gateway::{
    CountedGateway, Exchange, FreeGateway, Gateway, LinkFault, MappingFault, Point, Settings, SettingsFault,
};
use onescan_server::client::{Client, JoinRequest};
use onescan_server::signal::{ClientName, Port, SignalDecl, SignalName, did_you_mean};
use onescan_soft_plc::{Bindings, SoftPlcClient};
use serde::Deserialize;

use super::arrays;
use super::compose::{Compiled, Paths, plan_of};
use super::error::{PlcReport, ScenarioError};
use super::file::ClientFile;
use super::load::{LinkSource, Scenario};
use super::mode::Mode;
use super::permission;

/// What a real PLC of a scenario runs.
pub struct Instrumented {
    pub application: Application,
    /// Its tasks: scheduler first, in every cycle.
    pub plan: TaskPlan,
    /// Which signal is which variable; the variables have the paths of the scenario's own sources.
    pub bindings: Bindings,
    /// Signals and synchronisation words.
    pub exchange: Exchange,
    pub settings: Settings,
    /// What could not be replaced.
    pub warnings: Diagnostics,
}

/// What the gateway of a PLC and the program in that PLC must agree on.
#[derive(Clone, Debug)]
pub struct Agreement {
    /// The link. Its URL is empty if nothing says where the PLC is.
    pub settings: Settings,
    /// What the client reads and writes in the session.
    pub request: JoinRequest,
    /// Signals and synchronisation words.
    pub exchange: Exchange,
    /// The number of the mapping; nothing if the sources of the PLC's program are not known.
    pub layout: Option<u32>,
}

impl Agreement {
    /// The variables that the gateway writes and reads, in the order of its points.
    pub fn exchanged(&self) -> Vec<Exchanged> {
        let exchanged = |(direction, way): (Direction, Way)| {
            let points = self.exchange.points(direction).iter().filter(|point| !point.is_word());
            points.map(move |point: &Point| Exchanged {
                signal: point.name.clone(),
                variable: point.variable.clone().unwrap_or_else(|| point.name.clone()),
                ty: point.ty,
                way,
                address: point.address.clone().filter(|address| is_direct(address)),
            })
        };
        [(Direction::ToPlc, Way::ToPlc), (Direction::FromPlc, Way::FromPlc)].into_iter().flat_map(exchanged).collect()
    }
}

/// A file with links alone.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct LinkFile {
    clients: BTreeMap<ClientName, LinkTable>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct LinkTable {
    gateway: Settings,
}

/// True for what stands in the place of a URL and is a file with a link.
fn is_file(url: &str) -> bool {
    !url.contains("://") && Path::new(url).extension().is_some_and(|extension| extension.eq_ignore_ascii_case("toml"))
}

/// True for an address of the standard's, and for one by which Modbus finds it in OpenPLC.
fn is_direct(address: &str) -> bool {
    address.starts_with('%') || DirectAddress::at_modbus(address).is_some()
}

impl Scenario {
    /// Lets a real PLC stand in for the soft PLC `name`, at `url` if that is not where the scenario says.
    ///
    /// # Errors
    /// No such client, or one that is not a PLC.
    pub fn commission(&mut self, name: &ClientName, url: Option<String>) -> Result<(), ScenarioError> {
        let help = || did_you_mean(name.as_str(), self.file().clients.keys().map(ClientName::as_str));
        match self.file().clients.get(name).map(toml::Spanned::get_ref) {
            Some(client) if client.is_plc() => {}
            Some(_) => return Err(self.wrong_client(name, format!("client `{name}` is not a PLC"), None)),
            None => return Err(self.wrong_client(name, format!("the scenario has no client `{name}`"), help())),
        }
        match url {
            Some(path) if is_file(&path) => {
                let link = self.link_in(name, &path)?;
                self.links.insert(name.clone(), link);
                self.gateways.insert(name.clone(), None);
                if let Some(fault) = mapping::malformed(&self.declared(name).map) {
                    return Err(self.wrong_mapping(name, fault));
                }
            }
            url => {
                self.gateways.insert(name.clone(), url);
            }
        }
        Ok(())
    }

    /// The link of PLC `name` in a file of its own, as `onescan instrument` and `onescan map` write one.
    fn link_in(&self, name: &ClientName, path: &str) -> Result<LinkSource, ScenarioError> {
        let wrong = |why: String, help: &str| self.wrong_client(name, format!("{path}: {why}"), Some(help.to_owned()));
        let text = regular::read_text(Path::new(path))
            .map_err(|error| wrong(error.to_string(), "name a file with the table `[clients.NAME.gateway]`"))?;
        let mut file: LinkFile = toml::from_str(&text).map_err(|error| {
            let help = "write what `[clients.NAME.gateway]` of a scenario has".to_owned();
            super::error::wrong(Path::new(path), &text, error.message().trim().to_owned(), error.span(), Some(help))
        })?;
        let link = file.clients.remove(name).ok_or_else(|| {
            let known = file.clients.keys().map(ClientName::as_str);
            let help = did_you_mean(name.as_str(), known);
            let help = help.unwrap_or_else(|| format!("write `[clients.{name}.gateway]`"));
            wrong(format!("there is no link of client `{name}`"), &help)
        })?;
        Ok(LinkSource { settings: link.gateway, path: path.into(), text })
    }

    /// The client that speaks for the PLC `name`, connected.
    pub(crate) fn gateway(&self, name: &ClientName) -> Result<Box<dyn Client>, ScenarioError> {
        let Agreement { settings, request, exchange, layout } = self.agreement(name)?;
        self.may_listen(name, &settings)?;
        let wrong = |fault| self.wrong_settings(name, fault);
        if let Some(counted) = settings.counted(&exchange).map_err(wrong)? {
            let mut gateway = CountedGateway::new(request, exchange, counted, settings.patience());
            gateway.connect().map_err(|fault| self.wrong_settings(name, fault.into()))?;
            return Ok(Box::new(gateway));
        }
        let link = settings.link(&exchange).map_err(wrong)?;
        let mut gateway = Gateway::new(request, exchange, link, settings.patience()).expecting(layout);
        gateway.connect().map_err(|fault| self.wrong_settings(name, fault.into()))?;
        Ok(Box::new(gateway))
    }

    /// True if the client `name` is a real PLC, or one stands in for it.
    pub fn is_real_plc(&self, name: &ClientName) -> bool {
        let client = self.file().clients.get(name).map(toml::Spanned::get_ref);
        matches!(client, Some(ClientFile::Gateway { .. })) || self.gateways.contains_key(name)
    }

    /// Whether `name` is a real PLC that cannot be asked to start cold: it does so by itself, or somebody does it.
    pub fn starts_by_hand(&self, name: &ClientName) -> bool {
        self.is_real_plc(name) && self.declared(name).words() == Words::Handshake
    }

    /// The client that exchanges values with a PLC that free-wheels, if a real one stands in for `name`.
    ///
    /// # Errors
    /// As [`Scenario::member`].
    pub fn free_gateway(&self, name: &ClientName) -> Option<Result<Box<dyn Client>, ScenarioError>> {
        self.is_real_plc(name).then(|| {
            let Agreement { settings, request, exchange, .. } = self.agreement(name)?;
            self.may_listen(name, &settings)?;
            let link = settings.link(&exchange).map_err(|fault| self.wrong_settings(name, fault))?;
            let patience = settings.patience().reconnect;
            Ok(Box::new(FreeGateway::new(request, exchange, link, patience)) as Box<dyn Client>)
        })
    }

    /// A port that other machines reach is opened for whoever types its address, not for a file.
    fn may_listen(&self, name: &ClientName, settings: &Settings) -> Result<(), ScenarioError> {
        let address = settings.listens_on().map_err(|bad| self.wrong_settings(name, bad.into()))?;
        let is_typed = self.gateways.get(name).is_some_and(Option::is_some);
        match address.filter(|address| !is_typed && !address.ip().is_loopback()) {
            None => Ok(()),
            Some(address) => {
                let message = format!("`{}` would let other machines connect to {address}", settings.url);
                let help = format!(
                    "raw TCP knows no users; where that is wanted, type the address: --gateway {name}={}",
                    settings.url
                );
                Err(self.wrong_client(name, message, Some(help)))
            }
        }
    }

    /// What the gateway of PLC `name`, and the program in it, must agree on.
    ///
    /// # Errors
    /// No such PLC, nothing says where it is, its sources do not compile, or its mapping is wrong.
    pub fn agreement(&self, name: &ClientName) -> Result<Agreement, ScenarioError> {
        self.agreement_over(name, self.settings(name)?)
    }

    /// The same over another link than that of the scenario.
    ///
    /// # Errors
    /// As above.
    pub fn agreement_over(&self, name: &ClientName, settings: Settings) -> Result<Agreement, ScenarioError> {
        let client = self.file().clients.get(name).map(toml::Spanned::get_ref);
        if let Some(ClientFile::SoftPlc { sources, dialect, bind, .. }) = client {
            let compiled = self.compiled(name, sources, *dialect, bind)?;
            return self.agreement_on(name, settings, &compiled.application);
        }
        let request = self.request(name)?;
        let unknown = |ports: &[Port]| -> Vec<Variables> { ports.iter().cloned().map(Variables::unknown).collect() };
        let (inputs, outputs) = (unknown(&request.reads), unknown(&request.writes));
        let exchange = mapping::exchange(&inputs, &outputs, settings.words(), &settings.map);
        let exchange = exchange.map_err(|fault| self.wrong_mapping(name, fault))?;
        Ok(Agreement { settings, request, exchange, layout: None })
    }

    /// What the gateway of the soft PLC `name` and its program, whose sources are `inputs`, must agree on over the link that
    /// `link` makes of the scenario's; nothing if the sources do not compile. Where the PLC is need not be known.
    ///
    /// # Errors
    /// The mapping is wrong, or there is no such PLC.
    pub fn agreement_of(
        &self,
        name: &ClientName,
        inputs: Vec<Input>,
        link: impl FnOnce(Settings) -> Settings,
    ) -> Result<Option<Agreement>, ScenarioError> {
        let builder = Application::builder().memory_limit(self.memory_limit(name)).inputs(inputs);
        let Ok(application) = builder.build() else { return Ok(None) };
        self.agreement_on(name, link(self.declared(name)), &application).map(Some)
    }

    fn agreement_on(
        &self,
        name: &ClientName,
        settings: Settings,
        application: &Application,
    ) -> Result<Agreement, ScenarioError> {
        let Some(ClientFile::SoftPlc { tasks, bind, .. }) = self.file().clients.get(name).map(toml::Spanned::get_ref)
        else {
            return Err(self.wrong_client(name, format!("client `{name}` is not a soft PLC"), None));
        };
        let bindings = self.bindings(name, application, &self.paths(name, bind)?)?;
        let plan = self.task_plan(name, application, tasks)?;
        let plc = SoftPlcClient::new(name.clone(), application, &plan, &bindings, self.file().step);
        let request = plc.map_err(|error| self.wrong_client(name, error.to_string(), None))?.join();
        let exchange = self.exchange(name, &settings, settings.words(), &bindings)?;
        let layout = Some(layout_number(&settings, &exchange));
        Ok(Agreement { settings, request, exchange, layout })
    }

    /// The points of a soft PLC: each variable that it feeds is one.
    fn exchange(
        &self,
        name: &ClientName,
        settings: &Settings,
        words: Words,
        bindings: &Bindings,
    ) -> Result<Exchange, ScenarioError> {
        let [inputs, outputs] =
            [&bindings.inputs, &bindings.outputs].map(|bound| bound.iter().map(Variables::of).collect::<Vec<_>>());
        let exchange = mapping::exchange(&inputs, &outputs, words, &settings.map);
        exchange.map_err(|fault| self.wrong_mapping(name, fault))
    }

    /// Refuses mappings that are none, whoever uses them.
    pub(crate) fn checked(self) -> Result<Self, ScenarioError> {
        for name in self.file().clients.keys() {
            if let Some(fault) = mapping::malformed(&self.declared(name).map) {
                return Err(self.wrong_mapping(name, fault));
            }
        }
        Ok(self)
    }

    /// What the scenario says of the link of PLC `name`.
    pub fn declared(&self, name: &ClientName) -> Settings {
        if let Some(link) = self.links.get(name) {
            return link.settings.clone();
        }
        let mut settings = match self.file().clients.get(name).map(toml::Spanned::get_ref) {
            Some(ClientFile::SoftPlc { gateway, .. }) => gateway.clone().unwrap_or_default(),
            Some(ClientFile::Gateway { gateway, .. }) => gateway.clone(),
            _ => Settings::default(),
        };
        // The structures of signals are those of the PLC's data blocks, too. A layout's own take precedence.
        for (structure, members) in &self.file().structures {
            settings.layout.structures.entry(structure.clone()).or_insert_with(|| members.clone());
        }
        settings
    }

    /// The link of PLC `name`, with the URL that counts.
    pub(crate) fn settings(&self, name: &ClientName) -> Result<Settings, ScenarioError> {
        let declared = self.declared(name);
        for named in declared.files() {
            // One that is not there yet is made in a folder that is.
            let found = if named.exists() { named } else { named.parent().unwrap_or(named) };
            permission::granted().check(self.folder(), found)?;
        }
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
                let declared: Vec<_> = signals.iter().map(|signal| &signal.name).collect();
                let wanted = arrays::chosen("reads", reads, &declared)
                    .map_err(|wrong| self.wrong_client(name, wrong.message, wrong.help))?;
                let read = |name: SignalName| {
                    let ty = signals.iter().find(|signal| signal.name == name).map(|signal| signal.ty);
                    ty.map(|ty| Port { name, ty })
                };
                let is_own = |signal: &&SignalDecl| signal.writer.as_ref() == Some(name);
                Ok(JoinRequest {
                    name: name.clone(),
                    period: period.unwrap_or(self.file().step),
                    reads: wanted.into_iter().filter_map(read).collect(),
                    writes: signals.iter().filter(is_own).map(|signal| port(&signal.name, signal.ty)).collect(),
                })
            }
            _ => Err(self.wrong_client(name, format!("client `{name}` is not a PLC"), None)),
        }
    }

    /// The instrumented program of the soft PLC `name`, to be run by a controller of its own, with words about
    /// itself.
    ///
    /// # Errors
    /// The client is not a soft PLC, or its sources or its link are wrong.
    pub fn instrumented(&self, name: &ClientName, mode: Mode) -> Result<Instrumented, ScenarioError> {
        self.instrumented_for(self.own_target(name)?, name, mode)
    }

    /// The target that takes the sources of the soft PLC `name` as they are.
    fn own_target(&self, name: &ClientName) -> Result<Target, ScenarioError> {
        let Some(ClientFile::SoftPlc { sources, dialect, .. }) =
            self.file().clients.get(name).map(toml::Spanned::get_ref)
        else {
            return Ok(Target::default());
        };
        let inputs = self.inputs(name, sources, *dialect)?;
        let is_scl = inputs.iter().any(|input| input.file().dialect() == Dialect::SiemensScl);
        Ok(if is_scl { Target::Scl } else { Target::default() })
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
            return Err(self.wrong_client(name, format!("client `{name}` is not a soft PLC"), help));
        };
        let inputs = self.inputs(name, sources, *dialect)?;
        let asked = plan_of(tasks);
        let own = self.rebuilt(name, inputs.clone())?;
        let agreed = self.agreement_on(name, self.declared(name), &own)?;
        let options = Options {
            target,
            tasks: asked.clone().map(|plan| plan.tasks),
            exchanged: agreed.exchanged(),
            layout: agreed.layout,
            ..Options::default()
        };
        let project = instrument(&inputs, &options).map_err(|error| match error {
            InstrumentError::Text(findings) => Box::new(PlcReport { client: name.clone(), findings }).into(),
            other => self.wrong_client(name, other.to_string(), None),
        })?;
        let application = self.rebuilt(name, project.program().filter_map(|file| input(file, &inputs)).collect())?;
        let paths = self.paths(name, bind)?;
        let own = self.bindings(name, &own, &paths)?;
        let bindings = if project.tasks.is_some() {
            self.bindings(name, &application, &moved_paths(&own, &project))?
        } else {
            self.bindings(name, &application, &paths)?
        };
        // With a configuration of its own the scheduler is in its tasks.
        let is_configured = !project.located.is_empty();
        let configured = application.configured_tasks().filter(|_| is_configured);
        let plan = match configured.clone().or(project.tasks.map(TaskPlan::new)).or(asked) {
            Some(plan) if configured.is_some() => plan,
            Some(plan) if mode == Mode::Lockstep => in_one_task(&plan),
            Some(plan) => with_scheduler(plan),
            None => self.task_plan(name, &application, tasks)?,
        };
        let settings = gateway.clone().unwrap_or_default();
        let exchange = self.exchange(name, &settings, settings.words(), &own)?;
        Ok(Instrumented {
            application,
            plan,
            bindings: named_as(bindings, &own),
            exchange,
            settings,
            warnings: project.warnings,
        })
    }

    /// The instrumented sources of PLC `name`, compiled.
    fn rebuilt(&self, name: &ClientName, inputs: Vec<Input>) -> Result<Application, ScenarioError> {
        let builder = Application::builder().memory_limit(self.memory_limit(name)).inputs(inputs);
        builder.build().map_err(|error| match error {
            BuildError::Sources(findings) => Box::new(PlcReport { client: name.clone(), findings }).into(),
            BuildError::Constant(error) => self.wrong_client(name, error.to_string(), None),
        })
    }

    /// An error at the line of the mapping that is wrong; at the client if the signal is not mapped.
    pub(crate) fn wrong_mapping(&self, name: &ClientName, fault: MappingFault) -> ScenarioError {
        let wrong = self.wrong_entry(name, &fault.point, (&fault.message, fault.help.as_ref()));
        wrong.unwrap_or_else(|| self.wrong_client(name, fault.message, fault.help))
    }

    /// An error of a link, at its place in the file if it has one.
    pub fn wrong_settings(&self, name: &ClientName, fault: SettingsFault) -> ScenarioError {
        match fault {
            SettingsFault::Url(bad) => self.wrong_client(name, bad.to_string(), bad.help),
            SettingsFault::Mapping(fault) | SettingsFault::Link(LinkFault::Mapping(fault)) => {
                self.wrong_mapping(name, fault)
            }
            SettingsFault::Link(LinkFault::Setting(text)) => self.wrong_client(name, text, None),
            SettingsFault::Link(fault) => ScenarioError::Link { client: name.clone(), fault },
        }
    }
}

/// A file of the instrumented project as the compiler takes it: one of the program's own in the dialect and
/// for the registers that the scenario gives it, which its name does not tell.
fn input(file: &File, own: &[Input]) -> Option<Input> {
    let kind = match FileKind::of(std::path::Path::new(&file.name)) {
        Some(FileKind::Source(kind)) => kind,
        _ => SourceKind::Text,
    };
    let input = Input::from_text(&file.name, kind, file.text.clone()?);
    Some(match own.iter().find(|own| own.file().name() == file.name) {
        Some(own) => input.read_like(own.file()),
        None => input,
    })
}

/// The paths of all signals in a project that was written in another form: signals are found by their names in the
/// project's own programs.
fn moved_paths(own: &Bindings, project: &Project) -> Paths {
    let moved = own.inputs.iter().chain(&own.outputs).map(|bound| {
        let paths = bound.variables.iter().map(|path| project.path(path)).collect();
        (bound.port.name.clone(), paths)
    });
    moved.collect()
}

/// Bindings whose variables have the paths of the scenario's own sources.
fn named_as(mut bindings: Bindings, own: &Bindings) -> Bindings {
    let both = bindings.inputs.iter_mut().zip(&own.inputs).chain(bindings.outputs.iter_mut().zip(&own.outputs));
    for (bound, own) in both.filter(|(bound, own)| bound.variables.len() == own.variables.len()) {
        bound.variables.clone_from(&own.variables);
    }
    bindings
}

/// The tasks as they are, and the scheduler before them in every cycle: it says that the program is not simulated.
fn with_scheduler(plan: TaskPlan) -> TaskPlan {
    let scheduler = Task {
        name: "SDSP_Cycle".to_owned(),
        interval: Some(CYCLE),
        programs: vec!["SDSP_Scheduler".to_owned()],
        ..Task::default()
    };
    TaskPlan::new(std::iter::once(scheduler).chain(plan.tasks).collect())
}

/// Shorter than any cycle.
const CYCLE: TimeSpan = TimeSpan::nanos::<1>();

/// Scheduler and programs in one task, in this order, in every cycle: when a program is due is the scheduler's
/// business.
fn in_one_task(plan: &TaskPlan) -> TaskPlan {
    let scheduler = std::iter::once("SDSP_Scheduler".to_owned());
    let programs = scheduler.chain(plan.tasks.iter().flat_map(|task| task.programs.iter().cloned())).collect();
    TaskPlan::new(vec![Task { name: "cycle".to_owned(), interval: Some(CYCLE), programs, ..Task::default() }])
}
