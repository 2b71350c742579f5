//! Which bodies a look is of, and on which an element of a panel lies, as a page counts them.

use std::collections::BTreeSet;

use onescan_server::signal::did_you_mean;
use onescan_server::signal::pattern::SignalPattern;
use toml::Spanned;

use crate::error::{ScenarioError, Wrong};
use crate::load::Scenario;
use crate::look_file::LookFile;
use crate::panel_file::ElementFile;

/// What there is to be looked at, as a page counts it.
#[derive(Clone, Debug, Default)]
pub struct Visible {
    /// The bodies of plants: `arm`, and `arm/hand` for a shape that is attached to it. Figures come behind them.
    pub bodies: Vec<String>,
    /// The components, each with its body.
    pub parts: Vec<(String, Option<String>)>,
}

/// Where an element of a panel lies on the machine.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct OnMachine {
    /// The bodies, as a page counts them.
    pub bodies: Vec<usize>,
    /// The components by name, with or without a body.
    pub components: Vec<String>,
}

impl Visible {
    /// The names of all bodies, figures behind those of plants.
    fn names<'v>(&'v self, scenario: &'v Scenario) -> Vec<&'v str> {
        let figures = scenario.looks().figures.iter().map(|one| &*one.name);
        self.bodies.iter().map(String::as_str).chain(figures).collect()
    }
}

impl Scenario {
    /// Where an element lies that names a part of the machine.
    ///
    /// # Errors
    /// There is no such part.
    pub fn on_machine(&self, element: &ElementFile, visible: &Visible) -> Result<OnMachine, ScenarioError> {
        let Some(part) = &element.part else { return Ok(OnMachine::default()) };
        on_machine(part, visible, &visible.names(self)).map_err(|found| self.wrong_at(found))
    }

    /// By the number of the look: the bodies that it is of, as a page counts them.
    ///
    /// # Errors
    /// A look of something that is not there, or that moves what a plant moves.
    pub fn seen(&self, visible: &Visible) -> Result<Vec<Vec<usize>>, ScenarioError> {
        let placed = |found: Wrong| self.wrong_at(found);
        let names = visible.names(self);
        for figure in &self.file().figure {
            // an array may be on an array, which its copies name
            for on in figure.on.iter().filter(|on| !on.get_ref().contains("[i]")) {
                if !names.contains(&on.get_ref().as_str()) {
                    return Err(placed(unknown("a figure is on", on, &names)));
                }
            }
        }
        self.looks().looks.iter().map(|look| of(look.get_ref(), visible, &names).map_err(placed)).collect()
    }
}

fn unknown(what: &str, name: &Spanned<String>, names: &[&str]) -> Wrong {
    let help = did_you_mean(name.get_ref(), names.iter().copied());
    Wrong { message: format!("{what} `{}`, which is not there", name.get_ref()), place: name.span(), help }
}

/// What a body is called: a shape that is attached to one goes by its own name, too, and with its body.
fn known_as(name: &str) -> impl Iterator<Item = &str> {
    let parts = name.split_once('/').into_iter().flat_map(|(body, shape)| [body, shape]);
    std::iter::once(name).chain(parts)
}

fn on_machine(part: &Spanned<String>, visible: &Visible, names: &[&str]) -> Result<OnMachine, Wrong> {
    let wanted = part.get_ref().as_str();
    let components = visible.parts.iter().filter(|(name, _)| name == wanted);
    let carried: Vec<&str> = components.clone().filter_map(|(_, body)| body.as_deref()).collect();
    let is_meant = |name: &str| known_as(name).any(|name| name == wanted || carried.contains(&name));
    let bodies = names.iter().enumerate().filter(|(_, name)| is_meant(name)).map(|(number, _)| number);
    let found = OnMachine { bodies: bodies.collect(), components: components.map(|(name, _)| name.clone()).collect() };
    if found == OnMachine::default() {
        let known: Vec<&str> =
            names.iter().copied().chain(visible.parts.iter().map(|(name, _)| name.as_str())).collect();
        return Err(unknown("the element lies on a part", part, &known));
    }
    Ok(found)
}

fn of(look: &LookFile, visible: &Visible, names: &[&str]) -> Result<Vec<usize>, Wrong> {
    let mut found = BTreeSet::new();
    let mut add = |is_meant: &dyn Fn(&str) -> bool| {
        let meant = |number: &usize| names.get(*number).is_some_and(|name| known_as(name).any(is_meant));
        let numbers: Vec<usize> = (0..names.len()).filter(meant).collect();
        found.extend(&numbers);
        !numbers.is_empty()
    };
    let pattern = |written: &Spanned<String>| {
        written.get_ref().parse::<SignalPattern>().map_err(|error| at(written, error.to_string(), None))
    };
    for written in &look.bodies {
        let pattern = pattern(written)?;
        if !add(&|name| pattern.matches(name)) {
            return Err(unknown("the look is of a body", written, names));
        }
        let is_moved = |name: &&String| known_as(name).any(|name| pattern.matches(name));
        if let (true, Some(body)) = (look.moves(), visible.bodies.iter().find(is_moved)) {
            return Err(at(written, format!("`{body}` is moved by its plant"), Some("move a `[[figure]]`")));
        }
    }
    for written in &look.parts {
        let pattern = pattern(written)?;
        let mut parts = visible.parts.iter().filter(|(part, _)| pattern.matches(part)).peekable();
        if parts.peek().is_none() {
            let known: Vec<&str> = visible.parts.iter().map(|(part, _)| part.as_str()).collect();
            return Err(unknown("the look is of a part", written, &known));
        }
        let bodies: Vec<&str> = parts.filter_map(|(_, body)| body.as_deref()).collect();
        if bodies.is_empty() {
            return Err(at(written, format!("`{}` has no body", written.get_ref()), Some("name `bodies`")));
        }
        add(&|name| bodies.contains(&name));
    }
    Ok(found.into_iter().collect())
}

fn at<T>(place: &Spanned<T>, message: String, help: Option<&str>) -> Wrong {
    Wrong { message, place: place.span(), help: help.map(str::to_owned) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_lies_on_a_body_a_figure_or_a_component() {
        let visible = Visible {
            bodies: ["arm", "arm/hand", "belt"].map(str::to_owned).to_vec(),
            parts: vec![("barrier".to_owned(), Some("belt".to_owned())), ("timer".to_owned(), None)],
        };
        let found = |part: &str| {
            let part = Spanned::new(0..0, part.to_owned());
            let found = on_machine(&part, &visible, &["arm", "arm/hand", "belt", "tank"]);
            found.map(|on| (on.bodies, on.components)).map_err(|wrong| (wrong.message, wrong.help))
        };
        let on = |bodies: &[usize], components: &[&str]| {
            Ok((bodies.to_vec(), components.iter().map(|one| (*one).to_owned()).collect::<Vec<_>>()))
        };
        assert_eq!(found("arm"), on(&[0, 1], &[]));
        assert_eq!(found("hand"), on(&[1], &[]));
        assert_eq!(found("tank"), on(&[3], &[]));
        assert_eq!(found("barrier"), on(&[2], &["barrier"]));
        assert_eq!(found("timer"), on(&[], &["timer"]));
        let (message, help) = found("tanc").expect_err("no such part");
        assert_eq!(message, "the element lies on a part `tanc`, which is not there");
        assert!(help.is_some_and(|help| help.contains("tank")));
    }

    #[test]
    fn looks_find_bodies_with_what_is_attached_and_the_bodies_of_parts() {
        let visible = Visible {
            bodies: ["arm", "arm/hand", "belt"].map(str::to_owned).to_vec(),
            parts: vec![("barrier".to_owned(), Some("belt".to_owned())), ("timer".to_owned(), None)],
        };
        let names = ["arm", "arm/hand", "belt", "tank"];
        let found = |more: &str| {
            let look: LookFile = toml::from_str(more).expect("a look");
            of(&look, &visible, &names).map_err(|wrong| wrong.message)
        };
        assert_eq!(found("bodies = [\"arm\"]"), Ok(vec![0, 1]));
        assert_eq!(found("bodies = [\"hand\"]"), Ok(vec![1]));
        assert_eq!(found("bodies = [\"t*\"]\nparts = [\"bar*\"]"), Ok(vec![2, 3]));
        assert_eq!(found("bodies = [\"tnak\"]"), Err("the look is of a body `tnak`, which is not there".into()));
        assert_eq!(found("parts = [\"timer\"]"), Err("`timer` has no body".into()));
        assert_eq!(found("bodies = [\"arm\"]\nmove_m = [0, 0, 1]"), Err("`arm` is moved by its plant".into()));
        assert_eq!(found("bodies = [\"tank\"]\nmove_m = [0, 0, 1]"), Ok(vec![3]));
    }
}
