//! Ctrl-C, and other polite requests to end: the run stops at the next step boundary, with recordings and reports whole.
//! Another one after a while ends the process at once; so does the first, as long as there is no session that could stop:
//! while files are read, checked and compiled. Whatever came of it, the exit code says that a signal ended it.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicI32, Ordering};
use std::time::{Duration, Instant};

use onescan_server::mailbox::Mailbox;
use onescan_server::operation::Control;

/// A second signal before this is an echo of the first: some programs signal a process and its group.
const IMPATIENCE: Duration = Duration::from_secs(1);

/// The number of the signal for a terminal that is gone.
const HANG_UP: i32 = 1;
/// The number of Ctrl-C's signal.
const INTERRUPT: i32 = 2;
/// The number of the polite request to end.
const TERMINATE: i32 = 15;

/// The first signal that has asked this process to end; 0 while none has.
static SIGNAL: AtomicI32 = AtomicI32::new(0);

/// The exit code of a process that a signal has asked to end, as shells have it: 130 after Ctrl-C, 143 after SIGTERM, 129
/// after SIGHUP.
#[must_use]
pub fn exit_code() -> Option<u8> {
    let signal = SIGNAL.load(Ordering::SeqCst);
    u8::try_from(128 + signal).ok().filter(|_| signal != 0)
}

/// A signal ended no work: what there was to do was done before it came.
pub(super) fn set_answered() {
    SIGNAL.store(0, Ordering::SeqCst);
}

/// A wish to stop, seen by all runs of a process.
#[derive(Clone, Debug, Default)]
pub struct Interrupt {
    raised: Arc<AtomicBool>,
    /// Set when there is a session that answers it.
    is_watched: Arc<AtomicBool>,
    mailbox: Mailbox,
}

impl Interrupt {
    /// Nobody has asked to stop.
    pub fn new() -> Self {
        Self::default()
    }

    /// Raises it on Ctrl-C and on a polite request to end.
    pub fn on_signals(&self) {
        let interrupt = self.clone();
        let mut first: Option<Instant> = None;
        let handler = move |signal: i32| {
            // One that comes later does not say why it ends.
            let _ = SIGNAL.compare_exchange(0, signal, Ordering::SeqCst, Ordering::SeqCst);
            let end = || std::process::exit(128 + SIGNAL.load(Ordering::SeqCst));
            match first {
                None => {
                    first = Some(Instant::now());
                    interrupt.raised.store(true, Ordering::SeqCst);
                    if !interrupt.is_watched.load(Ordering::SeqCst) {
                        end();
                    }
                    interrupt.mailbox.control(Control::Stop);
                }
                Some(first) if first.elapsed() > IMPATIENCE => end(),
                Some(_) => {}
            }
        };
        if let Err(error) = on_each(&[HANG_UP, INTERRUPT, TERMINATE], handler) {
            tracing::warn!(%error, "Ctrl-C will end the program without a report");
        }
    }

    /// True once somebody asked to stop.
    pub fn is_raised(&self) -> bool {
        self.raised.load(Ordering::SeqCst)
    }

    /// From now on somebody looks whether a stop was asked for, and brings things to an end.
    pub(super) fn watch(&self) {
        self.is_watched.store(true, Ordering::SeqCst);
    }

    /// The flag itself, for those who spin on it.
    pub(super) fn flag(&self) -> &AtomicBool {
        &self.raised
    }

    /// Where the wish goes, and those of operators.
    pub(super) fn mailbox(&self) -> Mailbox {
        self.mailbox.clone()
    }
}

/// From now on the first signal that asks to end does so at once, after `last_word`. A process that ignores the end of its
/// terminal, as with `nohup`, goes on doing so.
pub(super) fn end_on_signals(last_word: impl Fn() + Send + 'static) {
    let handler = move |signal: i32| {
        last_word();
        std::process::exit(128 + signal);
    };
    if let Err(error) = on_each(&[INTERRUPT, TERMINATE], handler) {
        tracing::debug!(%error, "a signal ends the program without a word");
    }
}

/// Calls `handler` with the number of each of these signals, in a thread of its own.
#[cfg(unix)]
fn on_each(signals: &[i32], mut handler: impl FnMut(i32) + Send + 'static) -> std::io::Result<()> {
    use onescan_base::threads;
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};

    debug_assert_eq!([SIGHUP, SIGINT, SIGTERM], [HANG_UP, INTERRUPT, TERMINATE], "as POSIX has it");
    let mut signals = signal_hook::iterator::Signals::new(signals)?;
    let watch = move || signals.forever().for_each(&mut handler);
    threads::start("signals", watch).map(drop)
}

/// There all are as Ctrl-C.
#[cfg(windows)]
fn on_each(_signals: &[i32], mut handler: impl FnMut(i32) + Send + 'static) -> std::io::Result<()> {
    ctrlc::set_handler(move || handler(INTERRUPT)).map_err(std::io::Error::other)
}
