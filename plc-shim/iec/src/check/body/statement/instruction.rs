//! Lists of instructions (2nd ed. 3.2, 3rd ed. 7.2) to statements.
//!
//! The current result is an expression that grows from instruction to instruction; it becomes a wire, and so
//! is evaluated, where it is used more than once, where a label or a call stands, or where it would grow too
//! large. So it has whatever type its operands have, and a constant the type of what it meets (generic
//! operators, 2nd ed. Table 52); what does not fit is found as in an expression, at its instruction.
//!
//! Each instruction also stands in the list itself, for coverage and for the place of a fault.

use std::collections::{BTreeMap, BTreeSet};

use crate::check::body::Body;
use crate::check::body::wire;
use crate::diagnostic::{Code, Diagnostic};
use crate::ir::Type;
use crate::syntax::Span;
use crate::syntax::ast::{
    Argument, BinaryOp, Call, Expr, ExprKind, Ident, IfBranch, IfStatement, Instruction, ListCall, Statement,
    StatementKind, UnaryOp, UpdateOp, When,
};

/// Greatest height to which the current result grows.
const MAX_HEIGHT: u16 = 100;

pub(crate) fn is_list(list: &[Statement]) -> bool {
    list.iter().any(|statement| matches!(statement.kind, StatementKind::Instruction(_)))
}

fn instruction(statement: &Statement) -> Option<&Instruction> {
    match &statement.kind {
        StatementKind::Instruction(inner) => Some(inner),
        _ => None,
    }
}

/// True for what uses the current result and leaves it as it is.
fn stores(instruction: &Instruction) -> bool {
    use Instruction as I;
    matches!(instruction, I::Load { .. } | I::Store { .. } | I::Set(_) | I::Reset(_) | I::Input(..))
}

fn unary(operator: UnaryOp, operand: Expr, span: Span) -> Expr {
    let height = operand.height.saturating_add(1);
    Expr { kind: ExprKind::Unary(operator, Box::new(operand)), span, height }
}

fn binary(operator: BinaryOp, left: Expr, right: Expr, span: Span) -> Expr {
    let height = left.height.max(right.height).saturating_add(1);
    Expr { kind: ExprKind::Binary(operator, Box::new(left), Box::new(right)), span, height }
}

/// True for what has the same value and type wherever it stands, or none of its own.
fn is_settled(expr: &Expr) -> bool {
    match &expr.kind {
        ExprKind::Literal(_) => true,
        ExprKind::Name(name) => wire::is_wire(name),
        ExprKind::Unary(_, operand) => matches!(operand.kind, ExprKind::Literal(_)),
        _ => false,
    }
}

fn has_call(expr: &Expr) -> bool {
    match &expr.kind {
        ExprKind::Call(_) => true,
        ExprKind::Unary(_, operand) => has_call(operand),
        ExprKind::Binary(_, left, right) => has_call(left) || has_call(right),
        _ => false,
    }
}

/// What a list has come to so far.
#[derive(Default)]
struct Lowering {
    out: Vec<Statement>,
    current: Option<Expr>,
    /// Something before has been reported for want of a current result.
    reported: bool,
}

impl Lowering {
    /// True if execution never comes to the end of what there is so far.
    fn has_left(&self) -> bool {
        self.out.last().is_some_and(|last| matches!(last.kind, StatementKind::Jump(_) | StatementKind::Return))
    }

    /// Keeps the current result for the code behind a label.
    fn hand_over(&mut self, name: &Ident, span: Span) {
        if let Some(value) = self.current.clone() {
            self.out.push(Statement { kind: StatementKind::Assign(handed_wire(name), value), span });
        }
    }
}

impl Body<'_, '_> {
    /// The statements that a list of instructions stands for.
    pub(super) fn instructions(&mut self, list: &[Statement]) -> Vec<Statement> {
        let mut state = Lowering::default();
        let handed = handed_over(list);
        for (at, statement) in list.iter().enumerate() {
            match &statement.kind {
                StatementKind::Label(name) => self.label(name, &mut state, &handed, statement),
                StatementKind::Instruction(inner) => {
                    state.out.push(statement.clone());
                    let again = stores(inner) && is_used(list, at + 1);
                    self.instruction(inner, statement.span, again, &handed, &mut state);
                }
                _ => state.out.push(statement.clone()),
            }
        }
        self.discard(&mut state);
        state.out
    }

    fn wire_name(&mut self, span: Span) -> Ident {
        self.instruction_wires += 1;
        Ident { text: format!("`list.{}`", self.instruction_wires), span }
    }

    /// Evaluates the current result, so that it may be used more than once.
    fn settle_current(&mut self, state: &mut Lowering) {
        let Some(value) = state.current.take() else { return };
        if is_settled(&value) {
            state.current = Some(value);
            return;
        }
        let span = value.span;
        let name = self.wire_name(span);
        let wire = Expr { kind: ExprKind::Name(name), span, height: 1 };
        state.out.push(Statement { kind: StatementKind::Assign(wire.clone(), value), span });
        state.current = Some(wire);
    }

    /// A call is made though nobody uses its result.
    fn discard(&mut self, state: &mut Lowering) {
        if state.current.as_ref().is_some_and(has_call) {
            self.settle_current(state);
        }
        state.current = None;
    }

    fn current(&mut self, state: &mut Lowering, span: Span) -> Option<Expr> {
        if state.current.is_none() && !state.reported {
            let message = "there is no current result here";
            let help = "`LD` gives one";
            self.report(Diagnostic::error(Code::NoCurrentResult, span, message).with_help(help));
            state.reported = true;
        }
        state.current.clone()
    }

    /// Behind a label the current result is the one of wherever execution came from.
    fn label(&mut self, name: &Ident, state: &mut Lowering, handed: &BTreeSet<String>, statement: &Statement) {
        if handed.contains(&name.key()) {
            if !state.has_left() {
                self.current(state, statement.span);
            }
            state.reported = false;
            state.hand_over(name, statement.span);
            state.current = Some(handed_wire(name));
        } else {
            self.discard(state);
        }
        state.out.push(statement.clone());
    }

    /// One instruction; `again` says that the current result is used behind it.
    fn instruction(
        &mut self,
        inner: &Instruction,
        span: Span,
        again: bool,
        handed: &BTreeSet<String>,
        state: &mut Lowering,
    ) {
        match inner {
            Instruction::Load { negated: false, value } if self.is_instance_at(value) && state.current.is_some() => {
                self.input("LD", value, span, again, state);
            }
            Instruction::Load { negated, value } => {
                self.discard(state);
                state.reported = false;
                let value = value.clone();
                state.current = Some(if *negated { unary(UnaryOp::Not, value, span) } else { value });
            }
            Instruction::Store { negated, target } => {
                let Some(value) = self.used(again, span, state) else { return };
                let value = if *negated { unary(UnaryOp::Not, value, span) } else { value };
                state.out.push(Statement { kind: StatementKind::Assign(target.clone(), value), span });
            }
            Instruction::Set(target) | Instruction::Reset(target) => {
                let set = matches!(inner, Instruction::Set(_));
                if self.is_instance_at(target) {
                    return self.input(if set { "S" } else { "R" }, target, span, again, state);
                }
                let Some(value) = self.used(again, span, state) else { return };
                let operator = if set { UpdateOp::Set } else { UpdateOp::Reset };
                state.out.push(Statement { kind: StatementKind::Update(operator, target.clone(), value), span });
            }
            Instruction::Operate { operator, negated, operands } => {
                for operand in operands {
                    self.operate(*operator, *negated, operand.clone(), span, state);
                }
            }
            Instruction::Deferred { operator, negated, list } => self.deferred(*operator, *negated, list, span, state),
            Instruction::Not => {
                let Some(value) = self.current(state, span) else { return };
                state.current = Some(unary(UnaryOp::Not, value, span));
            }
            Instruction::Jump(when, label) => self.list_jump(*when, label, span, handed, state),
            Instruction::Return(when) => {
                let leave = Statement { kind: StatementKind::Return, span };
                self.guarded(*when, vec![leave], span, state);
            }
            Instruction::Call(when, call) => {
                self.settle_current(state);
                let call = self.arguments_of(call, None, state);
                let called = Statement { kind: StatementKind::Call(call), span };
                self.guarded(*when, vec![called], span, state);
            }
            Instruction::Function(call) => self.function(call, span, state),
            Instruction::Input(name, instance) => self.input(&name.text, instance, span, again, state),
        }
    }

    /// The current result for a use that is not the last one.
    fn used(&mut self, again: bool, span: Span, state: &mut Lowering) -> Option<Expr> {
        if again {
            self.settle_current(state);
        }
        let value = self.current(state, span)?;
        if !again {
            state.current = None;
            state.reported = true;
        }
        Some(value)
    }

    fn operate(&mut self, operator: BinaryOp, negated: bool, operand: Expr, span: Span, state: &mut Lowering) {
        let Some(left) = self.current(state, span) else { return };
        let operand = if negated { unary(UnaryOp::Not, operand, span) } else { operand };
        state.current = Some(binary(operator, left, operand, span));
        if state.current.as_ref().is_some_and(|current| current.height > MAX_HEIGHT) {
            self.settle_current(state);
        }
    }

    /// `AND( .. )`: what is between is evaluated first, behind what the operator has on its left.
    fn deferred(&mut self, operator: BinaryOp, negated: bool, list: &[Statement], span: Span, state: &mut Lowering) {
        let mut inner = Lowering::default();
        let nothing = BTreeSet::new();
        for (at, statement) in list.iter().enumerate() {
            let Some(found) = instruction(statement) else { continue };
            inner.out.push(statement.clone());
            let again = at + 1 == list.len() || stores(found) && is_used(list, at + 1);
            self.instruction(found, statement.span, again, &nothing, &mut inner);
        }
        let Some(value) = self.current(&mut inner, span) else { return };
        if inner.out.iter().any(|statement| instruction(statement).is_none()) {
            self.settle_current(state);
        }
        state.out.extend(inner.out);
        self.operate(operator, negated, value, span, state);
    }

    fn list_jump(&mut self, when: When, label: &Ident, span: Span, handed: &BTreeSet<String>, state: &mut Lowering) {
        self.settle_current(state);
        let mut jump = Vec::new();
        if handed.contains(&label.key())
            && let Some(value) = self.current(state, span)
        {
            jump.push(Statement { kind: StatementKind::Assign(handed_wire(label), value), span });
        }
        jump.push(Statement { kind: StatementKind::Jump(label.clone()), span });
        self.guarded(when, jump, span, state);
    }

    /// Statements that the modifiers `C` and `N` guard.
    fn guarded(&mut self, when: When, body: Vec<Statement>, span: Span, state: &mut Lowering) {
        if when == When::Always {
            state.out.extend(body);
            return;
        }
        self.settle_current(state);
        let Some(condition) = self.current(state, span) else { return };
        let condition = if when == When::False { unary(UnaryOp::Not, condition, span) } else { condition };
        let branches = vec![IfBranch { condition, body }];
        let kind = StatementKind::If(IfStatement { branches, otherwise: Vec::new() });
        state.out.push(Statement { kind, span });
    }

    /// The call that an instruction makes; arguments that are lists become expressions.
    fn arguments_of(&mut self, call: &ListCall, first: Option<Expr>, state: &mut Lowering) -> Call {
        let mut arguments: Vec<Argument> = first.into_iter().map(Argument::Positional).collect();
        arguments.extend(call.call.arguments.iter().cloned());
        for (name, list) in &call.lists {
            let mut inner = Lowering::default();
            for (at, statement) in list.iter().enumerate() {
                let Some(found) = instruction(statement) else { continue };
                inner.out.push(statement.clone());
                let again = at + 1 == list.len() || stores(found) && is_used(list, at + 1);
                self.instruction(found, statement.span, again, &BTreeSet::new(), &mut inner);
            }
            let value = self.current(&mut inner, name.span);
            state.out.extend(inner.out);
            arguments.extend(value.map(|value| Argument::Input(name.clone(), value)));
        }
        Call { callee: call.call.callee.clone(), arguments }
    }

    /// A function takes the current result for its first argument, and gives the next one.
    fn function(&mut self, called: &ListCall, span: Span, state: &mut Lowering) {
        let first = if called.takes_result {
            match self.current(state, span) {
                Some(first) => Some(first),
                None => return,
            }
        } else {
            self.discard(state);
            state.reported = false;
            None
        };
        let call = self.arguments_of(called, first, state);
        if self.has_no_result(&call) {
            return state.out.push(Statement { kind: StatementKind::Call(call), span });
        }
        let below = call.arguments.iter().map(|argument| match argument {
            Argument::Positional(value) | Argument::Input(_, value) => value.height,
            Argument::Output { .. } => 1,
        });
        let height = below.max().unwrap_or(1).saturating_add(1);
        state.current = Some(Expr { kind: ExprKind::Call(call), span, height });
        if height > MAX_HEIGHT {
            self.settle_current(state);
        }
    }

    fn has_no_result(&mut self, call: &Call) -> bool {
        let ExprKind::Name(name) = &call.callee.kind else { return false };
        let id = self.function_named(name);
        let scope = id.and_then(|id| self.declarations.interface(id, name.span));
        scope.is_some_and(|scope| scope.result().is_none())
    }

    /// An operator of Table 54: the same as `CAL` with this one input.
    fn input(&mut self, name: &str, instance: &Expr, span: Span, again: bool, state: &mut Lowering) {
        let Some(value) = self.used(again, span, state) else { return };
        let name = Ident { text: name.to_owned(), span };
        let call = Call { callee: Box::new(instance.clone()), arguments: vec![Argument::Input(name, value)] };
        state.out.push(Statement { kind: StatementKind::Call(call), span });
    }

    /// True for an instance of a function block.
    fn is_instance_at(&mut self, expr: &Expr) -> bool {
        if !matches!(expr.kind, ExprKind::Name(_) | ExprKind::Member(..) | ExprKind::Index(..)) {
            return false;
        }
        let known = self.declarations.mark();
        let found = self.place(expr);
        self.declarations.forget_since(known);
        found.is_some_and(|found| matches!(self.declarations.types().get(found.place.ty), Type::FunctionBlock { .. }))
    }
}

/// Holds the current result for the code behind a label.
fn handed_wire(label: &Ident) -> Expr {
    let name = Ident { text: format!("`label.{}`", label.key()), span: label.span };
    Expr { kind: ExprKind::Name(name), span: label.span, height: 1 }
}

/// The labels behind which the current result is used before there is another one.
fn handed_over(list: &[Statement]) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    for (at, statement) in list.iter().enumerate() {
        if let StatementKind::Label(name) = &statement.kind
            && is_used(list, at + 1)
        {
            found.insert(name.key());
        }
    }
    found
}

/// True if the current result is used behind `at` before there is another one.
fn is_used(list: &[Statement], from: usize) -> bool {
    let mut seen = BTreeSet::new();
    let mut open = vec![from];
    let mut labels: Option<BTreeMap<String, usize>> = None;
    while let Some(mut at) = open.pop() {
        while let Some(statement) = list.get(at).filter(|_| seen.insert(at)) {
            at += 1;
            let Some(inner) = instruction(statement) else { continue };
            match inner {
                Instruction::Load { .. } | Instruction::Return(When::Always) => break,
                Instruction::Function(call) if !call.takes_result => break,
                Instruction::Call(When::Always, _) => {}
                Instruction::Jump(When::Always, label) => {
                    let labels = labels.get_or_insert_with(|| positions(list));
                    open.extend(labels.get(&label.key()));
                    break;
                }
                _ => return true,
            }
        }
    }
    false
}

fn positions(list: &[Statement]) -> BTreeMap<String, usize> {
    let label = |(at, statement): (usize, &Statement)| match &statement.kind {
        StatementKind::Label(name) => Some((name.key(), at)),
        _ => None,
    };
    list.iter().enumerate().filter_map(label).collect()
}
