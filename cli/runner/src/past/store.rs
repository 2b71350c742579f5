//! What is kept of a session's past: checkpoints, and what operators did, within a budget of memory.
//!
//! When the budget is used up, the checkpoint goes whose place is missed the least: that which leaves the smallest gap
//! for its age. So distances grow with age, and to show a moment costs a re-run that is at most a fixed part of how long
//! ago it is. The first and the last stay; only if they and the inputs are too much, the past begins later.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use onescan_server::operation::{Author, Operation, OperatorInput};
use onescan_server::time::{StepCount, VirtualTime};

/// Checkpoints that are kept at most: each is looked at when one has to go.
const MARKS_MAX: usize = 4_096;

/// A checkpoint that is kept.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Mark {
    pub(crate) t_v: VirtualTime,
    pub(crate) steps: StepCount,
    /// The checkpoint as a file's bytes; nothing for the beginning of a session, which needs none.
    pub(crate) checkpoint: Option<Arc<[u8]>>,
}

impl Mark {
    /// The beginning of a session.
    pub(crate) fn beginning() -> Self {
        Self { t_v: VirtualTime::ZERO, steps: StepCount(0), checkpoint: None }
    }

    fn bytes(&self) -> usize {
        size_of::<Self>() + self.checkpoint.as_ref().map_or(0, |bytes| bytes.len())
    }
}

/// The past of one life of a session: from its beginning, or its last reset.
#[derive(Debug, Default)]
pub(crate) struct Store {
    budget_bytes: usize,
    /// Which life it is of: grows with every reset.
    life: u64,
    marks: Vec<Mark>,
    marks_bytes: usize,
    inputs: VecDeque<(OperatorInput, usize)>,
    inputs_bytes: usize,
}

/// A store that several threads share.
#[derive(Clone, Debug, Default)]
pub(crate) struct Kept(Arc<Mutex<Store>>);

/// From where a moment is shown.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Way {
    pub(crate) life: u64,
    pub(crate) from: Mark,
}

impl Kept {
    pub(crate) fn within(budget_bytes: usize) -> Self {
        Self(Arc::new(Mutex::new(Store { budget_bytes, ..Store::default() })))
    }

    /// A thread that panicked under the lock has left whole values.
    pub(crate) fn lock(&self) -> MutexGuard<'_, Store> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Store {
    /// A session begins again: nothing of what was is its past.
    pub(crate) fn begin(&mut self, life: u64) {
        *self = Self { budget_bytes: self.budget_bytes, life, ..Self::default() };
    }

    pub(crate) fn life(&self) -> u64 {
        self.life
    }

    /// Where the past begins; nothing if there is none.
    pub(crate) fn first(&self) -> Option<VirtualTime> {
        self.marks.first().map(|mark| mark.t_v)
    }

    /// Keeps a checkpoint of this life. One that comes late, or not after the last, is left out.
    pub(crate) fn keep(&mut self, life: u64, mark: Mark) {
        if life != self.life || self.marks.last().is_some_and(|last| last.steps >= mark.steps) {
            return;
        }
        self.marks_bytes += mark.bytes();
        self.marks.push(mark);
        self.fit();
    }

    /// Keeps what an operator did. What only holds time, or ends all, is not repeated.
    pub(crate) fn note(&mut self, input: &OperatorInput) {
        if input.author != Author::Operator || !input.operation.is_lasting() || input.operation == Operation::Stop {
            return;
        }
        let words = serde_json::to_vec(&input.operation).map_or(0, |text| text.len());
        let bytes = size_of::<(OperatorInput, usize)>() + words;
        // a re-run has not been reset
        self.inputs.push_back((OperatorInput { resets: 0, ..input.clone() }, bytes));
        self.inputs_bytes += bytes;
        self.fit();
    }

    /// The nearest checkpoint at or before `t_v`.
    pub(crate) fn way_to(&self, t_v: VirtualTime) -> Option<Way> {
        let behind = self.marks.partition_point(|mark| mark.t_v <= t_v);
        let from = self.marks.get(behind.checked_sub(1)?)?.clone();
        Some(Way { life: self.life, from })
    }

    /// What operators did at `steps` and later.
    pub(crate) fn inputs_from(&self, steps: StepCount) -> Vec<OperatorInput> {
        let first = self.inputs.partition_point(|(input, _)| input.step < steps);
        self.inputs.range(first..).map(|(input, _)| input.clone()).collect()
    }

    /// All that operators did since the session began; nothing where its beginning is not kept.
    pub(crate) fn inputs(&self) -> Option<Vec<OperatorInput>> {
        (self.first() == Some(VirtualTime::ZERO)).then(|| self.inputs_from(StepCount(0)))
    }

    fn bytes(&self) -> usize {
        self.marks_bytes + self.inputs_bytes
    }

    /// Gives away what does not fit.
    fn fit(&mut self) {
        while self.bytes() > self.budget_bytes || self.marks.len() > MARKS_MAX {
            let crowded = self.inputs_bytes > self.budget_bytes / 2;
            match self.least_missed() {
                Some(place) if !crowded => self.remove(place),
                _ if self.marks.len() > 1 => self.begin_later(),
                _ => return self.give_up(),
            }
        }
    }

    /// The place of the checkpoint that leaves the smallest gap for its age.
    fn least_missed(&self) -> Option<usize> {
        let last = self.marks.last()?.t_v.as_nanos();
        let gap_and_age = |place: usize| {
            let at = |place: usize| self.marks[place].t_v.as_nanos();
            (u128::from(at(place + 1) - at(place - 1)), u128::from(last - at(place)))
        };
        let inner = 1..self.marks.len().saturating_sub(1);
        inner.min_by(|a, b| {
            let ((gap_a, age_a), (gap_b, age_b)) = (gap_and_age(*a), gap_and_age(*b));
            (gap_a * age_b).cmp(&(gap_b * age_a))
        })
    }

    fn remove(&mut self, place: usize) {
        self.marks_bytes -= self.marks.remove(place).bytes();
    }

    /// Forgets what was before the second checkpoint.
    fn begin_later(&mut self) {
        self.remove(0);
        let first = self.marks.first().map_or(StepCount(0), |mark| mark.steps);
        while let Some((_, bytes)) = self.inputs.pop_front_if(|(input, _)| input.step < first) {
            self.inputs_bytes -= bytes;
        }
    }

    /// Not even one checkpoint fits: there is no past until one does.
    fn give_up(&mut self) {
        *self = Self { budget_bytes: self.budget_bytes, life: self.life, ..Self::default() };
    }
}

#[cfg(test)]
mod tests {
    use onescan_server::signal::SignalName;
    use proptest::prelude::*;

    use super::*;

    fn mark(step: u64, bytes: usize) -> Mark {
        let t_v = VirtualTime::from_nanos(step * 1_000_000);
        Mark { t_v, steps: StepCount(step), checkpoint: Some(vec![0; bytes].into()) }
    }

    fn input(step: u64, operation: Operation) -> OperatorInput {
        let t_v = VirtualTime::from_nanos(step * 1_000_000);
        OperatorInput { resets: 3, step: StepCount(step), t_v, author: Author::Operator, operation }
    }

    fn write() -> Operation {
        Operation::Write { signal: SignalName::new("Start").unwrap(), value: "TRUE".to_owned() }
    }

    fn steps(store: &Store) -> Vec<u64> {
        store.marks.iter().map(|mark| mark.steps.0).collect()
    }

    #[test]
    fn distances_grow_with_age() {
        let size = mark(0, 1_000).bytes();
        let mut store = Store { budget_bytes: 64 * size, ..Store::default() };
        for step in 0..20_000 {
            store.keep(0, mark(step, 1_000));
        }
        let kept = steps(&store);
        assert_eq!((kept.len(), kept[0], kept[63]), (64, 0, 19_999));
        for pair in kept.windows(2) {
            let age = 19_999 - pair[1];
            assert!(pair[1] - pair[0] <= 1 + age / 4, "{pair:?}");
        }
    }

    #[test]
    fn what_operators_did_is_repeated_from_the_checkpoint_on() {
        let mut store = Store { budget_bytes: 1 << 20, ..Store::default() };
        for step in [0, 10, 20] {
            store.keep(0, mark(step, 10));
        }
        for (step, operation) in
            [(9, write()), (10, write()), (12, Operation::Pause), (15, write()), (16, Operation::Stop)]
        {
            store.note(&input(step, operation));
        }
        store.note(&OperatorInput { author: Author::Timeline, ..input(17, write()) });
        let way = store.way_to(VirtualTime::from_nanos(19_999_999)).unwrap();
        assert_eq!(way.from.steps, StepCount(10));
        let again: Vec<_> = store.inputs_from(way.from.steps).iter().map(|one| (one.step.0, one.resets)).collect();
        assert_eq!(again, [(10, 0), (15, 0)]);
        // of another life
        store.keep(1, mark(30, 10));
        assert_eq!(steps(&store), [0, 10, 20]);
        assert_eq!(store.inputs().map(|inputs| inputs.len()), Some(3));
        store.begin(1);
        assert_eq!(store.inputs(), None, "it has no beginning yet");
        assert_eq!((store.first(), store.inputs_from(StepCount(0))), (None, Vec::new()));
    }

    #[test]
    fn inputs_alone_can_make_the_past_begin_later() {
        let mut store = Store { budget_bytes: 20_000, ..Store::default() };
        for step in 0..1_000 {
            if step % 10 == 0 {
                store.keep(0, mark(step, 10));
            }
            store.note(&input(step, write()));
        }
        let first = store.marks[0].steps;
        assert!(first > StepCount(0) && store.bytes() <= 20_000);
        assert!(store.inputs.iter().all(|(input, _)| input.step >= first));
        // and where nothing fits there is no past
        store.keep(0, mark(2_000, 30_000));
        assert_eq!(store.first(), None);
        store.keep(0, mark(2_001, 10));
        assert_eq!(steps(&store), [2_001]);
    }

    proptest! {
        #[test]
        fn the_budget_is_kept(
            budget_bytes in 0_usize..5_000,
            came in prop::collection::vec((1_u64..100, 0_usize..400, any::<bool>()), 0..200),
        ) {
            let mut store = Store { budget_bytes, ..Store::default() };
            let mut step = 0;
            for (later, bytes, is_input) in came {
                step += later;
                if is_input { store.note(&input(step, write())) } else { store.keep(0, mark(step, bytes)) }
                prop_assert!(store.bytes() <= budget_bytes);
                let all: usize = store.marks.iter().map(Mark::bytes).chain(store.inputs.iter().map(|(_, bytes)| *bytes)).sum();
                prop_assert_eq!(store.bytes(), all);
                prop_assert!(steps(&store).is_sorted());
            }
        }
    }
}
