//! Who sits where: any number of viewers, one at each panel.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Mutex, MutexGuard, PoisonError};

use schemars::JsonSchema;
use serde::Serialize;

use super::error::Refused;

/// A viewer, in the order of coming.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Viewer(u64);

/// A seat as one viewer sees it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
#[schemars(rename = "SeatState")]
pub(super) enum Seat {
    Free,
    Mine,
    Taken,
}

/// All seats as one viewer sees them, by panel.
pub(super) type SeatView = BTreeMap<String, Seat>;

#[derive(Debug, Default)]
struct Inner {
    last: u64,
    panels: BTreeMap<String, Option<Viewer>>,
}

/// The signals that each panel writes.
type Written = BTreeMap<String, BTreeSet<String>>;

/// The seats of a session.
#[derive(Debug)]
pub(super) struct Seats {
    written: Written,
    inner: Mutex<Inner>,
}

impl Seats {
    /// One at each panel, all free.
    pub(super) fn at(written: Written) -> Self {
        let panels = written.keys().map(|panel| (panel.clone(), None)).collect();
        Self { written, inner: Mutex::new(Inner { last: 0, panels }) }
    }

    /// A thread that panicked under the lock has left whole values.
    fn lock(&self) -> MutexGuard<'_, Inner> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Somebody comes.
    pub(super) fn enter(&self) -> Viewer {
        let mut inner = self.lock();
        inner.last += 1;
        Viewer(inner.last)
    }

    /// Somebody goes, and leaves all seats.
    pub(super) fn leave(&self, viewer: Viewer) {
        for seat in self.lock().panels.values_mut().filter(|seat| **seat == Some(viewer)) {
            *seat = None;
        }
    }

    /// Takes or leaves the seat of a panel.
    pub(super) fn claim(&self, panel: &str, viewer: Viewer, take: bool) -> Result<(), Refused> {
        let mut inner = self.lock();
        let seat = inner.panels.get_mut(panel).ok_or_else(|| Refused::NoPanel(panel.to_owned()))?;
        match (*seat, take) {
            (Some(other), _) if other != viewer => return Err(Refused::Taken(panel.to_owned())),
            (_, true) => *seat = Some(viewer),
            (_, false) => *seat = None,
        }
        Ok(())
    }

    /// Whoever writes a signal sits at a panel that has it.
    pub(super) fn may_write(&self, viewer: Viewer, signal: &str) -> Result<(), Refused> {
        let inner = self.lock();
        let mut sits_at = inner.panels.iter().filter(|(_, seat)| **seat == Some(viewer)).map(|(panel, _)| panel);
        let may = sits_at.any(|panel| self.written.get(panel).is_some_and(|written| written.contains(signal)));
        may.then_some(()).ok_or_else(|| Refused::NoSeat(signal.to_owned()))
    }

    /// Whether a viewer has the seat of one of these panels.
    pub(super) fn sits_at_one_of(&self, panels: &BTreeSet<String>, viewer: Viewer) -> bool {
        self.lock().panels.iter().any(|(panel, seat)| *seat == Some(viewer) && panels.contains(panel))
    }

    /// The seats as a viewer sees them.
    pub(super) fn seen_by(&self, viewer: Viewer) -> SeatView {
        let seen = |seat: &Option<Viewer>| match seat {
            None => Seat::Free,
            Some(holder) if *holder == viewer => Seat::Mine,
            Some(_) => Seat::Taken,
        };
        self.lock().panels.iter().map(|(panel, seat)| (panel.clone(), seen(seat))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_seat_a_panel_and_whoever_goes_leaves_it() {
        let written = BTreeMap::from([("desk".to_owned(), BTreeSet::from(["Start".to_owned()]))]);
        let seats = Seats::at(written);
        let (one, other) = (seats.enter(), seats.enter());
        assert_eq!(seats.may_write(one, "Start"), Err(Refused::NoSeat("Start".to_owned())));
        assert_eq!(seats.claim("desk", one, true), Ok(()));
        assert_eq!(seats.claim("desk", other, true), Err(Refused::Taken("desk".to_owned())));
        assert_eq!((seats.seen_by(one)["desk"], seats.seen_by(other)["desk"]), (Seat::Mine, Seat::Taken));
        assert_eq!(seats.may_write(one, "Start"), Ok(()));
        assert_eq!(seats.may_write(one, "Stop"), Err(Refused::NoSeat("Stop".to_owned())));
        seats.leave(one);
        assert_eq!(seats.seen_by(other)["desk"], Seat::Free);
        assert_eq!(seats.claim("chair", other, true), Err(Refused::NoPanel("chair".to_owned())));
    }
}
