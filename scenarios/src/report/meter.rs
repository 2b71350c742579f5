//! All measures of a run, image by image.

use super::alarm::Alarms;
use super::count::Count;
use super::cycle::Cycles;
use super::down_time::DownTime;
use super::history::History;
use super::measures::Measures;
use super::numbers::Numbers;
use super::result::{Outcome, Report};
use super::spread::Spreading;
use super::windows::Windows;

/// Measures a run as it goes. What it keeps does not grow with the run.
#[derive(Clone, Debug)]
pub struct Meter {
    measures: Measures,
    numbers: Numbers,
    /// From the first image to the last.
    span_ns: Option<(u64, u64)>,
    counts: Vec<Count>,
    cycles: Vec<Cycles>,
    down: Option<DownTime>,
    alarms: Alarms,
    histories: Vec<History>,
    spreads: Vec<Spreading>,
}

impl Meter {
    /// A meter of a run that has not begun.
    pub fn new(measures: &Measures) -> Self {
        Self {
            numbers: Numbers::new(&measures.signals),
            span_ns: None,
            counts: Vec::new(),
            cycles: measures.cycles.iter().map(|timed| Cycles::new(timed.clone(), measures.step)).collect(),
            down: measures.down.clone().map(DownTime::new),
            alarms: Alarms::new(&measures.alarms),
            histories: Vec::new(),
            spreads: measures.spreads.iter().map(|spread| Spreading::new(spread.clone())).collect(),
            measures: measures.clone(),
        }
    }

    /// Takes the image of `t_ns`: the bytes of each signal, in the order of [`Measures::signals`]. A run begins with the
    /// first image; times do not fall.
    pub fn push<'b>(&mut self, t_ns: u64, bytes: impl Iterator<Item = &'b [u8]>) {
        let is_first = self.span_ns.is_none();
        let begin_ns = self.span_ns.map_or(t_ns, |(begin_ns, _)| begin_ns);
        self.span_ns = Some((begin_ns, t_ns));
        if is_first {
            let windows = Windows::new(begin_ns, self.measures.window, self.measures.step);
            let count = |counted: &super::count::Counted| Count::new(counted.clone(), windows.clone());
            self.counts = self.measures.counts.iter().map(count).collect();
            let history = |past: &super::history::Past| History::new(past.clone(), begin_ns, self.measures.step);
            self.histories = self.measures.histories.iter().map(history).collect();
        }
        // Most images show nothing new, and all measures are of what changes.
        if self.numbers.take(bytes) || is_first {
            self.measure(t_ns);
        } else {
            self.alarms.pass(t_ns);
        }
    }

    fn measure(&mut self, t_ns: u64) {
        let Self { numbers, counts, cycles, down, alarms, histories, spreads, .. } = self;
        let values = numbers.values();
        let whole = |column: usize| numbers.whole(column);
        for count in counts {
            count.push(t_ns, values, whole);
        }
        for cycles in cycles {
            cycles.push(t_ns, values);
        }
        if let Some(down) = down {
            down.push(t_ns, values);
        }
        alarms.push(t_ns, values);
        for history in histories {
            history.push(t_ns, values);
        }
        for spread in spreads {
            spread.push(t_ns, values);
        }
    }

    /// What there is to report; nothing of a run without an image.
    pub fn report(&self) -> Option<Report> {
        let span_ns = self.span_ns?;
        let outcome = Outcome {
            counts: self.counts.iter().map(|count| count.until(span_ns)).collect(),
            cycles: self.cycles.iter().map(Cycles::report).collect(),
            down_time: self.down.as_ref().map(|down| down.until(span_ns)),
            alarms: self.alarms.until(span_ns.1),
            histories: self.histories.iter().map(|history| history.until(span_ns.1)).collect(),
            spreads: self.spreads.iter().map(|spread| spread.until(span_ns.1)).collect(),
        };
        Some(Report::new(span_ns, outcome, self.measures.ideal_cycle))
    }
}
