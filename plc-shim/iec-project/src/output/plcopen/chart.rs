//! Sequential Function Charts (TC6 2.01, `SFC`), drawn from the text: the way back of `input::plcopen_chart`.
//!
//! A step is drawn below the first transition that leads to it; any other leads to it by a jump. Alternatives stand
//! from left to right in the order in which they are evaluated, since CODESYS knows no other rank.

use std::collections::BTreeMap;

use super::super::page::Page;
use super::super::{Refused, Written};
use super::body;
use super::chart_element::{Elements, Place};
use super::markup::escaped;
use super::value::expression;
use onescan_iec::syntax::ast::{Association, ChartStep, Ident, Pou, Transition, TransitionCondition};

/// The body of a unit or action that is a chart, and the transitions that it refers to; nothing for any other.
pub(super) fn parts(pou: &Pou, page: &Page<'_>) -> Written<(String, String)> {
    if pou.chart.is_empty() {
        return Ok((String::new(), String::new()));
    }
    let mut drawing = Drawing::new(pou, page);
    let transitions = drawing.named();
    drawing.draw()?;
    let Drawing { elements, .. } = drawing;
    Ok((format!("<body><SFC>\n{}</SFC></body>\n", elements.xml), transitions))
}

struct Drawing<'a> {
    steps: &'a [ChartStep],
    transitions: &'a [Transition],
    page: &'a Page<'a>,
    /// Where each part of the unit ends that words may stand behind.
    ends: Vec<u32>,
    elements: Elements,
    /// What transitions that leave a step are connected to; nothing before it is drawn.
    outlets: BTreeMap<String, u64>,
    /// Steps that have a place below a transition.
    claimed: Vec<String>,
    /// Steps to be drawn, the next one last, and what they are connected to.
    open: Vec<(usize, Option<u64>, Place)>,
    /// Transitions that have been drawn.
    drawn: Vec<usize>,
}

impl<'a> Drawing<'a> {
    fn new(pou: &'a Pou, page: &'a Page<'a>) -> Self {
        let (steps, transitions) = (&pou.chart.steps[..], &pou.chart.transitions[..]);
        let parts = steps.iter().map(|step| step.span.end).chain(transitions.iter().map(|each| each.span.end));
        let others = pou.sections.iter().map(|section| section.span.end);
        let members = pou.object.members.iter().map(|member| member.pou.span.end);
        let mut ends: Vec<u32> = parts.chain(others).chain(members).chain([pou.name.span.end]).collect();
        ends.sort_unstable();
        Self {
            steps,
            transitions,
            page,
            ends,
            elements: Elements::default(),
            outlets: BTreeMap::new(),
            claimed: Vec::new(),
            open: Vec::new(),
            drawn: Vec::new(),
        }
    }

    /// Comments in a part of the chart and in front of it.
    fn words(&self, start: u32, end: u32) -> String {
        let before = self.ends.iter().rev().find(|other| **other <= start);
        self.page.remarks(before.copied().unwrap_or(start)..end)
    }

    fn draw(&mut self) -> Written<()> {
        let initial = (0..self.steps.len()).filter(|at| self.steps.get(*at).is_some_and(|step| step.is_initial));
        let roots: Vec<usize> = initial.chain(0..self.steps.len()).collect();
        for root in roots {
            let Some(step) = self.steps.get(root).filter(|step| !self.claimed.contains(&step.name.key())) else {
                continue;
            };
            self.claimed.push(step.name.key());
            let place = self.elements.next_column();
            self.open.push((root, None, place));
            while let Some((at, before, place)) = self.open.pop() {
                self.step(at, before, place)?;
            }
        }
        Ok(())
    }

    /// A step, its actions, and the transitions that leave it.
    fn step(&mut self, at: usize, before: Option<u64>, place: Place) -> Written<()> {
        let Some(step) = self.steps.get(at) else { return Ok(()) };
        let actions = step.associations.iter().map(|each| association(each, self.page)).collect::<Written<Vec<_>>>()?;
        let words = self.words(step.span.start, step.span.end);
        let id = self.elements.step(&escaped(&step.name.text), step.is_initial, before, place, &words);
        if !actions.is_empty() {
            self.elements.actions(id, place, &actions);
        }
        let key = step.name.key();
        let mut leaving: Vec<usize> = (0..self.transitions.len()).filter(|each| self.leaves(*each, &key)).collect();
        leaving.sort_by_key(|each| {
            self.transitions.get(*each).and_then(|each| each.priority).map_or(u32::MAX, |of| of.rank)
        });
        let outlet = if leaving.len() > 1 { self.elements.alternatives(id, leaving.len(), place.below()) } else { id };
        self.outlets.insert(key, outlet);
        let mut place = Some(place.below());
        // The next one to be drawn is the last in line.
        let line = self.open.len();
        for each in leaving {
            if self.is_ready(each) {
                let place = place.take().unwrap_or_else(|| self.elements.next_column());
                self.transition(each, place)?;
            }
        }
        if let Some(line) = self.open.get_mut(line..) {
            line.reverse();
        }
        Ok(())
    }

    fn leaves(&self, at: usize, key: &str) -> bool {
        self.transitions.get(at).is_some_and(|each| each.from.iter().any(|from| from.key() == key))
    }

    /// True if every step before a transition has been drawn, and it has not.
    fn is_ready(&self, at: usize) -> bool {
        let Some(transition) = self.transitions.get(at) else { return false };
        !self.drawn.contains(&at) && transition.from.iter().all(|from| self.outlets.contains_key(&from.key()))
    }

    fn transition(&mut self, at: usize, place: Place) -> Written<()> {
        let Some(transition) = self.transitions.get(at) else { return Ok(()) };
        self.drawn.push(at);
        let before: Vec<u64> =
            transition.from.iter().filter_map(|from| self.outlets.get(&from.key()).copied()).collect();
        let before = match before.as_slice() {
            [only] => *only,
            several => self.elements.convergence(several, place),
        };
        let words = self.words(transition.span.start, transition.span.end);
        let rank = transition.priority.map(|priority| priority.rank);
        let condition = self.condition(transition)?;
        let id = self.elements.transition(before, rank, &condition, place, &words);
        let below = place.below().below();
        match transition.to.as_slice() {
            [only] => self.target(only, id, below),
            several => {
                let fork = self.elements.divergence(id, several.len(), below);
                for (index, each) in several.iter().enumerate() {
                    let column = if index == 0 { below } else { self.elements.next_column().level(below) };
                    self.target(each, fork, column.below());
                }
            }
        }
        Ok(())
    }

    /// The step that a transition leads to.
    fn target(&mut self, name: &Ident, before: u64, place: Place) {
        let at = self.steps.iter().position(|step| step.name.key() == name.key());
        match at.filter(|_| !self.claimed.contains(&name.key())) {
            Some(at) => {
                self.claimed.push(name.key());
                self.open.push((at, Some(before), place));
            }
            None => self.elements.jump(&escaped(&name.text), before, place),
        }
    }

    /// What a transition waits for; one with a name is a part of the unit that the chart refers to.
    fn condition(&self, transition: &Transition) -> Written {
        Ok(match (&transition.name, &transition.condition) {
            (Some(name), _) => format!("<reference name=\"{}\"/>", escaped(&name.text)),
            (None, TransitionCondition::Expression(condition)) => {
                let text = body::formatted(&expression(condition, self.page), &[], self.page.wrapper);
                format!("<inline name=\"\">{text}</inline>")
            }
            (None, TransitionCondition::Network(_)) => {
                return Err(Refused::plcopen(transition.span, "statements of a transition without a name"));
            }
        })
    }

    /// The transitions with names; their statements assign to it.
    fn named(&self) -> String {
        let transition = |transition: &Transition| {
            let name = transition.name.as_ref()?;
            let body = match &transition.condition {
                TransitionCondition::Network(statements) => {
                    body::body(self.network(transition), statements, self.page.wrapper)
                }
                TransitionCondition::Expression(condition) => {
                    let text = format!("{} := {};", name.text, expression(condition, self.page));
                    body::body(&text, &[], self.page.wrapper)
                }
            };
            Some(format!("<transition name=\"{}\">\n{body}</transition>\n", escaped(&name.text)))
        };
        self.transitions.iter().filter_map(transition).collect()
    }

    /// The text between the colon of a transition and its end.
    fn network(&self, transition: &Transition) -> &'a str {
        let from = transition.to.last().map_or(transition.span.start, |to| to.span.end);
        let end = transition.span.end.saturating_sub("END_TRANSITION".len() as u32);
        let text = self.page.slice(from..end);
        text.split_once(':').map_or(text, |(_, text)| text)
    }
}

/// The attributes of an association, and the name of its action.
fn association(association: &Association, page: &Page<'_>) -> Written<(String, String)> {
    if association.indicators.len() > 1 {
        return Err(Refused::plcopen(association.span, "an action with several indicators"));
    }
    let qualifier = format!(" qualifier=\"{}\"", association.effective_qualifier().text());
    let attribute = |name: &str, value| format!(" {name}=\"{}\"", escaped(&expression(value, page)));
    let time = association.time.iter().map(|time| attribute("duration", time));
    let indicator = association.indicators.iter().map(|indicator| attribute("indicator", indicator));
    let attributes = std::iter::once(qualifier).chain(time).chain(indicator).collect();
    Ok((attributes, escaped(&association.action.text)))
}
