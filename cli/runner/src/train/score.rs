//! What is measured of somebody who takes a lesson, all of it on virtual time.

use onescan_report::Verdict;
use serde::{Deserialize, Serialize};

/// What came of one attempt. Its JSON form is a contract: fields are added, never changed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Score {
    /// The image with which it began.
    pub begin_ns: u64,
    pub end_ns: u64,
    /// Whether the lesson's `done` held at its end; nothing if it has none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub done: Option<bool>,
    /// What went wrong, in the order of the lesson.
    pub malfunctions: Vec<Handled>,
    pub expectations: Vec<Expected>,
    /// What the trainee must not do.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub mistakes: Vec<Made>,
    pub costs: Vec<Spent>,
}

/// A malfunction, and what the trainee made of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Handled {
    pub name: String,
    /// The first image that had it; nothing if it did not come.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub begun_ns: Option<u64>,
    /// When it was identified; nothing if the lesson does not ask.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub identified: Option<Response>,
    /// When the right thing was done; nothing if the lesson does not ask.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub acted: Option<Response>,
}

/// Something that is to be done in a time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Response {
    /// The first image that showed it; nothing if none did.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub at_ns: Option<u64>,
    /// How long from the beginning of the malfunction it took.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub after_ns: Option<u64>,
    /// How long it may take.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub within_ns: Option<u64>,
}

/// What came of an expectation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Expected {
    pub name: String,
    /// Whether it was met.
    pub verdict: Verdict,
    /// When it was first violated.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub at_ns: Option<u64>,
    /// Its robustness: by how much it was met, negative if it was not; absent where it is infinite.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub margin: Option<f64>,
    /// What that is measured in.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unit: Option<String>,
}

/// A mistake, and how often it was made.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Made {
    pub name: String,
    pub count: u32,
    /// How many are forgiven.
    pub at_most: u32,
    /// When it was made first.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub first_ns: Option<u64>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Spent {
    pub name: String,
    /// In `unit`.
    pub value: f64,
    /// What it is measured in.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unit: Option<String>,
}

impl Response {
    /// Whether it was done, and in time.
    pub fn is_timely(&self) -> bool {
        self.after_ns.is_some_and(|after_ns| self.within_ns.is_none_or(|within_ns| after_ns <= within_ns))
    }
}

impl Handled {
    /// Whether all that it asks for was done in time; what did not come asks for nothing.
    pub fn is_mastered(&self) -> bool {
        self.begun_ns.is_none() || [self.identified, self.acted].iter().flatten().all(Response::is_timely)
    }
}

impl Made {
    /// Whether it was made no more often than is forgiven.
    pub fn is_forgiven(&self) -> bool {
        self.count <= self.at_most
    }
}

impl Score {
    /// Whether the lesson is passed: every malfunction mastered, nothing expected violated, all mistakes forgiven, and done if
    /// it can be.
    pub fn is_passed(&self) -> bool {
        self.done != Some(false)
            && self.malfunctions.iter().all(Handled::is_mastered)
            && self.mistakes.iter().all(Made::is_forgiven)
            && self.expectations.iter().all(|expected| expected.verdict != Verdict::Violated)
    }

    /// How long it took.
    pub fn lasted_ns(&self) -> u64 {
        self.end_ns.saturating_sub(self.begin_ns)
    }
}
