//! Conversions of values to text and back (2nd ed. Table 22, 3rd ed. Table 27).
//!
//! | type | text |
//! |---|---|
//! | BOOL | `TRUE`, `FALSE` |
//! | integers, bit strings, enumerations | decimal; an enumeration's name where its attribute says so |
//! | REAL, LREAL | the shortest that reads back as the same number: `1.5`, `100.0`, `1.0E+20` |
//! | TIME, LTIME | `T#1h2m3s4ms`, `LT#...`; `LTIME#...` where that has no sign |
//! | dates | `D#1994-06-15`, `TOD#15:36:55.36`, `DT#1994-06-15-15:36:55.36`, `LD#...` |
//! | CHAR, WCHAR | the character; the first one the other way |
//!
//! The other way blanks in front are passed and the longest text that is a value is taken; what
//! is out of range becomes the nearest limit, what has no value 0.

use crate::check::body::Body;
use crate::check::standard::text_conversion::{Sort, TextConversion};
use crate::check::types::operand::Operand;
use crate::diagnostic::{Code, Diagnostic};
use crate::dialect::LongTime;
use crate::ir::text::{TextFunction, TextShape};
use crate::ir::{ElementaryType, Expr};
use crate::syntax::Span;

/// Longest text of a value of elementary type.
const VALUE_CAPACITY: u32 = 48;

impl Body<'_, '_> {
    pub(in crate::check) fn text_conversion(
        &mut self,
        conversion: TextConversion,
        operand: Operand,
        span: Span,
    ) -> Option<Operand> {
        let expr = match conversion.from {
            Some(Sort::Value(from)) => self.coerce(operand, from.into())?,
            Some(Sort::Text { wide }) => {
                let expr = self.settle(operand)?;
                if self.shape(expr.ty).is_none_or(|shape| shape.wide != wide) {
                    let found = self.type_name(expr.ty);
                    return self.mismatch(if wide { "WSTRING" } else { "STRING" }, &found, expr.span);
                }
                expr
            }
            None => self.settle(operand)?,
        };
        match conversion.to {
            Sort::Value(to) => self.parsed(expr, to, span),
            Sort::Text { wide } => self.formatted(expr, wide, span),
        }
    }

    /// The value that a text stands for.
    pub(in crate::check::body) fn parsed(&mut self, text: Expr, to: ElementaryType, span: Span) -> Option<Operand> {
        if self.shape(text.ty).is_none() {
            let found = self.type_name(text.ty);
            return self.mismatch("a string", &found, text.span);
        }
        self.warn_of_cut_text(&text);
        Some(Operand::Typed(Self::text_number(TextFunction::Parse(to), vec![text], to, span)))
    }

    fn formatted(&mut self, expr: Expr, wide: bool, span: Span) -> Option<Operand> {
        if let Some(shape) = self.shape(expr.ty) {
            return self.fitted(expr, TextShape { wide, ..shape }).map(Operand::Typed);
        }
        let Some(from) = self.elementary(expr.ty) else {
            let message = format!("there is no conversion from {} to a string", self.type_name(expr.ty));
            self.report(Diagnostic::error(Code::InvalidOperand, span, message));
            return None;
        };
        let shape = TextShape { wide, capacity: VALUE_CAPACITY, memory: self.declarations.dialect(span).strings() };
        match self.values_shown_by_name(expr.ty) {
            Some(values) => self.name_as_text(expr, &values, shape, span),
            None => self.formatted_number(expr, from, shape, span).map(Operand::Typed),
        }
    }

    pub(super) fn formatted_number(
        &mut self,
        expr: Expr,
        from: ElementaryType,
        shape: TextShape,
        span: Span,
    ) -> Option<Expr> {
        let is_long =
            from == ElementaryType::Ltime && self.declarations.dialect(span).long_time() == LongTime::Unsigned64;
        let function = if is_long { TextFunction::FormatLongTime } else { TextFunction::Format(from) };
        self.made_text(function, vec![expr], shape, span)
    }
}
