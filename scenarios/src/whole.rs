//! A scenario as one file: with everything that it takes in, to be read by people or by machines.

use std::fmt::{self, Write as _};

use serde_json::{Map, Number, Value as Json, json};
use toml::de::{DeArray, DeTable, DeValue};
use toml::{Spanned, Value};

use crate::error::ScenarioError;
use crate::load::Scenario;

/// How long a line is before what is on it gets lines of its own.
const WIDTH: usize = 120;

impl Scenario {
    /// The scenario's file with everything that it takes in, as TOML that loads to the same session.
    ///
    /// # Errors
    /// None for a scenario that was read.
    pub fn to_toml(&self) -> Result<String, ScenarioError> {
        let tree = self.chain().tree()?;
        let mut text = String::new();
        // Writing to a text cannot fail; what could is said by the type.
        section(&mut text, &mut Vec::new(), tree.get_ref())
            .map_err(|error| self.wrong_option(error.to_string(), None))?;
        Ok(text)
    }

    /// The same as JSON. A number that JSON does not have, as `inf`, is a text.
    ///
    /// # Errors
    /// None for a scenario that was read.
    pub fn to_json(&self) -> Result<Json, ScenarioError> {
        Ok(json_table(self.chain().tree()?.get_ref()))
    }
}

/// The entries of a table in the order in which their files have them: the scenario's own first, then those of its bases.
fn in_order<'e, 't>(table: &'e DeTable<'t>) -> Vec<(&'e str, &'e DeValue<'t>)> {
    let mut entries: Vec<_> = table.iter().collect();
    entries.sort_by_key(|(key, _)| key.span().start);
    entries.into_iter().map(|(key, value)| (&**key.get_ref(), value.get_ref())).collect()
}

/// The tables of a list that has nothing else.
fn tables<'e, 't>(value: &'e DeValue<'t>) -> Option<Vec<&'e DeTable<'t>>> {
    let list = value.as_array().filter(|list| !list.is_empty())?;
    list.iter().map(|entry| entry.get_ref().as_table()).collect()
}

/// Everything below the header `path`.
fn section(text: &mut String, path: &mut Vec<String>, table: &DeTable<'_>) -> fmt::Result {
    let mut below = Vec::new();
    for (key, value) in in_order(table) {
        let line = format!("{} = {}", quoted_key(key), inline(value));
        let is_held = value.as_table().is_some() || tables(value).is_some();
        if is_held && (path.is_empty() || line.chars().count() > WIDTH) {
            below.push((key, value));
        } else if let Some(list) = value.as_array().filter(|_| line.chars().count() > WIDTH) {
            writeln!(text, "{} = [", quoted_key(key))?;
            list.iter().try_for_each(|entry| writeln!(text, "    {},", inline(entry.get_ref())))?;
            writeln!(text, "]")?;
        } else {
            writeln!(text, "{line}")?;
        }
    }
    for (key, value) in below {
        path.push(quoted_key(key));
        let header = path.join(".");
        if let Some(table) = value.as_table() {
            writeln!(text, "\n[{header}]")?;
            section(text, path, table)?;
        }
        for entry in tables(value).unwrap_or_default() {
            writeln!(text, "\n[[{header}]]")?;
            section(text, path, entry)?;
        }
        path.pop();
    }
    Ok(())
}

/// A value on one line.
fn inline(value: &DeValue<'_>) -> String {
    match value {
        DeValue::String(text) => Value::from(&**text).to_string(),
        DeValue::Integer(whole) => whole.to_string(),
        DeValue::Float(number) => number.to_string(),
        DeValue::Boolean(flag) => flag.to_string(),
        DeValue::Datetime(time) => time.to_string(),
        DeValue::Array(list) => format!("[{}]", each(list).collect::<Vec<_>>().join(", ")),
        DeValue::Table(table) if table.is_empty() => "{}".to_owned(),
        DeValue::Table(table) => {
            let pairs =
                in_order(table).into_iter().map(|(key, value)| format!("{} = {}", quoted_key(key), inline(value)));
            format!("{{ {} }}", pairs.collect::<Vec<_>>().join(", "))
        }
    }
}

fn each(list: &DeArray<'_>) -> impl Iterator<Item = String> {
    list.iter().map(|entry| inline(entry.get_ref()))
}

/// A key, in quotes where it needs them.
fn quoted_key(key: &str) -> String {
    let is_bare =
        !key.is_empty() && key.bytes().all(|byte| byte.is_ascii_alphanumeric() || matches!(byte, b'_' | b'-'));
    // A text on several lines is a value, but not a key.
    if is_bare { key.to_owned() } else { json!(key).to_string() }
}

fn json_table(table: &DeTable<'_>) -> Json {
    let pair = |(key, value): (&Spanned<_>, &Spanned<DeValue<'_>>)| (key_text(key), json_value(value.get_ref()));
    Json::Object(table.iter().map(pair).collect::<Map<_, _>>())
}

fn key_text(key: &Spanned<std::borrow::Cow<'_, str>>) -> String {
    key.get_ref().to_string()
}

fn json_value(value: &DeValue<'_>) -> Json {
    match value {
        DeValue::String(text) => json!(text),
        DeValue::Integer(whole) => {
            match i128::from_str_radix(whole.as_str(), whole.radix()).ok().and_then(Number::from_i128) {
                Some(number) => Json::Number(number),
                None => json!(whole.to_string()),
            }
        }
        DeValue::Float(number) => match number.as_str().parse().ok().and_then(Number::from_f64) {
            Some(number) => Json::Number(number),
            None => json!(number.to_string()),
        },
        DeValue::Boolean(flag) => json!(flag),
        DeValue::Datetime(time) => json!(time.to_string()),
        DeValue::Array(list) => list.iter().map(|entry| json_value(entry.get_ref())).collect(),
        DeValue::Table(table) => json_table(table),
    }
}
