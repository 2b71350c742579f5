//! A deviation: an edge of a signal that arrives late.

use std::fmt;

use onescan_scenario::case::written::spelt;
use onescan_server::operation::Operation;
use onescan_server::signal::SignalName;
use onescan_server::time::{TimeSpan, VirtualTime};
use onescan_server::timeline::{Scheduled, When};
use serde::Serialize;

/// An edge that arrives late.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Deviation {
    /// The signal, a BOOL.
    pub signal: SignalName,
    /// Whether it rises.
    pub rises: bool,
    /// When the edge would arrive.
    #[serde(rename = "edge_ns")]
    pub edge: VirtualTime,
    /// When it does.
    #[serde(rename = "arrives_ns")]
    pub arrives: VirtualTime,
    /// By how many steps it is late.
    pub late_steps: u64,
}

impl Deviation {
    /// The edge of `signal` at `edge`, so many steps late. Nothing beyond the end of virtual time.
    pub(super) fn new(
        signal: SignalName,
        rises: bool,
        edge: VirtualTime,
        late_steps: u64,
        step: TimeSpan,
    ) -> Option<Self> {
        let arrives = edge.checked_add(step.times(late_steps)?)?;
        Some(Self { signal, rises, edge, arrives, late_steps })
    }

    /// The same as operations: until the edge arrives the readers have the value from before it.
    pub(super) fn operations(&self) -> [Scheduled; 2] {
        let signal = self.signal.clone();
        let force =
            Operation::Force { signal: signal.clone(), value: if self.rises { "FALSE" } else { "TRUE" }.to_owned() };
        let release = Operation::Release { signal };
        [
            Scheduled { when: When::At(self.edge), operation: force },
            Scheduled { when: When::At(self.arrives), operation: release },
        ]
    }

    /// The same as the force of a case.
    pub(super) fn as_toml(&self) -> String {
        let Self { signal, rises, .. } = self;
        let (edge, arrives) = (spelt(self.edge), spelt(self.arrives));
        format!("{{ signal = \"{signal}\", value = {}, from = \"{edge}\", until = \"{arrives}\" }}", !rises)
    }
}

impl fmt::Display for Deviation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { signal, rises, edge, late_steps, .. } = self;
        let (edge_word, scans) =
            (if *rises { "rising" } else { "falling" }, if *late_steps == 1 { "step" } else { "steps" });
        write!(f, "the {edge_word} edge of `{signal}` at {edge} is late by {late_steps} {scans}")
    }
}
