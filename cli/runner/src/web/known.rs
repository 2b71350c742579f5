//! What the server knows of a session beside its structure, to answer what pages ask.

use std::collections::{BTreeMap, BTreeSet};

use onescan_scenario::map_file::MapFile;
use onescan_scenario::panel_picture::PanelPicture;
use onescan_server::operation::SignalFault;
use onescan_server::signal::{ClientName, SignalName};

use super::drawings::States;
use super::looks::Judge;
use super::online::Online;
use super::picture::Stage;
use super::training::AtWork;

/// What does not change while the session runs.
#[derive(Debug, Default)]
pub(super) struct Known {
    /// Which of the page's bodies move with which.
    pub(super) stage: Stage,
    /// The plant of each component.
    pub(super) plants: BTreeMap<String, ClientName>,
    /// Clients that are people.
    pub(super) operators: BTreeSet<ClientName>,
    /// The faults on the way of signals that panels begin and end, each with what it does to its signals.
    pub(super) disturbances: Vec<Vec<(SignalName, SignalFault)>>,
    /// Panels that are not on this page.
    pub(super) hidden: BTreeSet<String>,
    /// Where the states of drawings are.
    pub(super) states: States,
    /// How many alarms there are.
    pub(super) alarms: usize,
    /// Which looks are on.
    pub(super) looks: Judge,
    /// The panels, each with the signals that it writes.
    pub(super) panels: BTreeMap<String, BTreeSet<String>>,
    /// Those of them with a key that resets the session, each with the signals of such keys.
    pub(super) resetting: BTreeMap<String, BTreeSet<String>>,
    /// PLCs that somebody may have to start by hand when the session begins again.
    pub(super) by_hand: Vec<ClientName>,
    /// What lies behind them.
    pub(super) pictures: Vec<PanelPicture>,
    /// The PLCs, as they are looked into.
    pub(super) online: Online,
    /// The panels of trainers.
    pub(super) trainers: BTreeSet<String>,
    /// The maps, as the scenario has them.
    pub(super) maps: Vec<MapFile>,
}

impl Known {
    /// The numbers of the panels' disturbances that are at work: all of their signals have them.
    pub(super) fn disturbed(&self, at_work: &AtWork) -> BTreeSet<usize> {
        let is_on = |all: &[(SignalName, SignalFault)]| all.iter().all(|(signal, fault)| at_work.has(signal, fault));
        self.disturbances.iter().enumerate().filter(|(_, all)| is_on(all)).map(|(number, _)| number).collect()
    }
}
