//! Every statement and expression of a body, in the order in which it runs.

use super::expr::{Argument, Expr, ExprKind, FunctionCall, Place, Step};
use super::statement::{Statement, StatementKind};

/// Looks at the parts of a body; what it does not care for it leaves out.
pub trait Reader {
    /// A statement, before its parts.
    fn statement(&mut self, _statement: &Statement) {}
    /// An expression, before its parts.
    fn expression(&mut self, _expr: &Expr) {}
    /// What follows runs on a condition, or more than once.
    fn enter(&mut self) {}
    /// That ends.
    fn leave(&mut self) {}
}

/// Shows a reader each of the statements, and what is inside of them.
pub fn read(statements: &[Statement], reader: &mut dyn Reader) {
    for each in statements {
        reader.statement(each);
        statement(&each.kind, reader);
    }
}

fn branch(statements: &[Statement], reader: &mut dyn Reader) {
    reader.enter();
    read(statements, reader);
    reader.leave();
}

fn statement(kind: &StatementKind, reader: &mut dyn Reader) {
    match kind {
        StatementKind::Assign(target, value) | StatementKind::Copy(target, value) => {
            place(target, reader);
            expression(value, reader);
        }
        StatementKind::Bind(target, shared) => {
            place(target, reader);
            place(shared, reader);
        }
        StatementKind::Initialise(target, _) => place(target, reader),
        StatementKind::Evaluate(value) => expression(value, reader),
        StatementKind::CallInstance(call) => {
            place(&call.instance, reader);
            read(&call.inputs, reader);
            read(&call.outputs, reader);
        }
        StatementKind::If(branches, otherwise) => {
            for each in branches {
                expression(&each.condition, reader);
                branch(&each.body, reader);
            }
            branch(otherwise, reader);
        }
        StatementKind::Case(case) => {
            expression(&case.selector, reader);
            case.arms.iter().for_each(|arm| branch(&arm.body, reader));
            branch(&case.otherwise, reader);
        }
        StatementKind::For(turns) => {
            place(&turns.variable, reader);
            for value in [&turns.from, &turns.to, &turns.by] {
                expression(value, reader);
            }
            branch(&turns.body, reader);
        }
        StatementKind::While(condition, body) | StatementKind::Repeat(body, condition) => {
            expression(condition, reader);
            branch(body, reader);
        }
        StatementKind::Labelled(labelled) => {
            branch(&labelled.first, reader);
            labelled.parts.iter().for_each(|(_, part)| branch(part, reader));
        }
        StatementKind::Exit
        | StatementKind::Continue
        | StatementKind::Return
        | StatementKind::Jump(_)
        | StatementKind::Pass => {}
    }
}

fn expression(expr: &Expr, reader: &mut dyn Reader) {
    reader.expression(expr);
    match &expr.kind {
        ExprKind::Constant(_) => {}
        ExprKind::Load(from) | ExprKind::Address(from) => place(from, reader),
        ExprKind::Unary(_, operand)
        | ExprKind::Convert(_, operand)
        | ExprKind::FromRegister(operand)
        | ExprKind::Limited(_, _, operand) => expression(operand, reader),
        ExprKind::Binary(_, left, right) => {
            expression(left, reader);
            expression(right, reader);
        }
        ExprKind::Conditional(parts) => {
            let [condition, then, otherwise] = &**parts;
            expression(condition, reader);
            reader.enter();
            expression(then, reader);
            expression(otherwise, reader);
            reader.leave();
        }
        ExprKind::Intrinsic(_, operands) => operands.iter().for_each(|operand| expression(operand, reader)),
        ExprKind::Text(call) => {
            call.operands.iter().for_each(|operand| expression(operand, reader));
            call.target.iter().for_each(|target| place(target, reader));
        }
        ExprKind::Call(call) => function(call, reader),
        ExprKind::After(statements, value) => {
            read(statements, reader);
            for value in value {
                expression(value, reader);
            }
        }
        ExprKind::Cast(cast) => expression(&cast.reference, reader),
    }
}

fn function(call: &FunctionCall, reader: &mut dyn Reader) {
    read(&call.before, reader);
    call.receiver.iter().for_each(|receiver| expression(&receiver.instance, reader));
    for argument in &call.arguments {
        match argument {
            Argument::Value(value) => expression(value, reader),
            Argument::Reference(shared) => place(shared, reader),
        }
    }
    read(&call.outputs, reader);
}

/// What is computed on the way to a place.
fn place(place: &Place, reader: &mut dyn Reader) {
    for step in &place.steps {
        match step {
            Step::Pointer { address, .. } => expression(address, reader),
            Step::Offset(_) => {}
            Step::Open { indices, .. } => indices.iter().for_each(|index| expression(index, reader)),
            Step::Index { index, .. } => expression(index, reader),
        }
    }
}
