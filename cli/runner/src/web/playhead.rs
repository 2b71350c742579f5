//! Where a viewer looks: at the live edge, or at a moment of the past.

use std::sync::Arc;

use onescan_server::published::SessionView;
use onescan_server::time::VirtualTime;

use super::Session;
use super::error::Refused;
use crate::past::{Moment, PastReader};

/// Where one viewer looks.
pub(super) struct Playhead {
    past_reader: Option<PastReader>,
    /// Whether it is shown the past, or is about to be.
    is_past: bool,
    seen: Option<Arc<SessionView>>,
}

impl Playhead {
    /// At the live edge; a recording has none, and is looked at from its beginning.
    pub(super) fn new(session: &Session) -> Self {
        let past_reader = session.past.as_ref().ok().map(crate::past::Rewinder::enter);
        let is_past = session.recorded_to.is_some();
        if let Some(past_reader) = past_reader.as_ref().filter(|_| is_past) {
            past_reader.show(VirtualTime::ZERO);
        }
        Self { past_reader, is_past, seen: None }
    }

    /// Asks for a moment of the past.
    pub(super) fn show(&mut self, t_ns: f64, session: &Session) -> Result<(), Refused> {
        let t_v = moment(t_ns, session)?;
        self.past_reader(session)?.show(t_v);
        self.is_past = true;
        Ok(())
    }

    /// Looks at the live edge again, where there is one. True if it did not before.
    pub(super) fn live(&mut self, session: &Session) -> bool {
        if session.recorded_to.is_some() || !self.is_past {
            return false;
        }
        if let Some(past_reader) = &mut self.past_reader {
            past_reader.leave();
        }
        (self.is_past, self.seen) = (false, None);
        true
    }

    /// Who shows the past.
    pub(super) fn past_reader(&self, session: &Session) -> Result<&PastReader, Refused> {
        match (&self.past_reader, &session.past) {
            (Some(past_reader), _) => Ok(past_reader),
            (None, Err(why)) => Err(Refused::Past(why.clone())),
            (None, Ok(_)) => Err(Refused::Past("nobody shows it".to_owned())),
        }
    }

    /// The next moment that was asked for.
    pub(super) async fn next(&mut self) -> Moment {
        match &mut self.past_reader {
            Some(past_reader) => past_reader.next().await,
            None => std::future::pending().await,
        }
    }

    /// Takes a moment; gives what is to be shown now. One that comes after it was looked away is left out.
    pub(super) fn see(&mut self, moment: Moment) -> Result<Option<Arc<SessionView>>, Refused> {
        match moment {
            Moment::Seen(view) if self.is_past => {
                self.seen = Some(Arc::clone(&view));
                Ok(Some(view))
            }
            Moment::Lost(why) if self.is_past => Err(Refused::Past(why)),
            Moment::None | Moment::Seen(_) | Moment::Lost(_) => Ok(None),
        }
    }

    /// The moment that is shown once more, with everything in it.
    pub(super) fn seen(&self) -> Option<Arc<SessionView>> {
        self.seen.clone()
    }

    pub(super) fn is_past(&self) -> bool {
        self.is_past
    }

    /// The moment that is shown, ns; nothing at the live edge.
    pub(super) fn shown_ns(&self) -> Option<u64> {
        self.is_past.then(|| self.seen.as_ref().map_or(0, |view| view.t_v.as_nanos()))
    }
}

/// A moment of the past: the last step at or before `t_ns`.
pub(super) fn moment(t_ns: f64, session: &Session) -> Result<VirtualTime, Refused> {
    let end = session.edge();
    let step = session.plan.step().as_nanos();
    let asked = t_ns as u64;
    // Put this way, NaN is refused, too.
    if !(t_ns >= 0.0 && asked <= end.as_nanos()) {
        return Err(Refused::NoMoment { t_ns: t_ns.to_string(), end });
    }
    Ok(VirtualTime::from_nanos(asked - asked % step))
}

/// When a session is to end that goes on from `t_v`.
pub(super) fn end(until_ns: f64, t_v: VirtualTime) -> Result<VirtualTime, Refused> {
    let until = VirtualTime::from_nanos(until_ns as u64);
    // Put this way, NaN is refused, too.
    if until_ns >= 0.0 && until > t_v { Ok(until) } else { Err(Refused::NoEnd { until_ns: until_ns.to_string(), t_v }) }
}

/// The past that can be shown, ns; nothing if there is none.
pub(super) fn past_ns(session: &Session) -> Option<[u64; 2]> {
    let first = session.past.as_ref().ok()?.first()?;
    Some([first.as_nanos(), session.edge().as_nanos().max(first.as_nanos())])
}
