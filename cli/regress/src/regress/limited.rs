//! A process that may take so long and no longer, and that ends when this one does.

use std::io::{self, Read};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::{Duration, Instant};

use onescan_base::threads;
use onescan_runner::error::ThreadError;

/// How long to wait before checking again whether a process that has closed its output has ended; it usually has at once.
const LOOK: Duration = Duration::from_millis(1);
/// How long to wait for what a process had said that was ended; its pipes close with it.
const REST: Duration = Duration::from_secs(1);

/// What a process may do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// How long it may take.
    pub time: Duration,
    /// How many bytes it may write to its standard output, and to its standard error; what is more is not read, and a
    /// process that goes on writing fails. Nothing for as many as there are.
    pub output_max: Option<u64>,
}

impl Limits {
    /// A limit of time alone.
    pub fn of_time(time: Duration) -> Self {
        Self { time, output_max: None }
    }
}

/// What a process said, and how it ended.
#[derive(Debug)]
pub struct Said {
    /// Nothing if it was not done in time and was ended.
    pub status: Option<ExitStatus>,
    pub stdout: Vec<u8>,
    pub stderr: Vec<u8>,
}

/// A process whose output is taken.
pub(super) struct Limited {
    child: Child,
    out: Receiver<Vec<u8>>,
    err: Receiver<Vec<u8>>,
    time: Duration,
}

impl Limited {
    /// Starts it. Its input stays open for as long as this process lives, so that it can notice its end.
    pub(super) fn start(command: &mut Command, Limits { time, output_max }: Limits) -> io::Result<Self> {
        let mut child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn()?;
        let taken = (taken(child.stdout.take(), output_max), taken(child.stderr.take(), output_max));
        match taken {
            (Ok(out), Ok(err)) => Ok(Self { child, out, err, time }),
            (Err(error), _) | (_, Err(error)) => {
                child.kill()?;
                child.wait()?;
                Err(error)
            }
        }
    }

    /// What it said and how it ended. One that is not done in time is ended.
    pub(super) fn output(mut self) -> io::Result<Said> {
        let (limit, started) = (self.time, Instant::now());
        // It is done when it has said all on its standard output. Its processes may hold the other one open.
        let stdout = match self.out.recv_timeout(limit) {
            Ok(stdout) => stdout,
            Err(RecvTimeoutError::Timeout) => {
                self.end()?;
                // What it left behind may hold its output open: then nothing of it is known.
                let stdout = self.out.recv_timeout(REST).unwrap_or_default();
                let stderr = self.err.recv_timeout(REST).unwrap_or_default();
                return Ok(Said { status: None, stdout, stderr });
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
                return Ok(Said { status: None, stdout, stderr });
            }
            std::thread::sleep(LOOK);
        }
        Ok(Said { status: Some(self.child.wait()?), stdout, stderr })
    }

    fn end(&mut self) -> io::Result<()> {
        self.child.kill()?;
        self.child.wait().map(drop)
    }
}

/// All that comes, up to so many bytes, when it has come.
fn taken(pipe: Option<impl Read + Send + 'static>, bytes_max: Option<u64>) -> io::Result<Receiver<Vec<u8>>> {
    let (done, all) = channel();
    if let Some(mut pipe) = pipe {
        threads::start("output", move || {
            let mut bytes = Vec::new();
            // What came before a pipe broke is what there is; that there is not all of it, the report shows, which is JSON.
            let _ = match bytes_max {
                Some(bytes_max) => pipe.take(bytes_max).read_to_end(&mut bytes),
                None => pipe.read_to_end(&mut bytes),
            };
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

    fn shell(script: &str, time: Duration, output_max: Option<u64>) -> Said {
        let started = Limited::start(Command::new("sh").args(["-c", script]), Limits { time, output_max });
        started.expect("a shell").output().expect("it can be waited for")
    }

    #[test]
    fn what_is_done_in_time_is_heard() {
        let said = shell("echo a; echo b >&2; exit 3", Duration::from_mins(1), None);
        assert_eq!((said.stdout, said.stderr), (b"a\n".to_vec(), b"b\n".to_vec()));
        assert_eq!(said.status.and_then(|status| status.code()), Some(3));
    }

    #[test]
    fn what_is_not_is_ended_and_what_it_had_said_is_heard() {
        assert!(shell("exec sleep 300", Duration::from_millis(1), None).status.is_none());
        let said = shell("echo a; exec sleep 300", Duration::from_millis(500), None);
        assert_eq!((said.status, said.stdout), (None, b"a\n".to_vec()));
    }

    #[test]
    fn what_closes_its_output_and_goes_on_is_ended() {
        let said = shell("exec >&- 2>&-; exec sleep 300", Duration::from_millis(200), None);
        assert!(said.status.is_none());
    }

    #[test]
    fn what_writes_without_end_is_not_read_to_it() {
        let said = shell("exec yes", Duration::from_mins(1), Some(1000));
        assert_eq!(said.stdout.len(), 1000);
        assert!(said.status.is_some_and(|status| !status.success()));
    }
}
