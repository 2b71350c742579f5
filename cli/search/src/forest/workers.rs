//! Several trials at a time. What comes of them does not depend on how many there are.

use std::num::NonZeroUsize;
use std::sync::{Mutex, PoisonError};

use onescan_base::threads;
use onescan_regress::regress::pool::{bar, spread};

/// So many runs in a process at most, so that little is lost if it is killed.
const BATCH_MAX: usize = 32;
/// At least so many batches per worker, where there are enough runs, so that no worker waits long for the last one.
const BATCHES_PER_JOB: usize = 4;

/// Does `tasks` independently of each other, `jobs` at a time, with a bar that calls them `noun` if it is shown. The
/// results are in the order of the tasks.
///
/// # Errors
/// The first of `one`, in the order of tasks.
pub(crate) fn each<T: Sync, O: Send, E: Send>(
    jobs: NonZeroUsize,
    tasks: &[T],
    (is_shown, noun): (bool, &str),
    one: impl Fn(&T) -> Result<O, E> + Sync,
) -> Result<Vec<O>, E> {
    let bar = bar(is_shown, tasks.len(), noun);
    spread(jobs, tasks.len(), &bar, |index| one(&tasks[index])).into_iter().collect()
}

/// Runs in batches, one per process: more than one run, because each process has to read and compile the scenario first,
/// but so few that all workers have something to do to the end.
pub(crate) fn batches<T>(jobs: NonZeroUsize, runs: &[T]) -> Vec<&[T]> {
    let size = (runs.len() / (jobs.get() * BATCHES_PER_JOB)).clamp(1, BATCH_MAX);
    runs.chunks(size).collect()
}

/// Workers with a state of their own, one per thread.
pub(crate) struct Workers<W> {
    workers: Vec<W>,
}

impl<W: Send> Workers<W> {
    pub(crate) fn new(jobs: NonZeroUsize, worker: impl Fn() -> W) -> Self {
        Self { workers: (0..jobs.get()).map(|_| worker()).collect() }
    }

    /// Does tasks in their order, up to the first whose outcome `is_last`.
    ///
    /// # Errors
    /// The first of `work`.
    pub(crate) fn run<T: Sync, O: Send, E: Send>(
        &mut self,
        tasks: &[T],
        work: impl Fn(&mut W, &T) -> Result<O, E> + Sync,
        is_last: impl Fn(&O) -> bool,
    ) -> Result<Vec<O>, E> {
        let mut outcomes = Vec::new();
        for some in tasks.chunks(self.workers.len()) {
            for outcome in self.at_once(some, &work) {
                let outcome = outcome?;
                let ends = is_last(&outcome);
                outcomes.push(outcome);
                // What was done beyond it counts for nothing: one worker would not have done it.
                if ends {
                    return Ok(outcomes);
                }
            }
        }
        Ok(outcomes)
    }

    fn at_once<T: Sync, O: Send, E: Send>(
        &mut self,
        tasks: &[T],
        work: &(impl Fn(&mut W, &T) -> Result<O, E> + Sync),
    ) -> Vec<Result<O, E>> {
        if let ([task], [worker, ..]) = (tasks, &mut self.workers[..]) {
            return vec![work(worker, task)];
        }
        let waiting = Mutex::new(self.workers.iter_mut().zip(tasks).enumerate());
        let worker = || {
            let next = || waiting.lock().unwrap_or_else(PoisonError::into_inner).next();
            std::iter::from_fn(next).map(|(at, (worker, task))| (at, work(worker, task))).collect::<Vec<_>>()
        };
        let mut done: Vec<(usize, Result<O, E>)> = std::thread::scope(|scope| {
            // This thread works, too: where the system has no more, it does all that there is.
            let others: Vec<_> =
                (1..tasks.len()).map_while(|_| threads::start_in(scope, "worker", worker).ok()).collect();
            let own = worker();
            let joined = others.into_iter().map(std::thread::ScopedJoinHandle::join);
            let theirs = joined.flat_map(|done| done.unwrap_or_else(|panic| std::panic::resume_unwind(panic)));
            own.into_iter().chain(theirs).collect()
        });
        done.sort_by_key(|(at, _)| *at);
        done.into_iter().map(|(_, outcome)| outcome).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outcomes_do_not_depend_on_the_number_of_workers() {
        let tasks: Vec<u32> = (0..10).collect();
        for jobs in (1..=4).map(|jobs| NonZeroUsize::new(jobs).unwrap()) {
            let mut workers = Workers::new(jobs, || ());
            let work = |wrong: u32| move |task: &u32| if *task == wrong { Err(*task) } else { Ok(2 * task) };
            let mut run =
                |wrong: u32| workers.run(&tasks, |(): &mut (), task| work(wrong)(task), |outcome| *outcome == 8);
            assert_eq!((run(7), run(3)), (Ok(vec![0, 2, 4, 6, 8]), Err(3)), "{jobs} jobs");
            let all = |wrong: u32| each(jobs, &tasks, (false, "tasks"), work(wrong));
            assert_eq!((all(10), all(3)), (Ok((0..10).map(|task| 2 * task).collect()), Err(3)), "{jobs} jobs");
        }
    }

    #[test]
    fn batches_are_small_enough_for_all_workers() {
        let sizes = |jobs: usize, runs: usize| {
            let runs: Vec<usize> = (0..runs).collect();
            batches(NonZeroUsize::new(jobs).unwrap(), &runs).into_iter().map(<[usize]>::len).collect::<Vec<_>>()
        };
        assert_eq!(sizes(2, 3), [1, 1, 1]);
        assert_eq!(sizes(1, 9), [2, 2, 2, 2, 1]);
        assert_eq!(sizes(1, 200), [32, 32, 32, 32, 32, 32, 8]);
        assert!(sizes(2, 0).is_empty());
    }
}
