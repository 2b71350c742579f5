//! What came of each test, and of all.

use std::path::PathBuf;
use std::time::Duration;

use onescan_server::client::SourcePlace;
use serde::Serialize;

use super::config::{Policy, TestConfig};
use super::error::TestError;
use super::plan::{CaseUnit, Unit, shown};
use super::ran::{FailedAssert, Ran, Shown, Worked, within};
use crate::snapshot::overlay::overlay;
use crate::snapshot::store::{Merge, Reviewed};
use crate::snapshot::{Difference, Snapshot, compare};
use onescan_runner::error::ExitCode;
use onescan_runner::run::RunStatus;
use onescan_runner::run::page::Event;

/// Why a test is not what was reviewed. Its JSON form is a contract: fields are added, never changed.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Cause {
    /// The commit of the reviewed program.
    pub commit: String,
    /// The statement in which the runs part, as it is now; as it was where it is gone.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub place: Option<SourcePlace>,
    /// The way back, a line each.
    pub lines: Vec<String>,
    /// The way back, as `onescan diff --format json` has it.
    pub why: serde_json::Value,
    /// So many of the lines are of the statement in which the runs part; the others are of the way from there.
    #[serde(skip)]
    pub root: usize,
}

impl Cause {
    /// What two tests have in common whose runs part in the same statement.
    pub fn root(&self) -> (&str, &[String]) {
        (&self.commit, self.lines.get(..self.root).unwrap_or(&self.lines))
    }
}

/// How a test ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Status {
    /// All is as it should be.
    Passed,
    /// There was no snapshot, and now one waits for a review.
    New,
    /// The snapshot was accepted unseen.
    Blessed,
    /// There is no snapshot, and there should be one.
    Missing,
    /// The trajectory is not the reviewed one.
    Changed,
    /// An expectation was violated, or an assert did not hold.
    Failed,
    /// A client or a link failed.
    Fault,
    /// The input is wrong.
    Wrong,
    /// The test is switched off.
    Skipped,
}

impl Status {
    /// One word for it.
    pub fn word(self) -> &'static str {
        match self {
            Self::Passed => "passed",
            Self::New => "new",
            Self::Blessed => "blessed",
            Self::Missing => "missing",
            Self::Changed => "changed",
            Self::Failed => "failed",
            Self::Fault => "fault",
            Self::Wrong => "wrong",
            Self::Skipped => "skipped",
        }
    }

    /// What it makes of the whole.
    pub fn exit_code(self) -> ExitCode {
        match self {
            Self::Passed | Self::New | Self::Blessed | Self::Skipped => ExitCode::Ok,
            Self::Missing | Self::Changed | Self::Failed => ExitCode::Unmet,
            Self::Wrong => ExitCode::WrongInput,
            Self::Fault => ExitCode::Fault,
        }
    }

    /// True if it makes the whole fail.
    pub fn is_bad(self) -> bool {
        self.exit_code() != ExitCode::Ok
    }
}

/// What came of one test. Its JSON form is a contract: fields are added, never changed.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Outcome {
    /// The scenario's folder, or the test's sources.
    pub suite: String,
    /// The case or the test program; empty if it is not known.
    pub name: String,
    /// What to choose it by.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub tags: Vec<String>,
    /// The suite of `TcUnit` that it is in.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub class: Option<String>,
    pub status: Status,
    /// The digest over all steps.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub digest: Option<String>,
    pub steps: u64,
    /// Virtual time of the last of them.
    pub virtual_time_ns: u64,
    /// Where the trajectory is not the reviewed one, the first difference first.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub differences: Vec<Difference>,
    /// What it had to show.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub expectations: Vec<Shown>,
    /// Asserts that did not hold.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub asserts: Vec<FailedAssert>,
    /// How many asserts were looked at.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub asserts_made: Option<u64>,
    /// What else there is to say.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub notes: Vec<String>,
    /// Why it is not what was reviewed, if the reviewed program is known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cause: Option<Cause>,
    /// The first test of all whose run parts in the same statement, if that is another one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cause_as_of: Option<String>,
    /// What went wrong, in words.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<String>,
    /// Where in the PLC's sources.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub place: Option<SourcePlace>,
    /// The step or cycle.
    pub step_ns: u64,
    /// How long it took, where it was measured by itself; no part of reports that are equal for equal runs.
    #[serde(skip)]
    pub wall_time: Option<Duration>,
    #[serde(skip)]
    pub shown: Picture,
}

impl Outcome {
    /// Its name among those of all suites.
    pub fn full_name(&self) -> String {
        format!("{}/{}", self.suite, self.name).trim_end_matches('/').to_owned()
    }
}

/// What only the page shows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Picture {
    /// The trajectory, as SVG.
    pub svg: Option<String>,
    /// The same as data for a chart.
    pub chart: Option<String>,
    /// The trajectory over the reviewed one where the two differ, as SVG.
    pub against: Option<String>,
    pub snapshot: Option<Snapshot>,
    /// What happened from outside.
    pub events: Vec<Event>,
}

/// What came of all tests.
#[derive(Clone, Debug)]
pub struct Report {
    pub outcomes: Vec<Outcome>,
    /// Snapshots that belong to no case.
    pub orphans: Vec<PathBuf>,
    /// Lines and outcomes of decisions of the PLCs' code with how many were executed, if that was asked for.
    pub coverage: Option<[(usize, usize); 2]>,
    /// How long it all took.
    pub wall_time: Duration,
}

impl Report {
    /// How many ended so.
    pub fn count(&self, status: Status) -> usize {
        self.outcomes.iter().filter(|outcome| outcome.status == status).count()
    }

    /// The exit code: the gravest of all.
    pub fn exit_code(&self) -> ExitCode {
        let codes = self.outcomes.iter().map(|outcome| outcome.status.exit_code());
        codes.max_by_key(|code| *code as u8).unwrap_or(ExitCode::Ok)
    }

    /// The names of suites, in the order of their tests.
    pub fn suites(&self) -> Vec<&str> {
        let mut suites: Vec<&str> = self.outcomes.iter().map(|outcome| outcome.suite.as_str()).collect();
        suites.dedup();
        suites
    }
}

/// What came of the tests of a unit; snapshots are kept as `config` wants it.
///
/// # Errors
/// A snapshot cannot be written.
pub fn judge(config: &TestConfig, unit: &Unit, worked: &Worked) -> Result<Vec<Outcome>, TestError> {
    if let Some((error, code)) = &worked.error {
        return Ok(vec![broken(unit, error, *code)]);
    }
    let suite = unit.suite();
    match unit {
        Unit::Case(unit) => worked.tests.iter().map(|ran| case(config, unit, &suite, ran)).collect(),
        Unit::Sources(_) | Unit::Unreadable { .. } => {
            let chosen = worked.tests.iter().filter(|ran| config.selection.has_name(&suite, &ran.name));
            Ok(chosen.map(|ran| test_program(&suite, ran)).collect())
        }
    }
}

/// The test of a process that gave nothing.
fn broken(unit: &Unit, error: &str, code: i32) -> Outcome {
    let wrong = code == ExitCode::WrongInput as i32;
    let (name, tags) = match unit {
        Unit::Case(unit) => (unit.place.case.clone(), unit.tags.clone()),
        _ => Default::default(),
    };
    let ran = Ran { error: Some(error.to_owned()), ..Ran::new(name, RunStatus::Failed) };
    let status = if wrong { Status::Wrong } else { Status::Fault };
    Outcome { tags, ..outcome(&unit.suite(), &ran, "", status) }
}

fn outcome(suite: &str, ran: &Ran, folder: &str, status: Status) -> Outcome {
    let found = |place: &SourcePlace| SourcePlace { file: within(folder, &place.file), ..place.clone() };
    Outcome {
        suite: suite.to_owned(),
        name: ran.name.clone(),
        tags: Vec::new(),
        class: ran.class.clone(),
        status,
        digest: ran.digest.clone(),
        steps: ran.steps,
        virtual_time_ns: ran.virtual_time_ns,
        differences: Vec::new(),
        expectations: ran.expectations.clone(),
        asserts: ran.asserts.clone(),
        asserts_made: None,
        notes: ran.notes.clone(),
        cause: None,
        cause_as_of: None,
        error: ran.error.clone(),
        place: ran.place.as_ref().map(found),
        step_ns: ran.step_ns,
        wall_time: ran.wall_ns.map(Duration::from_nanos),
        shown: Picture {
            svg: ran.picture.clone(),
            chart: ran.chart.clone(),
            events: ran.events.clone(),
            ..Picture::default()
        },
    }
}

fn test_program(suite: &str, ran: &Ran) -> Outcome {
    let failed = ran.error.is_some() || !ran.asserts.is_empty();
    let status = match (failed, ran.skipped) {
        (true, _) => Status::Failed,
        (false, true) => Status::Skipped,
        (false, false) => Status::Passed,
    };
    Outcome { asserts_made: Some(ran.asserts_made), tags: ran.tags.clone(), ..outcome(suite, ran, "", status) }
}

fn case(config: &TestConfig, unit: &CaseUnit, suite: &str, ran: &Ran) -> Result<Outcome, TestError> {
    let folder = shown(unit.place.folder());
    let with = |status| Outcome { tags: unit.tags.clone(), ..outcome(suite, ran, &folder, status) };
    if ran.status != RunStatus::Completed {
        return Ok(with(Status::Fault));
    }
    let taken = ran.snapshot.as_deref().map(Snapshot::parse).and_then(Result::ok);
    let Some(taken) = taken else {
        let error = Some("its process gave no trajectory".to_owned());
        return Ok(Outcome { error, ..with(Status::Fault) });
    };
    let violated = ran.expectations.iter().any(Shown::is_violated);
    let mut judged = match unit.place.read_merged() {
        Ok(Reviewed::Nothing) => held_against(config, unit, None, &taken, with)?,
        Ok(Reviewed::One(reviewed)) => held_against(config, unit, Some(&reviewed), &taken, with)?,
        Ok(Reviewed::Undecided(merge)) => merged(config, unit, &merge, &taken, with)?,
        Err(error) => Outcome { error: Some(error.to_string()), ..with(Status::Wrong) },
    };
    if violated && judged.status != Status::Wrong {
        judged.status = Status::Failed;
    }
    judged.shown.snapshot = Some(taken);
    Ok(judged)
}

/// A snapshot with both sides of a merge: the run waits for a review, whichever side it is equal to.
fn merged(
    config: &TestConfig,
    unit: &CaseUnit,
    merge: &Merge,
    taken: &Snapshot,
    with: impl Fn(Status) -> Outcome,
) -> Result<Outcome, TestError> {
    let status = match config.policy {
        Policy::Bless => {
            unit.place.accept(taken)?;
            Status::Blessed
        }
        Policy::Pending => {
            unit.place.keep(taken)?;
            Status::Changed
        }
        Policy::Check => Status::Changed,
    };
    let mut outcome = with(status);
    let tolerances = &unit.choice.tolerances;
    outcome.notes.push(merge.note(taken, tolerances));
    if let Some(side) = merge.nearest(taken, tolerances) {
        outcome.differences = compare(side, taken, tolerances);
    }
    Ok(outcome)
}

/// Compares with the reviewed snapshot, and keeps what is not equal to it.
fn held_against(
    config: &TestConfig,
    unit: &CaseUnit,
    reviewed: Option<&Snapshot>,
    taken: &Snapshot,
    with: impl Fn(Status) -> Outcome,
) -> Result<Outcome, TestError> {
    let differences = reviewed.map(|reviewed| compare(reviewed, taken, &unit.choice.tolerances));
    let is_equal = differences.as_ref().is_some_and(Vec::is_empty);
    let place = &unit.place;
    if is_equal {
        if config.policy != Policy::Check {
            place.reject()?;
        }
        return Ok(with(Status::Passed));
    }
    let status = match (config.policy, reviewed) {
        (Policy::Bless, _) => {
            place.accept(taken)?;
            Status::Blessed
        }
        (Policy::Pending, reviewed) => {
            place.keep(taken)?;
            if reviewed.is_some() { Status::Changed } else { Status::New }
        }
        (Policy::Check, Some(_)) => Status::Changed,
        (Policy::Check, None) => Status::Missing,
    };
    let mut outcome = with(status);
    if let (Some(reviewed), Some(differences)) = (reviewed, differences) {
        // Only a page has use for it.
        let drawn = outcome.shown.svg.is_some();
        outcome.shown.against = drawn.then(|| overlay(&outcome.name, Some(reviewed), taken, &differences).to_svg());
        outcome.differences = differences;
    }
    Ok(outcome)
}
