//! Bodies (TC6 2.01, `body`): statements and instructions, as they are written.

use std::ops::Range;

use super::super::page::Page;
use super::super::page::Wrapper;
use onescan_iec::syntax::ast::{Member, MemberKind, Pou, Section, Statement, StatementKind};

/// `<body>` of a unit, between its declarations and its end, without what is a member of it.
pub(super) fn of_unit(pou: &Pou, page: &Page<'_>) -> String {
    let head = behind_head(pou);
    // The head of a property stands in front of both its halves, which begin with GET or SET.
    let head = if head > pou.span.start { head } else { pou.span.start + "GET".len() as u32 };
    let from = head.max(pou.sections.iter().map(|section| section.span.end).max().unwrap_or(0));
    let keyword = page.text.get(..pou.span.end as usize).unwrap_or("");
    let last = keyword.trim_end_matches(|one: char| one.is_ascii_alphabetic() || one == '_').len() as u32;
    let mut apart: Vec<Range<u32>> = pou.object.members.iter().map(|member| member_range(member, page)).collect();
    apart.sort_by_key(|range| range.start);
    let text = without(from..last, &apart, page);
    body(&text, &pou.body, page.wrapper)
}

/// `<body>` of an action: what stands behind its colon.
pub(super) fn of_action(pou: &Pou, page: &Page<'_>) -> String {
    let end = pou.span.end.saturating_sub("END_ACTION".len() as u32);
    let text = page.slice(pou.name.span.end..end);
    body(text.trim_start().strip_prefix(':').unwrap_or(text), &pou.body, page.wrapper)
}

/// `<body>` with this text in the language of `statements`.
pub(crate) fn body(text: &str, statements: &[Statement], wrapper: Wrapper) -> String {
    format!("<body>{}</body>\n", formatted(text, statements, wrapper))
}

/// `<ST>` or `<IL>`.
pub(crate) fn formatted(text: &str, statements: &[Statement], wrapper: Wrapper) -> String {
    let is_list = statements.iter().any(|each| matches!(each.kind, StatementKind::Instruction(_)));
    let language = if is_list { "IL" } else { "ST" };
    format!("<{language}>{}</{language}>", wrapper.around(without_margin(text)))
}

/// Text without blank lines around it and without blanks at its end.
fn without_margin(text: &str) -> &str {
    let text = text.trim_end();
    let first = text.find(|one: char| !one.is_whitespace()).unwrap_or(text.len());
    let line = text.get(..first).unwrap_or("").rfind('\n').map_or(0, |at| at + 1);
    text.get(line..).unwrap_or("")
}

/// Where the head of a unit ends: name, result, bases.
fn behind_head(pou: &Pou) -> u32 {
    let bases = pou.object.extends.iter().chain(&pou.object.implements).chain(&pou.object.using);
    let ends = bases.map(|name| name.span.end).chain(pou.result.as_ref().map(|result| result.span.end));
    ends.fold(pou.name.span.end, u32::max)
}

/// Where a member stands, with the keywords around it.
fn member_range(member: &Member, page: &Page<'_>) -> Range<u32> {
    let span = member.pou.span;
    if matches!(member.kind, MemberKind::Method | MemberKind::Action) {
        return span.start..span.end;
    }
    let start = page.word_before("PROPERTY", span.start).map_or(span.start, |token| token.start);
    let end = page.word_behind("END_PROPERTY", span.end).map_or(span.end, |token| token.end);
    start..end
}

fn without(at: Range<u32>, apart: &[Range<u32>], page: &Page<'_>) -> String {
    let mut text = String::new();
    let mut from = at.start;
    for range in apart {
        if range.start >= from && range.end <= at.end {
            text.push_str(page.slice(from..range.start));
            from = range.end;
        }
    }
    text.push_str(page.slice(from..at.end.max(from)));
    text
}

/// Comments that a unit's head has before its first section.
pub(super) fn words_of_head(pou: &Pou, page: &Page<'_>) -> String {
    let first = pou.sections.iter().map(|section: &Section| section.span.start).min();
    first.map_or_else(String::new, |first| page.remarks(pou.span.start..first))
}
