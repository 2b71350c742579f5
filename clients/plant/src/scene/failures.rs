//! Second pass over `[[failure]]`: what fails, how and when.

use super::placed::Placed;
use onescan_base::nearest;
use onescan_server::signal::SignalType;
use thiserror::Error;

use super::error::{SceneFaultKind, Thing};
use super::faults::Faults;
use super::format::FailureTable;
use super::model::{Between, Component, FailureSwitch, Scene, When};
use super::number::{Allowed, Entry};
use super::own::Aliases;
use super::signals::Signals;
use super::text;

/// A failure that a scene does not have.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum UnknownFailure {
    /// The scene does not have the component.
    #[error("no component `{component}` in this scene{}", in_brackets(.hint.as_deref()))]
    Component {
        /// The name that was looked for.
        component: String,
        /// The nearest name, as a question, if one is near.
        hint: Option<String>,
    },
    /// The component does not fail in this way.
    #[error("component `{component}` has no failure mode `{mode}` ({hint})")]
    Mode {
        component: String,
        /// The mode that was looked for.
        mode: String,
        /// The nearest mode, as a question, or all modes that there are.
        hint: String,
    },
}

/// A hint as it follows a message.
pub(super) fn in_brackets(hint: Option<&str>) -> String {
    hint.map_or_else(String::new, |hint| format!(" ({hint})"))
}

/// A mode of a component: the component's index in the scene, the mode's among those of its kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct FoundMode {
    pub(crate) component: usize,
    pub(crate) mode: usize,
}

impl Scene {
    /// Checks that a component of the scene fails in this way, so that a failure can be refused
    /// before a plant runs.
    ///
    /// # Errors
    /// An unknown component or mode, in the words that a wrong `[[failure]]` gets.
    pub fn check_failure(&self, component: &str, mode: &str) -> Result<(), UnknownFailure> {
        self.find_failure(component, mode).map(|_| ())
    }

    /// The mode of a component that these names mean.
    pub(crate) fn find_failure(&self, component: &str, mode: &str) -> Result<FoundMode, UnknownFailure> {
        find(&self.components, &self.aliases, component, mode)
    }

    /// The components that are assemblies of the user's own, each with its kind.
    pub fn assemblies(&self) -> &[(String, String)] {
        self.aliases.assemblies()
    }
}

fn find(components: &[Component], aliases: &Aliases, component: &str, mode: &str) -> Result<FoundMode, UnknownFailure> {
    let (component, mode) = match aliases.mode(component, mode) {
        Some(part) => part,
        None if aliases.is_assembly(component) => {
            let modes: Vec<&str> = aliases.modes_of(component).collect();
            let hint = mode_hint(&modes, mode);
            return Err(UnknownFailure::Mode { component: component.to_owned(), mode: mode.to_owned(), hint });
        }
        None => (component, mode),
    };
    let at = place_of(components, component)
        .map_err(|hint| UnknownFailure::Component { component: component.to_owned(), hint })?;
    let modes: Vec<&str> = components[at].kind.failures.iter().map(|failure| &*failure.mode).collect();
    match modes.iter().position(|known| *known == mode) {
        Some(mode) => Ok(FoundMode { component: at, mode }),
        None => Err(UnknownFailure::Mode {
            component: component.to_owned(),
            mode: mode.to_owned(),
            hint: mode_hint(&modes, mode),
        }),
    }
}

fn mode_hint(modes: &[&str], wrong: &str) -> String {
    hint(modes, wrong, "it may be")
}

/// The place of the component of this name; else the nearest name, as a question, if one is near.
pub(super) fn place_of(components: &[Component], name: &str) -> Result<usize, Option<String>> {
    let near = || nearest(name, components.iter().map(|known| known.name.as_str())).map(did_you_mean);
    components.iter().position(|known| known.name == name).ok_or_else(near)
}

/// The nearest of some names, as a question; all of them behind `listed` if none is near.
pub(super) fn hint(known: &[&str], wrong: &str, listed: &str) -> String {
    let all = || {
        let all: Vec<_> = known.iter().map(|known| format!("`{known}`")).collect();
        if all.is_empty() { "it has none".to_owned() } else { format!("{listed} {}", all.join(", ")) }
    };
    nearest(wrong, known.iter().copied()).map_or_else(all, did_you_mean)
}

fn did_you_mean(near: &str) -> String {
    format!("did you mean `{near}`?")
}

pub(super) fn check(
    tables: &[Placed<FailureTable>],
    (components, lost, aliases): (&mut [Component], &[String], &Aliases),
    signals: &mut Signals,
    faults: &mut Faults<'_>,
) {
    for table in tables.iter().map(Placed::get_ref) {
        let when = when(table, signals, faults);
        if lost.iter().any(|lost| lost == text(&table.component)) {
            continue;
        }
        match find(components, aliases, text(&table.component), text(&table.mode)) {
            Ok(FoundMode { component, mode }) => {
                if let Some(when) = when {
                    components[component].failures.push(FailureSwitch { mode, when });
                }
            }
            Err(UnknownFailure::Component { component, hint }) => {
                let kind = SceneFaultKind::Unknown { thing: Thing::Component, name: component };
                faults.add_hinted(table.component.span(), kind, hint);
            }
            Err(UnknownFailure::Mode { component, mode, hint }) => {
                let kind = SceneFaultKind::ComponentPart { component, what: "failure mode", name: mode };
                faults.add_hinted(table.mode.span(), kind, Some(hint));
            }
        }
    }
}

fn when(table: &FailureTable, signals: &mut Signals, faults: &mut Faults<'_>) -> Option<When> {
    let from = Entry::new("from_s", table.from_s.as_ref());
    let until = Entry::new("until_s", table.until_s.as_ref());
    if let Some(signal) = &table.signal {
        if let Some(time) = from.value.or(until.value) {
            faults.add(time.span(), SceneFaultKind::FailureTwice);
        }
        return signals.read(signal, SignalType::BOOL, faults).map(When::Signal);
    }
    let from_s = faults.number(from, Allowed::NotNegative).unwrap_or(0.0);
    let until_s = faults.number(until, Allowed::NotNegative);
    if let (Some(until_s), Some(value)) = (until_s, until.value)
        && until_s <= from_s
    {
        faults.add(value.span(), SceneFaultKind::Order { lower: "from_s", upper: "until_s" });
    }
    let until_ns = until_s.map_or(u64::MAX, nanoseconds);
    Some(When::Between(Between { from_ns: nanoseconds(from_s), until_ns }))
}

/// The nearest whole number of nanoseconds.
pub(super) fn nanoseconds(time_s: f64) -> u64 {
    (time_s * 1e9).round() as u64
}
