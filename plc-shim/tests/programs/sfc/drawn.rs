//! Charts as PLCopen XML has them, drawn from lists of steps and transitions.

use std::fmt::Write;

use super::chart::{ACTIONS, BOOLEAN, Chart, Condition};
use crate::plcopen::{block, contact, input, pou, project, rail};

/// A step and its associations: qualifier, time (or nothing), what it does.
pub(crate) struct Step<'d> {
    pub(crate) name: &'d str,
    pub(crate) actions: Vec<(&'d str, String, String)>,
}

/// A transition; `condition` is the element of this name, `elements` are drawn beside it.
pub(crate) struct Transition {
    pub(crate) from: Vec<usize>,
    pub(crate) to: Vec<usize>,
    pub(crate) priority: Option<u32>,
    pub(crate) condition: String,
    pub(crate) elements: String,
}

/// Numbers of elements by what they are.
const BLOCKS: usize = 1000;
const TRANSITIONS: usize = 2000;
const CONVERGENCES: usize = 3000;
const DIVERGENCES: usize = 4000;
/// The first number of the elements beside a transition, and how many each has.
const BESIDE: usize = 10_000;
const EACH: usize = 10;

fn connected(ids: &[usize]) -> String {
    let connections: String = ids.iter().map(|id| format!("<connection refLocalId=\"{id}\"/>")).collect();
    if ids.is_empty() { String::new() } else { format!("<connectionPointIn>{connections}</connectionPointIn>") }
}

/// The content of `<SFC>`; the first step is the initial one.
pub(crate) fn chart(steps: &[Step<'_>], transitions: &[Transition]) -> String {
    let mut xml = String::new();
    for (index, step) in steps.iter().enumerate() {
        let leads_here = |transition: &Transition| transition.to.contains(&index);
        let before = transitions.iter().enumerate().filter(|(_, transition)| leads_here(transition));
        let before: Vec<usize> =
            before.map(|(at, each)| if each.to.len() > 1 { DIVERGENCES + at } else { TRANSITIONS + at }).collect();
        let (id, x, initial) = (index + 1, index * 100, if index == 0 { " initialStep=\"true\"" } else { "" });
        write!(
            xml,
            "<step localId=\"{id}\" name=\"{}\"{initial}>\n<position x=\"{x}\" y=\"0\"/>\n{}\n\
             <connectionPointOut formalParameter=\"\"/>\n</step>\n",
            step.name,
            connected(&before)
        )
        .expect("a string");
        xml += &actions(BLOCKS + index, x + 50, id, &step.actions);
    }
    for (index, each) in transitions.iter().enumerate() {
        xml += &transition(index, each);
    }
    xml
}

fn actions(id: usize, x: usize, step: usize, actions: &[(&str, String, String)]) -> String {
    if actions.is_empty() {
        return String::new();
    }
    let mut xml = format!("<actionBlock localId=\"{id}\">\n<position x=\"{x}\" y=\"0\"/>\n{}\n", connected(&[step]));
    for (row, (qualifier, time, does)) in actions.iter().enumerate() {
        let duration = if time.is_empty() { String::new() } else { format!(" duration=\"{time}\"") };
        let does = if does.starts_with('<') { does.clone() } else { format!("<reference name=\"{does}\"/>") };
        writeln!(
            xml,
            "<action localId=\"{}\" qualifier=\"{qualifier}\"{duration}><relPosition x=\"0\" y=\"{}\"/>{does}</action>",
            BESIDE * 10 + id * 10 + row,
            row * 20
        )
        .expect("a string");
    }
    xml + "</actionBlock>\n"
}

fn transition(index: usize, transition: &Transition) -> String {
    let mut xml = transition.elements.clone();
    let steps: Vec<usize> = transition.from.iter().map(|step| step + 1).collect();
    let x = index * 10;
    let before = if let [only] = steps.as_slice() {
        *only
    } else {
        let points: String = steps.iter().map(|step| connected(&[*step])).collect();
        let id = CONVERGENCES + index;
        writeln!(
            xml,
            "<simultaneousConvergence localId=\"{id}\"><position x=\"{x}\" y=\"40\"/>{points}<connectionPointOut/>\
             </simultaneousConvergence>"
        )
        .expect("a string");
        id
    };
    let priority = transition.priority.map_or_else(String::new, |rank| format!(" priority=\"{rank}\""));
    writeln!(
        xml,
        "<transition localId=\"{}\"{priority}>\n<position x=\"{x}\" y=\"60\"/>\n{}<connectionPointOut/>\n{}\n</transition>",
        TRANSITIONS + index,
        connected(&[before]),
        transition.condition
    )
    .expect("a string");
    if transition.to.len() > 1 {
        writeln!(
            xml,
            "<simultaneousDivergence localId=\"{}\"><position x=\"{x}\" y=\"80\"/>{}\
             <connectionPointOut formalParameter=\"\"/></simultaneousDivergence>",
            DIVERGENCES + index,
            connected(&[TRANSITIONS + index])
        )
        .expect("a string");
    }
    xml
}

/// An expression in ST.
pub(crate) fn inline(expression: &str) -> String {
    let paragraph = format!("<xhtml:p xmlns:xhtml=\"http://www.w3.org/1999/xhtml\"><![CDATA[{expression}]]></xhtml:p>");
    format!("<inline name=\"\"><ST>{paragraph}</ST></inline>")
}

pub(crate) fn condition(content: &str) -> String {
    format!("<condition>{content}</condition>")
}

pub(crate) fn negated(content: &str) -> String {
    format!("<condition negated=\"true\">{content}</condition>")
}

impl Chart {
    /// The same program as [`Chart::text`], drawn: conditions are variables, text, contacts and blocks in turn.
    pub(crate) fn drawn(&self) -> String {
        let names: Vec<String> = (0..self.steps).map(|step| format!("s{step}")).collect();
        let steps: Vec<Step<'_>> = names
            .iter()
            .enumerate()
            .map(|(index, name)| {
                let uses = self.uses.iter().filter(|used| used.step == index);
                let actions = uses.map(|used| (used.qualifier, used.time(), format!("b{}", used.action)));
                Step { name, actions: actions.collect() }
            })
            .collect();
        let transitions = self.links.iter().enumerate().map(|(index, link)| {
            let (condition, elements) = drawn_condition(index, &link.condition);
            Transition { from: link.from.clone(), to: link.to.clone(), priority: link.priority, condition, elements }
        });
        let sfc = chart(&steps, &transitions.collect::<Vec<_>>());
        let used = (BOOLEAN..ACTIONS).filter(|action| self.uses.iter().any(|used| used.action == *action));
        let actions: String = used
            .map(|action| {
                let body = format!("log := log * 31 + {} + BOOL_TO_UDINT(b{action}.Q);", action * 2);
                format!("<action name=\"b{action}\"><body>{}</body></action>\n", inline_body(&body))
            })
            .collect();
        let sections = "local c0 : BOOL, c1 : BOOL, c2 : BOOL, c3 : BOOL, b0 : BOOL, b1 : BOOL, b2 : BOOL, log : UDINT";
        let actions =
            if actions.is_empty() { String::new() } else { format!("</interface>\n<actions>\n{actions}</actions>\n") };
        let unit = pou("program", "P", sections, "SFC", &sfc).replace("<derived name=\"UDINT\"/>", "<UDINT/>");
        project(&if actions.is_empty() { unit } else { unit.replace("</interface>", &actions) })
    }
}

fn inline_body(statements: &str) -> String {
    inline(statements).replace("<inline name=\"\">", "").replace("</inline>", "")
}

/// A condition, and the elements that lead to it.
fn drawn_condition(index: usize, of: &Condition) -> (String, String) {
    let first = (BESIDE + index * EACH) as u32;
    let wired = |id: u32, pin: &str| {
        let pin = if pin.is_empty() { String::new() } else { format!(" formalParameter=\"{pin}\"") };
        condition(&format!("<connectionPointIn><connection refLocalId=\"{id}\"{pin}/></connectionPointIn>"))
    };
    let text = |expression: &str| (condition(&inline(expression)), String::new());
    let not = |expression: &str| (negated(&inline(&format!("NOT ({expression});"))), String::new());
    let drawn = |expression: &str| (wired(first, ""), input(first, (0, 60), expression));
    let ladder = |variable: &str| {
        let elements = rail(first) + &contact(first + 1, (0, 60), &first.to_string(), variable, "");
        (wired(first + 1, ""), elements)
    };
    match of {
        Condition::Input(number) => {
            let name = format!("c{number}");
            match index % 4 {
                0 => (condition(&format!("<reference name=\"{name}\"/>")), String::new()),
                1 => ladder(&name),
                2 => drawn(&name),
                _ => not(&name),
            }
        }
        Condition::Elapsed(step, ms) if index.is_multiple_of(2) => {
            let pins = format!("IN1={} IN2={}", first, first + 1);
            let elements = input(first, (0, 60), &format!("s{step}.T"))
                + &input(first + 1, (0, 80), &format!("T#{ms}ms"))
                + &block(first + 2, (40, 60), "GE", &pins, "OUT", "");
            (wired(first + 2, "OUT"), elements)
        }
        Condition::Elapsed(step, ms) => text(&format!("s{step}.T >= T#{ms}ms")),
        Condition::Active(step) if index.is_multiple_of(2) => drawn(&format!("s{step}.X")),
        Condition::Active(step) => not(&format!("s{step}.X")),
        Condition::Always if index.is_multiple_of(2) => (wired(first, ""), rail(first)),
        Condition::Always => text("TRUE"),
    }
}
