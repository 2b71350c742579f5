//! What sources say about what they declare: the comment beside a variable, and its line; the comment in front of a
//! unit.

use std::collections::BTreeMap;

use super::token::{Keyword, Token, TokenKind};
use super::tokenize_in;
use crate::source::SourceFile;

/// Comments and lines by unit and variable, in capitals; the unit of a global variable is empty, and so is the
/// variable of a unit itself.
#[derive(Debug, Default)]
pub struct Remarks(BTreeMap<(String, String), Remark>);

#[derive(Debug)]
struct Remark {
    line: u32,
    comment: Option<String>,
}

impl Remarks {
    /// Those of some files.
    pub fn of<'f>(files: impl Iterator<Item = &'f SourceFile>) -> Self {
        let mut remarks = Self::default();
        for file in files {
            remarks.file(file);
        }
        remarks
    }

    /// The line of the variable that a path begins with.
    pub fn line(&self, path: &str) -> Option<u32> {
        self.find(path).map(|remark| remark.line)
    }

    /// The comment of the variable that a path begins with.
    pub fn comment(&self, path: &str) -> Option<String> {
        self.find(path).and_then(|remark| remark.comment.clone())
    }

    /// The comment in front of a unit.
    pub fn comment_on_unit(&self, unit: &str) -> Option<&str> {
        self.0.get(&(unit.to_ascii_uppercase(), String::new()))?.comment.as_deref()
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
        self.units(file, &tokens);
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

impl Remarks {
    /// The comment nearest in front of each unit, where nothing else stands between.
    fn units(&mut self, file: &SourceFile, tokens: &[Token]) {
        let text = file.text();
        let piece = |token: &Token| text.get(token.start as usize..token.end as usize).unwrap_or_default();
        let mut before: Vec<&str> = Vec::new();
        let mut names = tokens.iter().filter(|token| token.kind == TokenKind::Identifier).peekable();
        for token in tokens {
            match token.kind {
                TokenKind::BlockComment => before = vec![piece(token)],
                TokenKind::LineComment => before.push(piece(token)),
                TokenKind::Keyword(Keyword::Program | Keyword::FunctionBlock | Keyword::Function) => {
                    while names.next_if(|name| name.start < token.end).is_some() {}
                    let comment = paragraph(&std::mem::take(&mut before));
                    if let (Some(name), false) = (names.peek(), comment.is_empty()) {
                        let line = file.shown_line_column(token.start).line;
                        let key = (piece(name).to_ascii_uppercase(), String::new());
                        self.0.entry(key).or_insert(Remark { line, comment: Some(comment) });
                    }
                }
                kind if kind.is_trivia() => {}
                _ => before.clear(),
            }
        }
    }
}

/// The first paragraph of comments as one line, without what makes them comments.
fn paragraph(comments: &[&str]) -> String {
    let lines = comments.iter().flat_map(|comment| {
        let inside = [("(*", "*)"), ("/*", "*/"), ("//", "")].iter().find_map(|(open, close)| {
            let inside = comment.strip_prefix(open)?;
            Some(inside.strip_suffix(close).unwrap_or(inside))
        });
        inside.unwrap_or(comment).trim().lines().map(|line| line.trim().trim_start_matches('*').trim())
    });
    let lines = lines.skip_while(|line| line.is_empty()).take_while(|line| !line.is_empty());
    lines.collect::<Vec<_>>().join(" ").trim_end_matches('.').to_owned()
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
    // `&amp;` comes last: what is left of `&amp;lt;` is the text `&lt;`.
    let entities = [("&lt;", "<"), ("&gt;", ">"), ("&quot;", "\""), ("&apos;", "'"), ("&amp;", "&")];
    let text = entities.iter().fold(text, |text, (entity, is)| text.replace(entity, is));
    Some(text.trim().to_owned()).filter(|text| !text.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_and_variables_have_the_comments_beside_them() {
        let text = "// Low pass\n// of first order.\nFUNCTION_BLOCK lag\nVAR_INPUT x : REAL; // what comes in\nEND_VAR\n\
            END_FUNCTION_BLOCK\n(* Sums up.\n\n * More of it. *)\nFUNCTION_BLOCK sum END_FUNCTION_BLOCK\n\
            FUNCTION_BLOCK bare END_FUNCTION_BLOCK";
        let file = SourceFile::new("a.st", text);
        let remarks = Remarks::of(std::iter::once(&file));
        assert_eq!(remarks.comment_on_unit("LAG"), Some("Low pass of first order"));
        assert_eq!(remarks.comment_on_unit("sum"), Some("Sums up"));
        assert_eq!(remarks.comment_on_unit("bare"), None);
        assert_eq!(remarks.comment("lag.x").as_deref(), Some("what comes in"));
    }
}
