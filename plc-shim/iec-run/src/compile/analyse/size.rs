//! The size of a unit's statements, and whom they call.

use onescan_iec::ir::text::TextCall;
use onescan_iec::ir::{
    Argument, Dispatch, Expr, ExprKind, FunctionCall, InstanceCall, Place, PouId, Statement, StatementKind, Step,
};

/// Nodes of the tree and every call in it.
#[derive(Debug, Default)]
pub(crate) struct Size {
    pub(crate) nodes: u32,
    /// Calls that are made as a rule.
    pub(crate) calls: Vec<PouId>,
    /// Calls in branches that leave the unit: they are seldom made, and never inlined.
    pub(crate) seldom: Vec<PouId>,
    /// It has statements that a fault ends.
    pub(crate) tries: bool,
    /// How many such branches are around.
    leaving: u32,
}

/// True for a branch that leaves the unit: it is for the exception, and the rest for the rule.
pub(crate) fn leaves(branch: &[Statement]) -> bool {
    branch.last().is_some_and(|last| matches!(last.kind, StatementKind::Return))
}

/// Of a unit's body.
pub(crate) fn measure(body: &[Statement]) -> Size {
    let mut size = Size::default();
    size.statements(body);
    debug_assert_eq!(size.leaving, 0, "all branches have been left");
    size
}

impl Size {
    /// Every call.
    pub(crate) fn all_calls(&self) -> impl Iterator<Item = &PouId> {
        self.calls.iter().chain(&self.seldom)
    }

    fn statements(&mut self, list: &[Statement]) {
        for statement in list {
            self.nodes = self.nodes.saturating_add(1);
            self.statement(&statement.kind);
        }
    }

    fn statement(&mut self, kind: &StatementKind) {
        match kind {
            StatementKind::Assign(place, expr) | StatementKind::Copy(place, expr) => {
                self.place(place);
                self.expression(expr);
            }
            StatementKind::Bind(pointer, place) => {
                self.place(pointer);
                self.place(place);
            }
            StatementKind::Initialise(place, _) => self.place(place),
            StatementKind::Evaluate(expr) => self.expression(expr),
            StatementKind::CallInstance(call) => self.instance(call),
            StatementKind::If(branches, otherwise) => {
                for branch in branches {
                    self.expression(&branch.condition);
                    self.leaving += u32::from(leaves(&branch.body));
                    self.statements(&branch.body);
                    self.leaving -= u32::from(leaves(&branch.body));
                }
                self.statements(otherwise);
            }
            StatementKind::Case(inner) => {
                self.expression(&inner.selector);
                for arm in &inner.arms {
                    self.nodes = self.nodes.saturating_add(arm.labels.len() as u32);
                    self.statements(&arm.body);
                }
                self.statements(&inner.otherwise);
            }
            StatementKind::For(inner) => {
                self.place(&inner.variable);
                for expr in [&inner.from, &inner.to, &inner.by] {
                    self.expression(expr);
                }
                self.statements(&inner.body);
            }
            StatementKind::While(expr, body) | StatementKind::Repeat(body, expr) => {
                self.expression(expr);
                self.statements(body);
            }
            StatementKind::Labelled(inner) => {
                self.statements(&inner.first);
                inner.parts.iter().for_each(|(_, part)| self.statements(part));
            }
            StatementKind::Try(tried) => {
                self.tries = true;
                self.statements(&tried.body);
            }
            StatementKind::Exit
            | StatementKind::Continue
            | StatementKind::Return
            | StatementKind::Jump(_)
            | StatementKind::Pass => {}
        }
    }

    fn instance(&mut self, call: &InstanceCall) {
        self.place(&call.instance);
        self.statements(&call.inputs);
        self.call(call.pou, call.dispatch);
        self.statements(&call.outputs);
    }

    fn place(&mut self, place: &Place) {
        for step in &place.steps {
            match step {
                Step::Offset(_) => {}
                Step::Index { index, .. } => {
                    self.nodes = self.nodes.saturating_add(2);
                    self.expression(index);
                }
                Step::Pointer { address, .. } => {
                    self.nodes = self.nodes.saturating_add(4);
                    self.expression(address);
                }
                Step::Open { description, indices, .. } => {
                    self.nodes = self.nodes.saturating_add(8);
                    self.place(description);
                    self.expressions(indices);
                }
            }
        }
    }

    fn expressions(&mut self, list: &[Expr]) {
        for expr in list {
            self.expression(expr);
        }
    }

    fn expression(&mut self, expr: &Expr) {
        self.nodes = self.nodes.saturating_add(1);
        match &expr.kind {
            ExprKind::Constant(_) => {}
            ExprKind::Load(place) | ExprKind::Address(place) => self.place(place),
            ExprKind::Unary(_, operand)
            | ExprKind::Convert(_, operand)
            | ExprKind::FromRegister(operand)
            | ExprKind::Limited(_, _, operand) => {
                self.expression(operand);
            }
            ExprKind::Binary(_, left, right) => {
                self.expression(left);
                self.expression(right);
            }
            ExprKind::Intrinsic(_, operands) => self.expressions(operands),
            ExprKind::Conditional(parts) => self.expressions(&parts[..]),
            ExprKind::After(statements, value) => {
                self.statements(statements);
                if let Some(value) = value {
                    self.expression(value);
                }
            }
            ExprKind::Text(call) => self.text(call),
            ExprKind::Call(call) => self.function(call),
            ExprKind::Cast(cast) => self.expression(&cast.reference),
        }
    }

    fn text(&mut self, call: &TextCall) {
        self.nodes = self.nodes.saturating_add(8);
        self.expressions(&call.operands);
        if let Some(target) = &call.target {
            self.place(target);
        }
    }

    /// What only the run decides is nobody's callee here.
    fn call(&mut self, pou: PouId, dispatch: Dispatch) {
        self.nodes = self.nodes.saturating_add(4);
        match dispatch {
            Dispatch::Direct if self.leaving > 0 => self.seldom.push(pou),
            Dispatch::Direct => self.calls.push(pou),
            Dispatch::Row(_) => {}
        }
    }

    fn function(&mut self, call: &FunctionCall) {
        if let Some(receiver) = &call.receiver {
            self.expression(&receiver.instance);
        }
        self.statements(&call.before);
        for argument in &call.arguments {
            match argument {
                Argument::Value(expr) => self.expression(expr),
                Argument::Reference(place) => self.place(place),
            }
        }
        self.call(call.pou, call.receiver.as_ref().map_or(Dispatch::Direct, |receiver| receiver.dispatch));
        self.statements(&call.outputs);
    }
}
