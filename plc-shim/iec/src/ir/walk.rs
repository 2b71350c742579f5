//! Every expression of checked statements, for those who look at values and not at places.

use super::expr::{Argument, Expr, ExprKind, FunctionCall, Place, Step};
use super::statement::{Statement, StatementKind};

/// Looks at expressions; [`children`] leads on.
pub trait Visitor {
    fn expression(&mut self, expr: &Expr);
}

/// Shows `visitor` the expressions of the statements, those within other expressions not.
pub fn statements(list: &[Statement], visitor: &mut dyn Visitor) {
    for each in list {
        statement(&each.kind, visitor);
    }
}

fn statement(kind: &StatementKind, visitor: &mut dyn Visitor) {
    match kind {
        StatementKind::Assign(target, value) | StatementKind::Copy(target, value) => {
            place(target, visitor);
            visitor.expression(value);
        }
        StatementKind::Bind(target, shared) => {
            place(target, visitor);
            place(shared, visitor);
        }
        StatementKind::Initialise(target, _) => place(target, visitor),
        StatementKind::Evaluate(value) => visitor.expression(value),
        StatementKind::CallInstance(call) => {
            place(&call.instance, visitor);
            statements(&call.inputs, visitor);
            statements(&call.outputs, visitor);
        }
        StatementKind::If(branches, otherwise) => {
            for branch in branches {
                visitor.expression(&branch.condition);
                statements(&branch.body, visitor);
            }
            statements(otherwise, visitor);
        }
        StatementKind::Case(case) => {
            visitor.expression(&case.selector);
            case.arms.iter().for_each(|arm| statements(&arm.body, visitor));
            statements(&case.otherwise, visitor);
        }
        StatementKind::For(turns) => {
            place(&turns.variable, visitor);
            for value in [&turns.from, &turns.to, &turns.by] {
                visitor.expression(value);
            }
            statements(&turns.body, visitor);
        }
        StatementKind::While(condition, body) | StatementKind::Repeat(body, condition) => {
            visitor.expression(condition);
            statements(body, visitor);
        }
        StatementKind::Labelled(labelled) => {
            statements(&labelled.first, visitor);
            labelled.parts.iter().for_each(|(_, part)| statements(part, visitor));
        }
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
        | ExprKind::Limited(_, _, operand) => visitor.expression(operand),
        ExprKind::Binary(_, left, right) => {
            visitor.expression(left);
            visitor.expression(right);
        }
        ExprKind::Conditional(parts) => parts.iter().for_each(|part| visitor.expression(part)),
        ExprKind::Intrinsic(_, operands) => operands.iter().for_each(|operand| visitor.expression(operand)),
        ExprKind::Text(call) => {
            call.operands.iter().for_each(|operand| visitor.expression(operand));
            call.target.iter().for_each(|target| place(target, visitor));
        }
        ExprKind::Call(call) => function(call, visitor),
        ExprKind::After(before, value) => {
            statements(before, visitor);
            if let Some(value) = value {
                visitor.expression(value);
            }
        }
        ExprKind::Cast(cast) => visitor.expression(&cast.reference),
    }
}

fn function(call: &FunctionCall, visitor: &mut dyn Visitor) {
    statements(&call.before, visitor);
    call.receiver.iter().for_each(|receiver| visitor.expression(&receiver.instance));
    for argument in &call.arguments {
        match argument {
            Argument::Value(value) => visitor.expression(value),
            Argument::Reference(shared) => place(shared, visitor),
        }
    }
    statements(&call.outputs, visitor);
    call.result.iter().for_each(|result| place(result, visitor));
}

fn place(of: &Place, visitor: &mut dyn Visitor) {
    for step in &of.steps {
        match step {
            Step::Pointer { address, .. } => visitor.expression(address),
            Step::Offset(_) => {}
            Step::Open { description, indices, .. } => {
                place(description, visitor);
                for index in indices {
                    visitor.expression(index);
                }
            }
            Step::Index { index, .. } => visitor.expression(index),
        }
    }
}
