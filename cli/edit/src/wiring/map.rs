//! The map: every signal with its writer, its readers and what is wrong with it.

use onescan_plant::component::kind::Setting;
use onescan_scenario::compose::Compiled;
use onescan_scenario::file::ClientFile;
use onescan_scenario::{Scenario, ScenarioError};
use onescan_server::signal::{ClientName, SignalName, SignalType, nearest};
use schemars::JsonSchema;
use serde::Serialize;

use super::ends::{End, Found, of_plant, of_plc, of_ports};

/// The wiring of a scenario.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[schemars(rename = "Wiring")]
pub struct Map {
    /// The clients by name.
    #[schemars(default)]
    pub clients: Vec<Member>,
    /// The declared signals by name.
    pub signals: Vec<Wired>,
    /// Inputs of a plant's components that nobody drives: no fault, but a reason to look.
    #[schemars(default)]
    pub open: Vec<OpenInput>,
    /// Inputs of soft PLCs that nobody drives: most often one of two names was changed.
    #[schemars(default)]
    pub undriven: Vec<UndrivenInput>,
    /// What is wrong, signal by signal.
    pub troubles: Vec<Trouble>,
}

/// An input of a component that nobody drives.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct OpenInput {
    /// The plant that has the component.
    pub client: String,
    /// Component and input, as in `heater.on`.
    pub input: String,
    /// What it is all the time.
    #[schemars(with = "serde_json::Value")]
    pub preset: Setting,
}

/// An input of a soft PLC that nobody drives.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct UndrivenInput {
    /// The PLC.
    pub client: String,
    /// The file that declares the input.
    pub file: String,
    /// The line there, from 1.
    pub line: u32,
    /// Which input it is, what it stays, and what could be done.
    pub message: String,
}

/// A client.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Member {
    /// Its name.
    pub name: String,
    /// Its kind, as the scenario has it.
    pub kind: &'static str,
    /// Whether what it reads and writes is known before it joins.
    pub known: bool,
}

/// A declared signal.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Wired {
    /// Its name.
    pub name: String,
    /// Its declared type.
    #[serde(rename = "type")]
    pub ty: String,
    /// Its unit, if it has one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unit: Option<String>,
    /// Who writes it, and from where.
    pub writer: Hook,
    /// Who reads it, and where to.
    pub readers: Vec<Hook>,
}

/// One client's part of a signal.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Hook {
    /// The client.
    pub client: String,
    /// Outputs, inputs or variables; empty if they are not known.
    pub at: Vec<String>,
}

/// Something that is wrong with the wiring.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Trouble {
    /// What sort of trouble.
    pub kind: TroubleKind,
    /// The signal.
    pub signal: String,
    /// What is wrong with it, and what could be done.
    pub message: String,
}

/// Sorts of trouble.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum TroubleKind {
    /// One end has nothing at the other.
    Unconnected,
    /// Two clients write it.
    WrittenTwice,
    /// Its ends have different types.
    UnequalType,
    /// Declared and written, but read by nobody: no fault, for it may be there to be recorded.
    Unread,
}

impl TroubleKind {
    /// In words.
    pub fn title(self) -> &'static str {
        match self {
            Self::Unconnected => "unconnected",
            Self::WrittenTwice => "written twice",
            Self::UnequalType => "of unequal type",
            Self::Unread => "read by nobody",
        }
    }
}

impl Trouble {
    /// True if it would keep a session from starting.
    pub fn is_error(&self) -> bool {
        self.kind != TroubleKind::Unread
    }
}

impl Map {
    /// The wiring of a scenario.
    ///
    /// # Errors
    /// A scene that is none, sources that do not compile, a `bind` that is wrong in itself.
    pub fn of(scenario: &Scenario) -> Result<Self, ScenarioError> {
        let mut clients = Vec::new();
        let mut found: Vec<(ClientName, Option<Found>)> = Vec::new();
        let mut undriven = Vec::new();
        for (name, entry) in &scenario.file().clients {
            let (kind, ends) = match entry.get_ref() {
                ClientFile::Plant { scene, .. } => ("plant", Some(of_plant(&scenario.scene_of(name, scene)?))),
                ClientFile::SoftPlc { sources, dialect, bind, ports, .. } => {
                    let compiled = scenario.compiled(name, sources, *dialect, bind)?;
                    let Compiled { application, paths, .. } = &compiled;
                    let mut ends = of_plc(application, name, scenario.plan().signals(), paths);
                    of_ports(ports, scenario.plan().signals(), &mut ends);
                    // A signal without a variable is reported itself; which inputs are left is then not known.
                    if ends.unbound.is_empty() {
                        undriven.extend(undriven_of(scenario, name, &compiled)?);
                    }
                    ("soft-plc", Some(ends))
                }
                // It writes whatever the scenario says that it writes.
                ClientFile::Operator { .. } => ("operator", None),
                ClientFile::Gateway { .. } => ("gateway", None),
                ClientFile::OpcUa { .. } => ("opc-ua", None),
                ClientFile::External { .. } => ("external", None),
            };
            clients.push(Member { name: name.to_string(), kind, known: ends.is_some() });
            found.push((name.clone(), ends.map(Found::new)));
        }
        let mut map = Self { clients, signals: Vec::new(), open: open(&found), undriven, troubles: Vec::new() };
        for (name, signal) in &scenario.file().signals {
            let signal = signal.get_ref();
            let wired = Wired {
                name: name.to_string(),
                ty: signal.ty.to_string(),
                unit: signal.unit.clone(),
                writer: hook(&signal.writer, &found, name, Side::Writes),
                readers: readers(&signal.writer, &found, name),
            };
            map.check(&wired, (name, signal.ty, &signal.writer), &found);
            map.signals.push(wired);
        }
        map.check_undeclared(scenario, &found);
        map.troubles.sort_by_key(|trouble| trouble.kind);
        Ok(map)
    }

    /// True if nothing would keep a session from starting.
    pub fn is_sound(&self) -> bool {
        !self.troubles.iter().any(Trouble::is_error)
    }

    fn trouble(&mut self, kind: TroubleKind, signal: &SignalName, message: String) {
        self.troubles.push(Trouble { kind, signal: signal.to_string(), message });
    }

    fn check(
        &mut self,
        wired: &Wired,
        (name, ty, writer): (&SignalName, SignalType, &ClientName),
        found: &[(ClientName, Option<Found>)],
    ) {
        for (client, ends) in found {
            let Some(ends) = ends else { continue };
            for error in ends.unbound(name) {
                let typed = error.message.contains(&format!("`{name}` is {ty}, but"));
                let kind = if typed { TroubleKind::UnequalType } else { TroubleKind::Unconnected };
                let help = error.help.as_ref().map(|help| format!(" ({help})")).unwrap_or_default();
                self.trouble(kind, name, format!("{client}: {}{help}", error.message));
            }
            let writes = ends.writes(name).next().is_some();
            if writes && client != writer {
                let message = format!("`{writer}` writes it by declaration, and `{client}` does, too");
                self.trouble(TroubleKind::WrittenTwice, name, message);
            }
            let bound = ends.unbound(name).next().is_none();
            if !writes && client == writer && bound {
                let near = nearest(name.as_str(), ends.ends.writes.iter().map(|end| end.signal.as_str()));
                let help = near.map(|near| format!(" (did you mean `{near}`?)")).unwrap_or_default();
                self.trouble(TroubleKind::Unconnected, name, format!("`{writer}` is to write it and does not{help}"));
            }
            for end in ends.reads(name).chain(ends.writes(name)).filter(|end| end.ty != ty) {
                let message = format!("declared {ty}, but {} at `{client}`", end.ty);
                self.trouble(TroubleKind::UnequalType, name, message);
            }
        }
        let all_known = found.iter().all(|(client, ends)| ends.is_some() || client == writer);
        if wired.readers.is_empty() && all_known {
            self.trouble(TroubleKind::Unread, name, format!("`{writer}` writes it"));
        }
    }

    /// Ends at signals that the scenario does not declare.
    fn check_undeclared(&mut self, scenario: &Scenario, found: &[(ClientName, Option<Found>)]) {
        let declared = &scenario.file().signals;
        for (client, ends) in found.iter().filter_map(|(client, found)| Some((client, &found.as_ref()?.ends))) {
            let reported = |end: &End, does: &str| {
                let near = nearest(end.signal.as_str(), declared.keys().map(SignalName::as_str));
                let help = near.map(|near| format!(" (did you mean `{near}`?)")).unwrap_or_default();
                format!("`{client}` {does} it, but it is not declared under [signals]{help}")
            };
            let reads = ends.reads.iter().map(|end| (end, "reads"));
            for (end, does) in reads.chain(ends.writes.iter().map(|end| (end, "writes"))) {
                if !declared.contains_key(&end.signal) {
                    self.trouble(TroubleKind::Unconnected, &end.signal, reported(end, does));
                }
            }
        }
    }
}

fn undriven_of(
    scenario: &Scenario,
    name: &ClientName,
    compiled: &Compiled,
) -> Result<Vec<UndrivenInput>, ScenarioError> {
    let warnings = scenario.undriven_of(name, compiled)?;
    let inputs = warnings.findings().iter().map(|finding| UndrivenInput {
        client: name.to_string(),
        file: finding.file().to_owned(),
        line: finding.start().line,
        message: finding.diagnostic().with_its_help(),
    });
    Ok(inputs.collect())
}

fn open(found: &[(ClientName, Option<Found>)]) -> Vec<OpenInput> {
    let mut open = Vec::new();
    for (client, ends) in found {
        for (input, preset) in ends.iter().flat_map(|found| &found.ends.open) {
            open.push(OpenInput { client: client.to_string(), input: input.clone(), preset: *preset });
        }
    }
    open
}

#[derive(Clone, Copy)]
enum Side {
    Reads,
    Writes,
}

fn hook(client: &ClientName, found: &[(ClientName, Option<Found>)], signal: &SignalName, side: Side) -> Hook {
    let ends = found.iter().find(|(known, _)| known == client).and_then(|(_, ends)| ends.as_ref());
    let places = |ends: &mut dyn Iterator<Item = &End>| ends.flat_map(|end| end.places.clone()).collect();
    let at = ends.map_or_else(Vec::new, |ends| match side {
        Side::Reads => places(&mut ends.reads(signal)),
        Side::Writes => places(&mut ends.writes(signal)),
    });
    Hook { client: client.to_string(), at }
}

fn readers(writer: &ClientName, found: &[(ClientName, Option<Found>)], signal: &SignalName) -> Vec<Hook> {
    let reads = |found: &Found| found.reads(signal).next().is_some();
    let reading = found.iter().filter(|(client, ends)| client != writer && ends.as_ref().is_some_and(reads));
    reading.map(|(client, _)| hook(client, found, signal, Side::Reads)).collect()
}
