//! How a lesson goes: when its time is up, and what came of it.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use schemars::JsonSchema;
use serde::Serialize;

/// How the attempt at a lesson goes that is under way.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
#[schemars(rename = "Attempt")]
pub(crate) struct Attempt {
    /// Its number, from 1.
    pub(crate) number: u32,
    /// When its time is up.
    pub(crate) ends_ns: u64,
    /// What came of it; nothing while it goes on.
    pub(crate) result: Option<LessonResult>,
}

/// What came of an attempt.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub(crate) struct LessonResult {
    pub(crate) passed: bool,
    /// Whether it was brought to its end, if it has one.
    pub(crate) done: Option<bool>,
    pub(crate) lasted_ns: u64,
    pub(crate) malfunctions: Vec<Met>,
    pub(crate) expectations: Vec<Kept>,
    pub(crate) mistakes: Vec<Slip>,
    pub(crate) costs: Vec<Cost>,
}

/// A malfunction, and what the trainee made of it.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub(crate) struct Met {
    pub(crate) name: String,
    /// Whether it had begun before the attempt was over.
    pub(crate) came: bool,
    pub(crate) identified: Option<Timing>,
    pub(crate) acted: Option<Timing>,
}

/// How long something took.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub(crate) struct Timing {
    /// Nothing if it was not done.
    pub(crate) after_ns: Option<u64>,
    pub(crate) within_ns: Option<u64>,
    pub(crate) timely: bool,
}

/// What must hold, and whether it did.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub(crate) struct Kept {
    pub(crate) name: String,
    pub(crate) met: bool,
    /// When it was first violated.
    pub(crate) at_ns: Option<u64>,
}

/// A mistake, and how often it was made.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub(crate) struct Slip {
    pub(crate) name: String,
    pub(crate) count: u32,
    /// How many are forgiven.
    pub(crate) at_most: u32,
}

/// A cost of the lesson, in its unit.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[schemars(rename = "LessonCost")]
pub(crate) struct Cost {
    pub(crate) name: String,
    pub(crate) value: f64,
    pub(crate) unit: Option<String>,
}

/// Where it is noted how a lesson goes; clones share it.
#[derive(Clone, Debug, Default)]
pub(crate) struct LessonBoard(Arc<Mutex<Option<Attempt>>>);

impl LessonBoard {
    /// A thread that panicked under the lock has left a whole value.
    fn lock(&self) -> MutexGuard<'_, Option<Attempt>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Notes that the attempt of this number begins, whose time is up at `ends_ns`.
    pub(crate) fn begin(&self, number: u32, ends_ns: u64) {
        *self.lock() = Some(Attempt { number, ends_ns, result: None });
    }

    /// Notes what came of the attempt that was begun last.
    pub(crate) fn end(&self, result: LessonResult) {
        if let Some(attempt) = &mut *self.lock() {
            attempt.result = Some(result);
        }
    }

    /// How it goes, if that is new to a viewer.
    pub(super) fn news(&self, reported: &mut Option<Attempt>) -> Option<Attempt> {
        let now = self.lock().clone();
        if now == *reported {
            return None;
        }
        reported.clone_from(&now);
        now
    }
}
