//! Who refers to what: names in the tables of a scene, words in a scenario.

use std::ops::Range;

use toml_edit::{Item, Table, Value};

use super::change::Sort;
use super::document::Document;
use super::error::Reference;
use super::field::{self, Form};

/// A name that stands for a thing of another table.
pub(super) struct Mention {
    /// The table that names it, and the key.
    pub(super) by: String,
    /// The text, with its quotes.
    pub(super) span: Range<usize>,
    pub(super) text: String,
}

/// A name without the range or the index at its end.
pub(super) fn base(name: &str) -> &str {
    name.split('[').next().unwrap_or(name)
}

/// Every mention of the thing `name` of this sort.
pub(super) fn to(document: &Document<'_>, sort: Sort, name: &str) -> Vec<Mention> {
    let mut found = Vec::new();
    let failures = document.tables("failure").map(|table| ("failure", table));
    let all = Sort::ALL.into_iter().flat_map(|sort| document.tables(sort.key()).map(move |table| (sort.key(), table)));
    for (table_sort, table) in all.chain(failures) {
        let whose = table
            .get("name")
            .and_then(Item::as_str)
            .map_or_else(|| table_sort.to_owned(), |name| format!("{table_sort} `{name}`"));
        for (key, item) in table {
            let Some(value) = item.as_value() else { continue };
            if refers(table_sort, table, key) != Some(sort) {
                continue;
            }
            for (text, span) in texts(value) {
                // an output of a component: `barrier.detected`
                let named = if sort == Sort::Component { text.split('.').next().unwrap_or(text) } else { text };
                if base(named) == base(name) {
                    found.push(Mention { by: format!("{whose}, {key}"), span, text: text.to_owned() });
                }
            }
        }
    }
    found
}

/// The sort of thing that a key of a table names.
fn refers(sort: &str, table: &Table, key: &str) -> Option<Sort> {
    match sort {
        "component" => {
            if key.ends_with("_from") {
                return Some(Sort::Component);
            }
            let kind = table.get("kind").and_then(Item::as_str).unwrap_or_default();
            let Some(fields) = field::of_kind(kind) else { return field::refers(key) };
            match fields.into_iter().find(|field| field.key == key)?.form {
                Form::Text { names } | Form::Texts { names } => names,
                _ => None,
            }
        }
        "failure" => (key == "component").then_some(Sort::Component),
        _ => field::refers(key),
    }
}

/// The texts that a value is or has.
fn texts(value: &Value) -> Vec<(&str, Range<usize>)> {
    match value {
        Value::String(text) => value.span().map(|span| (text.value().as_str(), span)).into_iter().collect(),
        Value::Array(all) => all.iter().flat_map(texts).collect(),
        Value::InlineTable(table) => table.iter().flat_map(|(_, value)| texts(value)).collect(),
        _ => Vec::new(),
    }
}

/// The tables of a scene that name a signal.
pub(super) fn to_signal(document: &Document<'_>, signal: &str) -> Vec<Reference> {
    let mut found = Vec::new();
    for (sort, item) in document.root() {
        for table in item.as_array_of_tables().into_iter().flat_map(|all| all.iter()) {
            let name = table.get("name").and_then(Item::as_str).unwrap_or_default();
            for (key, value) in table.iter().filter_map(|(key, item)| Some((key, item.as_value()?))) {
                let is_signal = key == "signal" || key.ends_with("_signal") || (sort == "signal" && key == "name");
                if is_signal && value.as_str() == Some(signal) {
                    let place = document.place(value.span().map_or(0, |span| span.start));
                    found.push(Reference { by: format!("{sort} `{name}`, {key}"), place });
                }
            }
        }
    }
    found
}

/// Where a word stands among the keys and texts of an item: a signal in a formula, a plot, a panel, a `bind`.
pub(super) fn to_word(document: &Document<'_>, whose: &str, item: &Item, word: &str) -> Vec<Reference> {
    let at = |span: Option<Range<usize>>| {
        let place = document.place(span.map_or(0, |span| span.start));
        Reference { by: format!("[{whose}]"), place }
    };
    match item {
        Item::Value(value) => {
            let texts = texts(value).into_iter().filter(|(text, _)| has_word(text, word));
            let keys =
                value.as_inline_table().into_iter().flat_map(|table| table.iter()).filter(|(key, _)| *key == word);
            texts.map(|(_, span)| at(Some(span))).chain(keys.map(|(_, value)| at(value.span()))).collect()
        }
        Item::Table(table) => {
            let inner = |(key, item): (&str, &Item)| {
                let own = (key == word).then(|| at(table.key(key).and_then(toml_edit::Key::span)));
                own.into_iter().chain(to_word(document, &format!("{whose}.{key}"), item, word)).collect::<Vec<_>>()
            };
            table.iter().flat_map(inner).collect()
        }
        Item::ArrayOfTables(all) => {
            let items = all.iter().flat_map(|table| table.iter());
            items.flat_map(|(_, item)| to_word(document, whose, item, word)).collect()
        }
        Item::None => Vec::new(),
    }
}

/// Whether a text has a word by itself: `Push` in `always (Push implies not Belt_On)`.
fn has_word(text: &str, word: &str) -> bool {
    let is_part = |c: char| c.is_alphanumeric() || c == '_';
    text.match_indices(word)
        .any(|(at, _)| !text[..at].ends_with(is_part) && !text[at + word.len()..].starts_with(is_part))
}
