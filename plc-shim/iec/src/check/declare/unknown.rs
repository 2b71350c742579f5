//! What is unknown because a declaration before it is wrong: that has been reported, and what follows from it is not.

use super::Declarations;
use super::class::Role;
use crate::ir::{PouId, TypeId};
use crate::syntax::ast::PouKind;

impl Declarations<'_> {
    /// True if a unit may have members that nobody knows: it, or what it is derived from, extends what is not there.
    pub(in crate::check) fn may_inherit(&self, id: PouId) -> bool {
        let lacks = |id: PouId| self.class(id).is_some_and(|class| class.lacks_base);
        // An interface has the members of all interfaces above it, a unit only those of its bases.
        if self.pou(id).ast.kind == PouKind::Interface {
            return lacks(id) || self.ancestors(id).into_iter().any(lacks);
        }
        self.with_bases(self.owner_of(id)).any(lacks)
    }

    /// True if a unit may be something else, too: what it extends or implements is not there.
    pub(in crate::check) fn may_be_more(&self, id: PouId) -> bool {
        let lacks = |id: PouId| self.class(id).is_some_and(|class| class.lacks_base || class.lacks_interface);
        lacks(id) || self.ancestors(id).into_iter().any(lacks)
    }

    /// True if a unit gives a result whose declaration is wrong.
    pub(in crate::check) fn lacks_result(&self, id: PouId) -> bool {
        let pou = self.pou(id);
        let sets = pou.membership.is_some_and(|membership| membership.role == Role::Setter);
        let known = pou.scope.as_ref().is_none_or(|scope| scope.result().is_some());
        pou.ast.result.is_some() && !sets && !known
    }

    /// True for a structure that references know, and that could not be made.
    pub(in crate::check) fn is_unmade(&self, ty: TypeId) -> bool {
        self.unmade.contains(&ty)
    }
}
