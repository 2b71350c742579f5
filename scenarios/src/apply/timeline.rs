//! What a case does while a session runs, as operations on its timeline.
//!
//! Times are known before the run, so overlapping inputs and forces of a signal are resolved here: of
//! those that cover an instant the last one counts, and forces come after inputs. What waits for a
//! condition is not known before; of these the one that happens last counts.

use std::collections::BTreeMap;
use std::ops::Range;

use onescan_server::operation::Operation;
use onescan_server::signal::{ClientName, SignalName, SignalType, did_you_mean};
use onescan_server::time::{TimeSpan, VirtualTime};
use onescan_server::timeline::{Scheduled, When};
use toml::{Spanned, Value};

use super::period::{Period, period};
use crate::case::file::{CaseFile, FaultFile, ParameterFile, TaskFile, VariableFile};
use crate::case::value::{bytes_of, literal_of};
use crate::case::{Applied, Catalogue, FailureAt, ParameterAt, TaskAt, VariableAt};
use crate::error::ScenarioError;
use crate::expect::KnownSignal;
use crate::file::ClientFile;
use crate::load::Scenario;
use crate::timed::Timed;

/// A value that a signal has for a time.
struct Held {
    from: VirtualTime,
    until: Option<VirtualTime>,
    value: String,
}

impl Held {
    fn covers(&self, t_v: VirtualTime) -> bool {
        self.from <= t_v && self.until.is_none_or(|until| t_v < until)
    }
}

impl Scenario {
    /// Puts what `entry` does while the session runs on the timeline.
    pub(crate) fn schedule(
        &self,
        catalogue: &Catalogue,
        entry: &CaseFile,
        applied: &mut Applied,
    ) -> Result<(), ScenarioError> {
        let known = self.file().known_signals();
        let mut held: BTreeMap<SignalName, Vec<Held>> = BTreeMap::new();
        let mut timeline = Vec::new();
        let mut inputs: Vec<_> = entry.inputs.iter().map(Spanned::get_ref).collect();
        inputs.sort_by_key(|input| input.at);
        for input in inputs {
            let value = self.value(catalogue, &input.signal, &input.value)?;
            let of_signal = held.entry(input.signal.get_ref().clone()).or_default();
            of_signal.push(Held { from: input.at, until: None, value });
        }
        for force in &entry.forces {
            let place = force.span();
            let force = force.get_ref();
            let (signal, value) = (force.signal.get_ref(), self.value(catalogue, &force.signal, &force.value)?);
            let period = period(catalogue, &known, &force.times(), place)?;
            match period {
                Period { begin: When::At(from), end: None } => {
                    held.entry(signal.clone()).or_default().push(Held { from, until: None, value });
                }
                Period { begin: When::At(from), end: Some(When::At(until)) } => {
                    held.entry(signal.clone()).or_default().push(Held { from, until: Some(until), value });
                }
                period => {
                    let release = Operation::Release { signal: signal.clone() };
                    between(&mut timeline, period, Operation::Force { signal: signal.clone(), value }, release);
                }
            }
        }
        for (signal, held) in &held {
            resolve(&mut timeline, signal, held);
        }
        for fault in &entry.faults {
            let failure = self.failure(catalogue, fault)?;
            let period = period_of(catalogue, &known, fault)?;
            let FailureAt { client, component, mode, .. } = failure.clone();
            let repair = Operation::Repair { client: client.clone(), component: component.clone(), mode: mode.clone() };
            between(&mut timeline, period, Operation::Fail { client, component, mode }, repair);
            applied.failures.push(failure);
        }
        let seed = applied.case.seed.unwrap_or(self.file().seed);
        for disturbance in &entry.disturbances {
            let period = period_of(catalogue, &known, disturbance)?;
            for (signal, fault) in self.signal_faults(catalogue, disturbance, seed)? {
                let clear = Operation::Mend { signal: signal.clone() };
                between(&mut timeline, period.clone(), Operation::Disturb { signal, fault }, clear);
            }
        }
        for parameter in &entry.parameters {
            let period = period_of(catalogue, &known, parameter)?;
            let at = self.parameter(catalogue, parameter)?;
            let ParameterAt { client, component, parameter, value, .. } = at.clone();
            let restore = Operation::RestoreParameter {
                client: client.clone(),
                component: component.clone(),
                parameter: parameter.clone(),
            };
            let change = Operation::ChangeParameter { client, component, parameter, value };
            between(&mut timeline, period, change, restore);
            applied.parameters.push(at);
        }
        for variable in &entry.variables {
            self.variable(catalogue, variable, &known, &mut timeline, &mut applied.variables)?;
        }
        for task in &entry.tasks {
            let period = period_of(catalogue, &known, task)?;
            let (at, by) = self.late_task(catalogue, task)?;
            let TaskAt { client, task, .. } = at.clone();
            let in_time = Operation::CatchUp { client: client.clone(), task: task.clone(), by };
            between(&mut timeline, period, Operation::Postpone { client, task, by }, in_time);
            applied.tasks.push(at);
        }
        // By time, so that the file of events and the plot's marks read like the run; a stable sort keeps
        // the order of the case where times are equal, and conditions last.
        timeline.sort_by_key(|scheduled: &Scheduled| match scheduled.when {
            When::At(at) => (false, at),
            When::Once { .. } => (true, VirtualTime::ZERO),
        });
        applied.timeline = timeline;
        Ok(())
    }

    pub(super) fn type_of(
        &self,
        catalogue: &Catalogue,
        signal: &Spanned<SignalName>,
    ) -> Result<SignalType, ScenarioError> {
        let name = signal.get_ref();
        self.file().signals.get(name).map(|declared| declared.get_ref().ty).ok_or_else(|| {
            let help = did_you_mean(name.as_str(), self.file().signals.keys().map(SignalName::as_str));
            catalogue.wrong(format!("the scenario has no signal `{name}`"), Some(signal.span()), help)
        })
    }

    /// A value of a signal, as the text of an operation.
    fn value(
        &self,
        catalogue: &Catalogue,
        signal: &Spanned<SignalName>,
        value: &Spanned<Value>,
    ) -> Result<String, ScenarioError> {
        let ty = self.type_of(catalogue, signal)?;
        let bytes = bytes_of(ty, value.get_ref()).map_err(|wanted| {
            let message = format!("`{}` is {ty}: {} is not {wanted}", signal.get_ref(), value.get_ref());
            catalogue.wrong(message, Some(value.span()), None)
        })?;
        Ok(ty.to_text(&bytes))
    }

    /// The only client of a kind, or the one that is named.
    pub(super) fn chosen(
        &self,
        catalogue: &Catalogue,
        named: Option<&Spanned<String>>,
        of_kind: impl Fn(&ClientFile) -> bool,
        (kind, what, place): (&str, &str, Range<usize>),
    ) -> Result<ClientName, ScenarioError> {
        let clients = self.file().clients.iter();
        let found: Vec<&ClientName> =
            clients.filter(|(_, client)| of_kind(client.get_ref())).map(|(name, _)| name).collect();
        match (named, &found[..]) {
            (Some(named), found) => {
                let same = found.iter().find(|name| name.as_str() == named.get_ref());
                same.map(|name| (*name).clone()).ok_or_else(|| {
                    let message = format!("the scenario has no {kind} `{}`", named.get_ref());
                    let help = did_you_mean(named.get_ref(), found.iter().map(|name| name.as_str()));
                    catalogue.wrong(message, Some(named.span()), help)
                })
            }
            (None, [only]) => Ok((*only).clone()),
            (None, []) => Err(catalogue.wrong(format!("the scenario has no {kind} {what}"), Some(place), None)),
            (None, [one, ..]) => {
                let help = format!("say which, as in `client = \"{one}\"`");
                Err(catalogue.wrong(format!("the scenario has more than one {kind}"), Some(place), Some(help)))
            }
        }
    }

    /// The component that fails, its plant named or found.
    pub(crate) fn failure(
        &self,
        catalogue: &Catalogue,
        fault: &Spanned<FaultFile>,
    ) -> Result<FailureAt, ScenarioError> {
        let FaultFile { client, component, mode, .. } = fault.get_ref();
        let what = ("plant", "whose components could fail", component.span());
        let is_plant = |client: &ClientFile| matches!(client, ClientFile::Plant { .. });
        let client = self.chosen(catalogue, client.as_ref(), is_plant, what)?;
        let place = component.span().start..mode.span().end.max(component.span().end);
        Ok(FailureAt { client, component: component.get_ref().clone(), mode: mode.get_ref().clone(), place })
    }

    /// Which parameter changes, and its value.
    fn parameter(&self, catalogue: &Catalogue, entry: &Spanned<ParameterFile>) -> Result<ParameterAt, ScenarioError> {
        let ParameterFile { client, component, parameter, value, .. } = entry.get_ref();
        let what = ("plant", "whose parameters could change", component.span());
        let is_plant = |client: &ClientFile| matches!(client, ClientFile::Plant { .. });
        let client = self.chosen(catalogue, client.as_ref(), is_plant, what)?;
        let Some(text) = literal_of(value.get_ref()) else {
            let message = "a parameter takes a number, `true` or `false`, or a word".to_owned();
            return Err(catalogue.wrong(message, Some(value.span()), None));
        };
        Ok(ParameterAt {
            client,
            component: component.get_ref().clone(),
            parameter: parameter.get_ref().clone(),
            value: text,
            place: entry.span(),
        })
    }

    fn variable(
        &self,
        catalogue: &Catalogue,
        entry: &Spanned<VariableFile>,
        known: &[KnownSignal],
        timeline: &mut Vec<Scheduled>,
        checked: &mut Vec<VariableAt>,
    ) -> Result<(), ScenarioError> {
        let place = entry.span();
        let VariableFile { client, variable, value, at, .. } = entry.get_ref();
        let what = ("soft PLC", "whose variables could be set", variable.span());
        let is_plc = |client: &ClientFile| matches!(client, ClientFile::SoftPlc { .. });
        let client = self.chosen(catalogue, client.as_ref(), is_plc, what)?;
        let Some(value) = literal_of(value.get_ref()) else {
            let message = "a variable takes a number, a BOOL or a literal as text".to_owned();
            return Err(catalogue.wrong(message, Some(value.span()), None));
        };
        let variable = variable.get_ref().clone();
        let value_at = VariableAt { client: client.clone(), variable: variable.clone(), value: value.clone(), place };
        let place = value_at.place.clone();
        checked.push(value_at);
        if let Some(at) = at {
            if entry.get_ref().says_when() {
                let help = "`at` writes once; `from`, `until`, `when`, `nth` and `for` force for a time".to_owned();
                let message = format!("`{variable}` is both written and forced");
                return Err(catalogue.wrong(message, Some(place), Some(help)));
            }
            let operation = Operation::WriteVariable { client, variable, value };
            timeline.push(Scheduled { when: When::At(*at), operation });
            return Ok(());
        }
        let release = Operation::ReleaseVariable { client: client.clone(), variable: variable.clone() };
        let force = Operation::ForceVariable { client, variable, value };
        between(timeline, period(catalogue, known, &entry.get_ref().times(), place)?, force, release);
        Ok(())
    }

    /// Which task is late, and by how much.
    fn late_task(&self, catalogue: &Catalogue, entry: &Spanned<TaskFile>) -> Result<(TaskAt, TimeSpan), ScenarioError> {
        let TaskFile { client, task, by, .. } = entry.get_ref();
        let what = ("soft PLC", "whose tasks could be late", entry.span());
        let is_plc = |client: &ClientFile| matches!(client, ClientFile::SoftPlc { .. });
        let client = self.chosen(catalogue, client.as_ref(), is_plc, what)?;
        let wrong = |message: String, help: Option<&str>| {
            Err(catalogue.wrong(message, Some(by.span()), help.map(str::to_owned)))
        };
        let step = self.file().step;
        let task = task.as_ref().map(|task| task.get_ref().clone());
        match by.get_ref().parse::<TimeSpan>() {
            Ok(span) if span.is_multiple_of(step) => Ok((TaskAt { client, task, place: entry.span() }, span)),
            Ok(span) => {
                let message = format!("{span} is not a multiple of the session's step, {step}");
                wrong(message, Some("tasks are late by whole steps"))
            }
            Err(error) => wrong(format!("`by` is not a time: {error}"), Some("as in `by = \"20ms\"`")),
        }
    }

    /// What a session of this scenario does by itself while it runs.
    pub fn timeline(&self) -> &[Scheduled] {
        self.applied().map_or(&[], |applied| &applied.timeline)
    }

    /// What the case does to a run from outside, by virtual time in nanoseconds; what waits for a
    /// condition has no time before the run.
    pub fn case_events(&self) -> Vec<(u64, String)> {
        let event = |Scheduled { when, operation }: &Scheduled| match when {
            When::At(at) => Some((at.as_nanos(), described(operation))),
            When::Once { .. } => None,
        };
        let mut events: Vec<_> = self.timeline().iter().filter_map(event).collect();
        events.sort();
        events
    }
}

/// When an entry begins and ends.
fn period_of<Entry: Timed>(
    catalogue: &Catalogue,
    known: &[KnownSignal],
    entry: &Spanned<Entry>,
) -> Result<Period, ScenarioError> {
    period(catalogue, known, &entry.get_ref().times(), entry.span())
}

/// An operation as the mark of a plot: short, without marks of code.
fn described(operation: &Operation) -> String {
    match operation {
        Operation::Force { signal, value } => format!("{signal} held at {value}"),
        Operation::Release { signal } => format!("{signal} let go"),
        Operation::Disturb { signal, fault } => format!("{signal} {fault}"),
        Operation::Mend { signal } => format!("{signal} mended"),
        Operation::Fail { component, mode, .. } => format!("{component} fails: {mode}"),
        Operation::Repair { component, mode, .. } => format!("{component} works again: {mode}"),
        Operation::ChangeParameter { component, parameter, value, .. } => format!("{component}.{parameter} = {value}"),
        Operation::RestoreParameter { component, parameter, .. } => format!("{component}.{parameter} as before"),
        Operation::WriteVariable { variable, value, .. } => format!("{variable} set to {value}"),
        Operation::ForceVariable { variable, value, .. } => format!("{variable} held at {value}"),
        Operation::ReleaseVariable { variable, .. } => format!("{variable} let go"),
        Operation::Postpone { task, by, .. } => {
            format!("{} late by {by}", task.as_deref().unwrap_or("all tasks"))
        }
        Operation::CatchUp { task, .. } => format!("{} in time again", task.as_deref().unwrap_or("all tasks")),
        other => other.to_string(),
    }
}

/// The operations that give a signal its values, one at each instant at which its value changes.
fn resolve(timeline: &mut Vec<Scheduled>, signal: &SignalName, held: &[Held]) {
    let mut instants: Vec<VirtualTime> =
        held.iter().flat_map(|held| std::iter::once(held.from).chain(held.until)).collect();
    instants.sort_unstable();
    instants.dedup();
    let mut before: Option<&str> = None;
    for at in instants {
        let now = held.iter().rfind(|held| held.covers(at)).map(|held| held.value.as_str());
        let signal = signal.clone();
        let operation = match (before, now) {
            (Some(before), Some(now)) if before == now => continue,
            (_, Some(value)) => Operation::Force { signal, value: value.to_owned() },
            (Some(_), None) => Operation::Release { signal },
            (None, None) => continue,
        };
        timeline.push(Scheduled { when: When::At(at), operation });
        before = now;
    }
}

fn between(timeline: &mut Vec<Scheduled>, period: Period, begin: Operation, end: Operation) {
    timeline.push(Scheduled { when: period.begin, operation: begin });
    timeline.extend(period.end.map(|when| Scheduled { when, operation: end }));
}

#[cfg(test)]
mod tests {
    use super::*;

    fn resolved(held: &[(u64, Option<u64>, &str)]) -> Vec<String> {
        let at = VirtualTime::from_nanos;
        let held: Vec<Held> = held
            .iter()
            .map(|(from, until, value)| Held { from: at(*from), until: until.map(at), value: (*value).to_owned() })
            .collect();
        let mut timeline = Vec::new();
        resolve(&mut timeline, &SignalName::new("x").unwrap(), &held);
        let ns = |when: &When| if let When::At(at) = when { at.as_nanos() } else { 0 };
        timeline.iter().map(|one| format!("{} {}", ns(&one.when), described(&one.operation))).collect()
    }

    #[test]
    fn of_overlapping_forces_the_last_one_counts() {
        assert_eq!(resolved(&[(5, None, "1"), (9, None, "2")]), ["5 x held at 1", "9 x held at 2"]);
        assert_eq!(
            resolved(&[(5, None, "1"), (7, Some(9), "2")]),
            ["5 x held at 1", "7 x held at 2", "9 x held at 1"],
            "behind a force the operator's input is there again"
        );
        assert_eq!(resolved(&[(5, Some(9), "1"), (3, Some(6), "2")]), ["3 x held at 2", "6 x held at 1", "9 x let go"]);
        assert_eq!(resolved(&[(5, Some(9), "1"), (9, Some(12), "1")]), ["5 x held at 1", "12 x let go"]);
    }
}
