//! `VAR_INST` of methods: variables that their instance keeps (CODESYS, TwinCAT).

use super::interface::Interface;
use crate::check::declare::{Need, moved, place_of};
use crate::diagnostic::{Code, Diagnostic};
use crate::ir::Storage;
use crate::syntax::ast::{self, Ident, PouKind, Section, SectionKind};

impl<'a> Interface<'_, 'a> {
    /// Makes room for what the unit's methods keep. What is wrong with it, the methods report.
    pub(super) fn keep_for_methods(&mut self, ast: &'a ast::Pou) {
        let known = self.declarations().mark();
        let sections = ast.object.members.iter().flat_map(|member| &member.pou.sections);
        for section in sections.filter(|section| section.kind == SectionKind::Instance) {
            for variable in &section.variables {
                self.keep(variable);
            }
        }
        self.declarations_mut().forget_since(known);
    }

    fn keep(&mut self, variable: &'a ast::Variable) -> Option<()> {
        let declared = self.written().declared(variable, Need::Size)?;
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
            self.report(found.with_help("VAR of a function block is kept"));
            return None;
        }
        let owner = self.declarations().owner_of(self.unit()?);
        let offset = self.declarations().pou(owner).kept(name.span);
        if offset.is_none() {
            // Its declaration was found wrong, or memory ran out.
            let message = format!("`{}` cannot be kept in an instance", name.text);
            self.report(Diagnostic::error(Code::WrongSection, name.span, message));
        }
        offset.map(Storage::Instance)
    }
}
