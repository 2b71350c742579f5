//! A report as pictures: throughput over time, histograms of cycle times, down time by cause, histories and histograms of
//! signals.

use onescan_report::page::Picture;
use onescan_report::plot::{Bar, Bars, Histogram, History, Panel, Past, Plot, Shape, Trajectory, ValueHistogram};
use onescan_scenario::report::{
    CauseReport, CountReport, CycleReport, DownTimeReport, HistoryReport, Report, SignalHistory, SignalSpread,
    SpreadReport,
};

use super::tables::{per_cent, seconds};

const HOUR_NS: f64 = 3.6e12;

/// What there is to draw of a report.
pub fn of(report: &Report) -> Vec<Picture> {
    let throughput = throughput(report).map(|plot| Picture::of_plot("throughput", &plot));
    let histograms = report.cycles.iter().filter_map(histogram);
    let histograms = histograms.map(|histogram| Picture::still("cycle times", histogram.to_svg()));
    let down = report.down_time.as_ref().map(|down| Picture::still("down time", bars(down).to_svg()));
    let histories = report.histories.iter().map(|past| history(past, report.from_ns, report.to_ns));
    let histories = histories.map(|history| Picture::still("history", history.to_svg()));
    let spreads = report.histograms.iter().flat_map(|all| all.signals.iter().map(move |one| spread(all, one)));
    let spreads = spreads.map(|spread| Picture::still("histogram", spread.to_svg()));
    throughput.into_iter().chain(histograms).chain(down).chain(histories).chain(spreads).collect()
}

/// A panel a count; nothing if nothing was counted at any time.
fn throughput(report: &Report) -> Option<Plot> {
    let panels: Vec<Panel> = report.counts.iter().map(|count| panel(count, report.from_ns, report.to_ns)).collect();
    let seen = panels.iter().any(|panel| panel.runs.iter().any(|run| !run.values.is_empty()));
    let window_ns = report.counts.first().map_or(0, |count| count.throughput.window_ns);
    let line = format!("per hour, in windows of {}", seconds(window_ns));
    seen.then(|| Plot { title: String::new(), runs: vec![line], panels, marks: Vec::new() })
}

/// Pieces in an hour, window by window. The last window may be shorter than the others.
fn panel(count: &CountReport, from_ns: u64, to_ns: u64) -> Panel {
    let window_ns = count.throughput.window_ns;
    let mut line = Trajectory::default();
    for (index, pieces) in (0_u64..).zip(&count.throughput.counts) {
        let begin_ns = from_ns.saturating_add(index.saturating_mul(window_ns));
        let end_ns = begin_ns.saturating_add(window_ns).min(to_ns);
        if end_ns > begin_ns {
            line.t_ns.extend([begin_ns, end_ns]);
            line.values.extend([*pieces as f64 * HOUR_NS / (end_ns - begin_ns) as f64; 2]);
        }
    }
    Panel {
        signal: count.name.clone(),
        unit: Some("1/h".to_owned()),
        shape: Shape::Step,
        names: Vec::new(),
        runs: vec![line],
    }
}

fn histogram(cycle: &CycleReport) -> Option<Histogram> {
    let (times, bins) = (cycle.times.as_ref()?, cycle.histogram.as_ref()?);
    let outside = |count: u64, word: &str| (count > 0).then(|| format!(", {count} {word} than shown"));
    let outside = [outside(bins.shorter, "shorter"), outside(bins.longer, "longer")].into_iter().flatten();
    let (count, median, p95) = (cycle.count, seconds(times.median_ns), seconds(times.p95_ns));
    let remark = format!("{count} cycles, median {median}, 95 % {p95}{}", outside.collect::<String>());
    Some(Histogram {
        title: cycle.name.clone(),
        remark,
        from_ns: bins.from_ns,
        bin_ns: bins.bin_ns,
        counts: bins.counts.clone(),
    })
}

/// The longest in all first, as in a Pareto chart; planned ones are grey.
fn bars(down: &DownTimeReport) -> Bars {
    let mut causes: Vec<&CauseReport> = down.causes.iter().collect();
    causes.sort_by_key(|cause| std::cmp::Reverse(cause.total_ns));
    let bar = |cause: &CauseReport| {
        let share = cause.share.map(|share| format!(", {}", per_cent(share))).unwrap_or_default();
        let times = if cause.count == 1 { "once".to_owned() } else { format!("{} times", cause.count) };
        let planned = if cause.planned { ", planned" } else { "" };
        Bar {
            name: cause.name.clone(),
            value: cause.total_ns as f64,
            label: format!("{}{share}, {times}{planned}", seconds(cause.total_ns)),
            is_faint: cause.planned,
        }
    };
    let title = format!("down {} of {}", seconds(down.down_ns), seconds(down.down_ns.saturating_add(down.run_ns)));
    Bars { title, bars: causes.into_iter().map(bar).collect() }
}

fn history(history: &HistoryReport, from_ns: u64, to_ns: u64) -> History {
    let past = |SignalHistory { signal, unit, min, mean, max }: &SignalHistory| {
        let values = min.iter().zip(mean).zip(max);
        let windows = values.map(|((min, mean), max)| Some([(*min)?, (*mean)?, (*max)?])).collect();
        Past { signal: signal.clone(), unit: unit.clone(), windows }
    };
    History {
        title: history.name.clone(),
        from_ns,
        to_ns,
        window_ns: history.window_ns,
        signals: history.signals.iter().map(past).collect(),
    }
}

fn spread(all: &SpreadReport, one: &SignalSpread) -> ValueHistogram {
    let total_ns = one.total_ns().max(1) as f64;
    let share = |time_ns: u64| time_ns as f64 / total_ns;
    let outside = [(one.below_ns, "below"), (one.above_ns, "above"), (one.not_finite_ns, "not a number")];
    let outside = outside.into_iter().filter(|(time_ns, _)| *time_ns > 0);
    let outside: Vec<String> = outside.map(|(time_ns, word)| format!("{} {word}", per_cent(share(time_ns)))).collect();
    ValueHistogram {
        title: format!("{}: {}", all.name, one.signal),
        remark: outside.join(", "),
        unit: one.unit.clone(),
        from: all.from,
        to: all.to,
        shares: one.time_ns.iter().map(|time_ns| share(*time_ns)).collect(),
    }
}
