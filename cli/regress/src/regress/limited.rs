//! A process that may take so long and no longer, and that ends when this one does.

use std::io::{self, Read};
use std::process::{Child, Command, Output, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::{Duration, Instant};

use onescan_base::threads;
use onescan_runner::error::ThreadError;

/// How long to wait before checking again whether a process that has closed its output has ended; it usually has at once.
const LOOK: Duration = Duration::from_millis(1);

/// A process whose output is taken.
pub(super) struct Limited {
    child: Child,
    out: Receiver<Vec<u8>>,
    err: Receiver<Vec<u8>>,
}

impl Limited {
    /// Starts it. Its input stays open for as long as this process lives, so that it can notice its end.
    pub(super) fn start(command: &mut Command) -> io::Result<Self> {
        let mut child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn()?;
        let taken = (taken(child.stdout.take()), taken(child.stderr.take()));
        match taken {
            (Ok(out), Ok(err)) => Ok(Self { child, out, err }),
            (Err(error), _) | (_, Err(error)) => {
                child.kill()?;
                child.wait()?;
                Err(error)
            }
        }
    }

    /// What it said and how it ended; nothing if it was not done within `limit` and was ended.
    pub(super) fn output(mut self, limit: Duration) -> io::Result<Option<Output>> {
        let started = Instant::now();
        // It is done when it has said all on its standard output. Its processes may hold the other one open.
        let stdout = match self.out.recv_timeout(limit) {
            Ok(stdout) => stdout,
            Err(RecvTimeoutError::Timeout) => {
                self.end()?;
                return Ok(None);
            }
            // The thread that reads ends with a result, unless the system could not start one more: then the status says
            // how it went.
            Err(RecvTimeoutError::Disconnected) => Vec::new(),
        };
        let left = || limit.saturating_sub(started.elapsed());
        // A process that it left behind may hold its standard error open beyond the limit. It is not waited for: what was
        // written there is then missing from the report, which still has the status and the output.
        let stderr = self.err.recv_timeout(left()).unwrap_or_default();
        // It may have closed its output and go on.
        while self.child.try_wait()?.is_none() {
            if left().is_zero() {
                self.end()?;
                return Ok(None);
            }
            std::thread::sleep(LOOK);
        }
        Ok(Some(Output { status: self.child.wait()?, stdout, stderr }))
    }

    fn end(&mut self) -> io::Result<()> {
        self.child.kill()?;
        self.child.wait().map(drop)
    }
}

/// All that comes, when it has come.
fn taken(pipe: Option<impl Read + Send + 'static>) -> io::Result<Receiver<Vec<u8>>> {
    let (done, all) = channel();
    if let Some(mut pipe) = pipe {
        threads::start("output", move || {
            let mut bytes = Vec::new();
            // What came before a pipe broke is what there is; that there is not all of it, the report shows, which is JSON.
            let _ = pipe.read_to_end(&mut bytes);
            // Nobody waits for it any more if the time was over.
            let _ = done.send(bytes);
        })?;
    }
    Ok(all)
}

/// Ends this process when the one that started it has ended, whose pipe is the standard input.
///
/// # Errors
/// The system has no thread to give.
pub fn end_with_parent() -> Result<(), ThreadError> {
    let watch = || {
        let mut rest = Vec::new();
        // Nothing is ever written to it. That it ends, or breaks, says that the other process has.
        let _ = io::stdin().lock().read_to_end(&mut rest);
        std::process::exit(1);
    };
    threads::start("parent", watch).map(drop).map_err(ThreadError)
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    fn shell(script: &str) -> Limited {
        Limited::start(Command::new("sh").args(["-c", script])).expect("a shell")
    }

    #[test]
    fn what_is_done_in_time_is_heard() {
        let output = shell("echo a; echo b >&2; exit 3").output(Duration::from_mins(1)).unwrap().unwrap();
        assert_eq!((output.stdout, output.stderr), (b"a\n".to_vec(), b"b\n".to_vec()));
        assert_eq!(output.status.code(), Some(3));
    }

    #[test]
    fn what_is_not_is_ended() {
        assert!(shell("exec sleep 300").output(Duration::from_millis(1)).unwrap().is_none());
    }

    #[test]
    fn what_closes_its_output_and_goes_on_is_ended() {
        let closed = shell("exec >&- 2>&-; exec sleep 300");
        assert!(closed.output(Duration::from_millis(200)).unwrap().is_none());
    }
}
