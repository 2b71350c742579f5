//! Which way a statement with several ways went: IF, CASE and loops.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::ops::Range;

use crate::application::Application;
use crate::compile::points::PointKind;
use onescan_iec::syntax::token::{Keyword, TokenKind};
use onescan_iec::syntax::{Span, tokenize};

/// A way of a statement in an application.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct WayId(pub(super) u32);

/// A statement with several ways, and one of them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Way {
    /// The unit of the statement.
    pub unit: String,
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

/// The statement's own conditions with the word before each, except those of statements inside it. Comments are
/// part of none.
fn heads(statement: &str) -> Vec<String> {
    let of = |range: &Range<usize>| {
        let tokens = tokenize(statement)
            .into_iter()
            .filter(|token| range.start <= token.start as usize && token.end as usize <= range.end);
        let text = tokens.map(|token| match token.kind {
            TokenKind::BlockComment | TokenKind::LineComment => " ",
            _ => statement.get(token.start as usize..token.end as usize).unwrap_or(""),
        });
        text.collect()
    };
    conditions(statement).iter().map(of).collect()
}

/// Where the statement's own conditions stand: from the word before each up to THEN, OF or DO, or the end.
fn conditions(statement: &str) -> Vec<Range<usize>> {
    use Keyword as K;
    let mut found = Vec::new();
    let (mut depth, mut open) = (0_usize, None);
    for token in tokenize(statement) {
        let TokenKind::Keyword(keyword) = token.kind else { continue };
        let (start, end) = (token.start as usize, token.end as usize);
        match keyword {
            K::If | K::Case | K::For | K::While | K::Repeat => {
                depth += 1;
                if depth == 1 && keyword == K::Repeat {
                    found.push(start..end);
                } else if depth == 1 {
                    open = Some(start);
                }
            }
            K::EndIf | K::EndCase | K::EndFor | K::EndWhile | K::EndRepeat => {
                depth = depth.saturating_sub(1);
                if depth == 0 {
                    found.extend(open.take().map(|open| open..start));
                }
            }
            K::Elsif | K::Until if depth == 1 => open = Some(start),
            K::Then | K::Of | K::Do if depth == 1 => found.extend(open.take().map(|open| open..start)),
            _ => {}
        }
    }
    found.extend(open.map(|open| open..statement.len()));
    found
}

/// What a statement says itself, line by line from `first` on: all of it, or its conditions if it has statements in
/// it. Comments are not part of it.
pub(super) fn rows(statement: &str, first: u32) -> Vec<(u32, String)> {
    let mut own = conditions(statement);
    if own.is_empty() {
        own.push(0..statement.len());
    }
    let mut rows: Vec<(u32, String)> = Vec::new();
    let mut line = first;
    for token in tokenize(statement) {
        let range = token.start as usize..token.end as usize;
        let text = statement.get(range.clone()).unwrap_or("");
        if !token.kind.is_trivia() && own.iter().any(|own| own.start <= range.start && range.end <= own.end) {
            match rows.last_mut().filter(|(last, _)| *last == line) {
                Some((_, row)) => {
                    row.push(' ');
                    row.push_str(text);
                }
                None => rows.push((line, text.to_owned())),
            }
        }
        line += text.matches('\n').count() as u32;
    }
    rows
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

    #[test]
    fn the_rows_of_a_statement_are_its_own() {
        let reported = |text| rows(text, 7).into_iter().map(|(line, row)| format!("{line}: {row}")).collect::<Vec<_>>();
        assert_eq!(
            reported("IF a (* or b *)\n  AND c THEN\n x := 1;\nELSIF d THEN\n y; END_IF"),
            ["7: IF a", "8: AND c", "10: ELSIF d"]
        );
        assert_eq!(reported("f(a := 1, // one\n\n  b := 2)"), ["7: f ( a := 1 ,", "9: b := 2 )"]);
        assert_eq!(reported("REPEAT\n x := 1;\nUNTIL x > 3\nEND_REPEAT"), ["7: REPEAT", "9: UNTIL x > 3"]);
    }
}
