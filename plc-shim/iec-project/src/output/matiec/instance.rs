//! Arrays of function blocks, which MatIEC has not: each instance becomes a variable of its own, and a loop that chooses
//! one by its variable is written round by round.

use std::fmt::Write as _;

use std::collections::BTreeMap;

use super::repeat::{Loops, end_of};
use super::{Finding, Page};
use crate::output::scl::scope::Scope;
use onescan_iec::source::edits::Edits;
use onescan_iec::syntax::Span;
use onescan_iec::syntax::ast::{
    Argument, Call, Dimension, Expr, ExprKind, ForStatement, Pou, Statement, StatementKind, TypeSpecKind,
};
use onescan_iec::syntax::walk::{self, Visitor};

/// So many rounds of a loop are written one by one, and so many instances of an array.
const MOST: i128 = 1024;
/// What to do instead of what cannot be unrolled.
const HELP: &str = "choose the instance with a number, or with the variable of a FOR between two numbers";

/// First and last index of the arrays of instances of a unit.
type Arrays = BTreeMap<String, (i128, i128)>;

fn arrays(page: &Page<'_>, pou: &Pou, scope: &Scope<'_>) -> Result<Arrays, Finding> {
    let mut found = Arrays::new();
    for variable in pou.sections.iter().flat_map(|section| &section.variables) {
        let TypeSpecKind::Array(dimensions, element) = &variable.spec.kind else { continue };
        let is_block = matches!(&element.kind, TypeSpecKind::Name(name) if is_block(page, &name.key()));
        if !is_block {
            continue;
        }
        let bounds = match dimensions.as_slice() {
            [only] => bounds(page, scope, only),
            _ => None,
        };
        let help = "give it one dimension between two numbers";
        let what = "this array of function blocks";
        let (low, high) = bounds.ok_or_else(|| Finding::new(variable.spec.span, what, help))?;
        found.extend(variable.names.iter().map(|name| (name.key(), (low, high))));
    }
    Ok(found)
}

fn is_block(page: &Page<'_>, key: &str) -> bool {
    let named = page.names.units.get(key);
    named.is_some_and(|pou| pou.kind.has_instances())
}

fn bounds(page: &Page<'_>, scope: &Scope<'_>, dimension: &Dimension) -> Option<(i128, i128)> {
    let [low, high] = [&dimension.low, &dimension.high].map(|bound| page.names.integer_with(bound, &scope.constants));
    let (low, high) = (low?, high?);
    (low <= high && high - low < MOST).then_some((low, high))
}

/// Writes the innermost loops that choose an instance round by round.
pub(super) fn unroll(page: &Page<'_>, edits: &mut Edits) -> Vec<Finding> {
    let mut findings = Vec::new();
    for pou in page.pous() {
        let scope = Scope::of(pou);
        let arrays = match arrays(page, pou, &scope) {
            Ok(arrays) if arrays.is_empty() => continue,
            Ok(arrays) => arrays,
            Err(found) => {
                findings.push(found);
                continue;
            }
        };
        let mut loops = Loops { found: Vec::new() };
        walk::with_members(pou, &mut loops);
        let chosen: Vec<_> =
            loops.found.into_iter().map(|(span, each)| (span, choices(&each, &arrays), each)).collect();
        let chosen: Vec<_> = chosen.into_iter().filter(|(_, choices, _)| !choices.is_empty()).collect();
        for (span, choices, each) in &chosen {
            let is_inner = |(other, _, _): &&(Span, Vec<Span>, ForStatement)| {
                other != span && span.start <= other.start && other.end <= span.end
            };
            if chosen.iter().any(|other| is_inner(&other)) {
                continue;
            }
            match rounds(page, &scope, *span, each, choices) {
                Ok(text) => edits.replace(span.start..text.1, text.0),
                Err(found) => findings.push(found),
            }
        }
    }
    findings
}

/// Where a loop's variable is the index of an array of instances.
fn choices(each: &ForStatement, arrays: &Arrays) -> Vec<Span> {
    let ExprKind::Name(variable) = &each.variable.kind else { return Vec::new() };
    let mut indices = Indices { arrays, found: Vec::new() };
    walk::statements(&each.body, &mut indices);
    let key = variable.key();
    let is_it = |index: &Expr| matches!(&index.kind, ExprKind::Name(name) if name.key() == key);
    indices.found.iter().filter(|(_, _, index)| is_it(index)).map(|(_, _, index)| index.span).collect()
}

/// The rounds of a loop one by one, and where the loop ends.
fn rounds(
    page: &Page<'_>,
    scope: &Scope<'_>,
    span: Span,
    each: &ForStatement,
    choices: &[Span],
) -> Result<(String, u32), Finding> {
    let number = |expr: &Expr| page.names.integer_with(expr, &scope.constants);
    let step = each.by.as_ref().map_or(Some(1), number).filter(|step| *step != 0);
    let (Some(from), Some(to), Some(step)) = (number(&each.from), number(&each.to), step) else {
        return Err(Finding::new(span, "a loop over function blocks whose bounds are not numbers", HELP));
    };
    if jumps(&each.body) {
        let help = "let an IF around the statements do what EXIT does";
        return Err(Finding::new(span, "a loop over function blocks with EXIT or CONTINUE", help));
    }
    let Some((end, behind)) = end_of(page, span) else {
        return Err(Finding::new(span, "this loop over function blocks", HELP));
    };
    let start = each.body.first().map_or(end, |first| first.span.start);
    let text = page.file.text();
    let variable = page.text(each.variable.span);
    let mut whole = String::new();
    let mut index = from;
    let is_more = |index: i128| if step > 0 { index <= to } else { index >= to };
    while is_more(index) && (index - from).abs() < MOST * step.abs() {
        let _ = writeln!(whole, "{variable} := {index};");
        let mut at = start;
        for choice in choices {
            whole += text.get(at as usize..choice.start as usize).unwrap_or("");
            whole += &index.to_string();
            at = choice.end;
        }
        whole += text.get(at as usize..end as usize).unwrap_or("").trim_end();
        whole.push('\n');
        index += step;
    }
    let _ = write!(whole, "{variable} := {index}");
    Ok((whole, behind))
}

/// True for statements that leave a loop, or one of its rounds.
fn jumps(list: &[Statement]) -> bool {
    struct Jumps(bool);
    impl Visitor for Jumps {
        fn statement(&mut self, statement: &Statement) {
            self.0 |= matches!(statement.kind, StatementKind::Exit | StatementKind::Continue);
        }
    }
    let mut jumps = Jumps(false);
    walk::statements(list, &mut jumps);
    jumps.0
}

/// Writes a variable for each instance.
pub(super) fn name(page: &Page<'_>, edits: &mut Edits) -> Vec<Finding> {
    let mut findings = Vec::new();
    for pou in page.pous() {
        let scope = Scope::of(pou);
        let Ok(arrays) = arrays(page, pou, &scope) else { continue };
        if arrays.is_empty() {
            continue;
        }
        for variable in pou.sections.iter().flat_map(|section| &section.variables) {
            let Some((name, (low, high))) =
                variable.names.first().and_then(|name| Some((name, arrays.get(&name.key())?)))
            else {
                continue;
            };
            if let Some(initial) = &variable.initial {
                let what = "initial values of an array of function blocks";
                findings.push(Finding::new(initial.span, what, "give its inputs their values in the first scan"));
                continue;
            }
            let TypeSpecKind::Array(_, element) = &variable.spec.kind else { continue };
            let element = page.text(element.span);
            let all: Vec<String> =
                (*low..=*high).map(|index| format!("{} : {element}", numbered(&name.text, index))).collect();
            edits.replace(name.span.start..variable.spec.span.end, all.join("; "));
        }
        let mut indices = Indices { arrays: &arrays, found: Vec::new() };
        walk::with_members(pou, &mut indices);
        for (whole, base, index) in indices.found {
            let value = page.names.integer_with(&index, &scope.constants);
            let bounds = arrays.get(&base.to_ascii_uppercase());
            match value.zip(bounds).filter(|(value, (low, high))| low <= value && value <= high) {
                Some((value, _)) => edits.replace(whole.start..whole.end, numbered(&base, value)),
                None => {
                    findings.push(Finding::new(index.span, "a function block that is chosen while it runs", HELP));
                }
            }
        }
    }
    findings
}

fn numbered(name: &str, index: i128) -> String {
    if index < 0 { format!("{name}_m{}", -index) } else { format!("{name}_{index}") }
}

/// Every place that chooses an instance: all of it, the array's name, the index.
struct Indices<'i> {
    arrays: &'i Arrays,
    found: Vec<(Span, String, Expr)>,
}

impl Indices<'_> {
    fn place(&mut self, place: &Expr) {
        match &place.kind {
            ExprKind::Member(inner, _) | ExprKind::Part(inner, _) | ExprKind::Paren(inner) => self.place(inner),
            ExprKind::Index(base, list) => match (&base.kind, list.as_slice()) {
                (ExprKind::Name(name), [index]) if self.arrays.contains_key(&name.key()) => {
                    let known = self.found.iter().any(|(span, ..)| *span == place.span);
                    if !known {
                        self.found.push((place.span, name.text.clone(), index.clone()));
                    }
                }
                _ => self.place(base),
            },
            _ => {}
        }
    }
}

impl Visitor for Indices<'_> {
    fn target(&mut self, target: &Expr) {
        self.place(target);
    }

    fn call(&mut self, call: &Call) {
        self.place(&call.callee);
        for argument in &call.arguments {
            if let Argument::Output { target: Some(target), .. } = argument {
                self.place(target);
            }
        }
    }

    fn expression(&mut self, expr: &Expr) {
        self.place(expr);
    }
}
