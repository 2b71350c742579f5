//! What becomes of expectations while a session runs.
//!
//! Whoever judges the run on the session's thread leaves a copy of itself here when somebody wants one. What it says is worked
//! out on the page's thread.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use onescan_scenario::expect::{Judge, Outcome, TraceEnd, Verdict};
use onescan_server::time::VirtualTime;
use schemars::JsonSchema;
use serde::Serialize;

/// What has become of one expectation so far.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub(super) struct Standing {
    pub(super) name: String,
    verdict: &'static str,
    /// By how much it is met, negative if it is not; nothing where that is not known, or without end.
    robustness: Option<f64>,
    /// When it was violated; else when it was looked at.
    t_ns: u64,
}

#[derive(Debug, Default)]
struct Latest {
    /// A judge that nobody has asked yet.
    judge: Option<(VirtualTime, Judge, TraceEnd)>,
    /// When one was asked for.
    asked: Option<Instant>,
    standings: Vec<Standing>,
}

/// How often the session's thread copies its judge, however many look.
const EACH: Duration = Duration::from_millis(500);

/// Where judges are left; clones share it.
#[derive(Clone, Debug, Default)]
pub(crate) struct VerdictBoard {
    wanted: Arc<AtomicBool>,
    latest: Arc<Mutex<Latest>>,
}

impl VerdictBoard {
    /// A thread that panicked under the lock has left whole values.
    fn lock(&self) -> MutexGuard<'_, Latest> {
        self.latest.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// True if somebody wants a judge; one that was asked for is asked for once.
    pub(crate) fn is_wanted(&self) -> bool {
        self.wanted.load(Ordering::Acquire) && self.wanted.swap(false, Ordering::AcqRel)
    }

    /// Leaves a judge of the run up to `t_v`.
    pub(crate) fn leave(&self, t_v: VirtualTime, judge: Judge, end: TraceEnd) {
        self.lock().judge = Some((t_v, judge, end));
    }

    /// What the judge says that was left last, by the names of its expectations. Asks for another one, if it is time.
    pub(super) fn standings(&self, names: &[String]) -> Vec<Standing> {
        let mut latest = self.lock();
        if latest.asked.is_none_or(|asked| asked.elapsed() >= EACH) {
            latest.asked = Some(Instant::now());
            self.wanted.store(true, Ordering::Release);
        }
        if let Some((t_v, judge, end)) = latest.judge.take() {
            let judged = judge.finish(end);
            latest.standings = names.iter().zip(judged).map(|(name, outcome)| standing(name, &outcome, t_v)).collect();
        }
        latest.standings.clone()
    }
}

fn standing(name: &str, outcome: &Outcome, now: VirtualTime) -> Standing {
    let (verdict, at) = match &outcome.verdict {
        Verdict::Met => ("pass", now),
        Verdict::Open => ("open", now),
        Verdict::Violated { at, .. } => ("fail", *at),
    };
    // a margin of -0, which negation gives, reads as if something were missing
    let margin = outcome.margin.greatest + 0.0;
    let is_known = margin.is_finite() && margin == outcome.margin.least;
    Standing { name: name.to_owned(), verdict, robustness: is_known.then_some(margin), t_ns: at.as_nanos() }
}

/// What has been reported to one viewer.
#[derive(Debug, Default)]
pub(super) struct Reported(Vec<(String, &'static str, Option<u64>)>);

impl Reported {
    /// What is new to the viewer: another verdict, or another robustness.
    pub(super) fn news(&mut self, standings: Vec<Standing>) -> Vec<Standing> {
        let key = |one: &Standing| (one.name.clone(), one.verdict, one.robustness.map(f64::to_bits));
        let now: Vec<_> = standings.iter().map(key).collect();
        let before = std::mem::replace(&mut self.0, now);
        standings.into_iter().filter(|one| !before.contains(&key(one))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_viewer_hears_what_is_new() {
        let standing = |verdict, t_ns| Standing { name: "level".to_owned(), verdict, robustness: Some(0.5), t_ns };
        let mut reported = Reported::default();
        assert_eq!(reported.news(vec![standing("open", 1)]).len(), 1);
        assert_eq!(reported.news(vec![standing("open", 2)]), []);
        assert_eq!(reported.news(vec![standing("fail", 2)]), [standing("fail", 2)]);
    }

    #[test]
    fn a_judge_is_asked_for_once() {
        let verdict_board = VerdictBoard::default();
        assert!(!verdict_board.is_wanted());
        assert_eq!(verdict_board.standings(&[]), []);
        assert!(verdict_board.is_wanted() && !verdict_board.is_wanted());
        assert_eq!(verdict_board.standings(&[]), []);
        assert!(!verdict_board.is_wanted(), "another viewer has just asked");
    }
}
