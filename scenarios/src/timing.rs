//! `[timing]` bound to the signals and clients of its scenario.

use std::collections::BTreeSet;
use std::ops::Range;

use onescan_server::signal::{ClientName, SignalName, did_you_mean};
use onescan_server::time::TimeSpan;
use toml::Spanned;

use crate::arrays;
use crate::error::Wrong;
use crate::file::{ClientFile, ScenarioFile};
use crate::timing_file::{LateFile, TaskTimingFile};

/// The greatest lateness, in steps: a search tries each number of them.
pub(crate) const LATE_STEPS_MAX: u64 = 10_000;

/// One thing that may happen otherwise in time.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TimingTolerance {
    /// What changes of these signals in a step arrives late: a signal alone, or a frame.
    Late {
        signals: Vec<SignalName>,
        /// By so many steps at most.
        steps: u64,
        /// They are a frame, and not a signal by itself.
        together: bool,
    },
    /// A change of the signal arrives a step after those of others in the same step.
    Behind { signal: SignalName, others: Vec<SignalName> },
    /// One scan of a task comes late.
    Jitter {
        task: TimedTask,
        /// By so many steps at most.
        steps: u64,
    },
    /// All scans of a task come later.
    Phase {
        task: TimedTask,
        /// By so many steps at most.
        steps: u64,
    },
    /// A scan of a task takes two cycles.
    TwoCycles { task: TimedTask },
    /// A PLC is started late.
    Start {
        client: ClientName,
        /// By so many steps at most.
        steps: u64,
    },
}

/// A task whose times are known.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TimedTask {
    pub client: ClientName,
    pub name: String,
    /// It is due each time that so much has passed.
    pub interval: TimeSpan,
}

/// What a task may do, its PLC known.
#[derive(Clone, Debug)]
pub(crate) struct TaskTolerance {
    pub(crate) client: ClientName,
    pub(crate) written: TaskTimingFile,
    pub(crate) place: Range<usize>,
}

/// `[timing]`, except for what is known only of PLCs that are made.
#[derive(Clone, Debug, Default)]
pub(crate) struct Timing {
    pub(crate) signals: Vec<TimingTolerance>,
    pub(crate) tasks: Vec<TaskTolerance>,
    pub(crate) starts: Vec<(ClientName, u64, Range<usize>)>,
}

/// `[timing]` of the file, in its order.
pub(crate) fn bind(file: &ScenarioFile) -> Result<Timing, Wrong> {
    let mut timing = Timing::default();
    let mut seen = BTreeSet::new();
    for (all, together) in [(&file.timing.late, false), (&file.timing.together, true)] {
        for late in all {
            let (steps, signals) = (steps_of(file, late)?, names(file, &late.signals)?);
            for (signal, place) in &signals {
                if !seen.insert(signal.clone()) {
                    return Err(wrong(format!("`{signal}` is late twice"), place.clone(), Some("name it once")));
                }
            }
            let signals = signals.into_iter().map(|(signal, _)| signal);
            if together {
                timing.signals.push(TimingTolerance::Late { signals: signals.collect(), steps, together });
            } else {
                timing.signals.extend(signals.map(|one| TimingTolerance::Late { signals: vec![one], steps, together }));
            }
        }
    }
    for order in &file.timing.order {
        let signals: Vec<SignalName> = names(file, &order.signals)?.into_iter().map(|(signal, _)| signal).collect();
        if let ([only], Some(written)) = (&signals[..], order.signals.first()) {
            let message = format!("`{only}` alone has no order");
            return Err(wrong(message, written.span(), Some("name the signals that may arrive before or after it")));
        }
        for signal in &signals {
            let others = signals.iter().filter(|other| *other != signal).cloned().collect();
            timing.signals.push(TimingTolerance::Behind { signal: signal.clone(), others });
        }
    }
    for task in &file.timing.task {
        let client = plc(file, task.get_ref().client.as_ref(), task.span())?;
        timing.tasks.push(TaskTolerance { client, written: task.get_ref().clone(), place: task.span() });
    }
    for start in &file.timing.start {
        let client = plc(file, start.get_ref().client.as_ref(), start.span())?;
        let steps = whole_steps(file, start.get_ref().by, start.span())?;
        timing.starts.push((client, steps, start.span()));
    }
    Ok(timing)
}

fn wrong(message: String, place: Range<usize>, help: Option<&str>) -> Wrong {
    Wrong { message, place, help: help.map(str::to_owned) }
}

fn whole_steps(file: &ScenarioFile, by: TimeSpan, place: Range<usize>) -> Result<u64, Wrong> {
    match by.as_nanos() / file.step.as_nanos().max(1) {
        0 => {
            let message = format!("{by} is less than a step, {}", file.step);
            Err(wrong(message, place, Some("time goes on in whole steps")))
        }
        steps if steps > LATE_STEPS_MAX => Err(too_late(&by.to_string(), place)),
        steps => Ok(steps),
    }
}

fn steps_of(file: &ScenarioFile, late: &LateFile) -> Result<u64, Wrong> {
    match (late.by.as_nanos() / file.step.as_nanos().max(1), late.signals.first()) {
        (0, Some(written)) => {
            let message = format!("`{}` is late by less than a step, {}", written.get_ref(), file.step);
            Err(wrong(message, written.span(), Some("time goes on in whole steps")))
        }
        (steps, Some(written)) if steps > LATE_STEPS_MAX => Err(too_late(&late.by.to_string(), written.span())),
        (steps, _) => Ok(steps),
    }
}

fn too_late(by: &str, place: Range<usize>) -> Wrong {
    let message = format!("{by} is more than {LATE_STEPS_MAX} steps");
    wrong(message, place, Some("`explore` tries each number of steps: allow less"))
}

/// The signals that are meant, each with the place of its name.
fn names(file: &ScenarioFile, written: &[Spanned<SignalName>]) -> Result<Vec<(SignalName, Range<usize>)>, Wrong> {
    let mut all: Vec<(SignalName, Range<usize>)> = Vec::new();
    for written in written {
        let names = arrays::names(written.get_ref().as_str(), written.span());
        for signal in names.map_err(|found| wrong(found.message, written.span(), found.help.as_deref()))? {
            if !file.signals.contains_key(&signal) {
                let help = did_you_mean(signal.as_str(), file.signals.keys().map(SignalName::as_str));
                return Err(Wrong {
                    message: format!("the scenario has no signal `{signal}`"),
                    place: written.span(),
                    help,
                });
            }
            if all.iter().any(|(other, _)| *other == signal) {
                return Err(wrong(format!("`{signal}` is late twice"), written.span(), Some("name it once")));
            }
            all.push((signal, written.span()));
        }
    }
    Ok(all)
}

/// The soft PLC that is named, or the only one.
fn plc(file: &ScenarioFile, named: Option<&Spanned<String>>, place: Range<usize>) -> Result<ClientName, Wrong> {
    let is_plc = |client: &ClientFile| matches!(client, ClientFile::SoftPlc { .. });
    let plcs: Vec<&ClientName> =
        file.clients.iter().filter(|(_, client)| is_plc(client.get_ref())).map(|(name, _)| name).collect();
    match (named, &plcs[..]) {
        (Some(named), plcs) => {
            let found = plcs.iter().find(|name| name.as_str() == named.get_ref());
            found.map(|name| (*name).clone()).ok_or_else(|| {
                let help = did_you_mean(named.get_ref(), plcs.iter().map(|name| name.as_str()));
                let message = format!("the scenario has no soft PLC `{}`", named.get_ref());
                Wrong { message, place: named.span(), help }
            })
        }
        (None, [only]) => Ok((*only).clone()),
        (None, []) => Err(wrong("the scenario has no soft PLC whose times could differ".to_owned(), place, None)),
        (None, [one, ..]) => {
            let help = format!("say which, as in `client = \"{one}\"`");
            Err(wrong("the scenario has more than one soft PLC".to_owned(), place, Some(&help)))
        }
    }
}
