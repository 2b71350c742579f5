//! Faults and failed asserts, with their places in the PLC's sources, as SARIF 2.1.0.

use onescan_server::client::SourcePlace;
use serde_json::{Value, json};

use super::outcome::{Outcome, Report};
use crate::check::sarif::{SCHEMA, uri};

/// What may be found: identity and description.
const RULES: [(&str, &str); 2] = [
    ("plc-fault", "The PLC stopped because of an error in its program."),
    ("assert", "An assert of a test program did not hold."),
];

/// The log as JSON.
pub fn text(report: &Report) -> String {
    let rules: Vec<Value> =
        RULES.iter().map(|(id, about)| json!({ "id": id, "shortDescription": { "text": about } })).collect();
    let results: Vec<Value> = report.outcomes.iter().flat_map(results).collect();
    let log = json!({
        "$schema": SCHEMA,
        "version": "2.1.0",
        "runs": [{
            "tool": { "driver": { "name": "onescan", "version": env!("CARGO_PKG_VERSION"), "rules": rules } },
            "columnKind": "unicodeCodePoints",
            "results": results,
        }],
    });
    format!("{log:#}\n")
}

fn results(outcome: &Outcome) -> Vec<Value> {
    let test = format!("{}/{}", outcome.suite, outcome.name);
    let mut found = Vec::new();
    if let (Some(error), Some(place)) = (&outcome.error, &outcome.place) {
        found.push(result(0, &format!("{test}: {error}"), place));
    }
    for failed in &outcome.asserts {
        found.push(result(1, &format!("{test}: {}", failed.text), &failed.place));
    }
    found
}

fn result(rule: usize, text: &str, place: &SourcePlace) -> Value {
    json!({
        "ruleId": RULES[rule].0,
        "ruleIndex": rule,
        "level": "error",
        "message": { "text": text },
        "locations": [{ "physicalLocation": {
            "artifactLocation": { "uri": uri(&place.file) },
            "region": { "startLine": place.line.max(1), "startColumn": place.column.max(1) },
        } }],
    })
}
