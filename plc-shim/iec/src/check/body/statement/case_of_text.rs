//! `CASE` of a character string (3rd ed. 7.3.3.3.3: the selector is of any elementary type).

use std::collections::BTreeSet;

use crate::check::body::Body;
use crate::check::types::build::truth;
use crate::check::types::operand::Operand;
use crate::diagnostic::{Code, Diagnostic};
use crate::ir::{Binary, ElementaryType, Expr, ExprKind, IfBranch, Place, StatementKind};
use crate::syntax::ast;

impl Body<'_, '_> {
    /// The selector is read once, then compared with one label after the other.
    pub(super) fn case_of_text(&mut self, selector: Expr, inner: &ast::CaseStatement) -> Option<StatementKind> {
        let (ty, span) = (selector.ty, selector.span);
        let memory = self.temporary(ty, span)?;
        let mut reading = vec![self.assignment(memory.clone(), selector, span)];
        let mut branches = Vec::new();
        let mut known = BTreeSet::new();
        for branch in &inner.branches {
            let condition = self.is_one_of(&memory, &branch.labels, &mut known);
            let body = self.statements(&branch.body);
            branches.extend(condition.map(|condition| IfBranch { condition, body }));
        }
        if branches.is_empty() {
            branches.push(IfBranch { condition: truth(false, span), body: Vec::new() });
        }
        if let Some(first) = branches.first_mut() {
            let condition = std::mem::replace(&mut first.condition, truth(false, span));
            let kind = ExprKind::After(std::mem::take(&mut reading), Some(Box::new(condition)));
            first.condition = Expr { kind, ty: ElementaryType::Bool.into(), span };
        }
        Some(StatementKind::If(branches, self.statements(&inner.otherwise)))
    }

    fn is_one_of(&mut self, text: &Place, labels: &[ast::CaseLabel], known: &mut BTreeSet<Vec<u16>>) -> Option<Expr> {
        let mut found: Option<Expr> = None;
        for label in labels {
            let span = label.low.span;
            if let Some(high) = &label.high {
                let message = "strings have no ranges: write one label for each";
                self.report(Diagnostic::error(Code::InvalidRange, span.to(high.span), message));
                continue;
            }
            let Some(value) = self.within(None, |body| body.expression(&label.low)) else { continue };
            if let Operand::Text { text, .. } = &value
                && !known.insert(text.units.clone())
            {
                let message = "this label is selected by an earlier one already";
                self.report(Diagnostic::warning(Code::DuplicateCase, span, message));
            }
            let kind = ExprKind::Load(text.clone());
            let selector = Operand::Typed(Expr { kind, ty: text.ty, span });
            let Some(Operand::Typed(equal)) = self.text_comparison(Binary::Equal, selector, value, span) else {
                continue;
            };
            found = Some(match found {
                Some(before) => {
                    let kind = ExprKind::Binary(Binary::Or, Box::new(before), Box::new(equal));
                    Expr { kind, ty: ElementaryType::Bool.into(), span }
                }
                None => equal,
            });
        }
        found
    }
}
