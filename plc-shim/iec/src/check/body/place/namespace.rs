//! Names with a namespace in front (3rd ed. 6.9).

use crate::check::body::Body;
use crate::syntax::ast::{self, Ident};

impl Body<'_, '_> {
    /// `a.b.c` as one name, if it begins with a namespace and not with a variable.
    pub(in crate::check) fn qualified_name(&self, expr: &ast::Expr) -> Option<Ident> {
        let ast::ExprKind::Member(base, last) = &expr.kind else { return None };
        let first = match &base.kind {
            ast::ExprKind::Name(name) if name.is_global() || !self.scope.declares(&name.key()) => name.clone(),
            // What a variable or a program of a namespace has are members.
            _ => self.qualified_name(base).filter(|name| !self.is_global(name))?,
        };
        if first.text.contains('.') && self.is_global(&first) {
            return None;
        }
        let text = format!("{}.{}", first.text, last.text);
        let found = Ident { text, span: first.span.to(last.span) };
        self.declarations.is_in_namespace(&found.key()).then_some(found)
    }

    /// True for a global variable, and for a program, which vendors take for its instance.
    pub(in crate::check::body) fn is_global(&self, name: &Ident) -> bool {
        let key = name.key();
        self.declarations.global_key(&key).is_some() || self.declarations.program_of_name(&key).is_some()
    }

    /// True for the first name of a namespace that no variable hides.
    pub(in crate::check::body) fn is_namespace(&self, name: &Ident) -> bool {
        let key = name.key();
        !self.scope.declares(&key)
            && self.declarations.global_key(&key).is_none()
            && self.declarations.is_in_namespace(&key)
    }
}
