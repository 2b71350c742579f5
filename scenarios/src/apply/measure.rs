//! What a campaign reads out of its runs, bound to the signals of its scenario.

use onescan_server::operation::Operation;
use onescan_server::signal::{SignalName, did_you_mean};
use onescan_server::time::VirtualTime;
use onescan_server::timeline::{Scheduled, When};
use toml::Spanned;

use crate::arrays;
use crate::case::{Campaign, Catalogue};
use crate::error::ScenarioError;
use crate::expect::{Expectation, Reaction};
use crate::file::ClientFile;
use crate::load::Scenario;

/// What is read out of a run, and by which formulas it is measured.
#[derive(Clone, Debug)]
pub struct CampaignMeasures {
    /// The signals in which a fault shows its effect.
    pub readouts: Vec<SignalName>,
    /// The columns of the formulas.
    pub columns: Vec<SignalName>,
    /// The control detects the fault.
    pub detected: Option<Reaction>,
    /// The machine is safe.
    pub safe: Option<Expectation>,
    /// Something comes to harm.
    pub collision: Option<Expectation>,
}

/// What a campaign brings into a run.
#[derive(Clone, Debug)]
pub struct Injected {
    /// The end of the step in which it comes, if that is by time.
    pub at: Option<VirtualTime>,
    /// What comes, if that waits for a condition.
    pub operations: Vec<Operation>,
    /// The signals that it holds or disturbs: they are not an effect of it.
    pub signals: Vec<SignalName>,
    /// When it is over.
    pub over: Over,
}

/// When nothing of a campaign's fault is to come any more.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Over {
    /// It lasts to the end of the run.
    Never,
    At(VirtualTime),
    /// That depends on when a condition comes true.
    Unknown,
}

impl Scenario {
    /// What `campaign` measures by, on the signals of this scenario.
    ///
    /// # Errors
    /// A formula is wrong, or a signal is not there.
    pub fn campaign_measures(
        &self,
        catalogue: &Catalogue,
        campaign: &Campaign,
    ) -> Result<CampaignMeasures, ScenarioError> {
        let (known, mut columns) = (self.file().known_signals(), Vec::new());
        let mut bound = |formula: &Option<Spanned<String>>| {
            let Some(formula) = formula else { return Ok(None) };
            let parsed = Expectation::parse(formula.get_ref(), &known, &mut columns);
            parsed.map(Some).map_err(|error| {
                let place = catalogue.place_within(formula, &error.place);
                catalogue.wrong(error.to_string(), Some(place), error.help)
            })
        };
        let file = &campaign.file;
        let (detected, safe, collision) = (bound(&file.detected)?, bound(&file.safe)?, bound(&file.collision)?);
        let detected = match (detected, &file.detected) {
            (Some(detected), Some(written)) => Some(Reaction::new(&detected).ok_or_else(|| {
                let message = "this formula does not show how long detection takes".to_owned();
                let help = "write `eventually[0,2s] f` or `within 2s f`".to_owned();
                catalogue.wrong(message, Some(written.span()), Some(help))
            })?),
            _ => None,
        };
        let columns = columns.iter().filter_map(|column| SignalName::new(column.as_str()).ok()).collect();
        Ok(CampaignMeasures { readouts: self.readouts(catalogue, campaign)?, columns, detected, safe, collision })
    }

    /// Refuses a campaign that names what the scenario does not have, before anything runs.
    ///
    /// # Errors
    /// A formula, a signal, a component, its mode, a variable or its value is wrong, or an activation can never come.
    pub fn check_campaign(&self, catalogue: &Catalogue, campaign: &Campaign) -> Result<(), ScenarioError> {
        self.campaign_measures(catalogue, campaign)?;
        let count = campaign.variants.len();
        for (number, (_, healthy)) in campaign.variants.iter().enumerate() {
            let mut all = self.clone().with_case(catalogue, healthy)?;
            // a run without faults may have nothing applied to it
            let mut applied = all.applied().cloned().unwrap_or_default();
            for case in campaign.cases.iter().skip(number).step_by(count) {
                let tried = self.clone().with_case(catalogue, case)?;
                if let Some(of_case) = tried.applied() {
                    applied.failures.extend(of_case.failures.iter().cloned());
                    applied.parameters.extend(of_case.parameters.iter().cloned());
                    applied.variables.extend(of_case.variables.iter().cloned());
                    applied.tasks.extend(of_case.tasks.iter().cloned());
                }
            }
            all.put_on(applied);
            // Clients are made once with all that is asked of them: sources are compiled and scenes read only once.
            for (name, client) in &self.file().clients {
                if matches!(client.get_ref(), ClientFile::Plant { .. } | ClientFile::SoftPlc { .. }) {
                    all.member(name)?;
                }
            }
        }
        Ok(())
    }

    fn readouts(&self, catalogue: &Catalogue, campaign: &Campaign) -> Result<Vec<SignalName>, ScenarioError> {
        let all = &self.file().signals;
        if campaign.file.readouts.is_empty() {
            return Ok(all.keys().cloned().collect());
        }
        let mut readouts = Vec::new();
        for written in &campaign.file.readouts {
            let names = arrays::names(written.get_ref().as_str(), written.span());
            for name in names.map_err(|found| catalogue.wrong(found.message, found.place, found.help))? {
                if !all.contains_key(&name) {
                    let help = did_you_mean(name.as_str(), all.keys().map(SignalName::as_str));
                    let message = format!("the scenario has no signal `{name}`");
                    return Err(catalogue.wrong(message, Some(written.span()), help));
                }
                readouts.push(name);
            }
        }
        Ok(readouts)
    }

    /// What a campaign brings into a run of this scenario; nothing if its case is none of a campaign.
    pub fn injected(&self) -> Option<Injected> {
        let applied = self.applied()?;
        let injection = applied.case.injection.as_ref()?;
        let begins = |when: &When| matches!(when, When::Once { delay: None, .. });
        let operations = applied.injected.iter().filter(|one| begins(&one.when)).map(|one| one.operation.clone());
        let mut signals: Vec<SignalName> = applied.injected.iter().filter_map(|one| held(&one.operation)).collect();
        signals.sort();
        signals.dedup();
        let step = self.file().step.as_nanos();
        // An operation acts with the first step that ends at its time or later.
        let grid = |at: VirtualTime| VirtualTime::from_nanos(at.as_nanos().div_ceil(step).saturating_mul(step));
        let at = injection.at.as_ref().map(|(at, _)| grid(*at));
        Some(Injected { at, operations: operations.collect(), signals, over: over(&applied.injected) })
    }
}

fn over(injected: &[Scheduled]) -> Over {
    let count = |is_such: fn(&Operation) -> bool| injected.iter().filter(|one| is_such(&one.operation)).count();
    // What begins and does not end lasts.
    if count(lasts) > count(ends) {
        return Over::Never;
    }
    let at = |one: &Scheduled| if let When::At(at) = one.when { Some(at) } else { None };
    let all: Option<Vec<VirtualTime>> = injected.iter().map(at).collect();
    all.and_then(|all| all.into_iter().max()).map_or(Over::Unknown, Over::At)
}

/// True if what an operation begins goes on until another one ends it.
fn lasts(operation: &Operation) -> bool {
    use Operation as O;
    matches!(
        operation,
        O::Force { .. }
            | O::Disturb { .. }
            | O::Fail { .. }
            | O::ChangeParameter { .. }
            | O::ForceVariable { .. }
            | O::Postpone { .. }
    )
}

/// True if an operation ends what another one began.
fn ends(operation: &Operation) -> bool {
    use Operation as O;
    matches!(
        operation,
        O::Release { .. }
            | O::Mend { .. }
            | O::Repair { .. }
            | O::RestoreParameter { .. }
            | O::ReleaseVariable { .. }
            | O::CatchUp { .. }
    )
}

/// The signal that an operation holds or disturbs.
fn held(operation: &Operation) -> Option<SignalName> {
    match operation {
        Operation::Force { signal, .. } | Operation::Disturb { signal, .. } => Some(signal.clone()),
        _ => None,
    }
}
