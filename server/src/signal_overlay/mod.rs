//! What lies over the values that writers stage: writes and forces from outside, and faults on the way
//! of a signal.
//!
//! A writer's own values stay as staged, so that a released or mended signal shows at once what its
//! writer last wrote, however long that client sleeps. Only what a commit makes visible is changed:
//! first by the fault, then by a write, then by a force, each hiding what is below it.

//!
//! | module | subject |
//! |---|---|
//! | this file | the order of what lies over each other |
//! | `disturbance` | faults on the way of a signal, at work |
//! | `line` | faults on a line of bytes |
//! | `push` | frames that a side pushes by its own clock |
//! | `number` | numbers shifted, and bits flipped, within their type |

mod disturbance;
mod line;
mod number;
mod push;

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::layout::ImageLayout;
use crate::operation::SignalFault;
use crate::signal::SignalId;

use disturbance::Disturbance;
pub(crate) use disturbance::Onset;

/// Everything that lies over the writers' values, by signal.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub(crate) struct SignalOverlay {
    faults: BTreeMap<SignalId, Disturbance>,
    /// Values for the step under way; its last commit gives them to the writer's own values.
    writes: BTreeMap<SignalId, Vec<u8>>,
    forces: BTreeMap<SignalId, Vec<u8>>,
}

impl SignalOverlay {
    /// True while nothing lies over anything: a commit is a copy then.
    pub(crate) fn is_empty(&self) -> bool {
        self.faults.is_empty() && self.writes.is_empty() && self.forces.is_empty()
    }

    /// A value for one step; `bytes` has the signal's size.
    pub(crate) fn write(&mut self, signal: SignalId, bytes: Vec<u8>) {
        debug_assert!(!self.is_forced(signal), "a write never lies under a force");
        self.writes.insert(signal, bytes);
    }

    /// A value until it is released.
    pub(crate) fn force(&mut self, signal: SignalId, bytes: Vec<u8>) {
        // The force hides a write of the same boundary for good.
        self.writes.remove(&signal);
        self.forces.insert(signal, bytes);
    }

    /// True if the signal is forced.
    pub(crate) fn is_forced(&self, signal: SignalId) -> bool {
        self.forces.contains_key(&signal)
    }

    /// The signals that are forced.
    pub(crate) fn forced(&self) -> impl Iterator<Item = SignalId> + '_ {
        self.forces.keys().copied()
    }

    /// Ends a force; false if there was none.
    pub(crate) fn release(&mut self, signal: SignalId) -> bool {
        self.forces.remove(&signal).is_some()
    }

    /// Puts a fault on a signal in place of the one it has. False if its type cannot have that fault.
    pub(crate) fn disturb(&mut self, signal: SignalId, fault: &SignalFault, onset: &Onset<'_>) -> bool {
        let disturbance = Disturbance::begin(fault, onset);
        let Some(disturbance) = disturbance else { return false };
        debug_assert!(disturbance.fits(onset.ty), "a fault begins as one that {} can have", onset.ty);
        let disturbance = match (disturbance, self.faults.remove(&signal)) {
            (Disturbance::Line(fault), Some(Disturbance::Line(before))) => Disturbance::Line(fault.after(before)),
            (disturbance, _) => disturbance,
        };
        self.faults.insert(signal, disturbance);
        true
    }

    /// Ends a fault; false if there was none.
    pub(crate) fn clear(&mut self, signal: SignalId) -> bool {
        if let Some(Disturbance::Line(fault)) = self.faults.get_mut(&signal) {
            // what it has done to bytes that are still in the window stays
            return fault.end();
        }
        self.faults.remove(&signal).is_some()
    }

    /// Changes `committed`, which is a copy of `staged`. The last commit of a step moves time on for
    /// late signals and gives written values to the writers' own.
    #[cold]
    pub(crate) fn apply(&mut self, layout: &ImageLayout, staged: &mut [u8], committed: &mut [u8], ends_step: bool) {
        debug_assert_eq!(staged.len(), layout.size(), "staged values have the layout of the image");
        debug_assert_eq!(committed.len(), layout.size(), "committed values have the layout of the image");
        for (signal, fault) in &mut self.faults {
            let at = layout.range(*signal);
            fault.pass(layout.ty(*signal), &mut committed[at], ends_step);
        }
        if ends_step {
            self.faults.retain(|_, fault| !matches!(fault, Disturbance::Line(line) if line.is_gone()));
        }
        for (signal, bytes) in &self.writes {
            let at = layout.range(*signal);
            committed[at.clone()].copy_from_slice(bytes);
            if ends_step {
                staged[at].copy_from_slice(bytes);
            }
        }
        if ends_step {
            self.writes.clear();
        }
        for (signal, bytes) in &self.forces {
            committed[layout.range(*signal)].copy_from_slice(bytes);
        }
    }

    /// True if it could lie over an image of this layout: what a checkpoint says is not believed.
    pub(crate) fn fits(&self, layout: &ImageLayout) -> bool {
        let known = |signal: &SignalId| signal.index() < layout.signals().len();
        let sized =
            |(signal, bytes): (&SignalId, &Vec<u8>)| known(signal) && bytes.len() == layout.range(*signal).len();
        let fault = |(signal, fault): (&SignalId, &Disturbance)| known(signal) && fault.fits(layout.ty(*signal));
        self.forces.iter().all(sized) && self.writes.iter().all(sized) && self.faults.iter().all(fault)
    }
}
