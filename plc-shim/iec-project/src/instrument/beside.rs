//! Files of PLCopen XML, alone or beside program text: which forms a project has, and where its author sees a place of
//! it.

use super::plain::Plain;
use super::plcopen;
use onescan_iec::diagnostic::{Diagnostic, Diagnostics};
use onescan_iec::input::kind::SourceKind;
use onescan_iec::syntax::ast::Configuration;
use onescan_iec::syntax::{FileId, SourceFile, SourceMap, Span};

impl Plain {
    /// True for a file of PLCopen XML.
    pub(super) fn is_xml(&self, id: FileId) -> bool {
        self.kinds.get(id.0 as usize) == Some(&SourceKind::PlcOpen)
    }

    /// True if one of the files is.
    pub(super) fn has_xml(&self) -> bool {
        self.kinds.contains(&SourceKind::PlcOpen)
    }

    /// True for a project that is one file of PLCopen XML, in which all of the shim has its place.
    pub(super) fn is_one_xml(&self) -> bool {
        self.kinds == [SourceKind::PlcOpen]
    }

    /// True for program text of the standard's language and PLCopen XML, of which a tool can be given another form.
    pub(super) fn is_portable(&self) -> bool {
        self.kinds.iter().all(|kind| matches!(kind, SourceKind::Text | SourceKind::PlcOpen))
            && !self.sources.iter().any(|(_, file)| super::scl::is_scl(file))
    }

    /// True for what a tool writes of its tasks beside the configurations that the standard has: it has no place for
    /// variables.
    pub(super) fn is_of_tool(&self, configuration: &Configuration) -> bool {
        let id = configuration.name.span.file;
        let file = self.sources.get(id).filter(|_| self.is_xml(id));
        let root = file.and_then(plcopen::tree);
        root.is_some_and(|root| plcopen::configuration(&root).is_none())
    }

    /// Takes the program text out of PLCopen XML, for a tool that takes text alone.
    pub(super) fn take_text(&mut self) {
        let mut texts = SourceMap::default();
        for (_, file) in self.sources.iter() {
            texts.add(SourceFile::new(file.name(), file.text().clone()).read_like(file));
        }
        self.original = Some(std::mem::replace(&mut self.sources, texts));
        self.kinds.fill(SourceKind::Text);
    }

    /// Findings at the places that the project's author knows.
    pub(super) fn diagnostics(&self, mut findings: Vec<Diagnostic>) -> Diagnostics {
        let Some(original) = &self.original else { return Diagnostics::new(findings, &self.sources) };
        let mut shown = SourceMap::default();
        for ((id, now), (_, before)) in self.sources.iter().zip(original.iter()) {
            if now.origin().is_some() || before.origin().is_none() {
                shown.add(now.clone());
                continue;
            }
            let spans = findings.iter_mut().flat_map(|found| {
                std::iter::once(&mut found.span).chain(found.labels.iter_mut().map(|label| &mut label.span))
            });
            for span in spans.filter(|span| span.file == id) {
                *span = unchanged(*span, now.text(), before.text());
            }
            shown.add(before.clone());
        }
        Diagnostics::new(findings, &shown)
    }
}

/// A place of a text in what the text was before conversions were written into it. None begins a line.
fn unchanged(span: Span, now: &str, before: &str) -> Span {
    if now == before {
        return span;
    }
    let before_it = now.get(..span.start as usize).unwrap_or("");
    let line = before_it.matches('\n').count();
    let column = before_it.len() - before_it.rfind('\n').map_or(0, |at| at + 1);
    let start = before.split_inclusive('\n').take(line).map(str::len).sum::<usize>();
    let length = before.get(start..).and_then(|rest| rest.lines().next()).map_or(0, str::len);
    let mut at = start + column.min(length);
    while !before.is_char_boundary(at) {
        at -= 1;
    }
    Span::new(span.file, at as u32, at as u32)
}
