//! `[timing]` bound to the signals and clients of its scenario.

use std::collections::BTreeSet;
use std::ops::Range;

use onescan_server::signal::{ClientName, SignalName, did_you_mean};
use onescan_server::time::TimeSpan;
use toml::Spanned;

use crate::arrays;
use crate::error::{ScenarioError, Wrong};
use crate::file::{ClientFile, ScenarioFile};
use crate::load::Scenario;
use crate::timing_file::{LateFile, TaskTimingFile};

/// One thing that may happen otherwise in time.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Leeway {
    /// What changes of these signals in a step arrives late: a signal alone, or a frame.
    Late {
        /// The signals.
        signals: Vec<SignalName>,
        /// By so many steps at most.
        steps: u64,
        /// They are a frame, and not a signal by itself.
        together: bool,
    },
    /// A change of the signal arrives a step after those of others in the same step.
    Behind {
        /// The signal.
        signal: SignalName,
        /// The others.
        others: Vec<SignalName>,
    },
    /// One scan of a task comes late.
    Jitter {
        /// The task.
        task: TimedTask,
        /// By so many steps at most.
        steps: u64,
    },
    /// All scans of a task come later.
    Phase {
        /// The task.
        task: TimedTask,
        /// By so many steps at most.
        steps: u64,
    },
    /// A scan of a task takes two cycles.
    TwoCycles {
        /// The task.
        task: TimedTask,
    },
    /// A PLC is started late.
    Start {
        /// The PLC.
        client: ClientName,
        /// By so many steps at most.
        steps: u64,
    },
}

/// A task whose times are known.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TimedTask {
    /// The PLC.
    pub client: ClientName,
    /// Its name.
    pub name: String,
    /// It is due each time that so much has passed.
    pub interval: TimeSpan,
}

/// What a task may do, its PLC known.
#[derive(Clone, Debug)]
pub(crate) struct TaskLeeway {
    client: ClientName,
    written: TaskTimingFile,
    place: Range<usize>,
}

/// `[timing]`, but for what is known only of PLCs that are made.
#[derive(Clone, Debug, Default)]
pub(crate) struct Timing {
    signals: Vec<Leeway>,
    tasks: Vec<TaskLeeway>,
    starts: Vec<(ClientName, u64, Range<usize>)>,
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
                timing.signals.push(Leeway::Late { signals: signals.collect(), steps, together });
            } else {
                timing.signals.extend(signals.map(|one| Leeway::Late { signals: vec![one], steps, together }));
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
            timing.signals.push(Leeway::Behind { signal: signal.clone(), others });
        }
    }
    for task in &file.timing.task {
        let client = plc(file, task.get_ref().client.as_ref(), task.span())?;
        timing.tasks.push(TaskLeeway { client, written: task.get_ref().clone(), place: task.span() });
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
        steps => Ok(steps),
    }
}

fn steps_of(file: &ScenarioFile, late: &LateFile) -> Result<u64, Wrong> {
    match (late.by.as_nanos() / file.step.as_nanos().max(1), late.signals.first()) {
        (0, Some(written)) => {
            let message = format!("`{}` is late by less than a step, {}", written.get_ref(), file.step);
            Err(wrong(message, written.span(), Some("time goes on in whole steps")))
        }
        (steps, _) => Ok(steps),
    }
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

impl Scenario {
    /// All that `[timing]` allows. PLCs are compiled if it names tasks.
    ///
    /// # Errors
    /// A task is not there or cannot be late, or a PLC does not compile.
    pub fn leeways(&self) -> Result<Vec<Leeway>, ScenarioError> {
        let mut all = self.timing().signals.clone();
        for leeway in &self.timing().tasks {
            self.task_leeways(leeway, &mut all)?;
        }
        for (client, steps, place) in &self.timing().starts {
            let plc = self.plc(client)?;
            let late = plc.plc().check_late(None);
            late.map_err(|error| self.wrong_timing(format!("`{client}`: {error}"), place, None))?;
            all.push(Leeway::Start { client: client.clone(), steps: *steps });
        }
        Ok(all)
    }

    fn task_leeways(&self, leeway: &TaskLeeway, all: &mut Vec<Leeway>) -> Result<(), ScenarioError> {
        let TaskLeeway { client, written, place } = leeway;
        let plc = self.plc(client)?;
        let tasks = &plc.plc().plan().tasks;
        let named = match (&written.task, &tasks[..]) {
            (Some(named), _) => named.get_ref().clone(),
            (None, [only]) => only.name.clone(),
            (None, all) => {
                let help = all.first().map(|one| format!("say which, as in `task = \"{}\"`", one.name));
                return Err(self.wrong_timing(format!("`{client}` has {} tasks", all.len()), place, help));
            }
        };
        let late = plc.plc().check_late(Some(&named));
        late.map_err(|error| self.wrong_timing(format!("`{client}`: {error}"), place, None))?;
        let Some((name, interval)) = tasks
            .iter()
            .find(|task| task.name.eq_ignore_ascii_case(&named))
            .and_then(|task| Some((task.name.clone(), task.interval?)))
        else {
            return Ok(());
        };
        let task = TimedTask { client: client.clone(), name, interval };
        let steps = |span: TimeSpan| -> Result<u64, ScenarioError> {
            let steps = span.as_nanos() / self.file().step.as_nanos().max(1);
            if steps == 0 || span >= interval {
                let message = format!(
                    "task `{}` can be late by whole steps of {} that are less than its interval, {interval}; not by {span}",
                    task.name,
                    self.file().step
                );
                let help = "a scan that is late by a whole interval is left out: `two_cycles = true`".to_owned();
                return Err(self.wrong_timing(message, place, Some(help)));
            }
            Ok(steps)
        };
        if written.late.is_none() && written.phase.is_none() && !written.two_cycles {
            let help = "write `late`, `phase` or `two_cycles = true`".to_owned();
            let message = format!("what task `{}` may do is not said", task.name);
            return Err(self.wrong_timing(message, place, Some(help)));
        }
        let jitter = written.late.map(&steps).transpose()?;
        let phase = written.phase.map(&steps).transpose()?;
        all.extend(jitter.map(|steps| Leeway::Jitter { task: task.clone(), steps }));
        all.extend(phase.map(|steps| Leeway::Phase { task: task.clone(), steps }));
        all.extend(written.two_cycles.then(|| Leeway::TwoCycles { task: task.clone() }));
        Ok(())
    }
}
