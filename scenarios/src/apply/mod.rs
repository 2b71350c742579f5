//! A case put on its scenario.
//!
//! | module | subject |
//! |---|---|
//! | this file | the case's own keys, and its expectations |
//! | `settings` | parameters of plants, constants and initial values of PLCs |
//! | `code` | other programs in soft PLCs |
//! | `period` | when something begins and ends |
//! | `disturbance` | faults on the way of signals |
//! | [`departure`] | where a case departs from another |
//! | [`measure`] | what a campaign reads out of its runs |
//! | `real_plc` | what a case asks of a PLC that a real one does not do |
//! | `timeline` | what a case does while a session runs, as operations |

mod code;
pub mod departure;
mod disturbance;
pub mod measure;
mod period;
mod real_plc;
mod settings;
mod timeline;

use std::ops::Range;
use std::path::{Path, PathBuf};

use onescan_server::signal::{ClientName, did_you_mean};

use crate::case::cases_file::VERSION;
use crate::case::file::CaseFile;
use crate::case::written::Written;
use crate::case::{Applied, Case, Catalogue, FILE_NAME, Injection, Setting};
use crate::error::{ScenarioError, wrong};
use crate::expectations::Owner;
use crate::file::ClientFile;
use crate::load::Scenario;

impl Scenario {
    /// The scenario in `path` as the case called `name` wants it; as it is without a name.
    ///
    /// # Errors
    /// See [`ScenarioError`].
    pub fn load_case(path: &Path, name: Option<&str>) -> Result<Self, ScenarioError> {
        let scenario = Self::load(path)?;
        let Some(name) = name else { return Ok(scenario) };
        let catalogue = scenario.catalogue()?;
        let case = catalogue.named(&scenario, name)?.clone();
        scenario.with_case(&catalogue, &case)
    }

    /// The scenario with one of its cases, and the case in pieces; as it is, and nothing, without a name.
    ///
    /// # Errors
    /// As those of [`load_case`](Self::load_case).
    pub fn case_in_pieces(&self, name: Option<&str>) -> Result<(Self, Written), ScenarioError> {
        let Some(name) = name else { return Ok((self.clone(), Written::default())) };
        let catalogue = self.catalogue()?;
        let case = catalogue.named(self, name)?;
        Ok((self.clone().with_case(&catalogue, case)?, catalogue.written(case)))
    }

    /// The scenario with the last case of a text, which has `[[case]]`s and nothing else.
    ///
    /// # Errors
    /// The text is wrong, or the case is.
    pub fn with_last_of(&self, cases: &str) -> Result<Self, ScenarioError> {
        let catalogue = Catalogue::parse(PathBuf::from(FILE_NAME), format!("version = {VERSION}\n{cases}"))?;
        let mut applied = self.clone();
        for case in catalogue.cases() {
            applied = self.clone().with_case(&catalogue, case)?;
        }
        Ok(applied)
    }

    /// The scenario as `case` wants it.
    ///
    /// # Errors
    /// The case names what the scenario does not have, or a value that does not fit.
    pub fn with_case(mut self, catalogue: &Catalogue, case: &Case) -> Result<Self, ScenarioError> {
        let mut applied = Applied { case: case.clone(), source: catalogue.source(), ..Applied::default() };
        for setting in &case.settings {
            self.settable(catalogue, setting)?;
        }
        let code = case.code.iter().map(|entry| self.code(catalogue, entry));
        applied.code = code.collect::<Result<_, _>>()?;
        if let Some(entry) = catalogue.entry(case)? {
            self.schedule(catalogue, &entry, &mut applied)?;
            if let Some(injection) = &case.injection {
                self.inject(catalogue, injection, &mut applied)?;
            }
            self.adjust_expectations(catalogue, &entry)?;
        }
        self.put_on(applied);
        Ok(self)
    }

    /// Describes what a campaign's fault adds to the run that is healthy.
    fn inject(&self, catalogue: &Catalogue, injection: &Injection, applied: &mut Applied) -> Result<(), ScenarioError> {
        let until = applied.case.until.unwrap_or(self.file().until);
        if let Some((at, place)) = injection.at.clone().filter(|(at, _)| *at >= until) {
            let message = format!("this activation can never come: it is at {at}, and the run ends at {until}");
            return Err(catalogue.wrong(
                message,
                Some(place),
                Some("let it come earlier, or the run end later".to_owned()),
            ));
        }
        let mut healthy = Applied { case: applied.case.clone(), ..Applied::default() };
        if let Some(entry) = catalogue.healthy_entry(&applied.case) {
            self.schedule(catalogue, entry, &mut healthy)?;
        }
        let mut injected = applied.timeline.clone();
        for known in &healthy.timeline {
            if let Some(place) = injected.iter().position(|one| one == known) {
                injected.remove(place);
            }
        }
        applied.injected = injected;
        Ok(())
    }

    /// Refuses a setting of a client that has none.
    fn settable(&self, catalogue: &Catalogue, setting: &Setting) -> Result<(), ScenarioError> {
        let client = setting.path.split('.').next().unwrap_or_default();
        let wrong = |message, help| Err(catalogue.wrong(message, Some(setting.place.clone()), help));
        match self.client(client) {
            Some(ClientFile::Plant { .. } | ClientFile::SoftPlc { .. }) => Ok(()),
            Some(_) => wrong(format!("client `{client}` has nothing that can be set"), None),
            None => {
                let help = did_you_mean(client, self.file().clients.keys().map(ClientName::as_str))
                    .unwrap_or_else(|| format!("`{}` begins with the client's name", setting.path));
                wrong(format!("the scenario has no client `{client}`"), Some(help))
            }
        }
    }

    /// The client of this name as `scenario.toml` describes it.
    pub(super) fn client(&self, name: &str) -> Option<&ClientFile> {
        self.file().clients.iter().find(|(client, _)| client.as_str() == name).map(|(_, client)| client.get_ref())
    }

    fn adjust_expectations(&mut self, catalogue: &Catalogue, entry: &CaseFile) -> Result<(), ScenarioError> {
        let mut expectations = self.expectations().clone();
        for waived in &entry.waive {
            let names = expectations.named.iter().map(|(name, _)| name.as_str());
            let help = did_you_mean(waived.get_ref(), names);
            let before = expectations.named.len();
            expectations.named.retain(|(name, _)| name != waived.get_ref());
            expectations.worth.remove(waived.get_ref());
            if expectations.named.len() == before {
                let message = format!("the scenario has no expectation `{}`", waived.get_ref());
                return Err(catalogue.wrong(message, Some(waived.span()), help));
            }
        }
        let added = expectations.add(self.file(), (&entry.expect, Owner::Case), &catalogue.source().1);
        added.map_err(|found| catalogue.wrong(found.message, Some(found.place), found.help))?;
        self.set_expectations(expectations);
        Ok(())
    }
}

impl Catalogue {
    /// The case of `scenario` called `name`, also one of a campaign.
    ///
    /// # Errors
    /// There is none, with the nearest.
    pub fn named(&self, scenario: &Scenario, name: &str) -> Result<&Case, ScenarioError> {
        if let Some(case) = self.find(name) {
            return Ok(case);
        }
        let unknown = |help| {
            Err(ScenarioError::UnknownCase { scenario: scenario.name().to_owned(), case: name.to_owned(), help })
        };
        if let Some((campaign, _)) = name.split_once('/')
            && let Some(campaign) = self.campaigns().iter().find(|one| one.name == campaign)
        {
            let nearest = did_you_mean(name, campaign.cases.iter().map(|case| case.name.as_str()));
            return unknown(nearest.unwrap_or_else(|| format!("its cases are {}/FAULT/ACTIVATION", campaign.name)));
        }
        let names = || self.cases().iter().map(|case| case.name.as_str());
        let all = || format!("its cases are {}", names().collect::<Vec<_>>().join(", "));
        unknown(did_you_mean(name, names()).unwrap_or_else(all))
    }
}

/// The settings of a case for one client.
pub(super) fn settings_of<'a>(applied: &'a Applied, client: &'a ClientName) -> impl Iterator<Item = &'a Setting> {
    applied.case.settings.iter().filter(|setting| setting.path.split('.').next() == Some(client.as_str()))
}

/// An error at a place of `cases.toml` that is found when clients are made.
pub(super) fn wrong_case(
    applied: &Applied,
    message: String,
    place: Range<usize>,
    help: Option<String>,
) -> ScenarioError {
    let (path, text) = &applied.source;
    wrong(Path::new(path), text, message, Some(place), help)
}
