//! Two snapshots of trajectories, the reviewed one and the one that waits, or any two.

use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, Write};
use std::path::Path;

use onescan_base::regular::Within;
use onescan_report::table;
use onescan_server::signal::SignalName;
use onescan_server::signal::pattern::{SignalPattern, choose};
use onescan_server::time::VirtualTime;
use serde_json::{Value, json};

use super::error::DiffError;
use super::report::NAMES;
use crate::snapshot::store::read;
use crate::snapshot::value::show;
use crate::snapshot::{Difference, Sampled, Snapshot, Track, compare};
use onescan_runner::error::Usage;

/// Signals that are listed for people.
const LISTED: usize = 20;
/// Instants shown before and after the first that differs.
const AROUND_INSTANTS: usize = 4;
/// Most signals of which the surroundings are shown.
const AROUND_SIGNALS: usize = 4;

/// Two snapshots and where they differ.
#[derive(Debug)]
pub struct TrajectoryReport {
    paths: [String; 2],
    snapshots: [Snapshot; 2],
    differences: Vec<Difference>,
}

impl TrajectoryReport {
    /// Compares the snapshots in two files, without tolerances.
    ///
    /// # Errors
    /// A file is not a snapshot; a pattern of no signal.
    pub fn of(paths: [&Path; 2], since: VirtualTime, patterns: &[SignalPattern]) -> Result<Self, DiffError> {
        let one = |path: &Path| -> Result<Snapshot, DiffError> {
            let none = || Usage::new(format!("{} is not there", path.display()), None);
            Ok(read(path, &Within::anywhere())?.ok_or_else(none)?)
        };
        let mut snapshots = [one(paths[0])?, one(paths[1])?];
        choose_signals(&mut snapshots, patterns)?;
        if since > VirtualTime::ZERO {
            snapshots.iter_mut().flat_map(|snapshot| &mut snapshot.signals).for_each(|track| clip(track, since));
        }
        let differences = compare(&snapshots[0], &snapshots[1], &BTreeMap::new());
        Ok(Self { paths: paths.map(|path| path.display().to_string()), snapshots, differences })
    }

    /// True if nothing differs.
    pub fn is_equal(&self) -> bool {
        self.differences.is_empty()
    }

    /// Writes the report for people.
    ///
    /// # Errors
    /// `out` takes no more.
    pub fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        for ((name, path), Snapshot { scenario, case, end, .. }) in NAMES.iter().zip(&self.paths).zip(&self.snapshots) {
            writeln!(out, "{name}  {path}: {scenario}, case {case}, up to {end}")?;
        }
        writeln!(out)?;
        if self.is_equal() {
            return writeln!(out, "no difference");
        }
        if let Some(first) = self.first() {
            writeln!(out, "first difference at t_v = {first}")?;
        }
        self.write_values(out)?;
        self.write_others(out)?;
        self.write_around(out)?;
        let Snapshot { case, .. } = &self.snapshots[1];
        writeln!(out, "\nto find the statement, compare recordings: onescan run SCENARIO --case {case} --record DIR")
    }

    /// When values first differ.
    fn first(&self) -> Option<VirtualTime> {
        let times =
            self.differences.iter().filter(|one| matches!(one, Difference::Values { .. })).map(Difference::at_ns);
        times.min().map(VirtualTime::from_nanos)
    }

    fn write_values(&self, out: &mut dyn Write) -> io::Result<()> {
        let head = ["signal", "t_v", "A", "B", "instants that differ"].map(str::to_owned);
        let rows = self.differences.iter().filter_map(|difference| match difference {
            Difference::Values { signal, unit, at_ns, expected, found, differing, instants, .. } => {
                let unit = unit.as_ref().map(|unit| format!(" ({unit})")).unwrap_or_default();
                let (at, count) = (VirtualTime::from_nanos(*at_ns), format!("{differing} of {instants}"));
                Some(vec![format!("{signal}{unit}"), at.to_string(), expected.clone(), found.clone(), count])
            }
            _ => None,
        });
        let rows: Vec<Vec<String>> = rows.collect();
        if rows.is_empty() {
            return Ok(());
        }
        let more = rows.len().saturating_sub(LISTED);
        table::write(&std::iter::once(head.to_vec()).chain(rows.into_iter().take(LISTED)).collect::<Vec<_>>(), out)?;
        if more > 0 { writeln!(out, "  and {more} more") } else { Ok(()) }
    }

    /// What is no other value: another step, end or sampling, signals that one has not.
    fn write_others(&self, out: &mut dyn Write) -> io::Result<()> {
        for difference in &self.differences {
            match difference {
                Difference::Values { .. } => {}
                Difference::Frame { of, expected, found } => writeln!(out, "  {of}: {expected} in A, {found} in B")?,
                Difference::Gone { signal } => writeln!(out, "  {signal}: in A only")?,
                Difference::Added { signal } => writeln!(out, "  {signal}: in B only")?,
                Difference::Between { .. } => writeln!(out, "  {difference}")?,
            }
        }
        Ok(())
    }

    /// The signals that differ first, at the instants around.
    fn write_around(&self, out: &mut dyn Write) -> io::Result<()> {
        let Some(first) = self.first() else { return Ok(()) };
        let is_first = |one: &&Difference| one.at_ns() == first.as_nanos();
        let named = self.differences.iter().filter(is_first).filter_map(|one| match one {
            Difference::Values { signal, .. } => Some(signal.as_str()),
            _ => None,
        });
        let tracks: Vec<[&Track; 2]> =
            named.take(AROUND_SIGNALS).filter_map(|name| Some([self.track(0, name)?, self.track(1, name)?])).collect();
        let times: BTreeSet<VirtualTime> =
            tracks.iter().flatten().flat_map(|track| &track.changes).map(|(at, _)| *at).collect();
        let before = times.range(..first).rev().take(AROUND_INSTANTS).collect::<Vec<_>>().into_iter().rev();
        let mut rows = vec![vec![String::new(), "t_v".to_owned()]];
        rows[0].extend(tracks.iter().flat_map(|[track, _]| NAMES.map(|name| format!("{} {name}", track.name))));
        for at in before.chain(times.range(first..).take(AROUND_INSTANTS + 1)) {
            let mut row = vec![if *at == first { ">".to_owned() } else { String::new() }, at.to_string()];
            let shown = |track: &&Track| track.at(*at).map_or_else(|| "-".to_owned(), |bytes| show(track.ty, bytes));
            row.extend(tracks.iter().flatten().map(shown));
            rows.push(row);
        }
        writeln!(out, "\naround it")?;
        table::write(&rows, out)
    }

    fn track(&self, index: usize, name: &str) -> Option<&Track> {
        self.snapshots[index].signals.iter().find(|track| track.name == name)
    }

    /// Writes the report as one JSON object. Fields are added, never changed.
    ///
    /// # Errors
    /// `out` takes no more.
    pub fn write_json(&self, out: &mut dyn Write) -> io::Result<()> {
        let of = |index: usize| -> Value {
            let Snapshot { scenario, case, end, .. } = &self.snapshots[index];
            json!({ "path": self.paths[index], "scenario": scenario, "case": case, "virtual_time_ns": end.as_nanos() })
        };
        let report = json!({
            "equal": self.is_equal(),
            "basis": "snapshots",
            "a": of(0),
            "b": of(1),
            "t_v_ns": self.first().map(VirtualTime::as_nanos),
            "differences": self.differences,
        });
        serde_json::to_writer(&mut *out, &report)?;
        writeln!(out)
    }
}

/// Leaves the signals that `patterns` choose of those that either has.
fn choose_signals(snapshots: &mut [Snapshot; 2], patterns: &[SignalPattern]) -> Result<(), DiffError> {
    let all: BTreeSet<SignalName> = snapshots
        .iter()
        .flat_map(|snapshot| &snapshot.signals)
        .filter_map(|track| SignalName::new(track.name.as_str()).ok())
        .collect();
    let all: Vec<SignalName> = all.into_iter().collect();
    let chosen = choose(patterns, all.iter()).map_err(|unmatched| Usage::new(unmatched.to_string(), None))?;
    let chosen: BTreeSet<&str> = chosen.into_iter().map(|index| all[index].as_str()).collect();
    for snapshot in snapshots {
        snapshot.signals.retain(|track| chosen.contains(track.name.as_str()));
    }
    Ok(())
}

/// Leaves what is from `since` on. The digest of all steps says nothing then.
fn clip(track: &mut Track, since: VirtualTime) {
    let held = track.at(since).map(<[u8]>::to_vec);
    track.changes.retain(|(at, _)| *at > since);
    track.changes.splice(0..0, held.map(|bytes| (since, bytes)));
    track.sampled = track.sampled.map(|sampled| Sampled { digest: 0, ..sampled });
}
