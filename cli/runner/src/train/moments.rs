//! Moments of an attempt to which a trainer may go back, kept at distances that grow with their age.

use onescan_server::checkpoint::Checkpoint;
use onescan_server::time::{StepCount, VirtualTime};

use super::examination::Examination;
use crate::web::AtWork;

/// The least distance between two moments, ns of virtual time.
const LEAST_NS: u64 = 1_000_000_000;
/// Of two neighbours one goes when what is left is no further apart than this part of its age.
const SHARE: u64 = 8;

/// A boundary to which the session can go back.
#[derive(Clone)]
pub(super) struct Moment {
    pub(super) checkpoint: Checkpoint,
    pub(super) examination: Examination,
    /// What did not work as it should.
    pub(super) at_work: AtWork,
}

impl Moment {
    pub(super) fn t_v(&self) -> VirtualTime {
        self.checkpoint.t_v()
    }

    pub(super) fn steps(&self) -> StepCount {
        self.checkpoint.steps()
    }
}

/// The moments of what has happened since the start.
#[derive(Clone)]
pub(super) struct Moments {
    /// The start itself, which always stays.
    start: Moment,
    kept: Vec<Moment>,
}

impl Moments {
    /// Nothing has happened yet.
    pub(super) fn since(start: Moment) -> Self {
        Self { start, kept: Vec::new() }
    }

    fn last(&self) -> &Moment {
        self.kept.last().unwrap_or(&self.start)
    }

    /// Whether one is due at `t_v`.
    pub(super) fn is_due(&self, t_v: VirtualTime) -> bool {
        t_v - self.last().t_v() >= LEAST_NS
    }

    /// Keeps one, and lets go those that have become too many.
    pub(super) fn keep(&mut self, moment: Moment) {
        let now = moment.t_v();
        self.kept.push(moment);
        let all = std::iter::once(&self.start).chain(&self.kept);
        let times: Vec<u64> = all.map(|moment| moment.t_v().as_nanos()).collect();
        let mut stays = thinned(&times, now.as_nanos()).into_iter().skip(1);
        self.kept.retain(|_| stays.next().unwrap_or(true));
    }

    /// The last moment at or before `t_v`, or the start; those after it have not happened any more.
    pub(super) fn back_to(&mut self, t_v: VirtualTime) -> Moment {
        self.kept.truncate(self.kept.partition_point(|moment| moment.t_v() <= t_v));
        self.last().clone()
    }
}

/// Which of these times stay, seen from `now_ns`.
fn thinned(times: &[u64], now_ns: u64) -> Vec<bool> {
    let mut stays = vec![true; times.len()];
    let mut before = times.first().copied().unwrap_or_default();
    for index in 1..times.len().saturating_sub(1) {
        let age_ns = now_ns.saturating_sub(times[index]);
        if times[index + 1] - before <= LEAST_NS.max(age_ns / SHARE) {
            stays[index] = false;
        } else {
            before = times[index];
        }
    }
    stays
}

#[cfg(test)]
mod tests {
    use super::*;

    /// After a shift there are few moments, near ones close to each other, and no gap is larger than a part of its age.
    #[test]
    fn distances_grow_with_age() {
        let mut kept: Vec<u64> = Vec::new();
        for second in 0..8 * 3600 {
            kept.push(second * LEAST_NS);
            let stays = thinned(&kept, second * LEAST_NS);
            kept = kept.into_iter().zip(stays).filter_map(|(time, stays)| stays.then_some(time)).collect();
        }
        let now = (8 * 3600 - 1) * LEAST_NS;
        assert!(kept.len() < 120, "{}", kept.len());
        assert_eq!((kept.first(), kept.last()), (Some(&0), Some(&now)));
        for pair in kept.windows(2) {
            let age = now - pair[0];
            assert!(pair[1] - pair[0] <= LEAST_NS.max(age / SHARE), "{pair:?}");
        }
    }
}
