//! Functions of character strings (2nd ed. 2.5.1.5.5 Table 29, 3rd ed. Table 34).
//!
//! | error of the standard | what is given |
//! |---|---|
//! | length below 0 | as a length of 0 |
//! | length beyond the string's end | up to the end |
//! | position outside of the string: MID | the empty string |
//! | position outside of the string: INSERT, DELETE, REPLACE | the first string as it is |
//! | result longer than its place | cut off |
//! | string longer than vendors' functions take or give | cut off |

use crate::check::body::Body;
use crate::check::standard::text::TextForm;
use crate::check::types::operand::{Operand, converted};
use crate::ir::text::{Edit, TextFunction, TextShape};
use crate::ir::{ElementaryType, Expr, Rounding};
use crate::syntax::Span;

impl Body<'_, '_> {
    pub(in crate::check::body) fn text_function(
        &mut self,
        form: TextForm,
        operands: Vec<Operand>,
        span: Span,
    ) -> Option<Operand> {
        match form {
            TextForm::Length => self.text_measure(TextFunction::Length, operands, span),
            TextForm::Find => self.text_measure(TextFunction::Find, operands, span),
            TextForm::Edit(Edit::Concat) => self.concat(operands, span),
            TextForm::Edit(edit) => self.edit(edit, operands, span),
        }
    }

    /// The result is of any integer type (`ANY_INT`): the place's own, else INT.
    fn text_measure(&mut self, function: TextFunction, operands: Vec<Operand>, span: Span) -> Option<Operand> {
        let strings = self.strings(operands)?;
        for each in &strings {
            self.warn_of_cut_text(each);
        }
        let counted =
            strings.first().and_then(|first| self.shape(first.ty)).map_or(ElementaryType::Int, TextShape::number);
        let number = Self::text_number(function, strings, counted, span);
        let wanted = self.context.filter(|ty| ty.is_integer() && ty.size() > 1);
        let ty = wanted.unwrap_or(ElementaryType::Int);
        Some(Operand::Typed(converted(number, ty, Rounding::NearestEven)))
    }

    /// Operands that must be strings of one width.
    fn strings(&mut self, operands: Vec<Operand>) -> Option<Vec<Expr>> {
        let mut strings: Vec<Expr> = Vec::new();
        for operand in operands {
            let known = strings.first().and_then(|first| self.shape(first.ty)).map(|shape| shape.wide);
            let expr = self.settle(operand)?;
            let expr = self.one_character(expr)?;
            let found = self.shape(expr.ty).map(|shape| shape.wide);
            if found.is_none() || known.is_some() && known != found {
                let wanted = if known == Some(true) { "a WSTRING" } else { "a STRING" };
                let found = self.type_name(expr.ty);
                return self.mismatch(wanted, &found, expr.span);
            }
            strings.push(self.taken_by_function(expr)?);
        }
        Some(strings)
    }

    fn concat(&mut self, operands: Vec<Operand>, span: Span) -> Option<Operand> {
        let mut strings = self.strings(operands)?.into_iter();
        let mut whole = strings.next()?;
        for next in strings {
            whole = self.joined(Edit::Concat, vec![whole, next], Vec::new(), span)?;
        }
        Some(Operand::Typed(whole))
    }

    fn edit(&mut self, edit: Edit, mut operands: Vec<Operand>, span: Span) -> Option<Operand> {
        let numbers = operands.split_off(edit.strings().min(operands.len()));
        let strings = self.strings(operands)?;
        // The beginning of what is cut is the same.
        if edit != Edit::Left {
            for each in &strings {
                self.warn_of_cut_text(each);
            }
        }
        let numbers = numbers.into_iter().map(|operand| self.integer_as_lint(operand));
        let numbers = numbers.collect::<Option<Vec<_>>>()?;
        self.joined(edit, strings, numbers, span).map(Operand::Typed)
    }

    /// The result holds the characters of all operands.
    fn joined(&mut self, edit: Edit, strings: Vec<Expr>, numbers: Vec<Expr>, span: Span) -> Option<Expr> {
        // What would not fit memory is cut off, and not made.
        let limit = (self.declarations.memory_limit() / 2) as u32 - 1;
        let limit = self.most_characters(span).map_or(limit, |most| most.min(limit));
        let shapes = strings.iter().filter_map(|each| self.shape(each.ty));
        let shape = shapes.reduce(|sum, each| TextShape {
            wide: sum.wide,
            memory: sum.memory,
            capacity: (sum.capacity + each.capacity).min(TextShape::most(sum.memory)).min(limit),
        })?;
        let operands = strings.into_iter().chain(numbers).collect();
        self.text_edit(edit, operands, shape, span)
    }
}
