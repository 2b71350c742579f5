//! A parameter of a component that takes another value while the plant runs: a clamp that slows down, a panel that takes less water.
//!
//! A component is its parameters and its state. The state stays, and from the next half turn on its equations have the other value.
//! What the world was built with, as the stops of a joint, and what a component only begins with cannot change any more.

use onescan_base::nearest;
use thiserror::Error;

use super::failures::in_brackets;
use super::model::{Component, Driven, Scene, Wire};
use crate::plant::component::kind::Setting;

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
        /// The component.
        component: String,
        /// The parameter that was looked for.
        parameter: String,
        /// The nearest one, or all that there are, in words.
        hint: String,
    },
    /// The parameter does not take the value.
    #[error("`{parameter}` of component `{component}` is {wanted}, which {value} is not")]
    Value {
        /// The component.
        component: String,
        /// The parameter.
        parameter: String,
        /// The value, as it was given.
        value: String,
        /// What it may be, in words.
        wanted: String,
    },
    /// The component cannot take it while it runs.
    #[error("`{parameter}` of component `{component}` stays as it is while the plant runs: {why}")]
    Fixed {
        /// The component.
        component: String,
        /// The parameter.
        parameter: String,
        /// What it decides.
        why: String,
    },
    /// The scene's own value is asked for, and the component has it.
    #[error("`{parameter}` of component `{component}` has not been changed")]
    Unchanged {
        /// The component.
        component: String,
        /// The parameter.
        parameter: String,
    },
    /// There is no plant before the set-up.
    #[error("component `{component}` cannot change before the set-up")]
    BeforeSetUp {
        /// The component.
        component: String,
    },
}

/// A parameter of a component: the component's index in the scene, the parameter's among those of its kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::plant) struct FoundParameter {
    pub(in crate::plant) component: usize,
    pub(in crate::plant) parameter: usize,
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
    pub(in crate::plant) fn find_parameter(
        &self,
        component: &str,
        parameter: &str,
    ) -> Result<FoundParameter, ParameterRefused> {
        let Some(at) = self.components.iter().position(|known| known.name == component) else {
            let near = nearest(component, self.components.iter().map(|known| known.name.as_str()));
            let hint = if self.aliases.is_assembly(component) {
                Some("it is an assembly: name one of its parts".to_owned())
            } else {
                near.map(|near| format!("did you mean `{near}`?"))
            };
            return Err(ParameterRefused::Component { component: component.to_owned(), hint });
        };
        let parameters = &self.components[at].kind.parameters;
        if let Some(parameter) = parameters.iter().position(|known| known.key == parameter) {
            return Ok(FoundParameter { component: at, parameter });
        }
        let keys = || parameters.iter().map(|known| &*known.key);
        let listed = || keys().map(|key| format!("`{key}`")).collect::<Vec<_>>().join(", ");
        let hint = match (nearest(parameter, keys()), parameters.is_empty()) {
            (Some(near), _) => format!("did you mean `{near}`?"),
            (None, true) => "it has none".to_owned(),
            (None, false) => format!("it has {}", listed()),
        };
        Err(ParameterRefused::Parameter { component: component.to_owned(), parameter: parameter.to_owned(), hint })
    }

    /// The setting that a text is for a parameter of a component with the settings `now`.
    ///
    /// # Errors
    /// A value that the parameter does not take, or not while the plant runs.
    pub(in crate::plant) fn read_parameter(
        &self,
        FoundParameter { component, parameter }: FoundParameter,
        text: &str,
        now: &[Setting],
    ) -> Result<Setting, ParameterRefused> {
        let described = &self.components[component];
        let about = &described.kind.parameters[parameter];
        let names = || (described.name.clone(), about.key.to_string());
        let setting = about.form.read_text(text).ok_or_else(|| {
            let ((component, parameter), value) = (names(), text.to_owned());
            ParameterRefused::Value { component, parameter, value, wanted: about.form.in_words() }
        })?;
        let mut changed = now.to_vec();
        changed[parameter] = setting;
        match fixed(described, parameter, now, &changed) {
            None => Ok(setting),
            Some(why) => {
                let (component, parameter) = names();
                Err(ParameterRefused::Fixed { component, parameter, why })
            }
        }
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
