//! What operators did, as entries of a case.

use std::collections::BTreeMap;

use onescan_scenario::Scenario;
use onescan_scenario::case::written::{Entry, List, to_text};
use onescan_scenario::file::ClientFile;
use onescan_server::operation::{Operation, OperatorInput, SignalFault};
use onescan_server::signal::{SignalName, SignalType};
use onescan_server::time::VirtualTime;
use toml::{Table, Value};

use crate::error::Usage;

/// Entries that do what the inputs did since the last restart. Who holds virtual time does nothing to the machine.
///
/// # Errors
/// Something was done that no entry of a case says.
pub fn entries(inputs: &[OperatorInput], scenario: &Scenario) -> Result<Vec<Entry>, Usage> {
    let restarts = inputs.iter().map(|input| input.resets).max().unwrap_or(0);
    let mut script = Script { scenario, entries: Vec::new(), open: BTreeMap::new() };
    for input in inputs.iter().filter(|input| input.resets == restarts) {
        // It was taken at a boundary, and acted on the step that begins there.
        let at = input.t_v.checked_add(scenario.plan().step()).unwrap_or(VirtualTime::MAX);
        script.take(&input.operation, at)?;
    }
    // What ended at the boundary at which it began was never seen.
    script.entries.retain(|entry| entry.time("until").is_none_or(|until| until > entry.begin()));
    Ok(script.entries)
}

struct Script<'a> {
    scenario: &'a Scenario,
    entries: Vec<Entry>,
    /// The entries that have no end yet, by what they are about.
    open: BTreeMap<String, usize>,
}

impl Script<'_> {
    fn take(&mut self, operation: &Operation, at: VirtualTime) -> Result<(), Usage> {
        let word = |word: &str| Value::from(word);
        match operation {
            Operation::Pause | Operation::Resume | Operation::Step | Operation::Reset | Operation::Stop => {}
            Operation::Write { signal, value } => {
                let mut keys = self.valued(signal, value)?;
                if self.is_operated(signal) {
                    keys.insert("at".to_owned(), word(&to_text(at)));
                    self.entries.push(Entry { list: List::Input, keys });
                } else {
                    // Its writer writes it again in the step after.
                    keys.insert("for".to_owned(), word(&to_text(VirtualTime::ZERO + self.scenario.plan().step())));
                    self.entries.push(begun(List::Force, keys, at));
                }
            }
            Operation::Force { signal, value } => {
                let keys = self.valued(signal, value)?;
                self.begin(format!("force {signal}"), begun(List::Force, keys, at), at);
            }
            Operation::Release { signal } => self.end(&format!("force {signal}"), at),
            Operation::Disturb { signal, fault } => {
                let mut keys = disturbance(fault, self.ty(signal)?)?;
                keys.insert("signal".to_owned(), word(signal.as_str()));
                self.begin(format!("disturbance {signal}"), begun(List::Disturbance, keys, at), at);
            }
            Operation::Mend { signal } => self.end(&format!("disturbance {signal}"), at),
            Operation::Fail { client, component, mode } => {
                let keys = [("client", client.as_str()), ("component", component), ("mode", mode)];
                let keys = keys.map(|(key, text)| (key.to_owned(), word(text))).into_iter().collect();
                self.begin(format!("fault {client} {component} {mode}"), begun(List::Fault, keys, at), at);
            }
            Operation::Repair { client, component, mode } => {
                self.end(&format!("fault {client} {component} {mode}"), at);
            }
            Operation::ChangeParameter { client, component, parameter, value } => {
                let keys = [("client", client.as_str()), ("component", component), ("parameter", parameter)];
                let mut keys: Table = keys.map(|(key, text)| (key.to_owned(), word(text))).into_iter().collect();
                keys.insert("value".to_owned(), scalar(value));
                self.begin(format!("parameter {client} {component} {parameter}"), begun(List::Parameter, keys, at), at);
            }
            Operation::RestoreParameter { client, component, parameter } => {
                self.end(&format!("parameter {client} {component} {parameter}"), at);
            }
            Operation::WriteVariable { client, variable, value } => {
                let mut keys = variable_keys(client.as_str(), variable, value);
                keys.insert("at".to_owned(), word(&to_text(at)));
                self.entries.push(Entry { list: List::Variable, keys });
            }
            Operation::ForceVariable { client, variable, value } => {
                let keys = variable_keys(client.as_str(), variable, value);
                self.begin(format!("variable {client} {variable}"), begun(List::Variable, keys, at), at);
            }
            Operation::ReleaseVariable { client, variable } => self.end(&format!("variable {client} {variable}"), at),
            Operation::Postpone { client, task, by } => {
                let task_key = task.as_ref().map(|task| ("task".to_owned(), word(task)));
                let by_key = ("by".to_owned(), word(&to_text(VirtualTime::ZERO + *by)));
                let client_key = ("client".to_owned(), word(client.as_str()));
                let keys = [client_key, by_key].into_iter().chain(task_key).collect();
                let about = format!("task {client} {task:?} {by}");
                self.begin(about, begun(List::Task, keys, at), at);
            }
            Operation::CatchUp { client, task, by } => self.end(&format!("task {client} {task:?} {by}"), at),
        }
        Ok(())
    }

    fn begin(&mut self, about: String, entry: Entry, at: VirtualTime) {
        self.end(&about, at);
        self.open.insert(about, self.entries.len());
        self.entries.push(entry);
    }

    /// Ends what began before; nothing if the session had refused to begin it.
    fn end(&mut self, about: &str, at: VirtualTime) {
        if let Some(entry) = self.open.remove(about).and_then(|index| self.entries.get_mut(index)) {
            entry.keys.insert("until".to_owned(), Value::from(to_text(at)));
        }
    }

    fn ty(&self, signal: &SignalName) -> Result<SignalType, Usage> {
        let declared = self.scenario.file().signals.get(signal);
        declared.map(|signal| signal.get_ref().ty).ok_or_else(|| {
            let help = "take what was recorded of this scenario".to_owned();
            Usage::new(format!("an operator wrote `{signal}`, which the scenario does not have"), Some(help))
        })
    }

    /// True if nobody but operators writes the signal.
    fn is_operated(&self, signal: &SignalName) -> bool {
        let file = self.scenario.file();
        let writer = file.signals.get(signal).map(|signal| &signal.get_ref().writer);
        let writer = writer.and_then(|writer| file.clients.get(writer));
        writer.is_some_and(|writer| matches!(writer.get_ref(), ClientFile::Operator { .. }))
    }

    fn valued(&self, signal: &SignalName, value: &str) -> Result<Table, Usage> {
        let ty = self.ty(signal)?;
        let bytes = ty.parse_text(value).map_err(|bad| Usage::new(format!("`{signal}`: {bad}"), None))?;
        let value = value_of(ty, &ty.to_text(&bytes));
        Ok([("signal".to_owned(), Value::from(signal.as_str())), ("value".to_owned(), value)].into_iter().collect())
    }
}

fn begun(list: List, mut keys: Table, at: VirtualTime) -> Entry {
    keys.insert("from".to_owned(), Value::from(to_text(at)));
    Entry { list, keys }
}

/// The value of a parameter as a case has it: a number, a flag, or a word.
fn scalar(text: &str) -> Value {
    let whole = text.parse().ok().map(Value::Integer);
    let number = || text.parse().ok().filter(|number: &f64| number.is_finite()).map(Value::Float);
    let flag = || text.to_ascii_lowercase().parse().ok().map(Value::Boolean);
    whole.or_else(number).or_else(flag).unwrap_or_else(|| Value::from(text))
}

fn variable_keys(client: &str, variable: &str, value: &str) -> Table {
    let keys = [("client", client), ("variable", variable), ("value", value)];
    keys.map(|(key, text)| (key.to_owned(), Value::from(text))).into_iter().collect()
}

/// A value as cases have it, of its text in recordings.
fn value_of(ty: SignalType, text: &str) -> Value {
    use SignalType as E;
    match ty {
        E::BOOL => Value::from(text == "1" || text.eq_ignore_ascii_case("true")),
        E::TIME | E::LTIME => Value::from(format!("{text}ns")),
        E::String(_) | E::Wstring(_) | E::Bytes(_) => Value::from(text),
        E::Elementary(_) => {
            let whole = text.parse::<i64>().map(Value::from);
            whole.or_else(|_| text.parse::<f64>().map(Value::from)).unwrap_or_else(|_| Value::from(text))
        }
    }
}

fn disturbance(fault: &SignalFault, ty: SignalType) -> Result<Table, Usage> {
    let keys = match fault {
        SignalFault::Stuck => vec![("kind", Value::from("stuck"))],
        SignalFault::Silent => vec![("kind", Value::from("silent"))],
        SignalFault::Cut => vec![("kind", Value::from("cut"))],
        SignalFault::Inverted => vec![("kind", Value::from("inverted"))],
        SignalFault::Offset { by } => vec![("kind", Value::from("offset")), ("by", value_of(ty, by))],
        SignalFault::Late { by } => {
            vec![("kind", Value::from("late")), ("by", Value::from(format!("{}ns", by.as_nanos())))]
        }
        SignalFault::Lost { .. }
        | SignalFault::LostSteps { .. }
        | SignalFault::Pushed { .. }
        | SignalFault::Flipped { .. }
        | SignalFault::Noisy { .. } => {
            let help = "its seed was the operator's own, which no case says; write it into a case".to_owned();
            return Err(Usage::new(format!("an operator let chance disturb a signal: {fault}"), Some(help)));
        }
    };
    Ok(keys.into_iter().map(|(key, value)| (key.to_owned(), value)).collect())
}
