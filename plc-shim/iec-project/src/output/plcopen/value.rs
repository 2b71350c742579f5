//! Initial values (TC6 2.01, `value`).

use super::super::page::Page;
use super::super::{Refused, Written};
use super::markup::escaped;
use onescan_iec::syntax::ast::{Expr, Initialiser, InitialiserKind};
use onescan_iec::syntax::printer::print_expression;

/// An expression as it is written, in one line.
pub(super) fn expression(expr: &Expr, page: &Page<'_>) -> String {
    let at = expr.span.start..expr.span.end;
    let written = page.slice(at.clone());
    let is_plain = !written.is_empty() && !written.contains('\n') && page.remarks(at).is_empty();
    if is_plain { written.to_owned() } else { print_expression(expr) }
}

/// `<initialValue>` of a declaration; nothing without one.
pub(super) fn initial(initial: Option<&Initialiser>, page: &Page<'_>) -> Written {
    let Some(initial) = initial else { return Ok(String::new()) };
    Ok(format!("<initialValue>{}</initialValue>", value(initial, page)?))
}

fn value(initial: &Initialiser, page: &Page<'_>) -> Written {
    Ok(match &initial.kind {
        InitialiserKind::Value(value) => format!("<simpleValue value=\"{}\"/>", escaped(&expression(value, page))),
        InitialiserKind::Array(values) => {
            let values: Vec<String> = values.iter().map(|each| element(each, page)).collect::<Written<_>>()?;
            format!("<arrayValue>{}</arrayValue>", values.concat())
        }
        InitialiserKind::Struct(members) => {
            let member = |name: &str, each| Ok(format!("<value member=\"{name}\">{}</value>", value(each, page)?));
            let members = members.iter().map(|each| member(&escaped(&each.name.text), &each.value));
            format!("<structValue>{}</structValue>", members.collect::<Written<String>>()?)
        }
        InitialiserKind::Repeat(..) => return Err(Refused::plcopen(initial.span, "a repetition outside of an array")),
        InitialiserKind::Elements(_) => return Err(Refused::plcopen(initial.span, "a start value of single elements")),
    })
}

/// An element of an array, repeated or not.
fn element(initial: &Initialiser, page: &Page<'_>) -> Written {
    let InitialiserKind::Repeat(times, repeated) = &initial.kind else {
        return Ok(format!("<value>{}</value>", value(initial, page)?));
    };
    let Some(repeated) = repeated else {
        return Err(Refused::plcopen(initial.span, "a repetition without a value"));
    };
    let times = escaped(&expression(times, page));
    Ok(format!("<value repetitionValue=\"{times}\">{}</value>", value(repeated, page)?))
}
