//! Statements of actions move into the one action that controls a chart: the standard has no call of an action
//! (2nd ed. 2.6.4.1), and leaves the order in which actions run to the system.
//!
//! | in an action | where it has moved to |
//! |---|---|
//! | `RETURN` | `EXIT` of a loop around the statements that runs once |
//! | `RETURN` in loops | `SDSP_Left_.. := TRUE; EXIT`, and the same `EXIT` behind each of those loops |

use std::ops::Range;

use super::marks;
use onescan_iec::source::edits::{Edited, Edits, LineMap};
use onescan_iec::syntax::ast::{Member, MemberKind, Statement, StatementKind};
use onescan_iec::syntax::token::{Keyword, Punctuation, Token, TokenKind};
use onescan_iec::syntax::tokenize;

/// An action's statements, to be put in at another place.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Moved {
    /// Each line, with the original's line that it comes from. Around them stands what a RETURN needs.
    pub(super) lines: Vec<(String, Option<u32>)>,
    /// There is nothing but comments.
    pub(super) is_empty: bool,
    /// The flag that is set by a RETURN in loops, if there is one. It is the action's own: in it others may be called.
    pub(super) left: Option<String>,
}

/// True for an action that can stand elsewhere: lists of instructions and jumps stay what they are.
pub(super) fn is_movable(member: &Member) -> bool {
    member.kind == MemberKind::Action && member.pou.chart.is_empty() && are_movable(&member.pou.body)
}

fn are_movable(list: &[Statement]) -> bool {
    let stays = |statement: &Statement| {
        matches!(statement.kind, StatementKind::Instruction(_) | StatementKind::Label(_) | StatementKind::Jump(_))
    };
    list.iter().all(|statement| !stays(statement) && parts(statement).into_iter().all(are_movable))
}

/// The lists of statements within one.
fn parts(statement: &Statement) -> Vec<&[Statement]> {
    match &statement.kind {
        StatementKind::If(inner) => {
            let branches = inner.branches.iter().map(|branch| branch.body.as_slice());
            branches.chain([inner.otherwise.as_slice()]).collect()
        }
        StatementKind::Case(inner) => {
            let branches = inner.branches.iter().map(|branch| branch.body.as_slice());
            branches.chain([inner.otherwise.as_slice()]).collect()
        }
        StatementKind::Try(inner) => vec![&inner.body, &inner.handler, &inner.finally],
        StatementKind::For(inner) => vec![&inner.body],
        StatementKind::While(inner) => vec![&inner.body],
        StatementKind::Repeat(inner) => vec![&inner.body],
        _ => Vec::new(),
    }
}

/// The text that a chart stands in, and its tokens.
pub(super) struct Text<'t> {
    text: &'t str,
    tokens: Vec<Token>,
}

impl<'t> Text<'t> {
    pub(super) fn new(text: &'t str) -> Self {
        let tokens = tokenize(text).into_iter().filter(|token| !token.kind.is_trivia()).collect();
        Self { text, tokens }
    }

    pub(super) fn part(&self, at: &Range<u32>) -> &'t str {
        self.text.get(at.start as usize..at.end as usize).unwrap_or("")
    }

    /// The place behind `mark` where that is what comes next behind `at`, else `at`.
    pub(super) fn behind(&self, at: u32, mark: Punctuation) -> u32 {
        let next = self.tokens.get(self.tokens.partition_point(|token| token.start < at));
        next.filter(|next| next.kind == TokenKind::Punctuation(mark)).map_or(at, |next| next.end)
    }

    /// Takes an action out, with all that changes in it. Spans are places in the text.
    pub(super) fn take_out(&self, member: &Member, edits: &mut Edits) -> Moved {
        let pou = &member.pou;
        let end = pou.span.end.saturating_sub(Keyword::EndAction.text().len() as u32);
        let body = self.behind(pou.name.span.end, Punctuation::Colon)..end;
        let mut returns = Returns { left: format!("SDSP_Left_{}", pou.name.text), any: false, in_loops: false };
        returns.within(&pou.body, false, edits);
        let given = self.part(&body);
        let edited = edits.take_within(&body).apply(given);
        let Edited { text, lines } =
            edited.unwrap_or_else(|_| Edited { text: given.to_owned(), lines: LineMap::same(given) });
        let whole = pou.span.start..self.behind(pou.span.end, Punctuation::Semicolon);
        edits.replace(whole.clone(), marks::cut_text(self.part(&whole)));
        let above = self.part(&(0..body.start)).matches('\n').count() as u32;
        let origins = lines.lines().iter().map(|line| line.map(|line| line + above));
        let lines = returns.around(&marks::unmarked(&text), origins.collect());
        let is_empty = pou.body.iter().all(|each| matches!(each.kind, StatementKind::Empty));
        Moved { lines, is_empty, left: returns.in_loops.then_some(returns.left) }
    }
}

/// RETURN in statements that stand in a loop which runs once.
struct Returns {
    left: String,
    any: bool,
    in_loops: bool,
}

impl Returns {
    /// True if one of the statements is a RETURN.
    fn within(&mut self, list: &[Statement], in_loop: bool, edits: &mut Edits) -> bool {
        let mut any = false;
        for statement in list {
            let span = statement.span;
            if matches!(statement.kind, StatementKind::Return) {
                let exit = if in_loop { format!("{} := TRUE; EXIT", self.left) } else { "EXIT".to_owned() };
                edits.replace(span.start..span.end, exit);
                self.in_loops |= in_loop;
                any = true;
                continue;
            }
            let is_loop =
                matches!(statement.kind, StatementKind::For(_) | StatementKind::While(_) | StatementKind::Repeat(_));
            let mut inside = false;
            for part in parts(statement) {
                inside |= self.within(part, in_loop || is_loop, edits);
            }
            if inside && is_loop {
                edits.insert(span.end, format!("; IF {} THEN EXIT; END_IF", self.left));
            }
            any |= inside;
        }
        self.any |= any;
        any
    }

    /// The statements without the blank lines above and below them, in the loop that a RETURN leaves.
    fn around(&self, statements: &str, origins: Vec<Option<u32>>) -> Vec<(String, Option<u32>)> {
        let mut lines: Vec<(&str, Option<u32>)> = Vec::new();
        let begin = format!("{} := FALSE;", self.left);
        lines.extend(self.in_loops.then_some((begin.as_str(), None)));
        lines.extend(self.any.then_some(("REPEAT", None)));
        let mut inside: Vec<_> = statements.lines().zip(origins).collect();
        let is_blank = |(line, _): &(&str, _)| line.trim().is_empty();
        inside.truncate(inside.iter().rposition(|line| !is_blank(line)).map_or(0, |last| last + 1));
        lines.extend(inside.into_iter().skip_while(is_blank));
        lines.extend(self.any.then_some(("UNTIL TRUE END_REPEAT;", None)));
        lines.into_iter().map(|(line, from)| (line.to_owned(), from)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use onescan_iec::syntax::ast::Declaration;
    use onescan_iec::syntax::{FileId, parse};

    fn moved(text: &str) -> (Moved, String) {
        let unit = parse(FileId(0), text).unit;
        let Some(Declaration::Pou(pou)) = unit.declarations.first() else { panic!("no unit") };
        let mut edits = Edits::default();
        let moved = Text::new(text).take_out(&pou.object.members[0], &mut edits);
        (moved, edits.apply(text).expect("no conflict").text)
    }

    #[test]
    fn an_action_leaves_a_comment_and_knows_its_lines() {
        let text = "PROGRAM P\nINITIAL_STEP s: END_STEP\nACTION a: (* first *)\n  x := 1; (* one *)\n\n  END_ACTION;\nEND_PROGRAM";
        let (moved, left) = moved(text);
        assert_eq!(moved.lines, [(" (* first *)".to_owned(), Some(3)), ("  x := 1; (* one *)".to_owned(), Some(4))]);
        assert!(left.contains("(*@sdsp cut ACTION a: (&#42; first &#42;)"), "{left}");
        assert!(left.ends_with("END_ACTION;*)\nEND_PROGRAM"), "{left}");
    }

    #[test]
    fn iec2_3_3_2_2_return_ends_the_action_alone() {
        let text = "PROGRAM P\nINITIAL_STEP s: END_STEP\nACTION a:\nIF x THEN RETURN; END_IF;\n\
                    FOR i := 1 TO 3 DO\nWHILE y DO\nRETURN;\nEND_WHILE;\nEND_FOR;\nEND_ACTION\nEND_PROGRAM";
        let (moved, _) = moved(text);
        let lines: Vec<_> = moved.lines.iter().map(|(line, _)| line.as_str()).collect();
        let expected = [
            "SDSP_Left_a := FALSE;",
            "REPEAT",
            "IF x THEN EXIT; END_IF;",
            "FOR i := 1 TO 3 DO",
            "WHILE y DO",
            "SDSP_Left_a := TRUE; EXIT;",
            "END_WHILE; IF SDSP_Left_a THEN EXIT; END_IF;",
            "END_FOR; IF SDSP_Left_a THEN EXIT; END_IF;",
            "UNTIL TRUE END_REPEAT;",
        ];
        assert_eq!(lines, expected);
        assert_eq!(moved.left.as_deref(), Some("SDSP_Left_a"));
    }
}
