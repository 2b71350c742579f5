//! What a viewer asks for that others do beside the session: another session, a part of the past, a case.

use std::sync::Arc;

use onescan_server::signal::SignalId;
use tokio::sync::mpsc;

use super::super::error::Refused;
use super::super::playhead::{self, Playhead};
use super::super::response::Response;
use super::super::{CaseWanted, Session};
use crate::past::Span;

/// Parts of a trace, at most: a screen has about as many columns.
const PARTS_MAX: u32 = 2_000;
/// Steps that are run again for one, at most: others wait meanwhile.
const STEPS_MAX: u64 = 20_000;

/// Starts a session from a moment of the past, beside this one, and reports its address to the viewer.
pub(super) fn fork(
    (t_ns, until_ns): (f64, Option<f64>),
    session: &Session,
    playhead: &Playhead,
    outcomes: &mpsc::UnboundedSender<Response>,
) -> Result<(), Refused> {
    let t_v = playhead::moment(t_ns, session)?;
    let until = until_ns.map(|until_ns| playhead::end(until_ns, t_v)).transpose()?;
    let saved = playhead.past_reader(session)?.save(t_v);
    let (outcomes, launch) = (outcomes.clone(), Arc::clone(&session.launch));
    tokio::spawn(async move {
        let saved: Result<Vec<u8>, String> = saved.await.unwrap_or_else(|_| Err("the session is over".to_owned()));
        let forked = match saved {
            // it takes as long as the other session takes to begin
            Ok(bytes) => {
                tokio::task::spawn_blocking(move || launch(&bytes, until)).await.unwrap_or_else(|e| Err(e.to_string()))
            }
            Err(why) => Err(why),
        };
        let response = match forked {
            Ok(url) => Response::Forked { t_ns: t_v.as_nanos(), url },
            Err(why) => Response::Error { message: format!("no session goes on from {t_v}: {why}") },
        };
        // a viewer that has left hears nothing
        outcomes.send(response).ok();
    });
    Ok(())
}

/// Has a span of the past run again, and reports what signals did in it.
pub(super) fn trace(
    (signals, [from_ns, until_ns], parts): (Vec<SignalId>, [f64; 2], u32),
    session: &Session,
    playhead: &Playhead,
    outcomes: &mpsc::UnboundedSender<Response>,
) -> Result<(), Refused> {
    let past_reader = playhead.past_reader(session)?;
    let [from, until] = [playhead::moment(from_ns, session)?, playhead::moment(until_ns, session)?];
    let step = session.plan.step();
    let steps = until.as_nanos().saturating_sub(from.as_nanos()) / step.as_nanos();
    if parts == 0 || parts > PARTS_MAX || steps > STEPS_MAX || until < from {
        let asked = format!("{parts} of {steps}");
        return Err(Refused::NoTrace { asked, parts_max: PARTS_MAX, steps_max: STEPS_MAX });
    }
    let traced = past_reader.trace(Span { signals, from, until, step, parts });
    let outcomes = outcomes.clone();
    tokio::spawn(async move {
        let response = match traced.await {
            Ok(Ok(values)) => Response::Trace { from_ns: from.as_nanos(), until_ns: until.as_nanos(), values },
            Ok(Err(why)) => Response::Error { message: format!("the past is not traced from {from} on: {why}") },
            // the viewer wants to see something else by now
            Err(_) => return,
        };
        // a viewer that has left hears nothing
        outcomes.send(response).ok();
    });
    Ok(())
}

/// Makes a case of what operators have done, and shows it to the viewer.
pub(super) fn keep(
    name: String,
    save: bool,
    session: &Session,
    outcomes: &mpsc::UnboundedSender<Response>,
) -> Result<(), Refused> {
    let keep_case = session.keep_case.clone().map_err(Refused::NoCase)?;
    let wanted = CaseWanted { name, until: session.edge(), save };
    let outcomes = outcomes.clone();
    tokio::spawn(async move {
        // it reads the scenario's files
        let kept = tokio::task::spawn_blocking(move || keep_case(&wanted)).await;
        let response = match kept.unwrap_or_else(|error| Err(error.to_string())) {
            Ok(kept) => Response::Case { kept },
            Err(why) => Response::Error { message: Refused::NoCase(why).to_string() },
        };
        // a viewer that has left hears nothing
        outcomes.send(response).ok();
    });
    Ok(())
}
