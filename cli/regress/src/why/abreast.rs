//! Two runs side by side, scan by scan, without keeping either.

use std::collections::{BTreeMap, VecDeque};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, sync_channel};
use std::{io, thread};

use onescan_base::threads;
use onescan_iec_run::Act;
use onescan_scenario::Scenario;
use onescan_server::operation::OperatorInput;
use onescan_server::signal::ClientName;
use onescan_server::time::VirtualTime;
use onescan_soft_plc::journal::{Journalling, Part, Scan, Seen, Wanted};

use onescan_runner::run::rerun::rerun_while;

/// Scans that a run may be ahead of who looks at it.
const AHEAD: usize = 64;

/// A run to be held against another.
#[derive(Debug)]
pub struct Side<'s> {
    pub scenario: &'s Scenario,
    /// What the operator does.
    pub inputs: Vec<OperatorInput>,
}

/// The scenario with PLCs that report what they do, to nobody.
pub(super) fn traced(scenario: &Scenario) -> Scenario {
    let mut traced = scenario.clone();
    let (scans, _) = sync_channel(0);
    traced.journal(Journalling { wanted: Wanted::Acts(VirtualTime::ZERO), scans });
    traced
}

/// The first scan after which the memory of a PLC differs in what both runs have.
///
/// # Errors
/// The system has no thread to give for a run.
pub(super) fn first_scan(
    sides: [&Side<'_>; 2],
    until: VirtualTime,
    parts: [BTreeMap<ClientName, Vec<Part>>; 2],
) -> io::Result<Option<VirtualTime>> {
    let [a, b] = parts;
    let mut first: Option<VirtualTime> = None;
    abreast(sides, until, [Wanted::Digests(a), Wanted::Digests(b)], |pair| {
        let differs = match &pair {
            [Some(a), Some(b)] => a.t_v != b.t_v || digest(a) != digest(b),
            _ => true,
        };
        let at = pair.iter().flatten().map(|scan| scan.t_v).min();
        if let Some(at) = at.filter(|_| differs) {
            first = Some(first.map_or(at, |first| first.min(at)));
        }
        first.is_none()
    })?;
    Ok(first)
}

fn digest(scan: &Scan) -> Option<[u8; 32]> {
    match scan.seen {
        Seen::Digest(digest) => Some(digest),
        Seen::Acts(_) => None,
    }
}

/// What a PLC did in a scan of each run; nothing where one had no such scan.
pub(super) struct Pair {
    pub(super) client: ClientName,
    pub(super) t_v: VirtualTime,
    pub(super) acts: [Vec<Act>; 2],
}

/// Gives `look` what both runs do from `from` on, until it says that it has seen enough.
///
/// # Errors
/// The system has no thread to give for a run.
pub(super) fn acts(
    sides: [&Side<'_>; 2],
    from: VirtualTime,
    until: VirtualTime,
    mut look: impl FnMut(&Pair) -> bool,
) -> io::Result<()> {
    abreast(sides, until, [Wanted::Acts(from), Wanted::Acts(from)], |pair| {
        let Some(first) = pair.iter().flatten().min_by_key(|scan| scan.t_v) else { return true };
        let (client, t_v) = (first.client.clone(), first.t_v);
        let acts = pair.map(|scan| match scan {
            Some(Scan { t_v: at, seen: Seen::Acts(acts), .. }) if at == t_v => acts,
            _ => Vec::new(),
        });
        look(&Pair { client, t_v, acts })
    })
}

/// Runs both and gives `look` the scans of each PLC in pairs, until it says that it has seen enough. A run that fails
/// ends with its last scan.
fn abreast(
    sides: [&Side<'_>; 2],
    until: VirtualTime,
    wanted: [Wanted; 2],
    mut look: impl FnMut([Option<Scan>; 2]) -> bool,
) -> io::Result<()> {
    // Who has seen enough does not wait for the end of either run.
    let is_enough = &AtomicBool::new(false);
    thread::scope(|scope| {
        let _ended = Raised(is_enough);
        let [first, second] = wanted;
        let listen_to = |side: &Side<'_>, wanted| {
            let (scans, listening) = sync_channel(AHEAD);
            let mut scenario = side.scenario.clone();
            scenario.journal(Journalling { wanted, scans });
            let inputs = side.inputs.clone();
            let is_wanted = move || !is_enough.load(Ordering::Relaxed);
            threads::start_in(scope, "run", move || {
                // What it did up to its end is what counts here; the run itself has been judged already.
                if let Err(error) = rerun_while(&scenario, until, inputs, is_wanted) {
                    tracing::debug!(%error, "a run that is looked at ends");
                }
            })?;
            io::Result::Ok(listening)
        };
        let listening = [listen_to(sides[0], first)?, listen_to(sides[1], second)?];
        let mut waiting: BTreeMap<ClientName, [VecDeque<Scan>; 2]> = BTreeMap::new();
        while let Some(both) = take(&listening, &mut waiting) {
            while !both[0].is_empty() && !both[1].is_empty() {
                if !look(paired(both)) {
                    return Ok(());
                }
            }
        }
        for (_, mut both) in waiting {
            while both.iter().any(|scans| !scans.is_empty()) {
                if !look(paired(&mut both)) {
                    return Ok(());
                }
            }
        }
        Ok(())
    })
}

/// Raises a flag as it goes, whichever way that is.
struct Raised<'f>(&'f AtomicBool);

impl Drop for Raised<'_> {
    fn drop(&mut self) {
        // `Relaxed` is enough: it says nothing of other memory, and a step more does no harm.
        self.0.store(true, Ordering::Relaxed);
    }
}

/// Takes the next scan of the run of which fewer wait, and gives those of its PLC; nothing once both have ended.
fn take<'w>(
    listening: &[Receiver<Scan>; 2],
    waiting: &'w mut BTreeMap<ClientName, [VecDeque<Scan>; 2]>,
) -> Option<&'w mut [VecDeque<Scan>; 2]> {
    let ahead = |side: usize| waiting.values().map(|both| both[side].len()).sum::<usize>();
    let first = usize::from(ahead(1) < ahead(0));
    let (side, scan) = [first, 1 - first].into_iter().find_map(|side| Some((side, listening[side].recv().ok()?)))?;
    let both = waiting.entry(scan.client.clone()).or_default();
    both[side].push_back(scan);
    Some(both)
}

/// The earliest scan of both; of one if the other has none then.
fn paired(both: &mut [VecDeque<Scan>; 2]) -> [Option<Scan>; 2] {
    let next = both.each_ref().map(|scans| scans.front().map(|scan| scan.t_v));
    let first = next.iter().flatten().min().copied();
    let mut taken = |side: usize| (next[side] == first).then(|| both[side].pop_front()).flatten();
    [taken(0), taken(1)]
}
