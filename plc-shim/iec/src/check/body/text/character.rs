//! Single characters of strings, `s[i]` (3rd ed. 6.4.2.2; CODESYS, TwinCAT: index access to strings).
//!
//! The standard counts from 1 and has CHAR or WCHAR; CODESYS and TwinCAT count from 0, have BYTE or WORD, and
//! end a string with a 0. A string with a count in front has that follow what is written; in one that ends with a 0
//! a character is a place like any other.

use crate::check::body::place::{Access, Located};
use crate::check::body::{Body, Meant};
use crate::check::types::build::{assign, joined, load, not, operation, when};
use crate::check::types::operand::{Operand, constant, converted};
use crate::dialect::{Feature, StringMemory};
use crate::ir::text::TextShape;
use crate::ir::{
    Binary, Dimension, ElementaryType, Expr, ExprKind, Place, Rounding, Statement, StatementKind, Step, Storage,
    TypeTable, Value,
};
use crate::syntax::{Span, ast};

/// A string, and which of its characters is meant.
struct Indexed {
    text: Place,
    /// Holds the position, from 0.
    position: Place,
    before: Statement,
}

impl Body<'_, '_> {
    fn ends_with_zero(&self, span: Span) -> bool {
        self.declarations.dialect(span).has(Feature::CharactersAsBytes)
    }

    /// How many characters may be read: with vendors the 0 at the end too.
    fn readable(&self, shape: TextShape, span: Span) -> u32 {
        shape.capacity + u32::from(self.ends_with_zero(span))
    }

    fn character_type(&self, shape: TextShape, span: Span) -> ElementaryType {
        match (self.ends_with_zero(span), shape.wide) {
            (false, false) => ElementaryType::Char,
            (false, true) => ElementaryType::Wchar,
            (true, false) => ElementaryType::Byte,
            (true, true) => ElementaryType::Word,
        }
    }

    /// The place of a character; nothing inside if the index is wrong.
    pub(in crate::check::body) fn character_place(
        &mut self,
        text: Located,
        index: &ast::Expr,
        span: Span,
    ) -> Meant<Located> {
        let shape = self.shape(text.place.ty)?;
        let low = i64::from(!self.ends_with_zero(span));
        // The 0 behind the last character has a place, too.
        let last = if shape.memory == StringMemory::ZeroTerminated { shape.capacity } else { shape.capacity - 1 };
        let bounds = Dimension { low, high: low + i64::from(last) };
        let Some(step) = self.index_step(bounds, index, shape.unit()) else { return Some(None) };
        Some(Some(self.character_at(text, shape, step, span)))
    }

    fn character_at(&self, text: Located, shape: TextShape, step: Step, span: Span) -> Located {
        let ty = self.character_type(shape, span).into();
        let mut place = text.place.member(shape.first(), ty);
        place.steps.push(step);
        Located { place: Place { span, ..place }, access: text.access }
    }

    /// The value of a character; 0 behind the last one, so that a full string ends with 0 too.
    pub(in crate::check::body) fn character(
        &mut self,
        text: Located,
        index: &ast::Expr,
        span: Span,
    ) -> Option<Operand> {
        let shape = self.shape(text.place.ty)?;
        if shape.memory == StringMemory::ZeroTerminated {
            let place = self.character_place(text, index, span)??.place;
            return Some(Operand::Typed(load(&place)));
        }
        let Indexed { text, position, before } = self.indexed(text.place, self.readable(shape, span), index, span)?;
        let behind = compared(Binary::GreaterEqual, load(&position), count_of(&text));
        let inside =
            compared(Binary::LessEqual, load(&position), lint(i64::from(self.readable(shape, span)) - 1, span));
        let ended = joined(Binary::And, [behind, inside])?;
        let step =
            Step::Index { index: Box::new(load(&position)), low: 0, count: shape.capacity, stride: shape.unit() };
        let character = self.character_at(Located { place: text, access: Access::ReadWrite }, shape, step, span).place;
        let ty = self.character_type(shape, span);
        let none = Expr { span, ..constant(Value::Int(0), ty, span) };
        let value =
            Expr { kind: ExprKind::Conditional(Box::new([ended, none, load(&character)])), ty: ty.into(), span };
        let kind = ExprKind::After(vec![before], Some(Box::new(value)));
        Some(Operand::Typed(Expr { kind, ty: ty.into(), span }))
    }

    /// `s[i] := value` where a 0 ends a string; nothing at all if the target is not a character of one.
    pub(in crate::check::body) fn character_assignment(
        &mut self,
        target: &ast::Expr,
        value: &ast::Expr,
        span: Span,
    ) -> Meant<Statement> {
        let ast::ExprKind::Index(base, indices) = &target.kind else { return None };
        let [index] = &indices[..] else { return None };
        if !self.ends_with_zero(span) {
            return None;
        }
        let known = self.declarations.mark();
        let counted = |shape: TextShape| shape.memory == StringMemory::Counted;
        let text = self.base_place(base).filter(|base| self.shape(base.place.ty).is_some_and(counted));
        let Some(text) = text else {
            // Whatever is wrong is reported on the usual way.
            self.declarations.forget_since(known);
            return None;
        };
        Some(self.assign_character(text, (target, index), value, span))
    }

    fn assign_character(
        &mut self,
        text: Located,
        (target, index): (&ast::Expr, &ast::Expr),
        value: &ast::Expr,
        span: Span,
    ) -> Option<Statement> {
        self.target(target)?;
        let shape = self.shape(text.place.ty)?;
        let ty = self.character_type(shape, span);
        let value = self.expression_of(value, ty)?;
        let Indexed { text, position, before } = self.indexed(text.place, shape.capacity, index, span)?;
        let register = Place::whole(Storage::Register(self.scope.register(ty)), ty.into(), span);
        let step =
            Step::Index { index: Box::new(load(&position)), low: 0, count: shape.capacity, stride: shape.unit() };
        let character =
            self.character_at(Located { place: text.clone(), access: Access::ReadWrite }, shape, step, span).place;
        let count = text.clone().member(0, ElementaryType::Uint.into());
        let zero = compared(Binary::Equal, load(&register), constant(Value::Int(0), ty, span));
        let shorter = compared(Binary::Less, load(&position), count_of(&text));
        let longer = compared(Binary::Equal, load(&position), count_of(&text));
        let cut = assign(&count, as_count(&position));
        let grown = assign(
            &count,
            operation(Binary::Add, as_count(&position), constant(Value::Int(1), ElementaryType::Uint, span)),
        );
        let statements = vec![
            before,
            assign(&register, value),
            assign(&character, load(&register)),
            when(joined(Binary::And, [zero.clone(), shorter])?, vec![cut], span),
            when(joined(Binary::And, [not(zero), longer])?, vec![grown, self.ended(&text, shape, &position)], span),
        ];
        let all = Expr { kind: ExprKind::After(statements, None), ty: TypeTable::nothing(), span };
        Some(Statement { kind: StatementKind::Evaluate(all), span })
    }

    /// Puts a 0 behind a character, if there is room.
    fn ended(&self, text: &Place, shape: TextShape, position: &Place) -> Statement {
        let span = position.span;
        let next = operation(Binary::Add, load(position), lint(1, span));
        let room = compared(Binary::Less, next.clone(), lint(i64::from(shape.capacity), span));
        let step = Step::Index { index: Box::new(next), low: 0, count: shape.capacity, stride: shape.unit() };
        let located = Located { place: text.clone(), access: Access::ReadWrite };
        let behind = self.character_at(located, shape, step, span).place;
        let zero = constant(Value::Int(0), self.character_type(shape, span), span);
        let cleared = assign(&behind, zero);
        when(room, vec![cleared], span)
    }

    /// The position of a character out of so many, from 0.
    fn indexed(&mut self, text: Place, count: u32, index: &ast::Expr, span: Span) -> Option<Indexed> {
        let low = i64::from(!self.ends_with_zero(span));
        let bounds = Dimension { low, high: low + i64::from(count) - 1 };
        let from_0 = match self.index_step(bounds, index, 1)? {
            Step::Offset(position) => lint(position.into(), span),
            Step::Index { index, .. } => {
                let index = converted(*index, ElementaryType::Lint, Rounding::NearestEven);
                operation(Binary::Subtract, index, lint(low, span))
            }
            Step::Pointer { .. } | Step::Open { .. } => return None,
        };
        let lint_type = ElementaryType::Lint;
        let position = Place::whole(Storage::Register(self.scope.register(lint_type)), lint_type.into(), span);
        let before = assign(&position, from_0);
        Some(Indexed { text, position, before })
    }
}

/// Characters in use, as LINT.
fn count_of(text: &Place) -> Expr {
    let count = load(&text.clone().member(0, ElementaryType::Uint.into()));
    converted(count, ElementaryType::Lint, Rounding::NearestEven)
}

fn compared(operator: Binary, left: Expr, right: Expr) -> Expr {
    let span = left.span;
    let kind = ExprKind::Binary(operator, Box::new(left), Box::new(right));
    Expr { kind, ty: ElementaryType::Bool.into(), span }
}

fn lint(value: i64, span: Span) -> Expr {
    constant(Value::Int(value.into()), ElementaryType::Lint, span)
}

fn as_count(position: &Place) -> Expr {
    converted(load(position), ElementaryType::Uint, Rounding::NearestEven)
}
