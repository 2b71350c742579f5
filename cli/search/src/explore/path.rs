//! One way in which the session may go, from its start or forked from another.

use std::collections::VecDeque;
use std::rc::Rc;

use onescan_scenario::Scenario;
use onescan_scenario::expect::TraceEnd;
use onescan_scenario::timing::TimingTolerance;
use onescan_server::checkpoint::StateHash;
use onescan_server::digest::Digest;
use onescan_server::time::{TimeSpan, VirtualTime};

use super::deviation::{Deviation, What};
use super::known::{Key, Known, Mark, Past, looks};
use super::place::{self, Watched};
use crate::forest::{SearchKind, form, run_until, start};
use onescan_runner::run::expectation::ExpectationReport;
use onescan_runner::run::judged::{Judged, Moment};
use onescan_runner::run::{RunError, SearchError};

/// Something that may happen later, and the boundary before the step in which it happens.
#[derive(Clone)]
pub(super) struct Fork {
    /// Number of what allows it.
    pub(super) tolerance: usize,
    pub(super) what: What,
    /// When it happens.
    pub(super) edge: VirtualTime,
    /// Nothing for what happens in the set-up.
    moment: Option<Rc<Moment>>,
}

/// What came of a way.
pub(super) struct Path {
    pub(super) digest: Option<Digest>,
    /// Expectations that did not hold.
    pub(super) violated: Vec<ExpectationReport>,
    /// How a client failed, if one did.
    pub(super) failure: Option<String>,
    /// What may happen later in it, in the order of time, if that was asked for.
    pub(super) forks: Vec<Fork>,
    /// Where it ended because its state was known, and how many schedules follow.
    pub(super) joined: Option<u64>,
    /// Where others may join it.
    pub(super) marks: Vec<Mark>,
}

/// What all ways of an exploration have in common.
pub(super) struct SearchContext<'a> {
    pub(super) scenario: &'a Scenario,
    pub(super) until: VirtualTime,
    pub(super) tolerances: &'a [TimingTolerance],
    /// How long expectations remember; nothing if all of a run may matter.
    memory: Option<TimeSpan>,
    /// Whether expectations remember anything.
    forgets: bool,
}

/// What is asked of a way.
#[derive(Clone, Copy)]
pub(super) struct Wanted<'k> {
    /// Whether it is to say what may happen later.
    pub(super) forks: bool,
    /// Exactly so many deviations come after its own, and what is known; nothing if it is to be gone to its end.
    pub(super) known: Option<(u32, &'k Known)>,
}

impl<'a> SearchContext<'a> {
    pub(super) fn new(scenario: &'a Scenario, until: VirtualTime, tolerances: &'a [TimingTolerance]) -> Self {
        let step = scenario.plan().step();
        let named = &scenario.expectations().named;
        let memories: Option<Vec<u64>> =
            named.iter().map(|(_, expectation)| expectation.memory_ns(step.as_nanos())).collect();
        let longest_ns = memories.map(|all| all.into_iter().max().unwrap_or(0));
        let memory = longest_ns.and_then(TimeSpan::from_nanos);
        Self { scenario, until, tolerances, memory, forgets: longest_ns == Some(0) }
    }

    /// Goes the way with these deviations, from the fork of the last of them if it has one.
    ///
    /// # Errors
    /// The session cannot be formed, saved or taken up.
    pub(super) fn go(
        &self,
        from: Option<&Fork>,
        deviations: &[Deviation],
        wanted: Wanted<'_>,
    ) -> Result<Path, SearchError> {
        let deviating = deviations.iter().flat_map(Deviation::operations);
        let mut judged = form(SearchKind::Explore, self.scenario, self.until, deviating)?;
        let moment = from.and_then(|fork| fork.moment.as_deref());
        start::<SearchError>(&mut judged, moment)?;
        let mut watched = Watched::new(self.tolerances);
        watched.begin(judged.session());
        let mut forks = if wanted.forks && moment.is_none() { self.at_start() } else { Vec::new() };
        let mut joining = Joining::new(self, deviations);
        // The boundary before the last step, because what that step brought is to be late.
        let mut before: Option<Rc<Moment>> = None;
        let joined = run_until(&mut judged, |judged| -> Result<Option<u64>, SearchError> {
            if let Some(moment) = before.take() {
                watched.look(judged.session());
                let t_v = judged.session().t_v();
                for (number, tolerance) in self.tolerances.iter().enumerate() {
                    let what = place::in_step(self.scenario, tolerance, &watched, (t_v, deviations));
                    let moment = Some(Rc::clone(&moment));
                    forks.extend(what.map(|what| Fork { tolerance: number, what, edge: t_v, moment }));
                }
            }
            if let Some((more, known)) = wanted.known
                && let Some(schedules) = joining.look(judged, more, known)?
            {
                return Ok(Some(schedules));
            }
            before = if wanted.forks { judged.moment()?.map(Rc::new) } else { None };
            Ok(None)
        })?;
        let marks = joining.marks;
        if joined.is_some() {
            return Ok(Path { digest: None, violated: Vec::new(), failure: None, forks, joined, marks });
        }
        let judgement = judged.finish(TraceEnd::Complete)?;
        let failure = judgement.failure.map(|failure| failure.to_string());
        Ok(Path { digest: judgement.digest, violated: judgement.violated, failure, forks, joined, marks })
    }

    fn at_start(&self) -> Vec<Fork> {
        let tolerances = self.tolerances.iter().enumerate();
        let fork = |(tolerance, what)| Fork { tolerance, what, edge: VirtualTime::ZERO, moment: None };
        tolerances.filter_map(|(number, tolerance)| Some((number, place::at_start(tolerance)?))).map(fork).collect()
    }
}

/// A way that looks whether its state is known.
struct Joining<'a> {
    context: &'a SearchContext<'a>,
    /// When its last deviation was over.
    over: VirtualTime,
    /// The way without deviations is that which most others join, so it is known at each boundary.
    always: bool,
    /// Boundaries, and the states there, for which others would have been alike long enough only later.
    waiting: VecDeque<(VirtualTime, StateHash)>,
    marks: Vec<Mark>,
}

impl<'a> Joining<'a> {
    fn new(context: &'a SearchContext<'a>, deviations: &[Deviation]) -> Self {
        let over = deviations.iter().map(|deviation| deviation.arrives).max().unwrap_or(VirtualTime::ZERO);
        Self { context, over, always: deviations.is_empty(), waiting: VecDeque::new(), marks: Vec::new() }
    }

    /// How many schedules follow from the boundary at which it is, if that is known.
    fn look(&mut self, judged: &mut Judged<'_>, more: u32, known: &Known) -> Result<Option<u64>, RunError> {
        let (t_v, step) = (judged.session().t_v(), judged.session().step());
        if t_v < self.over || t_v >= self.context.until {
            return Ok(None);
        }
        let steps = (t_v.as_nanos() - self.over.as_nanos()) / step.as_nanos();
        if (self.always || looks(steps))
            && let Some(state) = judged.state()?
        {
            let key = Key { at: t_v, state, past: Past::Seen(judged.seen()), more };
            if let Some(schedules) = self.is_known(key, t_v, known) {
                return Ok(Some(schedules));
            }
            if self.context.forgets || self.context.memory.is_some() {
                self.waiting.push_back((t_v, state));
            }
        }
        // The same for all that wait, and asked for only if one of them has waited long enough.
        let mut settled: Option<Vec<Option<bool>>> = None;
        while let Some((at, state)) = self.waiting.front().copied() {
            let alike_until = self.context.memory.map_or(at, |memory| at + memory);
            if alike_until > t_v {
                break;
            }
            self.waiting.pop_front();
            let settled = settled.get_or_insert_with(|| judged.settled());
            if settled.contains(&Some(false)) {
                break;
            }
            let key = Key { at, state, past: Past::Settled(settled.clone()), more };
            if let Some(schedules) = self.is_known(key, t_v, known) {
                return Ok(Some(schedules));
            }
        }
        Ok(None)
    }

    fn is_known(&mut self, key: Key, joined: VirtualTime, known: &Known) -> Option<u64> {
        let schedules = known.schedules(&key);
        if schedules.is_none() {
            self.marks.push(Mark { joined, key });
        }
        schedules
    }
}
