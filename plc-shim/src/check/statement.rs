//! Statements and the bodies of units (2nd ed. 3.3.2).

use std::collections::BTreeMap;

use super::Checker;
use super::convert::{Operand, constant};
use super::place::Access;
use super::scope::Body;
use super::start::Occasion;
use super::variables::decode;
use crate::diagnostic::{Code, Diagnostic};
use crate::ir::{
    CaseArm, CaseStatement, ElementaryType, Expr, ExprKind, ForStatement, Guard, IfBranch, LocalId, Place, Pou, PouId,
    Statement, StatementKind, Storage, Type, TypeId, Value, Variable,
};
use crate::syntax::Span;
use crate::syntax::ast::{self, PouKind, SectionKind};

impl Checker<'_> {
    pub(super) fn check_body(&mut self, id: PouId) {
        let home = self.pou(id).home.clone();
        self.at_home(home, |checker| checker.check_body_at_home(id));
    }

    fn check_body_at_home(&mut self, id: PouId) {
        let ast = self.pou(id).ast;
        let Some(scope) = self.interface(id, ast.name.span) else {
            return;
        };
        let mut body = Body::new(self, (*scope).clone(), Some(id));
        let mut statements = body.prologue(ast.kind);
        if let Some((owner, occasion)) = body.checker.stage_of(id) {
            statements.extend(body.staged(owner, occasion));
        } else {
            statements.extend(body.chart(ast));
            statements.extend(body.statements(&ast.body));
        }
        if body.scope.result.is_some() && !body.result_assigned && !Self::is_hook(&ast.name.text) {
            let message = format!("function `{}` never assigns its result", ast.name.text);
            body.report(Diagnostic::warning(Code::MissingResult, ast.name.span, message));
        }
        let scope = body.scope;
        let pou = Pou {
            name: self.display_name(id),
            span: ast.name.span,
            variables: scope.variables,
            registers: scope.registers,
            parameters: scope.parameters,
            result: scope.result,
            guard: if scope.has_memory { Guard::Once(0) } else { Guard::Depth },
            body: statements,
        };
        self.checked.insert(id, pou);
    }
}

impl Body<'_, '_> {
    /// Gives what does not outlive a call its initial value (2nd ed. 2.4.3, `VAR_TEMP`).
    fn prologue(&mut self, kind: PouKind) -> Vec<Statement> {
        let mut statements = Vec::new();
        let variables = self.scope.variables.clone();
        let mut register = u32::from(kind != PouKind::Function);
        for variable in &variables {
            let parameter = matches!(variable.section, SectionKind::Input | SectionKind::InOut);
            if kind.keeps_nothing() && parameter {
                let elementary = self.elementary(variable.ty).is_some();
                statements.extend(copied_parameter(variable, elementary, LocalId(register)));
                register += 1;
                continue;
            }
            if let Some(detection) = variable.edge {
                statements.extend(Self::detected(variable, detection));
            }
            let fleeting = match variable.section {
                SectionKind::Temp => true,
                SectionKind::External | SectionKind::Global | SectionKind::Static | SectionKind::Instance => false,
                // What the caller gives has its values already.
                SectionKind::Output if self.is_open(variable.ty) => false,
                _ => kind.keeps_nothing(),
            };
            if fleeting {
                statements.push(self.initialised(variable));
                statements.extend(self.computed(variable));
            }
            statements.extend(Self::outcome_begins(variable));
        }
        statements
    }

    /// What makes an initial value that is no constant.
    fn computed(&mut self, variable: &Variable) -> Vec<Statement> {
        let fleeting = self.pou.map(|id| self.checker.pou(id).fleeting.clone()).unwrap_or_default();
        let key = variable.name.to_ascii_uppercase();
        let Some((_, starts)) = fleeting.iter().find(|(name, _)| *name == key) else { return Vec::new() };
        let place = Place::whole(variable.storage, variable.ty, variable.span);
        self.performed(&place, starts, Occasion::Start)
    }

    fn initialised(&self, variable: &Variable) -> Statement {
        let (ty, span) = (variable.ty, variable.span);
        let place = Place::whole(variable.storage, ty, span);
        let kind = match self.elementary(ty) {
            Some(elementary) => {
                let value = constant(decode(elementary, &variable.image), elementary, span);
                StatementKind::Assign(place, Expr { ty, ..value })
            }
            None => StatementKind::Initialise(place, variable.image.clone()),
        };
        Statement { kind, span }
    }

    pub(super) fn statements(&mut self, list: &[ast::Statement]) -> Vec<Statement> {
        if super::instruction::is_list(list) {
            let list = self.instructions(list);
            return self.lowered(&list);
        }
        self.lowered(list)
    }

    /// The same of statements alone.
    pub(super) fn lowered(&mut self, list: &[ast::Statement]) -> Vec<Statement> {
        if super::jump::has_labels(list) { self.labelled(list) } else { self.unlabelled(list) }
    }

    /// Statements that no jump leads into.
    pub(super) fn unlabelled(&mut self, list: &[ast::Statement]) -> Vec<Statement> {
        let mut checked = Vec::new();
        for statement in list {
            if let ast::StatementKind::Chain(targets, value) = &statement.kind {
                checked.extend(self.chained(targets, value, statement.span));
            } else {
                checked.extend(self.statement(statement));
            }
        }
        checked
    }

    fn statement(&mut self, statement: &ast::Statement) -> Option<Statement> {
        let span = statement.span;
        let kind = match &statement.kind {
            // A chain is several statements, and a label is the beginning of some.
            ast::StatementKind::Empty
            | ast::StatementKind::Error
            | ast::StatementKind::Chain(..)
            | ast::StatementKind::Label(_) => return None,
            ast::StatementKind::Update(operator, target, value) => {
                return self.update(*operator, target, value, span);
            }
            ast::StatementKind::Assign(target, value) => return self.assign(target, value, span),
            ast::StatementKind::Refer(target, value) => return self.refer(target, value, span),
            ast::StatementKind::Attempt(target, value) => return self.attempt(target, value, span),
            ast::StatementKind::Call(call) => self.call_statement(call, span)?,
            ast::StatementKind::If(inner) => self.if_statement(inner),
            ast::StatementKind::Case(inner) => self.case_statement(inner)?,
            ast::StatementKind::For(inner) => self.for_statement(inner)?,
            ast::StatementKind::While(inner) => {
                let condition = self.condition(&inner.condition);
                let body = self.loop_body(&inner.body);
                StatementKind::While(condition?, body)
            }
            ast::StatementKind::Repeat(inner) => {
                let body = self.loop_body(&inner.body);
                StatementKind::Repeat(body, self.condition(&inner.until)?)
            }
            ast::StatementKind::Exit => self.inside_loop("EXIT", StatementKind::Exit, span)?,
            ast::StatementKind::Continue => self.inside_loop("CONTINUE", StatementKind::Continue, span)?,
            ast::StatementKind::Return => StatementKind::Return,
            ast::StatementKind::Jump(label) => self.jump(label)?,
            // What it does stands behind it.
            ast::StatementKind::Instruction(_) => StatementKind::Pass,
        };
        // Statements that contain others are pointed at by their first line's beginning.
        Some(Statement { kind, span })
    }

    fn inside_loop(&mut self, word: &str, kind: StatementKind, span: Span) -> Option<StatementKind> {
        if self.loops > 0 {
            return Some(kind);
        }
        let message = format!("{word} outside of a loop");
        self.report(Diagnostic::error(Code::MisplacedStatement, span, message));
        None
    }

    fn loop_body(&mut self, list: &[ast::Statement]) -> Vec<Statement> {
        self.loops += 1;
        let body = self.statements(list);
        self.loops -= 1;
        body
    }

    pub(super) fn condition(&mut self, expr: &ast::Expr) -> Option<Expr> {
        self.expression_of(expr, ElementaryType::Bool)
    }

    pub(super) fn assign(&mut self, target: &ast::Expr, value: &ast::Expr, span: Span) -> Option<Statement> {
        if let Some(set) = self.property_assignment(target, value, span) {
            return set;
        }
        if let Some(assigned) = self.character_assignment(target, value, span) {
            return assigned;
        }
        if let Some(name) = self.new_wire(target) {
            return self.first_value(name, value, span);
        }
        let target = self.target(target);
        let context = target.as_ref().and_then(|target| self.elementary(target.ty));
        let value = self.within(context, |body| body.expression(value));
        let (target, value) = (target?, value?);
        if matches!(self.checker.types.get(target.ty), Type::FunctionBlock { .. }) {
            let message = "instances are not assigned to one another";
            self.report(Diagnostic::error(Code::NotAssignable, span, message));
            return None;
        }
        let value = self.coerce(value, target.ty)?;
        Some(self.assignment(target, value, span))
    }

    /// A place that may be written to.
    pub(super) fn target(&mut self, expr: &ast::Expr) -> Option<Place> {
        let located = self.place(expr)?;
        match located.access {
            Access::ReadWrite => {}
            Access::Constant => {
                let message = "a constant is not assigned to";
                self.report(Diagnostic::error(Code::AssignToConstant, expr.span, message));
                return None;
            }
            Access::Chart => {
                let message = "steps, transitions and action flags are written by their chart only";
                self.report(Diagnostic::error(Code::NotAssignable, expr.span, message));
                return None;
            }
            Access::InstanceOutput => {
                let message = "an output is written by its own instance only";
                self.report(Diagnostic::error(Code::NotAssignable, expr.span, message));
                return None;
            }
            Access::Value => {
                let message = "this is a copy of what the property or call gives, which nobody would read";
                let found = Diagnostic::error(Code::NotAssignable, expr.span, message);
                self.report(found.with_help("change a copy in a variable and assign that to the property"));
                return None;
            }
            // 2nd ed. Table 16 forbids it; every vendor allows it, and programs rely on that.
            Access::OwnInput => {
                let message = "an input is written by the caller; this value is overwritten";
                self.report(Diagnostic::warning(Code::AssignToInput, expr.span, message));
            }
            Access::MachineInput => {
                let message = "an input is written by the machine; this value is overwritten";
                self.report(Diagnostic::warning(Code::AssignToInput, expr.span, message));
            }
        }
        let result = self.scope.result.as_ref().map(|result| result.storage);
        self.result_assigned |= result == Some(located.place.storage);
        Some(located.place)
    }

    fn if_statement(&mut self, inner: &ast::IfStatement) -> StatementKind {
        let mut branches = Vec::new();
        for branch in &inner.branches {
            let condition = self.condition(&branch.condition);
            let body = self.statements(&branch.body);
            branches.extend(condition.map(|condition| IfBranch { condition, body }));
        }
        StatementKind::If(branches, self.statements(&inner.otherwise))
    }

    fn case_statement(&mut self, inner: &ast::CaseStatement) -> Option<StatementKind> {
        let selector = self.expression(&inner.selector).and_then(|operand| self.settle(operand));
        let selector = selector.and_then(|selector| self.selectable(selector));
        let ty = selector.as_ref().map(|(selector, _)| selector.ty);
        let mut known = BTreeMap::new();
        let mut arms = Vec::new();
        for branch in &inner.branches {
            let labels = ty.map(|ty| self.case_labels(&branch.labels, ty, &mut known));
            let body = self.statements(&branch.body);
            arms.push(CaseArm { labels: labels.unwrap_or_default(), body });
        }
        let otherwise = self.statements(&inner.otherwise);
        let (selector, elementary) = selector?;
        let register = self.scope.register(elementary);
        let case = CaseStatement { selector, register, arms, otherwise };
        Some(StatementKind::Case(Box::new(case)))
    }

    /// 2nd ed. 3.3.2.3: an integer or an enumeration selects; 3rd ed. adds bit strings.
    fn selectable(&mut self, selector: Expr) -> Option<(Expr, ElementaryType)> {
        match self.elementary(selector.ty) {
            Some(ty) if (ty.is_integer() || ty.is_bits()) && !self.is_reference(&Operand::Typed(selector.clone())) => {
                Some((selector, ty))
            }
            _ => {
                let found = self.type_name(selector.ty);
                self.mismatch("an integer or enumeration", &found, selector.span)
            }
        }
    }

    fn case_labels(
        &mut self,
        labels: &[ast::CaseLabel],
        ty: TypeId,
        known: &mut BTreeMap<i128, i128>,
    ) -> Vec<(i128, i128)> {
        let mut ranges = Vec::new();
        for label in labels {
            let low = self.constant_of_type(&label.low, ty).and_then(Value::as_int);
            let high = match &label.high {
                Some(high) => self.constant_of_type(high, ty).and_then(Value::as_int),
                None => low,
            };
            let (Some(low), Some(high)) = (low, high) else {
                continue;
            };
            let span = label.high.as_ref().map_or(label.low.span, |high| label.low.span.to(high.span));
            if low > high {
                let message = format!("range {low}..{high} is reversed");
                self.report(Diagnostic::error(Code::InvalidRange, span, message));
                continue;
            }
            let before = known.range(..=high).next_back();
            if before.is_some_and(|(_, known_high)| *known_high >= low) {
                let message = "this label is selected by an earlier one already";
                self.report(Diagnostic::warning(Code::DuplicateCase, span, message));
            } else {
                known.insert(low, high);
            }
            ranges.push((low, high));
        }
        ranges
    }

    fn for_statement(&mut self, inner: &ast::ForStatement) -> Option<StatementKind> {
        let variable = self.target(&inner.variable).and_then(|place| self.control_variable(place));
        let header = variable.and_then(|(place, ty)| {
            let from = self.expression_of(&inner.from, ty);
            let to = self.expression_of(&inner.to, ty);
            let by = match &inner.by {
                Some(by) => self.expression_of(by, ty),
                None => Some(constant(Value::Int(1), ty, inner.to.span)),
            };
            Some((place, from?, to?, by?))
        });
        let body = self.loop_body(&inner.body);
        let (variable, from, to, by) = header?;
        let last = self.scope.register(ElementaryType::Lint);
        let step = self.scope.register(ElementaryType::Lint);
        let inner = ForStatement { variable, from, to, by, last, step, body };
        Some(StatementKind::For(Box::new(inner)))
    }

    fn control_variable(&mut self, place: Place) -> Option<(Place, ElementaryType)> {
        match self.checker.types.get(place.ty) {
            Type::Elementary(ty) | Type::Subrange { base: ty, .. } if ty.is_integer() => {
                let ty = *ty;
                Some((place, ty))
            }
            _ => {
                let message = format!("a FOR control variable is an integer, this is {}", self.type_name(place.ty));
                self.report(Diagnostic::error(Code::LoopVariable, place.span, message));
                None
            }
        }
    }
}

/// An aggregate comes by address; the callee works on its own copy. So it does on that of a value whose
/// address it takes.
fn copied_parameter(variable: &Variable, elementary: bool, register: LocalId) -> Option<Statement> {
    if !matches!(variable.storage, Storage::Absolute(_)) {
        return None;
    }
    let (ty, span) = (variable.ty, variable.span);
    let storage = if elementary { Storage::Register(register) } else { Storage::RegisterPointer(register) };
    let target = Place::whole(variable.storage, ty, span);
    let value = Expr { kind: ExprKind::Load(Place::whole(storage, ty, span)), ty, span };
    let kind = if elementary { StatementKind::Assign(target, value) } else { StatementKind::Copy(target, value) };
    Some(Statement { kind, span })
}
