//! All tests for CI servers.

use onescan_report::junit::{Case, Ended, Suite, Tests, Trouble};

use super::outcome::{Outcome, Report, Status};
use super::summary::details;

/// The report as XML.
pub fn text(report: &Report) -> String {
    let of = |suite: &&str| Suite {
        name: (*suite).to_owned(),
        cases: report.outcomes.iter().filter(|outcome| outcome.suite == *suite).map(case).collect(),
    };
    Tests { suites: report.suites().iter().map(of).collect(), wall_time: report.wall_time }.to_xml()
}

fn case(outcome: &Outcome) -> Case {
    let place = outcome.asserts.first().map(|failed| &failed.place).or(outcome.place.as_ref());
    let place = place.or_else(|| outcome.cause.as_ref()?.place.as_ref());
    let trouble = || Trouble { word: outcome.status.word(), lines: details(outcome) };
    // CI servers show the suite, which stands before the name, as a class.
    let own = outcome.class.as_ref().and_then(|class| outcome.name.strip_prefix(class.as_str())?.strip_prefix('@'));
    Case {
        class: outcome.class.clone(),
        name: own.unwrap_or(&outcome.name).to_owned(),
        virtual_time_ns: outcome.virtual_time_ns,
        wall_time: outcome.wall_time,
        place: place.map(|place| (place.file.clone(), place.line)),
        ended: match outcome.status {
            Status::Passed | Status::New | Status::Blessed => Ended::Well,
            Status::Skipped => Ended::Skipped,
            Status::Missing | Status::Changed | Status::Failed => Ended::Failure(trouble()),
            Status::Fault | Status::Wrong => Ended::Error(trouble()),
        },
    }
}
