//! What each listener of the program allows those who come, in one table: how many there may be, how many of one address, how many
//! of those that have shown to be clients, and how long that may take them. Fewer of one address than may stay: nobody
//! alone can have all places. `docs/security.md` has the same for its readers, and
//! `tests/simulation` holds each of them against a crowd. The lobby of a session has rules of its own
//! ([`lobby`](crate::lobby)).

use std::time::Duration;

use super::connection_limit::Limits;

/// What a listener allows those who come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ListenerRules {
    /// What they come to, for messages.
    pub what: &'static str,
    pub limits: Limits,
    /// How long a connection may take to show that it is a client's: for its first request, or from one answer to the next where
    /// connections come and go.
    pub proof: Duration,
    /// How long one that stays may be without an answer, or as long as it likes.
    pub idle: Option<Duration>,
}

/// A PLC's silence after which its connection is left; one that comes back is let in again.
pub const IDLE_TIMEOUT: Duration = Duration::from_mins(10);

const LIMITS: Limits = Limits { all: 64, of_address: 32, staying: 48 };

/// Those of a server that answers requests of many.
const fn of_server(what: &'static str) -> ListenerRules {
    ListenerRules { what, limits: LIMITS, proof: Duration::from_secs(30), idle: Some(IDLE_TIMEOUT) }
}

/// `onescan plc --modbus`.
pub const MODBUS: ListenerRules = of_server("Modbus");
/// `onescan plc --s7`.
pub const S7: ListenerRules = of_server("S7");
/// `onescan plc --ads`.
pub const ADS: ListenerRules = of_server("ADS");
/// `onescan run --ads`: the PLC of a session, looked into.
pub const INSPECTION: ListenerRules =
    ListenerRules { limits: Limits { all: 24, of_address: 12, staying: 18 }, ..of_server("ADS") };
/// OPC UA: a HELLO first, and its place once it has a secure channel. Sessions end before a connection does.
pub const OPC_UA: ListenerRules =
    ListenerRules { proof: Duration::from_secs(5), idle: Some(Duration::from_secs(30)), ..of_server("OPC UA") };
/// `onescan plc --tcp`. Connections have two threads each. A gateway connects long before its session begins and it has a block to
/// send, so it has as much time for the first as for any other.
pub const RAW_TCP: ListenerRules = ListenerRules {
    what: "raw TCP",
    limits: Limits { all: 16, of_address: 8, staying: 12 },
    proof: IDLE_TIMEOUT,
    idle: Some(IDLE_TIMEOUT),
};
/// A gateway that listens for its PLC: one at a time, who gives way until it has sent a block.
pub const PLC: Limits = Limits { all: 1, of_address: 1, staying: 1 };

/// Connections of a page at a time, if there are descriptors enough.
const PAGE_MAX: usize = 256;
/// Connections of a page that there is always room for, however few descriptors there are.
const PAGE_MIN: usize = 8;

/// The page, of a process that may have so many descriptors; nothing for as many as it likes. Only a viewer's connection stays.
#[must_use]
pub fn page(descriptors: Option<usize>) -> ListenerRules {
    let all = descriptors.map_or(PAGE_MAX, |descriptors| descriptors / 4).clamp(PAGE_MIN, PAGE_MAX);
    ListenerRules {
        what: "the page",
        limits: Limits { all, of_address: all / 2, staying: all * 3 / 4 },
        proof: Duration::from_secs(30),
        idle: None,
    }
}
