//! EN and ENO as a unit declares them (2nd ed. 2.5.1.2).

use super::Written;
use crate::check::types::parameter::{EN, ENO, is_control};
use crate::diagnostic::{Code, Diagnostic};
use crate::ir::{ElementaryType, Variable};
use crate::syntax::ast::SectionKind;

impl Written<'_, '_> {
    /// EN is a BOOL input and ENO a BOOL output; no other variable of a unit may bear the names.
    pub(super) fn check_control(&mut self, variable: &Variable) {
        let named = [EN, ENO].into_iter().any(|name| variable.name.eq_ignore_ascii_case(name));
        let shown = matches!(variable.section, SectionKind::Input | SectionKind::Output | SectionKind::InOut);
        if named && shown && !(is_control(variable) && variable.ty == ElementaryType::Bool.into()) {
            let message = format!("`{}` controls execution and is nothing else", variable.name);
            let found = Diagnostic::error(Code::InvalidEnable, variable.span, message);
            self.report(found.with_help("EN is a BOOL in VAR_INPUT, ENO a BOOL in VAR_OUTPUT"));
        }
    }
}
