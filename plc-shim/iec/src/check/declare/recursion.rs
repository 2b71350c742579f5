//! Units do not call themselves, be it by way of others (2nd ed. 2.5). Vendors let methods and functions: as deep as
//! [`guard_circles`](Declarations::guard_circles) lets them.

use std::collections::BTreeSet;

use super::Declarations;
use crate::diagnostic::{Code, Diagnostic};
use crate::dialect::Feature;
use crate::ir::PouId;
use crate::syntax::Span;
use crate::syntax::ast::PouKind;

impl Declarations<'_> {
    /// Reports each call that closes a circle. Walks the calls depth first, with its own stack.
    pub(in crate::check) fn report_recursion(&mut self) {
        let mut done = BTreeSet::new();
        for root in self.queued() {
            self.walk(root, &mut done);
        }
    }

    /// True for a call that may lead back to its unit.
    fn may_recur(&self, called: PouId, at: Span) -> bool {
        let kind = self.pou(called).ast.kind;
        matches!(kind, PouKind::Function | PouKind::Method) && self.dialect(at).has(Feature::Recursion)
    }

    fn walk(&mut self, root: PouId, done: &mut BTreeSet<PouId>) {
        let mut path = vec![(root, 0_usize)];
        let mut on_path = BTreeSet::from([root]);
        while let Some((caller, next)) = path.last_mut() {
            let caller = *caller;
            let call = self.calls_of(caller).get(*next).copied();
            *next += 1;
            match call {
                None => {
                    path.pop();
                    on_path.remove(&caller);
                    done.insert(caller);
                }
                Some((next_unit, span)) if on_path.contains(&next_unit) => {
                    if self.may_recur(next_unit, span) {
                        continue;
                    }
                    let name = self.display_name(next_unit);
                    let message = format!("this call makes `{name}` call itself");
                    self.report(Diagnostic::error(Code::Recursion, span, message));
                }
                Some((next_unit, _)) if !done.contains(&next_unit) => {
                    path.push((next_unit, 0));
                    on_path.insert(next_unit);
                }
                Some(_) => {}
            }
        }
    }
}
