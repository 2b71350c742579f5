//! Sequential Function Charts to steps and transitions in text.
//!
//! A chart is a line of steps and transitions; a branch in it has such lines as its legs. Legs that begin with steps
//! are simultaneous, legs that begin with transitions are alternatives.

use std::collections::BTreeSet;
use std::ops::Range;

use super::archive::{Object, Written};
use super::chart_element::{Attributes, Step, Transition};
use super::sheet::Sheet;
use crate::diagnostic::Code;
use crate::input::statement::Text;

/// Deepest branch in a branch.
const MAX_DEPTH: usize = 50;

/// Most transitions of a chart: one that several steps lead to in alternatives counts for each.
const MAX_TRANSITIONS: usize = 10_000;

/// What may be active where the next element of a line stands.
#[derive(Debug, Clone, PartialEq, Eq)]
enum Open {
    /// Steps that are active together.
    Steps(Vec<String>),
    /// A transition that leads to the next element.
    Transition(usize),
}

/// A chart while it is read.
struct Chart<'c, 's> {
    sheet: &'c mut Sheet<'s>,
    steps: Vec<Step>,
    transitions: Vec<Transition>,
}

/// Reads a chart: its steps and transitions go to the sheet, and the actions that it needs are given back.
pub(super) fn read(sheet: &mut Sheet<'_>, body: Object<'_>, bodies: &super::chart_element::Bodies<'_>) -> Vec<Text> {
    let mut chart = Chart { sheet, steps: Vec::new(), transitions: Vec::new() };
    let place = body.place();
    let Some(root) = body.object("Root") else {
        chart.sheet.report(&place, Code::MalformedXml, "this chart has no `Root`".to_owned());
        return Vec::new();
    };
    let ends = chart.line(root, Vec::new(), 0);
    for end in ends {
        if let Open::Transition(index) = end {
            chart.leads_nowhere(index);
        }
    }
    let Chart { sheet, steps, transitions } = chart;
    let mut names = BTreeSet::new();
    for step in &steps {
        if !names.insert(step.name.to_ascii_uppercase()) {
            let message = format!("there is a step `{}` already", step.name);
            sheet.report(&step.place, Code::DuplicateElement, message);
        }
    }
    let actions = steps.iter().filter_map(|step| step.write(sheet)).collect();
    for transition in transitions.iter().filter(|transition| !transition.to.is_empty()) {
        transition.write(sheet, bodies);
    }
    actions
}

impl Chart<'_, '_> {
    fn leads_nowhere(&mut self, index: usize) {
        if let Some(transition) = self.transitions.get(index) {
            let (place, message) = (transition.place.clone(), "this transition leads to no step".to_owned());
            self.sheet.report(&place, Code::MalformedXml, message);
        }
    }

    /// The elements of a line, one behind the other.
    fn line(&mut self, segment: Object<'_>, mut open: Vec<Open>, depth: usize) -> Vec<Open> {
        for element in segment.inner("ElementList") {
            open = match element.kind {
                "SFCStep" => self.step(element, open),
                "SFCTransition" => self.transition(element, open),
                "SFCJump" => self.jump(element, open),
                "SFCBranch" => self.branch(element, &open, depth + 1),
                other => {
                    let what = format!("element {} of a chart (`{other}`)", element.id(self.sheet.file));
                    self.sheet.unsupported(&element.place(), &what);
                    open
                }
            };
        }
        open
    }

    /// Lets all open transitions lead to a step too.
    fn lead(&mut self, open: Vec<Open>, name: &str, place: &Range<u32>) {
        for end in open {
            match end {
                Open::Transition(index) => {
                    if let Some(transition) = self.transitions.get_mut(index) {
                        transition.to.push(name.to_owned());
                    }
                }
                Open::Steps(_) => {
                    let message = format!("there is no transition before `{name}`");
                    self.sheet.report(place, Code::MalformedXml, message);
                }
            }
        }
    }

    fn step(&mut self, element: Object<'_>, open: Vec<Open>) -> Vec<Open> {
        let Some(step) = Step::read(self.sheet, element) else { return Vec::new() };
        let (name, place) = (step.name.clone(), step.place.clone());
        self.steps.push(step);
        self.lead(open, &name, &place);
        vec![Open::Steps(vec![name])]
    }

    fn transition(&mut self, element: Object<'_>, open: Vec<Open>) -> Vec<Open> {
        let place = element.place();
        if open.is_empty() {
            let message = "there is no step before this transition".to_owned();
            self.sheet.report(&place, Code::MalformedXml, message);
        }
        let mut behind = Vec::new();
        for end in open {
            let Open::Steps(from) = end else {
                let message = "there is no step between this transition and the one before".to_owned();
                self.sheet.report(&place, Code::MalformedXml, message);
                continue;
            };
            if self.transitions.len() >= MAX_TRANSITIONS {
                let message = format!("a chart has at most {MAX_TRANSITIONS} transitions");
                self.sheet.report(&place, Code::TooLarge, message);
                return Vec::new();
            }
            if let Some(transition) = Transition::read(self.sheet, element, from) {
                behind.push(Open::Transition(self.transitions.len()));
                self.transitions.push(transition);
            }
        }
        behind
    }

    fn jump(&mut self, element: Object<'_>, open: Vec<Open>) -> Vec<Open> {
        let attributes = Attributes::read(self.sheet.file, element);
        let target = attributes.value(super::chart_element::NAME).map(|name: &Written| name.plain.trim().to_owned());
        self.lead(open, &target.unwrap_or_default(), &element.place());
        Vec::new()
    }

    fn branch(&mut self, element: Object<'_>, open: &[Open], depth: usize) -> Vec<Open> {
        let place = element.place();
        let legs = element.inner("ElementList");
        if depth > MAX_DEPTH {
            let message = format!("branches are nested deeper than {MAX_DEPTH} levels");
            self.sheet.report(&place, Code::TooLarge, message);
            return Vec::new();
        }
        let attributes = Attributes::read(self.sheet.file, element);
        let declared = attributes.is_set(super::chart_element::PARALLEL);
        let drawn =
            legs.iter().any(|leg| leg.inner("ElementList").first().is_some_and(|first| first.kind == "SFCStep"));
        if declared != drawn {
            let message = format!(
                "the legs of branch {} begin with {}, but it says that it is {}",
                element.id(self.sheet.file),
                if drawn { "steps" } else { "transitions" },
                if declared { "simultaneous" } else { "alternative" }
            );
            self.sheet.report(&place, Code::MalformedXml, message);
            return Vec::new();
        }
        let ends: Vec<Vec<Open>> = legs.into_iter().map(|leg| self.line(leg, open.to_vec(), depth)).collect();
        if declared { self.together(ends, &place) } else { ends.into_iter().flatten().collect() }
    }

    /// The ends of simultaneous legs: one step of each is active.
    fn together(&mut self, legs: Vec<Vec<Open>>, place: &Range<u32>) -> Vec<Open> {
        let mut joined: Vec<Vec<String>> = vec![Vec::new()];
        for leg in legs {
            let mut next = Vec::new();
            for end in leg {
                let Open::Steps(steps) = end else {
                    let message = "a leg of a simultaneous branch ends with a step".to_owned();
                    self.sheet.report(place, Code::MalformedXml, message);
                    return Vec::new();
                };
                next.extend(joined.iter().map(|before| before.iter().chain(&steps).cloned().collect::<Vec<String>>()));
            }
            if next.len() > MAX_TRANSITIONS {
                self.sheet.report(place, Code::TooLarge, format!("a branch has at most {MAX_TRANSITIONS} ends"));
                return Vec::new();
            }
            joined = next;
        }
        joined.into_iter().map(Open::Steps).collect()
    }
}
