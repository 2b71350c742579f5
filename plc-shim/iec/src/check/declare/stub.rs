//! W0710: calls of what is declared `{external}`, which does nothing here.

use std::collections::{BTreeMap, BTreeSet};

use super::Declarations;
use crate::diagnostic::{Code, Diagnostic};
use crate::ir::PouId;
use crate::syntax::Span;
use crate::syntax::ast::PouKind;

/// Where units without behaviour are called.
#[derive(Debug, Default)]
pub(super) struct Stubs {
    /// A trial may find a call a second time.
    uses: BTreeMap<PouId, BTreeSet<(u32, u32, u32)>>,
}

impl Declarations<'_> {
    /// True for what is declared `{external}`, and for all that belongs to it.
    pub(in crate::check) fn is_external(&self, id: PouId) -> bool {
        let unit = self.pou(id);
        unit.ast.external || unit.membership.is_some_and(|member| self.pou(member.owner).ast.external)
    }

    /// True for a stub and for what is derived from one: members that its interfaces want and that are not declared are
    /// where the stub's behaviour is.
    pub(in crate::check) fn rests_on_stub(&self, id: PouId) -> bool {
        self.with_bases(id).any(|id| self.pou(id).ast.external)
    }

    /// Notes a call if what is called has no behaviour.
    pub(in crate::check) fn note_stub(&mut self, callee: PouId, span: Span) {
        if !self.is_external(callee) || self.library.contains(&span.file) {
            return;
        }
        let unit = self.pou(callee);
        let owner = unit.membership.map_or(callee, |member| member.owner);
        // What an interface refers to has behaviour, or is a stub of its own.
        if self.pou(owner).ast.kind != PouKind::Interface {
            self.stubs.uses.entry(owner).or_default().insert((span.file.0, span.start, span.end));
        }
    }

    /// Reports each unit without behaviour once, where it is called first.
    pub(in crate::check) fn report_stubs(&mut self) {
        for (unit, uses) in std::mem::take(&mut self.stubs.uses) {
            let Some((file, start, end)) = uses.first().copied() else { continue };
            let (name, external) = (self.display_name(unit), self.pou(unit).ast.external);
            let count = match uses.len() {
                1 => String::new(),
                all => format!(" (first of {all} uses)"),
            };
            let what = if external { "is a stub" } else { "has stubs for members" };
            let message = format!("`{name}` {what}: its calls do nothing{count}");
            let span = Span::new(crate::syntax::FileId(file), start, end);
            let declared = self.pou(unit).ast.name.span;
            let found = Diagnostic::warning(Code::StubUsed, span, message).with_label(declared, "declared here");
            self.report(found.with_help("write what it does in place of the declaration behind `{external}`"));
        }
    }
}
