//! Variables of the PLC that somebody looks at: their values after every turn.

use std::sync::{Arc, Mutex, PoisonError};

use onescan_iec_run::{Application, Radix, SoftPlc, UnknownVariable, Variable};
use onescan_server::time::VirtualTime;

/// A variable to look at.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Watch {
    /// Its path, as `Main.axis[2].x`.
    pub path: String,
    /// How its value is shown.
    pub radix: Radix,
}

/// A value that a watched variable has had since `since`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sighting {
    /// Number of the variable in the list of watches.
    pub watch: usize,
    /// The step after which it had the value first.
    pub since: VirtualTime,
    /// The value as a literal.
    pub value: String,
}

/// What has been seen in a run; it outlives the client.
#[derive(Debug, Default)]
pub struct Sightings {
    /// In the order of time; if changes are not asked for, one for each variable.
    pub list: Vec<Sighting>,
    /// Changes that are not in the list, because it would have grown beyond [`Self::LIMIT`].
    pub left_out: u64,
}

impl Sightings {
    /// Most changes that are kept of a run.
    pub const LIMIT: usize = 100_000;

    /// The value that a variable had last.
    fn last(&self, watch: usize) -> Option<&str> {
        self.list.iter().rfind(|each| each.watch == watch).map(|each| each.value.as_str())
    }

    fn add(&mut self, sighting: Sighting, changes: bool) {
        if changes && self.list.len() == Self::LIMIT {
            self.left_out += 1;
        } else if let Some(before) = self.list.iter_mut().find(|each| !changes && each.watch == sighting.watch) {
            *before = sighting;
        } else {
            self.list.push(sighting);
        }
    }
}

/// What the clients of a run have seen together.
pub type SightingSink = Arc<Mutex<Sightings>>;

/// A variable with the bytes it had last.
struct Watched {
    number: usize,
    variable: Variable,
    radix: Radix,
    last: Option<Vec<u8>>,
    /// True until it is looked at after a state was restored, which may have the value that was seen last.
    is_rewound: bool,
}

/// The watched variables of one PLC.
pub(super) struct Watcher {
    watched: Vec<Watched>,
    changes: bool,
    sink: SightingSink,
}

impl Watcher {
    /// Looks at `watches`, each with its number; all changes are kept if `changes`.
    pub(super) fn new(
        application: &Application,
        watches: &[(usize, Watch)],
        changes: bool,
        sink: SightingSink,
    ) -> Result<Self, UnknownVariable> {
        let watched = watches.iter().map(|(number, watch)| {
            let variable = application.variable(&watch.path)?;
            Ok(Watched { number: *number, variable, radix: watch.radix, last: None, is_rewound: false })
        });
        Ok(Self { watched: watched.collect::<Result<_, _>>()?, changes, sink })
    }

    /// The PLC goes on from a state saved at `t_v`: forgets what was seen later.
    pub(super) fn rewind(&mut self, t_v: VirtualTime) {
        for watched in &mut self.watched {
            (watched.last, watched.is_rewound) = (None, true);
        }
        let own = |sighting: &Sighting| self.watched.iter().any(|watched| watched.number == sighting.watch);
        let mut sink = self.sink.lock().unwrap_or_else(PoisonError::into_inner);
        sink.list.retain(|sighting| sighting.since <= t_v || !own(sighting));
    }

    /// Looks at the values as they are at `t_v`.
    pub(super) fn look(&mut self, plc: &SoftPlc, t_v: VirtualTime) {
        for Watched { number, variable, radix, last, is_rewound } in &mut self.watched {
            let bytes = variable.bytes(plc.memory());
            if last.as_deref() == Some(bytes.as_slice()) {
                continue;
            }
            let value = plc.application().value_text_in(variable, plc.memory(), *radix);
            *last = Some(bytes);
            // Whoever panicked while it held the lock left whole entries.
            let mut sink = self.sink.lock().unwrap_or_else(PoisonError::into_inner);
            if std::mem::take(is_rewound) && sink.last(*number) == Some(value.as_str()) {
                continue;
            }
            sink.add(Sighting { watch: *number, since: t_v, value }, self.changes);
        }
    }
}
