//! Names with a namespace in front (3rd ed. 6.9).

use crate::check::body::Body;
use crate::check::declare::namespace::{STANDARD_LIBRARIES, joined};
use crate::syntax::ast::{self, Ident};

impl Body<'_, '_> {
    /// `a.b.c` as one name, if it begins with a namespace and not with a variable.
    pub(in crate::check) fn qualified_name(&self, expr: &ast::Expr) -> Option<Ident> {
        let ast::ExprKind::Member(base, last) = &expr.kind else { return None };
        let first = match &base.kind {
            ast::ExprKind::Name(name) if !self.scope.declares(&name.key()) => name.clone(),
            _ => self.qualified_name(base)?,
        };
        let text = format!("{}.{}", first.text, last.text);
        let found = Ident { text, span: first.span.to(last.span) };
        self.is_in_namespace(&found.key()).then_some(found)
    }

    /// True for the first name of a namespace that no variable hides.
    pub(in crate::check) fn is_namespace(&self, name: &Ident) -> bool {
        let key = name.key();
        !self.scope.declares(&key) && self.checker.global_key(&key).is_none() && self.is_in_namespace(&key)
    }

    /// True if `key` names a namespace, or something in one.
    fn is_in_namespace(&self, key: &str) -> bool {
        let checker = &self.checker;
        let known = |key: &str| {
            let mut around = checker.home.namespace.as_str();
            loop {
                if checker.namespaces.contains_key(&joined(around, key)) {
                    return true;
                }
                if around.is_empty() {
                    return checker.home.using.iter().any(|each| checker.namespaces.contains_key(&joined(each, key)));
                }
                around = around.rsplit_once('.').map_or("", |(outer, _)| outer);
            }
        };
        let library = key.split_once('.').is_some_and(|(first, _)| STANDARD_LIBRARIES.contains(&first));
        library || key.match_indices('.').any(|(at, _)| known(&key[..at])) || known(key)
    }
}
