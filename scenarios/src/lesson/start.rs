//! Prepared states: the initial conditions of lessons.

use onescan_server::signal::did_you_mean;
use onescan_server::time::VirtualTime;

use super::sheet::Sheet;
use crate::case::Catalogue;
use crate::error::ScenarioError;
use crate::load::Scenario;

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Start {
    pub name: String,
    pub about: Option<String>,
    /// When it is, in the run that makes it.
    pub at: VirtualTime,
    /// The case of that run.
    pub case: Option<String>,
}

/// Adds the prepared states of a file to those of others.
pub(super) fn read_starts(sheet: &Sheet, scenario: &Scenario, starts: &mut Vec<Start>) -> Result<(), ScenarioError> {
    for file in &sheet.file.starts {
        let file = file.get_ref();
        let (name, case) = (file.name.get_ref(), file.case.as_ref());
        if starts.iter().any(|other| other.name == *name) {
            return Err(sheet.wrong(format!("two starts are called `{name}`"), file.name.span(), None));
        }
        if let Some(case) = case {
            let cases = Catalogue::load(scenario.path())?;
            if cases.find(case.get_ref()).is_none() {
                let help = did_you_mean(case.get_ref(), cases.cases().iter().map(|case| case.name.as_str()));
                return Err(sheet.wrong(format!("there is no case `{}`", case.get_ref()), case.span(), help));
            }
        }
        let case = case.map(|case| case.get_ref().clone());
        starts.push(Start { name: name.clone(), about: file.about.clone(), at: file.at, case });
    }
    Ok(())
}
