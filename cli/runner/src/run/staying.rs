//! The page of a run that is over: it stays for those who look back, and let other sessions go on from there.

use onescan_base::notice::NOTICE;

use super::config::RunConfig;
use crate::interrupt::{self, Interrupt};
use crate::web::{Page, Stay};

/// A page that is to stay.
pub(super) struct Staying {
    page: Page,
    stay: Stay,
}

impl Staying {
    /// The page of a run that has come to its end, if it is to stay; one that was asked to stop does not.
    pub(super) fn of(page: Option<Page>, config: &RunConfig, interrupt: &Interrupt) -> Option<Self> {
        let stay = config.doors.stay.filter(|_| !interrupt.is_raised())?;
        Some(Self { page: page?, stay })
    }

    /// Waits for whoever looks at it. The run has ended by itself, so its own exit code counts, not the signal.
    pub(super) fn last(self, interrupt: &Interrupt) {
        let until = match self.stay {
            Stay::UntilInterrupted => "Ctrl-C, or `Close` on the page, ends it",
            Stay::ForViewers => "it ends with its last viewer",
        };
        tracing::info!(target: NOTICE, "the run is over; its page stays at {}: {until}", self.page.url());
        self.page.await_departure(self.stay, || interrupt.is_raised());
        if interrupt.is_raised() {
            interrupt::set_answered();
        }
    }
}
