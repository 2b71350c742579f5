//! How a lesson goes: when its time is up, and what came of it.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use onescan_server::time::VirtualTime;
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

/// Real PLCs on their way to where an attempt begins.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub(crate) struct Drive {
    /// Names of the clients that they stand in for, at least one.
    pub(crate) plcs: Vec<String>,
    /// The prepared state from which the attempt begins.
    pub(crate) start: String,
    /// How far they are, in virtual time from their cold start.
    pub(crate) at_ns: u64,
    /// Where the attempt begins.
    pub(crate) to_ns: u64,
}

#[derive(Debug, Default)]
struct Noted {
    attempt: Option<Attempt>,
    drive: Option<Drive>,
}

/// Where it is noted how a lesson goes; clones share it.
#[derive(Clone, Debug, Default)]
pub(crate) struct LessonBoard(Arc<Mutex<Noted>>);

impl LessonBoard {
    /// A thread that panicked under the lock has left a whole value.
    fn lock(&self) -> MutexGuard<'_, Noted> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Notes that the attempt of this number begins, whose time is up at `ends_ns`.
    pub(crate) fn begin(&self, number: u32, ends_ns: u64) {
        self.lock().attempt = Some(Attempt { number, ends_ns, result: None });
    }

    /// Notes what came of the attempt that was begun last.
    pub(crate) fn end(&self, result: LessonResult) {
        if let Some(attempt) = &mut self.lock().attempt {
            attempt.result = Some(result);
        }
    }

    /// Notes that real PLCs set out to where an attempt begins, until what it gives is dropped.
    pub(crate) fn drive(&self, plcs: Vec<String>, start: &str, to: VirtualTime) -> Driving {
        self.lock().drive = Some(Drive { plcs, start: start.to_owned(), at_ns: 0, to_ns: to.as_nanos() });
        Driving(self.clone())
    }

    /// Whether real PLCs are on their way, so that nobody operates anything.
    pub(super) fn is_driving(&self) -> bool {
        self.lock().drive.is_some()
    }

    /// How the attempt goes, if that is new to a viewer.
    pub(super) fn news(&self, reported: &mut Option<Attempt>) -> Option<Attempt> {
        let noted = self.lock();
        if noted.attempt == *reported {
            return None;
        }
        reported.clone_from(&noted.attempt);
        noted.attempt.clone()
    }

    /// Brings what a viewer knows of real PLCs on their way up to date; true if that was new.
    pub(super) fn drive_news(&self, reported: &mut Option<Drive>) -> bool {
        let noted = self.lock();
        let is_new = noted.drive != *reported;
        reported.clone_from(&noted.drive);
        is_new
    }
}

/// Real PLCs are on their way for as long as this is kept.
#[derive(Debug)]
pub(crate) struct Driving(LessonBoard);

impl Driving {
    /// They have come as far as this.
    pub(crate) fn reach(&self, t_v: VirtualTime) {
        if let Some(drive) = &mut self.0.lock().drive {
            drive.at_ns = t_v.as_nanos();
        }
    }
}

impl Drop for Driving {
    fn drop(&mut self) {
        self.0.lock().drive = None;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_viewer_hears_how_far_a_plc_is() {
        let (board, mut reported) = (LessonBoard::default(), None);
        assert_eq!((board.drive_news(&mut reported), board.is_driving()), (false, false));
        let driving = board.drive(vec!["plc".to_owned()], "melting", VirtualTime::from_nanos(9));
        let far = |at_ns| Drive { plcs: vec!["plc".to_owned()], start: "melting".to_owned(), at_ns, to_ns: 9 };
        assert_eq!((board.drive_news(&mut reported), board.is_driving()), (true, true));
        assert_eq!((board.drive_news(&mut reported), &reported), (false, &Some(far(0))));
        driving.reach(VirtualTime::from_nanos(4));
        assert_eq!((board.drive_news(&mut reported), &reported), (true, &Some(far(4))));
        drop(driving);
        assert_eq!((board.drive_news(&mut reported), board.is_driving()), (true, false));
        assert_eq!(reported, None);
    }
}
