//! The acceptor: connections, from the first byte until they take part, ask as operators, or are sent away.

use std::collections::BTreeMap;
use std::hash::{Hash, Hasher};
use std::net::IpAddr;
use std::sync::Arc;
use std::time::Duration;

use onescan_base::foreign::one_line;
use onescan_base::repeated::Repeated;

use super::places::Places;
use super::visitor::{Connection, Said, Stage};
use crate::access::{Day, Holder, Register, Role as Right, TokenRefusal};
use crate::client::JoinRequest;
use crate::mailbox::Wish;
use crate::wire::message::{Role, Status};
use crate::wire::{ClientMessage, FRAME_BYTES_MAX, HANDSHAKE_FRAME_BYTES_MAX, ServerMessage, VERSIONS, VersionRange};

/// Connections that may be there at once before they take part or are operators.
pub const GUESTS_MAX: usize = 64;
/// Connections that may take their time to close after a last message; the others are closed at once.
pub const LEAVING_MAX: usize = 128;

/// How long a connection may take for a message of the handshake.
pub const HANDSHAKE_TIMEOUT: Duration = Duration::from_secs(5);
/// How long it may take to close after a last message.
pub const CLOSE_TIMEOUT: Duration = Duration::from_secs(1);
/// How long an operator may be silent.
const OPERATOR_PATIENCE: Duration = Duration::from_hours(24);

static SENT_AWAY: Repeated = Repeated::new();

/// The refusal of whoever comes when the session has begun.
pub const BEGUN: &str = "the session has begun: nobody can join any more";

/// One connection, by its number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Visitor(pub u64);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Now {
    /// How long the lobby has been open.
    pub at: Duration,
    /// The day of the calendar, for tokens.
    pub today: Day,
}

/// What holds for everybody who comes.
#[derive(Clone, Debug)]
pub struct Terms {
    /// The answer to a `hello` that is in order.
    pub welcome: Arc<ServerMessage>,
    /// Its bytes: a `join` may name all signals of it twice.
    pub welcome_bytes: usize,
    /// Tokens, if nobody is let in without.
    pub register: Option<Arc<Register>>,
}

/// What is to be done, in this order.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Action {
    Send(Visitor, Arc<ServerMessage>),
    /// Give this client a seat or refuse it; then say so with [`Acceptor::seated`] or [`Acceptor::refused`].
    Apply(Visitor, JoinRequest),
    /// Ask the session for this, or only how it is; then say so with [`Acceptor::answered`].
    Ask(Visitor, Wish),
    /// Send no more, and read until the other side closes.
    Part(Visitor),
    Close(Visitor),
}

/// All connections that do not take part.
#[derive(Clone, Debug)]
pub struct Acceptor {
    terms: Terms,
    connections: BTreeMap<Visitor, Connection>,
    places: Places,
    /// The session has begun.
    is_shut: bool,
    /// The session is over.
    is_closing: bool,
}

impl Hash for Acceptor {
    fn hash<H: Hasher>(&self, hasher: &mut H) {
        for (visitor, connection) in &self.connections {
            (visitor, connection.key()).hash(hasher);
        }
        (&self.places, self.is_shut, self.is_closing).hash(hasher);
    }
}

impl PartialEq for Acceptor {
    /// Of two receptions with the same terms.
    fn eq(&self, other: &Self) -> bool {
        let connections = self.connections.iter().map(|(visitor, connection)| (visitor, connection.key()));
        connections.eq(other.connections.iter().map(|(visitor, connection)| (visitor, connection.key())))
            && (&self.places, self.is_shut, self.is_closing) == (&other.places, other.is_shut, other.is_closing)
    }
}

impl Eq for Acceptor {}

impl Acceptor {
    /// Nobody is there.
    pub fn new(terms: Terms) -> Self {
        Self { terms, connections: BTreeMap::new(), places: Places::default(), is_shut: false, is_closing: false }
    }

    /// How many connections there are.
    pub fn connections(&self) -> usize {
        self.connections.len()
    }

    /// How many operators are in.
    pub fn operators(&self) -> usize {
        self.places.taken()
    }

    /// How many connections neither take part, nor operate, nor leave.
    pub fn guests(&self) -> usize {
        self.connections.values().filter(|connection| connection.is_guest()).count()
    }

    /// Bytes of a connection that have come and have not been understood yet.
    pub fn held_bytes(&self, visitor: Visitor) -> usize {
        self.connections.get(&visitor).map_or(0, Connection::held_bytes)
    }

    /// True if the connection is known here.
    pub fn knows(&self, visitor: Visitor) -> bool {
        self.connections.contains_key(&visitor)
    }

    /// When the connection's stage ends whatever happens.
    pub fn deadline_of(&self, visitor: Visitor) -> Option<Duration> {
        self.connections.get(&visitor)?.until
    }

    /// When [`clock`](Self::clock) has something to do, if nothing else happens.
    pub fn next_deadline(&self) -> Option<Duration> {
        self.connections.values().filter_map(|connection| connection.until).min()
    }

    /// A connection was opened.
    pub fn opened(&mut self, visitor: Visitor, address: IpAddr, now: Now) -> Vec<Action> {
        let mut actions = Vec::new();
        self.connections.insert(visitor, Connection::new(address, now.at + HANDSHAKE_TIMEOUT));
        if self.guests() > GUESTS_MAX {
            let slowest = self.slowest();
            self.refuse(slowest, "too many connections are waiting in the lobby", now, &mut actions);
        }
        actions
    }

    /// A connection has shown a certificate that is good.
    pub fn certified(&mut self, visitor: Visitor, holder: Holder) {
        if let Some(connection) =
            self.connections.get_mut(&visitor).filter(|connection| connection.stage == Stage::Greeting)
        {
            connection.holder = Some(holder);
        }
    }

    /// Who has been silent the longest: a client that means to join speaks at once, and is not kept out by those who do
    /// not. The one who came last if all others have done their part.
    fn slowest(&self) -> Visitor {
        let silent = |stage: &Stage| matches!(stage, Stage::Greeting | Stage::Applying);
        let waits = self.connections.iter().filter(|(_, connection)| silent(&connection.stage));
        let slowest = waits.min_by_key(|(visitor, connection)| (connection.until, **visitor));
        // There is one at least: who has just come.
        debug_assert!(slowest.is_some(), "who has just come is silent");
        slowest.map_or(Visitor(0), |(visitor, _)| *visitor)
    }

    /// Bytes came.
    pub fn received(&mut self, visitor: Visitor, bytes: &[u8], now: Now) -> Vec<Action> {
        let mut actions = Vec::new();
        let Some(connection) = self.connections.get_mut(&visitor) else { return actions };
        if connection.stage != Stage::Leaving {
            connection.take_in(bytes);
        }
        match connection.stage {
            Stage::Greeting if connection.speaks_tls() => {
                self.refuse(visitor, "it speaks TLS, and this session has no certificate", now, &mut actions);
            }
            Stage::Waiting => {
                self.refuse(visitor, "a client must wait for the answer to `join`", now, &mut actions);
            }
            Stage::Asking if connection.says_too_much() => {
                self.refuse(visitor, "an operator must wait for the answer to what it asked", now, &mut actions);
            }
            _ => self.read(visitor, now, &mut actions),
        }
        actions
    }

    /// Looks at what a connection has said, as far as it is its turn to speak.
    fn read(&mut self, visitor: Visitor, now: Now, actions: &mut Vec<Action>) {
        while let Some(connection) = self.connections.get_mut(&visitor) {
            if !matches!(connection.stage, Stage::Greeting | Stage::Applying | Stage::Operating) {
                return;
            }
            let message = match connection.next() {
                Said::Nothing => return,
                Said::Nonsense(why) => return self.refuse(visitor, &why, now, actions),
                Said::Message(message) => message,
            };
            match connection.stage {
                Stage::Greeting => self.greet(visitor, message, now, actions),
                Stage::Applying => self.apply(visitor, message, now, actions),
                Stage::Operating => self.ask(visitor, message, now, actions),
                Stage::Waiting | Stage::Asking | Stage::Leaving => {}
            }
        }
    }

    fn greet(&mut self, visitor: Visitor, message: ClientMessage, now: Now, actions: &mut Vec<Action>) {
        let ClientMessage::Hello { protocol, role, agent, token } = message else {
            return self.refuse(visitor, "the first message must be `hello`", now, actions);
        };
        tracing::debug!(?visitor, %agent, ?role, "hello");
        if let Err(why) = self.let_in(visitor, protocol, role, &agent, token.as_deref(), now) {
            return self.refuse(visitor, &why, now, actions);
        }
        if role == Role::Operator && !self.give_place(visitor, now, actions) {
            return self.refuse(visitor, "too many operators are connected", now, actions);
        }
        let Some(connection) = self.connections.get_mut(&visitor) else { return };
        connection.set_limit((HANDSHAKE_FRAME_BYTES_MAX + 2 * self.terms.welcome_bytes).min(FRAME_BYTES_MAX));
        (connection.stage, connection.until) = match role {
            Role::Client => (Stage::Applying, Some(now.at + HANDSHAKE_TIMEOUT)),
            Role::Operator => (Stage::Operating, Some(now.at + OPERATOR_PATIENCE)),
        };
        actions.push(Action::Send(visitor, Arc::clone(&self.terms.welcome)));
    }

    /// Whether somebody may go on after `hello`, or why not.
    fn let_in(
        &mut self,
        visitor: Visitor,
        protocol: VersionRange,
        role: Role,
        agent: &str,
        token: Option<&str>,
        now: Now,
    ) -> Result<(), String> {
        if VERSIONS.common(protocol).is_none() {
            return Err(format!(
                "no common protocol version: this server speaks {VERSIONS}, {agent} speaks {protocol}"
            ));
        }
        let Some(connection) = self.connections.get_mut(&visitor) else { return Ok(()) };
        // Who has shown a certificate needs no token.
        let holder = match (connection.holder.take(), &self.terms.register) {
            (Some(certified), _) => Some(certified.admitted(role)),
            (None, Some(register)) => Some(register.admit(token, role, now.today)),
            (None, None) => None,
        };
        connection.holder = holder.transpose().map_err(|refusal| refusal.to_string())?;
        Ok(())
    }

    /// Gives an operator a place. Where there is none, one of the same address that has never asked gives way, the first that came.
    fn give_place(&mut self, visitor: Visitor, now: Now, actions: &mut Vec<Action>) -> bool {
        let Some(address) = self.connections.get(&visitor).map(|connection| connection.address) else { return false };
        if self.places.take(address) {
            return true;
        }
        let idle = |connection: &Connection| {
            connection.address == address && connection.stage == Stage::Operating && !connection.has_asked
        };
        let Some(first) = self.connections.iter().find(|(_, connection)| idle(connection)).map(|(idle, _)| *idle)
        else {
            return false;
        };
        self.refuse(first, "another operator has come, and this one has asked nothing", now, actions);
        self.places.take(address)
    }

    fn apply(&mut self, visitor: Visitor, message: ClientMessage, now: Now, actions: &mut Vec<Action>) {
        let ClientMessage::Join(request) = message else {
            return self.refuse(visitor, "the second message of a client must be `join`", now, actions);
        };
        let Some(connection) = self.connections.get_mut(&visitor) else { return };
        if connection.has_more() {
            return self.refuse(visitor, "a client must wait for the answer to `join`", now, actions);
        }
        if let Some(holder) = &connection.holder
            && holder.role != Right::Client(request.name.clone())
        {
            let Holder { name, role, proof } = holder.clone();
            let refusal = TokenRefusal::OtherClient { proof, name, role, wanted: request.name };
            return self.refuse(visitor, &refusal.to_string(), now, actions);
        }
        if self.is_shut {
            return self.refuse(visitor, BEGUN, now, actions);
        }
        (connection.stage, connection.until) = (Stage::Waiting, None);
        actions.push(Action::Apply(visitor, request));
    }

    fn ask(&mut self, visitor: Visitor, message: ClientMessage, now: Now, actions: &mut Vec<Action>) {
        let wish = match message {
            ClientMessage::Control(control) => Wish::Do(control.into()),
            ClientMessage::Operate(operation) => Wish::Do(operation),
            ClientMessage::Status { signals } => Wish::Look(signals),
            _ => return self.refuse(visitor, "an operator may send `control`, `operate` and `status`", now, actions),
        };
        let Some(connection) = self.connections.get_mut(&visitor) else { return };
        if let Some(holder) = &connection.holder
            && matches!(wish, Wish::Do(_))
            && !holder.role.operates()
        {
            let refusal = TokenRefusal::LooksOnly { proof: holder.proof, name: holder.name.clone() };
            return self.refuse(visitor, &refusal.to_string(), now, actions);
        }
        (connection.stage, connection.until, connection.has_asked) = (Stage::Asking, None, true);
        actions.push(Action::Ask(visitor, wish));
    }

    /// A client gets its seat, and its connection goes over to the session; false if it waits for none any more.
    pub fn seated(&mut self, visitor: Visitor) -> bool {
        let waits = self.connections.get(&visitor).is_some_and(|connection| connection.stage == Stage::Waiting);
        if waits {
            self.connections.remove(&visitor);
        }
        waits
    }

    /// Somebody is sent away: a client that got no seat, or one who does not speak TLS where it must.
    pub fn refused(&mut self, visitor: Visitor, why: &str, now: Now) -> Vec<Action> {
        let mut actions = Vec::new();
        if self.knows(visitor) {
            self.refuse(visitor, why, now, &mut actions);
        }
        actions
    }

    /// The session has answered an operator: how it is, or why it does not do what was asked; nothing if it is over.
    pub fn answered(&mut self, visitor: Visitor, answer: Option<Result<Status, String>>, now: Now) -> Vec<Action> {
        let mut actions = Vec::new();
        let Some(connection) =
            self.connections.get_mut(&visitor).filter(|connection| connection.stage == Stage::Asking)
        else {
            return actions;
        };
        match answer {
            Some(Ok(status)) => {
                (connection.stage, connection.until) = (Stage::Operating, Some(now.at + OPERATOR_PATIENCE));
                actions.push(Action::Send(visitor, Arc::new(ServerMessage::Status(status))));
                if self.is_closing {
                    self.part(visitor, now, &mut actions);
                } else {
                    self.read(visitor, now, &mut actions);
                }
            }
            Some(Err(why)) => self.refuse(visitor, &why, now, &mut actions),
            None => self.part(visitor, now, &mut actions),
        }
        actions
    }

    /// The other side says no more. One that waits for an answer may still read it; false if nobody is there any more.
    pub fn hung_up(&mut self, visitor: Visitor) -> bool {
        let waits = |connection: &Connection| matches!(connection.stage, Stage::Waiting | Stage::Asking);
        let stays = self.connections.get(&visitor).is_some_and(waits);
        if !stays {
            self.gone(visitor);
        }
        stays
    }

    /// The other side has closed, or the connection has broken.
    pub fn gone(&mut self, visitor: Visitor) {
        if let Some(connection) = self.connections.remove(&visitor) {
            self.free_place(&connection);
        }
    }

    /// Time has passed: who has had time enough is sent away.
    pub fn clock(&mut self, now: Now) -> Vec<Action> {
        let mut actions = Vec::new();
        let late = |connection: &Connection| connection.until.is_some_and(|until| until <= now.at);
        let late: Vec<_> = self
            .connections
            .iter()
            .filter(|(_, connection)| late(connection))
            .map(|(v, g)| (*v, g.stage.clone()))
            .collect();
        for (visitor, stage) in late {
            match stage {
                Stage::Greeting | Stage::Applying => {
                    let why = format!("no answer within {} ms", HANDSHAKE_TIMEOUT.as_millis());
                    self.refuse(visitor, &why, now, &mut actions);
                }
                _ => self.close(visitor, &mut actions),
            }
        }
        actions
    }

    /// The session begins: who comes later, or still waits for a seat, hears that.
    pub fn shut(&mut self, now: Now) -> Vec<Action> {
        self.is_shut = true;
        let mut actions = Vec::new();
        for visitor in self.all_in(&[Stage::Waiting]) {
            self.refuse(visitor, BEGUN, now, &mut actions);
        }
        actions
    }

    /// The session is over. Who waits for an answer, or for the other side to close, is waited for; nobody else.
    pub fn closing(&mut self, now: Now) -> Vec<Action> {
        let mut actions = self.shut(now);
        self.is_closing = true;
        for visitor in self.all_in(&[Stage::Greeting, Stage::Applying, Stage::Operating]) {
            self.close(visitor, &mut actions);
        }
        actions
    }

    fn all_in(&self, stages: &[Stage]) -> Vec<Visitor> {
        self.connections
            .iter()
            .filter(|(_, connection)| stages.contains(&connection.stage))
            .map(|(visitor, _)| *visitor)
            .collect()
    }

    /// Says why, then parts.
    fn refuse(&mut self, visitor: Visitor, why: &str, now: Now, actions: &mut Vec<Action>) {
        debug_assert!(self.knows(visitor), "only who is there can be sent away");
        let message = one_line(why).into_owned();
        // Each of them hears why; the log does not grow with those who come.
        if let Some(times) = SENT_AWAY.again() {
            tracing::warn!(?visitor, why = %message, "sent away{times}");
        } else {
            tracing::debug!(?visitor, why = %message, "sent away");
        }
        actions.push(Action::Send(visitor, Arc::new(ServerMessage::Refused { message })));
        self.part(visitor, now, actions);
    }

    /// The other side gets the time to read the last message; not where too many do.
    fn part(&mut self, visitor: Visitor, now: Now, actions: &mut Vec<Action>) {
        if self.connections.values().filter(|connection| connection.stage == Stage::Leaving).count() >= LEAVING_MAX {
            return self.close(visitor, actions);
        }
        let Some(connection) = self.connections.get_mut(&visitor) else { return };
        connection.turn_deaf();
        let had_place = matches!(connection.stage, Stage::Operating | Stage::Asking).then_some(connection.address);
        (connection.stage, connection.until) = (Stage::Leaving, Some(now.at + CLOSE_TIMEOUT));
        if let Some(address) = had_place {
            self.places.give_back(address);
        }
        actions.push(Action::Part(visitor));
    }

    fn close(&mut self, visitor: Visitor, actions: &mut Vec<Action>) {
        self.gone(visitor);
        actions.push(Action::Close(visitor));
    }

    fn free_place(&mut self, connection: &Connection) {
        if matches!(connection.stage, Stage::Operating | Stage::Asking) {
            self.places.give_back(connection.address);
        }
    }
}
