//! The PLCs online: variables that are not signals, what is forced, which lines have been executed.
//!
//! A PLC shows its memory as it lies; where a variable lies in it, the program knows that was compiled. So looking costs the
//! session one copy, whatever is looked at.

use std::collections::BTreeMap;
use std::sync::Arc;

use onescan_iec_run::Variable;
use onescan_scenario::compose::Compiled;
use onescan_scenario::{Scenario, ScenarioError};
use onescan_server::operation::Operation;
use onescan_server::published::SessionView;
use onescan_server::signal::ClientName;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::error::Refused;

/// Variables of one PLC that can be looked at.
const VARIABLES_MAX: usize = 20_000;

/// A PLC whose variables can be looked at. Variables of all PLCs are numbered through.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct Plc {
    client: String,
    variables: Vec<Shown>,
}

#[derive(Debug, Serialize, JsonSchema)]
#[schemars(rename = "Variable")]
struct Shown {
    path: String,
    #[serde(rename = "type")]
    ty: String,
}

/// A PLC as it is looked into.
#[derive(Debug)]
struct Inside {
    client: ClientName,
    compiled: Arc<Compiled>,
    variables: Vec<Variable>,
    /// The number of the first of them among those of all PLCs.
    first: usize,
}

/// All soft PLCs of a session, as they are looked into.
#[derive(Debug, Default)]
pub(super) struct Online {
    plcs: Vec<Inside>,
    /// By path, in capitals: the number of a variable.
    numbers: BTreeMap<(ClientName, String), usize>,
}

/// What is done with a variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(super) enum Action {
    Write,
    Force,
    Release,
}

/// What is reported to a viewer of variables.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub(super) struct Seen {
    /// Number and value of those that have changed.
    values: Vec<(usize, String)>,
    /// All that are forced, of those that are known.
    forced: Vec<usize>,
    /// File and line of all statements that have been executed, where that is noted.
    #[schemars(default)]
    executed: Vec<(String, u32)>,
}

/// What one viewer looks at, and what of it has been reported.
#[derive(Debug, Default)]
pub(super) struct Watching {
    wanted: Option<Vec<usize>>,
    values: BTreeMap<usize, String>,
    forced: Vec<usize>,
    executed: usize,
}

impl Online {
    /// The soft PLCs of a scenario.
    ///
    /// # Errors
    /// A PLC that does not compile; it has just been compiled, so its sources have changed.
    pub(super) fn of(scenario: &Scenario) -> Result<(Vec<Plc>, Self), ScenarioError> {
        let (mut shown, mut online, mut first) = (Vec::new(), Self::default(), 0);
        for plc in scenario.plcs() {
            let Some(compiled) = scenario.compiled_plc(plc.name)? else { continue };
            let variables: Vec<Variable> = compiled.application.leaves().take(VARIABLES_MAX).collect();
            let page = |variable: &Variable| Shown { path: variable.path.clone(), ty: variable.type_name.clone() };
            shown.push(Plc { client: plc.name.to_string(), variables: variables.iter().map(page).collect() });
            for (place, variable) in variables.iter().enumerate() {
                online.numbers.insert((plc.name.clone(), variable.path.to_ascii_uppercase()), first + place);
            }
            let count = variables.len();
            online.plcs.push(Inside { client: plc.name.clone(), compiled, variables, first });
            first += count;
        }
        Ok((shown, online))
    }

    fn plc_of(&self, number: usize) -> Option<(&Inside, &Variable)> {
        let plc = self.plcs.iter().rfind(|plc| plc.first <= number)?;
        Some((plc, plc.variables.get(number - plc.first)?))
    }

    /// The number of the variable at a path of any PLC.
    pub(super) fn number(&self, client: &ClientName, path: &str) -> Option<usize> {
        self.numbers.get(&(client.clone(), path.to_ascii_uppercase())).copied()
    }

    /// Refuses numbers of which there is no variable.
    pub(super) fn check(&self, numbers: &[usize]) -> Result<(), Refused> {
        match numbers.iter().find(|number| self.plc_of(**number).is_none()) {
            Some(unknown) => Err(Refused::NoVariable(*unknown)),
            None => Ok(()),
        }
    }

    /// What `action` is for the session.
    pub(super) fn operation(&self, number: usize, action: Action, value: String) -> Option<Operation> {
        let (plc, variable) = self.plc_of(number)?;
        let (client, variable) = (plc.client.clone(), variable.path.clone());
        Some(match action {
            Action::Write => Operation::WriteVariable { client, variable, value },
            Action::Force => Operation::ForceVariable { client, variable, value },
            Action::Release => Operation::ReleaseVariable { client, variable },
        })
    }
}

impl Watching {
    /// From now on these variables; the next report has all of them.
    pub(super) fn want(&mut self, variables: Vec<usize>) {
        *self = Self { wanted: Some(variables), ..Self::default() };
    }

    /// Whether any variable is looked at.
    pub(super) fn is_wanted(&self) -> bool {
        self.wanted.as_ref().is_some_and(|wanted| !wanted.is_empty())
    }

    /// What is new in a step; nothing if nothing is, nobody looks, or the step does not show it.
    pub(super) fn see(&mut self, view: &SessionView, online: &Online) -> Option<Seen> {
        let wanted = self.wanted.as_ref()?;
        if !view.clients.parts.memories {
            return None;
        }
        let mut seen = Seen::default();
        for memory in &view.clients.memories {
            let Some(plc) = online.plcs.iter().find(|plc| plc.client == memory.client) else { continue };
            for number in wanted.iter().filter(|number| **number >= plc.first) {
                let Some(variable) = plc.variables.get(number - plc.first) else { continue };
                let value = plc.compiled.application.value_text(variable, &memory.bytes);
                if self.values.get(number) != Some(&value) {
                    self.values.insert(*number, value.clone());
                    seen.values.push((*number, value));
                }
            }
            seen.forced.extend(memory.forced.iter().filter_map(|path| online.number(&memory.client, path)));
            let noted = plc.compiled.application.noted_places().zip(&memory.executed);
            let executed = noted.filter(|(_, executed)| **executed != 0).filter_map(|(place, _)| place);
            seen.executed.extend(executed.map(|(file, line)| (file.to_owned(), line)));
        }
        let is_new = !seen.values.is_empty() || seen.forced != self.forced || seen.executed.len() != self.executed;
        (self.forced, self.executed) = (seen.forced.clone(), seen.executed.len());
        is_new.then_some(seen)
    }
}
