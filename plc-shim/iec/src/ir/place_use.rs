//! What statements do with places of memory.

use super::expr::{Argument, Expr, ExprKind, FunctionCall, LocalId, Place, Step, Storage};
use super::statement::{InstanceCall, Statement, StatementKind};
use super::types::TypeTable;

/// What is done with a place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PlaceUse {
    Read,
    Write,
    /// Something else gets its address, and may read and write it later.
    Share,
}

/// Calls `each` for every place that the statements read, write or share, those inside of them too. What a call
/// gives an instance is given as a part of that instance.
pub fn place_uses<'a>(statements: &'a [Statement], types: &'a TypeTable, each: &'a mut dyn FnMut(&Place, PlaceUse)) {
    Walk { types, each, open: Vec::new() }.statements(statements);
}

struct Walk<'a> {
    types: &'a TypeTable,
    each: &'a mut dyn FnMut(&Place, PlaceUse),
    /// The instances that are being called, by the register that holds their address.
    open: Vec<(LocalId, Place)>,
}

impl Walk<'_> {
    fn statements(&mut self, statements: &[Statement]) {
        for statement in statements {
            self.statement(&statement.kind);
        }
    }

    fn statement(&mut self, statement: &StatementKind) {
        match statement {
            StatementKind::Assign(target, value) | StatementKind::Copy(target, value) => {
                self.place(target, PlaceUse::Write);
                self.expression(value);
            }
            StatementKind::Bind(target, shared) => {
                self.place(target, PlaceUse::Write);
                self.place(shared, PlaceUse::Share);
            }
            StatementKind::Initialise(target, _) => self.place(target, PlaceUse::Write),
            StatementKind::Evaluate(value) => self.expression(value),
            StatementKind::CallInstance(call) => self.instance(call),
            StatementKind::If(branches, otherwise) => {
                for branch in branches {
                    self.expression(&branch.condition);
                    self.statements(&branch.body);
                }
                self.statements(otherwise);
            }
            StatementKind::Case(case) => {
                self.expression(&case.selector);
                case.arms.iter().for_each(|arm| self.statements(&arm.body));
                self.statements(&case.otherwise);
            }
            StatementKind::For(turns) => {
                self.place(&turns.variable, PlaceUse::Write);
                for value in [&turns.from, &turns.to, &turns.by] {
                    self.expression(value);
                }
                self.statements(&turns.body);
            }
            StatementKind::While(condition, body) | StatementKind::Repeat(body, condition) => {
                self.expression(condition);
                self.statements(body);
            }
            StatementKind::Labelled(labelled) => {
                self.statements(&labelled.first);
                labelled.parts.iter().for_each(|(_, part)| self.statements(part));
            }
            StatementKind::Try(tried) => self.statements(&tried.body),
            StatementKind::Exit
            | StatementKind::Continue
            | StatementKind::Return
            | StatementKind::Jump(_)
            | StatementKind::Pass => {}
        }
    }

    fn instance(&mut self, call: &InstanceCall) {
        self.place(&call.instance, PlaceUse::Read);
        self.open.push((call.pointer, call.instance.clone()));
        self.statements(&call.inputs);
        self.statements(&call.outputs);
        self.open.pop();
    }

    fn expression(&mut self, expr: &Expr) {
        match &expr.kind {
            ExprKind::Constant(_) => {}
            ExprKind::Load(place) => self.place(place, PlaceUse::Read),
            // The address of an aggregate is how its value is taken; one that is a value goes elsewhere.
            ExprKind::Address(place) if self.types.elementary(expr.ty).is_none() => self.place(place, PlaceUse::Read),
            ExprKind::Address(place) => self.place(place, PlaceUse::Share),
            ExprKind::Unary(_, operand)
            | ExprKind::Convert(_, operand)
            | ExprKind::FromRegister(operand)
            | ExprKind::Limited(_, _, operand) => self.expression(operand),
            ExprKind::Binary(_, left, right) => {
                self.expression(left);
                self.expression(right);
            }
            ExprKind::Conditional(three) => three.iter().for_each(|part| self.expression(part)),
            ExprKind::Intrinsic(_, operands) => operands.iter().for_each(|operand| self.expression(operand)),
            ExprKind::Text(call) => {
                call.operands.iter().for_each(|operand| self.expression(operand));
                call.target.iter().for_each(|target| self.place(target, PlaceUse::Write));
            }
            ExprKind::Call(call) => self.function(call),
            ExprKind::After(statements, value) => {
                self.statements(statements);
                if let Some(value) = value {
                    self.expression(value);
                }
            }
            ExprKind::Cast(cast) => self.expression(&cast.reference),
        }
    }

    fn function(&mut self, call: &FunctionCall) {
        self.statements(&call.before);
        call.receiver.iter().for_each(|receiver| self.expression(&receiver.instance));
        for argument in &call.arguments {
            match argument {
                Argument::Value(value) => self.expression(value),
                Argument::Reference(place) => self.place(place, PlaceUse::Share),
            }
        }
        self.statements(&call.outputs);
        call.result.iter().for_each(|result| self.place(result, PlaceUse::Write));
    }

    fn place(&mut self, place: &Place, how: PlaceUse) {
        for step in &place.steps {
            match step {
                Step::Pointer { address, .. } => self.expression(address),
                Step::Offset(_) => {}
                Step::Open { description, indices, .. } => {
                    self.place(description, PlaceUse::Read);
                    for index in indices {
                        self.expression(index);
                    }
                }
                Step::Index { index, .. } => self.expression(index),
            }
        }
        let called = match place.storage {
            Storage::RegisterPointer(register) => self.open.iter().rev().find(|(pointer, _)| *pointer == register),
            _ => None,
        };
        match called {
            Some((_, instance)) => {
                let steps = instance.steps.iter().chain(&place.steps).cloned().collect();
                (self.each)(&Place { storage: instance.storage, steps, ..place.clone() }, how);
            }
            None => (self.each)(place, how),
        }
    }
}
