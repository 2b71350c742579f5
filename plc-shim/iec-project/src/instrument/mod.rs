//! The shim, attached to a project: any program made to run in lockstep (`[SDSP]`
//! sec. V).
//!
//! | module | subject |
//! |---|---|
//! | [`marks`] | comments that record what was changed, and the way back |
//! | [`diff`] | a changed file as a unified diff |
//! | [`template`] | the shim's sources in `iec/shim` |
//! | [`clock`] | what reads the clock, and what replaces it |
//! | [`foreign`] | what reads the clock and is reported |
//! | [`motion`], [`motion_use`] | motion control, and what of it a project uses |
//! | [`survey`] | programs and sources of time in a project |
//! | [`tasks`] | the task table |
//! | [`single`] | tasks with SINGLE |
//! | [`configuration`] | a project's CONFIGURATION |
//! | [`plain`], [`beside`] | a project without the shim, and its changes; PLCopen XML beside other files |
//! | [`controller`] | execution controllers |
//! | [`exchanged`] | the variables that a gateway writes and reads |
//! | [`real_inputs`] | inputs that the PLC's I/O image writes, taken over by name |
//! | [`scl`], [`scl_timer`] | SCL of TIA Portal: organization blocks, timers |
//! | [`scl_exchange`] | what a gateway exchanges with it: data blocks and copies |
//! | [`plcopen_project`], [`plcopen`], [`plcopen_unit`] | files of PLCopen XML, a project or a part of one |
//! | [`chart`], [`chart_plan`], [`chart_time`], [`chart_script`], [`chart_action`] | Sequential Function Charts: execution signal, action control, times of steps |
//! | [`plcopen_chart`], [`plcopen_gate`], [`plcopen_drawing`] | the same of charts that are drawn, in PLCopen XML |
//! | [`port`], [`codesys`] | a project in text for a tool that takes another form |
//! | [`matiec`], [`taken_over`] | a project in text for MatIEC, with all that the gateway exchanges at addresses |
//! | [`long_duration`] | an LTIME for a timer of TIME |
//! | [`left_out`] | files that the target's build leaves out |
//! | [`address`], [`located`] | direct addresses, and what lies there |
//! | [`verify`] | what has been written is checked |
//! | [`target`], [`sources`], [`twincat`] | the shim's sources as a vendor's tool takes them |
//!
//! Invariants: text goes in and comes out, no file is touched; what is not marked stays byte for byte;
//! instrumenting twice is instrumenting once; what cannot be replaced is reported.

mod address;
mod beside;
mod chart;
mod chart_action;
mod chart_plan;
mod chart_script;
mod chart_time;
mod clock;
mod codesys;
mod configuration;
mod controller;
pub mod diff;
mod exchanged;
mod foreign;
mod left_out;
mod located;
mod long_duration;
mod marks;
mod matiec;
mod motion;
mod motion_use;
mod plain;
mod plcopen;
mod plcopen_chart;
mod plcopen_drawing;
mod plcopen_gate;
mod plcopen_project;
mod plcopen_unit;
mod port;
mod real_inputs;
mod scl;
mod scl_exchange;
mod scl_port;
mod scl_timer;
mod single;
mod sources;
mod survey;
mod taken_over;
mod target;
mod tasks;
mod template;
mod twincat;
mod verify;

use std::sync::Arc;

use onescan_base::TimeSpan;
use thiserror::Error;

pub use self::address::Address;
pub use self::exchanged::{Exchanged, Way};
pub use self::located::Located;
use self::plain::Plain;
pub use self::real_inputs::Inputs;
pub use self::scl_exchange::{DB_FROM_PLC, DB_TO_PLC, goes_in_blocks};
use self::sources::{Globals, Sources};
use self::survey::{Survey, survey};
pub use self::target::Target;
use self::tasks::{Entry, Line, TaskTable};
use onescan_iec::diagnostic::{Diagnostics, Severity};
use onescan_iec::input::Input;
use onescan_iec::input::encoding::Encoding;
use onescan_iec::source::edits::{Conflict, LineMap};
use onescan_iec::syntax::ast::{Configuration, ProgramDeclaration};
use onescan_iec::syntax::parser::parse_source;
use onescan_iec::task_plan::Task;
use onescan_iec_run::run::RunError;

/// How a project is to be instrumented.
#[derive(Debug, Clone, Default)]
pub struct Options {
    /// Who is to take the result.
    pub target: Target,
    /// The tasks; without any, those of the project's CONFIGURATION, or one of 10 ms for all programs
    /// that no other calls.
    pub tasks: Option<Vec<Task>>,
    /// What the gateway writes and reads, in the order in which it lies there; empty if no scenario is known.
    pub exchanged: Vec<Exchanged>,
    /// The number of the scenario's mapping, which the PLC shows as `SDSP_Layout`.
    pub layout: Option<u32>,
    /// Where the words of the handshake begin in the PLC's memory, as in `%MD0`; without, where there is room.
    pub words_at: Option<String>,
    /// The interval of the emitted task of the scheduler; without, the shortest of the project's tasks.
    pub cycle: Option<TimeSpan>,
    /// What becomes of inputs that the PLC's I/O image writes.
    pub inputs: Inputs,
}

/// Why a project cannot be instrumented.
#[derive(Debug, Clone, Error)]
pub enum InstrumentError {
    /// The text is wrong.
    #[error("{0}")]
    Text(Diagnostics),
    /// What was made of right sources is wrong.
    #[error("{0}")]
    Emitted(Diagnostics),
    /// The tasks are wrong.
    #[error(transparent)]
    Tasks(#[from] RunError),
    /// There is nothing to run.
    #[error("there is no PROGRAM that a task could run")]
    NoPrograms,
    /// There is only what the shim has made.
    #[error("{0} is the shim's own: give the sources that it was made of, too")]
    OnlyOwn(String),
    /// Two changes want the same part of a file.
    #[error("{file}: {conflict}")]
    Conflict { file: String, conflict: Conflict },
}

/// A project that has been instrumented, or whose shim has been taken off.
#[derive(Debug, Clone)]
pub struct Project {
    /// Its files in their order, those of the shim last.
    pub files: Vec<File>,
    /// What could not be replaced.
    pub warnings: Diagnostics,
    /// The name of the file that is the whole project, and alone is to be given to the tool; nothing where all are.
    pub whole: Option<String>,
    /// The tasks of the program, where they run other units than those that were asked for.
    pub tasks: Option<Vec<Task>>,
    /// What lies at addresses, where the target has them.
    pub located: Vec<Located>,
    /// The data blocks that global variables have become members of.
    homes: scl_port::Homes,
}

impl Project {
    /// A project whose files all are given to the tool.
    fn of(files: Vec<File>, warnings: Diagnostics) -> Self {
        Self { files, warnings, whole: None, tasks: None, located: Vec::new(), homes: scl_port::Homes::new() }
    }

    /// The files that together are the program.
    pub fn program(&self) -> impl Iterator<Item = &File> {
        let is_part = |file: &&File| self.whole.as_ref().is_none_or(|whole| file.name == *whole);
        self.files.iter().filter(|file| file.text.is_some()).filter(is_part)
    }

    /// The path in the program of what has this path in the project.
    pub fn path(&self, path: &str) -> String {
        let located = self.located.iter().find(|each| each.variable.eq_ignore_ascii_case(path));
        located.map_or_else(|| scl_port::path(&self.homes, path), |located| located.carrier.clone())
    }
}

/// A file of a project.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct File {
    /// Its name; a file of the shim's own belongs beside the first file of the project.
    pub name: String,
    /// What it was; nothing for a new file.
    pub before: Option<Arc<str>>,
    /// What it is; nothing for a file that is to be deleted.
    pub text: Option<Arc<str>>,
    /// How it is stored.
    pub encoding: Option<Encoding>,
    /// Where its lines come from, without the shim.
    pub lines: LineMap,
}

impl File {
    /// True if it is not what it was.
    pub fn is_changed(&self) -> bool {
        self.before != self.text
    }
}

/// Attaches scheduler, execution controllers and replacement timers to a project.
///
/// ```
/// use onescan_iec::Input;
/// use onescan_iec::input::kind::SourceKind;
/// use onescan_iec_project::instrument::{Options, instrument};
///
/// let text = "PROGRAM Main VAR pause : TON; END_VAR pause(IN := TRUE, PT := T#1s); END_PROGRAM";
/// let project = instrument(&[Input::from_text("main.st", SourceKind::Text, text)], &Options::default())?;
/// let main = &project.files[0];
/// assert!(main.is_changed(), "its timer runs on virtual time now");
/// assert!(project.files.len() > 1, "the shim's own files stand beside it");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// Text or tasks are wrong; see [`InstrumentError`].
pub fn instrument(inputs: &[Input], options: &Options) -> Result<Project, InstrumentError> {
    let mut plain = Plain::of(&port::read_by(options.target, inputs))?;
    if let Some(own) = plain.only_own() {
        return Err(InstrumentError::OnlyOwn(own.to_owned()));
    }
    if let Some(refused) = plain.without_inputs(options) {
        return Err(InstrumentError::Text(plain.diagnostics(vec![refused])));
    }
    plain.left_out = left_out::names(inputs, &plain.sources);
    port::in_text(&mut plain, options.target)?;
    port::with_conversions(&mut plain, inputs, options.target)?;
    let project = match port::ported(&plain, options) {
        Some(ported) => ported?,
        None => attach(&plain, options)?.project,
    };
    verify::verified(inputs, project, options.target)
}

/// A project with the shim attached to its own files.
struct Attached {
    project: Project,
    /// The tasks, unless a configuration of the project's declares them.
    tasks: Option<Vec<Task>>,
}

fn attach(plain: &Plain, options: &Options) -> Result<Attached, InstrumentError> {
    let mut units = Vec::new();
    let mut findings = plain.findings.clone();
    for (id, file) in plain.sources.iter() {
        let parsed = parse_source(id, file);
        if let Some(warning) = left_out::warning(&parsed.diagnostics).filter(|_| plain.may_stay(id)) {
            findings.push(warning);
            continue;
        }
        findings.extend(parsed.diagnostics);
        units.push((id, parsed.unit));
    }
    let trees: Vec<_> = units.iter().map(|(id, unit)| (*id, unit)).collect();
    let mut survey = survey(&trees, options.target);
    if let Some(refused) = plain.unsuited(options.target, &survey) {
        return Err(InstrumentError::Text(plain.diagnostics(vec![refused])));
    }
    findings.append(&mut survey.findings);
    let texts = if plain.is_text() { plain.texts().collect() } else { Vec::new() };
    survey.long_durations = long_duration::given(texts, options.target, &survey);
    let exchange = (options.target == Target::Scl).then(|| scl_exchange::text(&options.exchanged)).flatten();
    if options.target == Target::Scl {
        findings.extend(scl_exchange::refused(&options.exchanged));
    }
    survey.is_exchanged = exchange.is_some();
    if options.inputs == Inputs::Taken {
        survey.inputs = real_inputs::find(&trees, &plain.sources);
        findings.append(&mut survey.inputs.findings);
    }
    let mut motion = motion_use::motion(options.target, &trees, &survey.motion);
    findings.append(&mut motion.findings);
    if findings.iter().any(|found| found.severity == Severity::Error) {
        return Err(InstrumentError::Text(plain.diagnostics(findings)));
    }
    let is_text = options.target.is_text() && !plain.has_xml();
    let line = if is_text { Line::Named } else { Line::InPlace };
    let declared = plain.tasks(&survey, options)?;
    let tasks = TaskTable::new(&declared, &entries(&survey), line)?;
    let mut forms: Vec<_> = survey.renames.iter().map(|(_, form)| *form).collect();
    forms.extend((!survey.charts.is_empty()).then(clock::on_delay));
    forms.sort_by_key(|form| form.name);
    forms.dedup();
    let mut sources = Sources::new(options, &tasks, &forms, &motion, &survey.charts, exchange);
    sources.add(&survey.inputs.additions(&plain.sources));
    if plain.is_one_xml() {
        let files = vec![plain.edited_xml(&survey, &motion, &tasks, &sources)?];
        let project = Project::of(files, plain.diagnostics(findings));
        return Ok(Attached { project, tasks: None });
    }
    // CODESYS has global variables in lists of their own.
    let is_list = |first: &&Configuration| {
        options.target == Target::Codesys || plain.is_object(first.name.span) || plain.is_of_tool(first)
    };
    let globals = match survey.configurations.first() {
        Some(first) if !is_list(first) => Globals::InConfiguration,
        _ => Globals::InFile,
    };
    let declared_there = if globals == Globals::InConfiguration { sources.globals.as_str() } else { "" };
    let mut files = plain.edited(&survey, &motion, &tasks, declared_there)?;
    for source in sources.files(options.target, globals) {
        plain.add_own(source, &mut files);
    }
    plain.delete_stale(&mut files);
    plain.list_own(&mut files)?;
    let project = Project::of(files, plain.diagnostics(findings));
    Ok(Attached { project, tasks: survey.configurations.is_empty().then_some(declared) })
}

/// True for the text of a file that is a whole project with its shim, made of the files beside it.
pub fn is_whole(text: &str) -> bool {
    marks::is_whole(text)
}

/// Takes the shim off: every file as it was before.
///
/// # Errors
/// Marks have been damaged.
pub fn remove(inputs: &[Input]) -> Result<Project, InstrumentError> {
    let plain = Plain::of(inputs)?;
    let mut files = plain.unchanged();
    plain.delete_own(&mut files);
    plain.list_own(&mut files)?;
    Ok(Project::of(files, plain.diagnostics(Vec::new())))
}

/// What tasks may run: the instances of a configuration, or else the programs themselves.
fn entries<'a>(survey: &Survey<'a>) -> Vec<Entry<'a>> {
    if survey.configurations.is_empty() {
        return survey.programs.iter().map(|pou| Entry { name: pou.name.text.clone(), pou }).collect();
    }
    let resources = survey.configurations.iter().flat_map(|configuration| &configuration.resources);
    let declared = resources.flat_map(|resource| {
        resource.programs.iter().map(|instance| (configuration::entry_name(resource, &instance.name), instance))
    });
    let entry = |(name, instance): (String, &ProgramDeclaration)| {
        let pou = survey.programs.iter().find(|pou| pou.name.key() == instance.program.key())?;
        Some(Entry { name, pou })
    };
    declared.filter_map(entry).collect()
}
