//! What is said while tests run, on standard error: what is written to standard output depends on the tests alone.

use std::io::Write as _;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::time::{Duration, Instant};

use onescan_base::threads;

use super::config::Progress;
use super::outcome::Report;
use super::plan::Unit;
use super::summary::slowest;

/// CI servers end jobs that say nothing for minutes, and people wonder sooner.
const SILENCE_MAX: Duration = Duration::from_secs(10);

/// Where tests report that they have ended; nowhere if nobody reads it.
pub(super) struct Live(Option<Sender<String>>);

impl Live {
    /// A unit has ended.
    pub(super) fn ended(&self, unit: &Unit) {
        if let Some(sender) = &self.0 {
            let name = match unit {
                Unit::Case(case) => format!("{}/{}", unit.suite(), case.place.case),
                Unit::Sources(_) | Unit::Unreadable { .. } => unit.suite(),
            };
            // The thread that writes lives as long as this.
            drop(sender.send(name));
        }
    }
}

/// Does `work` over `count` units, and says meanwhile what `progress` asks for.
pub(super) fn during<T>(progress: Progress, count: usize, work: impl FnOnce(&Live) -> T) -> T {
    if !matches!(progress, Progress::Lines | Progress::Sparse) {
        return work(&Live(None));
    }
    let each = progress == Progress::Lines;
    std::thread::scope(|scope| {
        let (sender, receiver) = channel();
        let live = match threads::start_in(scope, "lines", move || write(&receiver, count, each)) {
            Ok(_) => Live(Some(sender)),
            Err(error) => {
                say(&format!("no line per test: {error}"));
                Live(None)
            }
        };
        work(&live)
    })
}

/// A line for each name that comes in, or only where nothing has been said for long.
fn write(receiver: &Receiver<String>, count: usize, each: bool) {
    let started = Instant::now();
    let (mut done, mut last_said) = (0, started);
    loop {
        let patience = SILENCE_MAX.saturating_sub(last_said.elapsed());
        let said = match receiver.recv_timeout(patience) {
            Ok(name) => {
                done += 1;
                if !each && last_said.elapsed() < SILENCE_MAX {
                    continue;
                }
                name
            }
            Err(RecvTimeoutError::Timeout) => "...".to_owned(),
            Err(RecvTimeoutError::Disconnected) => return,
        };
        last_said = Instant::now();
        let seconds = started.elapsed().as_secs_f64();
        say(&format!("{done:>4} / {count}  {seconds:>6.1} s  {said}"));
    }
}

/// How long it took, where time is shown.
pub(super) fn end(progress: Progress, report: &Report) {
    if matches!(progress, Progress::Bar | Progress::Lines) {
        for line in slowest(report) {
            say(&line);
        }
    }
}

fn say(line: &str) {
    // Where standard error takes nothing, there is nowhere to say so.
    drop(writeln!(std::io::stderr(), "{line}"));
}
