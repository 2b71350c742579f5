//! What a case does to a free-wheeling client, by that client's own clock: there is no common one.
//!
//! Operations by time act as in lockstep, on the cycle that ends at their time. A condition or a fault on
//! the way of a signal needs an image that all clients share, and there is none; these are left out, with
//! a warning.

use std::collections::BTreeMap;

use onescan_server::client::{Client, ClientFault, ClientOperation, JoinRequest};
use onescan_server::operation::Operation;
use onescan_server::signal::PortLayout;
use onescan_server::time::VirtualTime;
use onescan_server::timeline::{Scheduled, When};

/// What is done to one client.
enum Act {
    /// An output is held, from its first byte in the port on.
    Hold(usize, Vec<u8>),
    /// An output is let go.
    LetGo(usize),
    Client(ClientOperation),
}

/// The part of a timeline that concerns one client.
pub(super) struct OwnTimeline {
    /// By time, the earliest last, so that the next one is popped.
    ahead: Vec<(VirtualTime, Act)>,
    held: BTreeMap<usize, Vec<u8>>,
}

impl OwnTimeline {
    /// What `scheduled` does to the client that joins with `request`.
    pub(super) fn new(scheduled: &[Scheduled], request: &JoinRequest) -> Self {
        let layout = PortLayout::new(request.writes.clone());
        let mut ahead: Vec<(VirtualTime, Act)> = Vec::new();
        for Scheduled { when, operation } in scheduled {
            let act = act(operation, request, &layout);
            match (when, act) {
                (When::At(at), Some(act)) => ahead.push((*at, act)),
                (When::Once { .. }, Some(_)) => {
                    tracing::warn!(%operation, "left out: a condition cannot be judged without lockstep");
                }
                (_, None) => {}
            }
        }
        // Stable, so that acts of one time keep their order.
        ahead.sort_by_key(|(at, _)| *at);
        ahead.reverse();
        Self { ahead, held: BTreeMap::new() }
    }

    /// Takes what is due at `t`, and gives what the client itself is asked.
    fn due(&mut self, t: VirtualTime) -> Vec<ClientOperation> {
        let mut asked = Vec::new();
        while self.ahead.last().is_some_and(|(at, _)| *at <= t) {
            match self.ahead.pop() {
                Some((_, Act::Hold(offset, bytes))) => drop(self.held.insert(offset, bytes)),
                Some((_, Act::LetGo(offset))) => drop(self.held.remove(&offset)),
                Some((_, Act::Client(operation))) => asked.push(operation),
                None => return asked,
            }
        }
        asked
    }

    /// Sets the client up with what is in force from the start.
    pub(super) fn set_up(&mut self, client: &mut dyn Client, outputs: &mut [u8]) -> Result<(), ClientFault> {
        let asked = self.due(VirtualTime::ZERO);
        client.begin(&asked, outputs)
    }

    /// Asks the client for what is due in the cycle that ends at `t`.
    pub(super) fn before(&mut self, t: VirtualTime, client: &mut dyn Client) -> Result<(), ClientFault> {
        self.due(t).iter().try_for_each(|operation| {
            client.operate(operation).map_err(|refused| ClientFault::new(format!("{operation}: {refused}")))
        })
    }

    /// The outputs as others see them.
    pub(super) fn seen(&self, own: &[u8]) -> Vec<u8> {
        let mut seen = own.to_vec();
        for (offset, bytes) in &self.held {
            seen[*offset..*offset + bytes.len()].copy_from_slice(bytes);
        }
        seen
    }
}

/// What an operation does to a client; nothing if it is another's.
fn act(operation: &Operation, request: &JoinRequest, layout: &PortLayout) -> Option<Act> {
    let own = |signal: &onescan_server::signal::SignalName| layout.iter().find(|(port, _)| port.name == *signal);
    match operation {
        Operation::Force { signal, value } => {
            let (port, offset) = own(signal)?;
            match port.ty.parse_text(value) {
                Ok(bytes) => Some(Act::Hold(offset, bytes)),
                Err(error) => {
                    tracing::warn!(%operation, %error, "left out");
                    None
                }
            }
        }
        Operation::Release { signal } => own(signal).map(|(_, offset)| Act::LetGo(offset)),
        Operation::Disturb { signal, .. } if own(signal).is_some() => {
            tracing::warn!(%operation, "left out: faults of signals need lockstep");
            None
        }
        other => other.for_client().filter(|(name, _)| **name == request.name).map(|(_, asked)| Act::Client(asked)),
    }
}
