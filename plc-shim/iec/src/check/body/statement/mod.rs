//! Statements (2nd ed. 3.3.2).

pub(super) mod assignment;
mod case_of_text;
pub(super) mod exception;
pub(super) mod instruction;
pub(super) mod jump;

use std::collections::BTreeMap;

use self::exception::Leave;
use super::Body;
use super::place::{Access, Located};
use crate::check::types::constant::fold;
use crate::check::types::number::as_number;
use crate::check::types::operand::{Operand, constant, converted};
use crate::diagnostic::{Code, Diagnostic};
use crate::dialect::{Feature, IntegerWidth};
use crate::ir::{
    CaseArm, CaseStatement, ElementaryType, Expr, ForStatement, IfBranch, Place, Rounding, Statement, StatementKind,
    Type, TypeId, Value,
};
use crate::syntax::{Span, ast};

impl Body<'_, '_> {
    pub(in crate::check) fn statements(&mut self, list: &[ast::Statement]) -> Vec<Statement> {
        if instruction::is_list(list) {
            let list = self.instructions(list);
            return self.lowered(&list);
        }
        self.lowered(list)
    }

    /// The same of statements alone.
    fn lowered(&mut self, list: &[ast::Statement]) -> Vec<Statement> {
        if jump::has_labels(list) { self.labelled(list) } else { self.unlabelled(list) }
    }

    /// Statements that no jump leads into.
    fn unlabelled(&mut self, list: &[ast::Statement]) -> Vec<Statement> {
        let mut checked = Vec::new();
        for statement in list {
            match &statement.kind {
                ast::StatementKind::Chain(targets, value) => {
                    checked.extend(self.chained(targets, value, statement.span));
                }
                ast::StatementKind::SetReset(targets, value) => {
                    checked.extend(self.set_and_reset(targets, value, statement.span));
                }
                ast::StatementKind::Try(inner) => checked.extend(self.try_statement(inner, statement.span)),
                _ => checked.extend(self.statement(statement)),
            }
            checked.extend(self.seen_again(statement));
        }
        checked
    }

    fn statement(&mut self, statement: &ast::Statement) -> Option<Statement> {
        let span = statement.span;
        let kind = match &statement.kind {
            // A chain and what is tried are several statements, and a label is the beginning of some.
            ast::StatementKind::Empty
            | ast::StatementKind::Error
            | ast::StatementKind::Chain(..)
            | ast::StatementKind::SetReset(..)
            | ast::StatementKind::Try(_)
            | ast::StatementKind::Label(_) => return None,
            ast::StatementKind::Update(operator, target, value) => {
                return self.update(*operator, target, value, span);
            }
            ast::StatementKind::Assign(target, value) => return self.assign(target, value, span),
            ast::StatementKind::Refer(target, value) => return self.refer(target, value, span),
            ast::StatementKind::Attempt(target, value) => return self.attempt(target, value, span),
            ast::StatementKind::Call(call) => self.call_statement(call, span)?,
            ast::StatementKind::Value(value) => self.value_statement(value)?,
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
            ast::StatementKind::Exit => self.inside_loop("EXIT", Leave::Exit, span)?,
            ast::StatementKind::Continue => self.inside_loop("CONTINUE", Leave::Continue, span)?,
            ast::StatementKind::Return => self.leaving(Leave::Return, span),
            ast::StatementKind::Jump(label) => self.jump(label)?,
            // What it does stands behind it.
            ast::StatementKind::Instruction(_) => StatementKind::Pass,
        };
        // Statements that contain others are pointed at by their first line's beginning.
        Some(Statement { kind, span })
    }

    /// `a.b;`: reads it, which a property may notice.
    fn value_statement(&mut self, value: &ast::Expr) -> Option<StatementKind> {
        let operand = self.within(None, |body| body.expression(value))?;
        let found = self.settle(operand)?;
        let message = "this value goes nowhere";
        self.report(Diagnostic::warning(Code::ResultIgnored, value.span, message));
        Some(StatementKind::Evaluate(found))
    }

    fn inside_loop(&mut self, word: &str, leave: Leave, span: Span) -> Option<StatementKind> {
        if self.loops > 0 {
            return Some(self.leaving(leave, span));
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

    pub(in crate::check) fn condition(&mut self, expr: &ast::Expr) -> Option<Expr> {
        self.expression_of(expr, ElementaryType::Bool)
    }

    /// A BOOL, of an operand that has been checked.
    pub(in crate::check::body) fn truth_of(&mut self, operand: Operand) -> Option<Expr> {
        self.coerce(operand, ElementaryType::Bool.into())
    }

    pub(in crate::check) fn assign(&mut self, target: &ast::Expr, value: &ast::Expr, span: Span) -> Option<Statement> {
        if let Some(set) = self.property_assignment(target, value, span) {
            return set;
        }
        if let Some(assigned) = self.character_assignment(target, value, span) {
            return assigned;
        }
        if let Some(given) = self.in_out_given(target, value, span) {
            return given;
        }
        if let Some(name) = self.new_wire(target) {
            return self.first_value(name, value, span);
        }
        let target = self.target(target);
        let context = target.as_ref().and_then(|target| self.elementary(target.ty));
        let wanted = target.as_ref().map(|target| target.ty);
        let value = self.within(context, |body| body.wanting(wanted, |body| body.expression(value)));
        let (target, value) = (target?, value?);
        if matches!(self.declarations.types().get(target.ty), Type::FunctionBlock { .. }) {
            return self.instance_copy(target, value, span);
        }
        if self.refuse_foreign_value(&value, target.ty) {
            return None;
        }
        let value = self.coerce(value, target.ty)?;
        Some(self.assignment(target, value, span))
    }

    /// A place that may be written to.
    pub(in crate::check) fn target(&mut self, expr: &ast::Expr) -> Option<Place> {
        let located = self.place(expr)?;
        self.writable(located, expr.span)
    }

    /// The place, if it may be written to; reports one that may not.
    pub(in crate::check::body) fn writable(&mut self, located: Located, span: Span) -> Option<Place> {
        match located.access {
            Access::ReadWrite => {}
            Access::Constant => {
                let message = "a constant is not assigned to";
                self.report(Diagnostic::error(Code::AssignToConstant, span, message));
                return None;
            }
            Access::Chart => {
                let message = "steps, transitions and action flags are written by their chart only";
                self.report(Diagnostic::error(Code::NotAssignable, span, message));
                return None;
            }
            Access::InstanceOutput => {
                let message = "an output is written by its own instance only";
                self.report(Diagnostic::error(Code::NotAssignable, span, message));
                return None;
            }
            Access::Internal => {
                let message = "a variable that an instance keeps for itself is read from outside, not written";
                let found = Diagnostic::error(Code::NotAssignable, span, message);
                self.report(found.with_help("declare it as VAR_INPUT, or as a property with SET"));
                return None;
            }
            Access::Value => {
                let message = "this is a copy of what the property or call gives, which nobody would read";
                let found = Diagnostic::error(Code::NotAssignable, span, message);
                self.report(found.with_help("change a copy in a variable and assign that to the property"));
                return None;
            }
            // 2nd ed. Table 16 forbids it; every vendor allows it, and programs rely on that.
            Access::OwnInput => {
                let message = "an input is written by the caller; this value is overwritten";
                self.report(Diagnostic::warning(Code::AssignToInput, span, message));
            }
            Access::MachineInput => {
                let message = "an input is written by the machine; this value is overwritten";
                self.report(Diagnostic::warning(Code::AssignToInput, span, message));
            }
        }
        self.note_assigned(&located.place);
        Some(located.place)
    }

    /// Notes that the unit's result has a value, if that is what is assigned.
    pub(in crate::check::body) fn note_assigned(&mut self, place: &Place) {
        let result = self.scope.result().map(|result| result.storage);
        self.result_assigned |= result == Some(place.storage);
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
        let selector = selector.map(|selector| self.whole(selector));
        if let Some(selector) = selector.clone().filter(|selector| self.selects_by_text(selector)) {
            return self.case_of_text(selector, inner);
        }
        let selector = selector.and_then(|selector| self.selectable(selector));
        let ty = selector.as_ref().map(|(selector, _)| selector.ty);
        let mut known = BTreeMap::new();
        let mut arms = Vec::new();
        for branch in &inner.branches {
            let labels = ty.map(|ty| self.case_labels(&inner.selector, &branch.labels, ty, &mut known));
            let body = self.statements(&branch.body);
            // Labels that are wrong have been reported; without any the arm is never taken.
            arms.push(CaseArm { labels: labels.unwrap_or_default(), body });
        }
        let otherwise = self.statements(&inner.otherwise);
        let (selector, elementary) = selector?;
        let register = self.scope.register(elementary);
        let case = CaseStatement { selector, register, arms, otherwise };
        Some(StatementKind::Case(Box::new(case)))
    }

    fn selects_by_text(&self, selector: &Expr) -> bool {
        let has = self.declarations.dialect(selector.span).has(Feature::CharactersSelect);
        has && self.shape(selector.ty).is_some()
    }

    /// 2nd ed. 3.3.2.3: an integer or an enumeration selects; 3rd ed. adds bit strings and characters.
    fn selectable(&mut self, selector: Expr) -> Option<(Expr, ElementaryType)> {
        let has_characters = self.declarations.dialect(selector.span).has(Feature::CharactersSelect);
        match self.elementary(selector.ty) {
            Some(ty)
                if (ty.is_integer() || ty.is_bits() || ty.is_character() && has_characters)
                    && !self.is_reference(&Operand::Typed(selector.clone())) =>
            {
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
        selector: &ast::Expr,
        labels: &[ast::CaseLabel],
        ty: TypeId,
        known: &mut BTreeMap<i128, i128>,
    ) -> Vec<(i128, i128)> {
        let mut ranges = Vec::new();
        for label in labels {
            let low = self.label_value(selector, &label.low, ty);
            let high = match &label.high {
                Some(high) => self.label_value(selector, high, ty),
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

    /// The number of a label. Where enumerations are integers, one of another width may select, too.
    fn label_value(&mut self, selector: &ast::Expr, label: &ast::Expr, ty: TypeId) -> Option<i128> {
        if let Some(named) = self.type_asked(selector, label) {
            let Operand::Typed(value) = named? else { return None };
            return fold(self.declarations.types(), &value).ok().and_then(Value::as_int);
        }
        if self.declarations.dialect(label.span).has(Feature::EnumerationsAsIntegers) {
            let known = self.declarations.mark();
            let value = self.within(None, |body| body.wanting(Some(ty), |body| body.expression(label)));
            if let Some(Operand::Typed(value)) = value
                && matches!(self.declarations.types().get(value.ty), Type::Enumeration { .. })
                && let Ok(value) = fold(self.declarations.types(), &value)
            {
                return value.as_int();
            }
            self.declarations.forget_since(known);
        }
        self.constant_of_type(label, ty).and_then(Value::as_int)
    }

    fn for_statement(&mut self, inner: &ast::ForStatement) -> Option<StatementKind> {
        let variable = self.target(&inner.variable).and_then(|place| self.control_variable(place));
        let header = variable.and_then(|(place, ty)| {
            let from = self.start_of_count(&inner.from, ty);
            let to = self.expression_of(&inner.to, ty);
            let by = match &inner.by {
                Some(by) => self.expression_of(by, self.step_type(ty, by.span)),
                None => Some(constant(Value::Int(1), ty, inner.to.span)),
            };
            Some((place, from?, to?, by?))
        });
        let body = self.loop_body(&inner.body);
        let (variable, from, to, by) = header?;
        self.refuse_zero_step(&by)?;
        self.warn_of_endless_count(&variable, &to, &by);
        let last = self.scope.register(ElementaryType::Lint);
        let step = self.scope.register(ElementaryType::Lint);
        let inner = ForStatement { variable, from, to, by, last, step, body };
        Some(StatementKind::For(Box::new(inner)))
    }

    /// What a FOR begins with. SIMATIC AX takes a wider integer there, as project texts show.
    fn start_of_count(&mut self, expr: &ast::Expr, ty: ElementaryType) -> Option<Expr> {
        if !self.declarations.dialect(expr.span).has(Feature::WideStarts) {
            return self.expression_of(expr, ty);
        }
        let operand = self.within(Some(ty), |body| body.expression(expr))?;
        match operand {
            Operand::Typed(value) if self.plain_elementary(&value).is_some_and(|found| is_wider(found, ty)) => {
                let message =
                    format!("{} is wider than {ty}, so the loop may begin elsewhere", self.type_name(value.ty));
                let found = Diagnostic::warning(Code::TypeMismatch, expr.span, message);
                self.report(found.with_help("convert it, or count with a variable of its type"));
                Some(converted(value, ty, Rounding::NearestEven))
            }
            other => self.coerce(other, ty.into()),
        }
    }

    /// The standard has no loop that stays where it is; at run time it stops the PLC.
    fn refuse_zero_step(&mut self, by: &Expr) -> Option<()> {
        let step = fold(self.declarations.types(), by).ok().and_then(Value::as_int);
        if step != Some(0) {
            return Some(());
        }
        let found = Diagnostic::error(Code::ZeroStep, by.span, "a FOR with a step of 0 never comes to its end");
        self.report(found.with_help("`BY 1` counts up, `BY -1` counts down"));
        None
    }

    /// Warns of a FOR up to the limit of its variable's type, where the target counts in that type: its variable never
    /// passes the limit. Here, the loop ends.
    fn warn_of_endless_count(&mut self, variable: &Place, to: &Expr, by: &Expr) {
        let types = self.declarations.types();
        let whole = |expr: &Expr| fold(types, expr).ok().and_then(Value::as_int);
        let (Some(ty), Some(last), Some(step)) = (types.elementary(variable.ty), whole(to), whole(by)) else { return };
        let Some((least, most)) = ty.range() else { return };
        let is_endless = step > 0 && last == most || step < 0 && last == least;
        if is_endless && self.declarations.dialect(to.span).integers() == IntegerWidth::Register {
            let message =
                format!("{last} is the last number of {ty}, so the loop never ends on the target; here it does");
            let found = Diagnostic::warning(Code::EndlessCount, to.span, message);
            self.report(found.with_help("count with a variable of a wider type"));
        }
    }

    /// The type of a step. Where integers change their sign, an unsigned variable may count down.
    fn step_type(&self, ty: ElementaryType, span: Span) -> ElementaryType {
        let counts_down = !ty.is_signed() && self.declarations.dialect(span).has(Feature::SignChange);
        if counts_down { ElementaryType::Lint } else { ty }
    }

    fn control_variable(&mut self, place: Place) -> Option<(Place, ElementaryType)> {
        match self.declarations.types().get(place.ty) {
            Type::Elementary(ty) | Type::Subrange { base: ty, .. } if ty.is_integer() => {
                let ty = *ty;
                Some((place, ty))
            }
            Type::Elementary(ty) if self.bits_are_numbers(*ty, place.span) => {
                let ty = as_number(*ty);
                Some((Place { ty: ty.into(), ..place }, ty))
            }
            _ => {
                if let Some(ty) = self.base_of_enumeration(place.ty, place.span).filter(|ty| ty.is_integer()) {
                    return Some((Place { ty: ty.into(), ..place }, ty));
                }
                let message = format!("a FOR control variable is an integer, this is {}", self.type_name(place.ty));
                let help = match self.declarations.types().get(place.ty) {
                    Type::Elementary(ElementaryType::Bool) => None,
                    Type::Elementary(ty) if ty.is_real() => {
                        Some("count with a DINT, and convert it in the loop".to_owned())
                    }
                    Type::Elementary(ty) if as_number(*ty) != *ty => {
                        Some(format!("declare it as {}, which counts the same numbers", as_number(*ty)))
                    }
                    _ => None,
                };
                self.report(Diagnostic::error(Code::LoopVariable, place.span, message).with_optional_help(help));
                None
            }
        }
    }
}

/// True for a signed integer where a narrower one is wanted, or the same of unsigned ones.
fn is_wider(found: ElementaryType, wanted: ElementaryType) -> bool {
    found.is_integer() && found.is_signed() == wanted.is_signed() && found.size() > wanted.size()
}
