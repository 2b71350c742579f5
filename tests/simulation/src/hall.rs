//! Acceptor and seats with connections around them, moved as the TCP lobby and the formation move them, and what must
//! never be.

use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::net::IpAddr;
use std::sync::Arc;
use std::time::Duration;

use onescan_server::access::{Day, Pass, Register, Role, Token};
use onescan_server::client::{ClientId, JoinRequest};
use onescan_server::end::FailureCause;
use onescan_server::lobby::{Acceptor, Action, Now, Registration, Terms, Visitor};
use onescan_server::mailbox::Wish;
use onescan_server::plan::{Coupling, SessionPlan};
use onescan_server::signal::SignalType;
use onescan_server::wire::{ServerMessage, VERSIONS};

use crate::{client, plan, port, span_ms};

/// What the session's `welcome` is said to have.
pub const WELCOME_BYTES: usize = 1 << 10;
/// How many may wait to take part, as `docs/security.md` has it.
const GUESTS_MAX: usize = 64;
/// How many may read their last message at a time.
const LEAVING_MAX: usize = 128;

/// What the other side of a connection has seen of it.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Line {
    /// What the server has said, by kind: `w`elcome, `j`oined, `r`efused, `s`tatus.
    pub heard: String,
    /// The server says no more.
    pub parted: bool,
    /// The server has closed it.
    pub closed: bool,
    /// The other side has closed it.
    pub hung_up: bool,
}

impl Line {
    /// True if the other side need not wait for anything any more.
    pub fn is_settled(&self) -> bool {
        self.parted || self.closed || self.hung_up
    }
}

/// Everything that the lobby is, without its sockets, its clock and its threads.
#[derive(Clone, Debug)]
pub struct Hall {
    pub acceptor: Acceptor,
    pub registration: Registration,
    pub now: Duration,
    pub lines: BTreeMap<Visitor, Line>,
    /// Connections behind which are those who may get in.
    pub let_in: BTreeSet<Visitor>,
    /// What waits for the session's thread.
    pub applications: VecDeque<(Visitor, JoinRequest)>,
    pub wishes: VecDeque<Visitor>,
    /// Who has which seat.
    pub seats: BTreeMap<usize, Visitor>,
    pub is_begun: bool,
    /// Connections that say `hello` as operators, and where they are from.
    pub operators: BTreeMap<Visitor, IpAddr>,
    /// Those of them that may look and do nothing.
    pub lookers: BTreeSet<Visitor>,
    /// Those who begin a frame that is larger than any.
    pub huge: BTreeSet<Visitor>,
    /// Those who begin as TLS does, or nearly, and whether it is TLS.
    pub tls: BTreeMap<Visitor, bool>,
    /// Those who have heard that they speak TLS.
    pub named_tls: BTreeSet<Visitor>,
    /// How many operators there were at most.
    pub operators_most: usize,
    /// The session is over.
    pub is_closing: bool,
    /// Somebody was refused a seat, or has left it.
    pub was_sent_away: bool,
    /// What must not be.
    pub broken: Option<&'static str>,
}

/// A plan of so many clients, each of which writes a signal.
pub fn plan_of(clients: usize) -> SessionPlan {
    let names: Vec<String> = (0..clients).map(|number| format!("c{number}")).collect();
    let signals: Vec<String> = names.iter().map(|name| format!("{name}.out")).collect();
    let declared: Vec<_> =
        signals.iter().zip(&names).map(|(signal, name)| (signal.as_str(), SignalType::BYTE, name.as_str())).collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    plan(span_ms(10), &Coupling::Parallel, &declared, &names)
}

/// The `join` of a client of that plan.
pub fn request(number: usize) -> JoinRequest {
    let (name, signal) = (format!("c{number}"), format!("c{number}.out"));
    let writes = vec![port(&signal, SignalType::BYTE)];
    JoinRequest { name: client(&name), period: span_ms(10), reads: Vec::new(), writes }
}

/// Tokens: one for each client, one for operators, and one of a client that is too old.
pub struct Tokens {
    pub register: Register,
    pub clients: Vec<String>,
    pub operator: String,
    pub viewer: String,
    pub expired: String,
}

impl Tokens {
    /// Tokens for so many clients, called `c0` and so on.
    pub fn new(clients: usize) -> Self {
        let mut register = Register::default();
        let mut made = |name: &str, role: Role, expires: Option<Day>| {
            let token = Token::generate().expect("random numbers");
            let pass = Pass { name: name.to_owned(), role, expires, hash: token.hash() };
            register.add(pass).expect("a name of its own");
            token.reveal().to_owned()
        };
        let clients = (0..clients).map(|number| {
            let name = format!("c{number}");
            made(&name, Role::Client(client(&name)), None)
        });
        let clients = clients.collect();
        let operator = made("operator", Role::Operator, None);
        let viewer = made("viewer", Role::Viewer, None);
        let expired = made("expired", Role::Client(client("c0")), Some(Day::EPOCH));
        Self { register, clients, operator, viewer, expired }
    }
}

/// The day of all that is explored.
pub fn today() -> Day {
    Day::EPOCH.later(1)
}

impl Hall {
    /// Nobody is there yet. A register where tokens are asked for.
    pub fn new(clients: usize, register: Option<&Arc<Register>>) -> Self {
        let plan = plan_of(clients);
        let welcome = ServerMessage::Welcome {
            protocol: VERSIONS.max,
            agent: "hall".to_owned(),
            step: plan.step(),
            frame_bytes_max: 1 << 26,
            signals: plan.signals().to_vec(),
        };
        let terms = Terms { welcome: Arc::new(welcome), welcome_bytes: WELCOME_BYTES, register: register.cloned() };
        Self {
            acceptor: Acceptor::new(terms),
            registration: Registration::new(plan),
            now: Duration::ZERO,
            lines: BTreeMap::new(),
            let_in: BTreeSet::new(),
            applications: VecDeque::new(),
            wishes: VecDeque::new(),
            seats: BTreeMap::new(),
            is_begun: false,
            operators: BTreeMap::new(),
            lookers: BTreeSet::new(),
            huge: BTreeSet::new(),
            tls: BTreeMap::new(),
            named_tls: BTreeSet::new(),
            operators_most: 0,
            is_closing: false,
            was_sent_away: false,
            broken: None,
        }
    }

    fn moment(&self) -> Now {
        Now { at: self.now, today: today() }
    }

    /// Somebody connects; `is_let_in` if it may take part or operate.
    pub fn open(&mut self, visitor: Visitor, address: IpAddr, is_let_in: bool) {
        self.lines.insert(visitor, Line::default());
        if is_let_in {
            self.let_in.insert(visitor);
        }
        let before = self.acceptor.guests();
        let actions = self.acceptor.opened(visitor, address, self.moment());
        if before < GUESTS_MAX && !actions.is_empty() {
            self.broken = Some("somebody is sent away for one who comes, and there is room");
        }
        self.act(actions);
    }

    /// Bytes come over a connection.
    pub fn bytes(&mut self, visitor: Visitor, bytes: &[u8]) {
        let actions = self.acceptor.received(visitor, bytes, self.moment());
        self.act(actions);
    }

    /// The other side closes, in order or by a reset.
    pub fn hang_up(&mut self, visitor: Visitor) {
        if let Some(line) = self.lines.get_mut(&visitor) {
            line.hung_up = true;
        }
        // One that waits for an answer may still hear it; if it is a seat, it is found out that it has gone.
        if self.acceptor.hung_up(visitor) != self.acceptor.knows(visitor) {
            self.broken = Some("one that has hung up is kept, or one that waits is forgotten");
        }
    }

    /// Time passes, to the next deadline of the acceptor at most.
    pub fn pass(&mut self, to: Duration) {
        self.now = to;
        let actions = self.acceptor.clock(self.moment());
        self.act(actions);
        if self.acceptor.next_deadline().is_some_and(|deadline| deadline <= self.now) {
            self.broken = Some("a deadline has passed and nothing came of it");
        }
    }

    /// The session's thread looks at the next application.
    pub fn decide(&mut self) {
        let Some((visitor, request)) = self.applications.pop_front() else { return };
        if self.registration.is_taken(&request) {
            self.notice_gone();
        }
        match self.registration.apply(&request, "somewhere") {
            Err(refusal) => {
                self.was_sent_away = true;
                let actions = self.acceptor.refused(visitor, &refusal.to_string(), self.moment());
                self.act(actions);
            }
            Ok(id) if self.acceptor.seated(visitor) => {
                self.seats.insert(id.index(), visitor);
                self.hear(visitor, 'j');
            }
            Ok(id) => {
                self.was_sent_away = true;
                self.registration.left(id, &FailureCause::Disconnected);
            }
        }
    }

    /// The session's thread finds out which clients have gone since they joined.
    pub fn notice_gone(&mut self) {
        let gone = |visitor: &Visitor| self.lines.get(visitor).is_none_or(|line| line.hung_up);
        let left: Vec<usize> = self.seats.iter().filter(|(_, visitor)| gone(visitor)).map(|(seat, _)| *seat).collect();
        for seat in left {
            self.seats.remove(&seat);
            self.was_sent_away = true;
            if !self.registration.left(ClientId::from_index(seat), &FailureCause::Disconnected) {
                self.broken = Some("a seat is not free again");
            }
        }
    }

    /// The session answers what operators have asked.
    pub fn answer(&mut self) {
        let status = self.registration.session().status();
        while let Some(visitor) = self.wishes.pop_front() {
            let actions = self.acceptor.answered(visitor, Some(Ok(status.clone())), self.moment());
            self.act(actions);
        }
    }

    /// The session begins.
    pub fn begin(&mut self) {
        self.is_begun = true;
        while let Some((visitor, _)) = self.applications.pop_front() {
            let actions = self.acceptor.refused(visitor, "the session has begun", self.moment());
            self.act(actions);
        }
        let actions = self.acceptor.shut(self.moment());
        self.act(actions);
    }

    /// The session is over.
    pub fn close(&mut self) {
        self.is_closing = true;
        let actions = self.acceptor.closing(self.moment());
        self.act(actions);
        while let Some(visitor) = self.wishes.pop_front() {
            let actions = self.acceptor.answered(visitor, None, self.moment());
            self.act(actions);
        }
    }

    fn act(&mut self, actions: Vec<Action>) {
        for action in actions {
            match action {
                Action::Send(visitor, message) => {
                    if matches!(&*message, ServerMessage::Refused { message } if message.contains("TLS")) {
                        self.named_tls.insert(visitor);
                    }
                    self.hear(visitor, kind(&message));
                }
                Action::Apply(visitor, request) => {
                    if self.is_begun {
                        self.broken = Some("somebody applies to a session that has begun");
                    }
                    self.applications.push_back((visitor, request));
                }
                Action::Ask(visitor, wish) => {
                    if self.lookers.contains(&visitor) && matches!(wish, Wish::Do(_)) {
                        self.broken = Some("a viewer operates");
                    }
                    self.wishes.push_back(visitor);
                }
                Action::Part(visitor) => {
                    self.line(visitor).parted = true;
                    if !self.is_closing && !self.line(visitor).heard.ends_with('r') {
                        self.broken = Some("somebody is sent away without a word");
                    }
                    if self.line(visitor).hung_up {
                        self.acceptor.gone(visitor);
                    }
                }
                Action::Close(visitor) => {
                    let leaves = |line: &&Line| line.parted && !line.closed && !line.hung_up;
                    let leaving = self.lines.values().filter(leaves).count();
                    let line = self.line(visitor);
                    line.closed = true;
                    // An operator that has asked nothing for a day is not refused: it is closed.
                    let was_refused = line.heard.ends_with('r') && !line.parted && !line.hung_up;
                    if was_refused && !self.is_closing && leaving < LEAVING_MAX {
                        self.broken = Some("somebody is not given the time to read why it must go");
                    }
                }
            }
        }
    }

    fn line(&mut self, visitor: Visitor) -> &mut Line {
        self.lines.entry(visitor).or_default()
    }

    fn hear(&mut self, visitor: Visitor, what: char) {
        let line = self.line(visitor);
        line.heard.push(what);
        let is_settled = line.parted || line.closed;
        if is_settled {
            self.broken = Some("something is said after the last message");
        }
        if matches!(what, 'j' | 's') && !self.let_in.contains(&visitor) {
            self.broken = Some("a stranger is let in");
        }
    }

    /// What must hold at any time.
    pub fn check(&mut self) {
        let session = self.registration.session();
        for seat in 0..session.plan().clients().len() {
            if session.member(ClientId::from_index(seat)).is_some() != self.seats.contains_key(&seat) {
                self.broken = Some("a seat is lost, or taken by nobody");
            }
        }
        let known =
            |visitor: &Visitor| self.acceptor.knows(*visitor) || self.seats.values().any(|seat| seat == visitor);
        let forgotten = |(visitor, line): &(&Visitor, &Line)| !known(visitor) && !line.closed && !line.hung_up;
        if self.lines.iter().any(|each| forgotten(&each)) {
            self.broken = Some("a connection is forgotten: neither answered nor closed");
        }
        self.check_limits();
    }

    /// What `docs/security.md` says of sessions, written once more.
    fn check_limits(&mut self) {
        if self.acceptor.guests() > GUESTS_MAX {
            self.broken = Some("more than 64 wait to take part");
        }
        let leaves =
            |(visitor, line): &(&Visitor, &Line)| line.parted && !line.closed && self.acceptor.knows(**visitor);
        if self.lines.iter().filter(leaves).count() > LEAVING_MAX {
            self.broken = Some("more than 128 are given the time to read why they must go");
        }
        let is_in = |visitor: &Visitor| {
            let line = &self.lines[visitor];
            line.heard.starts_with('w') && !line.parted && !line.closed && self.acceptor.knows(*visitor)
        };
        let mut of_address: BTreeMap<IpAddr, usize> = BTreeMap::new();
        for (_, address) in self.operators.iter().filter(|(visitor, _)| is_in(visitor)) {
            *of_address.entry(*address).or_default() += 1;
        }
        let all: usize = of_address.values().sum();
        self.operators_most = self.operators_most.max(all);
        if all != self.acceptor.operators() || all > 64 || of_address.values().any(|count| *count > 16) {
            self.broken = Some("places of operators are lost, or there are too many of them");
        }
        let says_no_more = self.lines.iter().filter(|(_, line)| line.parted);
        if says_no_more.into_iter().any(|(visitor, _)| self.acceptor.held_bytes(*visitor) > 0) {
            self.broken = Some("bytes of one that leaves are kept");
        }
    }
}

fn kind(message: &ServerMessage) -> char {
    match message {
        ServerMessage::Welcome { .. } => 'w',
        ServerMessage::Joined { .. } => 'j',
        ServerMessage::Refused { .. } => 'r',
        ServerMessage::Status(_) => 's',
        _ => '?',
    }
}

/// A frame with a message of these words.
pub fn frame(json: &str) -> Vec<u8> {
    let mut bytes = (json.len() as u32 + 1).to_le_bytes().to_vec();
    bytes.push(b'J');
    bytes.extend_from_slice(json.as_bytes());
    bytes
}

/// `hello` as `role`, with a token if there is one.
pub fn hello(role: &str, token: Option<&str>) -> Vec<u8> {
    let token = token.map(|token| format!(r#","token":"{token}""#)).unwrap_or_default();
    frame(&format!(r#"{{"hello":{{"protocol":{{"min":1,"max":1}},"role":"{role}","agent":"a"{token}}}}}"#))
}

/// `join` as a client.
pub fn join(request: &JoinRequest) -> Vec<u8> {
    frame(&format!(r#"{{"join":{}}}"#, serde_json::to_string(request).expect("its own words")))
}
