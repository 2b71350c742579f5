//! A project in PLCopen XML as a whole: one file, with its changes and all that is the shim's.

use onescan_xml::Element;

use super::chart_plan::Plan as ChartPlan;
use super::motion_use::Motion;
use super::plain::Plain;
use super::sources::Sources;
use super::survey::Survey;
use super::tasks::TaskTable;
use super::{File, InstrumentError, clock, plcopen, plcopen_chart};
use onescan_iec::diagnostic::{Code, Diagnostic, Diagnostics};
use onescan_iec::source::edits::{Edited, Edits};
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
        let whole = Span::new(FileId(0), 0, 0);
        let (Some(given), Some(file)) = (self.given.first(), self.sources.get(FileId(0))) else {
            return Err(InstrumentError::NoPrograms);
        };
        let root = plcopen::tree(file).ok_or_else(|| self.refused(whole, "this is not XML"))?;
        let mut edits = Edits::default();
        let line = tasks.line_type();
        rename(survey, motion, file, &root, &mut edits);
        plcopen::cut_plain_text(&root, file.shown_text(), &mut edits);
        for (pou, number) in tasks.numbered().filter(|(pou, _)| pou.chart.is_empty()) {
            plcopen::control(pou, number, &line, (file, &root), &mut edits)
                .map_err(|message| self.refused(pou.name.span, message))?;
        }
        for pou in &survey.charts {
            let number = tasks.numbered().find(|(numbered, _)| std::ptr::eq(*numbered, *pou));
            let number = number.map(|(_, number)| (number, line.as_str()));
            let element = plcopen::element(pou, &root).map_err(|message| self.refused(pou.name.span, message))?;
            let plan = ChartPlan::new(pou, number, &survey.renames, file);
            plcopen_chart::control(&plan, element, &mut edits)
                .map_err(|(span, message)| self.refused(span, message))?;
        }
        plcopen::attach(&root, file.shown_text(), tasks, sources, &mut edits)
            .map_err(|message| self.refused(whole, message))?;
        let conflict = |conflict| InstrumentError::Conflict { file: given.name.clone(), conflict };
        let Edited { text, lines } = edits.apply(file.shown_text()).map_err(conflict)?;
        Ok(given.file(Some(text.into()), lines))
    }

    fn refused(&self, span: Span, message: &str) -> InstrumentError {
        let found = Diagnostic::error(Code::UnsupportedFeature, span, message);
        InstrumentError::Text(Diagnostics::new(vec![found], &self.sources))
    }
}

/// What reads the clock gets the names of the shim, in interfaces, text and blocks.
fn rename(survey: &Survey<'_>, motion: &Motion, file: &SourceFile, root: &Element, edits: &mut Edits) {
    let clocks = survey.renames.iter().map(|(name, form)| (name, form.new_name()));
    for (name, new) in clocks.chain(motion.renames.iter().map(|(name, new)| (name, new.clone()))) {
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
