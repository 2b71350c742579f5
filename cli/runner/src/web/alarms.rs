//! The alarms of `[[report.alarm]]` as they come and go in what a session publishes.

use std::collections::{BTreeMap, BTreeSet};

use onescan_scenario::Scenario;
use onescan_scenario::expect::Present;
use onescan_server::layout::ImageLayout;
use onescan_server::published::SessionView;
use onescan_server::signal::SignalId;

/// Judges which alarms are on.
#[derive(Clone, Debug, Default)]
pub(super) struct Bell {
    alarms: Vec<(String, Present)>,
    signals: Vec<SignalId>,
}

/// The alarms that one viewer knows to be on.
#[derive(Clone, Debug, Default)]
pub(super) struct ReportedAlarms(BTreeSet<usize>);

/// An alarm that has come or gone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Change<'b> {
    pub(super) kind: &'static str,
    pub(super) name: &'b str,
}

impl Bell {
    /// Of the alarms of a scenario.
    pub(super) fn of(scenario: &Scenario) -> Self {
        let Some(measures) = scenario.measures() else { return Self::default() };
        let signals = scenario.plan().signals();
        let layout = ImageLayout::new(signals);
        let ids: BTreeMap<&str, SignalId> =
            layout.signals().zip(signals).map(|(id, signal)| (signal.name.as_str(), id)).collect();
        Self {
            alarms: measures.alarms().map(|(name, when)| (name.to_owned(), when.clone())).collect(),
            // conditions are on signals of the plan
            signals: measures.signals().filter_map(|(signal, _)| ids.get(signal.as_str()).copied()).collect(),
        }
    }

    /// What has changed for a viewer since the last report.
    pub(super) fn changes(
        &self,
        reported: &mut ReportedAlarms,
        view: &SessionView,
        layout: &ImageLayout,
    ) -> Vec<Change<'_>> {
        let value =
            |signal: &SignalId| layout.ty(*signal).as_f64(layout.bytes(*signal, &view.image)).unwrap_or(f64::NAN);
        let values: Vec<f64> = self.signals.iter().map(value).collect();
        let mut changes = Vec::new();
        for (number, (name, when)) in self.alarms.iter().enumerate() {
            match (when.holds(&values), reported.0.contains(&number)) {
                (true, false) => {
                    reported.0.insert(number);
                    changes.push(Change { kind: "alarm", name });
                }
                (false, true) => {
                    reported.0.remove(&number);
                    changes.push(Change { kind: "gone", name });
                }
                (true, true) | (false, false) => {}
            }
        }
        changes
    }
}
