//! Every statement and expression of a body, in the order in which it runs.

use super::expr::{Argument, Expr, ExprKind, FunctionCall, Place, Step};
use super::statement::{Statement, StatementKind};

/// Looks at the parts of a body; what it does not care for it leaves out.
pub trait Visitor {
    /// A statement, before its parts.
    fn statement(&mut self, _statement: &Statement) {}
    /// An expression, before its parts.
    fn expression(&mut self, _expr: &Expr) {}
    /// An index of an array, before its parts.
    fn index(&mut self, index: &Expr) {
        self.expression(index);
    }
    /// True if the parts of each expression are shown as well; else [`children`] leads on.
    fn goes_into_expressions(&self) -> bool {
        true
    }
    /// What follows runs on a condition, or more than once, until [`leave`](Self::leave).
    fn enter(&mut self) {}
    /// What follows runs as often as what was before [`enter`](Self::enter).
    fn leave(&mut self) {}
}

/// Shows `visitor` each of the statements, and what is inside of them.
pub fn statements(list: &[Statement], visitor: &mut dyn Visitor) {
    for each in list {
        visitor.statement(each);
        statement(&each.kind, visitor);
    }
}

fn branch(list: &[Statement], visitor: &mut dyn Visitor) {
    visitor.enter();
    statements(list, visitor);
    visitor.leave();
}

fn expression(expr: &Expr, visitor: &mut dyn Visitor) {
    visitor.expression(expr);
    if visitor.goes_into_expressions() {
        children(expr, visitor);
    }
}

fn statement(kind: &StatementKind, visitor: &mut dyn Visitor) {
    match kind {
        StatementKind::Assign(target, value) | StatementKind::Copy(target, value) => {
            place(target, visitor);
            expression(value, visitor);
        }
        StatementKind::Bind(target, shared) => {
            place(target, visitor);
            place(shared, visitor);
        }
        StatementKind::Initialise(target, _) => place(target, visitor),
        StatementKind::Evaluate(value) => expression(value, visitor),
        StatementKind::CallInstance(call) => {
            place(&call.instance, visitor);
            statements(&call.inputs, visitor);
            statements(&call.outputs, visitor);
        }
        StatementKind::If(branches, otherwise) => {
            for each in branches {
                expression(&each.condition, visitor);
                branch(&each.body, visitor);
            }
            branch(otherwise, visitor);
        }
        StatementKind::Case(case) => {
            expression(&case.selector, visitor);
            case.arms.iter().for_each(|arm| branch(&arm.body, visitor));
            branch(&case.otherwise, visitor);
        }
        StatementKind::For(turns) => {
            place(&turns.variable, visitor);
            for value in [&turns.from, &turns.to, &turns.by] {
                expression(value, visitor);
            }
            branch(&turns.body, visitor);
        }
        StatementKind::While(condition, body) | StatementKind::Repeat(body, condition) => {
            expression(condition, visitor);
            branch(body, visitor);
        }
        StatementKind::Labelled(labelled) => {
            branch(&labelled.first, visitor);
            labelled.parts.iter().for_each(|(_, part)| branch(part, visitor));
        }
        StatementKind::Try(tried) => branch(&tried.body, visitor),
        StatementKind::Exit
        | StatementKind::Continue
        | StatementKind::Return
        | StatementKind::Jump(_)
        | StatementKind::Pass => {}
    }
}

/// Shows `visitor` what the expression is made of.
pub fn children(expr: &Expr, visitor: &mut dyn Visitor) {
    match &expr.kind {
        ExprKind::Constant(_) => {}
        ExprKind::Load(from) | ExprKind::Address(from) => place(from, visitor),
        ExprKind::Unary(_, operand)
        | ExprKind::Convert(_, operand)
        | ExprKind::FromRegister(operand)
        | ExprKind::Limited(_, _, operand) => expression(operand, visitor),
        ExprKind::Binary(_, left, right) => {
            expression(left, visitor);
            expression(right, visitor);
        }
        ExprKind::Conditional(parts) => {
            let [condition, then, otherwise] = &**parts;
            expression(condition, visitor);
            visitor.enter();
            expression(then, visitor);
            expression(otherwise, visitor);
            visitor.leave();
        }
        ExprKind::Intrinsic(_, operands) => operands.iter().for_each(|operand| expression(operand, visitor)),
        ExprKind::Text(call) => {
            call.operands.iter().for_each(|operand| expression(operand, visitor));
            call.target.iter().for_each(|target| place(target, visitor));
        }
        ExprKind::Call(call) => function(call, visitor),
        ExprKind::After(before, value) => {
            statements(before, visitor);
            if let Some(value) = value {
                expression(value, visitor);
            }
        }
        ExprKind::Cast(cast) => expression(&cast.reference, visitor),
    }
}

fn function(call: &FunctionCall, visitor: &mut dyn Visitor) {
    statements(&call.before, visitor);
    call.receiver.iter().for_each(|receiver| expression(&receiver.instance, visitor));
    for argument in &call.arguments {
        match argument {
            Argument::Value(value) => expression(value, visitor),
            Argument::Reference(shared) => place(shared, visitor),
        }
    }
    statements(&call.outputs, visitor);
    call.result.iter().for_each(|result| place(result, visitor));
}

fn place(of: &Place, visitor: &mut dyn Visitor) {
    for step in &of.steps {
        match step {
            Step::Pointer { address, .. } => expression(address, visitor),
            Step::Offset(_) => {}
            Step::Open { description, indices, .. } => {
                place(description, visitor);
                for index in indices {
                    element(index, visitor);
                }
            }
            Step::Index { index, .. } => element(index, visitor),
        }
    }
}

fn element(index: &Expr, visitor: &mut dyn Visitor) {
    visitor.index(index);
    if visitor.goes_into_expressions() {
        children(index, visitor);
    }
}
