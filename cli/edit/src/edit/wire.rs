//! Connections in `scenario.toml`: signals, and which variable of a PLC each of them is.

use toml_edit::{Item, Table};

use onescan_server::signal::nearest;

use super::change::Texts;
use super::document::{Document, Held, Splice, key_text, quoted};
use super::error::{EditError, Reference};
use super::reference;

/// What the file is called in places.
pub(super) const FILE: &str = "scenario.toml";

/// A signal as it is to be declared.
pub(super) struct Declared<'d> {
    pub(super) signal: &'d str,
    pub(super) ty: &'d str,
    pub(super) writer: &'d str,
    pub(super) unit: Option<&'d str>,
    pub(super) about: Option<&'d str>,
}

/// The names of the tables in a table, as `[clients]` has them.
fn names(table: Option<&Item>) -> impl Iterator<Item = &str> {
    table.and_then(Item::as_table_like).into_iter().flat_map(|table| table.iter().map(|(name, _)| name))
}

fn client<'d>(document: &'d Document<'_>, name: &'d str) -> Result<Held<'d>, EditError> {
    let clients = document.root().get("clients");
    let found = clients.and_then(|clients| clients.get(name)).and_then(|item| Held::of(item, name));
    found.ok_or_else(|| EditError::Missing {
        what: "client".to_owned(),
        name: name.to_owned(),
        file: FILE.to_owned(),
        near: nearest(name, names(clients)).map(str::to_owned),
    })
}

/// What `bind` of a client is; nothing if there is none.
fn bind(client: Held<'_>) -> Option<Held<'_>> {
    match client {
        Held::Header(table) | Held::Dotted(table, _) => Held::of(table.get("bind")?, "bind"),
        Held::Inline(table) => table.get("bind")?.as_inline_table().map(Held::Inline),
    }
}

/// `Name = "Path"` in `bind` of a PLC.
pub(super) fn connect(texts: &Texts, plc: &str, signal: &str, variable: &str) -> Result<Texts, EditError> {
    let document = Document::parse(FILE, &texts.scenario)?;
    let client = client(&document, plc)?;
    let path = quoted(variable);
    let splice = match bind(client) {
        None => document.insert(client, "bind", &format!("{{ {} = {path} }}", key_text(signal))),
        Some(bind) => match bind.value(signal) {
            Some((_, span)) => Splice::new(span, path),
            None => document.insert(bind, signal, &path),
        },
    };
    Ok(Texts { scenario: document.with(vec![splice])?, ..texts.clone() })
}

/// Takes that line away; with the last of several in braces, `bind` itself.
pub(super) fn disconnect(texts: &Texts, plc: &str, signal: &str) -> Result<Texts, EditError> {
    let document = Document::parse(FILE, &texts.scenario)?;
    let client = client(&document, plc)?;
    let by_name = || EditError::ByName { signal: signal.to_owned(), client: plc.to_owned() };
    let bind = bind(client).ok_or_else(by_name)?;
    let is_alone = matches!(bind, Held::Inline(table) if table.len() == 1 && table.contains_key(signal));
    let splice = if is_alone { document.remove_key(client, "bind") } else { document.remove_key(bind, signal) };
    let splice = splice.ok_or_else(|| covering(&document, bind, signal).unwrap_or_else(by_name))?;
    Ok(Texts { scenario: document.with(vec![splice])?, ..texts.clone() })
}

/// The pattern or array of `bind` by which a signal is bound.
fn covering(document: &Document<'_>, bind: Held<'_>, signal: &str) -> Option<EditError> {
    let mut table: Box<dyn Iterator<Item = (&str, &toml_edit::Value)>> = match bind {
        Held::Header(table) | Held::Dotted(table, _) => {
            Box::new(table.get_values().into_iter().filter_map(|(keys, value)| Some((keys.first()?.get(), value))))
        }
        Held::Inline(table) => Box::new(table.iter()),
    };
    let stem = |key: &str| key.split(['*', '[']).next().unwrap_or_default().to_owned();
    let (key, value) = table.find(|(key, _)| key.contains(['*', '[']) && signal.starts_with(&stem(key)))?;
    let place = document.place(value.span()?.start);
    Some(EditError::Together { name: signal.to_owned(), written: key.to_owned(), place })
}

/// `Name = { type = "BOOL", writer = "plc" }` in `[signals]`.
pub(super) fn declare(texts: &Texts, declared: &Declared<'_>) -> Result<Texts, EditError> {
    let Declared { signal, ty, writer, unit, about } = declared;
    let document = Document::parse(FILE, &texts.scenario)?;
    client(&document, writer)?;
    if let Some(place) = line_of(&document, signal) {
        return Err(EditError::Taken { what: "signal".to_owned(), name: (*signal).to_owned(), place });
    }
    let mut said = format!("type = {}, writer = {}", quoted(ty), quoted(writer));
    for (key, value) in [("unit", unit), ("about", about)] {
        if let Some(value) = value {
            said.extend([", ", key, " = ", quoted(value).as_str()]);
        }
    }
    let value = format!("{{ {said} }}");
    let splice = match signals(&document) {
        Some(table) if table.is_dotted() => document.insert(Held::Dotted(table, "signals"), signal, &value),
        Some(table) if !table.is_implicit() => document.insert(Held::Header(table), signal, &value),
        _ => document.lines_before_tables(&format!("[signals]\n{} = {value}", key_text(signal))),
    };
    Ok(Texts { scenario: document.with(vec![splice])?, ..texts.clone() })
}

fn signals<'d>(document: &'d Document<'_>) -> Option<&'d Table> {
    document.root().get("signals").and_then(Item::as_table)
}

/// Where a signal is declared by itself.
pub(super) fn line_of(document: &Document<'_>, signal: &str) -> Option<super::error::Place> {
    let span = signals(document)?.key(signal)?.span()?;
    Some(document.place(span.start))
}

/// Takes the line of a signal away that nothing refers to.
pub(super) fn withdraw(texts: &Texts, signal: &str) -> Result<Texts, EditError> {
    let document = Document::parse(FILE, &texts.scenario)?;
    let missing = || EditError::Missing {
        what: "signal".to_owned(),
        name: signal.to_owned(),
        file: FILE.to_owned(),
        near: nearest(signal, names(document.root().get("signals"))).map(str::to_owned),
    };
    let table = signals(&document).ok_or_else(missing)?;
    let by = users(texts, &document, signal)?;
    if !by.is_empty() {
        return Err(EditError::Referred { what: "signal".to_owned(), name: signal.to_owned(), by });
    }
    let splice = match table.get(signal) {
        Some(Item::Value(_)) => document.remove_key(Held::Header(table), signal),
        Some(Item::Table(table)) => document.remove_table(table),
        _ => None,
    };
    let scenario = document.with(vec![splice.ok_or_else(missing)?])?;
    Ok(Texts { scenario, ..texts.clone() })
}

/// Who refers to a signal: scenes, and the rest of the scenario.
fn users(texts: &Texts, document: &Document<'_>, signal: &str) -> Result<Vec<Reference>, EditError> {
    let mut by = Vec::new();
    for (file, text) in &texts.scenes {
        by.extend(reference::to_signal(&Document::parse(file, text)?, signal));
    }
    for (key, item) in document.root().iter().filter(|(key, _)| *key != "signals") {
        by.extend(reference::to_word(document, key, item, signal));
    }
    Ok(by)
}
