//! What sources say about their variables: the comment beside a declaration, and its line.

use std::collections::BTreeMap;

use onescan_plc_shim::source::SourceFile;
use onescan_plc_shim::syntax::token::{Keyword, Token, TokenKind};
use onescan_plc_shim::syntax::tokenize_in;

/// Comments and lines by unit and variable, in capitals; the unit of a global variable is empty.
#[derive(Debug, Default)]
pub(super) struct Remarks(BTreeMap<(String, String), Remark>);

#[derive(Debug)]
struct Remark {
    line: u32,
    comment: Option<String>,
}

impl Remarks {
    pub(super) fn of<'f>(files: impl Iterator<Item = &'f SourceFile>) -> Self {
        let mut remarks = Self::default();
        for file in files {
            remarks.file(file);
        }
        remarks
    }

    /// The line of the variable that a path begins with.
    pub(super) fn line(&self, path: &str) -> Option<u32> {
        self.find(path).map(|remark| remark.line)
    }

    /// The comment of the variable that a path begins with.
    pub(super) fn comment(&self, path: &str) -> Option<String> {
        self.find(path).and_then(|remark| remark.comment.clone())
    }

    fn find(&self, path: &str) -> Option<&Remark> {
        let path = path.to_ascii_uppercase();
        let mut names = path.split(['.', '[']);
        let (first, second) = (names.next().unwrap_or_default(), names.next().unwrap_or_default());
        let key = |unit: &str, name: &str| (unit.to_owned(), name.to_owned());
        // A list of globals stands before the names of its variables; a program before those of its own.
        let own = self.0.get(&key(first, second)).or_else(|| self.0.get(&key("", first)));
        own.or_else(|| self.0.get(&key("", second)))
    }

    fn file(&mut self, file: &SourceFile) {
        let text = file.text();
        let tokens = tokenize_in(file.dialect(), text);
        let (mut unit, mut is_in_section, mut is_global) = (String::new(), false, false);
        let significant = tokens.into_iter().filter(|token| !token.kind.is_trivia());
        let significant = significant.filter_map(|Token { kind, start, end }| {
            let (start, end) = (start as usize, end as usize);
            text.get(start..end).map(|piece| (kind, start, piece))
        });
        let significant: Vec<_> = significant.collect();
        for (index, (kind, at, piece)) in significant.iter().enumerate() {
            let next = significant.get(index + 1);
            match kind {
                TokenKind::Keyword(Keyword::Program | Keyword::FunctionBlock | Keyword::Function) => {
                    unit = next.map_or_else(String::new, |(_, _, name)| name.to_ascii_uppercase());
                }
                TokenKind::Keyword(Keyword::EndProgram | Keyword::EndFunctionBlock | Keyword::EndFunction) => {
                    unit.clear();
                }
                TokenKind::Keyword(Keyword::EndVar) => is_in_section = false,
                TokenKind::Keyword(keyword) if keyword.text().starts_with("VAR") => {
                    is_in_section = true;
                    is_global = *keyword == Keyword::VarGlobal;
                }
                TokenKind::Identifier if is_in_section => {
                    let before = index.checked_sub(1).and_then(|before| significant.get(before));
                    // Names stand at the beginning of a declaration and behind commas; types behind colons.
                    let begins = before.is_some_and(|(kind, _, piece)| {
                        matches!(kind, TokenKind::Keyword(_)) || matches!(*piece, ";" | ",")
                    });
                    let declares = next
                        .is_some_and(|(_, _, piece)| matches!(*piece, ":" | ",") || piece.eq_ignore_ascii_case("AT"));
                    if begins && declares {
                        let shown = file.shown_range(*at as u32, (*at + piece.len()) as u32).start as usize;
                        let before = file.shown_text().get(..shown).unwrap_or_default();
                        let line = before.matches('\n').count() as u32 + 1;
                        let comment = comment(file, *at + piece.len());
                        // A resource declares its globals behind its programs, too.
                        let unit = if is_global { String::new() } else { unit.clone() };
                        let key = (unit, piece.to_ascii_uppercase());
                        self.0.entry(key).or_insert(Remark { line, comment });
                    }
                }
                _ => {}
            }
        }
    }
}

/// The comment on the line of a declaration, or the documentation of a variable in PLCopen XML.
fn comment(file: &SourceFile, name_end: usize) -> Option<String> {
    if file.origin().is_some() {
        let place = file.shown_range(name_end as u32, name_end as u32).start as usize;
        let rest = file.shown_text().get(place..)?;
        if let Some(end) = rest.find("</variable>")
            && rest.find("<variable").is_none_or(|next| end < next)
        {
            return documentation(&rest[..end]);
        }
    }
    let rest = file.text().get(name_end..)?;
    let line = rest.lines().next()?;
    let (_, behind) = line.split_once(';')?;
    let behind = behind.trim();
    let inside = if let Some(text) = behind.strip_prefix("(*") {
        text.split("*)").next()
    } else if let Some(text) = behind.strip_prefix("//") {
        Some(text)
    } else {
        behind.strip_prefix("/*").and_then(|text| text.split("*/").next())
    };
    inside.map(|text| text.trim().to_owned()).filter(|text| !text.is_empty())
}

/// What is written between the tags of `<documentation>`.
fn documentation(variable: &str) -> Option<String> {
    let (_, inside) = variable.split_once("<documentation")?;
    let (inside, _) = inside.split_once("</documentation>")?;
    let mut text = String::new();
    for piece in inside.split('<') {
        text.push_str(piece.split_once('>').map_or("", |(_, text)| text));
    }
    let entities = [("&lt;", "<"), ("&gt;", ">"), ("&quot;", "\""), ("&apos;", "'"), ("&amp;", "&")];
    let text = entities.iter().fold(text, |text, (entity, is)| text.replace(entity, is));
    Some(text.trim().to_owned()).filter(|text| !text.is_empty())
}
