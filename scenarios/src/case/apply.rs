//! A case put on its scenario.

use std::ops::Range;

use onescan_clients::forced::{Force, Forced};
use onescan_clients::soft_plc::SoftPlcClient;
use onescan_plc_shim::{Application, Input, VariableAccess};
use onescan_server::client::Client;
use onescan_server::signal::{ClientName, SignalName, did_you_mean};
use onescan_server::time::VirtualTime;
use toml::{Spanned, Value};

use super::file::{CaseFile, FaultFile};
use super::value::{bytes_of, literal_of, quoted};
use super::{Applied, Case, Catalogue, FailureAt, Setting, constant, scene};
use crate::Scenario;
use crate::error::{ScenarioError, wrong};
use crate::file::ClientFile;

impl Scenario {
    /// The scenario as `case` wants it.
    ///
    /// # Errors
    /// The case names what the scenario has not, or a value that does not fit.
    pub fn with_case(mut self, catalogue: &Catalogue, case: &Case) -> Result<Self, ScenarioError> {
        let mut applied = Applied { case: case.clone(), source: catalogue.source(), ..Applied::default() };
        for setting in &case.settings {
            self.settable(catalogue, setting)?;
        }
        if let Some(entry) = catalogue.entry(case) {
            applied.forces = self.forces(catalogue, entry)?;
            for fault in &entry.faults {
                applied.failures.push(self.failure(catalogue, fault)?);
            }
            self.adjust_expectations(catalogue, entry)?;
        }
        self.put_on(applied);
        Ok(self)
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

    fn client(&self, name: &str) -> Option<&ClientFile> {
        self.file().clients.iter().find(|(client, _)| client.as_str() == name).map(|(_, client)| client.get_ref())
    }

    /// Inputs are forces until the next one on their signal; those that are written as forces come last.
    fn forces(&self, catalogue: &Catalogue, entry: &CaseFile) -> Result<Vec<Force>, ScenarioError> {
        let mut inputs: Vec<Force> = Vec::new();
        for input in entry.inputs.iter().map(Spanned::get_ref) {
            let bytes = self.bytes(catalogue, &input.signal, &input.value)?;
            inputs.push(Force { signal: input.signal.get_ref().clone(), from: input.at, until: None, bytes });
        }
        inputs.sort_by_key(|input| input.from);
        for force in &entry.forces {
            let place = force.span();
            let force = force.get_ref();
            let bytes = self.bytes(catalogue, &force.signal, &force.value)?;
            let (from, until) = (force.from.unwrap_or_default(), force.until);
            ordered(catalogue, from, until, place)?;
            inputs.push(Force { signal: force.signal.get_ref().clone(), from, until, bytes });
        }
        Ok(inputs)
    }

    fn bytes(
        &self,
        catalogue: &Catalogue,
        signal: &Spanned<SignalName>,
        value: &Spanned<Value>,
    ) -> Result<Vec<u8>, ScenarioError> {
        let name = signal.get_ref();
        let Some(declared) = self.file().signals.get(name).map(Spanned::get_ref) else {
            let help = did_you_mean(name.as_str(), self.file().signals.keys().map(SignalName::as_str));
            return Err(catalogue.wrong(format!("the scenario has no signal `{name}`"), Some(signal.span()), help));
        };
        if let Some(ClientFile::External { .. } | ClientFile::OpcUa { .. }) = self.client(declared.writer.as_str()) {
            let message = format!("`{name}` is written by `{}`, an external client", declared.writer);
            let help = "only what this program runs itself can be held".to_owned();
            return Err(catalogue.wrong(message, Some(signal.span()), Some(help)));
        }
        bytes_of(declared.ty, value.get_ref()).map_err(|wanted| {
            let message = format!("`{name}` is {}: {} is not {wanted}", declared.ty, value.get_ref());
            catalogue.wrong(message, Some(value.span()), None)
        })
    }

    fn failure(&self, catalogue: &Catalogue, fault: &Spanned<FaultFile>) -> Result<FailureAt, ScenarioError> {
        let FaultFile { client, component, mode, from, until } = fault.get_ref();
        let plants: Vec<&str> = self
            .file()
            .clients
            .iter()
            .filter(|(_, client)| matches!(client.get_ref(), ClientFile::Plant { .. }))
            .map(|(name, _)| name.as_str())
            .collect();
        let named = client.as_ref().map(Spanned::get_ref);
        let client = match (named, &plants[..]) {
            (Some(named), plants) if plants.contains(&named.as_str()) => named.clone(),
            (Some(named), plants) => {
                let message = format!("the scenario has no plant `{named}`");
                let place = client.as_ref().map(Spanned::span);
                return Err(catalogue.wrong(message, place, did_you_mean(named, plants.iter().copied())));
            }
            (None, [only]) => (*only).to_owned(),
            (None, []) => {
                let message = "the scenario has no plant whose components could fail".to_owned();
                return Err(catalogue.wrong(message, Some(component.span()), None));
            }
            (None, [one, ..]) => {
                let help = format!("say which, as in `client = \"{one}\"`");
                let message = "the scenario has more than one plant".to_owned();
                return Err(catalogue.wrong(message, Some(component.span()), Some(help)));
            }
        };
        let (from, place) =
            (from.unwrap_or_default(), component.span().start..mode.span().end.max(component.span().end));
        ordered(catalogue, from, *until, fault.span())?;
        let (component, mode) = (component.get_ref().clone(), mode.get_ref().clone());
        Ok(FailureAt { client, component, mode, from, until: *until, place })
    }

    fn adjust_expectations(&mut self, catalogue: &Catalogue, entry: &CaseFile) -> Result<(), ScenarioError> {
        let mut expectations = self.expectations().clone();
        for waived in &entry.waive {
            let names = expectations.named.iter().map(|(name, _)| name.as_str());
            let help = did_you_mean(waived.get_ref(), names);
            let before = expectations.named.len();
            expectations.named.retain(|(name, _)| name != waived.get_ref());
            if expectations.named.len() == before {
                let message = format!("the scenario has no expectation `{}`", waived.get_ref());
                return Err(catalogue.wrong(message, Some(waived.span()), help));
            }
        }
        let added = expectations.add(self.file(), &entry.expect, &catalogue.source().1);
        added.map_err(|found| catalogue.wrong(found.message, Some(found.place), found.help))?;
        self.set_expectations(expectations);
        Ok(())
    }

    /// The text of a plant's scene as the case wants it.
    pub(crate) fn scene_text(&self, name: &ClientName, file: &str, text: String) -> Result<String, ScenarioError> {
        let Some(applied) = self.applied() else { return Ok(text) };
        let settings: Vec<&Setting> = settings_of(applied, name).collect();
        let failures: Vec<&FailureAt> =
            applied.failures.iter().filter(|failure| failure.client == name.as_str()).collect();
        if settings.is_empty() && failures.is_empty() {
            return Ok(text);
        }
        let edited = scene::edited(&text, file, &settings, &failures);
        edited.map_err(|refused| wrong_case(applied, refused.message, refused.place, refused.help))
    }

    /// A source of PLC `name` with the constants of the case.
    pub(crate) fn with_constants(&self, name: &ClientName, input: Input) -> Input {
        let Some(applied) = self.applied() else { return input };
        let settings: Vec<&Setting> = settings_of(applied, name).collect();
        constant::set(input, &settings)
    }

    /// The error of a constant without which the sources of PLC `name` compile; `plain` are as they are written.
    pub(crate) fn wrong_constant(&self, name: &ClientName, plain: &[Input]) -> Option<ScenarioError> {
        let applied = self.applied()?;
        let found = |inputs: Vec<Input>| {
            let findings = Application::from_inputs(inputs).err()?;
            Some(findings.findings().first().map(|found| found.diagnostic().message.clone()).unwrap_or_default())
        };
        if found(plain.to_vec()).is_some() {
            return None;
        }
        settings_of(applied, name).find_map(|setting| {
            let with = plain.iter().map(|input| constant::set(input.clone(), &[setting]));
            let message = format!("`{name}` does not compile with this constant: {}", found(with.collect())?);
            Some(wrong_case(applied, message, setting.place.clone(), None))
        })
    }

    /// Gives a PLC the initial values of the case.
    pub(crate) fn preset(&self, plc: &mut SoftPlcClient, name: &ClientName) -> Result<(), ScenarioError> {
        let Some(applied) = self.applied() else { return Ok(()) };
        for setting in settings_of(applied, name) {
            let path = setting.path.split_once('.').map_or("", |(_, path)| path);
            let refused = |message, help| wrong_case(applied, message, setting.place.clone(), help);
            let Some(literal) = literal_of(&setting.value) else {
                return Err(refused(format!("`{path}` takes a number, a BOOL or a literal as text"), None));
            };
            if holds(plc, path, &literal) {
                // A constant, which was set in the program's text.
                continue;
            }
            let mut written = plc.preset(path, &literal);
            if written.is_err() && setting.value.is_str() {
                // A text may also be that of a string, without its quotation marks.
                let quotes = ['\'', '"'].into_iter().map(|quote| quoted(&literal, quote));
                written = quotes
                    .fold(written, |before, text| before.or_else(|error| plc.preset(path, &text).map_err(|_| error)));
            }
            written.map_err(|error| match error {
                onescan_plc_shim::WriteError::Unknown(unknown) => {
                    refused(format!("`{name}` has no variable `{}`", unknown.path), unknown.help)
                }
                error @ onescan_plc_shim::WriteError::Protected { .. } => {
                    let help =
                        "programs hold the values of constants; this one is set only where it is declared alone, \
                                with an initial value, in plain text"
                            .to_owned();
                    refused(error.to_string(), Some(help))
                }
                error @ onescan_plc_shim::WriteError::Value { .. } => refused(error.to_string(), None),
            })?;
        }
        Ok(())
    }

    /// What the case does to a run from outside, by virtual time in nanoseconds.
    pub fn case_events(&self) -> Vec<(u64, String)> {
        let Some(applied) = self.applied() else { return Vec::new() };
        let mut events = Vec::new();
        for force in &applied.forces {
            let ty = self.file().signals.get(&force.signal).map(|signal| signal.get_ref().ty);
            let value = ty.map(|ty| ty.to_text(&force.bytes)).unwrap_or_default();
            events.push((force.from.as_nanos(), format!("{} held at {value}", force.signal)));
            events.extend(force.until.map(|until| (until.as_nanos(), format!("{} let go", force.signal))));
        }
        for FailureAt { component, mode, from, until, .. } in &applied.failures {
            events.push((from.as_nanos(), format!("{component} fails: {mode}")));
            events.extend(until.map(|until| (until.as_nanos(), format!("{component} works again: {mode}"))));
        }
        events.sort();
        events
    }

    /// The client with the case's forces on it.
    pub(crate) fn forced(&self, client: Box<dyn Client>) -> Box<dyn Client> {
        match self.applied() {
            Some(applied) if !applied.forces.is_empty() => Box::new(Forced::new(client, &applied.forces)),
            _ => client,
        }
    }
}

/// True for a constant that has this value already.
fn holds(plc: &SoftPlcClient, path: &str, literal: &str) -> bool {
    let plc = plc.plc();
    let Ok(variable) = plc.variable(path) else { return false };
    let wanted = plc.application().value_bytes(&variable, literal);
    let at = variable.offset as usize;
    variable.access == VariableAccess::Constant
        && wanted.is_ok_and(|wanted| plc.memory().get(at..at + wanted.len()) == Some(&wanted[..]))
}

fn settings_of<'a>(applied: &'a Applied, client: &'a ClientName) -> impl Iterator<Item = &'a Setting> {
    applied.case.settings.iter().filter(|setting| setting.path.split('.').next() == Some(client.as_str()))
}

fn wrong_case(applied: &Applied, message: String, place: Range<usize>, help: Option<String>) -> ScenarioError {
    let (path, text) = &applied.source;
    wrong(std::path::Path::new(path), text, message, Some(place), help)
}

fn ordered(
    catalogue: &Catalogue,
    from: VirtualTime,
    until: Option<VirtualTime>,
    place: Range<usize>,
) -> Result<(), ScenarioError> {
    match until.filter(|until| *until <= from) {
        Some(until) => {
            Err(catalogue.wrong(format!("`until`, {until}, is not after `from`, {from}"), Some(place), None))
        }
        None => Ok(()),
    }
}
