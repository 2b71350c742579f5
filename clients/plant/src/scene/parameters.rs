//! A parameter of a component that takes another value while the plant runs: a clamp that slows down, a panel that takes less water.
//!
//! A component is its parameters and its state. The state stays, and from the next half turn on its equations have the other value.
//! What the world was built with, as the stops of a joint, and what a component only begins with cannot change any more.

use thiserror::Error;

use super::failures::{hint, in_brackets, place_of};
use super::model::{Component, Driven, Scene, Wire};
use crate::component::kind::Setting;

/// Why a parameter does not change. The plant stays as it was.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum ParameterRefused {
    /// The scene does not have the component.
    #[error("no component `{component}` in this scene{}", in_brackets(.hint.as_deref()))]
    Component {
        /// The name that was looked for.
        component: String,
        /// What is there, in words.
        hint: Option<String>,
    },
    /// Its kind does not have the parameter.
    #[error("component `{component}` has no parameter `{parameter}` ({hint})")]
    Parameter {
        /// The component, by its name in the scene.
        component: String,
        /// The parameter that was looked for.
        parameter: String,
        /// The nearest one, or all that there are, in words.
        hint: String,
    },
    /// The parameter does not take the value.
    #[error("`{parameter}` of component `{component}` is {wanted}, which {value} is not")]
    Value {
        /// The component, by its name in the scene.
        component: String,
        /// The parameter, by its key with its unit.
        parameter: String,
        /// The value, as it was given.
        value: String,
        /// What it may be, in words.
        wanted: String,
    },
    /// The component cannot take it while it runs.
    #[error("`{parameter}` of component `{component}` stays as it is while the plant runs: {why}")]
    Fixed {
        /// The component, by its name in the scene.
        component: String,
        /// The parameter, by its key with its unit.
        parameter: String,
        why: String,
    },
    /// The scene's own value is asked for, and the component has it.
    #[error("`{parameter}` of component `{component}` has not been changed")]
    Unchanged {
        /// The component, by its name in the scene.
        component: String,
        /// The parameter, by its key with its unit.
        parameter: String,
    },
    /// There is no plant before the set-up.
    #[error("component `{component}` cannot change before the set-up")]
    BeforeSetUp {
        /// The component, by its name in the scene.
        component: String,
    },
}

/// A parameter of a component: the component's index in the scene, the parameter's among those of its kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct FoundParameter {
    pub(crate) component: usize,
    pub(crate) parameter: usize,
}

impl Scene {
    /// Checks that a component of the scene can take this value of a parameter while it runs, beside the scene's own values of
    /// the others.
    ///
    /// # Errors
    /// See [`ParameterRefused`].
    pub fn check_parameter(&self, component: &str, parameter: &str, value: &str) -> Result<(), ParameterRefused> {
        let found = self.find_parameter(component, parameter)?;
        self.read_parameter(found, value, &self.components[found.component].settings).map(|_| ())
    }

    /// The parameter of a component that these names mean.
    pub(crate) fn find_parameter(&self, component: &str, parameter: &str) -> Result<FoundParameter, ParameterRefused> {
        let at = place_of(&self.components, component).map_err(|near| {
            let assembly = self.aliases.is_assembly(component);
            let hint = if assembly { Some("it is an assembly: name one of its parts".to_owned()) } else { near };
            ParameterRefused::Component { component: component.to_owned(), hint }
        })?;
        let keys: Vec<&str> = self.components[at].kind.parameters.iter().map(|known| &*known.key).collect();
        let place = keys.iter().position(|key| *key == parameter).ok_or_else(|| {
            let (component, parameter) = (component.to_owned(), parameter.to_owned());
            let hint = hint(&keys, &parameter, "it has");
            ParameterRefused::Parameter { component, parameter, hint }
        })?;
        Ok(FoundParameter { component: at, parameter: place })
    }

    /// The setting that a text is for a parameter of a component with the settings `now`.
    ///
    /// # Errors
    /// A value that the parameter does not take, or not while the plant runs.
    pub(crate) fn read_parameter(
        &self,
        found: FoundParameter,
        text: &str,
        now: &[Setting],
    ) -> Result<Setting, ParameterRefused> {
        let form = &self.components[found.component].kind.parameters[found.parameter].form;
        let setting = form.read_text(text).ok_or_else(|| {
            let (component, parameter) = self.names_of(found);
            ParameterRefused::Value { component, parameter, value: text.to_owned(), wanted: form.in_words() }
        })?;
        self.allow_parameter(found, setting, now).map(|()| setting)
    }

    /// Checks that a component with the settings `now` can take a setting while it runs.
    ///
    /// # Errors
    /// It cannot.
    pub(crate) fn allow_parameter(
        &self,
        found: FoundParameter,
        setting: Setting,
        now: &[Setting],
    ) -> Result<(), ParameterRefused> {
        let mut changed = now.to_vec();
        changed[found.parameter] = setting;
        let why = fixed(&self.components[found.component], found.parameter, now, &changed);
        why.map_or(Ok(()), |why| {
            let (component, parameter) = self.names_of(found);
            Err(ParameterRefused::Fixed { component, parameter, why })
        })
    }

    /// What the scene calls a component and its parameter.
    pub(crate) fn names_of(&self, found: FoundParameter) -> (String, String) {
        let component = &self.components[found.component];
        (component.name.clone(), component.kind.parameters[found.parameter].key.to_string())
    }
}

/// Why a component that runs cannot go from some settings to others; nothing if it can.
fn fixed(described: &Component, parameter: usize, now: &[Setting], changed: &[Setting]) -> Option<String> {
    let Component { kind, bound, inputs, .. } = described;
    if kind.is_program() {
        return Some("it is a constant of its program, which is compiled with it".to_owned());
    }
    if kind.parameters[parameter].initial {
        return Some("the component only begins with it".to_owned());
    }
    if let Some(conflict) = kind.conflict(changed) {
        return Some(format!("with it `{}` would have to be {}", conflict.key, conflict.wanted));
    }
    let means = |settings: &[Setting], place: usize| kind.uses(settings, place);
    let lost = |place: &usize| inputs[*place] != Wire::Open && means(now, *place) && !means(changed, *place);
    if let Some(place) = (0..inputs.len()).find(lost) {
        return Some(format!("with it the input `{}`, which is connected, would mean nothing", kind.inputs[place].key));
    }
    let (before, after) = (kind.built(now), kind.built(changed));
    if matches!(bound.drives, Some(Driven::Joint(_))) && before.stops != after.stops {
        return Some("the stops of its joint are built with it".to_owned());
    }
    (before.ports != after.ports).then(|| "its line of bytes is built with it".to_owned())
}
