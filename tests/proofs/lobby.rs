//! The lobby: who comes, who may stay, and for how long, in every order of what a few may do: two clients, an operator and
//! strangers say a message in pieces, are silent, hang up, come again. `tests/simulation` has histories of many.

use std::hash::{Hash, Hasher};
use std::net::IpAddr;
use std::sync::Arc;
use std::time::Duration;

use onescan_server::access::Register;
use onescan_server::lobby::Visitor;
use onescan_simulation::hall::{Hall, Tokens, frame, hello, join, request};
use stateright::{Checker, Model, Property};

use crate::stamped::report;

/// How often somebody comes: the second time it neither hangs up nor is late.
const TRIES: u64 = 2;
/// Somebody who comes.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
enum Actor {
    /// The client of this number, with its token.
    Client(usize),
    /// An operator with a token, who asks once.
    Operator,
    /// Somebody with the words of client 0 and without its token.
    Stranger,
}

/// Clients, an operator and strangers around a lobby.
struct Lobby {
    clients: usize,
    actors: Vec<Actor>,
    tokens: Tokens,
    register: Arc<Register>,
    /// How often time runs out for whoever is due.
    alarms: u8,
}

/// How far somebody has come.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Default)]
struct Way {
    /// How often it has come.
    tries: u64,
    /// How many pieces of what it says it has said.
    said: usize,
}

#[derive(Clone, Debug)]
struct LobbyState {
    hall: Hall,
    ways: Vec<Way>,
    alarms: u8,
}

impl LobbyState {
    /// How a lobby goes on does not depend on who tried last in vain.
    fn key(&self) -> impl Hash + Eq + use<'_> {
        let hall = &self.hall;
        let waiting: Vec<(Visitor, &str)> =
            hall.applications.iter().map(|(visitor, request)| (*visitor, request.name.as_str())).collect();
        let members = (&hall.seats, hall.is_begun, hall.broken, hall.now);
        (&hall.acceptor, &hall.lines, waiting, &hall.wishes, members, &self.ways, self.alarms)
    }
}

impl Hash for LobbyState {
    fn hash<H: Hasher>(&self, hasher: &mut H) {
        self.key().hash(hasher);
    }
}

impl PartialEq for LobbyState {
    fn eq(&self, other: &Self) -> bool {
        self.key() == other.key()
    }
}

#[derive(Clone, Debug, PartialEq, Eq, Hash)]
enum Event {
    /// It connects.
    Comes(usize),
    /// It says the next piece, half a message.
    Says(usize),
    /// It closes.
    HangsUp(usize),
    /// The session's thread decides about the next application.
    Decides,
    /// It finds out who has gone.
    Notices,
    /// It answers operators.
    Answers,
    /// It begins, once all are there.
    Begins,
    /// Time runs out for whoever is due first.
    Alarm,
}

impl Lobby {
    fn new(clients: usize, strangers: usize, alarms: u8) -> Self {
        let tokens = Tokens::new(clients);
        let register = Arc::new(tokens.register.clone());
        let mut actors: Vec<Actor> = (0..clients).map(Actor::Client).collect();
        actors.push(Actor::Operator);
        actors.extend((0..strangers).map(|_| Actor::Stranger));
        Self { clients, actors, tokens, register, alarms }
    }

    /// All that somebody has to say, each message in two pieces.
    fn pieces(&self, actor: &Actor) -> Vec<Vec<u8>> {
        let messages = match actor {
            Actor::Client(number) => {
                vec![hello("client", Some(&self.tokens.clients[*number])), join(&request(*number))]
            }
            Actor::Operator => {
                vec![hello("operator", Some(&self.tokens.operator)), frame(r#"{"status":{}}"#)]
            }
            Actor::Stranger => vec![hello("client", Some(&self.tokens.operator)), join(&request(0))],
        };
        let halves = |message: Vec<u8>| {
            let (first, second) = message.split_at(message.len() / 2);
            [first.to_vec(), second.to_vec()]
        };
        messages.into_iter().flat_map(halves).collect()
    }
}

/// The connection of somebody's last try.
fn visitor(index: usize, way: &Way) -> Visitor {
    Visitor(index as u64 * TRIES + way.tries.saturating_sub(1))
}

/// Whether somebody may speak: a client says `join` when it has heard `welcome`.
fn may_speak(state: &LobbyState, index: usize, pieces: usize) -> bool {
    let way = &state.ways[index];
    let line = state.hall.lines.get(&visitor(index, way));
    way.tries > 0
        && way.said < pieces
        && line.is_some_and(|line| !line.is_settled() && (way.said < 2 || line.heard.contains('w')))
}

impl Model for Lobby {
    type State = LobbyState;
    type Action = Event;

    fn init_states(&self) -> Vec<LobbyState> {
        let hall = Hall::new(self.clients, Some(&self.register));
        vec![LobbyState { hall, ways: vec![Way::default(); self.actors.len()], alarms: 0 }]
    }

    fn actions(&self, state: &LobbyState, events: &mut Vec<Event>) {
        for (index, way) in state.ways.iter().enumerate() {
            let line = state.hall.lines.get(&visitor(index, way)).filter(|_| way.tries > 0);
            if way.tries < TRIES && line.is_none_or(|line| line.closed || line.hung_up) {
                events.push(Event::Comes(index));
            }
            if may_speak(state, index, 4) {
                events.push(Event::Says(index));
            }
            // Whoever is asked to leave does; before that, only the first time.
            let leaves = line.is_some_and(|line| !line.closed && !line.hung_up && (line.parted || way.tries < TRIES));
            if leaves && !state.hall.is_begun {
                events.push(Event::HangsUp(index));
            }
        }
        if !state.hall.applications.is_empty() {
            events.push(Event::Decides);
        }
        if !state.hall.wishes.is_empty() {
            events.push(Event::Answers);
        }
        let gone = |seat: &Visitor| state.hall.lines.get(seat).is_some_and(|line| line.hung_up);
        let has_gone = state.hall.seats.values().any(gone);
        if has_gone && !state.hall.is_begun {
            events.push(Event::Notices);
        }
        if state.hall.registration.is_complete() && !has_gone && !state.hall.is_begun {
            events.push(Event::Begins);
        }
        if state.alarms < self.alarms && state.hall.acceptor.next_deadline().is_some() {
            events.push(Event::Alarm);
        }
    }

    fn next_state(&self, last: &LobbyState, event: Event) -> Option<LobbyState> {
        let mut state = last.clone();
        match event {
            Event::Comes(index) => {
                state.ways[index] = Way { tries: state.ways[index].tries + 1, said: 0 };
                let is_let_in = self.actors[index] != Actor::Stranger;
                let (visitor, address) = (visitor(index, &state.ways[index]), IpAddr::from([127, 0, 0, 1]));
                if self.actors[index] == Actor::Operator {
                    state.hall.operators.insert(visitor, address);
                }
                state.hall.open(visitor, address, is_let_in);
            }
            Event::Says(index) => {
                let pieces = self.pieces(&self.actors[index]);
                state.hall.bytes(visitor(index, &state.ways[index]), &pieces[state.ways[index].said]);
                state.ways[index].said += 1;
            }
            Event::HangsUp(index) => state.hall.hang_up(visitor(index, &state.ways[index])),
            Event::Decides => state.hall.decide(),
            Event::Notices => state.hall.notice_gone(),
            Event::Answers => state.hall.answer(),
            Event::Begins => state.hall.begin(),
            Event::Alarm => {
                state.alarms += 1;
                let due = state.hall.acceptor.next_deadline()?;
                state.hall.pass(due.max(state.hall.now + Duration::from_nanos(1)));
            }
        }
        state.hall.check();
        Some(state)
    }

    fn properties(&self) -> Vec<Property<Self>> {
        vec![
            Property::always("nothing is broken", |_, state: &LobbyState| state.hall.broken.is_none()),
            Property::always(
                "when nothing is left to do, all are answered, and the session has begun",
                |model, state| {
                    let mut events = Vec::new();
                    model.actions(state, &mut events);
                    // The second time, time may run out for whoever has not yet spoken; that is its own fault.
                    !events.is_empty() || state.hall.is_begun || state.alarms > 0
                },
            ),
            Property::sometimes("it begins although somebody was late", |model: &Self, state: &LobbyState| {
                state.hall.is_begun && state.alarms == model.alarms
            }),
            Property::sometimes("it begins with a client that had gone", |_, state: &LobbyState| {
                state.hall.is_begun && state.ways[0].tries == TRIES
            }),
            Property::sometimes("a stranger is refused while others are in", |_, state: &LobbyState| {
                let hall = &state.hall;
                let mut strangers = hall.lines.iter().filter(|(visitor, _)| !hall.let_in.contains(visitor));
                !hall.seats.is_empty() && strangers.any(|(_, line)| line.heard == "r")
            }),
        ]
    }
}

fn explore(clients: usize, strangers: usize, alarms: u8) {
    let checker = Lobby::new(clients, strangers, alarms).checker().threads(2).spawn_bfs().join();
    if strangers == 0 {
        for holds in ["nothing is broken", "when nothing is left to do, all are answered, and the session has begun"] {
            checker.assert_no_discovery(holds);
        }
        checker.assert_any_discovery("it begins although somebody was late");
        checker.assert_any_discovery("it begins with a client that had gone");
    } else {
        checker.assert_properties();
    }
    let states = checker.unique_state_count();
    report(format_args!(
        "lobby, {clients} clients, an operator, {strangers} strangers, time runs out {alarms} times: {states} states"
    ));
}

#[test]
fn a_session_that_can_form_forms_and_no_stranger_is_let_in() {
    explore(1, 0, 2);
    explore(1, 1, 0);
}

#[test]
#[ignore = "minutes: run with --ignored"]
fn the_same_with_more_of_all() {
    explore(1, 1, 2);
    explore(2, 0, 2);
}
