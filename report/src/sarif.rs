//! SARIF 2.1.0 (OASIS), which code hosts and editors read: one log with one run.

use std::path::{Component, Path};

use serde_json::{Value, json};

use crate::severity::Severity;

/// Where the log's schema is.
const SCHEMA: &str = "https://docs.oasis-open.org/sarif/sarif/v2.1.0/errata01/os/schemas/sarif-schema-2.1.0.json";

/// Something that may be found.
#[derive(Clone, Copy, Debug)]
pub struct Rule<'a> {
    pub id: &'a str,
    /// What it is about, in a sentence.
    pub about: &'a str,
}

/// A place in a file. Lines and columns count from 1, columns count characters; what is 0 is taken for 1.
#[derive(Clone, Copy, Debug)]
pub struct Region {
    /// Line and column where it begins.
    pub start: [u32; 2],
    /// Line and column behind its last character, where that is known.
    pub end: Option<[u32; 2]>,
}

/// Something that was found.
#[derive(Clone, Debug)]
pub struct Found<'a> {
    /// Which of the log's rules, by its index.
    pub rule: usize,
    /// How grave it is.
    pub level: Severity,
    pub text: String,
    /// The file, as it is found from where the program was started.
    pub file: &'a str,
    /// The place in it.
    pub region: Region,
}

/// The log as JSON, with a line break at its end. The notice is about the run and not a place in a file.
pub fn log<'a>(rules: &[Rule<'_>], found: impl Iterator<Item = Found<'a>>, notice: Option<&str>) -> String {
    let results: Vec<Value> = found.map(|found| result(rules, &found)).collect();
    let rules: Vec<Value> =
        rules.iter().map(|Rule { id, about }| json!({ "id": id, "shortDescription": { "text": about } })).collect();
    let mut log = json!({
        "$schema": SCHEMA,
        "version": "2.1.0",
        "runs": [{
            "tool": { "driver": { "name": "onescan", "version": env!("CARGO_PKG_VERSION"), "rules": rules } },
            "columnKind": "unicodeCodePoints",
            "results": results,
        }],
    });
    if let Some(text) = notice {
        log["runs"][0]["invocations"] = json!([{
            "executionSuccessful": true,
            "toolExecutionNotifications": [{ "level": "note", "message": { "text": text } }],
        }]);
    }
    format!("{log:#}\n")
}

fn result(rules: &[Rule<'_>], found: &Found<'_>) -> Value {
    let Found { rule, level, text, file, region: Region { start: [line, column], end } } = found;
    let mut region = json!({ "startLine": line.max(&1), "startColumn": column.max(&1) });
    if let Some([line, column]) = end {
        region["endLine"] = json!(line.max(&1));
        region["endColumn"] = json!(column.max(&1));
    }
    json!({
        "ruleId": rules.get(*rule).map(|rule| rule.id),
        "ruleIndex": rule,
        "level": level,
        "message": { "text": text },
        "locations": [{ "physicalLocation": {
            "artifactLocation": { "uri": uri(file) },
            "region": region,
        } }],
    })
}

/// A file's name as a URI reference (RFC 3986): everything but unreserved characters is escaped.
fn uri(file: &str) -> String {
    let path = Path::new(file);
    let mut text = String::new();
    for component in path.components() {
        match component {
            Component::RootDir => text.push_str("file:///"),
            Component::CurDir => {}
            other => {
                if !text.is_empty() && !text.ends_with('/') {
                    text.push('/');
                }
                escape(&other.as_os_str().to_string_lossy(), &mut text);
            }
        }
    }
    text
}

fn escape(segment: &str, text: &mut String) {
    for byte in segment.bytes() {
        if byte.is_ascii_alphanumeric() || b"-._~".contains(&byte) {
            text.push(char::from(byte));
        } else {
            const HEX: &[u8; 16] = b"0123456789ABCDEF";
            text.push('%');
            text.extend([byte >> 4, byte & 15].map(|digit| char::from(HEX[usize::from(digit)])));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_become_uris() {
        assert_eq!(uri("./plc/Förder band.st"), "plc/F%C3%B6rder%20band.st");
        assert_eq!(uri("/a/b.st"), "file:///a/b.st");
    }
}
