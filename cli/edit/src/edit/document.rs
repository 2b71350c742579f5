//! A TOML file as text, and the places in it where something is written.
//!
//! `toml_edit` says where everything stands; what is changed is put into the text at that place. So every other byte stays:
//! comments, layout, the order of lines and how they end.

use std::ops::Range;

use toml_edit::{InlineTable, Item, Key, Table, Value};

use super::error::{EditError, Place};

/// A file that can be changed.
#[derive(Debug)]
pub(super) struct Document<'t> {
    file: &'t str,
    text: &'t str,
    parsed: toml_edit::Document<&'t str>,
}

/// Text in the place of other text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Splice {
    at: Range<usize>,
    with: String,
}

impl Splice {
    pub(super) fn new(at: Range<usize>, with: impl Into<String>) -> Self {
        Self { at, with: with.into() }
    }
}

/// A table of one of the three ways in which TOML writes it.
#[derive(Clone, Copy, Debug)]
pub(super) enum Held<'d> {
    Header(&'d Table),
    /// By keys with dots, as in `bind.Feed = "P.Feed"`: the table, and the keys in front.
    Dotted(&'d Table, &'d str),
    Inline(&'d InlineTable),
}

impl<'d> Held<'d> {
    /// The table that `item` is, of the key `key`.
    pub(super) fn of(item: &'d Item, key: &'d str) -> Option<Self> {
        match item {
            Item::Table(table) if table.is_dotted() => Some(Self::Dotted(table, key)),
            Item::Table(table) => Some(Self::Header(table)),
            Item::Value(Value::InlineTable(table)) => Some(Self::Inline(table)),
            _ => None,
        }
    }

    /// A key and the bytes of its value.
    pub(super) fn value(&self, key: &str) -> Option<(&'d Value, Range<usize>)> {
        let value = match self {
            Self::Header(table) | Self::Dotted(table, _) => table.get(key).and_then(Item::as_value),
            Self::Inline(table) => table.get(key),
        }?;
        Some((value, value.span()?))
    }

    /// The bytes of a key.
    fn key_span(&self, key: &str) -> Option<Range<usize>> {
        match self {
            Self::Header(table) | Self::Dotted(table, _) => table.key(key).and_then(Key::span),
            Self::Inline(table) => table.key(key).and_then(Key::span),
        }
    }
}

impl<'t> Document<'t> {
    /// Reads a text.
    pub(super) fn parse(file: &'t str, text: &'t str) -> Result<Self, EditError> {
        match toml_edit::Document::parse(text) {
            Ok(parsed) => Ok(Self { file, text, parsed }),
            Err(error) => {
                let line = line_of(text, error.span().map_or(0, |span| span.start));
                let place = Place { file: file.to_owned(), line };
                Err(EditError::NoToml { message: error.message().trim().to_owned(), place })
            }
        }
    }

    pub(super) fn file(&self) -> &'t str {
        self.file
    }

    pub(super) fn root(&self) -> &Table {
        self.parsed.as_table()
    }

    pub(super) fn place(&self, at: usize) -> Place {
        Place { file: self.file.to_owned(), line: line_of(self.text, at) }
    }

    /// The tables `[[sort]]`.
    pub(super) fn tables(&self, sort: &str) -> impl Iterator<Item = &Table> {
        self.root().get(sort).and_then(Item::as_array_of_tables).into_iter().flat_map(|all| all.iter())
    }

    /// A new key with its value, behind the last one of the table.
    pub(super) fn insert(&self, held: Held<'_>, key: &str, value: &str) -> Splice {
        let key = key_text(key);
        match held {
            Held::Header(table) => self.line_behind(own_end(table).unwrap_or(0), &format!("{key} = {value}")),
            Held::Dotted(table, front) => {
                self.line_behind(own_end(table).unwrap_or(0), &format!("{}.{key} = {value}", key_text(front)))
            }
            Held::Inline(table) => {
                let last = table.iter().filter_map(|(_, value)| value.span()).map(|span| span.end).max();
                match (last, table.span()) {
                    (Some(last), _) => Splice::new(last..last, format!(", {key} = {value}")),
                    (None, Some(span)) => Splice::new(span, format!("{{ {key} = {value} }}")),
                    (None, None) => Splice::new(0..0, ""),
                }
            }
        }
    }

    /// A line behind the one in which `at` is, as deep as that one.
    pub(super) fn line_behind(&self, at: usize, line: &str) -> Splice {
        let start = line_start(self.text, at);
        let indent: String = self.text[start..].chars().take_while(|c| matches!(c, ' ' | '\t')).collect();
        self.lines_behind(at, &format!("{indent}{line}"))
    }

    /// Lines behind the one in which `at` is, without a break at their end.
    pub(super) fn lines_behind(&self, at: usize, lines: &str) -> Splice {
        let (end, newline) = (line_end(self.text, at), self.newline());
        let lines = lines.replace('\n', newline);
        let is_broken = self.text[..end].ends_with('\n') || end == 0;
        Splice::new(end..end, if is_broken { format!("{lines}{newline}") } else { format!("{newline}{lines}") })
    }

    /// Lines in front of the first table of the file and the comment right above it.
    pub(super) fn lines_before_tables(&self, lines: &str) -> Splice {
        let first = self.root().iter().filter_map(|(_, item)| first_header(item)).min().unwrap_or(self.text.len());
        let at = self.with_comment(first);
        let lines = lines.replace('\n', self.newline());
        let newline = self.newline();
        let is_broken = self.text[..at].ends_with('\n') || at == 0;
        Splice::new(at..at, if is_broken { format!("{lines}{newline}{newline}") } else { format!("{newline}{lines}") })
    }

    /// Takes a key and its value away, with its line where it has one of its own.
    pub(super) fn remove_key(&self, held: Held<'_>, key: &str) -> Option<Splice> {
        let (_, value) = held.value(key)?;
        let start = held.key_span(key)?.start;
        match held {
            Held::Header(_) | Held::Dotted(..) => {
                Some(Splice::new(line_start(self.text, start)..line_end(self.text, value.end), ""))
            }
            Held::Inline(table) => {
                let spans = table.iter().filter_map(|(key, value)| Some((table.key(key)?.span()?, value.span()?)));
                let mut spans: Vec<_> = spans.map(|(key, value)| key.start..value.end).collect();
                spans.sort_by_key(|span| span.start);
                let index = spans.iter().position(|span| span.start == start)?;
                let range = match (index.checked_sub(1).map(|before| &spans[before]), spans.get(index + 1)) {
                    (_, Some(next)) => start..next.start,
                    (Some(before), None) => before.end..value.end,
                    (None, None) => start..value.end,
                };
                Some(Splice::new(range, ""))
            }
        }
    }

    /// Takes a table below a header away, with the comment right above it and one empty line.
    pub(super) fn remove_table(&self, table: &Table) -> Option<Splice> {
        let start = self.with_comment(table.span()?.start);
        let mut end = line_end(self.text, whole_end(table)?);
        let is_empty = |at: usize| at < self.text.len() && self.text[at..line_end(self.text, at)].trim().is_empty();
        if is_empty(end) {
            end = line_end(self.text, end);
            return Some(Splice::new(start..end, ""));
        }
        // the last one takes the empty line in front of it along
        let before = self.text[..start].strip_suffix('\n').map(|front| line_start(self.text, front.len()));
        match before {
            Some(before) if end == self.text.len() && is_empty(before) => Some(Splice::new(before..end, "")),
            _ => Some(Splice::new(start..end, "")),
        }
    }

    /// The start of the line of `at`, or of the comments that stand right above it.
    fn with_comment(&self, at: usize) -> usize {
        let mut start = line_start(self.text, at);
        while let Some(front) = self.text[..start].strip_suffix('\n') {
            let above = line_start(self.text, front.len());
            if !self.text[above..start].trim_start().starts_with('#') {
                break;
            }
            start = above;
        }
        start
    }

    fn newline(&self) -> &'static str {
        if self.text.contains("\r\n") { "\r\n" } else { "\n" }
    }

    /// The text with all of these changes.
    ///
    /// # Errors
    /// Two of them are of the same text.
    pub(super) fn with(&self, mut splices: Vec<Splice>) -> Result<String, EditError> {
        // two at one place stay in their order
        splices.sort_by_key(|splice| splice.at.start);
        let mut text = String::with_capacity(self.text.len());
        let mut from = 0;
        for Splice { at, with } in splices {
            let kept = self.text.get(from..at.start);
            text.push_str(kept.ok_or_else(|| EditError::Overlap { file: self.file.to_owned() })?);
            text.push_str(&with);
            from = at.end;
        }
        text.push_str(&self.text[from..]);
        Ok(text)
    }
}

/// The last byte of what a table says below its own header.
pub(super) fn own_end(table: &Table) -> Option<usize> {
    let inner = table.iter().filter_map(|(_, item)| match item {
        Item::Value(value) => value.span().map(|span| span.end),
        Item::Table(table) if table.is_dotted() => own_end(table),
        Item::None | Item::Table(_) | Item::ArrayOfTables(_) => None,
    });
    let header = if table.is_implicit() { None } else { table.span().map(|span| span.end) };
    inner.chain(header).max()
}

/// The same with tables of headers of their own that belong to it.
pub(super) fn whole_end(table: &Table) -> Option<usize> {
    let inner = table.iter().filter_map(|(_, item)| match item {
        Item::Table(table) => whole_end(table),
        Item::ArrayOfTables(all) => all.iter().filter_map(whole_end).max(),
        Item::None | Item::Value(_) => None,
    });
    inner.chain(own_end(table)).max()
}

/// Where the first header of an item is.
fn first_header(item: &Item) -> Option<usize> {
    match item {
        Item::Table(table) if table.is_implicit() || table.is_dotted() => {
            table.iter().filter_map(|(_, item)| first_header(item)).min()
        }
        Item::Table(table) => table.span().map(|span| span.start),
        Item::ArrayOfTables(all) => all.iter().filter_map(toml_edit::Table::span).map(|span| span.start).min(),
        Item::None | Item::Value(_) => None,
    }
}

/// The number of the line in which a byte is, from 1.
pub(super) fn line_of(text: &str, at: usize) -> usize {
    1 + text.bytes().take(at).filter(|byte| *byte == b'\n').count()
}

fn line_start(text: &str, at: usize) -> usize {
    text[..at].rfind('\n').map_or(0, |newline| newline + 1)
}

/// Where the next line begins.
fn line_end(text: &str, at: usize) -> usize {
    text[at..].find('\n').map_or(text.len(), |newline| at + newline + 1)
}

/// A key as it is written.
pub(super) fn key_text(key: &str) -> String {
    Key::new(key).display_repr().into_owned()
}

/// A text as it is written.
pub(super) fn quoted(text: &str) -> String {
    Value::from(text).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn inserted(text: &str, path: &[&str]) -> String {
        let document = Document::parse("a.toml", text).expect("TOML");
        let mut held = Held::Header(document.root());
        for key in path {
            let Held::Header(table) = held else { panic!("no header") };
            let (key, item) = table.get_key_value(key).expect("there");
            held = Held::of(item, key.get()).expect("a table");
        }
        document.with(vec![document.insert(held, "new", "1")]).expect("one change")
    }

    #[test]
    fn a_key_goes_behind_the_last_one_of_its_table() {
        assert_eq!(inserted("[a]\nx = 1 # one\n\n# next\n[b]\n", &["a"]), "[a]\nx = 1 # one\nnew = 1\n\n# next\n[b]\n");
        assert_eq!(inserted("[a]\n[b]\n", &["a"]), "[a]\nnew = 1\n[b]\n");
        assert_eq!(inserted("[a]\n  x = 1", &["a"]), "[a]\n  x = 1\n  new = 1");
        assert_eq!(inserted("[a]\r\nx = 1\r\n", &["a"]), "[a]\r\nx = 1\r\nnew = 1\r\n");
        assert_eq!(inserted("[a]\nx = { y = 1 }\n", &["a", "x"]), "[a]\nx = { y = 1, new = 1 }\n");
        assert_eq!(inserted("[a]\nx = {}\n", &["a", "x"]), "[a]\nx = { new = 1 }\n");
        assert_eq!(inserted("[a]\nx.y = 1\nz = 2\n", &["a", "x"]), "[a]\nx.y = 1\nx.new = 1\nz = 2\n");
        assert_eq!(
            inserted("[a]\nx = [\n  1,\n]\n[a.b]\ny = 1\n", &["a"]),
            "[a]\nx = [\n  1,\n]\nnew = 1\n[a.b]\ny = 1\n"
        );
    }

    fn removed(text: &str, index: usize) -> String {
        let document = Document::parse("a.toml", text).expect("TOML");
        let table = document.tables("a").nth(index).expect("there");
        document.with(vec![document.remove_table(table).expect("a span")]).expect("one change")
    }

    #[test]
    fn a_table_goes_with_the_comment_right_above_it_and_no_other() {
        let text = "# top\n\n# first\n[[a]]\nx = 1\n\n# far\n\n[[a]]\nx = 2 # end\n[a.b]\ny = 1\n";
        assert_eq!(removed(text, 0), "# top\n\n# far\n\n[[a]]\nx = 2 # end\n[a.b]\ny = 1\n");
        assert_eq!(removed(text, 1), "# top\n\n# first\n[[a]]\nx = 1\n\n# far\n");
    }

    #[test]
    fn a_key_in_braces_goes_with_its_comma() {
        let text = "[c]\nbind = { a = 1, b = 2, c = 3 }\n";
        let document = Document::parse("a.toml", text).expect("TOML");
        let Some(Item::Table(table)) = document.root().get("c") else { panic!("a table") };
        let held = Held::of(&table["bind"], "bind").expect("a table");
        let without = |key| document.with(vec![document.remove_key(held, key).expect("there")]).expect("one change");
        assert_eq!(without("a"), "[c]\nbind = { b = 2, c = 3 }\n");
        assert_eq!(without("c"), "[c]\nbind = { a = 1, b = 2 }\n");
    }
}
