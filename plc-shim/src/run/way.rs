//! Which way a statement with several ways went: IF, CASE and loops.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

use crate::application::Application;
use crate::compile::points::PointKind;
use crate::syntax::token::{Keyword, TokenKind};
use crate::syntax::{Span, tokenize};

/// A way of a statement in an application.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct WayId(pub(super) u32);

/// A statement with several ways, and one of them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Way {
    /// The unit of the statement.
    pub unit: String,
    /// Its file.
    pub file: String,
    /// Its line, from 1.
    pub line: u32,
    /// Its column in characters, from 1.
    pub column: u32,
    /// Its number among the decisions of its unit in the order of the text, from 0, and how many
    /// there are.
    pub number: (u32, u32),
    /// What is decided, as it is written: `IF a > b`, `CASE n`, `FOR i := 1 TO 3`, `WHILE run`, `REPEAT`.
    pub question: String,
    /// The number of the way among those of the statement, from 0; nothing for ELSE and the end of a
    /// loop.
    pub branch: Option<u32>,
    /// The way: `THEN`, `ELSIF c`, `ELSE`, `arm 2`; of a loop `a turn` or `its end`.
    pub answer: String,
}

/// `IF a > b: THEN`.
impl fmt::Display for Way {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}: {}", self.question, self.answer)
    }
}

/// Most characters of a question that are shown.
const QUESTION_CHARACTERS: usize = 120;

impl Application {
    /// All ways of its statements; none unless it was compiled for
    /// [`SoftPlc::ways`](crate::SoftPlc::ways).
    pub fn ways(&self) -> BTreeMap<WayId, Way> {
        let outcomes = self.points().iter().zip(0..).filter_map(|(point, id)| match point.kind {
            PointKind::Outcome(outcome) => Some((WayId(id), point, outcome)),
            _ => None,
        });
        let outcomes: Vec<_> = outcomes.collect();
        let mut decisions: BTreeMap<&str, BTreeSet<_>> = BTreeMap::new();
        let mut last: BTreeMap<_, u32> = BTreeMap::new();
        for (_, point, outcome) in &outcomes {
            let key = (point.span.file, point.span.start, point.span.end);
            decisions.entry(&point.unit).or_default().insert(key);
            let last = last.entry(key).or_default();
            *last = (*last).max(*outcome);
        }
        let way = |(id, point, outcome): &(WayId, &crate::compile::points::Point, u32)| {
            let key = (point.span.file, point.span.start, point.span.end);
            let of_unit = decisions.get(point.unit.as_str())?;
            let number = of_unit.iter().position(|decision| *decision == key)? as u32;
            let is_last = last.get(&key) == Some(outcome);
            let (question, answer) = words(self.sources().text(point.span), *outcome, is_last);
            let (file, place) = self.sources().locate(point.span);
            let (line, column) = (place.line, place.column);
            let (unit, file) = (point.unit.clone(), file.to_owned());
            let (number, branch) = ((number, of_unit.len() as u32), (!is_last).then_some(*outcome));
            Some((*id, Way { unit, file, line, column, number, question, branch, answer }))
        };
        outcomes.iter().filter_map(way).collect()
    }

    /// The text of a span on one line, its beginning if it is long.
    pub(super) fn shown(&self, span: Span) -> String {
        on_one_line(self.sources().text(span))
    }

    /// The conditions of a statement that has other statements in it.
    pub(super) fn conditions(&self, span: Span) -> Option<String> {
        let heads = heads(self.sources().text(span));
        let whole = heads.iter().map(|head| on_one_line(head)).collect::<Vec<_>>().join(" … ");
        (!whole.is_empty()).then_some(whole)
    }
}

/// Blanks drawn together; the beginning of a long text.
fn on_one_line(text: &str) -> String {
    let whole = text.split_whitespace().collect::<Vec<_>>().join(" ");
    let mut shown: String = whole.chars().take(QUESTION_CHARACTERS).collect();
    if shown.len() < whole.len() {
        shown.push('…');
    }
    shown
}

/// What is decided by a statement, and the name of one of its ways.
fn words(statement: &str, outcome: u32, is_last: bool) -> (String, String) {
    let heads = heads(statement);
    let question = heads.first().map(|head| on_one_line(head)).unwrap_or_default();
    let first = question.split(' ').next().unwrap_or_default().to_ascii_uppercase();
    let answer = match (first.as_str(), outcome) {
        ("FOR" | "WHILE" | "REPEAT", 0) => "a turn".to_owned(),
        ("FOR" | "WHILE" | "REPEAT", _) => "its end".to_owned(),
        (_, _) if is_last => "ELSE".to_owned(),
        ("CASE", arm) => format!("arm {}", arm + 1),
        (_, 0) => "THEN".to_owned(),
        (_, branch) => heads.get(branch as usize).map_or_else(|| format!("branch {}", branch + 1), |c| on_one_line(c)),
    };
    (question, answer)
}

/// The statement's own conditions with the word before each: up to THEN, OF or DO, but for those of
/// statements inside it. Comments are part of none.
fn heads(statement: &str) -> Vec<String> {
    use Keyword as K;
    let mut heads = Vec::new();
    let (mut depth, mut open) = (0_usize, false);
    for token in tokenize(statement) {
        let text = statement.get(token.start as usize..token.end as usize).unwrap_or("");
        let TokenKind::Keyword(keyword) = token.kind else {
            if let Some(head) = heads.last_mut().filter(|_| open) {
                let as_blank = matches!(token.kind, TokenKind::BlockComment | TokenKind::LineComment);
                String::push_str(head, if as_blank { " " } else { text });
            }
            continue;
        };
        match keyword {
            K::If | K::Case | K::For | K::While | K::Repeat => {
                depth += 1;
                if depth == 1 {
                    heads.push(text.to_owned());
                    open = keyword != K::Repeat;
                }
            }
            K::EndIf | K::EndCase | K::EndFor | K::EndWhile | K::EndRepeat => depth = depth.saturating_sub(1),
            K::Elsif if depth == 1 => {
                heads.push(text.to_owned());
                open = true;
            }
            K::Then | K::Of | K::Do if depth == 1 => open = false,
            _ => {
                if let Some(head) = heads.last_mut().filter(|_| open) {
                    head.push_str(text);
                }
            }
        }
    }
    heads
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ways_have_names() {
        let named = |text: &str, outcome, is_last| {
            let (question, answer) = words(text, outcome, is_last);
            format!("{question}: {answer}")
        };
        let branches = "IF a > b (* then *) AND\n  c THEN IF x THEN y; END_IF; ELSIF d OR e THEN z; ELSE w; END_IF";
        assert_eq!(named(branches, 0, false), "IF a > b AND c: THEN");
        assert_eq!(named(branches, 1, false), "IF a > b AND c: ELSIF d OR e");
        assert_eq!(named(branches, 2, true), "IF a > b AND c: ELSE");
        let arms = "case n of 1: x := 1; 2, 3: IF y THEN z; END_IF; END_CASE";
        assert_eq!(named(arms, 1, false), "case n: arm 2");
        assert_eq!(named(arms, 2, true), "case n: ELSE");
        assert_eq!(named("FOR i := 1 TO 3 DO a; END_FOR", 0, false), "FOR i := 1 TO 3: a turn");
        assert_eq!(named("REPEAT a; UNTIL b END_REPEAT", 1, true), "REPEAT: its end");
        assert_eq!(named("no statement of these", 0, false), ": THEN");
    }
}
