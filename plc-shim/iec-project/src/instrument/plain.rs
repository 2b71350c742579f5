//! A project as it is without the shim, and the changes that make it one with it.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::sync::Arc;

use onescan_base::TimeSpan;

use super::chart_plan::Plan as ChartPlan;
use super::marks::{self, Original};
use super::motion_use::Motion;
use super::survey::Survey;
use super::target::{self, Target};
use super::tasks::TaskTable;
use super::{
    File, Inputs, InstrumentError, Options, chart, configuration, controller, long_duration, scl, single, twincat,
};
use onescan_iec::diagnostic::{Code, Diagnostic, Diagnostics};
use onescan_iec::input::Input;
use onescan_iec::input::encoding::Encoding;
use onescan_iec::input::kind::{FileKind, SourceKind};
use onescan_iec::source::edits::{Edited, Edits, LineMap};
use onescan_iec::syntax::ast::{Ident, Pou};
use onescan_iec::syntax::{FileId, SourceFile, SourceMap, Span};
use onescan_iec::task_plan::Task;

/// A project without the shim.
pub(super) struct Plain {
    pub(super) sources: SourceMap,
    /// The same as their author has them, where `sources` has their program text alone or conversions in it.
    pub(super) original: Option<SourceMap>,
    /// Of each file in `sources` what it was when it was given.
    pub(super) given: Vec<Given>,
    /// What kind of file each of them is.
    pub(super) kinds: Vec<SourceKind>,
    /// The shim's own files that were given.
    own: Vec<Given>,
    /// TwinCAT projects, and what they are without the shim.
    manifests: Vec<(Given, Arc<str>)>,
    pub(super) findings: Vec<Diagnostic>,
    /// Names of files that hold what no task uses; those whose text is broken stay as they are.
    pub(super) left_out: BTreeSet<String>,
}

pub(super) struct Given {
    pub(super) name: String,
    text: Arc<str>,
    encoding: Option<Encoding>,
}

impl Plain {
    pub(super) fn of(inputs: &[Input]) -> Result<Self, InstrumentError> {
        let mut plain = Self {
            sources: SourceMap::default(),
            original: None,
            given: Vec::new(),
            kinds: Vec::new(),
            own: Vec::new(),
            manifests: Vec::new(),
            findings: Vec::new(),
            left_out: BTreeSet::new(),
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
        let given = Given { name: name.to_owned(), text: text.clone(), encoding: input.encoding() };
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
            Ok(Original::Text(plain)) => Input::from_text(name, kind, plain.text).read_like(input.file()),
            Err(damaged) => return self.damaged(name, text, &damaged),
        };
        self.given.push(given);
        self.findings.extend(plain.add_to(&mut self.sources).1);
        self.kinds.push(kind);
    }

    /// A file of the shim's own, if there is no other.
    pub(super) fn only_own(&self) -> Option<&str> {
        self.own.first().filter(|_| self.given.is_empty() && self.findings.is_empty()).map(|own| own.name.as_str())
    }

    /// True for program text alone, in the standard's language.
    pub(super) fn is_text(&self) -> bool {
        let is_scl = self.sources.iter().any(|(_, file)| scl::is_scl(file));
        !is_scl && self.kinds.iter().all(|kind| *kind == SourceKind::Text)
    }

    /// True for text that was taken out of an object of TwinCAT.
    pub(super) fn is_object(&self, place: Span) -> bool {
        self.kinds.get(place.file.0 as usize) == Some(&SourceKind::TwinCat)
    }

    /// True for an object of TwinCAT that no task uses.
    pub(super) fn may_stay(&self, id: FileId) -> bool {
        self.is_object(Span::new(id, 0, 0))
            && self.sources.get(id).is_some_and(|file| self.left_out.contains(file.name()))
    }

    /// A target that does not take the project's kind of file.
    pub(super) fn unsuited(&self, target: Target, survey: &Survey<'_>) -> Option<Diagnostic> {
        let scl = self.sources.iter().find(|(_, file)| scl::is_scl(file)).map(|(id, _)| id);
        let foreign = |pou: &&&Pou| self.sources.get(pou.name.span.file).is_some_and(|file| !scl::is_scl(file));
        let foreign = survey.programs.iter().find(foreign).map(|pou| pou.name.span);
        let message = match target {
            Target::Scl if scl.is_some() && foreign.is_some() => "beside SCL there are variables only, not programs",
            Target::Scl if scl.is_some() && self.has_xml() => "beside SCL there are variables only, not PLCopen XML",
            Target::Scl if scl.is_none() => {
                "the target scl takes program text, PLCopen XML or SCL sources of TIA Portal"
            }
            Target::OpenPlc | Target::Beremiz if !self.is_text() => "this target takes program text or PLCopen XML",
            Target::Iec | Target::TwinCat | Target::Codesys if scl.is_some() => "SCL sources take the target scl",
            Target::Codesys if !self.is_portable() => {
                "the target codesys takes program text or a project in PLCopen XML"
            }
            _ => return None,
        };
        let at = foreign.filter(|_| scl.is_some()).unwrap_or(Span::new(scl.unwrap_or(FileId(0)), 0, 0));
        let found = Diagnostic::error(Code::UnsupportedFeature, at, message);
        Some(found.with_help("export the project in that form, or choose another target"))
    }

    /// Inputs cannot be taken over in every form of a project.
    pub(super) fn without_inputs(&self, options: &Options) -> Option<Diagnostic> {
        let is_text = !self.has_xml() && !self.sources.iter().any(|(_, file)| scl::is_scl(file));
        let takes = matches!(options.target, Target::Iec | Target::TwinCat | Target::Codesys);
        if options.inputs == Inputs::Left || (is_text && takes) {
            return None;
        }
        let (message, help) = match options.target {
            Target::OpenPlc | Target::Beremiz => (
                "this target has an address for every signal",
                "give inputs addresses in %M or %Q in the scenario's mapping",
            ),
            _ => (
                "inputs are taken over in program text and TwinCAT objects, not in PLCopen XML or SCL",
                "export program text; in TIA Portal, copy tags of %I into a data block and read that",
            ),
        };
        let found = Diagnostic::error(Code::UnsupportedFeature, Span::new(FileId(0), 0, 0), message);
        Some(found.with_help(help))
    }

    fn damaged(&mut self, name: &str, text: &Arc<str>, damaged: &marks::DamagedMarks) {
        let id = self.sources.add(SourceFile::new(name, text.clone()));
        let span = Span::new(id, damaged.at.start, damaged.at.end);
        let found = Diagnostic::error(Code::DamagedMarks, span, damaged.message);
        let help = "take the file from before it was instrumented, or take the marks out by hand";
        self.findings.push(found.with_help(help));
    }

    pub(super) fn tasks(&self, survey: &Survey<'_>, options: &Options) -> Result<Vec<Task>, InstrumentError> {
        let wrong = |found| InstrumentError::Text(self.diagnostics(vec![found]));
        if let Some(tasks) = &options.tasks {
            single::refused_beside(&survey.configurations).map_or(Ok(()), |found| Err(wrong(found)))?;
            single::check_given(tasks, |name| survey.is_global(name), (options.target, self.has_xml()))?;
            return Ok(tasks.clone());
        }
        // A task of a library names a program that its users have.
        if survey.programs.is_empty() {
            return Err(InstrumentError::NoPrograms);
        }
        if !survey.configurations.is_empty() {
            if options.target != Target::Iec || self.has_xml() {
                self.refuse_singles(survey)?;
            }
            let parts = survey.configurations.iter().map(|part| configuration::tasks(part, &survey.constants));
            return Ok(parts.collect::<Result<Vec<_>, _>>().map_err(wrong)?.concat());
        }
        let scheduled = survey.programs.iter().filter(|program| !survey.called.contains(&program.name.key()));
        let scheduled: Vec<_> = scheduled.copied().collect();
        if scheduled.is_empty() {
            return Err(InstrumentError::NoPrograms);
        }
        if options.target == Target::Scl {
            return Ok(scl::tasks(&scheduled));
        }
        let programs = scheduled.iter().map(|program| program.name.text.clone()).collect();
        Ok(vec![Task {
            name: "main".to_owned(),
            interval: Some(TimeSpan::millis::<10>()),
            programs,
            ..Task::default()
        }])
    }

    /// Refuses tasks of a configuration that start at edges.
    pub(super) fn refuse_singles(&self, survey: &Survey<'_>) -> Result<(), InstrumentError> {
        let refused = |found| InstrumentError::Text(self.diagnostics(vec![found]));
        single::refused_elsewhere(&survey.configurations).map_or(Ok(()), |found| Err(refused(found)))
    }

    /// The project's files without the shim.
    pub(super) fn unchanged(&self) -> Vec<File> {
        let texts = self.original.as_ref().unwrap_or(&self.sources);
        let same = |(given, (_, file)): (&Given, (FileId, &SourceFile))| {
            let text = file.shown_text();
            given.file(Some(text.clone()), LineMap::same(text))
        };
        self.given.iter().zip(texts.iter()).map(same).collect()
    }

    /// The files of a project in program text or PLCopen XML, as they are translated.
    pub(super) fn texts(&self) -> impl Iterator<Item = Input> {
        let read = |(kind, (_, file)): (&SourceKind, (FileId, &SourceFile))| {
            Input::from_text(file.name(), *kind, file.shown_text().as_ref()).read_like(file)
        };
        self.kinds.iter().zip(self.sources.iter()).map(read)
    }

    /// Changes the texts that are translated; the files stay as they are. No change begins a line.
    pub(super) fn change(&mut self, mut edits: BTreeMap<FileId, Edits>) -> Result<(), InstrumentError> {
        let mut changed = SourceMap::default();
        for (id, file) in self.sources.iter() {
            let conflict = |conflict| InstrumentError::Conflict { file: file.name().to_owned(), conflict };
            changed.add(match edits.remove(&id) {
                Some(edits) => {
                    SourceFile::new(file.name(), edits.apply(file.text()).map_err(conflict)?.text).read_like(file)
                }
                None => file.clone(),
            });
        }
        let before = std::mem::replace(&mut self.sources, changed);
        self.original.get_or_insert(before);
        Ok(())
    }

    /// The project's files with their changes.
    pub(super) fn edited(
        &self,
        survey: &Survey<'_>,
        motion: &Motion,
        tasks: &TaskTable<'_>,
        globals: &str,
    ) -> Result<Vec<File>, InstrumentError> {
        self.refuse_drawn(survey, tasks)?;
        let changed = |id: FileId| {
            if self.is_xml(id) { self.edits_of_xml(id, survey, motion, tasks, globals) } else { Ok(Edits::default()) }
        };
        let mut edits: Vec<Edits> = self.sources.iter().map(|(id, _)| changed(id)).collect::<Result<_, _>>()?;
        let mut changes = |id: FileId, change: &mut dyn FnMut(&SourceFile, &mut Edits)| {
            // Those of PLCopen XML have been changed.
            let edits = edits.get_mut(id.0 as usize).filter(|_| !self.is_xml(id));
            if let (Some(file), Some(edits)) = (self.sources.get(id), edits) {
                change(file, edits);
            }
        };
        for (name, form) in &survey.renames {
            changes(name.span.file, &mut |file, edits| {
                rename(name, &form.new_name(), file, edits);
            });
        }
        for (name, new) in &motion.renames {
            changes(name.span.file, &mut |file, edits| rename(name, new, file, edits));
        }
        for span in &survey.long_durations {
            changes(span.file, &mut |file, edits| long_duration::convert(*span, file, edits));
        }
        for span in &survey.cuts {
            changes(span.file, &mut |file, edits| scl::cut(*span, file, edits));
        }
        for (id, _) in self.sources.iter() {
            changes(id, &mut |file, edits| survey.inputs.declare(id, file, tasks, edits));
        }
        let line = tasks.line_type();
        for pou in &survey.charts {
            let number = tasks.numbered().find(|(numbered, _)| std::ptr::eq(*numbered, *pou));
            let number = number.map(|(_, number)| (number, line.as_str()));
            changes(pou.name.span.file, &mut |file, edits| {
                chart::control(&ChartPlan::new(pou, number, &survey.renames, file), survey, edits);
            });
        }
        for (pou, number) in tasks.numbered().filter(|(pou, _)| pou.chart.is_empty()) {
            changes(pou.name.span.file, &mut |file, edits| {
                controller::control(pou, number, &line, survey.wanted(), file, edits);
            });
        }
        // Statements stand behind all declarations, those of controllers too.
        for (id, _) in self.sources.iter() {
            changes(id, &mut |file, edits| survey.inputs.assign(id, file, edits));
        }
        if let Some(first) = survey.configurations.first() {
            let is_object = self.is_object(first.name.span);
            let part =
                if is_object { twincat::first_task(&survey.configurations, &survey.constants) } else { Some(*first) };
            let Some(part) = part else { return Err(InstrumentError::NoPrograms) };
            changes(part.name.span.file, &mut |file, edits| {
                if is_object {
                    twincat::call_scheduler(file, edits);
                } else {
                    configuration::attach(part, tasks, globals, file, edits);
                }
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

    /// A controller stands in the body of a program or a chart, and there is no place for it in a drawing of TwinCAT.
    fn refuse_drawn(&self, survey: &Survey<'_>, tasks: &TaskTable<'_>) -> Result<(), InstrumentError> {
        let scheduled = tasks.numbered().map(|(pou, _)| pou);
        for pou in scheduled.chain(survey.charts.iter().copied()).filter(|pou| self.is_object(pou.name.span)) {
            let file = self.sources.get(pou.name.span.file);
            let Some(language) = file.and_then(twincat::drawn_in) else { continue };
            let name = &pou.name.text;
            let (message, help) = if pou.chart.is_empty() {
                let message =
                    format!("`{name}` is drawn in {language}, where the program of a task cannot be controlled");
                (message, "call it from a program in Structured Text, and let the task call that one")
            } else {
                let message = format!("`{name}` is drawn in {language}, where a chart cannot be controlled");
                (message, "write the chart in PLCopen XML, or as a CASE statement in Structured Text")
            };
            let found = Diagnostic::error(Code::UnsupportedFeature, pou.name.span, message).with_help(help);
            return Err(InstrumentError::Text(self.diagnostics(vec![found])));
        }
        Ok(())
    }

    /// Adds a file of the shim's own, or puts it in the place of the one that was given.
    pub(super) fn add_own(&self, source: target::Source, files: &mut Vec<File>) {
        let is_it = |given: &&Given| Path::new(&given.name).file_name().is_some_and(|name| *name == *source.name);
        let text = Some(Arc::from(source.text));
        files.push(if let Some(given) = self.own.iter().find(is_it) {
            given.file(text, LineMap::default())
        } else {
            let folder = self.given.first().and_then(|first| Path::new(&first.name).parent());
            let name = folder.unwrap_or(Path::new("")).join(&source.name).display().to_string();
            File { name, before: None, text, encoding: None, lines: LineMap::default() }
        });
    }

    /// Adds to TwinCAT projects the shim's own files.
    pub(super) fn list_own(&self, files: &mut Vec<File>) -> Result<(), InstrumentError> {
        let is_own = |file: &&File| file.text.is_some() && !self.given.iter().any(|given| given.name == file.name);
        let own: Vec<String> = files.iter().filter(is_own).map(|file| file.name.clone()).collect();
        for (given, plain) in &self.manifests {
            let conflict = |conflict| InstrumentError::Conflict { file: given.name.clone(), conflict };
            let Edited { text, lines } = twincat::listing(&given.name, plain, &own).apply(plain).map_err(conflict)?;
            files.push(given.file(Some(text.into()), lines));
        }
        Ok(())
    }

    /// Files of the shim's own that were given, and are none of the result, are to be deleted.
    pub(super) fn delete_stale(&self, files: &mut Vec<File>) {
        let is_stale = |given: &&Given| files.iter().all(|file| file.name != given.name);
        let stale: Vec<File> =
            self.own.iter().filter(is_stale).map(|given| given.file(None, LineMap::default())).collect();
        files.extend(stale);
    }

    /// Files of the shim's own that were given are to be deleted.
    pub(super) fn delete_own(&self, files: &mut Vec<File>) {
        files.extend(self.own.iter().map(|given| given.file(None, LineMap::default())));
    }
}

fn rename(name: &Ident, new: &str, file: &SourceFile, edits: &mut Edits) {
    if scl::is_scl(file) {
        return scl::rename(name, new, file, edits);
    }
    let at = file.shown_range(name.span.start, name.span.end);
    edits.replace(at, marks::renamed(new, &name.text));
}

impl Given {
    pub(super) fn file(&self, text: Option<Arc<str>>, lines: LineMap) -> File {
        File { name: self.name.clone(), before: Some(self.text.clone()), text, encoding: self.encoding, lines }
    }
}
