//! What statements want, and how types meet: what goes where, and what stands beside what.

use super::collect::{Collector, Scope, elementary};
use super::names::Access;
use super::ty::{Slot, Ty};
use onescan_iec::ElementaryType;
use onescan_iec::syntax::ast::{Expr, ReferenceKind, Statement, StatementKind, UpdateOp};

impl<'a> Collector<'a> {
    pub(super) fn statements(&mut self, list: &[Statement], scope: &Scope<'a>) {
        for statement in list {
            self.statement(&statement.kind, scope);
        }
    }

    pub(super) fn condition(&mut self, expr: &Expr, scope: &Scope<'a>) {
        self.wanted(expr, &elementary(ElementaryType::Bool), scope);
    }

    /// An expression whose value goes to what is of a type.
    pub(super) fn wanted(&mut self, expr: &Expr, ty: &Ty, scope: &Scope<'a>) {
        let found = self.infer(expr, scope);
        self.flow(&found, ty);
    }

    fn statement(&mut self, kind: &StatementKind, scope: &Scope<'a>) {
        match kind {
            StatementKind::Assign(target, value)
            | StatementKind::Attempt(target, value)
            | StatementKind::Refer(target, value) => {
                let target = self.place(target, Access::Write, scope);
                self.wanted(value, &target, scope);
            }
            StatementKind::Chain(targets, value) => {
                let value = self.infer(value, scope);
                for target in targets {
                    let target = self.place(target, Access::Write, scope);
                    self.flow(&value, &target);
                }
            }
            StatementKind::Update(op, target, value) => {
                let target = self.place(target, Access::Write, scope);
                if matches!(op, UpdateOp::Set | UpdateOp::Reset) {
                    self.flow(&elementary(ElementaryType::Bool), &target);
                    self.condition(value, scope);
                } else {
                    self.wanted(value, &target, scope);
                }
            }
            StatementKind::SetReset(targets, value) => {
                for (_, target) in targets {
                    let target = self.place(target, Access::Write, scope);
                    self.flow(&elementary(ElementaryType::Bool), &target);
                }
                self.condition(value, scope);
            }
            StatementKind::Call(call) => {
                self.call(call, false, scope);
            }
            StatementKind::Value(value) => {
                self.infer(value, scope);
            }
            StatementKind::Try(inner) => {
                self.statements(&inner.body, scope);
                if let Some(code) = &inner.code {
                    let code = self.place(code, Access::Write, scope);
                    self.flow(&Ty::Integer, &code);
                }
                self.statements(&inner.handler, scope);
                self.statements(&inner.finally, scope);
            }
            StatementKind::If(inner) => {
                for branch in &inner.branches {
                    self.condition(&branch.condition, scope);
                    self.statements(&branch.body, scope);
                }
                self.statements(&inner.otherwise, scope);
            }
            StatementKind::Case(inner) => {
                let selector = self.infer(&inner.selector, scope);
                for branch in &inner.branches {
                    for label in &branch.labels {
                        for value in [Some(&label.low), label.high.as_ref()].into_iter().flatten() {
                            let label = self.place(value, Access::Constant, scope);
                            self.beside(&label, &selector);
                        }
                    }
                    self.statements(&branch.body, scope);
                }
                self.statements(&inner.otherwise, scope);
            }
            StatementKind::For(inner) => {
                let variable = self.place(&inner.variable, Access::Write, scope);
                self.flow(&Ty::Integer, &variable);
                for value in [Some(&inner.from), Some(&inner.to), inner.by.as_ref()].into_iter().flatten() {
                    self.wanted(value, &variable, scope);
                }
                self.statements(&inner.body, scope);
            }
            StatementKind::While(inner) => {
                self.condition(&inner.condition, scope);
                self.statements(&inner.body, scope);
            }
            StatementKind::Repeat(inner) => {
                self.statements(&inner.body, scope);
                self.condition(&inner.until, scope);
            }
            _ => {}
        }
    }

    /// A value of one type goes to what is of another.
    pub(super) fn flow(&mut self, from: &Ty, to: &Ty) {
        if from == to {
            return;
        }
        if let Ty::Slot(slot) = from {
            self.slots.taken(*slot, to);
        }
        if let Ty::Slot(slot) = to {
            self.slots.given(*slot, from);
        }
        if let (Ty::Pointer(_, from), Ty::Pointer(_, to)) | (Ty::Array(_, from), Ty::Array(_, to)) = (from, to) {
            self.beside(&from.clone(), &to.clone());
        }
        if let (Ty::Pointer(ReferenceKind::RefTo, from), Ty::Pointer(ReferenceKind::RefTo, to)) = (from, to) {
            // What one refers to is taken for what the other does; pointers of vendors ask for nothing.
            let (from, to) = (self.slots.resolved(from), self.slots.resolved(to));
            if from != to {
                self.stands_for(&from, &to);
            }
        }
        let (from, to) = (self.slots.resolved(from), self.slots.resolved(to));
        if from == to {
            return;
        }
        self.stands_for(&from, &to);
        if let Some(slot) = self.value_of(&from) {
            self.slots.taken(slot, &to);
        }
        if let Some(slot) = self.value_of(&to) {
            self.slots.given(slot, &from);
        }
    }

    /// Two values that are compared or joined.
    pub(super) fn beside(&mut self, one: &Ty, other: &Ty) {
        for (one, other) in [(one, other), (other, one)] {
            if let Ty::Slot(slot) = one {
                self.slots.beside(*slot, other);
            }
            let (one, other) = (self.slots.resolved(one), self.slots.resolved(other));
            if let Some(slot) = self.value_of(&one)
                && one != other
            {
                self.slots.beside(slot, &other);
            }
        }
    }

    fn value_of(&self, ty: &Ty) -> Option<Slot> {
        let Ty::Foreign(key) = ty else { return None };
        self.needs.types.get(key).and_then(|found| found.value)
    }
}
