//! Marks in comments: what was changed, so that it is recognised and can be taken back.
//!
//! | mark | says |
//! |---|---|
//! | `(*@sdsp file*)` | the whole file was added |
//! | `(*@sdsp whole*)` | the whole file was added, and is the project as a whole, in the form of another tool |
//! | `(*@sdsp begin*)` .. `(*@sdsp end*)` | this, the marks and a line break behind them was put in |
//! | `SDSP_TON(*@sdsp was TON*)` | the name in front of the mark, also in quotes, stands for another |
//! | `(*@sdsp cut .TON*)` | this stood here, `(&#42;` and `&#42;)` for the ends of comments, `&amp;` for an ampersand |
//!
//! | `<a x="SDSP_TON"/><!--@sdsp was TON-->` | the name in the tag in front of the mark stands for another |
//! | `<!--@sdsp cut <a/>-->` | this stood here, `-&#45;` for two hyphens and `&amp;` for an ampersand |
//!
//! In XML outside of program text the first three are XML comments, too.

use std::ops::Range;

use thiserror::Error;

use onescan_iec::source::edits::{Edited, Edits};

const OPENING: &str = "(*@sdsp ";
const CLOSING: &str = "*)";
const XML_OPENING: &str = "<!--@sdsp ";
const XML_CLOSING: &str = "-->";

/// The first line of a file that was added.
pub(super) const FILE: &str = "(*@sdsp file*)";

/// The first line of a file that was added and is the project as a whole.
pub(super) const WHOLE: &str = "(*@sdsp whole*)";

/// The same in XML, behind its declaration.
pub(super) const XML_FILE: &str = "<!--@sdsp file-->";

/// What stands there in a file that was added and is the project as a whole.
pub(super) const XML_WHOLE: &str = "<!--@sdsp whole-->";

/// True for a file that was added and is the project as a whole.
pub(super) fn is_whole(text: &str) -> bool {
    Mark::next(text, 0).is_some_and(|mark| mark.says == "whole")
}

/// How lines end in a file.
pub(super) fn line_break(text: &str) -> &'static str {
    let first = text.find('\n').map_or("", |at| text.get(..at).unwrap_or(""));
    if first.ends_with('\r') { "\r\n" } else { "\n" }
}

/// The start of the line if only blanks are before `at`, so that lines keep their indentation.
pub(super) fn line_start(text: &str, at: u32) -> u32 {
    let before = text.get(..at as usize).unwrap_or("");
    let line = before.trim_end_matches([' ', '\t']);
    if line.is_empty() || line.ends_with('\n') { line.len() as u32 } else { at }
}

/// The start of the next line if only blanks are behind `at`.
pub(super) fn line_end(text: &str, at: u32) -> u32 {
    let rest = text.get(at as usize..).unwrap_or("");
    let line = rest.trim_start_matches([' ', '\t', '\r']);
    if line.starts_with('\n') { at + (rest.len() - line.len()) as u32 + 1 } else { at }
}

/// Lines to put in, ending as those of the file do.
pub(super) fn lines(text: &str, line_break: &str) -> String {
    let mut marked = format!("{OPENING}begin{CLOSING}{line_break}");
    for line in text.lines() {
        marked.push_str(line);
        marked.push_str(line_break);
    }
    marked + OPENING + "end" + CLOSING + line_break
}

/// Text to put in within a line, before something other than a line's end.
pub(super) fn inline(text: &str) -> String {
    format!("{OPENING}begin{CLOSING}{}{OPENING}end{CLOSING}", text.trim())
}

/// Lines of XML to put in.
pub(super) fn xml_lines(text: &str, line_break: &str) -> String {
    let mut marked = format!("{XML_OPENING}begin{XML_CLOSING}{line_break}");
    for line in text.lines() {
        marked.push_str(line);
        marked.push_str(line_break);
    }
    marked + XML_OPENING + "end" + XML_CLOSING + line_break
}

/// A name to put in the place of `old`.
pub(super) fn renamed(new: &str, old: &str) -> String {
    format!("{new}{OPENING}was {old}{CLOSING}")
}

/// The mark behind a tag in which a name stands for `old`.
pub(super) fn renamed_before(old: &str) -> String {
    format!("{XML_OPENING}was {old}{XML_CLOSING}")
}

/// The mark for text that is taken out; no comment ends in a comment.
pub(super) fn cut_text(text: &str) -> String {
    let escaped = text.replace('&', "&amp;").replace("(*", "(&#42;").replace("*)", "&#42;)");
    format!("{OPENING}cut {escaped}{CLOSING}")
}

/// Where the name begins that ends at the end of `before`, with its quotes if it has any.
fn name_start(before: &str) -> usize {
    match before.strip_suffix('"') {
        Some(quoted) => quoted.rfind('"').unwrap_or(quoted.len()),
        None => before.trim_end_matches(|one: char| one.is_ascii_alphanumeric() || one == '_').len(),
    }
}

/// The mark for XML that is taken out; no `--` stands in a comment.
pub(super) fn cut(xml: &str) -> String {
    let escaped = xml.replace('&', "&amp;").replace("--", "-&#45;");
    format!("{XML_OPENING}cut {escaped}{XML_CLOSING}")
}

/// What was taken out.
fn uncut(escaped: &str) -> String {
    escaped.replace("&#45;", "-").replace("&#42;", "*").replace("&amp;", "&")
}

/// Text to put in before `at`, wherever that is in a line.
pub(super) fn within(text: &str, at: u32, new: &str) -> String {
    let ends_line = text.get(at as usize..).is_some_and(|rest| rest.starts_with(['\r', '\n']));
    if ends_line || new.contains('\n') { lines(new, line_break(text)) } else { inline(new) }
}

/// Text without the marks in it, but with what they mark.
pub(super) fn unmarked(text: &str) -> String {
    let mut plain = String::with_capacity(text.len());
    let mut from = 0;
    let is_word = |one: char| one.is_ascii_alphanumeric() || one == '_';
    while let Some(mark) = Mark::next(text, from) {
        plain.push_str(text.get(from..mark.at.start).unwrap_or(""));
        from = mark.at.end;
        // A mark may be all that keeps two words apart.
        let behind = text.get(from..).unwrap_or("");
        if plain.ends_with(is_word) && behind.starts_with(is_word) {
            plain.push(' ');
        }
    }
    plain + text.get(from..).unwrap_or("")
}

/// Text with all that was put in, and without a sign of it.
pub(super) fn plain_text(text: &str) -> String {
    let is_mark = |line: &&str| {
        let line = line.trim();
        [FILE, "(*@sdsp begin*)", "(*@sdsp end*)"].contains(&line)
    };
    let lines: Vec<&str> = text.split('\n').filter(|line| !is_mark(line)).collect();
    unmarked(&lines.join("\n"))
}

/// Where the name stands in the tag before a mark that says what it was: the word of the shim's own that ends with it.
fn renamed_in_tag(before: &str, old: &str) -> Option<Range<u32>> {
    let tag = before.rfind('<')?;
    let inside = before.get(tag..)?;
    let is_word = |one: char| one.is_ascii_alphanumeric() || one == '_';
    let mut found = None;
    for (at, _) in inside.match_indices("SDSP_") {
        let rest = inside.get(at..)?;
        let word = rest.get(..rest.find(|one| !is_word(one)).unwrap_or(rest.len()))?;
        let is_begin = !inside.get(..at)?.ends_with(is_word);
        if is_begin && word.to_ascii_uppercase().ends_with(&format!("_{}", old.to_ascii_uppercase())) {
            found = Some((tag + at) as u32..(tag + at + word.len()) as u32);
        }
    }
    found
}

/// Marks that do not fit together.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("{message}")]
pub(super) struct DamagedMarks {
    pub(super) at: Range<u32>,
    pub(super) message: &'static str,
}

/// What a file was before it was instrumented.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Original {
    Same,
    /// This text, and where its lines are now.
    Text(Edited),
    Nothing,
}

/// Takes back all that is marked.
pub(super) fn original(text: &str) -> Result<Original, DamagedMarks> {
    let mut edits = Edits::default();
    let mut open: Option<Mark<'_>> = None;
    let mut from = 0;
    while let Some(mark) = Mark::next(text, from) {
        from = mark.at.end;
        let damaged = |message| DamagedMarks { at: mark.at.start as u32..mark.at.end as u32, message };
        match (mark.says, &open) {
            ("file" | "whole", None) => return Ok(Original::Nothing),
            ("begin", None) => open = Some(mark),
            ("end", Some(begin)) => {
                let end = mark.at.end + line_break_length(text.get(mark.at.end..).unwrap_or(""));
                edits.replace(begin.at.start as u32..end as u32, "");
                from = end;
                open = None;
            }
            ("end", None) => return Err(damaged("this mark ends what has not begun")),
            // Within what was put in anything may stand.
            (says, None) if says.starts_with("cut ") => {
                let cut = says.strip_prefix("cut ").unwrap_or("");
                edits.replace(mark.at.start as u32..mark.at.end as u32, uncut(cut));
            }
            (says, None) if mark.is_xml && says.starts_with("was ") => {
                let old = says.strip_prefix("was ").unwrap_or("");
                let before = text.get(..mark.at.start).unwrap_or("");
                let at = renamed_in_tag(before, old).ok_or_else(|| damaged("the name that this describes is gone"))?;
                edits.replace(at, old);
                edits.replace(mark.at.start as u32..mark.at.end as u32, "");
            }
            (says, None) => {
                let old = says.strip_prefix("was ").ok_or_else(|| damaged("this mark is not known"))?;
                let before = text.get(..mark.at.start).unwrap_or("");
                edits.replace(name_start(before) as u32..mark.at.end as u32, old);
            }
            ("begin" | "file" | "whole", Some(_)) => return Err(damaged("this mark stands inside of another")),
            (_, Some(_)) => {}
        }
    }
    if let Some(begin) = open {
        let at = begin.at.start as u32..begin.at.end as u32;
        return Err(DamagedMarks { at, message: "what begins here has no end" });
    }
    if edits.is_empty() {
        return Ok(Original::Same);
    }
    let edited = edits
        .apply(text)
        .map_err(|conflict| DamagedMarks { at: conflict.at..conflict.at, message: "marks overlap here" })?;
    Ok(Original::Text(edited))
}

struct Mark<'t> {
    at: Range<usize>,
    says: &'t str,
    /// True for a comment of XML.
    is_xml: bool,
}

impl<'t> Mark<'t> {
    fn next(text: &'t str, from: usize) -> Option<Self> {
        let rest = text.get(from..)?;
        let found = |opening: &'static str, closing: &'static str| {
            let start = rest.find(opening)?;
            let says = rest.get(start + opening.len()..)?;
            let says = says.get(..says.find(closing)?)?;
            let end = start + opening.len() + says.len() + closing.len();
            Some(Self { at: from + start..from + end, says, is_xml: opening == XML_OPENING })
        };
        let marks = [found(OPENING, CLOSING), found(XML_OPENING, XML_CLOSING)];
        marks.into_iter().flatten().min_by_key(|mark| mark.at.start)
    }
}

fn line_break_length(rest: &str) -> usize {
    if rest.starts_with("\r\n") { 2 } else { usize::from(rest.starts_with('\n')) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text_of(marked: &str) -> Option<String> {
        match original(marked) {
            Ok(Original::Text(edited)) => Some(edited.text),
            _ => None,
        }
    }

    #[test]
    fn what_is_marked_is_taken_back() {
        let put_in = lines("VAR x : INT; END_VAR\n    y;", "\r\n");
        let text = format!("a\r\n{put_in}t : {};{}RETURN\r\n", renamed("SDSP_TON", "ton"), inline(" z; "));
        assert_eq!(text_of(&text).as_deref(), Some("a\r\nt : ton;RETURN\r\n"));
        let scl = format!("t : {};\n#t{}(IN := 1)", renamed("\"SDSP_TON\"", "TON"), cut_text(".TON"));
        assert_eq!(text_of(&scl).as_deref(), Some("t : TON;\n#t.TON(IN := 1)"));
        assert_eq!(original("(*@sdsp *) no"), Err(DamagedMarks { at: 0..10, message: "this mark is not known" }));
        assert_eq!(original("(* sdsp *)"), Ok(Original::Same));
        assert_eq!(original("(*@sdsp file*)\nx"), Ok(Original::Nothing));
        let xml = format!("<a>\n{}</a>", xml_lines("<b/>", "\n"));
        assert_eq!(text_of(&xml).as_deref(), Some("<a>\n</a>"));
    }

    #[test]
    fn marks_that_do_not_fit_together_are_reported() {
        for (text, message) in [
            ("(*@sdsp begin*) x", "what begins here has no end"),
            ("x (*@sdsp end*)", "this mark ends what has not begun"),
            ("(*@sdsp begin*)(*@sdsp begin*)", "this mark stands inside of another"),
            ("(*@sdsp began*)", "this mark is not known"),
        ] {
            assert_eq!(original(text).map_err(|damaged| damaged.message), Err(message), "{text}");
        }
    }

    #[test]
    fn lines_end_as_in_the_file() {
        assert_eq!((line_break("a\r\nb\n"), line_break("a\nb\r\n"), line_break("a")), ("\r\n", "\n", "\n"));
    }
}
