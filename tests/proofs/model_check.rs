//! The session, model-checked with `stateright`: the very code that runs, in every order of what its
//! clients may do.
//!
//! Two models. [`Barrier`] holds [`Session`] alone: 1 to 4 clients, each free to sleep 0 to 5 steps
//! after a turn, ready in any order, failing in any state. [`Network`] puts [`Endpoint`]s and FIFO
//! connections around it: messages in flight, faults, lost connections.
//!
//! Time grows for ever, behaviour does not: two states that differ only in `t_v` behave alike, and so
//! do two that differ only in the values clients wrote. The barrier model therefore compares and
//! hashes states with all times relative to `t_v` and with each value only as right or wrong, which
//! makes it finite and the search complete. The network model is bounded in virtual time instead.

use std::collections::{HashMap, VecDeque};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io::Write;

use onescan_server::client::{ClientFault, ClientId, JoinRequest, Wake};
use onescan_server::end::{FailureCause, SessionEnd};
use onescan_server::plan::Coupling;
use onescan_server::session::{Progress, Session, Turn};
use onescan_server::signal::{ClientName, ElementaryType};
use onescan_server::state::{ClientState, ServerState};
use onescan_server::time::{StepCount, TimeSpan, VirtualTime};
use onescan_server::wire::{Duty, Endpoint, Frame, FrameCodec, FrameRef, ServerMessage};
use onescan_tests::{client, plan, port};
use stateright::{Checker, Model, Property};
use tokio_util::bytes::BytesMut;
use tokio_util::codec::{Decoder, Encoder};

const STEP: TimeSpan = TimeSpan::from_nanos(1).expect("not zero");
/// `tdelay : 0..5` of the appendix.
const DELAYS: std::ops::RangeInclusive<u64> = 0..=5;

/// A session of `clients` clients that have joined. Each writes its turn's time to two signals, which
/// every other reads.
fn formed(clients: usize, coupling: &Coupling<ClientName>) -> Session {
    let names: Vec<String> = (0..clients).map(|i| format!("c{i}")).collect();
    let stamps: Vec<String> = names.iter().flat_map(|name| [format!("{name}.a"), format!("{name}.b")]).collect();
    let signals: Vec<_> = stamps
        .iter()
        .enumerate()
        .map(|(i, stamp)| (stamp.as_str(), ElementaryType::Lint, names[i / 2].as_str()))
        .collect();
    let clients: Vec<&str> = names.iter().map(String::as_str).collect();
    let mut session = Session::new(plan(STEP, coupling, &signals, &clients));
    for (i, name) in names.iter().enumerate() {
        let ports = |range: &[String]| range.iter().map(|stamp| port(stamp, ElementaryType::Lint)).collect();
        let writes = ports(&stamps[2 * i..2 * i + 2]);
        let request = JoinRequest { name: client(name), period: STEP, reads: ports(&stamps), writes };
        session.join(&request).expect("the plan has a place");
    }
    session
}

/// The two stamps of each client in `bytes`.
fn stamps(bytes: &[u8]) -> Vec<(u64, u64)> {
    let word = |chunk: &[u8]| u64::from_le_bytes(chunk.try_into().expect("eight bytes"));
    bytes.chunks_exact(16).map(|pair| (word(&pair[..8]), word(&pair[8..]))).collect()
}

fn stamp_bytes(t_v: VirtualTime) -> [u8; 16] {
    let mut bytes = [0; 16];
    bytes[..8].copy_from_slice(&t_v.as_nanos().to_le_bytes());
    bytes[8..].copy_from_slice(&t_v.as_nanos().to_le_bytes());
    bytes
}

/// A time seen from `t_v`.
fn relative(time: u64, t_v: VirtualTime) -> i64 {
    time as i64 - t_v.as_nanos() as i64
}

/// What distinguishes two sessions that would behave differently.
type SessionView = (ServerState, usize, Vec<(ClientState, bool, bool, i64)>, Option<(ClientName, ClientState)>);

fn view(session: &Session) -> SessionView {
    let (cycle, t_v) = (session.cycle(), session.t_v());
    let clients = session
        .clients()
        .map(|id| {
            // A wake-up that is past means the same however long ago it was: due now.
            let wake = relative(cycle.wake(id).as_nanos(), t_v).max(0);
            (cycle.client(id), cycle.is_awaited(id), cycle.is_due(id), wake)
        })
        .collect();
    let failed = match session.end() {
        Some(SessionEnd::Failed(failure)) => Some((failure.client.clone(), failure.state)),
        _ => None,
    };
    (cycle.server(), cycle.pass(), clients, failed)
}

// ---------------------------------------------------------------------------------------------
// The barrier alone

/// The session with clients that do what they may, in any order.
struct Barrier {
    clients: usize,
    coupling: Coupling<ClientName>,
    /// Whether clients may also fail.
    failures: bool,
}

#[derive(Clone, Debug)]
struct BarrierState {
    session: Session,
    /// When each client's next turn is, as the client itself reckons.
    expected: Vec<VirtualTime>,
    /// The last turn of each client, and the last that has been committed.
    turned: Vec<VirtualTime>,
    committed: Vec<VirtualTime>,
    /// What a client saw that must not be.
    broken: Option<&'static str>,
}

impl BarrierState {
    fn key(&self) -> impl Hash + Eq + use<> {
        let t_v = self.session.t_v();
        let expected: Vec<i64> = self.expected.iter().map(|t| relative(t.as_nanos(), t_v)).collect();
        let right = |bytes: &[u8], turns: &[VirtualTime]| -> Vec<(bool, bool)> {
            let pairs = stamps(bytes).into_iter().zip(turns);
            pairs.map(|((a, b), turn)| (a == turn.as_nanos(), b == turn.as_nanos())).collect()
        };
        let image = right(self.session.image(), &self.committed);
        let staged = right(self.session.staged(), &self.turned);
        (view(&self.session), expected, image, staged, self.turned == self.committed, self.broken)
    }
}

impl Hash for BarrierState {
    fn hash<H: Hasher>(&self, hasher: &mut H) {
        self.key().hash(hasher);
    }
}

impl PartialEq for BarrierState {
    fn eq(&self, other: &Self) -> bool {
        self.key() == other.key()
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Act {
    /// The server goes on.
    Advance,
    /// A client does what its state asks for; after a turn it sleeps for so many steps.
    Client(usize, u64),
    /// A client fails.
    Fail(usize),
}

impl Barrier {
    fn act(&self, state: &mut BarrierState, act: Act) {
        match act {
            Act::Advance => drop(state.session.advance()),
            Act::Fail(i) => state.session.fail(ClientId::from_index(i), FailureCause::Disconnected),
            Act::Client(i, delay) => self.act_of_client(state, i, delay),
        }
    }

    fn act_of_client(&self, state: &mut BarrierState, i: usize, delay: u64) {
        let id = ClientId::from_index(i);
        let (steps, t_v) = (state.session.cycle().steps(), state.session.t_v());
        let done = match state.session.cycle().client(id) {
            ClientState::Start => unreachable!("all have joined"),
            ClientState::Setup => {
                state.expected[i] = VirtualTime::ZERO + STEP;
                state.session.initialise(id, &stamp_bytes(t_v))
            }
            ClientState::Ready | ClientState::Write => state.session.ready(id),
            ClientState::Read => {
                let mut inputs = vec![0; 16 * self.clients];
                let read = state.session.read(id, &mut inputs);
                self.look_at(state, &inputs);
                read
            }
            ClientState::Run => {
                if state.expected[i] != t_v {
                    state.broken = Some("a client acts in a wrong step");
                }
                let wake = VirtualTime::from_nanos(t_v.as_nanos() + 1 + delay);
                state.expected[i] = wake;
                state.turned[i] = t_v;
                state
                    .session
                    .submit(id, &Turn { sequence: steps, t_v, wake: Wake::At(wake), outputs: &stamp_bytes(t_v) })
            }
        };
        if done.is_err() {
            state.broken = Some("a client that keeps the rules is told that it broke one");
        }
    }

    /// What a client reads must be all that was committed and nothing else; in parallel coupling
    /// nothing of its own step.
    fn look_at(&self, state: &mut BarrierState, inputs: &[u8]) {
        let t_v = state.session.t_v().as_nanos();
        let parallel = matches!(self.coupling, Coupling::Parallel);
        let whole =
            |((a, b), turn): (&(u64, u64), &VirtualTime)| a == b && *a == turn.as_nanos() && (!parallel || *a < t_v);
        if !stamps(inputs).iter().zip(&state.committed).all(whole) {
            state.broken = Some("a client reads a half-committed image");
        }
    }
}

impl Model for Barrier {
    type State = BarrierState;
    type Action = Act;

    fn init_states(&self) -> Vec<BarrierState> {
        let zero = vec![VirtualTime::ZERO; self.clients];
        vec![BarrierState {
            session: formed(self.clients, &self.coupling),
            expected: zero.clone(),
            turned: zero.clone(),
            committed: zero,
            broken: None,
        }]
    }

    fn actions(&self, state: &BarrierState, actions: &mut Vec<Act>) {
        if state.session.end().is_some() {
            return;
        }
        let cycle = state.session.cycle();
        if cycle.is_synchronised() {
            actions.push(Act::Advance);
        }
        for i in 0..self.clients {
            let id = ClientId::from_index(i);
            if cycle.is_awaited(id) {
                match cycle.client(id) {
                    ClientState::Run => actions.extend(DELAYS.map(|delay| Act::Client(i, delay))),
                    _ => actions.push(Act::Client(i, 0)),
                }
            }
            if self.failures {
                actions.push(Act::Fail(i));
            }
        }
    }

    fn next_state(&self, last: &BarrierState, act: Act) -> Option<BarrierState> {
        let mut state = last.clone();
        self.act(&mut state, act);
        if act == Act::Advance && state.session.cycle().server() == ServerState::Write {
            state.committed.clone_from(&state.turned);
        }
        Some(state)
    }

    fn properties(&self) -> Vec<Property<Self>> {
        vec![
            Property::always("nothing is broken", |_, state: &BarrierState| state.broken.is_none()),
            Property::always("clients with equal delays are in equal states", |model: &Self, state: &BarrierState| {
                !matches!(model.coupling, Coupling::Parallel) || equal_delays_equal_states(&state.session)
            }),
            Property::always("only those whose delay has run out take part", |model: &Self, state: &BarrierState| {
                !matches!(model.coupling, Coupling::Parallel) || due_is_delay_run_out(state)
            }),
            Property::always("a failure ends the session and is told by name", |_, state: &BarrierState| {
                match state.session.end() {
                    None => true,
                    Some(SessionEnd::Failed(failure)) => {
                        state.session.clients().any(|id| {
                            state.session.plan().clients()[id.index()] == failure.client
                                && state.session.cycle().client(id) == failure.state
                                && state.session.t_v() == failure.t_v
                        }) && state.session.clone().advance() == Progress::Ended
                    }
                    Some(_) => false,
                }
            }),
        ]
    }
}

/// `AG (client1.state = client2.state)`, "valid when the time delays are equal".
fn equal_delays_equal_states(session: &Session) -> bool {
    let cycle = session.cycle();
    session
        .clients()
        .all(|a| session.clients().all(|b| cycle.wake(a) != cycle.wake(b) || cycle.client(a) == cycle.client(b)))
}

/// While clients run, exactly those take part whose own reckoning says that it is their turn.
fn due_is_delay_run_out(state: &BarrierState) -> bool {
    let cycle = state.session.cycle();
    !matches!(cycle.server(), ServerState::Read)
        || state.session.clients().all(|id| cycle.is_due(id) == (state.expected[id.index()] == cycle.t_v()))
}

/// All states that `model` can reach, and which follow which.
struct Graph<M: Model> {
    states: Vec<M::State>,
    edges: Vec<Vec<usize>>,
}

fn explore<M: Model>(model: &M) -> Graph<M>
where
    M::State: Clone + Hash,
{
    let key = |state: &M::State| {
        let mut hasher = DefaultHasher::new();
        state.hash(&mut hasher);
        hasher.finish()
    };
    let (mut graph, mut known) = (Graph::<M> { states: Vec::new(), edges: Vec::new() }, HashMap::new());
    for state in model.init_states() {
        known.insert(key(&state), graph.states.len());
        graph.states.push(state);
    }
    let mut next = 0;
    let mut actions = Vec::new();
    while next < graph.states.len() {
        actions.clear();
        model.actions(&graph.states[next], &mut actions);
        let mut follows = Vec::with_capacity(actions.len());
        for action in actions.drain(..) {
            let Some(state) = model.next_state(&graph.states[next], action) else { continue };
            let index = *known.entry(key(&state)).or_insert_with(|| {
                graph.states.push(state);
                graph.states.len() - 1
            });
            follows.push(index);
        }
        graph.edges.push(follows);
        next += 1;
    }
    graph
}

impl<M: Model> Graph<M> {
    /// `AG EF goal`: from every state a state with `goal` can be reached. The states from which none can.
    fn cannot_reach(&self, goal: impl Fn(&M::State) -> bool) -> usize {
        let mut before = vec![Vec::new(); self.states.len()];
        for (from, follows) in self.edges.iter().enumerate() {
            for to in follows {
                before[*to].push(from);
            }
        }
        let mut reaches: Vec<bool> = self.states.iter().map(goal).collect();
        let mut todo: Vec<usize> = (0..self.states.len()).filter(|i| reaches[*i]).collect();
        while let Some(state) = todo.pop() {
            for from in &before[state] {
                if !std::mem::replace(&mut reaches[*from], true) {
                    todo.push(*from);
                }
            }
        }
        reaches.iter().filter(|reaches| !**reaches).count()
    }

    /// Every pair of a state and one that follows it.
    fn transitions(&self) -> impl Iterator<Item = (&M::State, &M::State)> {
        self.edges
            .iter()
            .enumerate()
            .flat_map(move |(from, follows)| follows.iter().map(move |to| (&self.states[from], &self.states[*to])))
    }
}

/// Prints a line also where the harness keeps what a passing test prints.
fn report(line: std::fmt::Arguments<'_>) {
    let mut out = std::io::stdout().lock();
    writeln!(out, "{line}").expect("somebody reads the tests' output");
}

fn check_barrier(clients: usize, coupling: &Coupling<ClientName>, failures: bool) {
    let model = Barrier { clients, coupling: coupling.clone(), failures };
    let checker = model.checker().threads(2).spawn_bfs().join();
    checker.assert_properties();
    report(format_args!(
        "barrier, {clients} clients, delays 0..5, {}, {}: {} states",
        if matches!(coupling, Coupling::Parallel) { "parallel" } else { "sequential" },
        if failures { "failing in any state" } else { "nobody fails" },
        checker.unique_state_count(),
    ));
    assert!(checker.unique_state_count() > 10 * clients, "the model moves");
}

fn in_order(clients: usize) -> Coupling<ClientName> {
    Coupling::Sequential { order: (0..clients).rev().map(|i| client(&format!("c{i}"))).collect() }
}

#[test]
fn barrier_holds_with_one_to_four_clients_in_parallel() {
    (1..=4).for_each(|clients| check_barrier(clients, &Coupling::Parallel, false));
}

#[test]
fn barrier_holds_with_one_to_four_clients_in_sequence() {
    (1..=4).for_each(|clients| check_barrier(clients, &in_order(clients), false));
}

#[test]
fn a_client_that_fails_in_any_state_ends_the_session() {
    (1..=4).for_each(|clients| check_barrier(clients, &Coupling::Parallel, true));
    (1..=4).for_each(|clients| check_barrier(clients, &in_order(clients), true));
}

/// `AG EF (server.state = write)`, and `AG (read -> E [read U pre-write])` made stronger: no state but
/// pre-write ever follows read.
#[test]
fn write_stays_reachable_and_read_is_followed_by_pre_write() {
    for clients in 1..=4 {
        for coupling in [Coupling::Parallel, in_order(clients)] {
            let graph = explore(&Barrier { clients, coupling, failures: false });
            let server = |state: &BarrierState| state.session.cycle().server();
            assert_eq!(graph.cannot_reach(|state| server(state) == ServerState::Write), 0);
            let mut left_read = 0;
            for (from, to) in graph.transitions() {
                if server(from) == ServerState::Read && server(to) != ServerState::Read {
                    assert_eq!(server(to), ServerState::PreWrite);
                    left_read += 1;
                }
            }
            assert!(left_read > 0);
            report(format_args!("barrier graph, {clients} clients: {} states, no deadlock", graph.states.len()));
        }
    }
}

/// The check can fail: a barrier that lets go of a client too early is found out.
#[test]
fn a_broken_rule_would_be_found() {
    let mut state = Barrier { clients: 2, coupling: Coupling::Parallel, failures: false }.init_states().remove(0);
    let model = Barrier { clients: 2, coupling: Coupling::Parallel, failures: false };
    model.act(&mut state, Act::Advance);
    model.act(&mut state, Act::Client(0, 0));
    model.act(&mut state, Act::Client(0, 0));
    assert_eq!(state.broken, Some("a client that keeps the rules is told that it broke one"));
    let mut state = model.init_states().remove(0);
    state.turned[1] = VirtualTime::from_nanos(7);
    state.committed[1] = VirtualTime::from_nanos(7);
    model.look_at(&mut state, &[0; 32]);
    assert_eq!(state.broken, Some("a client reads a half-committed image"));
}

// ---------------------------------------------------------------------------------------------
// With endpoints and connections

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
    /// The server has told this client that the session is over.
    told: bool,
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
    /// The server goes on, and tells its clients.
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
            tell_the_end(state);
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
                ServerState::InitialWrite => state.pipes[i].to_client.push_back(json(&ServerMessage::Setup {})),
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
        Ok(Duty::Setup) => {
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
        Ok(Duty::Leave(_)) => pipe.told = true,
        Ok(_) => state.broken = Some("a client is asked what nobody asked"),
        Err(_) => state.broken = Some("a client acts in a wrong step"),
    }
    pipe.endpoint.answered();
}

fn tell_the_end(state: &mut NetworkState) {
    let end = state.session.end().cloned().expect("it is over");
    let message = json(&ServerMessage::End(end));
    for pipe in &mut state.pipes {
        if !pipe.told && pipe.to_client.back() != Some(&message) {
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
            told: false,
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
            if !pipe.closed && !pipe.told {
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
                state.pipes.iter().any(|pipe| pipe.closed) && state.pipes.iter().any(|pipe| pipe.told)
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
