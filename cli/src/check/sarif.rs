//! Findings as SARIF 2.1.0 (OASIS), one log with one run.

use std::io::{self, Write};
use std::path::{Component, Path};

use onescan_plc_shim::{Code, Finding, Severity};
use serde_json::{Value, json};

use super::report::Report;

/// Where the log's schema is.
pub const SCHEMA: &str = "https://docs.oasis-open.org/sarif/sarif/v2.1.0/errata01/os/schemas/sarif-schema-2.1.0.json";

/// Writes the report.
///
/// # Errors
/// Those of `out`.
pub fn write(report: &Report, out: &mut dyn Write) -> io::Result<()> {
    serde_json::to_writer_pretty(&mut *out, &log(report))?;
    writeln!(out)
}

fn log(report: &Report) -> Value {
    let rules: Vec<Value> = Code::ALL.iter().map(|code| rule(*code)).collect();
    let results: Vec<Value> = report.iter().map(result).collect();
    json!({
        "$schema": SCHEMA,
        "version": "2.1.0",
        "runs": [{
            "tool": { "driver": {
                "name": "onescan",
                "version": env!("CARGO_PKG_VERSION"),
                "rules": rules,
            } },
            "columnKind": "unicodeCodePoints",
            "results": results,
        }],
    })
}

fn rule(code: Code) -> Value {
    json!({ "id": code.text(), "shortDescription": { "text": code.about() } })
}

fn result(finding: &Finding) -> Value {
    let found = finding.diagnostic();
    let level = match found.severity {
        Severity::Warning => "warning",
        Severity::Error => "error",
    };
    let text = match &found.help {
        Some(help) => format!("{} ({help})", found.message),
        None => found.message.clone(),
    };
    let (start, end) = (finding.start(), finding.end());
    json!({
        "ruleId": found.code.text(),
        "ruleIndex": Code::ALL.iter().position(|code| *code == found.code),
        "level": level,
        "message": { "text": text },
        "locations": [{ "physicalLocation": {
            "artifactLocation": { "uri": uri(finding.file()) },
            "region": {
                "startLine": start.line.max(1),
                "startColumn": start.column.max(1),
                "endLine": end.line.max(1),
                "endColumn": end.column.max(1),
            },
        } }],
    })
}

/// A file's name as a URI reference (RFC 3986): everything but unreserved characters is escaped.
pub fn uri(file: &str) -> String {
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
