//! Programs, function blocks and functions (TC6 2.01, `pou`), and what CODESYS adds to them.

use super::super::page::Page;
use super::super::{Refused, Written};
use super::about::About;
use super::interface::interface;
use super::markup::{additions, escaped};
use super::{body, chart, object};
use onescan_iec::syntax::ast::{Member, MemberKind, Pou, PouKind};

/// `<pou>`
pub(crate) fn unit(pou: &Pou, about: About, page: &Page<'_>) -> Written {
    let kind = match pou.kind {
        PouKind::Program => "program",
        PouKind::Function => "function",
        PouKind::FunctionBlock => "functionBlock",
        PouKind::Class => return Err(Refused::plcopen(pou.name.span, "a CLASS")),
        PouKind::Interface | PouKind::Method | PouKind::Action => {
            return Err(Refused::plcopen(pou.name.span, "this unit"));
        }
    };
    if let Some(using) = pou.object.using.first() {
        return Err(Refused::plcopen(using.span, "USING"));
    }
    let heritage = object::heritage(&pou.object) + &object::modifiers(&pou.object.modifiers) + about.added();
    let about = about.with_words(&body::words_of_head(pou, page));
    let (steps, transitions) = chart::parts(pou, page)?;
    let body = if steps.is_empty() { body::of_unit(pou, page) } else { steps };
    let (actions, others) = actions(pou, page)?;
    let transitions = list("transitions", &[transitions, others].concat());
    Ok(format!(
        "<pou name=\"{}\" pouType=\"{kind}\">\n{}{actions}{transitions}{body}{}{}</pou>\n",
        escaped(&pou.name.text),
        interface(pou, &heritage, page)?,
        additions(&object::members(pou, page)?),
        about.documentation(),
    ))
}

/// `<actions>`, and the transitions to which those refer that are charts.
fn actions(pou: &Pou, page: &Page<'_>) -> Written<(String, String)> {
    let action = |member: &Member| {
        let action = &member.pou;
        if let Some(section) = action.sections.first() {
            return Err(Refused::plcopen(section.span, "variables of an action"));
        }
        let (steps, transitions) = chart::parts(action, page)?;
        let body = if steps.is_empty() { body::of_action(action, page) } else { steps };
        Ok((format!("<action name=\"{}\">\n{body}</action>\n", escaped(&action.name.text)), transitions))
    };
    let actions = pou.object.members.iter().filter(|member| member.kind == MemberKind::Action);
    let (xml, transitions): (Vec<_>, Vec<_>) = actions.map(action).collect::<Written<Vec<_>>>()?.into_iter().unzip();
    Ok((list("actions", &xml.concat()), transitions.concat()))
}

/// A list of elements; nothing without any.
fn list(element: &str, inner: &str) -> String {
    if inner.is_empty() { String::new() } else { format!("<{element}>\n{inner}</{element}>\n") }
}
