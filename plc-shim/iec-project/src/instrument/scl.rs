//! SCL of Siemens' TIA Portal as external source: what is written in another way there.
//!
//! | in the source | becomes |
//! |---|---|
//! | `t {InstructionName := 'TON_TIME'} : TON_TIME;` | `t : "SDSP_TON_TIME";` |
//! | `t : IEC_TIMER;` and only `#t.TON(..)` | the same |
//! | `#t.TON(IN := ..)`, `"timer".TON(IN := ..)` | `#t(IN := ..)`, `"timer"(IN := ..)` |

use onescan_base::TimeSpan;

use super::marks;
use onescan_iec::dialect::Dialect;
use onescan_iec::source::edits::Edits;
use onescan_iec::syntax::ast::{Ident, Pou, SectionKind};
use onescan_iec::syntax::lexer::tokenize_in;
use onescan_iec::syntax::token::{Keyword, Punctuation, Token, TokenKind};
use onescan_iec::syntax::{SourceFile, Span};
use onescan_iec::task_plan::Task;

/// Takes `.TON` out of `#t.TON(..)`.
pub(super) fn cut(span: Span, file: &SourceFile, edits: &mut Edits) {
    let at = file.shown_range(span.start, span.end);
    let text = file.shown_text().get(at.start as usize..at.end as usize).unwrap_or("");
    edits.replace(at, marks::cut_text(text));
}

/// Puts a block of the shim in the place of a timer; what the portal notes of the timer's version goes with it.
pub(super) fn rename(name: &Ident, new: &str, file: &SourceFile, edits: &mut Edits) {
    let text = file.text();
    let tokens = tokenize_in(file.dialect(), text);
    let before = tokens.iter().rev().skip_while(|token| token.end > name.span.start);
    for note in before.take_while(|token| !begins_declaration(token)).filter(|token| token.kind == TokenKind::Pragma) {
        let written = text.get(note.start as usize..note.end as usize).unwrap_or("");
        if written.contains("InstructionName") {
            edits.replace(note.start..note.end, marks::cut_text(written));
        }
    }
    let written = text.get(name.span.start as usize..name.span.end as usize).unwrap_or("");
    edits.replace(name.span.start..name.span.end, marks::renamed(&format!("\"{new}\""), written));
}

/// True for what stands before the declaration of a variable or behind the words `DATA_BLOCK`.
fn begins_declaration(token: &Token) -> bool {
    match token.kind {
        TokenKind::Punctuation(Punctuation::Semicolon) => true,
        TokenKind::Keyword(keyword) => !matches!(keyword, Keyword::Retain | Keyword::NonRetain),
        _ => false,
    }
}

/// Intervals that STEP 7 gives to OB30 to OB38, ms; the later ones have the higher priority.
const CYCLIC_MS: [u64; 9] = [5000, 2000, 1000, 500, 200, 100, 50, 20, 10];
/// The interval of program cycles.
const CYCLE: TimeSpan = TimeSpan::millis::<10>();

/// The tasks of a project of organization blocks: cyclic interrupts that bear their number, each with the interval and
/// the rank that STEP 7 gives it, and behind them all others as one program cycle.
pub(super) fn tasks(programs: &[&Pou]) -> Vec<Task> {
    let mut tasks = Vec::new();
    let mut cycle = Vec::new();
    for pou in programs {
        let number = pou.name.key().strip_prefix("OB").and_then(|number| number.parse::<usize>().ok());
        let interval = number.and_then(|number| CYCLIC_MS.get(number.checked_sub(30)?).map(|ms| (number - 30, ms)));
        let name = pou.name.text.clone();
        match interval {
            Some((rank, ms)) => {
                let priority = (CYCLIC_MS.len() - 1 - rank) as u32;
                tasks.push(Task {
                    interval: TimeSpan::from_millis(*ms),
                    priority,
                    programs: vec![name.clone()],
                    name,
                    ..Task::default()
                });
            }
            None => cycle.push(name),
        }
    }
    if !cycle.is_empty() {
        let (name, priority) = ("OB1".to_owned(), CYCLIC_MS.len() as u32);
        tasks.push(Task { name, interval: Some(CYCLE), priority, programs: cycle, ..Task::default() });
    }
    tasks
}

/// Adds a block's temporary variables; a block has one section of them.
pub(super) fn declare(pou: &Pou, declarations: &str, file: &SourceFile, edits: &mut Edits) {
    let (text, line_break) = (file.text(), marks::line_break(file.text()));
    let section = pou.sections.iter().find(|section| section.kind == SectionKind::Temp);
    if let Some(end) = section.and_then(|section| keyword(Keyword::EndVar, section.span, file)) {
        let inner: Vec<&str> = declarations.lines().filter(|line| line.contains(':')).collect();
        edits.insert(marks::line_start(text, end.start), marks::lines(&inner.join("\n"), line_break));
    } else if let Some(begin) = begin(pou.span, file) {
        edits.insert(marks::line_start(text, begin.start), marks::lines(declarations, line_break));
    }
}

/// The word `BEGIN` of a block in SCL.
pub(super) fn begin(block: Span, file: &SourceFile) -> Option<Token> {
    keyword(Keyword::Begin, block, file).filter(|_| is_scl(file))
}

/// The first keyword of this kind.
fn keyword(wanted: Keyword, inside: Span, file: &SourceFile) -> Option<Token> {
    let tokens = tokenize_in(file.dialect(), file.text());
    let is_inside = |token: &&Token| inside.start <= token.start && token.end <= inside.end;
    tokens.iter().filter(is_inside).find(|token| token.kind == TokenKind::Keyword(wanted)).copied()
}

/// True for a source in SCL.
pub(super) fn is_scl(file: &SourceFile) -> bool {
    file.dialect() == Dialect::SiemensScl
}
