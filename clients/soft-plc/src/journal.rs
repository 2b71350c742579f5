//! What a PLC does scan by scan, handed over as the session runs: so that two runs can be held against each other
//! without keeping either.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::mpsc::SyncSender;

use onescan_iec_run::{Act, SoftPlc};
use onescan_server::signal::ClientName;
use onescan_server::time::VirtualTime;

/// A part of memory, and the bit of it that counts; all if absent.
pub type Part = (Range<usize>, Option<u8>);

/// What is handed over of each scan.
#[derive(Clone, Debug)]
pub enum Wanted {
    /// A digest over these parts of each PLC's memory, in their order, after the scan.
    Digests(BTreeMap<ClientName, Vec<Part>>),
    /// All that was done in scans from this time on.
    Acts(VirtualTime),
}

/// A scan of a PLC.
#[derive(Clone, Debug)]
pub struct Scan {
    pub client: ClientName,
    pub t_v: VirtualTime,
    /// What was wanted of it.
    pub seen: Seen,
}

/// What was seen of a scan.
#[derive(Clone, Debug)]
pub enum Seen {
    /// The digest of its memory.
    Digest([u8; 32]),
    Acts(Vec<Act>),
}

/// What is wanted, and who takes it.
#[derive(Clone, Debug)]
pub struct Journalling {
    pub wanted: Wanted,
    /// Who takes it. One that has gone is not waited for.
    pub scans: SyncSender<Scan>,
}

/// The journal of one PLC.
pub(super) struct Keeper {
    client: ClientName,
    /// Of which memory digests are wanted; nothing where acts are.
    parts: Option<Vec<Part>>,
    from: VirtualTime,
    is_kept: bool,
    scans: SyncSender<Scan>,
}

impl Keeper {
    /// The keeper of `client`; nothing if nothing is wanted of it.
    pub(super) fn new(client: &ClientName, Journalling { wanted, scans }: &Journalling) -> Option<Self> {
        let (parts, from) = match wanted {
            Wanted::Digests(parts) => (Some(parts.get(client)?.clone()), VirtualTime::ZERO),
            Wanted::Acts(from) => (None, *from),
        };
        Some(Self { client: client.clone(), parts, from, is_kept: false, scans: scans.clone() })
    }

    /// A scan is to begin.
    pub(super) fn begin(&mut self, plc: &mut SoftPlc, t_v: VirtualTime) {
        if self.parts.is_none() && !self.is_kept && t_v >= self.from {
            plc.watch([]);
            plc.keep_journal(true);
            self.is_kept = true;
        }
    }

    /// A scan is over, be it by a fault.
    pub(super) fn end(&self, plc: &SoftPlc, t_v: VirtualTime) {
        let seen = match &self.parts {
            Some(parts) => Seen::Digest(digest(parts, plc.memory())),
            None if self.is_kept => Seen::Acts(plc.journal().to_vec()),
            None => return,
        };
        // Whoever has seen enough stops listening; the session goes on to its end.
        drop(self.scans.send(Scan { client: self.client.clone(), t_v, seen }));
    }
}

fn digest(parts: &[Part], memory: &[u8]) -> [u8; 32] {
    let mut hasher = blake3::Hasher::new();
    for (range, bit) in parts {
        let bytes = memory.get(range.clone()).unwrap_or_default();
        match (bit, bytes) {
            (Some(bit), [byte, ..]) => hasher.update(&[byte >> bit & 1]),
            _ => hasher.update(bytes),
        };
    }
    hasher.finalize().into()
}
