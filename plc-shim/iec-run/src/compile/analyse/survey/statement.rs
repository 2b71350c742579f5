//! Statements, and what is around the turns of loops.

use super::Walk;
use crate::compile::analyse::choice::Choice;
use crate::compile::analyse::drift::step_of;
use crate::compile::analyse::price;
use onescan_iec::ir::{CaseStatement, Expr, ForStatement, IfBranch, Labelled, Place, Statement, StatementKind};

impl Walk<'_, '_> {
    pub(super) fn statements(&mut self, list: &[Statement]) {
        for statement in list {
            self.statement(&statement.kind);
        }
    }

    pub(super) fn statement(&mut self, kind: &StatementKind) {
        match kind {
            StatementKind::Assign(target, value) => self.assign(target, value),
            StatementKind::Copy(target, source) => {
                self.full_address(target);
                self.expression(source);
                self.charge(price::COPY);
                self.changed(self.scope.extent(target));
            }
            StatementKind::Bind(pointer, place) => self.store(pointer, |walk| walk.full_address(place)),
            StatementKind::Initialise(place, _) => {
                self.full_address(place);
                self.charge(price::COPY);
                self.changed(self.scope.extent(place));
            }
            StatementKind::Evaluate(expr) => self.expression(expr),
            StatementKind::CallInstance(call) => self.call_instance(call),
            StatementKind::If(branches, otherwise) => self.if_statement(branches, otherwise),
            StatementKind::Case(inner) => self.case_statement(inner),
            StatementKind::For(inner) => self.for_statement(inner),
            StatementKind::While(condition, body) => {
                self.metered = true;
                self.charge(price::PAYMENT);
                self.expression(condition);
                self.turn(body);
            }
            StatementKind::Repeat(body, until) => {
                self.metered = true;
                self.charge(price::PAYMENT);
                self.turn(body);
                self.expression(until);
            }
            StatementKind::Labelled(inner) if inner.register.is_some() => {
                self.metered = true;
                self.charge(price::PAYMENT);
                self.parts(inner);
            }
            StatementKind::Labelled(inner) => self.parts_once(inner),
            StatementKind::Try(tried) => {
                self.metered = true;
                self.charge(price::TRY.saturating_add(u64::from(tried.outcome.0)));
                self.changed(None);
                self.set(self.scope.register(tried.outcome));
            }
            StatementKind::Exit | StatementKind::Continue | StatementKind::Return | StatementKind::Jump(_) => {
                self.charge(1);
                self.leaves = true;
            }
            StatementKind::Pass => {}
        }
    }

    pub(super) fn assign(&mut self, target: &Place, value: &Expr) {
        if let Some((slot, ty, by)) = step_of(&self.scope, target, value) {
            self.effects.steps_mut().note(slot, ty, by);
        }
        self.store(target, |walk| walk.settled(value));
    }

    pub(super) fn if_statement(&mut self, branches: &[IfBranch], otherwise: &[Statement]) {
        if !self.program.has_whole_branches()
            && let Some(Choice { target, condition, first, second }) = Choice::of(&self.scope, branches, otherwise)
        {
            self.store(target, |walk| {
                for expr in [first, second, condition] {
                    walk.expression(expr);
                }
                walk.charge(1);
            });
            return;
        }
        self.charge(2);
        for branch in branches {
            self.expression(&branch.condition);
            self.charge(price::BRANCH);
            self.scope.open_branch(&branch.body);
            self.statements(&branch.body);
            self.scope.close_branch(&branch.body);
        }
        self.statements(otherwise);
    }

    pub(super) fn case_statement(&mut self, inner: &CaseStatement) {
        self.expression(&inner.selector);
        self.set(self.scope.register(inner.register));
        let labels = inner.arms.iter().map(|arm| arm.labels.len() as u64).sum();
        self.charge(price::case(inner.arms.len() as u64, labels));
        for arm in &inner.arms {
            self.statements(&arm.body);
        }
        self.statements(&inner.otherwise);
    }

    pub(super) fn for_statement(&mut self, inner: &ForStatement) {
        // It may turn out to end soon and not to pay, but what is around it pays for its turns then.
        self.metered = true;
        for (expr, local) in [(&inner.to, inner.last), (&inner.by, inner.step)] {
            self.expression(expr);
            self.set(self.scope.register(local));
        }
        self.store(&inner.variable, |walk| walk.expression(&inner.from));
        self.turns(inner);
    }

    pub(super) fn turns(&mut self, inner: &ForStatement) {
        self.charge(price::FOR);
        self.load(&inner.variable);
        self.turn(&inner.body);
        self.load(&inner.variable);
        self.load(&inner.variable);
        self.store(&inner.variable, |walk| walk.load(&inner.variable));
    }

    pub(super) fn turn(&mut self, body: &[Statement]) {
        self.charge(price::TURN);
        self.effects.steps_mut().open_turn();
        self.statements(body);
        self.effects.steps_mut().close_turn();
    }

    pub(super) fn parts(&mut self, inner: &Labelled) {
        self.effects.steps_mut().open_turn();
        self.parts_once(inner);
        self.effects.steps_mut().close_turn();
    }

    pub(super) fn parts_once(&mut self, inner: &Labelled) {
        if let Some(local) = inner.register {
            self.set(self.scope.register(local));
        }
        self.charge(price::BRANCH * (1 + inner.parts.len() as u64));
        self.statements(&inner.first);
        for (_, part) in &inner.parts {
            self.statements(part);
        }
    }
}
