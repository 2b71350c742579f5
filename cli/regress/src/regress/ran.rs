//! What a process says of its unit, as JSON on its standard output.

use onescan_iec_run::coverage::{Counted, Row};
use onescan_iec_run::{Coverage, PlcFault};
use onescan_report::Verdict;
use onescan_server::client::SourcePlace;
use serde::{Deserialize, Serialize};

use onescan_runner::run::expectation::SignalValue;
use onescan_runner::run::page::Event;
use onescan_runner::run::{RunReport, RunStatus};

/// All that came of a unit.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Worked {
    pub tests: Vec<Ran>,
    /// What its PLCs executed.
    pub coverage: Vec<Covered>,
    /// Why there is nothing: an error, drawn, and the process's exit code.
    pub error: Option<(String, i32)>,
}

/// One test that was run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ran {
    pub name: String,
    /// The tags of a test program.
    #[serde(default)]
    pub tags: Vec<String>,
    /// The suite of `TcUnit` that it is in.
    #[serde(default)]
    pub class: Option<String>,
    /// True for a test that is switched off.
    #[serde(default)]
    pub skipped: bool,
    pub status: RunStatus,
    /// The digest over all steps.
    pub digest: Option<String>,
    pub steps: u64,
    /// Virtual time of the last of them.
    pub virtual_time_ns: u64,
    /// The step or cycle.
    pub step_ns: u64,
    /// How long it took, where it was measured by itself.
    #[serde(default)]
    pub wall_ns: Option<u64>,
    pub error: Option<String>,
    /// Where in the PLC's sources.
    pub place: Option<SourcePlace>,
    /// What it had to show.
    pub expectations: Vec<Shown>,
    /// Asserts that did not hold.
    pub asserts: Vec<FailedAssert>,
    /// How many asserts were looked at.
    pub asserts_made: u64,
    /// What else the library under which it ran has to say.
    #[serde(default)]
    pub notes: Vec<String>,
    /// What happened to it from outside.
    pub events: Vec<Event>,
    /// Its trajectory, as a snapshot's text.
    pub snapshot: Option<String>,
    /// Its trajectory, as SVG.
    pub picture: Option<String>,
    /// The same as data for a chart.
    pub chart: Option<String>,
}

/// What came of an expectation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Shown {
    pub name: String,
    /// Whether it was met.
    pub verdict: Verdict,
    /// When it was first violated.
    pub at_ns: Option<u64>,
    /// What its signals were then.
    pub values: Vec<(String, f64)>,
    /// By how much it was met.
    pub margin: Option<f64>,
    /// What the margin is measured in, if that is one unit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub margin_unit: Option<String>,
}

impl Shown {
    /// True if the run did not show it.
    pub fn is_violated(&self) -> bool {
        self.verdict == Verdict::Violated
    }
}

/// An assert that did not hold.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FailedAssert {
    pub text: String,
    /// The type of what it compares, where that is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub kind: Option<String>,
    pub place: SourcePlace,
    /// When it first did not hold.
    pub at_ns: u64,
    /// In how many scans.
    pub times: u64,
}

/// A row of coverage.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Covered(String, u32, Option<String>, Option<(u32, u32)>, u64);

impl From<Row> for Covered {
    fn from(Row { file, line, of, count }: Row) -> Self {
        match of {
            Counted::Unit(unit) => Self(file, line, Some(unit), None, count),
            Counted::Line => Self(file, line, None, None, count),
            Counted::Outcome { column, outcome } => Self(file, line, None, Some((column, outcome)), count),
        }
    }
}

impl Covered {
    /// Coverage as it is handed over.
    pub(crate) fn all(coverage: &Coverage) -> Vec<Self> {
        coverage.rows().into_iter().map(Self::from).collect()
    }

    /// The row, of a file in `folder`.
    pub fn row(&self, folder: &str) -> Row {
        let Self(file, line, unit, outcome, count) = self;
        let of = match (unit, outcome) {
            (Some(unit), _) => Counted::Unit(unit.clone()),
            (None, Some((column, outcome))) => Counted::Outcome { column: *column, outcome: *outcome },
            (None, None) => Counted::Line,
        };
        Row { file: within(folder, file), line: *line, of, count: *count }
    }
}

/// A file of a scenario as it is found from where the tests were started.
pub fn within(folder: &str, file: &str) -> String {
    if folder.is_empty() || folder == "." || std::path::Path::new(file).is_absolute() {
        file.to_owned()
    } else {
        format!("{folder}/{file}")
    }
}

/// Where a fault stopped the PLC, if that is in a source.
pub fn fault_place(fault: &PlcFault) -> Option<SourcePlace> {
    let at = &fault.at;
    (!at.file.is_empty()).then(|| SourcePlace { file: at.file.clone(), line: at.line, column: at.column })
}

impl Ran {
    /// A test of which nothing is known yet but how it ended.
    pub fn new(name: String, status: RunStatus) -> Self {
        Self {
            name,
            tags: Vec::new(),
            class: None,
            skipped: false,
            status,
            digest: None,
            steps: 0,
            virtual_time_ns: 0,
            step_ns: 0,
            wall_ns: None,
            error: None,
            place: None,
            expectations: Vec::new(),
            asserts: Vec::new(),
            asserts_made: 0,
            notes: Vec::new(),
            events: Vec::new(),
            snapshot: None,
            picture: None,
            chart: None,
        }
    }

    /// What a report of a run says.
    pub fn of(name: &str, report: &RunReport, step_ns: u64) -> Self {
        use onescan_server::end::FailureCause;
        let cause = report.failure.as_ref().map(|failure| &failure.cause);
        let place = if let Some(FailureCause::Fault(fault)) = cause { fault.place.clone() } else { None };
        let shown = report.expectations.iter().map(|expectation| Shown {
            name: expectation.name.clone(),
            verdict: expectation.verdict,
            at_ns: expectation.at.map(onescan_server::time::VirtualTime::as_nanos),
            values: expectation.values.iter().map(|SignalValue { signal, value }| (signal.clone(), *value)).collect(),
            margin: expectation.margin,
            margin_unit: expectation.margin_unit.clone(),
        });
        Self {
            digest: report.digest.map(|digest| digest.to_string()),
            steps: report.steps.0,
            virtual_time_ns: report.virtual_time.as_nanos(),
            step_ns,
            error: report.error.clone(),
            place,
            expectations: shown.collect(),
            ..Self::new(name.to_owned(), report.status)
        }
    }
}
