//! A file of PLCopen XML with its changes: with all that is the shim's if it is the whole project.

use onescan_xml::Element;

use super::chart_plan::Plan as ChartPlan;
use super::motion_use::Motion;
use super::plain::Plain;
use super::sources::Sources;
use super::survey::Survey;
use super::tasks::TaskTable;
use super::{File, InstrumentError, clock, plcopen, plcopen_chart};
use onescan_iec::diagnostic::{Code, Diagnostic};
use onescan_iec::source::edits::{Edited, Edits};
use onescan_iec::syntax::ast::Pou;
use onescan_iec::syntax::{FileId, SourceFile, Span};

impl Plain {
    /// The project's only file with its changes and all that is the shim's.
    pub(super) fn edited_xml(
        &self,
        survey: &Survey<'_>,
        motion: &Motion,
        tasks: &TaskTable<'_>,
        sources: &Sources,
    ) -> Result<File, InstrumentError> {
        let only = FileId(0);
        let (Some(given), Some(file)) = (self.given.first(), self.sources.get(only)) else {
            return Err(InstrumentError::NoPrograms);
        };
        let root = self.tree(only, file)?;
        let mut edits = self.controlled(only, (file, &root), survey, motion, tasks)?;
        plcopen::attach(&root, file.shown_text(), tasks, sources, &mut edits)
            .map_err(|message| self.refused(Span::new(only, 0, 0), message))?;
        let conflict = |conflict| InstrumentError::Conflict { file: given.name.clone(), conflict };
        let Edited { text, lines } = edits.apply(file.shown_text()).map_err(conflict)?;
        Ok(given.file(Some(text.into()), lines))
    }

    /// The changes of a file beside which the shim's own stand: its programs, its charts, its configuration.
    pub(super) fn edits_of_xml(
        &self,
        id: FileId,
        survey: &Survey<'_>,
        motion: &Motion,
        tasks: &TaskTable<'_>,
        globals: &str,
    ) -> Result<Edits, InstrumentError> {
        let Some(file) = self.sources.get(id) else { return Err(InstrumentError::NoPrograms) };
        let root = self.tree(id, file)?;
        let mut edits = self.controlled(id, (file, &root), survey, motion, tasks)?;
        let is_here = survey.configurations.first().is_some_and(|first| first.name.span.file == id);
        if let Some(configuration) = plcopen::configuration(&root).filter(|_| is_here) {
            plcopen::configure(configuration, file.shown_text(), tasks, globals, &mut edits)
                .map_err(|message| self.refused(Span::new(id, 0, 0), message))?;
        }
        Ok(edits)
    }

    fn tree(&self, id: FileId, file: &SourceFile) -> Result<Element, InstrumentError> {
        plcopen::tree(file).ok_or_else(|| self.refused(Span::new(id, 0, 0), "this is not XML"))
    }

    /// Programs and charts on virtual time.
    fn controlled(
        &self,
        id: FileId,
        (file, root): (&SourceFile, &Element),
        survey: &Survey<'_>,
        motion: &Motion,
        tasks: &TaskTable<'_>,
    ) -> Result<Edits, InstrumentError> {
        let mut edits = Edits::default();
        let line = tasks.line_type();
        rename(survey, motion, (id, file, root), &mut edits);
        plcopen::cut_plain_text(root, file.shown_text(), &mut edits);
        let is_here = |pou: &Pou| pou.name.span.file == id;
        for (pou, number) in tasks.numbered().filter(|(pou, _)| is_here(pou) && pou.chart.is_empty()) {
            plcopen::control(pou, number, &line, (file, root), &mut edits)
                .map_err(|message| self.refused(pou.name.span, message))?;
        }
        for pou in survey.charts.iter().filter(|pou| is_here(pou)) {
            let number = tasks.numbered().find(|(numbered, _)| std::ptr::eq(*numbered, *pou));
            let number = number.map(|(_, number)| (number, line.as_str()));
            let element = plcopen::element(pou, root).map_err(|message| self.refused(pou.name.span, message))?;
            let plan = ChartPlan::new(pou, number, &survey.renames, file);
            plcopen_chart::control(&plan, element, &mut edits)
                .map_err(|(span, message)| self.refused(span, message))?;
        }
        Ok(edits)
    }

    fn refused(&self, span: Span, message: &str) -> InstrumentError {
        let found = Diagnostic::error(Code::UnsupportedFeature, span, message);
        InstrumentError::Text(self.diagnostics(vec![found]))
    }
}

/// What reads the clock gets the names of the shim, in interfaces, text and blocks.
fn rename(survey: &Survey<'_>, motion: &Motion, (id, file, root): (FileId, &SourceFile, &Element), edits: &mut Edits) {
    let clocks = survey.renames.iter().map(|(name, form)| (name, form.new_name()));
    let names = clocks.chain(motion.renames.iter().map(|(name, new)| (name, new.clone())));
    for (name, new) in names.filter(|(name, _)| name.span.file == id) {
        plcopen::rename(file, name.span.start..name.span.end, &name.text, &new, edits);
    }
    let new = |name: &str| {
        if survey.is_declared(name) {
            return None;
        }
        clock::replacement(name).or_else(|| motion.replacement(name))
    };
    plcopen::rename_blocks(root, file.shown_text(), &new, edits);
}
