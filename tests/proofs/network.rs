//! The session with endpoints and FIFO connections around it.

use std::collections::VecDeque;
use std::hash::{Hash, Hasher};

use onescan_server::client::{ClientFault, ClientId, Wake};
use onescan_server::end::{FailureCause, SessionEnd};
use onescan_server::plan::Coupling;
use onescan_server::session::{Progress, Session, Turn};
use onescan_server::state::ServerState;
use onescan_server::time::{StepCount, VirtualTime};
use onescan_server::wire::{Duty, Endpoint, Frame, FrameCodec, FrameRef, ServerMessage};
use stateright::{Checker, Model, Property};
use tokio_util::bytes::BytesMut;
use tokio_util::codec::{Decoder, Encoder};

use crate::stamped::{formed, report, stamp_bytes, stamps};

/// The session with clients behind FIFO connections; each side takes its messages when it likes.
struct Network {
    clients: usize,
    /// Steps of virtual time that are explored.
    horizon: u64,
    /// The longest sleep of a client, in steps.
    delay_max: u64,
}

/// The server's end and the client's end of one connection, and what is on the way.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
struct Pipe {
    endpoint: Endpoint,
    to_client: VecDeque<Vec<u8>>,
    to_server: VecDeque<Vec<u8>>,
    /// The client closed it; what it sent before still arrives.
    closed: bool,
    /// The server has notified this client that the session is over.
    notified: bool,
    /// What the server has read for this client's next grant.
    inputs: Vec<u8>,
}

#[derive(Clone, Debug)]
struct NetworkState {
    session: Session,
    pipes: Vec<Pipe>,
    broken: Option<&'static str>,
}

impl NetworkState {
    /// Absolute times also travel inside messages and endpoints, so these states are not made
    /// relative; the search is bounded in virtual time instead.
    fn key(&self) -> impl Hash + Eq + use<'_> {
        let session = &self.session;
        (session.cycle(), session.image(), session.staged(), session.end(), &self.pipes, self.broken)
    }
}

impl Hash for NetworkState {
    fn hash<H: Hasher>(&self, hasher: &mut H) {
        self.key().hash(hasher);
    }
}

impl PartialEq for NetworkState {
    fn eq(&self, other: &Self) -> bool {
        self.key() == other.key()
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Event {
    /// The server goes on, and notifies its clients.
    Advance,
    /// The server takes a message.
    ServerReceives(usize),
    /// The server finds the connection closed.
    ServerLoses(usize),
    /// The client takes a message, and sleeps for so many steps if it was a grant.
    ClientReceives(usize, u64),
    /// The client breaks down: with a last word, or without.
    ClientFaults(usize),
    /// Its connection breaks.
    ClientVanishes(usize),
}

fn encoded(frame: FrameRef<'_>) -> Vec<u8> {
    let mut bytes = BytesMut::new();
    FrameCodec::new(1 << 16).encode(frame, &mut bytes).expect("small frames");
    bytes.to_vec()
}

fn decoded(bytes: &[u8]) -> Frame {
    FrameCodec::new(1 << 16).decode(&mut BytesMut::from(bytes)).expect("own frames").expect("whole frames")
}

fn json(message: &ServerMessage) -> Vec<u8> {
    encoded(FrameRef::Json(&serde_json::to_vec(message).expect("own messages")))
}

impl Network {
    fn apply(&self, state: &mut NetworkState, event: Event) {
        match event {
            Event::Advance => self.advance(state),
            Event::ServerReceives(i) => server_receives(state, i),
            Event::ServerLoses(i) => state.session.fail(ClientId::from_index(i), FailureCause::Disconnected),
            Event::ClientReceives(i, delay) => client_receives(state, i, delay),
            Event::ClientFaults(i) => {
                let fault = onescan_server::wire::ClientMessage::Fault(ClientFault::new("breaks down"));
                let text = serde_json::to_vec(&fault).expect("own messages");
                state.pipes[i].to_server.push_back(encoded(FrameRef::Json(&text)));
                state.pipes[i].closed = true;
            }
            Event::ClientVanishes(i) => {
                state.pipes[i].to_server.clear();
                state.pipes[i].closed = true;
            }
        }
        if state.session.end().is_some() {
            notify_of_the_end(state);
        }
    }

    fn advance(&self, state: &mut NetworkState) {
        let Progress::Entered(entered) = state.session.advance() else { return };
        for i in 0..self.clients {
            let id = ClientId::from_index(i);
            if !state.session.cycle().is_awaited(id) {
                continue;
            }
            let (sequence, t_v) = (state.session.cycle().steps(), state.session.t_v());
            match entered {
                ServerState::Start => {}
                ServerState::InitialWrite => {
                    state.pipes[i].to_client.push_back(json(&ServerMessage::Setup { operations: Vec::new() }));
                }
                ServerState::PreRead | ServerState::Write => state.session.ready(id).expect("awaited"),
                ServerState::Read => {
                    state.session.read(id, &mut state.pipes[i].inputs).expect("awaited");
                }
                ServerState::PreWrite => {
                    let pipe = &mut state.pipes[i];
                    pipe.to_client.push_back(encoded(FrameRef::Grant { sequence, t_v, inputs: &pipe.inputs }));
                }
            }
        }
    }
}

fn server_receives(state: &mut NetworkState, i: usize) {
    let id = ClientId::from_index(i);
    let Some(bytes) = state.pipes[i].to_server.pop_front() else { return };
    match decoded(&bytes) {
        Frame::Turn { sequence, outputs, .. } if sequence.0 == 0 => drop(state.session.initialise(id, &outputs)),
        Frame::Turn { sequence, t_v, wake, outputs } => {
            drop(state.session.submit(id, &Turn { sequence, t_v, wake, outputs: &outputs }));
        }
        _ => state.session.fail(id, FailureCause::Fault(ClientFault::new("breaks down"))),
    }
}

fn client_receives(state: &mut NetworkState, i: usize, delay: u64) {
    let pipe = &mut state.pipes[i];
    let Some(bytes) = pipe.to_client.pop_front() else { return };
    let answer = |sequence, t_v, wake, outputs: &[u8]| encoded(FrameRef::Turn { sequence, t_v, wake, outputs });
    match pipe.endpoint.receive(decoded(&bytes)) {
        Ok(Duty::Setup(_)) => {
            let zero = VirtualTime::ZERO;
            pipe.to_server.push_back(answer(StepCount(0), zero, Wake::NextPeriod, &stamp_bytes(zero)));
        }
        Ok(Duty::Turn { sequence, t_v, inputs }) => {
            if stamps(&inputs).iter().any(|(a, b)| a != b || *a >= t_v.as_nanos()) {
                state.broken = Some("a client reads a half-committed image");
            }
            let wake = Wake::At(VirtualTime::from_nanos(t_v.as_nanos() + 1 + delay));
            pipe.to_server.push_back(answer(sequence, t_v, wake, &stamp_bytes(t_v)));
        }
        Ok(Duty::Leave(_)) => pipe.notified = true,
        Ok(_) => state.broken = Some("a client is asked what nobody asked"),
        Err(_) => state.broken = Some("a client acts in a wrong step"),
    }
    pipe.endpoint.answered();
}

fn notify_of_the_end(state: &mut NetworkState) {
    let end = state.session.end().cloned().expect("it is over");
    let message = json(&ServerMessage::End(end));
    for pipe in &mut state.pipes {
        if !pipe.notified && pipe.to_client.back() != Some(&message) {
            pipe.to_client.push_back(message.clone());
        }
    }
}

impl Model for Network {
    type State = NetworkState;
    type Action = Event;

    fn init_states(&self) -> Vec<NetworkState> {
        let pipe = Pipe {
            endpoint: Endpoint::new(16 * self.clients),
            to_client: VecDeque::new(),
            to_server: VecDeque::new(),
            closed: false,
            notified: false,
            inputs: vec![0; 16 * self.clients],
        };
        let session = formed(self.clients, &Coupling::Parallel);
        vec![NetworkState { session, pipes: vec![pipe; self.clients], broken: None }]
    }

    fn actions(&self, state: &NetworkState, events: &mut Vec<Event>) {
        let over = state.session.end().is_some();
        if !over && state.session.cycle().is_synchronised() {
            events.push(Event::Advance);
        }
        for (i, pipe) in state.pipes.iter().enumerate() {
            if !pipe.to_client.is_empty() && !pipe.closed {
                let delay_max = if decoded(&pipe.to_client[0]).is_grant() { self.delay_max } else { 0 };
                let delays = 0..=delay_max;
                events.extend(delays.map(|delay| Event::ClientReceives(i, delay)));
            }
            if !over && !pipe.to_server.is_empty() {
                events.push(Event::ServerReceives(i));
            }
            if !over
                && pipe.closed
                && pipe.to_server.is_empty()
                && state.session.cycle().is_awaited(ClientId::from_index(i))
            {
                events.push(Event::ServerLoses(i));
            }
            if !pipe.closed && !pipe.notified {
                events.extend([Event::ClientFaults(i), Event::ClientVanishes(i)]);
            }
        }
    }

    fn next_state(&self, last: &NetworkState, event: Event) -> Option<NetworkState> {
        let mut state = last.clone();
        self.apply(&mut state, event);
        Some(state)
    }

    fn within_boundary(&self, state: &NetworkState) -> bool {
        state.session.t_v().as_nanos() <= self.horizon
    }

    fn properties(&self) -> Vec<Property<Self>> {
        vec![
            Property::always("nothing is broken", |_, state: &NetworkState| state.broken.is_none()),
            Property::always("the session is never at fault", |_, state: &NetworkState| match state.session.end() {
                Some(SessionEnd::Failed(failure)) => !matches!(failure.cause, FailureCause::Violation(_)),
                _ => true,
            }),
            Property::always(
                "when nothing is left to do, everybody knows that it is over",
                |model: &Self, state: &NetworkState| {
                    let mut events = Vec::new();
                    model.actions(state, &mut events);
                    !events.is_empty() || state.pipes.iter().all(|pipe| pipe.closed || pipe.endpoint.is_ended())
                },
            ),
            Property::sometimes("a session goes on to the horizon", |model: &Self, state: &NetworkState| {
                state.session.t_v().as_nanos() == model.horizon
            }),
            Property::sometimes("a failure reaches the others", |_, state: &NetworkState| {
                state.pipes.iter().any(|pipe| pipe.closed) && state.pipes.iter().any(|pipe| pipe.notified)
                    || state.pipes.len() == 1
            }),
        ]
    }
}

/// What the models ask of a frame.
trait FrameKind {
    fn is_grant(&self) -> bool;
}

impl FrameKind for Frame {
    fn is_grant(&self) -> bool {
        matches!(self, Frame::Grant { .. })
    }
}

#[test]
fn sessions_over_connections_end_for_everybody() {
    for (clients, horizon, delay_max) in [(1, 8, 5), (2, 4, 2), (3, 2, 1)] {
        let checker = Network { clients, horizon, delay_max }.checker().threads(2).spawn_bfs().join();
        checker.assert_properties();
        let states = checker.unique_state_count();
        report(format_args!("network, {clients} clients, faults and lost connections: {states} states"));
    }
}
