//! Faults, failed asserts and where the PLC parts from what was reviewed, with their places in the PLC's sources, as a SARIF log.

use onescan_report::Severity;
use onescan_report::sarif::{Found, Region, Rule, log};
use onescan_server::client::SourcePlace;

use super::outcome::{Outcome, Report};

const PLC_FAULT: usize = 0;
const ASSERT: usize = 1;
const PARTING: usize = 2;
const RULES: [Rule<'static>; 3] = [
    Rule { id: "plc-fault", about: "The PLC stopped because of an error in its program." },
    Rule { id: "assert", about: "An assert of a test program did not hold." },
    Rule { id: "parting", about: "The PLC parts here from the program that was reviewed." },
];

/// The log as JSON.
pub fn text(report: &Report) -> String {
    log(&RULES, report.outcomes.iter().flat_map(results), None)
}

fn results(outcome: &Outcome) -> Vec<Found<'_>> {
    let test = format!("{}/{}", outcome.suite, outcome.name);
    let mut found = Vec::new();
    if let (Some(error), Some(place)) = (&outcome.error, &outcome.place) {
        found.push(result(PLC_FAULT, format!("{test}: {error}"), place));
    }
    for failed in &outcome.asserts {
        found.push(result(ASSERT, format!("{test}: {}", failed.text), &failed.place));
    }
    if let Some((cause, place)) = outcome.cause.as_ref().and_then(|cause| Some((cause, cause.place.as_ref()?))) {
        found.push(result(PARTING, format!("{test}: {}", cause.lines.join("\n")), place));
    }
    found
}

fn result(rule: usize, text: String, place: &SourcePlace) -> Found<'_> {
    let region = Region { start: [place.line, place.column], end: None };
    Found { rule, level: Severity::Error, text, file: &place.file, region }
}
