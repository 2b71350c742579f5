//! The signals of a session, as the page reads them.

use std::collections::BTreeMap;

use onescan_scenario::Scenario;
use onescan_scenario::file::SignalFile;
use onescan_server::signal::SignalDecl;
use schemars::JsonSchema;
use serde::Serialize;

/// A signal of the session. Signals are named by their place in its list.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct Signal {
    name: String,
    #[serde(rename = "type")]
    ty: String,
    writer: String,
    unit: Option<String>,
    #[schemars(default)]
    about: String,
    /// Names of values.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    #[schemars(default)]
    names: BTreeMap<i64, String>,
}

/// The signals of a scenario, in the order of its plan.
pub(super) fn of(scenario: &Scenario) -> Vec<Signal> {
    scenario.plan().signals().iter().map(|declared| signal(declared, scenario)).collect()
}

/// The signals that the scenario plots, by their places, from top to bottom.
pub(super) fn plotted(scenario: &Scenario) -> Vec<usize> {
    let declared = scenario.plan().signals();
    let plotted = scenario.file().plot.signals.iter();
    plotted.filter_map(|name| declared.iter().position(|signal| signal.name == *name.get_ref())).collect()
}

/// A signal as the scenario declares it.
pub(super) fn written(scenario: &Scenario, declared: &SignalDecl) -> Option<SignalFile> {
    scenario.file().signals.get(&declared.name).map(|signal| signal.get_ref().clone())
}

fn signal(declared: &SignalDecl, scenario: &Scenario) -> Signal {
    let file = written(scenario, declared);
    let names = file.as_ref().map(|file| file.names.pairs()).into_iter().flatten();
    Signal {
        name: declared.name.to_string(),
        ty: declared.ty.to_string(),
        writer: declared.writer.as_ref().map(ToString::to_string).unwrap_or_default(),
        unit: declared.unit.clone(),
        about: file.as_ref().and_then(|file| file.about.clone()).unwrap_or_default(),
        names: names.collect(),
    }
}
