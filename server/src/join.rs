//! Joining: a client's wishes held against the session's plan.

use onescan_base::nearest;
use thiserror::Error;

use crate::client::JoinRequest;
use crate::image::PortMap;
use crate::layout::ImageLayout;
use crate::plan::{SessionPlan, hint};
use crate::signal::{ClientName, Port, PortLayout, SignalDecl, SignalId, SignalName, SignalType};
use crate::time::TimeSpan;

/// A client that is in.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Membership {
    /// Virtual time of one turn.
    pub period: TimeSpan,
    /// The signals it reads.
    pub reads: Vec<SignalId>,
    /// The signals it writes.
    pub writes: Vec<SignalId>,
    /// Its inputs and the image.
    pub inputs: PortMap,
    /// Its outputs and the image.
    pub outputs: PortMap,
}

/// Why a client may not join.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum JoinRefusal {
    /// The session does not wait for such a client.
    #[error("the session expects no client `{name}`{}", hint(nearest.as_deref()))]
    NotExpected {
        name: ClientName,
        /// Who may have been meant.
        nearest: Option<String>,
    },
    /// Somebody of that name is in.
    #[error("client `{0}` has already joined")]
    AlreadyJoined(ClientName),
    /// The session has begun or ended.
    #[error("client `{0}` is too late: the session has left state start")]
    TooLate(ClientName),
    /// A turn would end between two steps.
    #[error("the period {period} of client `{client}` is not a multiple of the session's step {step}")]
    Period { client: ClientName, period: TimeSpan, step: TimeSpan },
    #[error("client `{client}` names a signal `{signal}` that the session has not{}", hint(nearest.as_deref()))]
    UnknownSignal {
        client: ClientName,
        signal: SignalName,
        /// What may have been meant.
        nearest: Option<String>,
    },
    /// Another type than declared.
    #[error("client `{client}` takes signal `{signal}` for {claimed}, but it is {declared}")]
    WrongType { client: ClientName, signal: SignalName, claimed: SignalType, declared: SignalType },
    /// A signal has exactly one writer.
    #[error("client `{client}` would be a second writer of signal `{signal}`, which `{writer}` writes")]
    SecondWriter { client: ClientName, signal: SignalName, writer: ClientName },
    /// A signal that is the client's to write, and that it does not.
    #[error("client `{client}` does not write signal `{signal}`, which the session has no other writer for")]
    Unwritten { client: ClientName, signal: SignalName },
    /// The same signal twice in one port.
    #[error("client `{client}` names signal `{signal}` twice")]
    Doubled { client: ClientName, signal: SignalName },
}

/// Holds `request` against the plan. `written_by` says who writes each signal by now.
///
/// # Errors
/// See [`JoinRefusal`]; nothing has changed then.
pub fn admit(
    request: &JoinRequest,
    plan: &SessionPlan,
    layout: &ImageLayout,
    written_by: &[Option<ClientName>],
) -> Result<Membership, JoinRefusal> {
    if !request.period.is_multiple_of(plan.step()) {
        return Err(JoinRefusal::Period { client: request.name.clone(), period: request.period, step: plan.step() });
    }
    let reads = resolve(&request.name, &request.reads, plan)?;
    let writes = resolve(&request.name, &request.writes, plan)?;
    let mut written = vec![false; plan.signals().len()];
    for id in &writes {
        written[id.index()] = true;
        let signal = &plan.signals()[id.index()];
        let writer = written_by[id.index()].as_ref().or(signal.writer.as_ref());
        if let Some(writer) = writer.filter(|writer| **writer != request.name) {
            return Err(JoinRefusal::SecondWriter {
                client: request.name.clone(),
                signal: signal.name.clone(),
                writer: writer.clone(),
            });
        }
    }
    let is_missing = |signal: &&SignalDecl| signal.writer.as_ref() == Some(&request.name);
    if let Some(signal) =
        plan.signals().iter().enumerate().filter(|(index, _)| !written[*index]).map(|(_, s)| s).find(is_missing)
    {
        return Err(JoinRefusal::Unwritten { client: request.name.clone(), signal: signal.name.clone() });
    }
    Ok(Membership {
        period: request.period,
        inputs: PortMap::new(&PortLayout::new(request.reads.clone()), &reads, layout),
        outputs: PortMap::new(&PortLayout::new(request.writes.clone()), &writes, layout),
        reads,
        writes,
    })
}

/// The ids of the signals of one port, in its order.
fn resolve(client: &ClientName, ports: &[Port], plan: &SessionPlan) -> Result<Vec<SignalId>, JoinRefusal> {
    let mut ids = Vec::with_capacity(ports.len());
    for port in ports {
        let id = find(client, port, plan)?;
        ids.push(id);
    }
    let mut sorted = ids.clone();
    sorted.sort_unstable();
    if let Some(pair) = sorted.windows(2).find(|pair| pair[0] == pair[1]) {
        let signal = plan.signals()[pair[0].index()].name.clone();
        return Err(JoinRefusal::Doubled { client: client.clone(), signal });
    }
    Ok(ids)
}

fn find(client: &ClientName, port: &Port, plan: &SessionPlan) -> Result<SignalId, JoinRefusal> {
    let signals = plan.signals();
    let index =
        signals.binary_search_by(|signal| signal.name.cmp(&port.name)).map_err(|_| JoinRefusal::UnknownSignal {
            client: client.clone(),
            signal: port.name.clone(),
            nearest: nearest(port.name.as_str(), signals.iter().map(|signal| signal.name.as_str())).map(str::to_owned),
        })?;
    if signals[index].ty != port.ty {
        return Err(JoinRefusal::WrongType {
            client: client.clone(),
            signal: port.name.clone(),
            claimed: port.ty,
            declared: signals[index].ty,
        });
    }
    Ok(SignalId(index as u32))
}
