//! A signal on a terminal: as it was, as it is, and by how much the two differ.

use onescan_server::signal::SignalType;
use onescan_server::time::VirtualTime;

use super::canvas::Canvas;
use crate::snapshot::Track;

/// Rows of a curve.
const ROWS: usize = 4;
/// Columns before a curve: the name of the row, and the values at its edges.
const LABELS: usize = 18;

/// A span of virtual time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// The first instant that is shown.
    pub from: VirtualTime,
    /// The last instant that is shown, not before `from`.
    pub to: VirtualTime,
}

impl Window {
    /// A whole run.
    pub fn whole(end: VirtualTime) -> Self {
        Self { from: VirtualTime::ZERO, to: end }
    }

    /// The instant after so many of all parts of it.
    fn instant(self, part: usize, of: usize) -> VirtualTime {
        let span = self.to.as_nanos().saturating_sub(self.from.as_nanos()).max(1);
        let after = u128::from(span) * part as u128 / of.max(1) as u128;
        VirtualTime::from_nanos(self.from.as_nanos().saturating_add(after as u64))
    }
}

/// The signal in lines of `width` columns.
pub fn lines(old: Option<&Track>, new: Option<&Track>, window: Window, width: usize) -> Vec<String> {
    let columns = width.saturating_sub(LABELS + 1).max(10);
    let Some(any) = new.or(old) else { return Vec::new() };
    match any.ty {
        SignalType::BOOL => levels(old, new, window, columns),
        ty if ty.as_f64(&vec![0; ty.size()]).is_none() => Vec::new(),
        _ => curves(old, new, window, columns),
    }
}

/// Least and greatest value in each column of a curve.
fn envelope(track: &Track, window: Window, columns: usize) -> Vec<Option<(f64, f64)>> {
    let instant = |column: usize| window.instant(column, columns);
    let number = |bytes: &[u8]| track.ty.as_f64(bytes).filter(|value| value.is_finite());
    (0..columns)
        .map(|column| {
            let (from, to) = (instant(column), instant(column + 1));
            let first = track.changes.partition_point(|(since, _)| *since <= from);
            let inside =
                track.changes[first..].iter().take_while(|(since, _)| *since < to).map(|(_, bytes)| &bytes[..]);
            let values = track.at(from).into_iter().chain(inside).filter_map(number);
            values.fold(None, |range: Option<(f64, f64)>, value| {
                Some(range.map_or((value, value), |(low, high)| (low.min(value), high.max(value))))
            })
        })
        .collect()
}

fn whole(envelopes: &[&[Option<(f64, f64)>]]) -> (f64, f64) {
    let all = envelopes.iter().flat_map(|envelope| envelope.iter().flatten());
    let (low, high) =
        all.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), (least, most)| (low.min(*least), high.max(*most)));
    if low <= high { (low, high) } else { (0.0, 0.0) }
}

fn curves(old: Option<&Track>, new: Option<&Track>, window: Window, columns: usize) -> Vec<String> {
    let dots = columns * 2;
    let of = |track: Option<&Track>| track.map(|track| envelope(track, window, dots));
    let (was, is) = (of(old), of(new));
    let both: Vec<&[Option<(f64, f64)>]> = [&was, &is].into_iter().flatten().map(Vec::as_slice).collect();
    let range = whole(&both);
    let mut lines = Vec::new();
    for (name, curve) in [("old", &was), ("new", &is)] {
        if let Some(curve) = curve {
            lines.extend(curve_lines(name, curve, range, columns));
        }
    }
    if let (Some(old), Some(new)) = (old, new) {
        let difference = envelope(&new.less(old), window, dots);
        let range = whole(&[&difference]);
        if range != (0.0, 0.0) {
            lines.extend(curve_lines("new - old", &difference, range, columns));
        }
    }
    lines
}

fn curve_lines(name: &str, curve: &[Option<(f64, f64)>], (low, high): (f64, f64), columns: usize) -> Vec<String> {
    let mut canvas = Canvas::new(columns, ROWS);
    let top = canvas.height() - 1;
    let span = if high > low { high - low } else { 1.0 };
    let dot = |value: f64| ((value - low) / span * top as f64).round().clamp(0.0, top as f64) as usize;
    let mut before: Option<(usize, usize)> = None;
    for (x, range) in curve.iter().enumerate() {
        let Some((least, most)) = range else {
            before = None;
            continue;
        };
        let (least, most) = (dot(*least), dot(*most));
        // A curve has no gaps: each column begins where the one before ended.
        let (from, to) = match before {
            Some((_, below)) if below + 1 < least => (below + 1, most),
            Some((above, _)) if above > most + 1 => (least, above - 1),
            _ => (least, most),
        };
        canvas.bar(x, from, to);
        before = Some((least, most));
    }
    let last = ROWS - 1;
    let rows = canvas.lines().into_iter().enumerate();
    rows.map(|(row, line)| {
        let name = if row == 0 { name } else { "" };
        let value = if row == 0 {
            short(high)
        } else if row == last {
            short(low)
        } else {
            String::new()
        };
        format!("{name:<9}{value:>8} {}", line.trim_end_matches('\u{2800}'))
    })
    .collect()
}

/// A number in at most eight columns.
fn short(value: f64) -> String {
    let plain = format!("{value:.4}");
    let plain = plain.trim_end_matches('0').trim_end_matches('.');
    let is_tiny = value != 0.0 && value.abs() < 0.001;
    if plain.len() <= 8 && !is_tiny { plain.to_owned() } else { format!("{value:.1e}") }
}

/// BOOLs: a row each, and one that points to where they differ.
fn levels(old: Option<&Track>, new: Option<&Track>, window: Window, columns: usize) -> Vec<String> {
    let level = |range: &Option<(f64, f64)>| match range {
        Some((0.0, 0.0)) => '▁',
        Some((1.0, 1.0)) => '█',
        Some(_) => '▌',
        None => ' ',
    };
    let row = |name: &str, curve: &[Option<(f64, f64)>]| {
        format!("{name:<17} {}", curve.iter().map(level).collect::<String>())
    };
    let of = |track: Option<&Track>| track.map(|track| envelope(track, window, columns));
    let (was, is) = (of(old), of(new));
    let mut lines: Vec<String> = was.iter().map(|curve| row("old", curve)).collect();
    lines.extend(is.iter().map(|curve| row("new", curve)));
    if let (Some(old), Some(new)) = (old, new) {
        let curve = envelope(&new.less(old), window, columns);
        let mark = |range: &Option<(f64, f64)>| if range.is_some_and(|range| range != (0.0, 0.0)) { '^' } else { ' ' };
        let marks: String = curve.iter().map(mark).collect();
        if marks.contains('^') {
            lines.push(format!("{:<17} {}", "differs", marks.trim_end()));
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    fn track(ty: SignalType, changes: &[(u64, f64)]) -> Track {
        let bytes = |value: f64| if ty == SignalType::BOOL { vec![value as u8] } else { value.to_le_bytes().to_vec() };
        let changes =
            changes.iter().map(|(ms, value)| (VirtualTime::from_nanos(ms * 1_000_000), bytes(*value))).collect();
        Track { name: "x".to_owned(), ty, unit: None, sampled: None, changes }
    }

    #[test]
    fn a_curve_stands_beside_its_old_one() {
        let ramp: Vec<(u64, f64)> = (0..100).map(|ms| (ms, ms as f64 / 100.0)).collect();
        let bent: Vec<(u64, f64)> = ramp.iter().map(|(ms, value)| (*ms, value.min(0.5))).collect();
        let (old, new) = (track(SignalType::LREAL, &ramp), track(SignalType::LREAL, &bent));
        insta::assert_snapshot!(
            lines(Some(&old), Some(&new), Window::whole(VirtualTime::from_nanos(100_000_000)), 60).join("\n")
        );
    }

    #[test]
    fn a_pulse_is_seen_and_pointed_to() {
        let old = track(SignalType::BOOL, &[(0, 0.0), (50, 1.0)]);
        let new = track(SignalType::BOOL, &[(0, 0.0), (20, 1.0), (21, 0.0), (50, 1.0)]);
        insta::assert_snapshot!(
            lines(Some(&old), Some(&new), Window::whole(VirtualTime::from_nanos(100_000_000)), 60).join("\n")
        );
    }

    #[test]
    fn no_line_is_too_wide() {
        let wild = track(SignalType::LREAL, &[(0, -1e300), (1, 1e300), (2, f64::NAN), (3, 1e-300)]);
        let all = lines(Some(&wild), Some(&wild), Window::whole(VirtualTime::from_nanos(4_000_000)), 80);
        assert!(all.iter().all(|line| line.chars().count() <= 80), "{all:#?}");
    }
}
