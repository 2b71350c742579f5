//! FOR as WHILE: MatIEC passes over a FOR whose first value is its last, and leaves its variable at the last value
//! where other tools leave it behind that.

use super::{Finding, Page};
use crate::output::scl::scope::Scope;
use onescan_iec::source::edits::Edits;
use onescan_iec::syntax::Span;
use onescan_iec::syntax::ast::{Expr, ExprKind, ForStatement, Literal, Pou, Statement, StatementKind, UnaryOp};
use onescan_iec::syntax::lexer::tokenize_in;
use onescan_iec::syntax::token::{Keyword, TokenKind};
use onescan_iec::syntax::walk::{self, Visitor};

/// Loops with no other inside; the next round takes those around them.
pub(super) fn lower(page: &Page<'_>, edits: &mut Edits) -> Vec<Finding> {
    let mut findings = Vec::new();
    for pou in page.pous() {
        let mut loops = Loops { found: Vec::new() };
        walk::with_members(pou, &mut loops);
        let inner: Vec<_> = loops
            .found
            .iter()
            .filter(|(span, _)| !loops.found.iter().any(|(other, _)| within(*other, *span)))
            .collect();
        let scope = Scope::of(pou);
        for (number, (span, inner)) in inner.into_iter().enumerate() {
            let place = Place { page, pou, scope: &scope, span: *span, number: number + 1 };
            if let Err(found) = place.lower(inner, edits) {
                findings.push(found);
            }
        }
    }
    findings
}

fn within(inner: Span, outer: Span) -> bool {
    inner != outer && outer.start <= inner.start && inner.end <= outer.end
}

pub(super) struct Loops {
    pub(super) found: Vec<(Span, ForStatement)>,
}

impl Visitor for Loops {
    fn statement(&mut self, statement: &Statement) {
        if let StatementKind::For(inner) = &statement.kind {
            self.found.push((statement.span, (**inner).clone()));
        }
    }
}

/// Where the word `END_FOR` of a loop begins and ends.
pub(super) fn end_of(page: &Page<'_>, span: Span) -> Option<(u32, u32)> {
    let tokens = tokenize_in(page.file.dialect(), page.file.text());
    let inside = tokens.iter().rev().skip_while(|token| token.start >= span.end);
    let mut inside = inside.take_while(|token| token.start >= span.start);
    inside.find(|token| token.kind == TokenKind::Keyword(Keyword::EndFor)).map(|token| (token.start, token.end))
}

struct Place<'p, 'a> {
    page: &'p Page<'a>,
    pou: &'a Pou,
    scope: &'p Scope<'a>,
    span: Span,
    number: usize,
}

impl Place<'_, '_> {
    fn lower(&self, inner: &ForStatement, edits: &mut Edits) -> Result<(), Finding> {
        let ForStatement { variable, from, to, by, .. } = inner;
        let step = match by {
            None => 1,
            Some(by) => self
                .page
                .names
                .integer_with(by, &self.scope.constants)
                .filter(|step| *step != 0)
                .ok_or_else(|| Finding::new(by.span, "BY other than a constant", "write the loop with WHILE"))?,
        };
        let Some((end, behind)) = end_of(self.page, self.span) else { return Ok(()) };
        let [name, first, last] = [variable, from, to].map(|part| self.page.text(part.span));
        let limit = if is_constant(to) || self.page.names.integer_with(to, &self.scope.constants).is_some() {
            last.to_owned()
        } else {
            self.noted_limit(variable, edits)?
        };
        let noted = if limit == last { String::new() } else { format!("{limit} := {last}; ") };
        let (relation, sign) = if step > 0 { ("<=", "+") } else { (">=", "-") };
        let head = format!("{name} := {first}; {noted}WHILE {name} {relation} {limit}");
        let head_end = by.as_ref().map_or(to.span.end, |by| by.span.end);
        edits.replace(self.span.start..head_end, head);
        edits.replace(end..behind, format!("{name} := {name} {sign} {}; END_WHILE", step.abs()));
        Ok(())
    }

    /// The last value is taken once, before the loop.
    fn noted_limit(&self, variable: &Expr, edits: &mut Edits) -> Result<String, Finding> {
        let help = "declare its variable with an elementary type";
        let ty = self.scope.type_of(self.page.names, variable);
        let ty = ty.ok_or_else(|| Finding::new(variable.span, "a loop of this variable", help))?;
        let limit = format!("Last_{}_{}", self.span.start, self.number);
        let at = self.pou.sections.last().map_or(self.pou.name.span.end, |section| section.span.end);
        edits.insert(at, format!("\nVAR {limit} : {}; END_VAR\n", ty.name()));
        Ok(limit)
    }
}

fn is_constant(expr: &Expr) -> bool {
    match &expr.kind {
        ExprKind::Literal(Literal::Integer(_) | Literal::Typed { .. }) => true,
        ExprKind::Unary(UnaryOp::Negate | UnaryOp::Plus, inner) | ExprKind::Paren(inner) => is_constant(inner),
        _ => false,
    }
}
