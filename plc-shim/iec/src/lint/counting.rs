//! W0722: a FOR loop whose first value lies behind its last. W0723: one whose variable is written in its body.

use super::bodies::Bodies;
use crate::diagnostic::{Code, Diagnostic};
use crate::ir::walk::{self, Visitor};
use crate::ir::{
    Argument, ElementaryType, Expr, ExprKind, ForStatement, FunctionCall, InstanceCall, Place, Pou, Statement,
    StatementKind, Step, Storage, Value,
};
use crate::syntax::Span;

pub(super) fn lint(bodies: &Bodies<'_>, findings: &mut Vec<Diagnostic>) {
    for body in bodies.iter() {
        walk::statements(&body.checked.body, &mut Loops { bodies, findings });
    }
}

struct Loops<'a, 'f> {
    bodies: &'a Bodies<'a>,
    findings: &'f mut Vec<Diagnostic>,
}

impl Visitor for Loops<'_, '_> {
    fn statement(&mut self, statement: &Statement) {
        if let StatementKind::For(turns) = &statement.kind {
            self.never_runs(turns);
            self.variable_is_written(turns);
        }
    }
}

impl Loops<'_, '_> {
    fn never_runs(&mut self, turns: &ForStatement) {
        let number = |expr| self.bodies.literal(expr).and_then(Value::as_int);
        let (Some(from), Some(to), Some(by)) = (number(&turns.from), number(&turns.to), number(&turns.by)) else {
            return;
        };
        let is_empty = by > 0 && from > to || by < 0 && from < to;
        if is_empty {
            let (way, help) = if by > 0 {
                let has_sign = self.bodies.types().elementary(turns.variable.ty).is_some_and(ElementaryType::is_signed);
                let sign = if has_sign { "" } else { ", with a variable of a type that has a sign" };
                ("up", format!("`BY -1` counts down from {from} to {to}{sign}"))
            } else {
                ("down", format!("without BY, the loop counts up from {from} to {to}"))
            };
            let message = format!("this loop never runs: it counts {way} from {from}, and {to} lies behind that");
            let found = Diagnostic::warning(Code::LoopNeverRuns, turns.from.span.to(turns.to.span), message);
            self.findings.push(found.with_help(help));
        }
    }

    fn variable_is_written(&mut self, turns: &ForStatement) {
        let mut writes = Writes { bodies: self.bodies, variable: &turns.variable, found: None };
        writes.list(&turns.body);
        let Some((span, how)) = writes.found else { return };
        let name = self.bodies.text(turns.variable.span);
        let message = format!("`{name}` counts the turns of this loop, and {how}");
        let found = Diagnostic::warning(Code::LoopVariableWritten, span, message)
            .with_label(turns.variable.span, "counts here")
            .with_help("use a variable of its own, or a WHILE loop; EXIT leaves a loop");
        self.findings.push(found);
    }
}

/// Looks for the first statement that writes the variable of a loop.
struct Writes<'a> {
    bodies: &'a Bodies<'a>,
    variable: &'a Place,
    found: Option<(Span, &'static str)>,
}

impl Writes<'_> {
    /// What is written before the loop is left disturbs no turn.
    fn list(&mut self, statements: &[Statement]) {
        let leaves = |each: &Statement| matches!(each.kind, StatementKind::Exit | StatementKind::Return);
        if statements.iter().any(leaves) {
            return;
        }
        for statement in statements {
            match &statement.kind {
                StatementKind::If(branches, otherwise) => {
                    for branch in branches {
                        self.list(&branch.body);
                    }
                    self.list(otherwise);
                }
                StatementKind::Case(case) => {
                    case.arms.iter().for_each(|arm| self.list(&arm.body));
                    self.list(&case.otherwise);
                }
                StatementKind::For(turns) => {
                    self.written(&turns.variable, "an inner loop counts with it, too");
                    self.list(&turns.body);
                }
                StatementKind::While(_, body) | StatementKind::Repeat(body, _) => self.list(body),
                StatementKind::Assign(target, _) => {
                    self.written(target, "is written inside of it");
                    walk::statements(std::slice::from_ref(statement), &mut Calls(self));
                }
                StatementKind::CallInstance(call) => self.instance(call),
                _ => walk::statements(std::slice::from_ref(statement), &mut Calls(self)),
            }
        }
    }

    fn written(&mut self, place: &Place, how: &'static str) {
        if self.found.is_none() && place.is_surely(self.variable) {
            self.found = Some((place.span, how));
        }
    }

    fn instance(&mut self, call: &InstanceCall) {
        for statement in &call.outputs {
            if let StatementKind::Assign(target, _) = &statement.kind {
                self.written(target, "an output of a call writes it");
            }
        }
        for statement in &call.inputs {
            if let StatementKind::Bind(parameter, shared) = &statement.kind
                && let [Step::Offset(offset)] = parameter.steps[..]
                && self.bodies.unit(call.pou).is_some_and(|unit| writes(unit, Storage::InstancePointer(offset)))
            {
                self.written(shared, "the called block writes it as its VAR_IN_OUT");
            }
        }
    }

    fn function(&mut self, call: &FunctionCall) {
        for statement in &call.outputs {
            if let StatementKind::Assign(target, _) = &statement.kind {
                self.written(target, "an output of a call writes it");
            }
        }
        let Some(unit) = self.bodies.unit(call.pou) else { return };
        let first = u32::from(call.receiver.is_some());
        for (register, argument) in (first..).zip(&call.arguments) {
            if let Argument::Reference(shared) = argument
                && writes(unit, Storage::RegisterPointer(crate::ir::LocalId(register)))
            {
                self.written(shared, "the called function writes it as its VAR_IN_OUT");
            }
        }
    }
}

/// Functions are called inside of expressions.
struct Calls<'w, 'a>(&'w mut Writes<'a>);

impl Visitor for Calls<'_, '_> {
    fn expression(&mut self, expr: &Expr) {
        if let ExprKind::Call(call) = &expr.kind {
            self.0.function(call);
        }
    }
}

/// True if a unit itself assigns to what its caller hands it.
fn writes(unit: &Pou, parameter: Storage) -> bool {
    struct Targets(Storage, bool);
    impl Visitor for Targets {
        fn statement(&mut self, statement: &Statement) {
            let target = match &statement.kind {
                StatementKind::Assign(target, _) | StatementKind::Copy(target, _) => target,
                StatementKind::For(turns) => &turns.variable,
                _ => return,
            };
            self.1 |= target.storage == self.0;
        }
    }
    let mut targets = Targets(parameter, false);
    walk::statements(&unit.body, &mut targets);
    targets.1
}
