//! The same report from a whole run at hand: each measure by its definition, with no thought for memory.

use onescan_server::signal::SignalType;
use proptest::prelude::*;

use super::alarm::{AlarmTotal, Occurrence};
use super::meter::Meter;
use super::result::Report;
use super::{CauseReport, Measures};
use crate::file::ScenarioFile;

const STEP_NS: u64 = 10_000_000;

const SIGNALS: &str = r#"
    version = 1
    step = "10ms"
    until = "1s"
    [signals]
    A = { type = "BOOL", writer = "x" }
    B = { type = "BOOL", writer = "x" }
    C = { type = "BOOL", writer = "x" }
    N = { type = "USINT", writer = "x" }
    X = { type = "LREAL", writer = "x", unit = "m" }
    [clients.x]
    kind = "operator"
"#;

const MEASURES: &str = r#"
    [report]
    window = "70ms"
    ideal_cycle = "20ms"
    [[report.count]]
    name = "edges"
    when = "A and not C"
    quality = "good"
    [[report.count]]
    name = "growth"
    counter = "N"
    quality = "reject"
    [[report.cycle]]
    name = "A to A"
    from = "A"
    [[report.cycle]]
    name = "A to B"
    from = "A"
    to = "B"
    [report.down_time]
    when = "A or B"
    [[report.down_time.cause]]
    name = "B first"
    when = "B"
    [[report.down_time.cause]]
    name = "then C, as planned"
    when = "C"
    planned = true
    [[report.history]]
    name = "X and N"
    signals = ["X", "N"]
    every = "70ms"
    [[report.history]]
    name = "X in cm"
    signals = ["X"]
    unit = "cm"
    [[report.histogram]]
    name = "X and N"
    signals = ["X", "N"]
    from = -0.5
    to = 100
    bins = 7
    [[report.alarm]]
    name = "B"
    when = "B"
    [[report.alarm]]
    name = "far"
    when = "X > 50 cm"
    [[report.alarm]]
    name = "lasting"
    when = "B"
    on_delay = "30ms"
    off_delay = "20ms"
"#;

/// What `[report]` of a scenario with these signals asks for.
pub(super) fn measures(report: &str) -> Result<Measures, (String, String, Option<String>)> {
    let text = format!("{SIGNALS}{report}");
    let mut file: ScenarioFile =
        toml::from_str(&text).map_err(|error| (error.message().to_owned(), String::new(), None))?;
    crate::structure::expand(&mut file).map_err(|wrong| (wrong.message, String::new(), wrong.help))?;
    match Measures::bind(&file, &text) {
        Ok(measures) => Ok(measures.expect("a report")),
        Err(wrong) => Err((wrong.message, text[wrong.place].to_owned(), wrong.help)),
    }
}

/// An image: A, B, C, N, X.
#[derive(Clone, Copy, Debug)]
pub(super) struct Image(pub(super) bool, pub(super) bool, pub(super) bool, pub(super) u8, pub(super) f64);

impl Image {
    fn bytes(self, name: &str) -> Vec<u8> {
        match name {
            "A" => vec![u8::from(self.0)],
            "B" => vec![u8::from(self.1)],
            "C" => vec![u8::from(self.2)],
            "N" => vec![self.3],
            _ => self.4.to_le_bytes().to_vec(),
        }
    }
}

/// The report of images that follow each other step by step.
pub(super) fn metered(measures: &Measures, first_step: u64, images: &[Image]) -> Report {
    let mut meter = Meter::new(measures);
    let names: Vec<&str> = measures.signals().map(|(name, _)| name.as_str()).collect();
    for (image, step) in images.iter().zip(first_step..) {
        let bytes: Vec<Vec<u8>> = names.iter().map(|name| image.bytes(name)).collect();
        meter.push(step * STEP_NS, bytes.iter().map(Vec::as_slice));
    }
    meter.report().expect("images")
}

/// A whole run, with its times.
struct Run<'i> {
    first_step: u64,
    images: &'i [Image],
}

impl Run<'_> {
    fn t_ns(&self, index: usize) -> u64 {
        (self.first_step + index as u64) * STEP_NS
    }

    fn end_ns(&self) -> u64 {
        self.t_ns(self.images.len() - 1)
    }

    /// Where a condition becomes true.
    fn rises(&self, holds: impl Fn(&Image) -> bool) -> Vec<usize> {
        (1..self.images.len()).filter(|at| holds(&self.images[*at]) && !holds(&self.images[at - 1])).collect()
    }

    /// From where to where a condition holds; without an end if it holds in the last image.
    fn spells(&self, holds: impl Fn(&Image) -> bool) -> Vec<(u64, Option<u64>)> {
        let begins =
            (0..self.images.len()).filter(|at| holds(&self.images[*at]) && (*at == 0 || !holds(&self.images[at - 1])));
        let end = |from: usize| (from..self.images.len()).find(|at| !holds(&self.images[*at]));
        begins.map(|from| (self.t_ns(from), end(from).map(|end| self.t_ns(end)))).collect()
    }

    fn lengths(&self, spells: &[(u64, Option<u64>)]) -> Vec<u64> {
        spells.iter().map(|(from, to)| to.unwrap_or(self.end_ns()) - from).collect()
    }
}

/// The cause that counts in an image: 0 and 1 are named, 2 is unknown.
fn cause(image: &Image) -> Option<usize> {
    let Image(a, b, c, ..) = *image;
    (a || b).then_some(if b {
        0
    } else if c {
        1
    } else {
        2
    })
}

fn check_counts(run: &Run<'_>, report: &Report) {
    let edges: Vec<u64> = run.rises(|image| image.0 && !image.2).into_iter().map(|at| run.t_ns(at)).collect();
    let growths: Vec<(u64, u64)> = (1..run.images.len())
        .map(|at| (run.t_ns(at), super::count::growth(run.images[at - 1].3.into(), run.images[at].3.into(), (0, 255))))
        .collect();
    let edges: Vec<(u64, u64)> = edges.into_iter().map(|t_ns| (t_ns, 1)).collect();
    for (count, all) in report.counts.iter().zip([edges, growths]) {
        assert_eq!(count.count, all.iter().map(|(_, more)| more).sum::<u64>(), "{}", count.name);
        let (width, begin) = (count.throughput.window_ns, run.t_ns(0));
        assert_eq!(width, 70_000_000);
        assert_eq!(count.throughput.counts.len() as u64, (run.end_ns() - begin).div_ceil(width));
        for (window, counted) in (0..).zip(&count.throughput.counts) {
            let within = |t: u64| t > begin + window * width && t <= begin + (window + 1) * width;
            let expected: u64 = all.iter().filter(|(t, _)| within(*t)).map(|(_, more)| more).sum();
            assert_eq!(*counted, expected, "window {window} of {}", count.name);
        }
    }
}

fn check_cycles(run: &Run<'_>, report: &Report) {
    let begins = run.rises(|image| image.0);
    let ends = run.rises(|image| image.1);
    let same: Vec<u64> = begins.windows(2).map(|pair| run.t_ns(pair[1]) - run.t_ns(pair[0])).collect();
    // The last beginning before an end that lies before the next beginning, or with it.
    let between: Vec<u64> = begins
        .iter()
        .enumerate()
        .filter_map(|(index, begin)| {
            let next = begins.get(index + 1).copied().unwrap_or(usize::MAX);
            let end = ends.iter().find(|end| **end > *begin && **end <= next)?;
            Some(run.t_ns(*end) - run.t_ns(*begin))
        })
        .collect();
    let abandoned = begins.len().saturating_sub(between.len());
    for (cycle, mut lengths) in report.cycles.iter().zip([same, between]) {
        assert_eq!(cycle.count, lengths.len() as u64, "{}", cycle.name);
        lengths.sort_unstable();
        let Some(times) = &cycle.times else {
            assert!(lengths.is_empty());
            continue;
        };
        let count = lengths.len() as f64;
        let mean = lengths.iter().sum::<u64>() as f64 / count;
        assert!((times.mean_ns as f64 - mean).abs() <= 0.5 + 1e-6);
        let squares: f64 = lengths.iter().map(|length| (*length as f64 - mean).powi(2)).sum();
        match times.sigma_ns {
            Some(sigma_ns) => assert!((sigma_ns as f64 - (squares / (count - 1.0)).sqrt()).abs() <= 1.0),
            None => assert_eq!(lengths.len(), 1),
        }
        let reached = |per_cent: usize| lengths[(lengths.len() * per_cent).div_ceil(100) - 1];
        assert_eq!((times.min_ns, times.max_ns), (lengths[0], lengths[lengths.len() - 1]));
        assert_eq!((times.median_ns, times.p95_ns), (reached(50), reached(95)));
        let histogram = cycle.histogram.as_ref().expect("times");
        for (bin, counted) in (0..).zip(&histogram.counts) {
            let from = histogram.from_ns + bin * histogram.bin_ns;
            let within = lengths.iter().filter(|length| (from..from + histogram.bin_ns).contains(*length)).count();
            assert_eq!(*counted, within as u64, "bin {bin} of {}", cycle.name);
        }
        let outside = histogram.shorter + histogram.longer;
        assert_eq!(histogram.counts.iter().sum::<u64>() + outside, cycle.count);
    }
    // One that is open at the end has not been abandoned.
    let open = u64::from(begins.last().is_some_and(|last| !ends.iter().any(|end| end > last)));
    assert_eq!(report.cycles[1].abandoned, abandoned as u64 - open);
}

fn check_down_time(run: &Run<'_>, report: &Report) {
    let down = report.down_time.as_ref().expect("asked for");
    let span = run.end_ns() - run.t_ns(0);
    for (index, found) in down.causes.iter().enumerate() {
        let spells = run.spells(|image| cause(image) == Some(index));
        let lengths = run.lengths(&spells);
        let total_ns = lengths.iter().sum();
        let expected = CauseReport {
            name: ["B first", "then C, as planned", "unknown cause"][index].to_owned(),
            planned: index == 1,
            count: spells.len() as u64,
            total_ns,
            longest_ns: lengths.into_iter().max().unwrap_or(0),
            share: (span > 0).then(|| total_ns as f64 / span as f64),
        };
        assert_eq!(*found, expected);
    }
    let failures = run.spells(|image| matches!(cause(image), Some(0 | 2)));
    let repair: u64 = run.lengths(&failures).iter().sum();
    assert_eq!(down.failures, failures.len() as u64);
    assert_eq!(down.run_ns + down.down_ns, span);
    assert_eq!(down.planned_ns, down.down_ns - repair);
    assert_eq!(down.mtbf_ns, down.run_ns.checked_div(down.failures));
    assert_eq!(down.mttr_ns, repair.checked_div(down.failures));
    let planned_to_run = span - down.planned_ns;
    assert_eq!(down.availability, (planned_to_run > 0).then(|| down.run_ns as f64 / planned_to_run as f64));
}

/// Spells with a delay at their beginning and at their end: gaps that are no longer than the second one are none.
fn delayed(spells: &[(u64, Option<u64>)], (on_ns, off_ns): (u64, u64), end_ns: u64) -> Vec<(u64, Option<u64>)> {
    let mut found: Vec<(u64, Option<u64>)> = Vec::new();
    for (from, to) in spells {
        let lasts = |from: u64| to.map_or(end_ns >= from + on_ns, |to| to > from + on_ns);
        let gone = |to: u64| to + off_ns;
        match found.last_mut() {
            // it has not gone yet, or goes at the very time at which it holds again
            Some((_, last)) if last.is_none_or(|last| last >= *from) => *last = to.map(gone),
            _ if lasts(*from) => found.push((from + on_ns, to.map(gone))),
            // too short for its on-delay: it never came
            _ => {}
        }
    }
    found.into_iter().map(|(from, to)| (from, to.filter(|to| *to <= end_ns))).collect()
}

fn check_alarms(run: &Run<'_>, report: &Report) {
    let alarms = report.alarms.as_ref().expect("asked for");
    let b = run.spells(|image| image.1);
    let lasting = delayed(&b, (30_000_000, 20_000_000), run.end_ns());
    let all = [("B", b), ("far", run.spells(|image| image.4 > 0.5)), ("lasting", lasting)];
    let mut listed: Vec<Occurrence> = Vec::new();
    for ((name, spells), total) in all.iter().zip(&alarms.totals) {
        let lengths = run.lengths(spells);
        let expected = AlarmTotal {
            name: (*name).to_owned(),
            count: spells.len() as u64,
            total_ns: lengths.iter().sum(),
            longest_ns: lengths.iter().copied().max().unwrap_or(0),
            active: spells.last().is_some_and(|(_, to)| to.is_none()),
        };
        assert_eq!(*total, expected);
        listed.extend(spells.iter().zip(lengths).map(|((from_ns, to_ns), duration_ns)| Occurrence {
            name: (*name).to_owned(),
            from_ns: *from_ns,
            to_ns: *to_ns,
            duration_ns,
        }));
    }
    // A stable sort: those of one time stay in the order of the alarms.
    listed.sort_by_key(|occurrence| occurrence.from_ns);
    let (first, others) = listed.split_at(listed.len().min(50));
    assert_eq!(alarms.first, first);
    assert_eq!(alarms.left_out, others.len().saturating_sub(50) as u64);
    assert_eq!(alarms.last, others[others.len().saturating_sub(50)..]);
}

/// A value holds from its image to the next: the last one has not held yet.
fn check_values(run: &Run<'_>, report: &Report) {
    let near = |a: Option<f64>, b: Option<f64>| match (a, b) {
        (Some(a), Some(b)) => (a - b).abs() <= 1e-9 * b.abs().max(1.0),
        (a, b) => a == b,
    };
    let of: [fn(&Image) -> f64; 2] = [|image| image.4, |image| f64::from(image.3)];
    let held = &run.images[..run.images.len() - 1];
    let [both, carried] = &report.histories[..] else { panic!("two histories") };
    assert_eq!((both.signals.len(), carried.signals[0].unit.as_deref()), (2, Some("cm")));
    for (signal, value) in both.signals.iter().zip(of) {
        assert_eq!((both.window_ns, signal.mean.len()), (70_000_000, held.len().div_ceil(7)), "{}", signal.signal);
        for (window, images) in held.chunks(7).enumerate() {
            let values: Vec<f64> = images.iter().map(value).collect();
            assert_eq!(signal.min[window], values.iter().copied().reduce(f64::min));
            assert_eq!(signal.max[window], values.iter().copied().reduce(f64::max));
            assert!(near(signal.mean[window], Some(values.iter().sum::<f64>() / values.len() as f64)));
        }
    }
    let most = |values: &[Option<f64>]| values.iter().flatten().copied().reduce(f64::max);
    assert!(near(most(&carried.signals[0].max), most(&both.signals[0].max).map(|most| 100.0 * most)));
    for (signal, value) in report.histograms[0].signals.iter().zip(of) {
        let within = |low: f64, high: f64| held.iter().filter(|image| (low..high).contains(&value(image))).count();
        for (bin, time_ns) in signal.time_ns.iter().enumerate() {
            let edge = |bin: usize| -0.5 + 100.5 * bin as f64 / 7.0;
            let upper = if bin == 6 { f64::next_up(100.0) } else { edge(bin + 1) };
            assert_eq!(*time_ns, within(edge(bin), upper) as u64 * STEP_NS, "bin {bin} of {}", signal.signal);
        }
        assert_eq!(signal.below_ns, within(f64::NEG_INFINITY, -0.5) as u64 * STEP_NS);
        assert_eq!(signal.total_ns(), run.end_ns() - run.t_ns(0));
    }
}

fn check(first_step: u64, images: &[Image]) {
    let report = metered(&measures(MEASURES).expect("measures"), first_step, images);
    let run = Run { first_step, images };
    assert_eq!((report.from_ns, report.to_ns), (run.t_ns(0), run.end_ns()));
    check_counts(&run, &report);
    check_cycles(&run, &report);
    check_down_time(&run, &report);
    check_alarms(&run, &report);
    check_values(&run, &report);
    let (good, reject) = (report.counts[0].count, report.counts[1].count);
    let quality = report.quality.as_ref().expect("both are counted");
    assert_eq!((quality.good, quality.reject), (good, reject));
    if let (Some(oee), Some(down)) = (&report.oee, &report.down_time) {
        // The ideal time of all good pieces, as a part of the planned time.
        let planned_ns = report.to_ns - report.from_ns - down.planned_ns;
        assert!((oee.oee - 20e6 * good as f64 / planned_ns as f64).abs() < 1e-9 * oee.oee.max(1.0));
    }
}

/// Images that mostly stay as they are, as those of machines do.
fn images() -> impl Strategy<Value = Vec<Image>> {
    let change = (any::<bool>(), any::<bool>(), any::<bool>(), any::<u8>(), -1.0..1.0_f64, 1_usize..5);
    proptest::collection::vec(change, 1..200).prop_map(|changes| {
        let held = |(a, b, c, n, x, steps): (bool, bool, bool, u8, f64, usize)| {
            std::iter::repeat_n(Image(a, b, c, n, x), steps)
        };
        changes.into_iter().flat_map(held).collect()
    })
}

proptest! {
    #[test]
    fn a_run_as_it_goes_is_reported_as_one_that_is_over(first_step in 0_u64..100, images in images()) {
        check(first_step, &images);
    }
}

#[test]
fn the_signals_are_those_of_the_measures() {
    let measures = measures(MEASURES).expect("measures");
    let names: Vec<&str> = measures.signals().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["A", "C", "N", "B", "X"]);
    assert!(measures.signals().any(|(name, ty)| name.as_str() == "N" && ty == SignalType::USINT));
}

/// By hand: `_` is nothing, letters are BOOLs that hold.
fn drawn(text: &str) -> Vec<Image> {
    let image = |letter: char| match letter {
        'a' => Image(true, false, false, 0, 0.0),
        'b' => Image(false, true, false, 0, 0.0),
        'c' => Image(false, false, true, 0, 0.0),
        'x' => Image(true, true, true, 0, 0.0),
        'p' => Image(true, false, true, 0, 0.0),
        _ => Image(false, false, false, 0, 0.0),
    };
    text.chars().map(image).collect()
}

#[test]
fn down_time_by_hand() {
    let report = metered(&measures(MEASURES).expect("measures"), 0, &drawn("bb__ap__xc_b"));
    let down = report.down_time.expect("asked for");
    // 110 ms: B at the start (20), A of unknown cause (10), A with C as planned (10), all three, so B (10), B at the end (0).
    let causes: Vec<_> =
        down.causes.iter().map(|cause| (cause.count, cause.total_ns / STEP_NS, cause.longest_ns / STEP_NS)).collect();
    assert_eq!(causes, [(3, 3, 2), (1, 1, 1), (1, 1, 1)]);
    assert_eq!((down.run_ns / STEP_NS, down.planned_ns / STEP_NS, down.failures), (6, 1, 4));
    assert_eq!(down.availability, Some(6.0 / 10.0));
    assert_eq!((down.mtbf_ns, down.mttr_ns), (Some(6 * STEP_NS / 4), Some(STEP_NS)));
}

#[test]
fn two_failures_without_a_gap_are_one() {
    let report = metered(&measures(MEASURES).expect("measures"), 0, &drawn("_abab_"));
    let down = report.down_time.expect("asked for");
    assert_eq!((down.failures, down.causes[0].count, down.causes[2].count), (1, 2, 2));
    assert_eq!(down.mttr_ns, Some(4 * STEP_NS));
}

#[test]
fn cycles_by_hand() {
    // A rises at 1, 4, 6 and 8; B rises at 2 and, with A, at 8.
    let report = metered(&measures(MEASURES).expect("measures"), 0, &drawn("_ab_a_a_x_"));
    let [same, between] = &report.cycles[..] else { panic!("two cycles") };
    assert_eq!((same.count, same.abandoned), (3, 0));
    let times = same.times.as_ref().expect("cycles");
    assert_eq!((times.min_ns, times.median_ns, times.max_ns), (2 * STEP_NS, 2 * STEP_NS, 3 * STEP_NS));
    // 1 to 2, and 6 to 8; what began at 4 began once more at 6; what begins at 8 is open.
    assert_eq!((between.count, between.abandoned), (2, 1));
}

#[test]
fn one_image_is_a_report_without_length() {
    let report = metered(&measures(MEASURES).expect("measures"), 7, &drawn("x"));
    assert_eq!((report.from_ns, report.to_ns), (7 * STEP_NS, 7 * STEP_NS));
    assert_eq!(report.counts[0].per_hour, None);
    let alarms = report.alarms.expect("asked for");
    assert_eq!((alarms.totals[0].count, alarms.totals[0].total_ns, alarms.totals[0].active), (1, 0, true));
}

#[test]
fn a_counter_that_begins_anywhere_counts_its_growth() {
    let images: Vec<Image> = [250, 250, 253, 2, 40, 0, 3].map(|n| Image(false, false, false, n, 0.0)).to_vec();
    let report = metered(&measures(MEASURES).expect("measures"), 0, &images);
    // 3, over the end of the range 5, 38, reset, 3.
    assert_eq!(report.counts[1].count, 3 + 5 + 38 + 3);
}

#[test]
fn many_alarms_are_listed_from_both_ends() {
    let text = "b_".repeat(130);
    let report = metered(&measures(MEASURES).expect("measures"), 0, &drawn(&text));
    let alarms = report.alarms.expect("asked for");
    assert_eq!((alarms.first.len(), alarms.left_out, alarms.last.len()), (50, 30, 50));
    assert_eq!((alarms.first[49].from_ns / STEP_NS, alarms.last[0].from_ns / STEP_NS), (98, 160));
}

#[test]
fn what_is_wrong_has_its_place_and_a_hint() {
    let count = |entry: &str| format!("[[report.count]]\nname = \"pieces\"\n{entry}\n");
    let cause = |name: &str| format!("[[report.down_time.cause]]\nname = \"{name}\"\nwhen = \"A\"\n");
    let history = |entry: &str| format!("[[report.history]]\nname = \"past\"\n{entry}\n");
    let histogram = |entry: &str| format!("[[report.histogram]]\nname = \"spread\"\nsignals = [\"X\"]\n{entry}\n");
    let wrong = [
        "[report]\n".to_owned(),
        "[report.down_time]\n".to_owned(),
        count(""),
        count("when = \"A\"\ncounter = \"N\""),
        count("counter = \"M\""),
        count("counter = \"A\""),
        count("counter = \"X\""),
        count("when = \"A and Bb\""),
        count("when = \"N\""),
        count("when = \"rose(A)\""),
        count("wen = \"A\""),
        count("when = \"A\"") + &count("when = \"B\""),
        cause("stop") + &cause("stop"),
        cause("unknown cause"),
        history("signals = []"),
        history("signals = [\"Y\"]"),
        history("signals = [\"X\", \"X\"]"),
        history("signals = [\"X[1..]\"]"),
        history("signals = [\"X\"]\nunit = \"bar\""),
        history("signals = [\"X\"]\nunit = \"mmm\""),
        history("signals = [\"N\"]\nunit = \"mm\""),
        history("signals = [\"X\"]\nevery = \"0s\""),
        history("signals = [\"X\"]") + &history("signals = [\"N\"]"),
        histogram("from = 1.0"),
        histogram("from = 1.0\nto = 1.0"),
        histogram("from = nan\nto = 1.0"),
        histogram("from = -1.7e308\nto = 1.7e308"),
        histogram("from = 0\nto = 1\nbins = 0"),
        histogram("from = 0\nto = 1\nbins = 1001"),
    ];
    let reported: Vec<String> = wrong
        .iter()
        .map(|report| match measures(report) {
            Ok(_) => format!("accepted: {report}"),
            Err((message, place, help)) => {
                format!("{message}\n    at {place:?}\n    help: {}", help.unwrap_or_default())
            }
        })
        .collect();
    insta::assert_snapshot!(reported.join("\n"));
}
