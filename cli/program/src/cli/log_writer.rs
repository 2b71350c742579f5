//! Where lines of the log go: a thread writes them, and a line that it cannot write for a while is not waited for any more.
//!
//! Standard error may be a pipe that nobody reads. What strangers do is logged by the threads that serve them, which must not
//! stand still for ever because of that. As long as somebody reads, every line is written before its thread goes on, so that
//! the log and what the program prints are in order.

use std::io::{self, Write};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use onescan_base::threads;

/// How long a thread waits for its line to be written. After that, lines are left out until the pipe is read again.
const PATIENCE: Duration = Duration::from_secs(5);

/// The log; clones write to the same one.
#[derive(Clone)]
pub(super) struct LogWriter(Arc<Shared>);

struct Shared {
    patience: Duration,
    state: Mutex<State>,
    given: Condvar,
    written: Condvar,
}

#[derive(Default)]
struct State {
    /// The line that is being written.
    line: Option<Vec<u8>>,
    lines_given: u64,
    lines_written: u64,
    is_stuck: bool,
    /// Lines that were left out.
    lost: u64,
}

impl LogWriter {
    /// Writes to `out`.
    ///
    /// # Errors
    /// The system has no thread to give.
    pub(super) fn to(out: impl Write + Send + 'static) -> io::Result<Self> {
        Self::patient(out, PATIENCE)
    }

    fn patient(mut out: impl Write + Send + 'static, patience: Duration) -> io::Result<Self> {
        let (state, given, written) = (Mutex::default(), Condvar::new(), Condvar::new());
        let shared = Arc::new(Shared { patience, state, given, written });
        let writing = Arc::clone(&shared);
        threads::start("log", move || writing.write_each(&mut out))?;
        Ok(Self(shared))
    }
}

impl Write for LogWriter {
    fn write(&mut self, line: &[u8]) -> io::Result<usize> {
        self.0.give(line);
        Ok(line.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Shared {
    /// A thread that panicked here left whole values.
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits while `is_awaited`, but no longer than its patience; after that the log is stuck.
    fn wait<'s>(&self, state: MutexGuard<'s, State>, is_awaited: impl Fn(&State) -> bool) -> MutexGuard<'s, State> {
        let waits = |state: &mut State| is_awaited(state) && !state.is_stuck;
        let waited = self.written.wait_timeout_while(state, self.patience, waits);
        let (mut state, timeout) = waited.unwrap_or_else(PoisonError::into_inner);
        state.is_stuck |= timeout.timed_out();
        state
    }

    fn give(&self, line: &[u8]) {
        let mut state = self.wait(self.lock(), |state| state.line.is_some());
        if state.is_stuck {
            state.lost += 1;
            return;
        }
        state.line = Some(line.to_owned());
        state.lines_given += 1;
        let own = state.lines_given;
        self.given.notify_one();
        drop(self.wait(state, |state| state.lines_written < own));
    }

    /// The line that is to be written; it stands in the state until it has been.
    fn next_line(&self) -> Vec<u8> {
        let mut state = self.lock();
        loop {
            if let Some(line) = &state.line {
                return line.clone();
            }
            state = self.given.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
    }

    fn write_each(&self, out: &mut impl Write) {
        loop {
            let line = self.next_line();
            // Nobody is left to report to if it cannot be written.
            let _ = out.write_all(&line).and_then(|()| out.flush());
            let mut state = self.lock();
            (state.line, state.is_stuck) = (None, false);
            state.lines_written += 1;
            let lost = std::mem::take(&mut state.lost);
            self.written.notify_all();
            drop(state);
            if lost > 0 {
                // Nor if this cannot.
                let _ = writeln!(out, " WARN {lost} lines of this log are missing: nobody read it");
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::{Receiver, Sender, channel};

    use super::*;

    /// A pipe that takes as many lines as are asked for.
    struct Pipe {
        room: Receiver<()>,
        taken: Sender<String>,
    }

    impl Write for Pipe {
        fn write(&mut self, line: &[u8]) -> io::Result<usize> {
            self.room.recv().map_err(io::Error::other)?;
            self.taken.send(String::from_utf8_lossy(line).into_owned()).map_err(io::Error::other)?;
            Ok(line.len())
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn a_log_that_nobody_reads_holds_nobody() {
        let ((room, wanted), (taken, lines)) = (channel(), channel());
        let mut log = LogWriter::patient(Pipe { room: wanted, taken }, Duration::from_millis(20)).unwrap();
        room.send(()).unwrap();
        log.write_all(b"first\n").unwrap();
        assert_eq!(lines.recv().unwrap(), "first\n");
        // Nobody makes room any more.
        for line in 0..10_000 {
            // As the log does: a line is one write.
            log.write_all(format!("line {line}\n").as_bytes()).unwrap();
        }
        for _ in 0..20 {
            room.send(()).unwrap();
        }
        assert_eq!(lines.recv().unwrap(), "line 0\n", "it waits in the pipe");
        let mut note = lines.recv().unwrap();
        while !note.contains('\n') {
            note += &lines.recv().unwrap();
        }
        assert!(note.contains("9999 lines of this log are missing"), "{note}");
    }
}
