//! The verdicts of a campaign, by fault and activation.

use std::collections::BTreeMap;
use std::path::Path;

use onescan_scenario::case::campaign::{CampaignFault, CampaignProgram};
use onescan_scenario::case::{Campaign, CampaignVerdict, Case};
use onescan_server::signal::SignalName;
use serde::Serialize;

use super::reading::{Failure, Reading};
use onescan_regress::regress::plan::suite_of;

/// What came of a campaign.
#[derive(Clone, Debug)]
pub struct Table {
    /// The scenario's folder.
    pub scenario: String,
    /// The campaign's name in `cases.toml`.
    pub campaign: String,
    /// What it is about.
    pub about: Option<String>,
    /// Its faults, in the order of the file.
    pub faults: Vec<CampaignFault>,
    /// The names of its columns: the activations, in the order of the file, each with all variants.
    pub activations: Vec<String>,
    /// How many variants it has: combinations of its matrix.
    pub variants: usize,
    /// The programs that were tried beside the scenario's own.
    pub programs: Vec<Program>,
    /// The verdicts with which it is passed.
    pub accepted: Vec<CampaignVerdict>,
    /// The run without faults of each variant.
    pub healthy: Vec<Reading>,
    /// All activations of the first fault, then those of the second.
    pub rows: Vec<Row>,
}

/// A program that was tried beside the scenario's own, and what it makes of the same faults.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Program {
    /// Its name.
    pub name: String,
    /// What it is, in one line: of a mutant, its place and the change.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub about: Option<String>,
    /// How its run without faults failed; the first of them with a matrix.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub failure: Option<Failure>,
    /// Runs with faults.
    pub runs: usize,
    /// The cases of which another verdict came than with the scenario's own program.
    pub others: Vec<String>,
}

/// What came of one fault at one activation. Its JSON form is a contract: fields are added, never changed.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// The case, as `onescan run --case` takes it.
    pub case: String,
    /// The program with which it was tried, if that is not the scenario's own.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub program: Option<String>,
    /// What came of it.
    pub verdict: CampaignVerdict,
    /// The end of the step in which the fault came.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub activated_ns: Option<u64>,
    /// How much later the control detected it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub detected_after_ns: Option<u64>,
    /// Whether the machine was safe, if the campaign says what that means.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub safe: Option<bool>,
    /// Whether something came to harm, if the campaign says what that means.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub collision: Option<bool>,
    /// The readouts whose trajectories are not those of the run without faults, beside the signals that the fault itself
    /// holds or disturbs.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub effects: Vec<String>,
    /// Whether the state at the end, with all that clients remember, is that of the run without faults: from there on both
    /// would go on alike. Absent if it failed, or if a client cannot save its state.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rejoined: Option<bool>,
    /// Where the run ended early because its state was that of the run without faults: the rest was read out of that one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub joined_ns: Option<u64>,
    /// How often each alarm of the scenario's `[report]` came from the fault on, of those that did.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub alarms: BTreeMap<String, u64>,
    /// The failure that ended the run.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub failure: Option<Failure>,
    /// Why the run came to no end.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unfinished: Option<String>,
    /// The digest over all steps.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub digest: Option<String>,
    /// Virtual time of the last step.
    pub virtual_time_ns: u64,
}

impl Table {
    /// The table of these rows.
    pub(super) fn new(scenario: &Path, campaign: &Campaign, healthy: Vec<Reading>, rows: Vec<Row>) -> Self {
        let column = |(activation, (suffix, _)): (&String, &(String, Case))| format!("{activation}{suffix}");
        let activations = campaign.activations.iter();
        let columns = activations.flat_map(|one| campaign.variants.iter().map(move |variant| (one, variant)));
        Self {
            scenario: suite_of(scenario),
            campaign: campaign.name.clone(),
            about: campaign.about.clone(),
            faults: campaign.faults.clone(),
            activations: columns.map(column).collect(),
            variants: campaign.variants.len(),
            programs: programs(campaign, &healthy, &rows),
            accepted: campaign.accepted.clone(),
            healthy,
            rows,
        }
    }

    /// How many ended so.
    pub fn count(&self, verdict: CampaignVerdict) -> usize {
        self.rows.iter().filter(|row| row.verdict == verdict).count()
    }

    /// True if its verdict is one with which the campaign is passed. What comes of another program is reported beside
    /// it: whether the campaign is passed depends on the scenario's own.
    pub fn is_accepted(&self, row: &Row) -> bool {
        row.program.is_some() || self.accepted.contains(&row.verdict)
    }

    /// True if all verdicts are.
    pub fn is_passed(&self) -> bool {
        self.rows.iter().all(|row| self.is_accepted(row))
    }

    /// Each fault with its rows.
    pub fn by_fault(&self) -> impl Iterator<Item = (&CampaignFault, &[Row])> {
        self.faults.iter().zip(self.rows.chunks(self.activations.len().max(1)))
    }
}

/// What the programs of a campaign make of its faults.
fn programs(campaign: &Campaign, healthy: &[Reading], rows: &[Row]) -> Vec<Program> {
    let count = campaign.variants.len().max(1);
    let program = |CampaignProgram { name, about }: &CampaignProgram| {
        let is_it = |variant: usize| campaign.program_of(variant) == Some(name.as_str());
        let own = |number: usize| rows.get(number - number % count + campaign.own_program_of(number % count));
        let tried = || rows.iter().enumerate().filter(|(number, _)| is_it(number % count));
        let others = tried().filter(|(number, row)| own(*number).is_some_and(|own| own.verdict != row.verdict));
        let failures = healthy.iter().enumerate().filter(|(variant, _)| is_it(*variant));
        Program {
            name: name.clone(),
            about: about.clone(),
            failure: failures.into_iter().find_map(|(_, reading)| reading.failure.clone()),
            runs: tried().count(),
            others: others.map(|(_, row)| row.case.clone()).collect(),
        }
    };
    campaign.programs.iter().map(program).collect()
}

/// The row of a run. `own` are the signals that the fault itself holds or disturbs.
pub(super) fn row(
    case: &Case,
    reading: Reading,
    healthy: &Reading,
    readouts: &[SignalName],
    own: &[SignalName],
) -> Row {
    let compared = readouts.iter().zip(reading.readouts.iter().zip(&healthy.readouts));
    let differs =
        |(signal, (now, healthy)): &(&SignalName, (&String, &String))| now != healthy && !own.contains(signal);
    let effects: Vec<String> = compared.filter(differs).map(|(signal, _)| signal.to_string()).collect();
    Row {
        case: case.name.clone(),
        program: None,
        verdict: verdict(&reading, !effects.is_empty()),
        activated_ns: reading.activated_ns,
        detected_after_ns: reading.detected_after_ns,
        safe: reading.safe,
        collision: reading.collision,
        effects,
        rejoined: reading.state.as_ref().zip(healthy.state.as_ref()).map(|(own, healthy)| own == healthy),
        joined_ns: reading.joined_ns,
        alarms: reading.alarms,
        failure: reading.failure,
        unfinished: reading.unfinished,
        digest: reading.digest,
        virtual_time_ns: reading.virtual_time_ns,
    }
}

/// The first of these that holds, in the order of [`CampaignVerdict::ALL`].
fn verdict(reading: &Reading, has_effect: bool) -> CampaignVerdict {
    let of_plc = reading.failure.as_ref().map(|failure| failure.of_plc);
    match reading {
        Reading { unfinished: Some(_), .. } => CampaignVerdict::Unfinished,
        Reading { activated_ns: None, .. } => CampaignVerdict::NotActivated,
        _ if of_plc == Some(true) => CampaignVerdict::PlcFault,
        // A client that is not a PLC stopped the run: that is harm, whatever else was seen of it.
        _ if of_plc == Some(false) => CampaignVerdict::Collision,
        _ if !has_effect => CampaignVerdict::NoEffect,
        Reading { collision: Some(true), .. } => CampaignVerdict::Collision,
        Reading { detected_after_ns: Some(_), .. } => CampaignVerdict::Detected,
        Reading { safe: Some(true), .. } => CampaignVerdict::Safe,
        _ => CampaignVerdict::Missed,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_several_verdicts_the_first_counts() {
        let mut reading =
            Reading { detected_after_ns: Some(0), safe: Some(true), collision: Some(true), ..Reading::default() };
        let failure = Failure { text: String::new(), of_plc: true, place: None };
        reading.failure = Some(failure);
        reading.unfinished = Some(String::new());
        let mut verdicts = vec![verdict(&reading, true)];
        reading.unfinished = None;
        verdicts.push(verdict(&reading, true));
        reading.activated_ns = Some(0);
        verdicts.push(verdict(&reading, true));
        reading.failure = None;
        verdicts.push(verdict(&reading, false));
        verdicts.push(verdict(&reading, true));
        reading.collision = Some(false);
        verdicts.push(verdict(&reading, true));
        reading.detected_after_ns = None;
        verdicts.push(verdict(&reading, true));
        reading.safe = None;
        verdicts.push(verdict(&reading, true));
        assert_eq!(verdicts, CampaignVerdict::ALL);
    }
}
