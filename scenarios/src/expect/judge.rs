//! All expectations of a run, judged as it goes.

use std::collections::VecDeque;

use onescan_server::time::VirtualTime;

use super::bind::Expectation;
use super::monitor::Monitor;
use super::sample::{Block, Judged, TraceEnd};
use super::truth::{Margin, Scale, Truth};
use super::verdict::{Outcome, Verdict};

/// Runs of equal samples that are judged at a time.
const BLOCK_RUNS: usize = 256;
/// And samples, about: what an operator within another one says of each of them is kept until then.
const BLOCK_SAMPLES: u64 = 8192;

/// Takes the samples of a run and judges it by expectations.
#[derive(Clone, Debug)]
pub struct Judge {
    expectations: Vec<(Expectation, Monitor)>,
    /// Judged, and may still be reported.
    kept: VecDeque<Block>,
    open: Block,
    /// Emptied, to be filled again.
    free: Vec<Block>,
    columns: usize,
    newest_ns: Option<u64>,
}

impl Judge {
    /// A judge of a run that begins; `columns` are the signals of all expectations.
    pub fn new(expectations: impl IntoIterator<Item = Expectation>, columns: usize) -> Self {
        let monitored = |expectation: Expectation| {
            let monitor = Monitor::new(expectation.formula());
            (expectation, monitor)
        };
        Self {
            expectations: expectations.into_iter().map(monitored).collect(),
            kept: VecDeque::new(),
            open: Block::new(columns),
            free: Vec::new(),
            columns,
            newest_ns: None,
        }
    }

    /// Forgets all samples: the run restarts.
    pub fn begin(&mut self) {
        let expectations = std::mem::take(&mut self.expectations);
        *self = Self::new(expectations.into_iter().map(|(expectation, _)| expectation), self.columns);
    }

    /// Takes a sample: a value for each column. Times that do not increase are not taken: the
    /// sample before them stands.
    pub fn push(&mut self, t_ns: u64, values: impl IntoIterator<Item = f64>) {
        self.push_run(t_ns, 1, 1, values);
    }

    /// Takes `count` samples with the same values, the first at `t_ns`, each `step_ns` behind the one before, which is more
    /// than 0. It is as if they were pushed one by one.
    pub fn push_run(&mut self, t_ns: u64, step_ns: u64, count: u64, values: impl IntoIterator<Item = f64>) {
        let step_ns = step_ns.max(1);
        let gap_ns = self.newest_ns.and_then(|newest_ns| newest_ns.checked_sub(t_ns));
        let old = gap_ns.map_or(0, |gap_ns| gap_ns / step_ns + 1);
        let Some(new) = count.checked_sub(old).filter(|new| *new > 0) else { return };
        let t_ns = t_ns + old * step_ns;
        self.newest_ns = Some(t_ns + (new - 1) * step_ns);
        self.open.push(t_ns, step_ns, new, values);
        if self.open.runs() >= BLOCK_RUNS || self.open.end() - self.open.first() >= BLOCK_SAMPLES {
            self.judge_open();
            self.forget();
        }
    }

    /// What came of each expectation. Without a sample nothing is decided.
    pub fn finish(mut self, end: TraceEnd) -> Vec<Outcome> {
        self.judge_open();
        for (_, monitor) in &mut self.expectations {
            monitor.finish(end);
        }
        self.expectations.iter().map(|(expectation, monitor)| self.outcome(expectation, monitor.first())).collect()
    }

    /// The numbers of expectations that are violated already, whatever comes. What is judged comes in blocks, so that it
    /// lags behind the run.
    pub fn violated(&self) -> impl Iterator<Item = usize> + '_ {
        let is_violated = |monitor: &Monitor| monitor.first().is_some_and(|judged| judged.worth.truth == Truth::False);
        let numbered = self.expectations.iter().enumerate();
        numbered.filter(move |(_, (_, monitor))| is_violated(monitor)).map(|(number, _)| number)
    }

    /// The verdict of each expectation if the run were cut here; nothing for what is open. What is met stays met whatever
    /// comes; what is violated here may be so only because the run ends here.
    pub fn settled(&self) -> Vec<Option<bool>> {
        let truth = |judged: &Judged| match judged.worth.truth {
            Truth::True => Some(true),
            Truth::False => Some(false),
            Truth::Unknown => None,
        };
        let settled = |(_, monitor): &(Expectation, Monitor)| {
            if let Some(judged) = monitor.first() {
                truth(judged)
            } else {
                // An operator without an end says nothing before the run is over, so the run is taken as over.
                let mut cut = monitor.clone();
                cut.push(&self.open);
                cut.finish(TraceEnd::Cut);
                cut.first().and_then(truth)
            }
        };
        self.expectations.iter().map(settled).collect()
    }

    fn judge_open(&mut self) {
        for (_, monitor) in &mut self.expectations {
            monitor.push(&self.open);
        }
        let mut next = self.free.pop().unwrap_or_else(|| Block::new(self.columns));
        next.begin(self.open.end());
        self.kept.push_back(std::mem::replace(&mut self.open, next));
    }

    /// Gives away the blocks that no verdict will name: the last one may always be.
    fn forget(&mut self) {
        // What a formula is worth is what it is worth at the first sample, which a negation names whenever it is decided.
        let mut others = vec![0];
        let first = self.expectations.iter().map(|(_, monitor)| monitor.keeps(&mut others)).min();
        let first = first.unwrap_or(u64::MAX).min(self.open.first().saturating_sub(1));
        let mut index = 0;
        while let Some(block) = self.kept.get(index) {
            if block.end() > first || others.iter().any(|number| block.holds(*number)) {
                index += 1;
            } else if let Some(block) = self.kept.remove(index) {
                self.free.push(block);
            }
        }
    }

    fn outcome(&self, expectation: &Expectation, judged: Option<&Judged>) -> Outcome {
        let Some(judged) = judged else { return Outcome { verdict: Verdict::Open, margin: Margin::UNKNOWN } };
        let verdict = match judged.worth.truth {
            Truth::True => Verdict::Met,
            Truth::Unknown => Verdict::Open,
            Truth::False => Verdict::Violated {
                at: VirtualTime::from_nanos(judged.certain.at_ns),
                values: self.values(expectation, judged.certain.sample),
            },
        };
        Outcome { verdict, margin: judged.worth.margin }
    }

    /// What the signals of an expectation were at a sample.
    fn values(&self, expectation: &Expectation, number: u64) -> Vec<(String, f64)> {
        let Some(block) = self.kept.iter().find(|block| block.holds(number)) else { return Vec::new() };
        let value = |(name, column): &(String, usize)| Some((name.clone(), block.value_at(*column, number)?));
        expectation.signals().iter().filter_map(value).collect()
    }
}

#[cfg(test)]
mod tests {
    use onescan_server::signal::SignalType;
    use proptest::prelude::*;

    use super::super::bind::KnownSignal;
    use super::super::offline::Trace;
    use super::*;

    fn window() -> impl Strategy<Value = String> {
        prop_oneof![
            2 => Just(String::new()),
            4 => (0_u64..9, 0_u64..12).prop_map(|(from, length)| format!("[{from}ns,{}ns]", from + length)),
            1 => (0_u64..9).prop_map(|from| format!("[{from}ns,]")),
        ]
    }

    fn formula() -> impl Strategy<Value = String> {
        let signs = prop::sample::select(vec!["<", "<=", ">", ">=", "=", "<>"]);
        let terms = prop::sample::select(vec!["a", "b", "rate(a)", "abs(b) - a", "max(a, b)"]);
        let leaf = prop_oneof![
            6 => (terms, signs, -4_i32..5).prop_map(|(term, sign, limit)| format!("({term} {sign} {limit})")),
            2 => Just("c".to_owned()),
            1 => prop::sample::select(vec!["true", "false"]).prop_map(str::to_owned),
        ];
        leaf.prop_recursive(4, 20, 2, |inner| {
            let one = prop::sample::select(vec!["always", "eventually", "historically", "once"]);
            let two = prop::sample::select(vec!["and", "or", "implies", "iff"]);
            let path = prop::sample::select(vec!["until", "since"]);
            let edge = prop::sample::select(vec!["rose", "fell", "changed"]);
            prop_oneof![
                4 => (one, window(), inner.clone()).prop_map(|(word, window, f)| format!("({word}{window} {f})")),
                2 => (inner.clone(), two, inner.clone()).prop_map(|(f, word, g)| format!("({f} {word} {g})")),
                2 => (inner.clone(), path, window(), inner.clone())
                    .prop_map(|(f, word, window, g)| format!("({f} {word}{window} {g})")),
                1 => inner.clone().prop_map(|f| format!("(not {f})")),
                1 => (edge, inner).prop_map(|(word, f)| format!("{word}({f})")),
            ]
        })
    }

    /// How many equal samples follow each other.
    fn run() -> impl Strategy<Value = u64> {
        prop_oneof![12 => Just(1_u64), 3 => 2_u64..12, 1 => 12_u64..60]
    }

    fn known() -> Vec<KnownSignal> {
        let signal = |name: &str, ty| KnownSignal { name: name.to_owned(), ty, unit: None };
        vec![signal("a", SignalType::LREAL), signal("b", SignalType::LREAL), signal("c", SignalType::BOOL)]
    }

    fn expectation(text: &str) -> Expectation {
        Expectation::parse(text, &known(), &mut ["a", "b", "c"].map(str::to_owned).to_vec()).unwrap()
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2_000))]
        /// The same verdicts, margins, times and values as by looking at the whole run.
        #[test]
        fn a_run_is_judged_as_it_goes_like_as_a_whole(
            formulas in prop::collection::vec(formula(), 1..4),
            samples in prop::collection::vec((1_u64..5, -9_i32..10, prop::num::i8::ANY, any::<bool>(), run()), 0..60),
            start_ns in prop_oneof![Just(0_u64), 0_u64..30],
            cut in any::<bool>(),
            repeat in 1_usize..12,
            asked in any::<bool>(),
        ) {
            let end = if cut { TraceEnd::Cut } else { TraceEnd::Complete };
            let expectations: Vec<_> = formulas.iter().map(|text| expectation(text)).collect();
            let mut judge = Judge::new(expectations.clone(), 3);
            let mut trace = Trace::new(3);
            let mut settled = Vec::new();
            let mut t_ns = start_ns;
            // Longer than a block, too.
            for (dt_ns, a, b, c, count) in samples.iter().cycle().take(samples.len() * repeat) {
                let b = if *b == i8::MIN { f64::NAN } else { f64::from(*b % 8) };
                let values = [f64::from(*a) / 2.0, b, f64::from(u8::from(*c))];
                // Equal samples at once are as good as one by one.
                judge.push_run(t_ns, *dt_ns, *count, values);
                (0..*count).for_each(|number| trace.push(t_ns + number * dt_ns, values));
                // What is met early is met in the end, and looking changes nothing.
                if asked && *dt_ns == 3 {
                    settled.push(judge.settled());
                }
                t_ns += dt_ns * count;
            }
            trace.set_end(end);
            let outcomes = judge.clone().finish(end);
            for (early, outcome) in settled.iter().flat_map(|early| early.iter().zip(&outcomes)) {
                if *early == Some(true) {
                    prop_assert_eq!(&outcome.verdict, &Verdict::Met);
                }
            }
            for ((expectation, text), outcome) in expectations.iter().zip(&formulas).zip(judge.finish(end)) {
                let expected = expectation.judge_offline(&trace);
                prop_assert_eq!(format!("{outcome:?}"), format!("{expected:?}"), "{}", text);
            }
        }
    }

    /// A value holds until the next sample, so the last one of a run may reach into a window that begins later.
    #[test]
    fn a_run_that_ends_before_a_window_begins_decides_nothing_by_its_last_value() {
        let truth = |text: &str, samples: &[(u64, f64)]| {
            let mut judge = Judge::new([expectation(text)], 3);
            for (t_ns, a) in samples {
                judge.push(*t_ns, [*a, 0.0, 0.0]);
            }
            judge.settled().remove(0)
        };
        let text = "not ((a < 0) until[1ns,1ns] (a > 0))";
        assert_eq!(truth(text, &[(0, 0.5)]), None);
        assert_eq!(truth(text, &[(0, 0.5), (1, 0.5)]), Some(true));
        assert_eq!(truth(text, &[(0, 0.5), (3, 0.5)]), Some(false));
        // Neither holds: no sample that comes can change it.
        assert_eq!(truth(text, &[(0, 0.0)]), Some(true));
    }

    /// Samples that are equal are not all looked at where a window cannot distinguish them, and cost nothing then.
    #[test]
    fn a_month_of_equal_samples_is_judged_at_once() {
        let texts =
            ["eventually[100s,700h] a > 5", "always[1s,100h] (a < 9 and not c)", "(a < 3) until[0,720h] (b > 3)"];
        let mut judge = Judge::new(texts.map(expectation), 3);
        let step_ns = 1_000_000;
        let count = 720 * 3600 * 1000;
        judge.push_run(0, step_ns, count, [1.0, 2.0, 0.0]);
        judge.push_run(count * step_ns, step_ns, count, [7.0, 4.0, 0.0]);
        let verdicts = judge.finish(TraceEnd::Complete).into_iter().map(|outcome| outcome.verdict).collect::<Vec<_>>();
        assert!(matches!(verdicts[0], Verdict::Violated { .. }), "{verdicts:?}");
        assert_eq!(verdicts[1], Verdict::Met);
        assert_eq!(verdicts[2], Verdict::Met, "at 720 h, which is within");
    }

    /// What is kept does not grow with the run, where operators without an end stand outermost.
    #[test]
    fn what_is_kept_depends_on_windows_only() {
        let texts = [
            "always a < 100",
            "always (rose(c) implies eventually[0,50ns] b > 3)",
            "(always a < 3) or eventually (a > 100 and once[0,90ns] b > 0)",
            "(a < 100) until (b > 100)",
            "always ((historically b < 9) implies not (c since[3ns,70ns] b > 6))",
            "eventually[200ns,500ns] changed(c)",
            "always[0,100ns] eventually[0,30ns] c",
        ];
        let judged = |steps: u64| {
            let mut judge = Judge::new(texts.map(expectation), 3);
            for step in 0..steps {
                judge.push(step, [(step % 7) as f64, (step % 11) as f64, (step % 2) as f64]);
            }
            (judge.kept.len(), judge.free.len(), judge.expectations.iter().map(|(_, m)| m.held()).sum::<usize>())
        };
        let (short, long) = (judged(256 * 40), judged(256 * 400));
        assert_eq!((short.0, short.1), (long.0, long.1), "blocks");
        // Two stacks hold a window's members up to twice.
        assert!(short.2 < 1_000 && long.2 < 1_000, "{short:?}, {long:?}");
    }
}
