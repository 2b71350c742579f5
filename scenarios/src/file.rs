//! `scenario.toml` as it is written. Times are text with a unit, as in `"10ms"`.

use std::collections::BTreeMap;

use onescan_iec::{Dialect, MemoryLimit, WordSize};
use onescan_links::gateway::Settings;
use onescan_server::signal::{ClientName, SignalName, SignalType};
use onescan_server::time::{TimeSpan, VirtualTime};
use schemars::JsonSchema;
use serde::{Deserialize, Deserializer};
use toml::Spanned;

use crate::expect::KnownSignal;
use crate::falsify_file::FalsifyFile;
use crate::form::{DialectName, Mebibytes, Name, Scalar, Time, Type, Values, WordBits, from_optional_text, from_text};
use crate::look_file::{FigureFile, LookFile, ViewFile};
use crate::map_file::MapFile;
use crate::panel_file::PanelFile;
use crate::ports_file::PortFile;
use crate::report_file::ReportFile;
use crate::timing_file::TimingFile;
use crate::value_names::ValueNames;

/// The file that makes a folder a scenario.
pub const FILE_NAME: &str = "scenario.toml";
/// The only version of the format so far.
pub const VERSION: u32 = 1;

/// `scenario.toml`: a session.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ScenarioFile {
    /// Version of the format: 1.
    pub version: u32,
    /// What the scenario is about, in one line.
    #[serde(default)]
    pub title: String,
    /// The step of virtual time, as in `"10ms"`.
    #[serde(deserialize_with = "from_text")]
    #[schemars(with = "Time")]
    pub step: TimeSpan,
    /// Virtual time at which a run is complete, unless `--until` or a case says otherwise.
    #[serde(deserialize_with = "from_text")]
    #[schemars(with = "Time")]
    pub until: VirtualTime,
    /// What must hold before virtual time runs: a formula on one image.
    #[serde(default)]
    #[schemars(with = "Option<String>")]
    pub start: Option<Spanned<String>>,
    /// Seed of all noise, jitter and other randomness.
    #[serde(default)]
    pub seed: u64,
    /// How clients see each other within a step.
    #[serde(default)]
    pub coupling: CouplingFile,
    /// Structures that signals may have, by name: their members, each `Name: TYPE`.
    #[serde(default)]
    pub structures: BTreeMap<String, Vec<String>>,
    /// The session's signals by name, as they are written; none once they are written out.
    #[serde(default, rename = "signals")]
    #[schemars(with = "BTreeMap<String, DeclaredSignal>")]
    pub(crate) declared: BTreeMap<SignalName, Spanned<DeclaredSignal>>,
    /// The session's signals by name, arrays and structures written out.
    #[serde(skip)]
    pub signals: BTreeMap<SignalName, Spanned<SignalFile>>,
    /// The session's clients by name.
    #[schemars(with = "BTreeMap<String, ClientFile>")]
    pub clients: BTreeMap<ClientName, Spanned<ClientFile>>,
    /// Variables of the environment that the programs of `command` are to see beside those that programs need.
    #[serde(default)]
    pub pass_env: Vec<String>,
    /// What every run must show.
    #[serde(default)]
    pub expect: Vec<ExpectFile>,
    /// What is counted and timed in every run.
    #[schemars(with = "Option<ReportFile>")]
    pub report: Option<Spanned<ReportFile>>,
    /// What the real links may do to signals, for `onescan explore`.
    #[serde(default)]
    pub timing: TimingFile,
    /// What may be varied to break what is expected, for `onescan falsify`.
    #[serde(default)]
    pub falsify: FalsifyFile,
    /// How the signals travel when nothing is synchronised.
    #[serde(default)]
    pub freewheel: FreewheelFile,
    /// What a plot shows.
    #[serde(default)]
    pub plot: PlotFile,
    /// Tables of values that `onescan run --maps` draws when a run is over.
    #[serde(default)]
    pub map: Vec<MapFile>,
    /// What people see and operate on the page.
    #[serde(default)]
    pub panel: Vec<PanelFile>,
    /// Texts of the scenario in other languages, for the page: by language, as in `de`, what each text is there.
    #[serde(default)]
    pub translations: BTreeMap<String, BTreeMap<String, String>>,
    /// From where the machine is seen on the page.
    #[serde(default)]
    pub view: Vec<ViewFile>,
    /// What is drawn on the page beside the bodies of plants.
    #[serde(default)]
    pub figure: Vec<FigureFile>,
    /// What bodies look like on the page while something holds, or by the value of a signal.
    #[serde(default)]
    #[schemars(with = "Vec<LookFile>")]
    pub look: Vec<Spanned<LookFile>>,
}

/// `"parallel"` or `{ sequential = ["plc", "plant"] }`.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum CouplingFile {
    /// All clients of a step read the image of the step before (SDSP).
    #[default]
    Parallel,
    /// The clients run in this order, and each sees what those before it wrote (OneScan).
    Sequential(
        /// All clients, in the order in which they run.
        #[schemars(with = "Vec<Name>")]
        Vec<ClientName>,
    ),
}

/// One signal.
#[derive(Clone, Debug)]
pub struct SignalFile {
    /// An elementary type of IEC 61131-3.
    pub ty: SignalType,
    /// The client that writes it.
    pub writer: ClientName,
    /// Its unit, as `"bar"` or `"mm"`.
    pub unit: Option<String>,
    /// What it means, for readers.
    pub about: Option<String>,
    /// The names of its values.
    pub names: ValueNames,
}

/// One signal.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "SignalFile")]
pub(crate) struct DeclaredSignal {
    /// An elementary type of IEC 61131-3: `BOOL`, `INT`, `LREAL`, `TIME`, `STRING[80]`.
    #[serde(default, rename = "type")]
    #[schemars(with = "Type")]
    pub ty: Option<SignalType>,
    /// In place of a type, one of `[structures]`: the signal then stands for one signal a member.
    #[serde(default)]
    #[schemars(with = "Name")]
    pub structure: Option<Spanned<String>>,
    /// The client that writes it; exactly one.
    #[schemars(with = "Name")]
    pub writer: ClientName,
    /// Its unit, as `"bar"` or `"mm"`: reports show it, and expectations convert to it.
    pub unit: Option<String>,
    /// What it means, for readers.
    pub about: Option<String>,
    /// The names of its values, as `{ 0 = "Idle", 1 = "Running" }`: plots show them.
    #[serde(default)]
    #[schemars(with = "BTreeMap<String, String>")]
    pub names: ValueNames,
}

/// One client.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum ClientFile {
    /// A scene of rigid bodies.
    Plant {
        /// The scene file, relative to the scenario's folder.
        scene: String,
        /// Values in the place of the scene's, as in `set.pump.speed_rad_s = 2.0`, so that scenarios share a scene.
        #[serde(default)]
        #[schemars(with = "Values")]
        set: toml::Table,
        /// Virtual time of one turn; the session's step if absent.
        #[serde(default, deserialize_with = "from_optional_text")]
        #[schemars(with = "Option<Time>")]
        period: Option<TimeSpan>,
    },
    /// The embedded soft PLC.
    SoftPlc {
        /// Source files, relative to the scenario's folder.
        sources: Vec<String>,
        /// The dialect of all sources; from each file's name if absent.
        #[serde(default, deserialize_with = "from_optional_text")]
        #[schemars(with = "Option<DialectName>")]
        dialect: Option<Dialect>,
        /// Bits of the registers in which the target computes integers, in codesys and twincat; 64 if absent.
        #[serde(default, deserialize_with = "word_size")]
        #[schemars(with = "Option<WordBits>")]
        word_size_bits: Option<WordSize>,
        /// MiB that all its variables may take together, up to 2047; 64 if absent.
        #[serde(default, deserialize_with = "memory_limit")]
        #[schemars(with = "Option<Mebibytes>")]
        memory_limit_mib: Option<MemoryLimit>,
        /// Its tasks, in place of all tasks of the sources' CONFIGURATION.
        #[serde(default)]
        tasks: Vec<TaskFile>,
        /// Signals whose PLC variable is not found by the signal's name, with the variable's path: by
        /// name, as arrays (`"arm[0..2].x" = "P.arm[0..2].x"`) or as patterns (`"SW_*" = "P.*"`).
        #[serde(default)]
        bind: BTreeMap<String, String>,
        /// Its ports: lines of bytes to devices, by their names.
        #[serde(default)]
        ports: BTreeMap<String, PortFile>,
        /// A folder with the files that its program finds; `files` if absent and there.
        #[serde(default)]
        files: Option<String>,
        /// The real PLC that runs the same sources, instrumented (see `run --gateway`).
        #[serde(default)]
        gateway: Option<Settings>,
    },
    /// A real PLC, of which only the link is known.
    Gateway {
        /// Virtual time of one turn; the session's step if absent.
        #[serde(default, deserialize_with = "from_optional_text")]
        #[schemars(with = "Option<Time>")]
        period: Option<TimeSpan>,
        /// The signals that it reads: names, ranges as `Sensor[0..3]`, patterns as `Feedback.*`.
        #[serde(default)]
        reads: Vec<String>,
        /// The link to the PLC.
        gateway: Settings,
    },
    /// Switches and set points that neither plant nor PLC writes; a case says what it does.
    Operator {
        /// Values of its signals at the start; 0, FALSE or empty if absent.
        #[serde(default)]
        #[schemars(with = "BTreeMap<String, Scalar>")]
        initial: BTreeMap<SignalName, toml::Value>,
    },
    /// A program of its own that takes part over OPC UA, in the session's information model (`docs/opcua.md`).
    OpcUa {
        /// Virtual time of one turn; the session's step if absent.
        #[serde(default, deserialize_with = "from_optional_text")]
        #[schemars(with = "Option<Time>")]
        period: Option<TimeSpan>,
        /// The signals that it reads: names, ranges as `Sensor[0..3]`, patterns as `Feedback.*`. It writes those whose
        /// writer it is.
        #[serde(default)]
        reads: Vec<String>,
        /// The program to start, with its arguments; `{server}` stands for the server's endpoint.
        /// Without it the server waits for somebody to start it.
        #[serde(default)]
        command: Vec<String>,
    },
    /// A program of its own that joins over TCP.
    External {
        /// The program to start, with its arguments; `{server}` stands for the server's address.
        /// Without it the server waits for somebody to start it.
        #[serde(default)]
        command: Vec<String>,
    },
}

impl ClientFile {
    /// True for a PLC, whether its program is run here or elsewhere.
    pub fn is_plc(&self) -> bool {
        matches!(self, Self::SoftPlc { .. } | Self::Gateway { .. })
    }
}

/// One task of a soft PLC (IEC 61131-3 2.7.2).
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TaskFile {
    /// The task's name, for reports.
    pub name: String,
    /// Its cycle time, a multiple of the step.
    #[serde(default, deserialize_with = "from_optional_text")]
    #[schemars(with = "Option<Time>")]
    pub interval: Option<TimeSpan>,
    /// Path of a BOOL of the PLC whose rising edges start it.
    #[serde(default)]
    pub single: Option<String>,
    /// Its priority, from 0, which is the highest.
    #[serde(default)]
    pub priority: u32,
    /// The programs it runs, in this order; with a CONFIGURATION, their instances.
    pub programs: Vec<String>,
}

/// Something that every run must show.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ExpectFile {
    /// Its name in reports; unique.
    #[schemars(with = "String")]
    pub name: Spanned<String>,
    /// Signal temporal logic over the scenario's signals, as in `"always (Push implies not Belt_On)"`.
    #[schemars(with = "String")]
    pub formula: Spanned<String>,
    /// What it means, for readers.
    pub about: Option<String>,
    /// Of a task that is graded: the marks of a program that meets it in every case in which it is judged.
    #[serde(default)]
    pub marks: u32,
    /// Of a task that is graded: its violation is one of safety, which the report shows first.
    #[serde(default)]
    pub safety: bool,
}

/// The OPC-like link between free-wheeling clients (`[SDSP]` sec. II-C and III).
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct FreewheelFile {
    /// How often the link looks for changes: the update rate of the OPC client group.
    #[serde(deserialize_with = "from_text")]
    #[schemars(with = "Time")]
    pub update_rate: TimeSpan,
    /// How long the link needs for one item: items that change together arrive one after the other.
    #[serde(deserialize_with = "from_text")]
    #[schemars(with = "Time")]
    pub item_transfer: TimeSpan,
    /// How much of its error a plant that follows the PLC's clock corrects at each update, % (`[Vergnano]` Fig. 5: all of it).
    #[serde(deserialize_with = "percent")]
    #[schemars(range(min = 0, max = 100))]
    pub synchronizer_gain_pct: u8,
    /// The clocks of a run with `--seed`, whose time is computed.
    pub model: ClockModelFile,
}

/// The clocks of a PLC and of the PC with plant and link, as they are drawn by a seed in a run that takes no real time.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct ClockModelFile {
    /// How much faster the PLC's clock is than the PC's, parts per million.
    #[serde(deserialize_with = "skew")]
    #[schemars(range(min = -1000, max = 1000))]
    pub clock_skew_ppm: i16,
    /// The granularity of the PC's timer, microseconds: sleeps end at a multiple of it. 0 for none.
    pub timer_us: u32,
    /// How late the PC wakes on average, microseconds.
    pub late_mean_us: u32,
    /// The standard deviation of that; it never wakes early.
    pub late_sigma_us: u32,
}

impl Default for ClockModelFile {
    /// A PC of the office: two quartz clocks, a timer of 1 ms, and whoever sleeps gets the processor half a millisecond late.
    fn default() -> Self {
        Self { clock_skew_ppm: 30, timer_us: 1_000, late_mean_us: 500, late_sigma_us: 1_000 }
    }
}

impl ScenarioFile {
    /// The signals, as formulas know them.
    pub(crate) fn known_signals(&self) -> Vec<KnownSignal> {
        let known = |(name, signal): (&SignalName, &Spanned<SignalFile>)| {
            let signal = signal.get_ref();
            KnownSignal { name: name.to_string(), ty: signal.ty, unit: signal.unit.clone() }
        };
        self.signals.iter().map(known).collect()
    }
}

impl Default for FreewheelFile {
    /// The update rate of `[SDSP]` sec. III-C, and a gateway that moves a thousand items a second.
    fn default() -> Self {
        const MILLISECOND: TimeSpan = TimeSpan::from_millis(1).expect("not zero");
        Self {
            update_rate: MILLISECOND,
            item_transfer: MILLISECOND,
            synchronizer_gain_pct: 100,
            model: ClockModelFile::default(),
        }
    }
}

/// What a plot shows.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlotFile {
    /// The signals, a panel each, from top to bottom; all if empty.
    #[serde(default)]
    #[schemars(with = "Vec<Name>")]
    pub signals: Vec<Spanned<SignalName>>,
}

/// A part of a hundred.
fn percent<'de, D: Deserializer<'de>>(from: D) -> Result<u8, D::Error> {
    match u8::deserialize(from)? {
        percent @ 0..=100 => Ok(percent),
        more => Err(serde::de::Error::custom(format!("{more} is more than 100 %"))),
    }
}

/// The skew of two clocks that anybody would call clocks.
fn skew<'de, D: Deserializer<'de>>(from: D) -> Result<i16, D::Error> {
    match i16::deserialize(from)? {
        ppm @ -1000..=1000 => Ok(ppm),
        more => Err(serde::de::Error::custom(format!("{more} is not from -1000 to 1000 parts per million"))),
    }
}

/// Bits of a target's registers.
fn word_size<'de, D: Deserializer<'de>>(from: D) -> Result<Option<WordSize>, D::Error> {
    let bits = u32::deserialize(from)?;
    WordSize::of_bits(bits).map(Some).map_err(serde::de::Error::custom)
}

/// A number of MiB that a PLC can address.
fn memory_limit<'de, D: Deserializer<'de>>(from: D) -> Result<Option<MemoryLimit>, D::Error> {
    let mib = u32::deserialize(from)?;
    MemoryLimit::of_mib(mib).map(Some).map_err(serde::de::Error::custom)
}
