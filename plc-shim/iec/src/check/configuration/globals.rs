//! Which resource sees which global variable (2nd ed. 2.7.1).

use std::collections::BTreeMap;

use super::Configurer;
use crate::diagnostic::{Code, Diagnostic};
use crate::ir::{ElementaryType, Place, Statement, StatementKind, Storage, TypeId};
use crate::syntax::Span;

impl Configurer<'_, '_> {
    /// Lets every name with several declarations stand for the resource's own.
    pub(super) fn select_globals(&mut self, resource: Option<usize>, span: Span) -> Vec<Statement> {
        let names = self.declarations.alternatives();
        let mut statements = Vec::new();
        for (name, cell) in names {
            let own = self.declarations.key_in(&name, resource).and_then(|key| self.declarations.global(&key, None));
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
    pub(super) fn report_foreign_globals(&mut self) {
        let uses = self.declarations.global_uses().to_vec();
        let mut found = BTreeMap::new();
        for program in self.declarations.programs().to_vec() {
            let reached = self.declarations.reached_from(program.pou);
            for (pou, key, span) in uses.iter().filter(|(pou, ..)| reached.contains(pou)) {
                if self.declarations.key_in(key, program.resource).is_none()
                    && self.declarations.global_declared(key).is_some()
                {
                    // One finding for a unit, where it uses the name first.
                    let first = found.entry((*pou, key.clone())).or_insert((*span, program.name.clone()));
                    first.0 = if span.start < first.0.start { *span } else { first.0 };
                }
            }
        }
        for ((_, key), (span, program)) in found {
            let Some((name, declared)) = self.declarations.global_declared(&key) else { continue };
            let message = format!("`{name}` belongs to another resource than `{program}`, which runs this");
            let found = Diagnostic::error(Code::ForeignGlobal, span, message).with_label(declared, "declared here");
            self.declarations.report(found.with_help("declare it in the configuration, outside of its resources"));
        }
    }
}
