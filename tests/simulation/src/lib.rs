//! Sessions with a world around them that goes wrong by a seed: visitors, networks, disks, on virtual time and without a thread. The
//! code that is tried is the very code that runs; what is around it stands here.
//!
//! | module | subject |
//! |---|---|
//! | [`histories`] | histories by their seeds, on all processors |
//! | [`chance`] | numbers by a seed |
//! | [`hall`] | acceptor and seats of a session, with connections around them |
//! | [`faulty_disk`] | a disk that refuses, or a process that ends, at any call |
//! | [`toy`], [`run`] | small clients, and sessions of them |

pub mod chance;
pub mod faulty_disk;
pub mod hall;
pub mod histories;
pub mod run;
pub mod toy;

use onescan_server::plan::{Coupling, SessionPlan};
use onescan_server::signal::{ClientName, Port, SignalDecl, SignalName, SignalType};
use onescan_server::time::{TimeSpan, VirtualTime};

/// `ms` milliseconds as a span.
pub fn span_ms(ms: u64) -> TimeSpan {
    TimeSpan::from_millis(ms).expect("a span is not zero")
}

/// `ms` milliseconds after the session's start.
pub fn at_ms(ms: u64) -> VirtualTime {
    VirtualTime::from_nanos(ms * 1_000_000)
}

/// The client of this name.
pub fn client(name: &str) -> ClientName {
    ClientName::new(name).expect("a test knows its names")
}

/// A port of this signal.
pub fn port(name: &str, ty: SignalType) -> Port {
    Port { name: SignalName::new(name).expect("a test knows its names"), ty }
}

/// A plan with a step of `step` and the given signals, each with its writer.
pub fn plan(
    step: TimeSpan,
    coupling: &Coupling<ClientName>,
    signals: &[(&str, SignalType, &str)],
    clients: &[&str],
) -> SessionPlan {
    let signals = signals
        .iter()
        .map(|(name, ty, writer)| SignalDecl {
            name: SignalName::new(*name).expect("a test knows its names"),
            ty: *ty,
            writer: Some(client(writer)),
            unit: None,
        })
        .collect();
    let clients = clients.iter().map(|name| client(name)).collect();
    SessionPlan::new(step, coupling, signals, clients).expect("a test knows its plan")
}
