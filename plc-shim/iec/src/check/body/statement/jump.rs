//! Labels and jumps: of networks (2nd ed. 4.1.4, 3rd ed. 8.1.5), of lists of instructions (2nd ed.
//! 3.2.2), and of vendors' Structured Text.
//!
//! A jump leads to a label of its own list of statements or of one around it, so never into a branch or
//! loop.

use crate::check::body::Body;
use crate::diagnostic::{Code, Diagnostic, did_you_mean};
use crate::ir::{ElementaryType, LabelId, Labelled, LocalId, Statement, StatementKind};
use crate::syntax::ast::{self, Ident};

/// The labels of one list of statements.
#[derive(Debug)]
pub(in crate::check::body) struct Labels {
    /// Names as keys in the order of the list.
    known: Vec<(String, LabelId)>,
    /// How many of them have been passed.
    passed: usize,
    /// Holds where to go on after a jump backwards.
    register: Option<LocalId>,
}

/// The name of the label that the statement is.
fn label(statement: &ast::Statement) -> Option<&Ident> {
    match &statement.kind {
        ast::StatementKind::Label(name) => Some(name),
        _ => None,
    }
}

pub(super) fn has_labels(list: &[ast::Statement]) -> bool {
    list.iter().any(|statement| label(statement).is_some())
}

impl Body<'_, '_> {
    pub(super) fn labelled(&mut self, list: &[ast::Statement]) -> Vec<Statement> {
        let mut labels: Vec<(String, LabelId)> = Vec::new();
        for name in list.iter().filter_map(label) {
            if labels.iter().any(|(key, _)| *key == name.key()) {
                let message = format!("there is a label `{}` already", name.text);
                self.report(Diagnostic::error(Code::DuplicateName, name.span, message));
            }
            labels.push((name.key(), LabelId(self.label_count)));
            self.label_count += 1;
        }
        let ids: Vec<LabelId> = labels.iter().map(|(_, id)| *id).collect();
        self.labels.push(Labels { known: labels, passed: 0, register: None });
        let mut parts = list.split(|statement| label(statement).is_some()).map(<[ast::Statement]>::to_vec);
        let first = self.unlabelled(&parts.next().unwrap_or_default());
        let mut checked = Vec::new();
        for (id, part) in ids.into_iter().zip(parts) {
            if let Some(labels) = self.labels.last_mut() {
                labels.passed += 1;
            }
            checked.push((id, self.unlabelled(&part)));
        }
        let register = self.labels.pop().and_then(|labels| labels.register);
        let Some(span) = list.first().map(|statement| statement.span) else { return Vec::new() };
        let labelled = Labelled { first, parts: checked, register };
        vec![Statement { kind: StatementKind::Labelled(Box::new(labelled)), span }]
    }

    pub(in crate::check::body) fn jump(&mut self, name: &Ident) -> Option<StatementKind> {
        let key = name.key();
        for level in (0..self.labels.len()).rev() {
            let Some(labels) = self.labels.get(level) else { continue };
            let Some(at) = labels.known.iter().position(|(known, _)| *known == key) else { continue };
            let (_, id) = *labels.known.get(at)?;
            if at < labels.passed && labels.register.is_none() {
                let register = self.scope.register(ElementaryType::Dint);
                self.labels.get_mut(level)?.register = Some(register);
            }
            return Some(StatementKind::Jump(id));
        }
        let known = self.labels.iter().flat_map(|labels| &labels.known).map(|(key, _)| key.as_str());
        let in_try = "no jump leads out of a part of `__TRY`; RETURN, EXIT and CONTINUE do";
        let in_try = (!self.tried.is_empty()).then(|| in_try.to_owned());
        let help = did_you_mean(&name.text, known).or(in_try);
        let message = format!("there is no label `{}` that this jump could lead to", name.text);
        self.report(Diagnostic::error(Code::UnknownLabel, name.span, message).with_optional_help(help));
        None
    }
}
