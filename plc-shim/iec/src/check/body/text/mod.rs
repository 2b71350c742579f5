//! Character strings: literals, lengths, assignment, comparison (2nd ed. 2.2.2, 2.4.3.2, Table 28).

pub(super) mod character;
pub(super) mod conversion;
mod declared;
pub(super) mod function;
mod limit;
mod named;

use super::Body;
use crate::check::types::operand::{Operand, constant};
use crate::diagnostic::{Code, Diagnostic};
use crate::dialect::Feature;
use crate::ir::text::{Edit, MAX_CAPACITY, TextCall, TextFunction, TextShape};
use crate::ir::{Binary, ElementaryType, Expr, ExprKind, TypeId, Value};
use crate::syntax::text_literal::{Text, parse_text, parse_windows_text};
use crate::syntax::{Span, ast};

impl Body<'_, '_> {
    /// A literal that has no length yet.
    pub(in crate::check) fn text_literal(&mut self, text: &str, span: Span) -> Option<Operand> {
        // A literal without an end has been reported by the parser.
        let quote = text.chars().next()?;
        if text.len() < 2 || !text.ends_with(quote) {
            return None;
        }
        let has_windows = self.declarations.dialect(span).has(Feature::WindowsCharacters);
        match if has_windows { parse_windows_text(text) } else { parse_text(text) } {
            Ok(text) if text.units.len() <= MAX_CAPACITY as usize => Some(Operand::Text { text, span }),
            Ok(_) => self.invalid_literal("string is too long".to_owned(), span),
            Err(message) => self.invalid_literal(message, span),
        }
    }

    fn invalid_literal<T>(&mut self, message: String, span: Span) -> Option<T> {
        self.report(Diagnostic::error(Code::InvalidLiteral, span, message));
        None
    }

    /// `STRING#'...'`
    pub(super) fn typed_text(&mut self, prefix: &str, text: &str, span: Span) -> Option<Operand> {
        let literal = self.text_literal(text, span)?;
        if let Some(ty) = ElementaryType::find(prefix).filter(|ty| ty.is_character()) {
            return Some(Operand::Typed(self.coerce(literal, ty.into())?));
        }
        let wide = match prefix.to_ascii_uppercase().as_str() {
            "STRING" => false,
            "WSTRING" => true,
            _ => return self.malformed_literal(prefix, text, span),
        };
        match literal {
            Operand::Text { text, .. } if text.wide == wide => Some(Operand::Text { text, span }),
            // The units of a narrow text are those of the first 256 characters.
            Operand::Text { text, .. } if wide && self.declarations.dialect(span).has(Feature::NarrowQuotes) => {
                Some(Operand::Text { text: Text { wide, ..text }, span })
            }
            _ => self.malformed_literal(prefix, text, span),
        }
    }
}

impl Body<'_, '_> {
    /// The shape of an expression's type.
    pub(in crate::check) fn shape(&self, ty: TypeId) -> Option<TextShape> {
        self.declarations.types().text(ty)
    }

    pub(super) fn is_text(&self, operand: &Operand) -> bool {
        match operand {
            Operand::Text { .. } => true,
            Operand::Typed(expr) => self.shape(expr.ty).is_some(),
            _ => false,
        }
    }

    /// A literal as a string of its own length.
    pub(super) fn settled_text(&mut self, text: &Text, span: Span) -> Option<Expr> {
        let shape = self.own_shape(text, text.units.len() as u32, span);
        self.stored_text(shape, text, span)
    }

    fn own_shape(&self, text: &Text, capacity: u32, span: Span) -> TextShape {
        TextShape { wide: text.wide, capacity, memory: self.declarations.dialect(span).strings() }
    }

    fn stored_text(&mut self, shape: TextShape, text: &Text, span: Span) -> Option<Expr> {
        let ty = self.declarations.types_mut().string(shape);
        let place = self.declarations.constant_bytes(ty, shape.encode(&text.units).into(), span)?;
        Some(Expr { kind: ExprKind::Load(place), ty, span })
    }

    /// The one character of a literal, as one of `ty` (3rd ed. 6.3.3).
    pub(super) fn as_character(text: &Text, ty: ElementaryType) -> Option<u16> {
        let fits = ty.is_character() && text.wide == (ty == ElementaryType::Wchar);
        text.units.first().copied().filter(|_| fits && text.units.len() == 1)
    }

    pub(super) fn literal_character(&mut self, text: &Text, ty: ElementaryType, span: Span) -> Option<Expr> {
        if let Some(unit) = Self::as_character(text, ty) {
            return Some(constant(Value::Int(i128::from(unit)), ty, span));
        }
        let quotes = if ty == ElementaryType::Wchar { "double" } else { "single" };
        let message = format!("{ty} is one character between {quotes} quotes");
        self.report(Diagnostic::error(Code::TypeMismatch, span, message));
        None
    }

    /// The operand as a string of `shape`; what does not fit is cut off (2nd ed. 2.4.3.2).
    pub(super) fn coerce_text(&mut self, operand: Operand, shape: TextShape) -> Option<Expr> {
        match self.between_other_quotes(operand, shape) {
            Operand::Text { text, span } if text.wide == shape.wide => {
                self.warn_if_cut(&text, shape, span);
                self.stored_text(shape, &text, span)
            }
            Operand::Typed(expr) if self.character_shape(&expr).is_some_and(|own| own.wide == shape.wide) => {
                let from = if shape.wide { ElementaryType::Wchar } else { ElementaryType::Char };
                let span = expr.span;
                self.formatted_number(expr, from, shape, span)
            }
            Operand::Typed(expr) if self.shape(expr.ty).is_some_and(|found| found.wide == shape.wide) => {
                if self.most_characters(expr.span).is_some_and(|most| shape.capacity > most) {
                    self.warn_of_cut_text(&expr);
                }
                self.fitted(expr, shape)
            }
            other => {
                let (wanted, found) = (shape.keyword(), self.describe(&other));
                let message = format!("{wanted} is wanted, this is {found}");
                let mut report = Diagnostic::error(Code::TypeMismatch, other.span(), message);
                report = match &other {
                    Operand::Text { .. } if shape.wide => report.with_help("write it between double quotes"),
                    Operand::Text { .. } => report.with_help("write it between single quotes"),
                    _ => report.with_help(format!("convert it with TO_{wanted}")),
                };
                self.report(report);
                None
            }
        }
    }

    /// The string of its own that a character may stand for (3rd ed. Figure 12).
    fn character_shape(&self, expr: &Expr) -> Option<TextShape> {
        let dialect = self.declarations.dialect(expr.span);
        let wide = match self.elementary(expr.ty).filter(|_| dialect.has(Feature::CharactersAsText))? {
            ElementaryType::Char => false,
            ElementaryType::Wchar => true,
            _ => return None,
        };
        Some(TextShape { wide, capacity: 1, memory: dialect.strings() })
    }

    /// The character as a string of its own, if it may stand for one.
    pub(super) fn one_character(&mut self, expr: Expr) -> Option<Expr> {
        match self.character_shape(&expr) {
            Some(shape) => self.coerce_text(Operand::Typed(expr), shape),
            None => Some(expr),
        }
    }

    /// Of two values the character beside a string as a string; a literal stands for either.
    fn alike_texts(&mut self, left: Operand, right: Operand) -> Option<(Operand, Operand)> {
        let is_string = |operand: &Operand| operand.typed().is_some_and(|expr| self.shape(expr.ty).is_some());
        let (left_is_string, right_is_string) = (is_string(&left), is_string(&right));
        Some(match (left, right) {
            (Operand::Typed(left), right) if right_is_string => (Operand::Typed(self.one_character(left)?), right),
            (left, Operand::Typed(right)) if left_is_string => (left, Operand::Typed(self.one_character(right)?)),
            others => others,
        })
    }

    /// A STRING between double quotes, where the dialect's tools write it so; all else as it is.
    fn between_other_quotes(&mut self, operand: Operand, shape: TextShape) -> Operand {
        match operand {
            Operand::Text { text, span }
                if text.wide
                    && !shape.wide
                    && text.units.iter().all(|unit| *unit < 0x100)
                    && self.declarations.dialect(span).has(Feature::DoubleQuotes) =>
            {
                let message = "a STRING stands between single quotes";
                self.report(Diagnostic::warning(Code::TypeMismatch, span, message));
                Operand::Text { text: Text { wide: false, ..text }, span }
            }
            other => other,
        }
    }

    fn warn_if_cut(&mut self, text: &Text, shape: TextShape, span: Span) {
        if text.units.len() > shape.capacity as usize {
            let message = format!("only the first {} of {} characters fit", shape.capacity, text.units.len());
            self.report(Diagnostic::warning(Code::OutOfRange, span, message));
        }
    }

    /// A string in another shape, which may differ in width too.
    fn fitted(&mut self, expr: Expr, shape: TextShape) -> Option<Expr> {
        if self.shape(expr.ty) == Some(shape) {
            return Some(expr);
        }
        let span = expr.span;
        self.text_edit(Edit::Fit, vec![expr], shape, span)
    }

    /// A string made by a function.
    fn text_edit(&mut self, edit: Edit, operands: Vec<Expr>, shape: TextShape, span: Span) -> Option<Expr> {
        self.made_text(TextFunction::Edit(edit), operands, shape, span)
    }

    fn made_text(&mut self, function: TextFunction, operands: Vec<Expr>, shape: TextShape, span: Span) -> Option<Expr> {
        let ty = self.declarations.types_mut().string(shape);
        let target = Some(self.temporary(ty, span)?);
        let call = TextCall { function, operands, target };
        Some(Expr { kind: ExprKind::Text(Box::new(call)), ty, span })
    }

    /// A number that a function gives of strings.
    fn text_number(function: TextFunction, operands: Vec<Expr>, ty: ElementaryType, span: Span) -> Expr {
        let call = TextCall { function, operands, target: None };
        Expr { kind: ExprKind::Text(Box::new(call)), ty: ty.into(), span }
    }

    /// Strings are ordered character by character, from the left (2nd ed. Table 28).
    pub(super) fn text_comparison(
        &mut self,
        operator: Binary,
        left: Operand,
        right: Operand,
        span: Span,
    ) -> Option<Operand> {
        let (left, right) = self.alike_texts(left, right)?;
        let character = |operand: &Operand| matches!(operand, Operand::Typed(expr) if self.plain_elementary(expr).is_some_and(ElementaryType::is_character));
        if character(&left) != character(&right) {
            let pair = self.unify(operator, left, right, "characters", span)?;
            let kind = ExprKind::Binary(operator, Box::new(pair.left), Box::new(pair.right));
            return Some(Operand::Typed(Expr { kind, ty: ElementaryType::Bool.into(), span }));
        }
        if !self.is_text(&left) || !self.is_text(&right) {
            return self.invalid_operands(&left, &right, span);
        }
        let (left, right) = (self.settle(left)?, self.settle(right)?);
        self.warn_of_cut_text(&left);
        self.warn_of_cut_text(&right);
        if self.shape(left.ty).map(|shape| shape.wide) != self.shape(right.ty).map(|shape| shape.wide) {
            return self.invalid_operands(&Operand::Typed(left), &Operand::Typed(right), span);
        }
        let dint = ElementaryType::Dint;
        let order = Self::text_number(TextFunction::Compare, vec![left, right], dint, span);
        let zero = constant(Value::Int(0), dint, span);
        let kind = ExprKind::Binary(operator, Box::new(order), Box::new(zero));
        Some(Operand::Typed(Expr { kind, ty: ElementaryType::Bool.into(), span }))
    }

    /// All operands as strings that hold the longest.
    pub(super) fn unify_texts(&mut self, operands: Vec<Operand>, span: Span) -> Option<(Vec<Expr>, TypeId)> {
        let mut widest: Option<TextShape> = None;
        for operand in &operands {
            let shape = match operand {
                Operand::Text { text, span } => Some(self.own_shape(text, text.units.len().max(1) as u32, *span)),
                Operand::Typed(expr) => self.character_shape(expr).or_else(|| self.shape(expr.ty)),
                _ => None,
            };
            widest = match (widest, shape) {
                (Some(known), Some(shape)) if known.wide != shape.wide => None,
                (Some(known), Some(shape)) => Some(if shape.capacity > known.capacity { shape } else { known }),
                (None, shape) => shape,
                (_, None) => None,
            };
            if widest.is_none() {
                return self.invalid_operands(&operands[0], operand, span);
            }
        }
        let shape = widest?;
        let ty = self.declarations.types_mut().string(shape);
        let all = operands.into_iter().map(|operand| self.coerce_text(operand, shape));
        Some((all.collect::<Option<_>>()?, ty))
    }

    /// The bytes of a string's initial value: a literal or a constant (2nd ed. 2.4.3.2).
    pub(in crate::check) fn text_image(&mut self, shape: TextShape, expr: &ast::Expr) -> Option<Vec<u8>> {
        let operand = match self.constant_text(expr) {
            Some(text) => Operand::Text { text, span: expr.span },
            None => self.expression(expr)?,
        };
        match self.between_other_quotes(operand, shape) {
            Operand::Text { text, span } if text.wide == shape.wide => {
                self.warn_if_cut(&text, shape, span);
                Some(shape.encode(&text.units))
            }
            Operand::Typed(typed) if self.shape(typed.ty).is_some() => {
                let message = "a constant is wanted here";
                self.report(Diagnostic::error(Code::NotConstant, typed.span, message));
                None
            }
            other => self.coerce_text(other, shape).and(None),
        }
    }

    /// The characters of a `CONSTANT` string.
    pub(in crate::check) fn constant_text(&mut self, expr: &ast::Expr) -> Option<Text> {
        let name = match &expr.kind {
            ast::ExprKind::Name(name) => name.clone(),
            ast::ExprKind::Member(..) => self.qualified_name(expr)?,
            _ => return None,
        };
        let variable = self.variable_named(&name)?.ok()?;
        let shape = self.shape(variable.ty).filter(|_| variable.is_constant)?;
        Some(Text { wide: shape.wide, units: shape.decode(&variable.image) })
    }
}
