//! The shim, attached to a project: any program made to run in lockstep (seed: Carlsson et al. 2012,
//! sec. V).
//!
//! | module | subject |
//! |---|---|
//! | [`edits`] | changes of a text, and where its lines come from |
//! | [`marks`] | comments that tell what was changed, and the way back |
//! | [`diff`] | a changed file as a unified diff |
//! | [`template`] | the shim's sources in `iec/shim` |
//! | [`clock`] | what reads the clock, and what replaces it |
//! | [`motion`], [`motion_use`] | motion control, and what of it a project uses |
//! | [`survey`] | programs and sources of time in a project |
//! | [`tasks`] | the task table |
//! | [`constant`] | constant expressions of tasks |
//! | [`configuration`] | a project's CONFIGURATION |
//! | [`controller`] | execution controllers |
//! | [`plcopen_project`], [`plcopen`], [`plcopen_unit`] | projects in PLCopen XML |
//! | [`chart`], [`chart_plan`] | Sequential Function Charts: execution signal, action control, times of steps |
//! | [`plcopen_chart`], [`plcopen_gate`] | the same of charts that are drawn, in PLCopen XML |
//! | [`target`], [`twincat`] | the shim's sources as a vendor's tool takes them |
//!
//! Invariants: text goes in and comes out, no file is touched; what is not marked stays byte for byte;
//! instrumenting twice is instrumenting once; what cannot be replaced is told.

mod chart;
mod chart_plan;
mod clock;
mod configuration;
mod constant;
mod controller;
pub mod diff;
pub mod edits;
mod marks;
mod motion;
mod motion_use;
mod plcopen;
mod plcopen_chart;
mod plcopen_gate;
mod plcopen_project;
mod plcopen_unit;
mod survey;
mod target;
mod tasks;
mod template;
mod twincat;

use std::path::Path;
use std::sync::Arc;

use thiserror::Error;

use self::chart_plan::Plan as ChartPlan;
use self::edits::{Conflict, Edited, Edits, LineMap};
use self::marks::Original;
use self::motion_use::Motion;
use self::survey::{Survey, survey};
pub use self::target::Target;
use self::target::{Globals, Sources};
use self::tasks::{Entry, TaskTable};
use crate::diagnostic::{Code, Diagnostic, Diagnostics, Severity};
use crate::dialect::Dialect;
use crate::input::Input;
use crate::input::encoding::Encoding;
use crate::input::kind::{FileKind, SourceKind};
use crate::run::{RunError, Task};
use crate::syntax::ast::ProgramDeclaration;
use crate::syntax::parser::parse_source;
use crate::syntax::{FileId, SourceMap, Span};

/// How a project is to be instrumented.
#[derive(Debug, Clone, Default)]
pub struct Options {
    /// Who is to take the result.
    pub target: Target,
    /// The tasks; without any, those of the project's CONFIGURATION, or one of 10 ms for all programs
    /// that no other calls.
    pub tasks: Option<Vec<Task>>,
}

/// Why a project cannot be instrumented.
#[derive(Debug, Clone, Error)]
pub enum InstrumentError {
    /// The text is wrong.
    #[error("{0}")]
    Text(Diagnostics),
    /// The tasks are wrong.
    #[error(transparent)]
    Tasks(#[from] RunError),
    /// There is nothing to run.
    #[error("there is no PROGRAM that a task could run")]
    NoPrograms,
    /// Two changes want the same part of a file.
    #[error("{file}: {conflict}")]
    Conflict {
        /// The file.
        file: String,
        /// Where.
        conflict: Conflict,
    },
}

/// A project that has been instrumented, or whose shim has been taken off.
#[derive(Debug, Clone)]
pub struct Project {
    /// Its files in their order, those of the shim last.
    pub files: Vec<File>,
    /// What could not be replaced.
    pub warnings: Diagnostics,
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
    /// Where its lines come from in `before`.
    from: LineMap,
}

impl File {
    /// True if it is not what it was.
    pub fn is_changed(&self) -> bool {
        self.before != self.text
    }
}

/// Attaches scheduler, execution controllers and replacement timers to a project.
///
/// # Errors
/// Text or tasks are wrong; see [`InstrumentError`].
pub fn instrument(inputs: &[Input], options: &Options) -> Result<Project, InstrumentError> {
    let plain = Plain::of(inputs)?;
    let mut units = Vec::new();
    let mut findings = plain.findings.clone();
    for (id, file) in plain.sources.iter() {
        let parsed = parse_source(id, file);
        findings.extend(parsed.diagnostics);
        units.push((id, parsed.unit));
    }
    let trees: Vec<_> = units.iter().map(|(id, unit)| (*id, unit)).collect();
    let mut survey = survey(&trees);
    findings.append(&mut survey.findings);
    let mut motion = motion_use::motion(options.target, &trees, &survey.motion);
    findings.append(&mut motion.findings);
    findings.extend(plain.unsuited(options.target));
    if findings.iter().any(|found| found.severity == Severity::Error) {
        return Err(InstrumentError::Text(Diagnostics::new(findings, &plain.sources)));
    }
    let tasks = TaskTable::new(&plain.tasks(&survey, options)?, &entries(&survey))?;
    let mut forms: Vec<_> = survey.renames.iter().map(|(_, form)| *form).collect();
    forms.extend((!survey.charts.is_empty()).then(clock::on_delay));
    forms.sort_by_key(|form| form.name);
    forms.dedup();
    let sources = Sources::new(options.target, &tasks, &forms, &motion.blocks, &survey.charts);
    if plain.is_xml() {
        let files = vec![plain.edited_xml(&survey, &motion, &tasks, &sources)?];
        return Ok(Project { files, warnings: Diagnostics::new(findings, &plain.sources) });
    }
    let mut files = plain.edited(&survey, &motion, &tasks, &sources.globals)?;
    let globals = if survey.configuration.is_some() { Globals::InConfiguration } else { Globals::InFile };
    for source in sources.files(options.target, globals) {
        plain.add_own(source, &mut files);
    }
    plain.list_own(&mut files)?;
    Ok(Project { files, warnings: Diagnostics::new(findings, &plain.sources) })
}

/// Takes the shim off: every file as it was before.
///
/// # Errors
/// Marks have been damaged.
pub fn remove(inputs: &[Input]) -> Result<Project, InstrumentError> {
    let plain = Plain::of(inputs)?;
    let mut files = plain.edited(&Survey::default(), &Motion::default(), &TaskTable::default(), "")?;
    plain.delete_own(&mut files);
    plain.list_own(&mut files)?;
    Ok(Project { files, warnings: Diagnostics::new(Vec::new(), &plain.sources) })
}

/// What tasks may run: the instances of a configuration, or else the programs themselves.
fn entries<'a>(survey: &Survey<'a>) -> Vec<Entry<'a>> {
    let Some(configuration) = survey.configuration else {
        return survey.programs.iter().map(|pou| Entry { name: pou.name.text.clone(), pou }).collect();
    };
    let declared = configuration.resources.iter().flat_map(|resource| {
        resource.programs.iter().map(|instance| (configuration::entry_name(resource, &instance.name), instance))
    });
    let entry = |(name, instance): (String, &ProgramDeclaration)| {
        let pou = survey.programs.iter().find(|pou| pou.name.key() == instance.program.key())?;
        Some(Entry { name, pou })
    };
    declared.filter_map(entry).collect()
}

/// A project without the shim.
struct Plain {
    sources: SourceMap,
    /// Of each file in `sources` what it was when it was given.
    given: Vec<Given>,
    /// What kind of file each of them is.
    kinds: Vec<SourceKind>,
    /// The shim's own files that were given.
    own: Vec<Given>,
    /// TwinCAT projects, and what they are without the shim.
    manifests: Vec<(Given, Arc<str>)>,
    findings: Vec<Diagnostic>,
}

struct Given {
    name: String,
    text: Arc<str>,
    encoding: Option<Encoding>,
    /// Where the lines are of what it was before it was instrumented.
    plain_lines: LineMap,
}

impl Plain {
    fn of(inputs: &[Input]) -> Result<Self, InstrumentError> {
        let mut plain = Self {
            sources: SourceMap::default(),
            given: Vec::new(),
            kinds: Vec::new(),
            own: Vec::new(),
            manifests: Vec::new(),
            findings: Vec::new(),
        };
        for input in inputs {
            plain.add(input);
        }
        if plain.findings.iter().any(|found| found.code == Code::DamagedMarks) {
            return Err(InstrumentError::Text(Diagnostics::new(plain.findings, &plain.sources)));
        }
        Ok(plain)
    }

    fn add(&mut self, input: &Input) {
        let (name, text) = (input.file().name(), input.file().shown_text());
        let original = marks::original(text);
        let plain_lines = match &original {
            Ok(Original::Text(plain)) => plain.lines.clone(),
            _ => LineMap::same(text),
        };
        let given = Given { name: name.to_owned(), text: text.clone(), encoding: input.encoding(), plain_lines };
        let kind = match (FileKind::of(Path::new(name)), &original) {
            (Some(FileKind::Project), Ok(Original::Text(plain))) => {
                return self.manifests.push((given, plain.text.as_str().into()));
            }
            (Some(FileKind::Project), Ok(_)) => return self.manifests.push((given, text.clone())),
            (Some(FileKind::Source(kind)), _) => kind,
            _ => SourceKind::Text,
        };
        let plain = match original {
            Ok(Original::Nothing) => return self.own.push(given),
            Ok(Original::Same) => input.clone(),
            Ok(Original::Text(plain)) => Input::from_text(name, kind, plain.text).in_dialect(input.file().dialect()),
            Err(damaged) => return self.damaged(name, text, &damaged),
        };
        self.given.push(given);
        let id = FileId(self.sources.iter().count() as u32);
        self.findings.extend(plain.add_to(&mut self.sources));
        self.kinds.push(kind);
        let mixed = self.kinds.contains(&SourceKind::PlcOpen) && self.kinds.len() > 1;
        let refused = match (kind, input.file().dialect()) {
            _ if mixed => "a project in PLCopen XML is one file, other sources beside it are not instrumented yet",
            (_, Dialect::SiemensScl) => "SCL is not instrumented yet",
            _ => return,
        };
        self.findings.push(Diagnostic::error(Code::UnsupportedFeature, Span::new(id, 0, 0), refused));
    }

    /// True for a project in PLCopen XML, which is one file.
    fn is_xml(&self) -> bool {
        self.kinds.contains(&SourceKind::PlcOpen)
    }

    /// A target that does not take the project's kind of file.
    fn unsuited(&self, target: Target) -> Option<Diagnostic> {
        let message = match target {
            Target::Codesys if !self.is_xml() => "the target codesys takes a project in PLCopen XML",
            Target::TwinCat if self.is_xml() => "the target twincat takes TwinCAT's own files, not PLCopen XML",
            _ => return None,
        };
        let found = Diagnostic::error(Code::UnsupportedFeature, Span::new(FileId(0), 0, 0), message);
        Some(found.with_help("export the project in that form, or choose another target"))
    }

    fn damaged(&mut self, name: &str, text: &Arc<str>, damaged: &marks::DamagedMarks) {
        let id = self.sources.add(crate::syntax::SourceFile::new(name, text.clone()));
        let span = Span::new(id, damaged.at.start, damaged.at.end);
        let found = Diagnostic::error(Code::DamagedMarks, span, damaged.message);
        let help = "take the file from before it was instrumented, or take the marks out by hand";
        self.findings.push(found.with_help(help));
    }

    fn tasks(&self, survey: &Survey<'_>, options: &Options) -> Result<Vec<Task>, InstrumentError> {
        if let Some(tasks) = &options.tasks {
            return Ok(tasks.clone());
        }
        if let Some(configuration) = survey.configuration {
            let wrong = |found| InstrumentError::Text(Diagnostics::new(vec![found], &self.sources));
            return configuration::tasks(configuration, &survey.constants).map_err(wrong);
        }
        let scheduled = survey.programs.iter().filter(|program| !survey.called.contains(&program.name.key()));
        let programs: Vec<String> = scheduled.map(|program| program.name.text.clone()).collect();
        if programs.is_empty() {
            return Err(InstrumentError::NoPrograms);
        }
        Ok(vec![Task { name: "main".to_owned(), interval_ns: 10_000_000, programs, ..Task::default() }])
    }

    /// The project's files with their changes.
    fn edited(
        &self,
        survey: &Survey<'_>,
        motion: &Motion,
        tasks: &TaskTable<'_>,
        globals: &str,
    ) -> Result<Vec<File>, InstrumentError> {
        let mut edits: Vec<Edits> = self.given.iter().map(|_| Edits::default()).collect();
        let mut changes = |id: FileId, change: &mut dyn FnMut(&crate::syntax::SourceFile, &mut Edits)| {
            if let (Some(file), Some(edits)) = (self.sources.get(id), edits.get_mut(id.0 as usize)) {
                change(file, edits);
            }
        };
        let clocks = survey.renames.iter().map(|(name, form)| (name, form.new_name()));
        for (name, new) in clocks.chain(motion.renames.iter().map(|(name, new)| (name, new.clone()))) {
            changes(name.span.file, &mut |file, edits| {
                let at = file.shown_range(name.span.start, name.span.end);
                edits.replace(at, marks::renamed(&new, &name.text));
            });
        }
        for pou in &survey.charts {
            let number = tasks.numbered().find(|(numbered, _)| std::ptr::eq(*numbered, *pou));
            let number = number.map(|(_, number)| (number, tasks.programs.len()));
            changes(pou.name.span.file, &mut |file, edits| {
                chart::control(&ChartPlan::new(pou, number, &survey.renames, file), edits);
            });
        }
        for (pou, number) in tasks.numbered().filter(|(pou, _)| pou.chart.is_empty()) {
            changes(pou.name.span.file, &mut |file, edits| {
                controller::control(pou, number, tasks.programs.len(), file, edits);
            });
        }
        if let Some(configuration) = survey.configuration {
            changes(configuration.name.span.file, &mut |file, edits| {
                configuration::attach(configuration, tasks, globals, file, edits);
            });
        }
        let each = self.given.iter().zip(self.sources.iter()).zip(edits);
        each.map(|((given, (_, file)), edits)| {
            let conflict = |conflict| InstrumentError::Conflict { file: given.name.clone(), conflict };
            let Edited { text, lines } = edits.apply(file.shown_text()).map_err(conflict)?;
            Ok(given.file(Some(text.into()), lines))
        })
        .collect()
    }

    /// Adds a file of the shim's own, or puts it in the place of the one that was given.
    fn add_own(&self, source: target::Source, files: &mut Vec<File>) {
        let is_it = |given: &&Given| Path::new(&given.name).file_name().is_some_and(|name| *name == *source.name);
        let text = Some(Arc::from(source.text));
        files.push(if let Some(given) = self.own.iter().find(is_it) {
            given.file(text, LineMap::default())
        } else {
            let folder = self.given.first().and_then(|first| Path::new(&first.name).parent());
            let name = folder.unwrap_or(Path::new("")).join(&source.name).display().to_string();
            File { name, before: None, text, encoding: None, lines: LineMap::default(), from: LineMap::default() }
        });
    }

    /// Tells TwinCAT projects of the shim's own files.
    fn list_own(&self, files: &mut Vec<File>) -> Result<(), InstrumentError> {
        let is_own = |file: &&File| file.text.is_some() && !self.given.iter().any(|given| given.name == file.name);
        let own: Vec<String> = files.iter().filter(is_own).map(|file| file.name.clone()).collect();
        for (given, plain) in &self.manifests {
            let conflict = |conflict| InstrumentError::Conflict { file: given.name.clone(), conflict };
            let Edited { text, lines } = twincat::listing(&given.name, plain, &own).apply(plain).map_err(conflict)?;
            files.push(given.file(Some(text.into()), lines));
        }
        Ok(())
    }

    /// Files of the shim's own that were given are to be deleted.
    fn delete_own(&self, files: &mut Vec<File>) {
        files.extend(self.own.iter().map(|given| given.file(None, LineMap::default())));
    }
}

impl Given {
    fn file(&self, text: Option<Arc<str>>, lines: LineMap) -> File {
        let from = lines.through(&self.plain_lines);
        File { name: self.name.clone(), before: Some(self.text.clone()), text, encoding: self.encoding, lines, from }
    }
}
