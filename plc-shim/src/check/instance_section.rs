//! `VAR_INST` of methods: variables that their instance keeps (CODESYS, TwinCAT).

use std::collections::BTreeMap;

use super::Checker;
use super::initial::moved;
use super::types::Need;
use super::variables::Interface;
use crate::diagnostic::{Code, Diagnostic};
use crate::ir::{PouId, Storage, Variable};
use crate::syntax::Span;
use crate::syntax::ast::{self, Ident, PouKind, Section, SectionKind};

/// What one method keeps in the instances of its unit.
#[derive(Debug)]
pub(crate) struct Kept {
    /// The method's name.
    pub(crate) method: String,
    pub(crate) variables: Vec<Variable>,
}

impl Checker<'_> {
    /// What methods keep, by the unit whose instances they keep it in, those of its bases included.
    pub(super) fn kept_by_methods(&self) -> BTreeMap<PouId, Vec<Kept>> {
        let kept = self.classes.keys().map(|id| (*id, self.kept_in(*id)));
        kept.filter(|(_, kept)| !kept.is_empty()).collect()
    }

    fn kept_in(&self, unit: PouId) -> Vec<Kept> {
        let (mut found, mut next): (Vec<Kept>, _) = (Vec::new(), Some(unit));
        while let Some(class) = next.and_then(|id| self.class(id)) {
            for method in class.members.values() {
                let pou = self.pou(*method);
                let (name, hidden) =
                    (&pou.ast.name.text, |kept: &Kept| kept.method.eq_ignore_ascii_case(&pou.ast.name.text));
                let variables = pou.scope.iter().flat_map(|scope| &scope.variables);
                let own: Vec<_> = variables.filter(|each| each.section == SectionKind::Instance).cloned().collect();
                if !own.is_empty() && !found.iter().any(hidden) {
                    found.push(Kept { method: name.clone(), variables: own });
                }
            }
            next = class.base;
        }
        found
    }
}

impl<'a> Interface<'_, 'a> {
    /// Makes room for what the unit's methods keep. What is wrong with it, the methods report.
    pub(super) fn keep_for_methods(&mut self, ast: &'a ast::Pou) {
        let known = self.body.checker.diagnostics.len();
        let sections = ast.object.members.iter().flat_map(|member| &member.pou.sections);
        for section in sections.filter(|section| section.kind == SectionKind::Instance) {
            for variable in &section.variables {
                self.keep(variable);
            }
        }
        self.body.checker.diagnostics.truncate(known);
    }

    fn keep(&mut self, variable: &'a ast::Variable) -> Option<()> {
        let declared = self.body.declared(variable, Need::Size)?;
        for name in &variable.names {
            let offset = self.in_instance(&declared, name.span)?;
            self.starts.extend(moved(&declared.starts, offset));
            self.kept.insert(place_of(name.span), offset);
        }
        Some(())
    }

    /// Where a variable of a method's `VAR_INST` lies.
    pub(super) fn kept_storage(&mut self, section: &Section, name: &Ident) -> Option<Storage> {
        if self.kind != PouKind::Method {
            let message = "VAR_INST is for methods";
            let found = Diagnostic::error(Code::WrongSection, section.span, message);
            self.body.report(found.with_help("VAR of a function block is kept"));
            return None;
        }
        let owner = self.body.checker.owner_of(self.body.pou?);
        let offset = self.body.checker.pou(owner).kept.get(&place_of(name.span)).copied();
        if offset.is_none() {
            // Its declaration was found wrong, or memory ran out.
            let message = format!("`{}` cannot be kept in an instance", name.text);
            self.body.report(Diagnostic::error(Code::WrongSection, name.span, message));
        }
        offset.map(Storage::Instance)
    }
}

fn place_of(span: Span) -> (u32, u32) {
    (span.file.0, span.start)
}
