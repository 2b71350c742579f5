//! Ctrl-C: the run stops at the next step boundary, with recordings and reports whole. Another one
//! after a while ends the process at once; so does the first, as long as there is no session that could stop: while
//! files are read, checked and compiled.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use onescan_server::mailbox::Mailbox;
use onescan_server::operation::Control;

/// A second signal before this is an echo of the first: some programs signal a process and its group.
const IMPATIENCE: Duration = Duration::from_secs(1);

/// The exit code of a program that was ended by Ctrl-C, as shells have it.
const INTERRUPTED: i32 = 130;

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
        let handler = move || match first {
            None => {
                first = Some(Instant::now());
                interrupt.raised.store(true, Ordering::SeqCst);
                if !interrupt.is_watched.load(Ordering::SeqCst) {
                    std::process::exit(INTERRUPTED);
                }
                interrupt.mailbox.control(Control::Stop);
            }
            Some(first) if first.elapsed() > IMPATIENCE => std::process::exit(INTERRUPTED),
            Some(_) => {}
        };
        if let Err(error) = ctrlc::set_handler(handler) {
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
