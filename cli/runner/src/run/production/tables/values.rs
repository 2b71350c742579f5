//! Histories and histograms of signals as tables.

use onescan_report::Table;
use onescan_report::number::short as number;
use onescan_scenario::report::{HistoryReport, Report, SignalHistory, SignalSpread, SpreadReport};

use super::{at, per_cent, seconds};

const HOUR_NS: u64 = 3_600_000_000_000;
const DAY_NS: u64 = 24 * HOUR_NS;

/// A terminal shows so many windows at both ends of a long history.
const SHOWN_AT_EACH_END: usize = 16;

/// How much of a history is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Extent {
    Whole,
    Ends,
}

/// All of histories and histograms, for pages: shown to who asks for it.
pub(super) fn whole(report: &Report) -> Vec<Table> {
    tables(report, Extent::Whole).into_iter().map(|table| Table { is_folded: true, ..table }).collect()
}

/// The same for terminals, where the middle of long histories is left out.
pub(super) fn short(report: &Report) -> Vec<Table> {
    tables(report, Extent::Ends)
}

fn tables(report: &Report, extent: Extent) -> Vec<Table> {
    let histories = report.histories.iter().map(|history| of_history(history, report.from_ns, extent));
    histories.chain(report.histograms.iter().map(of_spread)).collect()
}

/// The name of a signal with its unit.
fn head(signal: &str, unit: Option<&String>) -> String {
    unit.map_or_else(|| signal.to_owned(), |unit| format!("{signal} ({unit})"))
}

fn of_history(history: &HistoryReport, from_ns: u64, extent: Extent) -> Table {
    let windows = history.signals.iter().map(|signal| signal.mean.len()).max().unwrap_or(0);
    let row = |window: usize| {
        let begin_ns = from_ns.saturating_add((window as u64).saturating_mul(history.window_ns));
        let values = history.signals.iter().map(|signal| values(signal, window));
        std::iter::once(begin(begin_ns, history.window_ns)).chain(values).collect::<Vec<String>>()
    };
    let left_out = match extent {
        Extent::Whole => 0,
        Extent::Ends => windows.saturating_sub(2 * SHOWN_AT_EACH_END),
    };
    let first = if left_out > 0 { SHOWN_AT_EACH_END } else { windows };
    let gap = (left_out > 0).then(|| vec![format!("... {left_out} are left out ...")]);
    Table {
        title: "history",
        head: history.signals.iter().map(|signal| head(&signal.signal, signal.unit.as_ref()).into()).collect(),
        rows: (0..first).map(row).chain(gap).chain((first + left_out..windows).map(row)).collect(),
        remarks: vec![format!("{}: mean (min to max) in windows of {}", history.name, width(history.window_ns))],
        is_folded: false,
    }
}

/// When a window begins, in days or hours where all of them do.
fn begin(begin_ns: u64, window_ns: u64) -> String {
    let is_whole = |unit_ns: u64| begin_ns.is_multiple_of(unit_ns) && window_ns.is_multiple_of(unit_ns);
    match begin_ns {
        days if is_whole(DAY_NS) => format!("{} d", days / DAY_NS),
        hours if is_whole(HOUR_NS) => format!("{} h", hours / HOUR_NS),
        _ => at(begin_ns),
    }
}

/// How wide a window is.
fn width(window_ns: u64) -> String {
    if window_ns.is_multiple_of(HOUR_NS) { begin(window_ns, window_ns) } else { seconds(window_ns) }
}

/// Mean, lowest and highest value of a window; nothing where there is none.
fn values(signal: &SignalHistory, window: usize) -> String {
    let of = |values: &[Option<f64>]| values.get(window).copied().flatten().map(number);
    let all = of(&signal.mean).zip(of(&signal.min)).zip(of(&signal.max));
    all.map_or_else(|| "-".to_owned(), |((mean, min), max)| format!("{mean} ({min} to {max})"))
}

fn of_spread(spread: &SpreadReport) -> Table {
    let bins = spread.signals.iter().map(|signal| signal.time_ns.len()).max().unwrap_or(0);
    let edge = |bin: usize| spread.from + (spread.to - spread.from) * bin as f64 / bins as f64;
    let shares = |name: String, of: &dyn Fn(&SignalSpread) -> u64| {
        let share = |signal: &SignalSpread| match signal.total_ns() {
            0 => "-".to_owned(),
            // bins are many, and most of them empty
            _ if of(signal) == 0 => String::new(),
            total_ns => per_cent(of(signal) as f64 / total_ns as f64),
        };
        std::iter::once(name).chain(spread.signals.iter().map(share)).collect::<Vec<String>>()
    };
    let of_bin = |bin: usize| move |signal: &SignalSpread| signal.time_ns.get(bin).copied().unwrap_or(0);
    let is_used = |of: &dyn Fn(&SignalSpread) -> u64| spread.signals.iter().any(|signal| of(signal) > 0);
    let used: Vec<usize> = (0..bins).filter(|bin| is_used(&of_bin(*bin))).collect();
    let shown = used.first().copied().unwrap_or(0)..used.last().map_or(0, |last| last + 1);
    let mut rows = Vec::new();
    rows.extend(is_used(&|signal| signal.below_ns).then(|| shares("below".to_owned(), &|signal| signal.below_ns)));
    for bin in shown {
        rows.push(shares(format!("{} to {}", number(edge(bin)), number(edge(bin + 1))), &of_bin(bin)));
    }
    rows.extend(is_used(&|signal| signal.above_ns).then(|| shares("above".to_owned(), &|signal| signal.above_ns)));
    let not_finite = |signal: &SignalSpread| signal.not_finite_ns;
    rows.extend(is_used(&not_finite).then(|| shares("not a number".to_owned(), &not_finite)));
    Table {
        title: "histogram",
        head: spread.signals.iter().map(|signal| head(&signal.signal, signal.unit.as_ref()).into()).collect(),
        rows,
        remarks: vec![format!("{}: share of the time in each bin", spread.name)],
        is_folded: false,
    }
}
