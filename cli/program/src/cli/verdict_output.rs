//! Standard output of a command whose exit code is a verdict: a reader that leaves early, as `head` does, does not change the
//! verdict, and the command goes on until it has it.

use std::io::{self, ErrorKind, StdoutLock, Write};

/// Standard output, as long as somebody reads it.
pub(super) struct VerdictOutput {
    out: StdoutLock<'static>,
    /// The reader has left: nothing more is written.
    is_closed: bool,
}

impl VerdictOutput {
    /// Standard output, for as long as the command lasts.
    pub(super) fn lock() -> Self {
        Self { out: io::stdout().lock(), is_closed: false }
    }

    /// What came of writing; a closed pipe is not an error here.
    fn noted(&mut self, done: io::Result<()>) -> io::Result<()> {
        match done {
            Err(error) if error.kind() == ErrorKind::BrokenPipe => {
                self.is_closed = true;
                Ok(())
            }
            done => done,
        }
    }
}

impl Write for VerdictOutput {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if !self.is_closed {
            let done = self.out.write_all(bytes);
            self.noted(done)?;
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        if self.is_closed {
            return Ok(());
        }
        let done = self.out.flush();
        self.noted(done)
    }
}
