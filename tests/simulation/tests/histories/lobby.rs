//! Histories of a lobby by a seed: a network with many around it, on virtual time. Messages come in pieces of any length
//! and with any delay, in their order on one connection and in any order between connections; connections break; some are
//! silent, some say half a message, some flood.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};
use std::net::IpAddr;
use std::sync::Arc;
use std::time::Duration;

use onescan_server::access::Register;
use onescan_server::lobby::{Verdict, Visitor};
use onescan_simulation::chance::Chance;
use onescan_simulation::hall::{Hall, Tokens, WELCOME_BYTES, frame, hello, join, request};
use onescan_simulation::histories::{Kind, try_all};

const KIND: Kind = Kind { name: "lobby", few: 3_000, share: 55 };
/// How long the session waits for its clients.
const PATIENCE: Duration = Duration::from_secs(30);
/// How often the session's thread looks up.
const LOOK_UP: Duration = Duration::from_millis(50);
/// Within which all come; where strangers come all at once, these within this.
const ARRIVALS: Duration = Duration::from_secs(10);
const BURST: Duration = Duration::from_millis(300);
/// Most clients of a session.
const CLIENTS_MAX: usize = 4;

/// Who is behind a connection.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Who {
    /// The client of this number; comes again until it takes part.
    Client(usize),
    /// Asks how it is, now and then.
    Operator,
    /// Comes once.
    Stranger(Manner),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Manner {
    /// Says nothing.
    Silent,
    /// Says half a `hello`, and then nothing.
    Half,
    /// Says bytes that mean nothing.
    Garbage,
    /// Wants to be a client that is not expected, or one whose token it has not.
    Pretender,
    /// Says `hello` as a client, and then nothing.
    Hesitant,
    /// An operator that never asks.
    Idle,
    /// Says everything at once and does not wait for answers.
    Hasty,
    /// The words of a client with its token and, in the same piece, more than it may say.
    Eager,
    /// An operator with a viewer's token, or a frame that is larger than any.
    Looker,
    Huge,
}

const MANNERS: [Manner; 10] = [
    Manner::Silent,
    Manner::Half,
    Manner::Garbage,
    Manner::Pretender,
    Manner::Hesitant,
    Manner::Idle,
    Manner::Hasty,
    Manner::Eager,
    Manner::Looker,
    Manner::Huge,
];

#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Event {
    Comes(usize),
    Bytes(Visitor, Vec<u8>),
    /// Whoever is behind it looks at what it has heard.
    Looks(Visitor),
    HangsUp(Visitor),
    /// The session's thread looks up.
    LookUp,
}

/// One history.
struct History<'t> {
    hall: Hall,
    chance: Chance,
    tokens: &'t Tokens,
    asks_tokens: bool,
    clients: usize,
    /// The client that never comes, if one does not.
    absent: Option<usize>,
    people: Vec<Who>,
    /// Until when strangers come all at once, if they do.
    burst: Option<Duration>,
    /// From how many addresses strangers come.
    addresses: u8,
    /// When each connection was opened.
    opened: BTreeMap<Visitor, Duration>,
    behind: BTreeMap<Visitor, usize>,
    /// When the last bytes of a connection come: its own stay in their order.
    last: BTreeMap<Visitor, Duration>,
    events: BinaryHeap<Reverse<(Duration, u64, Event)>>,
    number: u64,
    visitors: u64,
    verdict: Option<(Duration, Verdict)>,
}

impl<'t> History<'t> {
    fn new(seed: u64, tokens: &'t Tokens, registers: &[Arc<Register>]) -> Self {
        let mut chance = Chance::new(seed);
        let clients = 1 + chance.below(CLIENTS_MAX as u64) as usize;
        let asks_tokens = chance.one_in(2);
        let hall = Hall::new(clients, asks_tokens.then(|| &registers[0]));
        let absent = chance.one_in(8).then(|| chance.below(clients as u64) as usize);
        let mut people: Vec<Who> = (0..clients).map(Who::Client).collect();
        people.extend((0..chance.below(4)).map(|_| Who::Operator));
        let is_crowd = chance.one_in(16);
        let burst = (is_crowd && chance.one_in(4)).then_some(BURST);
        let strangers = if is_crowd { 60 + chance.below(200) } else { chance.below(12) };
        // Half of the crowds have come for the places of operators.
        let manner = match chance.below(6) {
            0 | 1 => Some(MANNERS[chance.below(10) as usize]),
            2 | 3 if is_crowd => Some(if chance.one_in(2) { Manner::Idle } else { Manner::Hasty }),
            _ => None,
        };
        let addresses = 1 + chance.below(6) as u8;
        for _ in 0..strangers {
            let own = MANNERS[chance.below(10) as usize];
            people.push(Who::Stranger(manner.unwrap_or(own)));
        }
        let (events, last, behind) = (BinaryHeap::new(), BTreeMap::new(), BTreeMap::new());
        let mut history = Self {
            hall,
            chance,
            tokens,
            asks_tokens,
            clients,
            absent,
            people,
            burst,
            addresses,
            opened: BTreeMap::new(),
            behind,
            last,
            events,
            number: 0,
            visitors: 0,
            verdict: None,
        };
        for index in 0..history.people.len() {
            let who = history.people[index];
            if who != Who::Client(absent.unwrap_or(usize::MAX)) {
                let within = history.burst.filter(|_| matches!(who, Who::Stranger(_))).unwrap_or(ARRIVALS);
                let at = history.chance.within_ms(within.as_millis() as u64);
                history.at(at, Event::Comes(index));
            }
        }
        history.at(LOOK_UP, Event::LookUp);
        history
    }

    fn at(&mut self, at: Duration, event: Event) {
        self.number += 1;
        self.events.push(Reverse((at, self.number, event)));
    }

    /// Sends bytes in pieces, with the delays of a network.
    fn send(&mut self, visitor: Visitor, mut bytes: &[u8]) {
        let mut at = self.hall.now.max(self.last.get(&visitor).copied().unwrap_or_default());
        while !bytes.is_empty() {
            let all = self.chance.one_in(2);
            let length = if all { bytes.len() } else { 1 + self.chance.below(bytes.len() as u64) as usize };
            let (piece, rest) = bytes.split_at(length);
            at += self.chance.within_ms(200);
            self.at(at, Event::Bytes(visitor, piece.to_vec()));
            bytes = rest;
        }
        self.last.insert(visitor, at);
        let looks = at + self.chance.within_ms(200) + Duration::from_millis(1);
        self.at(looks, Event::Looks(visitor));
    }

    fn token(&self, who: Who) -> Option<&'t str> {
        match who {
            Who::Client(number) if self.asks_tokens => Some(&self.tokens.clients[number]),
            Who::Operator if self.asks_tokens => Some(&self.tokens.operator),
            _ => None,
        }
    }

    fn comes(&mut self, index: usize) {
        let visitor = Visitor(self.visitors);
        self.visitors += 1;
        self.behind.insert(visitor, index);
        self.opened.insert(visitor, self.hall.now);
        let who = self.people[index];
        // A crowd has a few addresses.
        let from = if matches!(who, Who::Stranger(_)) { 9 + index as u8 % self.addresses } else { 1 };
        let address = IpAddr::from([10, 0, 0, from]);
        let is_let_in = match who {
            Who::Client(_) | Who::Operator | Who::Stranger(Manner::Looker) => true,
            Who::Stranger(manner) => !self.asks_tokens && matches!(manner, Manner::Idle | Manner::Hasty),
        };
        self.hall.open(visitor, address, is_let_in);
        let operates = matches!(who, Who::Operator | Who::Stranger(Manner::Idle | Manner::Hasty | Manner::Looker));
        let role = if operates { "operator" } else { "client" };
        if operates {
            self.hall.operators.insert(visitor, address);
        }
        let greeting = hello(role, self.token(who));
        match who {
            Who::Stranger(Manner::Silent) => {}
            Who::Stranger(Manner::Half) => self.send(visitor, &greeting[..greeting.len() / 2]),
            Who::Stranger(Manner::Garbage) if self.chance.one_in(3) => {
                let (content, version) = (0x14 + self.chance.below(4) as u8, self.chance.below(9) as u8);
                let major = if self.chance.one_in(8) { 6 } else { 3 };
                self.hall.tls.insert(visitor, content == 0x16 && major == 3 && (1..=4).contains(&version));
                let hello = [&[content, major, version], &[0; 61][..]].concat();
                self.at(self.hall.now, Event::Bytes(visitor, hello));
            }
            Who::Stranger(Manner::Garbage) => {
                let garbage: Vec<u8> = (0..64).map(|_| self.chance.number() as u8).collect();
                self.send(visitor, &garbage);
            }
            Who::Stranger(Manner::Pretender) => {
                let stolen = match self.chance.below(3) {
                    0 => None,
                    1 => Some(self.tokens.expired.as_str()),
                    _ => Some(self.tokens.operator.as_str()),
                };
                // Where nobody asks for tokens, whoever has a client's name and ports is that client.
                let number = if self.asks_tokens { 0 } else { CLIENTS_MAX };
                self.send(visitor, &[hello("client", stolen), join(&request(number))].concat());
            }
            Who::Stranger(Manner::Eager) => {
                let token = self.asks_tokens.then(|| self.tokens.clients[0].as_str());
                let all = [hello("client", token), join(&request(0)), frame(r#"{"status":{}}"#)].concat();
                self.at(self.hall.now, Event::Bytes(visitor, all));
            }
            Who::Stranger(Manner::Looker) => {
                let token = self.asks_tokens.then(|| {
                    self.hall.lookers.insert(visitor);
                    self.tokens.viewer.as_str()
                });
                self.send(visitor, &[hello("operator", token), frame(r#"{"control":"pause"}"#)].concat());
            }
            Who::Stranger(Manner::Huge) => {
                self.hall.huge.insert(visitor);
                let head = [&8_000_000_u32.to_le_bytes()[..], b"J{"].concat();
                let token = self.asks_tokens.then(|| self.tokens.clients[0].as_str());
                let all = if self.chance.one_in(2) { head } else { [hello("client", token), head].concat() };
                self.at(self.hall.now, Event::Bytes(visitor, all));
            }
            Who::Stranger(Manner::Hasty) => {
                let wishes = frame(r#"{"status":{}}"#).repeat(3);
                self.send(visitor, &[greeting, wishes].concat());
            }
            _ => self.send(visitor, &greeting),
        }
        if matches!(who, Who::Stranger(_)) && self.chance.one_in(3) || self.chance.one_in(20) {
            let breaks = self.hall.now + self.chance.within_ms(8_000);
            self.at(breaks, Event::HangsUp(visitor));
        }
    }

    /// Whoever is behind a connection reads what has come, and goes on.
    fn looks(&mut self, visitor: Visitor) {
        let (Some(line), Some(&index)) = (self.hall.lines.get(&visitor).cloned(), self.behind.get(&visitor)) else {
            return;
        };
        let who = self.people[index];
        if line.hung_up {
            return;
        }
        if line.parted || line.closed {
            self.hall.hang_up(visitor);
            if let Who::Client(_) = who {
                let again = self.hall.now + self.chance.within_ms(500);
                self.at(again, Event::Comes(index));
            }
            return;
        }
        match (who, line.heard.as_str()) {
            (Who::Client(number), "w") => self.send(visitor, &join(&request(number))),
            (Who::Client(_), "wj") => {}
            (Who::Operator, heard) if heard.ends_with(['w', 's']) && heard.len() < 4 => {
                self.send(visitor, &frame(r#"{"status":{}}"#));
            }
            _ => {
                let later = self.hall.now + Duration::from_millis(300);
                self.at(later, Event::Looks(visitor));
            }
        }
    }

    fn hangs_up(&mut self, visitor: Visitor) {
        let settled = self.hall.lines.get(&visitor).is_none_or(|line| line.closed || line.hung_up);
        if settled || self.hall.is_begun {
            return;
        }
        self.hall.hang_up(visitor);
        if let Some(&index) = self.behind.get(&visitor)
            && let Who::Client(_) = self.people[index]
        {
            let again = self.hall.now + self.chance.within_ms(500);
            self.at(again, Event::Comes(index));
        }
    }

    /// The session's thread: as `Formation::admit_from` does it.
    fn look_up(&mut self) {
        self.hall.notice_gone();
        self.hall.answer();
        self.hall.decide();
        let verdict = self.hall.registration.verdict(self.hall.now, PATIENCE);
        match verdict {
            Verdict::Waiting => {
                let soon =
                    self.hall.now + if self.hall.applications.is_empty() { LOOK_UP } else { Duration::from_micros(50) };
                self.at(soon, Event::LookUp);
            }
            verdict => {
                self.hall.notice_gone();
                if verdict == Verdict::Complete && !self.hall.registration.is_complete() {
                    let soon = self.hall.now + LOOK_UP;
                    return self.at(soon, Event::LookUp);
                }
                self.verdict = Some((self.hall.now, verdict));
                self.hall.begin();
            }
        }
    }

    /// Runs to the end; what was wrong.
    fn run(mut self) -> Result<u64, String> {
        while let Some(Reverse((at, _, event))) = self.events.pop() {
            while let Some(deadline) = self.hall.acceptor.next_deadline().filter(|deadline| *deadline <= at) {
                self.hall.pass(deadline.max(self.hall.now));
            }
            self.hall.now = at;
            if self.verdict.as_ref().is_some_and(|(since, _)| at > *since + Duration::from_secs(5)) {
                break;
            }
            match event {
                Event::Comes(index) => self.comes(index),
                Event::Bytes(visitor, bytes) => {
                    if let Some(before) = self.hall.lines.get(&visitor).filter(|line| !line.hung_up && !line.closed) {
                        let was_settled = before.is_settled();
                        self.hall.bytes(visitor, &bytes);
                        let line = &self.hall.lines[&visitor];
                        let (is_tls, named) = (self.hall.tls.get(&visitor), self.hall.named_tls.contains(&visitor));
                        if is_tls.is_some_and(|is_tls| *is_tls != named) && !was_settled {
                            return Err(format!("{:?} hears that it speaks TLS: {named}", &bytes[..3]));
                        }
                        if self.hall.huge.contains(&visitor) && !line.is_settled() {
                            return Err("a frame that is larger than any is waited for".to_owned());
                        }
                    }
                }
                Event::Looks(visitor) => self.looks(visitor),
                Event::HangsUp(visitor) => self.hangs_up(visitor),
                Event::LookUp => self.look_up(),
            }
            self.hall.check();
            if let Some(broken) = self.hall.broken {
                return Err(broken.to_owned());
            }
        }
        self.judge()
    }

    /// Operators have their place if there is one, and an answer to each of their questions, however they are asked.
    fn operators_are_served(&self) -> Result<(), String> {
        for (visitor, index) in &self.behind {
            let (line, who) = (&self.hall.lines[visitor], self.people[*index]);
            let (opened, last) = (self.opened[visitor], self.last.get(visitor).copied().unwrap_or_default());
            // Whoever is slow, and whoever comes when all places are taken, may be sent away; the last bytes may be on their way.
            let is_slow = last > opened + Duration::from_secs(1) || last >= self.hall.now;
            let is_in_burst = self.burst.is_some_and(|until| opened < until);
            if who == Who::Operator
                && line.heard.starts_with('r')
                && !is_slow
                && !is_in_burst
                && self.hall.operators_most < 64
            {
                return Err("an operator is sent away, and there is room".to_owned());
            }
            let waits = self.hall.wishes.contains(visitor);
            if who == Who::Stranger(Manner::Hasty)
                && line.heard.starts_with('w')
                && !line.is_settled()
                && !is_slow
                && !waits
            {
                let answers = line.heard.matches('s').count();
                if answers != 3 {
                    return Err(format!("an operator has asked three times, and has {answers} answers"));
                }
            }
        }
        Ok(())
    }

    fn judge(mut self) -> Result<u64, String> {
        let Some((when, verdict)) = self.verdict.take() else { return Err("the session is stuck".to_owned()) };
        match (&verdict, self.absent) {
            (Verdict::Complete, None) => {}
            (Verdict::TooLate { sent_away }, Some(_)) if when < PATIENCE + 2 * LOOK_UP => {
                if sent_away.is_some() != self.hall.was_sent_away {
                    return Err(format!("{sent_away:?} is said of those who were sent away"));
                }
            }
            _ => return Err(format!("{verdict:?} after {when:?}, absent: {:?}", self.absent)),
        }
        if verdict == Verdict::Complete && self.hall.seats.len() != self.clients {
            return Err("a seat is lost".to_owned());
        }
        if self.hall.registration.verdict(PATIENCE, PATIENCE) == Verdict::Waiting {
            return Err("it is waited for longer than there is patience".to_owned());
        }
        self.operators_are_served()?;
        self.hall.close();
        self.hall.pass(self.hall.now + Duration::from_secs(1));
        match (self.hall.broken, self.hall.acceptor.connections()) {
            (Some(broken), _) => Err(broken.to_owned()),
            (None, 0) => Ok(self.visitors),
            (None, left) => Err(format!("{left} connections are left when all is over")),
        }
    }
}

/// A `join` may have 1 MiB plus twice the length of `welcome`: a client may name every signal that the server has listed.
#[test]
fn a_join_may_be_as_long_as_the_session_needs_and_no_longer() {
    const LONGEST: usize = (1 << 20) + 2 * WELCOME_BYTES;
    for (length, heard) in [(LONGEST, "w"), (LONGEST + 1, "wr")] {
        let (mut hall, visitor) = (Hall::new(1, None), Visitor(0));
        hall.open(visitor, IpAddr::from([10, 0, 0, 1]), true);
        hall.bytes(visitor, &hello("client", None));
        let mut words = join(&request(0)).split_off(5);
        // Blanks between words say nothing; a frame has its type before them.
        words.resize(length - 1, b' ');
        hall.bytes(visitor, &frame(std::str::from_utf8(&words).expect("text")));
        assert_eq!((hall.lines[&visitor].heard.as_str(), hall.broken), (heard, None), "{length} bytes");
        assert_eq!(hall.applications.len(), usize::from(length == LONGEST));
    }
}

/// An operator that waits for an answer may send what it asks next, up to the length of a frame.
#[test]
fn an_operator_of_the_lobby_may_ask_ahead_and_not_without_end() {
    const LONGEST: usize = (1 << 20) + 2 * WELCOME_BYTES;
    for (length, heard) in [(LONGEST, "w"), (LONGEST + 1, "wr")] {
        let (mut hall, visitor) = (Hall::new(1, None), Visitor(0));
        hall.open(visitor, IpAddr::from([10, 0, 0, 1]), true);
        hall.bytes(visitor, &hello("operator", None));
        hall.bytes(visitor, &frame(r#"{"status":{}}"#));
        hall.bytes(visitor, &vec![b' '; length]);
        assert_eq!((hall.lines[&visitor].heard.as_str(), hall.broken), (heard, None), "{length} bytes");
    }
}

#[test]
fn a_lobby_lets_in_whom_it_must() {
    let tokens = Tokens::new(CLIENTS_MAX);
    // The names of the smaller sessions are among those of the largest.
    let registers = [Arc::new(tokens.register.clone())];
    try_all(KIND, |seed| History::new(seed, &tokens, &registers).run());
}
