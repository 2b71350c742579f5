//! What a case sets before a session begins: parameters of plants, constants and initial values of
//! PLCs. All of it is typed by whoever owns it, the scene's format and the PLC's declarations.

use std::collections::BTreeMap;

use onescan_iec::{ConstantError, Diagnostics, Input};
use onescan_iec_run::{Application, BuildError, Builder, WriteError};
use onescan_plant::scene::{Override, UnknownFailure};
use onescan_server::checkpoint::SessionSettings;
use onescan_server::signal::ClientName;
use onescan_soft_plc::SoftPlcClient;

use super::{settings_of, wrong_case};
use crate::case::value::{literal_of, quoted};
use crate::case::{Applied, DEFAULT, Setting};
use crate::error::{ScenarioError, Wrong};
use crate::file::ClientFile;
use crate::load::Scenario;

/// The values of a table and of those within, each with its path.
fn leaves(path: &str, table: &toml::Table, found: &mut Vec<Override>) {
    for (key, value) in table {
        let path = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
        match value {
            toml::Value::Table(inner) => leaves(&path, inner, found),
            value => found.push(Override::new(path, value)),
        }
    }
}

/// What is behind the client's name in a setting's path.
fn own_path(setting: &Setting) -> &str {
    setting.path.split_once('.').map_or("", |(_, path)| path)
}

impl Scenario {
    /// What the scenario sets in the scene of plant `name`, and then what the case does.
    pub(crate) fn overrides(&self, name: &ClientName) -> Vec<Override> {
        let settings = self.applied().into_iter().flat_map(|applied| settings_of(applied, name));
        let of_case = settings.map(|setting| Override::new(own_path(setting), &setting.value));
        self.set_by_scenario(name).into_iter().chain(of_case).collect()
    }

    /// What the scenario itself sets in the scene of plant `name`.
    fn set_by_scenario(&self, name: &ClientName) -> Vec<Override> {
        let mut found = Vec::new();
        if let Some(ClientFile::Plant { set, .. }) = self.file().clients.get(name).map(toml::Spanned::get_ref) {
            leaves("", set, &mut found);
        }
        found
    }

    /// The error of override `index` of plant `name`; the last one's if none is named, since without
    /// them the scene was right. Nothing if there are none.
    pub(crate) fn wrong_override(
        &self,
        name: &ClientName,
        index: Option<usize>,
        message: String,
        help: Option<String>,
    ) -> Option<ScenarioError> {
        let own = self.set_by_scenario(name).len();
        let settings: Vec<&Setting> = self.applied().into_iter().flat_map(|case| settings_of(case, name)).collect();
        let of_case = match index {
            Some(index) => index.checked_sub(own).and_then(|index| settings.get(index)),
            None => settings.last(),
        };
        let (Some(setting), Some(applied)) = (of_case, self.applied()) else {
            return (own > 0).then(|| self.wrong_client(name, message, help));
        };
        Some(wrong_case(applied, message, setting.place.clone(), help))
    }

    /// The application of PLC `name`, with the constants of the case. `sources` adds the sources and
    /// says what it is built for.
    pub(crate) fn built(
        &self,
        name: &ClientName,
        inputs: &[Input],
        flavour: impl Fn(Builder) -> Builder,
    ) -> Result<Result<Application, Diagnostics>, ScenarioError> {
        let fresh = || Application::builder().memory_limit(self.memory_limit(name)).inputs(inputs.iter().cloned());
        let mut builder = flavour(fresh());
        let mut constants: Vec<(&Applied, &Setting)> = Vec::new();
        if let Some(applied) = self.applied() {
            for setting in settings_of(applied, name) {
                // What is not a constant is a variable: it is preset when the PLC is made.
                if let Some(literal) = literal_of(&setting.value)
                    && builder.has_constant(own_path(setting))
                {
                    builder = builder.constant(own_path(setting), literal);
                    constants.push((applied, setting));
                }
            }
        }
        match builder.build() {
            Ok(application) => Ok(Ok(application)),
            Err(BuildError::Constant(error)) => match blamed(&error, &constants) {
                Some((applied, setting)) => {
                    let message = format!("`{name}` does not compile with this constant: {error}");
                    Err(wrong_case(applied, message, setting.place.clone(), None))
                }
                // Only constants of the case are given, so one of them is named.
                None => Err(self.wrong_client(name, error.to_string(), None)),
            },
            Err(BuildError::Sources(findings)) => match constants.last() {
                Some((applied, setting)) if fresh().build().is_ok() => {
                    let first = findings.findings().first().map(|found| found.diagnostic().message.clone());
                    let what = first.unwrap_or_else(|| "it does not compile".to_owned());
                    let message = format!("`{name}` does not compile with the constants of this case: {what}");
                    Err(wrong_case(applied, message, setting.place.clone(), None))
                }
                _ => Ok(Err(findings)),
            },
        }
    }

    /// Gives a PLC the initial values of the case.
    pub(crate) fn preset(
        &self,
        plc: &mut SoftPlcClient,
        name: &ClientName,
        inputs: &[Input],
    ) -> Result<(), ScenarioError> {
        let Some(applied) = self.applied() else { return Ok(()) };
        let builder = Application::builder().inputs(inputs.iter().cloned());
        for setting in settings_of(applied, name) {
            let path = own_path(setting);
            let refused = |message, help| wrong_case(applied, message, setting.place.clone(), help);
            let Some(literal) = literal_of(&setting.value) else {
                return Err(refused(format!("`{path}` takes a number, a BOOL or a literal as text"), None));
            };
            if builder.has_constant(path) {
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
                WriteError::Unknown(unknown) => {
                    refused(format!("`{name}` has no variable `{}`", unknown.path), unknown.help)
                }
                error => refused(error.to_string(), None),
            })?;
        }
        Ok(())
    }

    /// Refuses values of variables that PLC `name` does not have, and those that are none of their types.
    pub(crate) fn check_variables(&self, plc: &SoftPlcClient, name: &ClientName) -> Result<(), ScenarioError> {
        let Some(applied) = self.applied() else { return Ok(()) };
        for at in applied.variables.iter().filter(|at| at.client == *name) {
            plc.check_write(&at.variable, &at.value).map_err(|error| {
                let (message, help) = match error {
                    WriteError::Unknown(unknown) => {
                        (format!("`{name}` has no variable `{}`", unknown.path), unknown.help)
                    }
                    error => (error.to_string(), None),
                };
                wrong_case(applied, message, at.place.clone(), help)
            })?;
        }
        Ok(())
    }

    /// Refuses tasks that PLC `name` does not have, and those that cannot be late.
    pub(crate) fn check_tasks(&self, plc: &SoftPlcClient, name: &ClientName) -> Result<(), ScenarioError> {
        let Some(applied) = self.applied() else { return Ok(()) };
        for at in applied.tasks.iter().filter(|at| at.client == *name) {
            let late = plc.plc().check_late(at.task.as_deref());
            late.map_err(|error| wrong_case(applied, format!("`{name}`: {error}"), at.place.clone(), None))?;
        }
        Ok(())
    }

    /// Refuses failures and parameters that plant `name` does not have, and values that these do not take while it runs.
    pub(crate) fn check_asked_of(&self, name: &ClientName, scene: &onescan_plant::Scene) -> Result<(), ScenarioError> {
        self.check_failures(name, scene)?;
        let Some(applied) = self.applied() else { return Ok(()) };
        for at in applied.parameters.iter().filter(|at| at.client == *name) {
            scene
                .check_parameter(&at.component, &at.parameter, &at.value)
                .map_err(|refused| wrong_case(applied, refused.to_string(), at.place.clone(), None))?;
        }
        Ok(())
    }

    /// Refuses failures of components that plant `name` does not have.
    fn check_failures(&self, name: &ClientName, scene: &onescan_plant::Scene) -> Result<(), ScenarioError> {
        self.check_panels(scene)?;
        let Some(applied) = self.applied() else { return Ok(()) };
        for failure in applied.failures.iter().filter(|failure| failure.client == *name) {
            if let Err(unknown) = scene.check_failure(&failure.component, &failure.mode) {
                let (message, help) = unknown_failure(unknown);
                return Err(wrong_case(applied, message, failure.place.clone(), help));
            }
        }
        Ok(())
    }

    /// Refuses failures on panels that `scene` does not have. Where there are several plants, a component that it does not have
    /// may be another one's.
    fn check_panels(&self, scene: &onescan_plant::Scene) -> Result<(), ScenarioError> {
        let is_plant = |client: &toml::Spanned<ClientFile>| matches!(client.get_ref(), ClientFile::Plant { .. });
        let is_only = self.file().clients.values().filter(|client| is_plant(client)).count() == 1;
        for element in self.file().panel.iter().flat_map(|panel| &panel.element) {
            let Some(failure) = &element.get_ref().failure else { continue };
            let Some([component, mode]) = failure.get_ref().parts() else { continue };
            match scene.check_failure(component, mode) {
                Err(UnknownFailure::Component { .. }) if !is_only => {}
                Err(unknown) => {
                    let (message, help) = unknown_failure(unknown);
                    return Err(self.wrong_at(Wrong { message, place: failure.span(), help }));
                }
                Ok(()) => {}
            }
        }
        Ok(())
    }

    /// Whether a setting of a checkpoint is a text or a file in the program of a soft PLC.
    pub fn is_program(&self, path: &str) -> bool {
        let of_client = |(name, client): (&ClientName, &toml::Spanned<ClientFile>)| {
            let ClientFile::SoftPlc { sources, .. } = client.get_ref() else { return false };
            let own = path.strip_prefix(name.as_str()).and_then(|rest| rest.strip_prefix('.'));
            let is_of = |own: &str, source: &String| {
                own.strip_prefix(source.as_str()).is_some_and(|rest| rest.is_empty() || rest.starts_with(':'))
            };
            own.is_some_and(|own| sources.iter().any(|source| is_of(own, source)))
        };
        self.file().clients.iter().any(of_client)
    }

    /// Whether a setting is a constant of a soft PLC: part of its code, and not of its state.
    ///
    /// # Errors
    /// Sources that cannot be read.
    pub fn is_constant(&self, path: &str) -> Result<bool, ScenarioError> {
        let Some((client, own)) = path.split_once('.') else { return Ok(false) };
        let named = self.file().clients.iter().find(|(name, _)| name.as_str() == client);
        let Some((name, ClientFile::SoftPlc { sources, dialect, .. })) =
            named.map(|(name, client)| (name, client.get_ref()))
        else {
            return Ok(false);
        };
        let inputs = self.inputs(name, sources, *dialect)?;
        Ok(Application::builder().inputs(inputs).has_constant(own))
    }

    /// What a session of this scenario is made of, for checkpoints.
    pub fn session_settings(&self) -> SessionSettings {
        let mut settings = BTreeMap::new();
        settings.insert("seed".to_owned(), self.seed().to_string());
        for setting in self.applied().into_iter().flat_map(|applied| &applied.case.settings) {
            settings.insert(setting.path.clone(), setting.value.to_string());
        }
        settings.extend(self.applied().into_iter().flat_map(Applied::code_settings));
        let case = self.case().map_or(DEFAULT, |case| case.name.as_str());
        SessionSettings { name: format!("case `{case}`"), settings }
    }
}

/// What is wrong with a failure, and what to do.
fn unknown_failure(unknown: UnknownFailure) -> (String, Option<String>) {
    match unknown {
        UnknownFailure::Component { component, hint } => (format!("no component `{component}` in this scene"), hint),
        UnknownFailure::Mode { component, mode, hint } => {
            (format!("component `{component}` has no failure mode `{mode}`"), Some(hint))
        }
    }
}

/// The setting that a constant's error is about.
fn blamed<'a>(error: &ConstantError, constants: &[(&'a Applied, &'a Setting)]) -> Option<(&'a Applied, &'a Setting)> {
    let path = match error {
        ConstantError::Unknown { path, .. }
        | ConstantError::Variable { path, .. }
        | ConstantError::Ambiguous { path, .. }
        | ConstantError::Twice { path, .. }
        | ConstantError::Value { path, .. } => path,
    };
    let named = constants.iter().find(|(_, setting)| own_path(setting).eq_ignore_ascii_case(path));
    named.or(constants.last()).copied()
}
