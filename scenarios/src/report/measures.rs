//! What a scenario's `[report]` asks for, bound to its signals.

use onescan_server::signal::{SignalName, SignalType, did_you_mean};
use onescan_server::time::TimeSpan;
use toml::Spanned;

use super::annunciator::Alarm;
use super::count::{Counted, What};
use super::cycle::Timed;
use super::down_time::{Cause, Down, UNKNOWN};
use super::history::Past;
use super::look::Looker;
use super::spread::Spread;
use crate::error::Wrong;
use crate::expect::{KnownSignal, Present};
use crate::expectations::place_within;
use crate::file::ScenarioFile;
use crate::report_file::{AlarmFile, CauseFile, CountFile, CycleFile, DownTimeFile, ReportFile};

/// What is counted and timed in a run.
#[derive(Clone, Debug)]
pub struct Measures {
    pub(super) step: TimeSpan,
    pub(super) window: Option<TimeSpan>,
    pub(super) ideal_cycle: Option<TimeSpan>,
    pub(super) signals: Vec<(SignalName, SignalType)>,
    pub(super) counts: Vec<Counted>,
    pub(super) cycles: Vec<Timed>,
    pub(super) down: Option<Down>,
    pub(super) alarms: Vec<Alarm>,
    pub(super) histories: Vec<Past>,
    pub(super) spreads: Vec<Spread>,
}

impl Measures {
    /// The alarms, in the order of the scenario.
    pub fn alarms(&self) -> &[Alarm] {
        &self.alarms
    }

    /// What `file` asks for, whose text is `text`; nothing if it asks for no report.
    ///
    /// # Errors
    /// A formula that is wrong, a signal that is not there or has the wrong type, two of a kind with one name.
    pub(crate) fn bind(file: &ScenarioFile, text: &str) -> Result<Option<Self>, Wrong> {
        file.report.as_ref().map(|report| Binder::new(file, text).measures(file.step, report)).transpose()
    }

    /// The signals that it looks at with their types, in the order in which a [`super::Meter`] takes their values.
    pub fn signals(&self) -> impl Iterator<Item = (&SignalName, SignalType)> {
        self.signals.iter().map(|(name, ty)| (name, *ty))
    }
}

struct Binder<'a> {
    known: Vec<KnownSignal>,
    text: &'a str,
    columns: Vec<String>,
}

impl<'a> Binder<'a> {
    fn new(file: &ScenarioFile, text: &'a str) -> Self {
        Self { known: file.known_signals(), text, columns: Vec::new() }
    }

    fn measures(mut self, step: TimeSpan, report: &Spanned<ReportFile>) -> Result<Measures, Wrong> {
        let ReportFile { window, ideal_cycle, count, cycle, down_time, alarm, history, histogram } = report.get_ref();
        let has_measure = !count.is_empty() || !cycle.is_empty() || down_time.is_some() || !alarm.is_empty();
        if !has_measure && history.is_empty() && histogram.is_empty() {
            let help = "give it a `[[report.count]]`, `[[report.cycle]]`, `[report.down_time]`, `[[report.alarm]]`, \
                        `[[report.history]]` or `[[report.histogram]]`";
            let message = "the report has nothing to report".to_owned();
            return Err(Wrong { message, place: report.span(), help: Some(help.to_owned()) });
        }
        unique("counts", count.iter().map(|entry| &entry.name))?;
        unique("cycles", cycle.iter().map(|entry| &entry.name))?;
        unique("alarms", alarm.iter().map(|entry| &entry.name))?;
        unique("histories", history.iter().map(|entry| &entry.name))?;
        unique("histograms", histogram.iter().map(|entry| &entry.name))?;
        let counts = count.iter().map(|entry| self.count(entry)).collect::<Result<_, _>>()?;
        let cycles = cycle.iter().map(|entry| self.cycle(entry)).collect::<Result<_, _>>()?;
        let down = down_time.as_ref().map(|entry| self.down(entry)).transpose()?;
        let alarms = alarm.iter().map(|entry| self.alarm(entry)).collect::<Result<_, _>>()?;
        let mut looker = Looker::new(&self.known, &mut self.columns);
        let histories = history.iter().map(|entry| looker.history(entry)).collect::<Result<_, _>>()?;
        let spreads = histogram.iter().map(|entry| looker.histogram(entry)).collect::<Result<_, _>>()?;
        let signals = self.columns.iter().filter_map(|name| {
            let known = self.known.iter().find(|known| known.name == *name)?;
            // Columns are names of the file's own signals.
            Some((SignalName::new(name.as_str()).ok()?, known.ty))
        });
        let signals = signals.collect();
        let (window, ideal_cycle) = (*window, *ideal_cycle);
        Ok(Measures { step, window, ideal_cycle, signals, counts, cycles, down, alarms, histories, spreads })
    }

    fn count(&mut self, entry: &CountFile) -> Result<Counted, Wrong> {
        let CountFile { name, when, counter, quality } = entry;
        let what = match (when, counter) {
            (Some(when), None) => What::Rising(self.formula(when)?),
            (None, Some(counter)) => self.counter(counter)?,
            (when, _) => {
                let both =
                    if when.is_some() { "has both `when` and `counter`" } else { "has no `when` and no `counter`" };
                let message = format!("the count `{}` {both}", name.get_ref());
                let help = "`when` is a formula and counts each time it becomes true; `counter` is a signal that counts \
                            by itself";
                return Err(Wrong { message, place: name.span(), help: Some(help.to_owned()) });
            }
        };
        Ok(Counted { name: name.get_ref().clone(), quality: *quality, what })
    }

    fn counter(&mut self, counter: &Spanned<SignalName>) -> Result<What, Wrong> {
        let name = counter.get_ref().as_str();
        let wrong = |message, help| Wrong { message, place: counter.span(), help };
        let Some(known) = self.known.iter().find(|known| known.name == name) else {
            let help = did_you_mean(name, self.known.iter().map(|known| known.name.as_str()));
            return Err(wrong(format!("the scenario has no signal `{name}`"), help));
        };
        let range = match known.ty {
            SignalType::Elementary(ty) if ty.is_integer() || (ty.is_bits() && known.ty != SignalType::BOOL) => {
                ty.range()
            }
            _ => None,
        };
        let Some(range) = range else {
            let help = (known.ty == SignalType::BOOL).then(|| format!("count its edges: `when = \"{name}\"`"));
            return Err(wrong(format!("`{name}` has the type {}; a counter is a whole number", known.ty), help));
        };
        let column = self.columns.iter().position(|column| column == name).unwrap_or_else(|| {
            self.columns.push(name.to_owned());
            self.columns.len() - 1
        });
        Ok(What::Growth(column, range))
    }

    fn cycle(&mut self, entry: &CycleFile) -> Result<Timed, Wrong> {
        let CycleFile { name, from, to } = entry;
        let from = self.formula(from)?;
        let to = to.as_ref().map(|to| self.formula(to)).transpose()?;
        Ok(Timed { name: name.get_ref().clone(), from, to })
    }

    fn down(&mut self, entry: &Spanned<DownTimeFile>) -> Result<Down, Wrong> {
        let DownTimeFile { when, cause } = entry.get_ref();
        if when.is_none() && cause.is_empty() {
            let help = "give `[report.down_time]` a `when`, or a `[[report.down_time.cause]]`".to_owned();
            let message = "nothing says when the machine is down".to_owned();
            return Err(Wrong { message, place: entry.span(), help: Some(help) });
        }
        unique("causes", cause.iter().map(|cause| &cause.name))?;
        if let Some(taken) = cause.iter().find(|cause| cause.name.get_ref() == UNKNOWN) {
            let message = format!("no cause can be called `{UNKNOWN}`: so the report calls down time without a cause");
            return Err(Wrong { message, place: taken.name.span(), help: None });
        }
        let when = when.as_ref().map(|when| self.formula(when)).transpose()?;
        let causes = cause.iter().map(|cause| {
            let CauseFile { name, when, planned } = cause;
            Ok(Cause { name: name.get_ref().clone(), when: self.formula(when)?, is_planned: *planned })
        });
        Ok(Down { when, causes: causes.collect::<Result<_, _>>()? })
    }

    fn alarm(&mut self, entry: &AlarmFile) -> Result<Alarm, Wrong> {
        let AlarmFile { name, when, priority, on_delay, off_delay } = entry;
        Ok(Alarm {
            name: name.get_ref().clone(),
            priority: *priority,
            when: self.formula(when)?,
            on_delay_ns: on_delay.map_or(0, TimeSpan::as_nanos),
            off_delay_ns: off_delay.map_or(0, TimeSpan::as_nanos),
        })
    }

    fn formula(&mut self, formula: &Spanned<String>) -> Result<Present, Wrong> {
        Present::parse(formula.get_ref(), &self.known, &mut self.columns).map_err(|error| Wrong {
            message: error.to_string(),
            place: place_within(formula, self.text, &error.place),
            help: error.help,
        })
    }
}

/// Refuses two of a kind with one name.
fn unique<'n>(kind: &str, names: impl Iterator<Item = &'n Spanned<String>>) -> Result<(), Wrong> {
    let mut seen: Vec<&str> = Vec::new();
    for name in names {
        if seen.contains(&name.get_ref().as_str()) {
            let message = format!("two {kind} of the report are called `{}`", name.get_ref());
            return Err(Wrong { message, place: name.span(), help: None });
        }
        seen.push(name.get_ref());
    }
    Ok(())
}
