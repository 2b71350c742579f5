//! The session alone, with clients that do what they may, in any order.

use std::hash::{Hash, Hasher};

use onescan_server::client::{ClientId, Wake};
use onescan_server::end::{FailureCause, SessionEnd};
use onescan_server::plan::Coupling;
use onescan_server::session::{Progress, Session, Turn};
use onescan_server::signal::ClientName;
use onescan_server::state::{ClientState, ServerState};
use onescan_server::time::VirtualTime;
use onescan_tests::client;
use stateright::{Checker, Model, Property};

use crate::graph::explore;
use crate::stamped::{DELAYS, STEP, formed, relative, report, stamp_bytes, stamps, view};

/// The session with clients that do what they may, in any order.
pub(crate) struct Barrier {
    clients: usize,
    coupling: Coupling<ClientName>,
    /// Whether clients may also fail.
    failures: bool,
}

#[derive(Clone, Debug)]
pub(crate) struct BarrierState {
    session: Session,
    /// When each client's next turn is, as the client itself reckons.
    expected: Vec<VirtualTime>,
    /// The last turn of each client, and the last that has been committed.
    turned: Vec<VirtualTime>,
    committed: Vec<VirtualTime>,
    /// What a client saw that must not be.
    broken: Option<&'static str>,
}

/// A state as other descriptions of the session know it: the server's, and for each client its state,
/// whether it is ready, the steps that it still sleeps through, and those that it has asked for next.
pub(crate) type Shown = (String, Vec<[String; 4]>);

impl BarrierState {
    pub(crate) fn shown(&self) -> Shown {
        let (cycle, t_v) = (self.session.cycle(), self.session.t_v());
        let word = |state: &dyn std::fmt::Display| state.to_string().replace('-', "_");
        let client = |id: ClientId| {
            let wake = relative(cycle.wake(id).as_nanos(), t_v);
            let (due, ready) = (cycle.is_due(id), !cycle.is_awaited(id));
            let asleep = match cycle.server() {
                _ if due => 0,
                // the step in which it would wake has not begun
                ServerState::PreRead => wake - 1,
                _ => wake,
            };
            let asked = match cycle.client(id) {
                ClientState::Run if ready => relative(self.expected[id.index()].as_nanos(), t_v) - 1,
                ClientState::Write if due => wake - 1,
                _ => 0,
            };
            [word(&cycle.client(id)), ready.to_string(), asleep.to_string(), asked.to_string()]
        };
        (word(&cycle.server()), self.session.clients().map(client).collect())
    }

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
pub(crate) enum Act {
    /// The server goes on.
    Advance,
    /// A client does what its state asks for; after a turn it sleeps for so many steps.
    Client(usize, u64),
    /// A client fails.
    Fail(usize),
}

impl Barrier {
    /// Clients of which none fails.
    pub(crate) fn undisturbed(clients: usize, coupling: Coupling<ClientName>) -> Self {
        Self { clients, coupling, failures: false }
    }

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
            state.broken = Some("a client that keeps the rules is blamed for breaking one");
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
            Property::always(
                "a failure ends the session and is reported by name",
                |_, state: &BarrierState| match state.session.end() {
                    None => true,
                    Some(SessionEnd::Failed(failure)) => {
                        state.session.clients().any(|id| {
                            state.session.plan().clients()[id.index()] == failure.client
                                && state.session.cycle().client(id) == failure.state
                                && state.session.t_v() == failure.t_v
                        }) && state.session.clone().advance() == Progress::Ended
                    }
                    Some(_) => false,
                },
            ),
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
    assert_eq!(state.broken, Some("a client that keeps the rules is blamed for breaking one"));
    let mut state = model.init_states().remove(0);
    state.turned[1] = VirtualTime::from_nanos(7);
    state.committed[1] = VirtualTime::from_nanos(7);
    model.look_at(&mut state, &[0; 32]);
    assert_eq!(state.broken, Some("a client reads a half-committed image"));
}
