//! What is exchanged with a PLC: signals and synchronisation words in their order, as packed bytes.
//!
//! Both directions are ports as a session has them: little-endian, unpadded. To the PLC go the inputs and then
//! the words, the grant last, so that a link that writes one value after the other writes it last. From the
//! PLC come the words first and then the outputs, so that outputs are never older than the `SDSP_Done` before them.

use std::collections::BTreeMap;

use onescan_server::signal::{Port, SignalType};
use onescan_server::time::VirtualTime;

use super::answer::Answer;
use super::handshake::{Order, Report};

/// Which way a point goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// The gateway writes it.
    ToPlc,
    /// The gateway reads it.
    FromPlc,
}

/// One value that is exchanged.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Point {
    /// The signal, or the synchronisation word.
    pub name: String,
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
}

/// The words that the gateway writes, in this order, the grant last.
pub const WORDS_TO_PLC: [(&str, SignalType); 4] = [
    ("SDSP_Session", SignalType::UDINT),
    ("SDSP_Limit", SignalType::UDINT),
    ("SDSP_TV", SignalType::LINT),
    ("SDSP_Grant", SignalType::UDINT),
];

/// The words that the gateway reads.
pub const WORDS_FROM_PLC: [(&str, SignalType); 3] =
    [("SDSP_Joined", SignalType::UDINT), ("SDSP_Done", SignalType::UDINT), ("SDSP_Answer", SignalType::INT)];

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

/// Words about the PLC itself, which a program cannot have: the PLC's system serves them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SystemWords {
    /// A PLC without them: who restarts it is a person.
    #[default]
    Absent,
    /// `PLC_Start`, `PLC_Boots` and `PLC_Running`.
    Present,
}

/// All points of a PLC, and where the words lie among them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Exchange {
    to_plc: Vec<Point>,
    from_plc: Vec<Point>,
    /// Bytes of the inputs, before the words.
    input_bytes: usize,
    /// Bytes of the words, before the outputs.
    word_bytes: usize,
    system: SystemWords,
}

impl Exchange {
    /// The points of a PLC that reads `inputs` and writes `outputs`; `addresses` by signal or word.
    pub fn new(inputs: &[Port], outputs: &[Port], system: SystemWords, addresses: &BTreeMap<String, String>) -> Self {
        let words = |words: &[(&str, SignalType)]| -> Vec<(String, SignalType)> {
            words.iter().map(|(name, ty)| ((*name).to_owned(), *ty)).collect()
        };
        let signals = |ports: &[Port]| ports.iter().map(|port| (port.name.to_string(), port.ty)).collect::<Vec<_>>();
        let (start, about) = match system {
            SystemWords::Absent => (Vec::new(), Vec::new()),
            SystemWords::Present => (words(&[START]), words(&[BOOTS, RUNNING])),
        };
        let inputs = signals(inputs);
        let input_bytes = inputs.iter().map(|(_, ty)| ty.size()).sum();
        let read = [words(&WORDS_FROM_PLC), about].concat();
        let word_bytes = read.iter().map(|(_, ty)| ty.size()).sum();
        Self {
            to_plc: points([inputs, start, words(&WORDS_TO_PLC)].concat(), addresses),
            from_plc: points([read, signals(outputs)].concat(), addresses),
            input_bytes,
            word_bytes,
            system,
        }
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

    /// Where the inputs lie in what is written.
    pub fn inputs(&self) -> std::ops::Range<usize> {
        0..self.input_bytes
    }

    /// Where the outputs lie in what is read.
    pub fn outputs(&self) -> std::ops::Range<usize> {
        self.word_bytes..self.size(Direction::FromPlc)
    }

    /// Puts an order behind the inputs.
    pub fn put(&self, order: &Order, to_plc: &mut [u8]) {
        let mut at = self.input_bytes;
        let mut put = |bytes: &[u8]| {
            to_plc[at..at + bytes.len()].copy_from_slice(bytes);
            at += bytes.len();
        };
        if self.system == SystemWords::Present {
            put(&order.start.to_le_bytes());
        }
        put(&order.session.to_le_bytes());
        put(&order.limit.to_le_bytes());
        put(&order.t_v.as_nanos().to_le_bytes());
        put(&order.grant.to_le_bytes());
    }

    /// The words among what was read.
    pub fn report(&self, from_plc: &[u8]) -> Report {
        let udint =
            |at: usize| u32::from_le_bytes([from_plc[at], from_plc[at + 1], from_plc[at + 2], from_plc[at + 3]]);
        let (boots, running) = match self.system {
            SystemWords::Absent => (None, None),
            SystemWords::Present => (Some(udint(10)), Some(from_plc[14] != 0)),
        };
        let answer = Answer::from(i16::from_le_bytes([from_plc[8], from_plc[9]]));
        Report { joined: udint(0), done: udint(4), answer, boots, running }
    }

    /// The order among what was written: the PLC's side of [`Exchange::put`].
    pub fn order(&self, to_plc: &[u8]) -> Order {
        let words = &to_plc[self.input_bytes..];
        let udint = |at: usize| u32::from_le_bytes([words[at], words[at + 1], words[at + 2], words[at + 3]]);
        let (start, at) = match self.system {
            SystemWords::Absent => (0, 0),
            SystemWords::Present => (udint(0), 4),
        };
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

fn points(named: Vec<(String, SignalType)>, addresses: &BTreeMap<String, String>) -> Vec<Point> {
    let mut offset = 0;
    let point = |(name, ty): (String, SignalType)| {
        let at = offset;
        offset += ty.size();
        Point { address: addresses.get(&name).cloned(), name, ty, offset: at }
    };
    named.into_iter().map(point).collect()
}

#[cfg(test)]
mod tests {
    use onescan_server::signal::SignalName;

    use super::*;

    #[test]
    fn words_lie_where_they_are_looked_for() {
        let port = |name: &str, ty| Port { name: SignalName::new(name).unwrap(), ty };
        for system in [SystemWords::Absent, SystemWords::Present] {
            let exchange = Exchange::new(
                &[port("a", SignalType::BOOL), port("b", SignalType::LREAL)],
                &[port("c", SignalType::INT)],
                system,
                &BTreeMap::new(),
            );
            assert_eq!(exchange.to_plc().last().map(|point| point.name.as_str()), Some("SDSP_Grant"));
            let mut to_plc = vec![0; exchange.size(Direction::ToPlc)];
            let start = if system == SystemWords::Present { 9 } else { 0 };
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
            set("PLC_Boots", &8_u32.to_le_bytes());
            set("PLC_Running", &[1]);
            let is_told = system == SystemWords::Present;
            let (boots, running) = (is_told.then_some(8), is_told.then_some(true));
            let report = Report { joined: 5, done: 6, answer: Answer::Other(-2), boots, running };
            assert_eq!(exchange.report(&from_plc), report);
            assert_eq!(exchange.outputs().len(), 2);
        }
    }
}
