//! What a call may change: units that write nowhere but into their own instance.
//!
//! After a call of one, its caller still knows what lies elsewhere.

use super::address::Extent;
use onescan_iec::ir::{
    Argument, Dispatch, Expr, ExprKind, FunctionCall, Guard, IfBranch, InstanceCall, Intrinsic, MemoryFunction, Place,
    Pou, PouId, Statement, StatementKind, Step, Storage,
};

/// What a call runs on.
#[derive(Debug, Clone, Copy)]
pub(crate) enum RunsOn {
    Nothing,
    /// The instance in these bytes.
    Instance(Extent),
    /// An instance that may be anywhere.
    Anywhere,
}

/// True if the unit, and all that it calls, changes only registers and the instance that it runs on. `is_known` says so
/// of what it calls.
pub(crate) fn stays_inside(pou: &Pou, is_known: &dyn Fn(PouId) -> bool) -> bool {
    pou.guard == Guard::None && Reach { is_known }.statements(&pou.body)
}

/// Looks for what reaches out.
struct Reach<'k> {
    is_known: &'k dyn Fn(PouId) -> bool,
}

impl Reach<'_> {
    fn statements(&self, list: &[Statement]) -> bool {
        list.iter().all(|statement| self.statement(&statement.kind))
    }

    fn statement(&self, kind: &StatementKind) -> bool {
        match kind {
            StatementKind::Assign(target, expr) | StatementKind::Copy(target, expr) => {
                self.target(target) && self.expression(expr)
            }
            StatementKind::Bind(pointer, place) => self.target(pointer) && self.place(place),
            StatementKind::Initialise(target, _) => self.target(target),
            StatementKind::Evaluate(expr) => self.expression(expr),
            StatementKind::CallInstance(call) => self.instance(call),
            StatementKind::If(branches, otherwise) => {
                let branch = |branch: &IfBranch| self.expression(&branch.condition) && self.statements(&branch.body);
                branches.iter().all(branch) && self.statements(otherwise)
            }
            StatementKind::Case(inner) => {
                self.expression(&inner.selector)
                    && inner.arms.iter().all(|arm| self.statements(&arm.body))
                    && self.statements(&inner.otherwise)
            }
            StatementKind::For(inner) => {
                self.target(&inner.variable)
                    && [&inner.from, &inner.to, &inner.by].into_iter().all(|expr| self.expression(expr))
                    && self.statements(&inner.body)
            }
            StatementKind::While(expr, body) | StatementKind::Repeat(body, expr) => {
                self.expression(expr) && self.statements(body)
            }
            StatementKind::Labelled(inner) => {
                self.statements(&inner.first) && inner.parts.iter().all(|(_, part)| self.statements(part))
            }
            // A fault in there leaves its variables half changed, and this caller goes on.
            StatementKind::Try(_) => false,
            StatementKind::Exit
            | StatementKind::Continue
            | StatementKind::Return
            | StatementKind::Jump(_)
            | StatementKind::Pass => true,
        }
    }

    fn instance(&self, call: &InstanceCall) -> bool {
        matches!(call.instance.storage, Storage::Instance(_))
            && self.place(&call.instance)
            && call.dispatch == Dispatch::Direct
            && (self.is_known)(call.pou)
            && self.statements(&call.inputs)
            && self.statements(&call.outputs)
    }

    /// True for what is written inside.
    fn target(&self, place: &Place) -> bool {
        matches!(place.storage, Storage::Register(_) | Storage::Instance(_)) && self.place(place)
    }

    /// An index that is out of bounds stops the PLC, so whatever has steps lies within its variable.
    fn place(&self, place: &Place) -> bool {
        place.steps.iter().all(|step| match step {
            Step::Offset(_) => true,
            Step::Index { index, .. } => self.expression(index),
            Step::Pointer { .. } | Step::Open { .. } => false,
        })
    }

    fn expression(&self, expr: &Expr) -> bool {
        match &expr.kind {
            ExprKind::Constant(_) => true,
            ExprKind::Load(place) | ExprKind::Address(place) => self.place(place),
            ExprKind::Unary(_, operand)
            | ExprKind::Convert(_, operand)
            | ExprKind::FromRegister(operand)
            | ExprKind::Limited(_, _, operand) => self.expression(operand),
            ExprKind::Binary(_, left, right) => self.expression(left) && self.expression(right),
            ExprKind::Intrinsic(Intrinsic::Memory(MemoryFunction::Copy | MemoryFunction::Fill), _) => false,
            ExprKind::Intrinsic(_, operands) => operands.iter().all(|operand| self.expression(operand)),
            ExprKind::Conditional(parts) => parts.iter().all(|part| self.expression(part)),
            ExprKind::After(statements, value) => {
                self.statements(statements) && value.iter().all(|value| self.expression(value))
            }
            ExprKind::Text(call) => {
                call.operands.iter().all(|operand| self.expression(operand))
                    && call.target.iter().all(|target| self.target(target))
            }
            ExprKind::Call(call) => self.function(call),
            ExprKind::Cast(cast) => self.expression(&cast.reference),
        }
    }

    fn function(&self, call: &FunctionCall) -> bool {
        let argument = |argument: &Argument| match argument {
            Argument::Value(expr) => self.expression(expr),
            Argument::Reference(place) => self.place(place),
        };
        call.receiver.is_none()
            && (self.is_known)(call.pou)
            && self.statements(&call.before)
            && call.arguments.iter().all(argument)
            && self.statements(&call.outputs)
            && call.result.iter().all(|place| self.target(place))
    }
}
