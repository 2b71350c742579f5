//! Programs, function blocks and functions (TC6 2.01, `pou`), and what CODESYS adds to them.

use super::super::page::Page;
use super::super::{Refused, Written};
use super::markup::{additions, documentation, escaped};
use super::types::type_of;
use super::{body, chart, object, variables};
use crate::syntax::ast::{Member, MemberKind, Pou, PouKind};

/// `<pou>`; `words` are said of it.
pub(crate) fn unit(pou: &Pou, words: &str, page: &Page<'_>) -> Written {
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
    let heritage = object::heritage(&pou.object) + &object::modifiers(&pou.object.modifiers);
    let words = [words, &body::words_of_head(pou, page)].join("\n");
    let (steps, transitions) = chart::parts(pou, page)?;
    let body = if steps.is_empty() { body::of_unit(pou, page) } else { steps };
    Ok(format!(
        "<pou name=\"{}\" pouType=\"{kind}\">\n{}{}{transitions}{body}{}{}</pou>\n",
        escaped(&pou.name.text),
        interface(pou, &heritage, page)?,
        actions(pou, page)?,
        additions(&object::members(pou, page)?),
        documentation(words.trim()),
    ))
}

/// `<interface>`: result, variables, and CODESYS' additions.
pub(super) fn interface(pou: &Pou, added: &str, page: &Page<'_>) -> Written {
    let result = match &pou.result {
        Some(result) => format!("<returnType>{}</returnType>\n", type_of(result, page)?),
        None => String::new(),
    };
    let sections = variables::sections(&pou.sections, page)?;
    Ok(format!("<interface>\n{result}{sections}{}</interface>\n", additions(added)))
}

fn actions(pou: &Pou, page: &Page<'_>) -> Written {
    let action = |member: &Member| {
        let action = &member.pou;
        if let Some(section) = action.sections.first() {
            return Err(Refused::plcopen(section.span, "variables of an action"));
        }
        if !action.chart.is_empty() {
            return Err(Refused::plcopen(action.name.span, "a chart in an action"));
        }
        let body = body::of_action(action, page);
        Ok(format!("<action name=\"{}\">\n{body}</action>\n", escaped(&action.name.text)))
    };
    let actions = pou.object.members.iter().filter(|member| member.kind == MemberKind::Action);
    let xml = actions.map(action).collect::<Written<String>>()?;
    Ok(if xml.is_empty() { xml } else { format!("<actions>\n{xml}</actions>\n") })
}
