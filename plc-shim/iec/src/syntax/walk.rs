//! Every statement and expression of a body, in the order of the text.

use crate::syntax::ast::{
    Argument, Call, Expr, ExprKind, Instruction, Pou, Statement, StatementKind, TransitionCondition,
};

/// Looks at the parts of a body; what it does not care for it leaves out.
pub trait Visitor {
    /// A statement, before its parts.
    fn statement(&mut self, _statement: &Statement) {}
    /// The statements of a branch or loop begin.
    fn enter(&mut self) {}
    /// They end.
    fn leave(&mut self) {}
    /// Where a value goes to.
    fn target(&mut self, _target: &Expr) {}
    /// A name alone that a value goes to: an action of a chart.
    fn control(&mut self, _name: &crate::syntax::ast::Ident) {}
    /// A call, before its arguments.
    fn call(&mut self, _call: &Call) {}
    /// What a reference is made to refer to.
    fn referred(&mut self, _place: &Expr) {}
    /// An expression, before its parts; of targets and callees only their indices.
    fn expression(&mut self, _expr: &Expr) {}
}

/// Shows a visitor each statement, before its parts.
pub fn statements(list: &[Statement], visitor: &mut impl Visitor) {
    for each in list {
        visitor.statement(each);
        statement(&each.kind, visitor);
    }
}

/// The statements of a unit, and the conditions, times and actions of its chart.
pub fn unit(pou: &Pou, visitor: &mut impl Visitor) {
    for association in pou.chart.steps.iter().flat_map(|step| &step.associations) {
        visitor.control(&association.action);
        association.time.iter().for_each(|time| expression(time, visitor));
        association.indicators.iter().for_each(|indicator| target(indicator, visitor));
    }
    for transition in &pou.chart.transitions {
        match &transition.condition {
            TransitionCondition::Expression(condition) => expression(condition, visitor),
            TransitionCondition::Network(network) => statements(network, visitor),
        }
    }
    statements(&pou.body, visitor);
}

/// The same, and its actions and methods, which are parts of it.
pub fn with_members(pou: &Pou, visitor: &mut impl Visitor) {
    unit(pou, visitor);
    pou.object.members.iter().for_each(|member| unit(&member.pou, visitor));
}

fn branch(list: &[Statement], visitor: &mut impl Visitor) {
    visitor.enter();
    statements(list, visitor);
    visitor.leave();
}

fn statement(kind: &StatementKind, visitor: &mut impl Visitor) {
    match kind {
        StatementKind::Assign(place, value) | StatementKind::Attempt(place, value) => {
            target(place, visitor);
            expression(value, visitor);
        }
        StatementKind::Refer(place, value) => {
            target(place, visitor);
            visitor.referred(value);
            expression(value, visitor);
        }
        StatementKind::Chain(places, value) => {
            for place in places {
                target(place, visitor);
            }
            expression(value, visitor);
        }
        StatementKind::Update(_, place, value) => {
            expression(place, visitor);
            target(place, visitor);
            expression(value, visitor);
        }
        StatementKind::SetReset(places, value) => {
            for (_, place) in places {
                expression(place, visitor);
                target(place, visitor);
            }
            expression(value, visitor);
        }
        StatementKind::Call(inner) => call(inner, visitor),
        StatementKind::Value(value) => expression(value, visitor),
        StatementKind::Try(inner) => {
            branch(&inner.body, visitor);
            inner.code.iter().for_each(|code| target(code, visitor));
            branch(&inner.handler, visitor);
            branch(&inner.finally, visitor);
        }
        StatementKind::If(inner) => {
            for each in &inner.branches {
                expression(&each.condition, visitor);
                branch(&each.body, visitor);
            }
            branch(&inner.otherwise, visitor);
        }
        StatementKind::Case(inner) => {
            expression(&inner.selector, visitor);
            for each in &inner.branches {
                for label in &each.labels {
                    expression(&label.low, visitor);
                    label.high.iter().for_each(|high| expression(high, visitor));
                }
                branch(&each.body, visitor);
            }
            branch(&inner.otherwise, visitor);
        }
        StatementKind::For(inner) => {
            target(&inner.variable, visitor);
            expression(&inner.from, visitor);
            expression(&inner.to, visitor);
            inner.by.iter().for_each(|by| expression(by, visitor));
            branch(&inner.body, visitor);
        }
        StatementKind::While(inner) => {
            expression(&inner.condition, visitor);
            branch(&inner.body, visitor);
        }
        StatementKind::Repeat(inner) => {
            branch(&inner.body, visitor);
            expression(&inner.until, visitor);
        }
        StatementKind::Instruction(inner) => instruction(inner, visitor),
        _ => {}
    }
}

fn instruction(instruction: &Instruction, visitor: &mut impl Visitor) {
    match instruction {
        Instruction::Load { value, .. } => expression(value, visitor),
        Instruction::Store { target: place, .. } => target(place, visitor),
        Instruction::Set(place) | Instruction::Reset(place) => {
            expression(place, visitor);
            target(place, visitor);
        }
        Instruction::Operate { operands, .. } => operands.iter().for_each(|operand| expression(operand, visitor)),
        Instruction::Deferred { list, .. } => statements(list, visitor),
        Instruction::Call(_, called) | Instruction::Function(called) => {
            call(&called.call, visitor);
            called.lists.iter().for_each(|(_, list)| statements(list, visitor));
        }
        Instruction::Input(_, instance) => expression(instance, visitor),
        Instruction::Not | Instruction::Jump(..) | Instruction::Return(_) => {}
    }
}

fn call(call: &Call, visitor: &mut impl Visitor) {
    visitor.call(call);
    indices(&call.callee, visitor);
    for argument in &call.arguments {
        match argument {
            Argument::Positional(value) | Argument::Input(_, value) => expression(value, visitor),
            Argument::Output { target: place, .. } => place.iter().for_each(|place| target(place, visitor)),
        }
    }
}

fn target(place: &Expr, visitor: &mut impl Visitor) {
    visitor.target(place);
    indices(place, visitor);
}

/// The indices on the way to a place: they are read, whatever becomes of the place.
fn indices(place: &Expr, visitor: &mut impl Visitor) {
    match &place.kind {
        ExprKind::Member(inner, _) | ExprKind::Part(inner, _) | ExprKind::Paren(inner) => indices(inner, visitor),
        // The reference itself is read.
        ExprKind::Dereference(inner) => expression(inner, visitor),
        ExprKind::Index(inner, list) => {
            indices(inner, visitor);
            for index in list {
                expression(index, visitor);
            }
        }
        ExprKind::Call(inner) => call(inner, visitor),
        _ => {}
    }
}

/// Shows a visitor an expression, then its parts.
pub fn expression(expr: &Expr, visitor: &mut impl Visitor) {
    visitor.expression(expr);
    match &expr.kind {
        ExprKind::Member(inner, _)
        | ExprKind::Part(inner, _)
        | ExprKind::Dereference(inner)
        | ExprKind::Unary(_, inner)
        | ExprKind::Paren(inner) => expression(inner, visitor),
        ExprKind::Index(inner, list) => {
            expression(inner, visitor);
            for index in list {
                expression(index, visitor);
            }
        }
        ExprKind::Binary(_, left, right) => {
            expression(left, visitor);
            expression(right, visitor);
        }
        ExprKind::Chain(first, links) => {
            expression(first, visitor);
            for link in links {
                expression(&link.operand, visitor);
            }
        }
        ExprKind::Call(inner) => call(inner, visitor),
        ExprKind::Assign(place, value) => {
            target(place, visitor);
            expression(value, visitor);
        }
        _ => {}
    }
}

/// The variable that a place is or is a part of.
pub fn root(place: &Expr) -> Option<&crate::syntax::ast::Ident> {
    match &place.kind {
        ExprKind::Name(name) => Some(name),
        ExprKind::Member(inner, _) | ExprKind::Part(inner, _) | ExprKind::Index(inner, _) | ExprKind::Paren(inner) => {
            root(inner)
        }
        _ => None,
    }
}

/// True if the expression, or a part of it, is the name, which is in capitals.
pub fn names(expr: &Expr, key: &str) -> bool {
    struct Search<'k>(&'k str, bool);

    impl Visitor for Search<'_> {
        fn expression(&mut self, expr: &Expr) {
            self.1 |= matches!(&expr.kind, ExprKind::Name(name) if name.key() == self.0);
        }
    }

    let mut search = Search(key, false);
    expression(expr, &mut search);
    search.1
}
