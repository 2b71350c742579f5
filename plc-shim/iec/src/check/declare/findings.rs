//! What is wrong with the text, in the order in which it was found.

use std::collections::{BTreeMap, BTreeSet};

use super::Declarations;
use super::class::Occasion;
use crate::diagnostic::{Code, Diagnostic};
use crate::ir::PouId;
use crate::syntax::Span;
use crate::syntax::ast::Ident;

/// All findings so far, and what has been reported that is found more than once.
#[derive(Debug, Default)]
pub(super) struct Findings {
    diagnostics: Vec<Diagnostic>,
    /// Where something was wrong already, and when.
    faulty_starts: BTreeSet<(u32, u32, Occasion)>,
    /// Methods `FB_init` that do not suit those of their bases.
    faulty_hooks: BTreeSet<PouId>,
    /// Names that are not declared, by the unit that uses them: which finding says so.
    unknown: BTreeMap<(Option<PouId>, Code, String), (usize, Span)>,
}

impl Findings {
    /// True if something of the code has been found.
    pub(super) fn has(&self, code: Code) -> bool {
        self.diagnostics.iter().any(|found| found.code == code)
    }

    /// Says more with the first finding of the code.
    pub(super) fn set_help(&mut self, code: Code, help: &str) {
        if let Some(found) = self.diagnostics.iter_mut().find(|found| found.code == code) {
            found.help = Some(help.to_owned());
        }
    }

    pub(super) fn into_list(self) -> Vec<Diagnostic> {
        self.diagnostics
    }

    /// Leaves out what has been reported of another block that is made of the same text.
    pub(super) fn leave_out_repeated(&mut self) {
        let mut known = BTreeSet::new();
        self.diagnostics.retain(|found| {
            known.insert((found.span.file, found.span.start, found.span.end, found.code, found.message.clone()))
        });
    }
}

/// How much had been found at some point: later findings can be taken back.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::check) struct Mark(usize);

impl Declarations<'_> {
    pub(in crate::check) fn report(&mut self, diagnostic: Diagnostic) {
        self.findings.diagnostics.push(diagnostic);
    }

    /// Reports a name that is not declared, once for each unit that uses it.
    pub(in crate::check) fn report_name(&mut self, unit: Option<PouId>, name: &Ident, found: Diagnostic) {
        let place = (self.findings.diagnostics.len(), found.span);
        // In SCL `"x"` is another name than `x`.
        let slot = (unit, found.code, name.text.to_ascii_uppercase());
        if let Some((index, span)) = self.findings.unknown.get(&slot) {
            // One that was taken back reports nothing.
            let reported = self.findings.diagnostics.get(*index);
            if reported.is_some_and(|reported| reported.span == *span && reported.code == found.code) {
                return;
            }
        }
        self.findings.unknown.insert(slot, place);
        self.report(found);
    }

    pub(in crate::check) fn mark(&self) -> Mark {
        Mark(self.findings.diagnostics.len())
    }

    /// True if something has been found since.
    pub(in crate::check) fn has_found_since(&self, mark: Mark) -> bool {
        self.findings.diagnostics.len() > mark.0
    }

    /// What has been found since.
    pub(in crate::check) fn found_since(&self, mark: Mark) -> &[Diagnostic] {
        self.findings.diagnostics.get(mark.0..).unwrap_or_default()
    }

    /// Takes back what has been found since: a trial, or what is reported elsewhere.
    pub(in crate::check) fn forget_since(&mut self, mark: Mark) {
        self.findings.diagnostics.truncate(mark.0);
    }

    /// Forgets what has been found since of quotients that lose their fraction.
    pub(in crate::check) fn forget_lost_fractions(&mut self, mark: Mark) {
        let mut since = self.findings.diagnostics.split_off(mark.0.min(self.findings.diagnostics.len()));
        since.retain(|found| found.code != Code::LostFraction);
        self.findings.diagnostics.append(&mut since);
    }

    /// True for the first fault in what is done at `span` at an occasion. A type's text is gone through for each
    /// variable of it, and is reported once.
    pub(in crate::check) fn is_first_fault(&mut self, span: Span, occasion: Occasion) -> bool {
        self.findings.faulty_starts.insert((span.file.0, span.start, occasion))
    }

    /// True for the first fault of an `FB_init`, however many instances there are.
    pub(in crate::check) fn is_first_hook_fault(&mut self, hook: PouId) -> bool {
        self.findings.faulty_hooks.insert(hook)
    }
}
