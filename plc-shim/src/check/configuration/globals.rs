//! Which resource sees which global variable (2nd ed. 2.7.1).

use std::collections::{BTreeMap, BTreeSet};

use crate::check::declare::declarations::Checker;
use crate::diagnostic::{Code, Diagnostic};
use crate::ir::{ElementaryType, Place, PouId, Statement, StatementKind, Storage, TypeId};
use crate::syntax::Span;

impl<'a> Checker<'a> {
    /// Lets every name with several declarations stand for the resource's own.
    pub(in crate::check) fn select_globals(&mut self, resource: Option<usize>, span: Span) -> Vec<Statement> {
        let names: Vec<(String, u32)> =
            self.configured.alternatives.iter().map(|(key, each)| (key.clone(), each.cell)).collect();
        let mut statements = Vec::new();
        for (name, cell) in names {
            let own = self.key_in(&name, resource).and_then(|key| self.global(&key, None));
            if let Some(own) = own {
                let pointer: TypeId = ElementaryType::Udint.into();
                let cell = Place::whole(Storage::Absolute(cell), pointer, span);
                let kind = StatementKind::Bind(cell, Place::whole(own.storage, own.ty, span));
                statements.push(Statement { kind, span });
            }
        }
        statements
    }

    /// Units that run in a resource use no global variable of another one.
    pub(in crate::check) fn report_foreign_globals(&mut self) {
        let uses = std::mem::take(&mut self.configured.uses);
        let mut found = BTreeMap::new();
        for program in self.programs.clone() {
            let reached = self.reached(program.pou);
            for (pou, key, span) in uses.iter().filter(|(pou, ..)| reached.contains(pou)) {
                if self.key_in(key, program.resource).is_none() && self.globals.contains_key(key) {
                    // One finding for a unit, where it uses the name first.
                    let first = found.entry((*pou, key.clone())).or_insert((*span, program.name.clone()));
                    first.0 = if span.start < first.0.start { *span } else { first.0 };
                }
            }
        }
        for ((_, key), (span, program)) in found {
            let Some(entry) = self.globals.get(&key) else { continue };
            let (name, declared) = (entry.name.clone(), entry.span);
            let message = format!("`{name}` belongs to another resource than `{program}`, which runs this");
            let found = Diagnostic::error(Code::ForeignGlobal, span, message).with_label(declared, "declared here");
            self.report(found.with_help("declare it in the configuration, outside of its resources"));
        }
    }

    /// A unit and all that it calls.
    fn reached(&self, start: PouId) -> BTreeSet<PouId> {
        let mut seen = BTreeSet::from([start]);
        let mut open = vec![start];
        while let Some(pou) = open.pop() {
            for (callee, _) in self.calls.get(&pou).into_iter().flatten() {
                if seen.insert(*callee) {
                    open.push(*callee);
                }
            }
        }
        seen
    }
}
