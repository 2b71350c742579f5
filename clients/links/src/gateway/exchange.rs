//! What is exchanged with a PLC: signals and synchronisation words in their order, as packed bytes.
//!
//! Both directions are ports as a session has them: little-endian, unpadded. To the PLC go the inputs and then
//! the words, the grant last, so that a link that writes one value after the other writes it last. From the
//! PLC come the words first and then the outputs, so that outputs are never older than the `SDSP_Done` before them.

use std::collections::BTreeMap;

use onescan_server::signal::{Port, SignalType};
use onescan_server::time::VirtualTime;

use super::answer::Answer;
use super::fault::MappingFault;
use super::handshake::{Order, Report};

/// Which way a point goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// The gateway writes it.
    ToPlc,
    /// The gateway reads it.
    FromPlc,
}

/// A signal, and the points at which a PLC takes part in it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Feed {
    /// The signal as the session has it.
    pub port: Port,
    /// Its points: several for a signal that several variables of the PLC read.
    pub targets: Vec<Target>,
}

impl Feed {
    /// A signal that is one point, at `address` if the scenario says where.
    pub fn whole(port: &Port, address: Option<String>) -> Self {
        Self { port: port.clone(), targets: vec![Target { variable: None, address }] }
    }
}

/// One of the points of a signal.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Target {
    /// The path of the variable; absent for whatever the PLC has for the signal as a whole.
    pub variable: Option<String>,
    /// Where the scenario says that it is.
    pub address: Option<String>,
}

/// One value that is exchanged: a variable of a signal, or a word.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Point {
    /// The signal, or the synchronisation word.
    pub name: String,
    /// The variable's path in the PLC's sources, where they are known.
    pub variable: Option<String>,
    /// Its number among the points of its signal, from 1, if there are several.
    pub ordinal: Option<usize>,
    /// Its type on both sides.
    pub ty: SignalType,
    /// Where the scenario says that it is in the PLC; a link knows a place for it if absent.
    pub address: Option<String>,
    /// Its first byte in the packed bytes of its direction.
    pub offset: usize,
}

impl Point {
    /// Its bytes in the packed bytes of its direction.
    pub fn range(&self) -> std::ops::Range<usize> {
        self.offset..self.offset + self.ty.size()
    }

    /// What a PLC with symbols calls it: the path of its variable, or else the signal's name. A direct address like
    /// `%QX0.1` is not a symbol.
    pub fn symbol(&self) -> &str {
        self.variable.as_deref().filter(|path| !path.starts_with('%')).unwrap_or(&self.name)
    }

    /// A name that no other point of its direction has: that of the signal, unless it has several.
    pub fn key(&self) -> String {
        match (self.ordinal, &self.variable) {
            (None, _) => self.name.clone(),
            (Some(_), Some(path)) => path.clone(),
            (Some(number), None) => format!("{}[{number}]", self.name),
        }
    }

    /// Its name for people.
    pub fn label(&self) -> String {
        match (self.ordinal, &self.variable) {
            (Some(_), Some(path)) => format!("{}` at `{path}", self.name),
            _ => self.key(),
        }
    }

    /// This one and another are in one place. A point without an address is there by default, so that the other one is
    /// wrong.
    pub fn doubled(&self, other: &Self, place: &str) -> MappingFault {
        let message = format!("`{}` and `{}` are both mapped to {place}", self.label(), other.label());
        let (wrong, default) = if other.address.is_some() { (other, self) } else { (self, other) };
        let is_default = wrong.address.is_some() && default.address.is_none();
        let help =
            format!("`{}` is there by default: give it another address, too, or choose a free one", default.label());
        MappingFault::new(&wrong.name, message).with_help(is_default.then_some(help))
    }

    /// True for a synchronisation word or a word about the PLC itself.
    pub fn is_word(&self) -> bool {
        is_word(&self.name)
    }
}

/// The words that the gateway writes, in this order, the grant last.
pub const WORDS_TO_PLC: [(&str, SignalType); 4] = [
    ("SDSP_Session", SignalType::UDINT),
    ("SDSP_Limit", SignalType::UDINT),
    ("SDSP_TV", SignalType::LINT),
    ("SDSP_Grant", SignalType::UDINT),
];

/// What the scheduler says of the last order.
pub const ANSWER: (&str, SignalType) = ("SDSP_Answer", SignalType::INT);

/// The words that the gateway reads.
pub const WORDS_FROM_PLC: [(&str, SignalType); 4] =
    [("SDSP_Joined", SignalType::UDINT), ("SDSP_Done", SignalType::UDINT), ANSWER, ("SDSP_Layout", SignalType::UDINT)];

/// A number that the gateway writes to have the PLC started cold: one more than `PLC_Boots`.
pub const START: (&str, SignalType) = ("PLC_Start", SignalType::UDINT);
/// How often the PLC was started.
pub const BOOTS: (&str, SignalType) = ("PLC_Boots", SignalType::UDINT);
/// TRUE in RUN, FALSE in STOP.
pub const RUNNING: (&str, SignalType) = ("PLC_Running", SignalType::BOOL);

/// True for the name of a synchronisation word or of a word about the PLC itself.
pub fn is_word(name: &str) -> bool {
    let words = WORDS_TO_PLC.iter().chain(&WORDS_FROM_PLC).chain([&START, &BOOTS, &RUNNING]);
    words.map(|(word, _)| *word).any(|word| word == name)
}

/// The words that are exchanged beside the signals.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Words {
    /// None: the PLC's program is not instrumented.
    Absent,
    /// Those of the handshake. A person starts the PLC.
    #[default]
    Handshake,
    /// Those of the handshake, and `PLC_Start`, `PLC_Boots` and `PLC_Running`, which a program cannot have: the PLC's
    /// system serves them.
    WithSystem,
}

/// All points of a PLC, and where the words lie among them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Exchange {
    to_plc: Vec<Point>,
    from_plc: Vec<Point>,
    /// For each input its first byte in the session's port, in the order of the points.
    ports: Vec<usize>,
    /// Bytes of the inputs, before the words.
    input_bytes: usize,
    /// Bytes of the words, before the outputs.
    word_bytes: usize,
    words: Words,
}

impl Exchange {
    /// The points of a PLC that reads `inputs` and writes `outputs`; `addresses` are those of words.
    pub fn new(inputs: &[Feed], outputs: &[Feed], words: Words, addresses: &BTreeMap<String, String>) -> Self {
        let points = |words: &[(&str, SignalType)]| -> Vec<Point> {
            let word = |(name, ty): &(&str, SignalType)| Point {
                name: (*name).to_owned(),
                variable: None,
                ordinal: None,
                ty: *ty,
                address: addresses.get(*name).cloned(),
                offset: 0,
            };
            words.iter().map(word).collect()
        };
        let (written, read) = match words {
            Words::Absent => (Vec::new(), Vec::new()),
            Words::Handshake => (points(&WORDS_TO_PLC), points(&WORDS_FROM_PLC)),
            Words::WithSystem => (
                [points(&[START]), points(&WORDS_TO_PLC)].concat(),
                [points(&WORDS_FROM_PLC), points(&[BOOTS, RUNNING])].concat(),
            ),
        };
        let (inputs, ports) = (points_of(inputs), ports_of(inputs));
        let input_bytes = inputs.iter().map(|point| point.ty.size()).sum();
        let word_bytes = read.iter().map(|point| point.ty.size()).sum();
        Self {
            to_plc: placed([inputs, written].concat()),
            from_plc: placed([read, points_of(outputs)].concat()),
            ports,
            input_bytes,
            word_bytes,
            words,
        }
    }

    /// The same points, none of which has an address.
    pub fn without_addresses(&self) -> Self {
        let mut plain = self.clone();
        plain.to_plc.iter_mut().chain(&mut plain.from_plc).for_each(|point| point.address = None);
        plain
    }

    /// The words that are exchanged.
    pub fn words(&self) -> Words {
        self.words
    }

    /// What the gateway writes, in order.
    pub fn to_plc(&self) -> &[Point] {
        &self.to_plc
    }

    /// What the gateway reads, in order.
    pub fn from_plc(&self) -> &[Point] {
        &self.from_plc
    }

    /// What goes one way, in order.
    pub fn points(&self, direction: Direction) -> &[Point] {
        match direction {
            Direction::ToPlc => &self.to_plc,
            Direction::FromPlc => &self.from_plc,
        }
    }

    /// Bytes of all points of a direction.
    pub fn size(&self, direction: Direction) -> usize {
        self.points(direction).last().map_or(0, |point| point.range().end)
    }

    /// Puts the values of the session's port into what is written: each goes to every point of its signal.
    pub fn put_inputs(&self, port: &[u8], to_plc: &mut [u8]) {
        for (point, at) in self.to_plc.iter().zip(&self.ports) {
            to_plc[point.range()].copy_from_slice(&port[*at..at + point.ty.size()]);
        }
    }

    /// Where the outputs lie in what is read.
    pub fn outputs(&self) -> std::ops::Range<usize> {
        self.word_bytes..self.size(Direction::FromPlc)
    }

    /// Puts an order behind the inputs; nothing where there are no words.
    pub fn put(&self, order: &Order, to_plc: &mut [u8]) {
        if self.words == Words::Absent {
            return;
        }
        let mut at = self.input_bytes;
        let mut put = |bytes: &[u8]| {
            to_plc[at..at + bytes.len()].copy_from_slice(bytes);
            at += bytes.len();
        };
        if self.words == Words::WithSystem {
            put(&order.start.to_le_bytes());
        }
        put(&order.session.to_le_bytes());
        put(&order.limit.to_le_bytes());
        put(&order.t_v.as_nanos().to_le_bytes());
        put(&order.grant.to_le_bytes());
    }

    /// The words among what was read; all 0 where there are none.
    pub fn report(&self, from_plc: &[u8]) -> Report {
        // The places are those of `WORDS_FROM_PLC`, then `BOOTS` and `RUNNING`, packed: 4, 4, 2, 4, 4 and 1 bytes.
        let udint =
            |at: usize| u32::from_le_bytes([from_plc[at], from_plc[at + 1], from_plc[at + 2], from_plc[at + 3]]);
        let (boots, running) = match self.words {
            Words::Absent => return Report::default(),
            Words::Handshake => (None, None),
            Words::WithSystem => (Some(udint(14)), Some(from_plc[18] != 0)),
        };
        let answer = Answer::from(i16::from_le_bytes([from_plc[8], from_plc[9]]));
        Report { joined: udint(0), done: udint(4), answer, layout: udint(10), boots, running }
    }

    /// The order among what was written: the PLC's side of [`Exchange::put`]; none where there are no words.
    pub fn order(&self, to_plc: &[u8]) -> Order {
        let words = &to_plc[self.input_bytes..];
        let udint = |at: usize| u32::from_le_bytes([words[at], words[at + 1], words[at + 2], words[at + 3]]);
        let (start, at) = match self.words {
            Words::Absent => return Order::default(),
            Words::Handshake => (0, 0),
            Words::WithSystem => (udint(0), 4),
        };
        // `SDSP_TV` is a LINT, low half first.
        let t_v = u64::from(udint(at + 8)) | u64::from(udint(at + 12)) << 32;
        Order {
            session: udint(at),
            limit: udint(at + 4),
            t_v: VirtualTime::from_nanos(t_v),
            grant: udint(at + 16),
            start,
        }
    }
}

/// The points of some signals, in the order of the signals.
fn points_of(feeds: &[Feed]) -> Vec<Point> {
    let mut points = Vec::new();
    for Feed { port, targets } in feeds {
        for (index, target) in targets.iter().enumerate() {
            points.push(Point {
                name: port.name.to_string(),
                variable: target.variable.clone(),
                ordinal: (targets.len() > 1).then_some(index + 1),
                ty: port.ty,
                address: target.address.clone(),
                offset: 0,
            });
        }
    }
    points
}

/// For each point of some signals its first byte in their port.
fn ports_of(feeds: &[Feed]) -> Vec<usize> {
    let (mut at, mut ports) = (0, Vec::new());
    for Feed { port, targets } in feeds {
        ports.extend(targets.iter().map(|_| at));
        at += port.ty.size();
    }
    ports
}

/// The points one behind the other.
fn placed(mut points: Vec<Point>) -> Vec<Point> {
    let mut offset = 0;
    for point in &mut points {
        point.offset = offset;
        offset += point.ty.size();
    }
    points
}

#[cfg(test)]
mod tests {
    use onescan_server::signal::SignalName;

    use super::*;

    #[test]
    fn words_lie_where_they_are_looked_for() {
        let port = |name: &str, ty| Port { name: SignalName::new(name).unwrap(), ty };
        for words in [Words::Handshake, Words::WithSystem] {
            let feed = |name: &str, ty| Feed::whole(&port(name, ty), None);
            let exchange = Exchange::new(
                &[feed("a", SignalType::BOOL), feed("b", SignalType::LREAL)],
                &[feed("c", SignalType::INT)],
                words,
                &BTreeMap::new(),
            );
            assert_eq!(exchange.to_plc().last().map(|point| point.name.as_str()), Some("SDSP_Grant"));
            let mut to_plc = vec![0; exchange.size(Direction::ToPlc)];
            let start = if words == Words::WithSystem { 9 } else { 0 };
            let t_v = VirtualTime::from_nanos(0x0102_0304_0506_0708);
            let order = Order { session: 3, limit: 4, t_v, grant: 7, start };
            exchange.put(&order, &mut to_plc);
            assert_eq!(exchange.order(&to_plc), order);
            for (name, ty) in WORDS_TO_PLC {
                let point = exchange.to_plc().iter().find(|point| point.name == name).unwrap();
                assert_eq!(point.ty, ty);
            }
            let mut from_plc = vec![0; exchange.size(Direction::FromPlc)];
            let mut set = |name: &str, bytes: &[u8]| {
                if let Some(point) = exchange.from_plc().iter().find(|point| point.name == name) {
                    from_plc[point.range()].copy_from_slice(bytes);
                }
            };
            set("SDSP_Joined", &5_u32.to_le_bytes());
            set("SDSP_Done", &6_u32.to_le_bytes());
            set("SDSP_Answer", &(-2_i16).to_le_bytes());
            set("SDSP_Layout", &11_u32.to_le_bytes());
            set("PLC_Boots", &8_u32.to_le_bytes());
            set("PLC_Running", &[1]);
            let is_reported = words == Words::WithSystem;
            let (boots, running) = (is_reported.then_some(8), is_reported.then_some(true));
            let report = Report { joined: 5, done: 6, answer: Answer::Other(-2), layout: 11, boots, running };
            assert_eq!(exchange.report(&from_plc), report);
            assert_eq!(exchange.outputs().len(), 2);
        }
    }

    #[test]
    fn a_signal_goes_to_every_variable_that_reads_it() {
        let port = |name: &str, ty| Port { name: SignalName::new(name).unwrap(), ty };
        let target = |path: &str| Target { variable: Some(path.to_owned()), address: None };
        let several =
            Feed { port: port("go", SignalType::INT), targets: vec![target("A.go"), target("B.go"), target("C.go")] };
        let after = Feed::whole(&port("level", SignalType::BOOL), None);
        let exchange = Exchange::new(&[several, after], &[], Words::Handshake, &BTreeMap::new());
        let mut to_plc = vec![0; exchange.size(Direction::ToPlc)];
        exchange.put_inputs(&[7, 8, 1], &mut to_plc);
        assert_eq!(to_plc[..7], [7, 8, 7, 8, 7, 8, 1]);
        let keys: Vec<_> = exchange.to_plc().iter().take(4).map(Point::key).collect();
        assert_eq!(keys, ["A.go", "B.go", "C.go", "level"]);
    }
}
