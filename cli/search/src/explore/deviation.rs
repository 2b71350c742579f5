//! A deviation: something that happens later than it would.

use std::fmt;

use onescan_scenario::case::written::{Entry, List, to_text};
use onescan_server::operation::{Operation, SignalFault};
use onescan_server::signal::{ClientName, SignalName};
use onescan_server::time::{TimeSpan, VirtualTime};
use onescan_server::timeline::{Scheduled, When};
use serde::Serialize;
use toml::Value;

/// What happens later.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum What {
    /// An edge of a BOOL.
    Edge {
        /// The signal.
        signal: SignalName,
        /// Whether it rises.
        rises: bool,
    },
    /// A change of another signal.
    Change {
        /// The signal.
        signal: SignalName,
    },
    /// What changes of signals that are a frame.
    Frame {
        /// The signals.
        signals: Vec<SignalName>,
    },
    /// A change that arrives behind those of other signals in the same step.
    Behind {
        /// The signal.
        signal: SignalName,
        /// The others that change.
        others: Vec<SignalName>,
    },
    /// One scan of a task.
    Scan {
        /// The PLC.
        client: ClientName,
        /// The task.
        task: String,
    },
    /// All scans of a task.
    Phase {
        /// The PLC.
        client: ClientName,
        /// The task.
        task: String,
    },
    /// A scan that takes two cycles: its outputs come an interval later, and the scan after it is left out.
    TwoCycles {
        /// The PLC.
        client: ClientName,
        /// The task.
        task: String,
        /// The signals that the PLC writes.
        #[serde(skip)]
        outputs: Vec<SignalName>,
    },
    /// The start of a PLC.
    Start {
        /// The PLC.
        client: ClientName,
    },
}

/// Something that happens later than it would.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Deviation {
    /// What.
    #[serde(flatten)]
    pub what: What,
    /// When it would happen.
    #[serde(rename = "edge_ns")]
    pub edge: VirtualTime,
    /// When it does, and what is held by it is let go.
    #[serde(rename = "arrives_ns")]
    pub arrives: VirtualTime,
    /// By how many steps it is late.
    pub late_steps: u64,
    /// Number of its tolerance among those of the scenario.
    #[serde(skip)]
    pub(super) tolerance: usize,
    #[serde(skip)]
    step: TimeSpan,
}

impl What {
    /// The signals that it holds.
    pub(super) fn signals(&self) -> &[SignalName] {
        match self {
            Self::Edge { signal, .. } | Self::Change { signal } | Self::Behind { signal, .. } => {
                std::slice::from_ref(signal)
            }
            Self::Frame { signals } | Self::TwoCycles { outputs: signals, .. } => signals,
            Self::Scan { .. } | Self::Phase { .. } | Self::Start { .. } => &[],
        }
    }

    /// The task whose scans it moves; all of the PLC's without a name.
    pub(super) fn task(&self) -> Option<(&ClientName, Option<&str>)> {
        match self {
            Self::Scan { client, task } | Self::Phase { client, task } | Self::TwoCycles { client, task, .. } => {
                Some((client, Some(task)))
            }
            Self::Start { client } => Some((client, None)),
            Self::Edge { .. } | Self::Change { .. } | Self::Frame { .. } | Self::Behind { .. } => None,
        }
    }

    /// True if both hold the same signal or move the same task.
    pub(super) fn meets(&self, other: &Self) -> bool {
        let same_task = match (self.task(), other.task()) {
            (Some((one, task)), Some((other, other_task))) => {
                one == other && (task.is_none() || other_task.is_none() || task == other_task)
            }
            _ => false,
        };
        same_task || self.signals().iter().any(|signal| other.signals().contains(signal))
    }
}

impl Deviation {
    /// What would happen at `edge`, so many steps late. Nothing beyond the end of virtual time.
    pub(super) fn new(
        (tolerance, what): (usize, What),
        edge: VirtualTime,
        late_steps: u64,
        step: TimeSpan,
    ) -> Option<Self> {
        let late = edge.checked_add(step.times(late_steps)?)?;
        // What moves a task for good is over as soon as it has begun.
        let arrives = if matches!(what, What::Phase { .. } | What::Start { .. }) { edge } else { late };
        Some(Self { what, edge, arrives, late_steps, tolerance, step })
    }

    /// The same with another lateness.
    pub(super) fn with_steps(&self, late_steps: u64) -> Option<Self> {
        Self::new((self.tolerance, self.what.clone()), self.edge, late_steps, self.step)
    }

    fn by(&self) -> TimeSpan {
        self.step.times(self.late_steps).unwrap_or(self.step)
    }

    /// The same as operations: until it happens readers have what was before it.
    pub(super) fn operations(&self) -> Vec<Scheduled> {
        let (edge, arrives, by) = (When::At(self.edge), When::At(self.arrives), self.by());
        let scheduled = |when: &When, operation| Scheduled { when: when.clone(), operation };
        if let What::Edge { signal, rises } = &self.what {
            let value = if *rises { "FALSE" } else { "TRUE" }.to_owned();
            return vec![
                scheduled(&edge, Operation::Force { signal: signal.clone(), value }),
                scheduled(&arrives, Operation::Release { signal: signal.clone() }),
            ];
        }
        let mut all = Vec::new();
        for signal in self.what.signals() {
            all.push(scheduled(&edge, Operation::Disturb { signal: signal.clone(), fault: SignalFault::Stuck }));
            all.push(scheduled(&arrives, Operation::Mend { signal: signal.clone() }));
        }
        if let Some((client, task)) = self.what.task() {
            let (client, task) = (client.clone(), task.map(str::to_owned));
            let from = When::At(self.postponed_from());
            all.push(scheduled(&from, Operation::Postpone { client: client.clone(), task: task.clone(), by }));
            if matches!(self.what, What::Scan { .. }) {
                all.push(scheduled(&arrives, Operation::CatchUp { client, task, by }));
            }
        }
        all
    }

    /// The scan itself comes in time if it takes two cycles: the one after it does not.
    fn postponed_from(&self) -> VirtualTime {
        if matches!(self.what, What::TwoCycles { .. }) { self.edge + self.step } else { self.edge }
    }

    /// The same as entries of a case.
    pub(super) fn entries(&self) -> Vec<Entry> {
        let word = |text: &str| Value::from(text);
        let time = |at: VirtualTime| Value::from(to_text(at));
        let mut all = Vec::new();
        let held: Option<(List, Vec<(&str, Value)>)> = match &self.what {
            What::Edge { signal, rises } => {
                Some((List::Force, vec![("signal", word(signal.as_str())), ("value", Value::from(!rises))]))
            }
            What::Change { signal } | What::Behind { signal, .. } => {
                Some((List::Disturbance, vec![("signal", word(signal.as_str())), ("kind", word("stuck"))]))
            }
            What::Frame { signals } => {
                let names: Vec<&str> = signals.iter().map(SignalName::as_str).collect();
                Some((List::Disturbance, vec![("signals", Value::from(names)), ("kind", word("stuck"))]))
            }
            What::TwoCycles { client, .. } => {
                Some((List::Disturbance, vec![("client", word(client.as_str())), ("kind", word("stuck"))]))
            }
            What::Scan { .. } | What::Phase { .. } | What::Start { .. } => None,
        };
        if let Some((list, mut keys)) = held {
            keys.extend([("from", time(self.edge)), ("until", time(self.arrives))]);
            all.push(Entry { list, keys: keys.into_iter().map(|(key, value)| (key.to_owned(), value)).collect() });
        }
        if let Some((client, task)) = self.what.task() {
            let mut keys = vec![("client", word(client.as_str()))];
            keys.extend(task.map(|task| ("task", word(task))));
            keys.push(("by", time(VirtualTime::ZERO + self.by())));
            if self.postponed_from() > VirtualTime::ZERO {
                keys.push(("from", time(self.postponed_from())));
            }
            if matches!(self.what, What::Scan { .. }) {
                keys.push(("until", time(self.arrives)));
            }
            let keys = keys.into_iter().map(|(key, value)| (key.to_owned(), value)).collect();
            all.push(Entry { list: List::Task, keys });
        }
        all
    }
}

impl fmt::Display for Deviation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { what, edge, late_steps, .. } = self;
        let steps = if *late_steps == 1 { "step" } else { "steps" };
        let list =
            |signals: &[SignalName]| signals.iter().map(|signal| format!("`{signal}`")).collect::<Vec<_>>().join(", ");
        match what {
            What::Edge { signal, rises } => {
                let word = if *rises { "rising" } else { "falling" };
                write!(f, "the {word} edge of `{signal}` at {edge} is late by {late_steps} {steps}")
            }
            What::Change { signal } => write!(f, "the change of `{signal}` at {edge} is late by {late_steps} {steps}"),
            What::Frame { signals } => {
                write!(f, "the frame of {} at {edge} is late by {late_steps} {steps}", list(signals))
            }
            What::Behind { signal, others } => {
                write!(f, "the change of `{signal}` at {edge} arrives a step after that of {}", list(others))
            }
            What::Scan { client, task } => {
                write!(f, "the scan of `{task}` of `{client}` at {edge} is late by {late_steps} {steps}")
            }
            What::Phase { client, task } => {
                write!(f, "all scans of `{task}` of `{client}` are later by {late_steps} {steps}")
            }
            What::TwoCycles { client, task, .. } => {
                write!(f, "the scan of `{task}` of `{client}` at {edge} takes two cycles")
            }
            What::Start { client } => write!(f, "`{client}` is started later by {late_steps} {steps}"),
        }
    }
}
