//! Where two snapshots differ.

use std::collections::{BTreeMap, BTreeSet};

use onescan_report::number::{apart, short};
use onescan_server::time::VirtualTime;
use serde::{Deserialize, Serialize};

use super::value::show;
use super::{Snapshot, Track};

/// One way in which a run is not its snapshot. Its JSON form is a contract: fields are added, never
/// changed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Difference {
    /// Another step, end or sampling: the two cannot be laid over each other.
    Frame {
        /// What it is of: `step`, `end`, or a signal.
        of: String,
        expected: String,
        /// As it was now.
        found: String,
    },
    /// A signal that the snapshot has and the run has not been asked for.
    Gone { signal: String },
    /// A signal that the snapshot has not.
    Added { signal: String },
    /// A signal that has other values.
    Values {
        signal: String,
        #[serde(skip_serializing_if = "Option::is_none")]
        unit: Option<String>,
        /// When it first differs.
        at_ns: u64,
        /// What it should be then.
        expected: String,
        found: String,
        /// How many of the instants that are held differ,
        differing: usize,
        instants: usize,
        /// Of a number, when it is furthest off and by how much.
        #[serde(skip_serializing_if = "Option::is_none")]
        furthest: Option<Furthest>,
    },
    /// A signal all of whose samples are the same, but not what is between them.
    Between {
        signal: String,
        /// How far apart samples are.
        every_ns: u64,
    },
}

/// Where a number is furthest from what it should be.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Furthest {
    pub at_ns: u64,
    /// By how much, in the signal's unit.
    pub by: f64,
}

impl Difference {
    /// The signal, or what else it is of.
    pub fn subject(&self) -> &str {
        match self {
            Self::Frame { of: subject, .. }
            | Self::Gone { signal: subject }
            | Self::Added { signal: subject }
            | Self::Values { signal: subject, .. }
            | Self::Between { signal: subject, .. } => subject,
        }
    }

    /// When it begins; what has no instant comes first.
    pub fn at_ns(&self) -> u64 {
        if let Self::Values { at_ns, .. } = self { *at_ns } else { 0 }
    }
}

impl std::fmt::Display for Difference {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Frame { of, expected, found } => write!(f, "{of}: expected {expected}, found {found}"),
            Self::Gone { signal } => write!(f, "{signal}: in the snapshot, not in the run"),
            Self::Added { signal } => write!(f, "{signal}: in the run, not in the snapshot"),
            Self::Between { signal, every_ns } => {
                let every = onescan_server::time::TimeSpan::from_nanos(*every_ns);
                let every = every.map(|every| every.to_string()).unwrap_or_default();
                write!(f, "{signal}: equal at its samples every {every}, but not between them")
            }
            Self::Values { signal, unit, at_ns, expected, found, differing, instants, furthest } => {
                let unit = unit.as_ref().map(|unit| format!(" ({unit})")).unwrap_or_default();
                let at = VirtualTime::from_nanos(*at_ns);
                let [expected, found] = readable(expected, found);
                write!(f, "{signal}{unit} at {at}: expected {expected}, found {found}")?;
                if *differing > 1 {
                    write!(f, "; {differing} of {instants} instants differ")?;
                }
                match furthest {
                    Some(Furthest { at_ns: most, by }) if most != at_ns => {
                        write!(f, ", most at {}, by {}", VirtualTime::from_nanos(*most), short(*by))
                    }
                    _ => Ok(()),
                }
            }
        }
    }
}

/// Two values as people read them: numbers with a point have no more digits than it takes.
fn readable(expected: &str, found: &str) -> [String; 2] {
    // Only REAL and LREAL are written with a point or a power of ten.
    let number = |text: &str| text.parse::<f64>().ok().filter(|_| text.contains(['.', 'e']));
    match (number(expected), number(found)) {
        (Some(expected), Some(found)) => apart(expected, found),
        _ => [expected.to_owned(), found.to_owned()],
    }
}

/// Where `found` differs from `expected`, the earliest first. A signal with a tolerance may be off by
/// it at every sample; one without is equal in all bits at all steps.
pub fn compare(expected: &Snapshot, found: &Snapshot, tolerances: &BTreeMap<String, f64>) -> Vec<Difference> {
    let mut differences = Vec::new();
    let mut frame = |of: &str, expected: String, found: String| {
        if expected != found {
            differences.push(Difference::Frame { of: of.to_owned(), expected, found });
        }
    };
    frame("step", expected.step.to_string(), found.step.to_string());
    frame("end", expected.end.to_string(), found.end.to_string());
    let now = |name: &str| found.signals.iter().find(|track| track.name == name);
    let reviewed = |name: &str| expected.signals.iter().find(|track| track.name == name);
    for track in &expected.signals {
        match now(&track.name) {
            None => differences.push(Difference::Gone { signal: track.name.clone() }),
            Some(other) => differences.extend(tracks(track, other, tolerances.get(&track.name).copied())),
        }
    }
    for track in found.signals.iter().filter(|track| reviewed(&track.name).is_none()) {
        differences.push(Difference::Added { signal: track.name.clone() });
    }
    differences.sort_by_key(Difference::at_ns);
    differences
}

fn tracks(expected: &Track, found: &Track, tolerance: Option<f64>) -> Option<Difference> {
    let described = |track: &Track| {
        let unit = track.unit.as_ref().map(|unit| format!(" ({unit})")).unwrap_or_default();
        let every = track.sampled.map(|sampled| format!(" every {}", sampled.every)).unwrap_or_default();
        format!("{}{unit}{every}", track.ty)
    };
    if described(expected) != described(found) {
        let (of, expected, found) = (expected.name.clone(), described(expected), described(found));
        return Some(Difference::Frame { of, expected, found });
    }
    let times: BTreeSet<VirtualTime> = expected.changes.iter().chain(&found.changes).map(|(since, _)| *since).collect();
    let mut first = None;
    let mut differing = 0;
    let mut furthest: Option<Furthest> = None;
    for t_v in &times {
        let (Some(wanted), Some(got)) = (expected.at(*t_v), found.at(*t_v)) else { continue };
        let (one, other) = (expected.ty.as_f64(wanted), found.ty.as_f64(got));
        let off = one.zip(other).map(|(one, other)| (other - one).abs());
        let within = tolerance.is_some_and(|tolerance| off.is_some_and(|off| off <= tolerance));
        if wanted == got || within {
            continue;
        }
        first.get_or_insert((*t_v, show(expected.ty, wanted), show(found.ty, got)));
        differing += 1;
        if let Some(by) = off.filter(|by| by.is_finite() && furthest.is_none_or(|furthest| *by > furthest.by)) {
            furthest = Some(Furthest { at_ns: t_v.as_nanos(), by });
        }
    }
    let (signal, unit) = (expected.name.clone(), expected.unit.clone());
    if let Some((at, expected, found)) = first {
        let (at_ns, instants) = (at.as_nanos(), times.len());
        return Some(Difference::Values { signal, unit, at_ns, expected, found, differing, instants, furthest });
    }
    let every_ns = expected.sampled.map_or(0, |sampled| sampled.every.as_nanos());
    let differs = tolerance.is_none() && expected.sampled != found.sampled;
    differs.then_some(Difference::Between { signal, every_ns })
}

#[cfg(test)]
mod tests {
    use super::super::Sampled;
    use super::*;
    use onescan_server::signal::SignalType;
    use onescan_server::time::TimeSpan;

    fn snapshot(values: &[f64], digest: u64) -> Snapshot {
        let step = TimeSpan::from_millis(10).unwrap();
        let at = |index: usize| VirtualTime::from_nanos(index as u64 * 10_000_000);
        let changes = values.iter().enumerate().map(|(index, value)| (at(index), value.to_le_bytes().to_vec()));
        let track = Track {
            name: "x".to_owned(),
            ty: SignalType::LREAL,
            unit: Some("m".to_owned()),
            sampled: Some(Sampled { every: step, digest }),
            changes: changes.collect(),
        };
        Snapshot { scenario: "s".to_owned(), case: "c".to_owned(), step, end: at(9), signals: vec![track] }
    }

    fn reported(one: &Snapshot, other: &Snapshot, tolerance: Option<f64>) -> Vec<String> {
        let tolerances = tolerance.map(|tolerance| ("x".to_owned(), tolerance)).into_iter().collect();
        compare(one, other, &tolerances).iter().map(ToString::to_string).collect()
    }

    #[test]
    fn the_first_and_the_furthest_difference_are_reported() {
        let (one, other) = (snapshot(&[0.0, 1.0, 2.0, 3.0], 1), snapshot(&[0.0, 1.5, 2.0, 5.0], 2));
        assert_eq!(reported(&one, &one, None), [""; 0]);
        let all = "x (m) at 0.010 s: expected 1, found 1.5; 2 of 4 instants differ, most at 0.030 s, by 2";
        assert_eq!(reported(&one, &other, None), [all]);
        let some = "x (m) at 0.030 s: expected 3, found 5";
        assert_eq!(reported(&one, &other, Some(0.5)), [some]);
        assert_eq!(reported(&one, &other, Some(2.0)), [""; 0]);
    }

    #[test]
    fn what_lies_between_samples_counts() {
        let (one, other) = (snapshot(&[0.0, 1.0], 1), snapshot(&[0.0, 1.0], 2));
        assert_eq!(reported(&one, &other, None), ["x: equal at its samples every 10 ms, but not between them"]);
        assert_eq!(reported(&one, &other, Some(0.0)), [""; 0]);
    }

    #[test]
    fn a_nan_is_never_near() {
        let (one, other) = (snapshot(&[0.0, 1.0], 1), snapshot(&[0.0, f64::NAN], 1));
        assert_eq!(reported(&one, &other, Some(9.0)), ["x (m) at 0.010 s: expected 1.0, found NaN"]);
    }
}
