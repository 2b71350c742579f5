//! Branches without statements, which MatIEC does not take.

use super::{Finding, Page};
use onescan_iec::source::edits::Edits;
use onescan_iec::syntax::Span;
use onescan_iec::syntax::ast::{Statement, StatementKind};
use onescan_iec::syntax::lexer::tokenize_in;
use onescan_iec::syntax::token::{Keyword, Punctuation, TokenKind};
use onescan_iec::syntax::walk::{self, Visitor};

/// A statement that does nothing.
const NOTHING: &str = " WHILE FALSE DO EXIT; END_WHILE;";

/// Puts a statement into every branch that has none, and takes semicolons out that end none.
pub(super) fn fill(page: &Page<'_>, edits: &mut Edits) -> Vec<Finding> {
    for pou in page.pous() {
        let mut writer = Writer { page, edits };
        walk::with_members(pou, &mut writer);
        writer.list(&pou.body, None);
        pou.object.members.iter().for_each(|member| writer.list(&member.pou.body, None));
    }
    Vec::new()
}

struct Writer<'w, 'a> {
    page: &'w Page<'a>,
    edits: &'w mut Edits,
}

impl Writer<'_, '_> {
    /// `behind` is what stands before the branch, and the kinds of word that open it.
    fn list(&mut self, list: &[Statement], behind: Option<(u32, &[TokenKind])>) {
        let is_empty = |each: &&Statement| matches!(each.kind, StatementKind::Empty);
        let is_without = behind.is_some() && list.iter().all(|each| is_empty(&each));
        for (at, each) in list.iter().filter(is_empty).enumerate() {
            let start = each.span.start;
            let rest = self.page.file.text().get(start as usize..).unwrap_or("");
            let end = rest.find(';').map_or(each.span.end, |semicolon| start + semicolon as u32 + 1);
            self.edits.replace(start..end, if is_without && at == 0 { NOTHING } else { "" });
        }
        let opened = behind.and_then(|(from, words)| self.word(from, words));
        if let Some(at) = opened.filter(|_| list.is_empty()) {
            self.edits.insert(at, NOTHING);
        }
    }

    /// Behind the next word of one of these kinds.
    fn word(&self, from: u32, words: &[TokenKind]) -> Option<u32> {
        let tokens = tokenize_in(self.page.file.dialect(), self.page.file.text());
        tokens.iter().find(|token| token.start >= from && words.contains(&token.kind)).map(|token| token.end)
    }

    fn branch(&mut self, list: &[Statement], head: Span, word: TokenKind) {
        self.list(list, Some((head.end, &[word])));
    }
}

impl Visitor for Writer<'_, '_> {
    fn statement(&mut self, statement: &Statement) {
        let keyword = TokenKind::Keyword;
        match &statement.kind {
            StatementKind::If(inner) => {
                for branch in &inner.branches {
                    self.branch(&branch.body, branch.condition.span, keyword(Keyword::Then));
                }
                if !inner.otherwise.is_empty() {
                    self.list(&inner.otherwise, Some((0, &[])));
                }
            }
            StatementKind::Case(inner) => {
                for branch in &inner.branches {
                    let label = branch.labels.last().map(|label| label.high.as_ref().unwrap_or(&label.low).span);
                    if let Some(label) = label {
                        self.branch(&branch.body, label, TokenKind::Punctuation(Punctuation::Colon));
                    }
                }
                if !inner.otherwise.is_empty() {
                    self.list(&inner.otherwise, Some((0, &[])));
                }
            }
            StatementKind::While(inner) => self.branch(&inner.body, inner.condition.span, keyword(Keyword::Do)),
            StatementKind::Repeat(inner) => {
                self.list(&inner.body, Some((statement.span.start, &[keyword(Keyword::Repeat)])));
            }
            _ => {}
        }
    }
}
