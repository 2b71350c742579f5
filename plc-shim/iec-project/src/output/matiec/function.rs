//! Calls of functions where MatIEC has less than others, or writes wrong C: a function that is called as a statement
//! gives its value to a variable that nobody reads; one without inputs or without a value gets them.

use std::collections::BTreeSet;

use super::{Finding, Page};
use onescan_iec::source::edits::Edits;
use onescan_iec::syntax::ast::{
    Argument, Call, Expr, ExprKind, Ident, Literal, Pou, PouKind, SectionKind, Statement, StatementKind, TypeSpec,
};
use onescan_iec::syntax::walk::{self, Visitor};

/// The input of a function that has none.
const UNUSED: &str = "Unused_Input";

/// Writes functions and their calls as MatIEC takes them.
pub(super) fn lower(page: &Page<'_>, edits: &mut Edits) -> Vec<Finding> {
    let mut findings = Vec::new();
    for pou in page.pous() {
        if pou.kind == PouKind::Function {
            complete(pou, edits);
        }
        let mut reader =
            Reader { page, edits, is_function: pou.kind == PouKind::Function, types: BTreeSet::new(), findings };
        walk::with_members(pou, &mut reader);
        let declared: String =
            reader.types.iter().map(|ty| format!("\nVAR {} : {ty}; END_VAR\n", unread(ty))).collect();
        findings = reader.findings;
        if !declared.is_empty() {
            let head = pou.result.as_ref().map_or(pou.name.span.end, |result| result.span.end);
            edits.insert(pou.sections.last().map_or(head, |section| section.span.end), declared);
        }
    }
    findings
}

/// The variable that takes values of a type which nobody reads.
fn unread(ty: &str) -> String {
    let letters = ty.chars().map(|one| if one.is_ascii_alphanumeric() { one } else { '_' });
    format!("Unread_{}", letters.collect::<String>().trim_matches('_'))
}

/// A value and an input for a function that has none.
fn complete(pou: &Pou, edits: &mut Edits) {
    let result = if pou.result.is_none() { " : BOOL" } else { "" };
    let input = if has_no_parameters(pou) { format!("\nVAR_INPUT {UNUSED} : BOOL; END_VAR") } else { String::new() };
    let head = format!("{result}{input}");
    if !head.is_empty() {
        edits.insert(pou.result.as_ref().map_or(pou.name.span.end, |result| result.span.end), head);
    }
}

fn has_no_parameters(pou: &Pou) -> bool {
    let is_parameter = |kind| matches!(kind, SectionKind::Input | SectionKind::InOut | SectionKind::Output);
    let mut sections = pou.sections.iter().filter(|section| is_parameter(section.kind));
    sections.all(|section| section.variables.is_empty())
}

/// What a call hands over: to which kind of parameter, and the argument.
pub(super) fn handed_over<'c>(page: &Page<'_>, call: &'c Call) -> Vec<(SectionKind, &'c Expr)> {
    let ExprKind::Name(callee) = &call.callee.kind else { return Vec::new() };
    let Some(pou) = page.names.units.get(&callee.key()) else { return Vec::new() };
    let parameters: Vec<(SectionKind, &Ident)> = pou
        .sections
        .iter()
        .filter(|section| matches!(section.kind, SectionKind::Input | SectionKind::InOut | SectionKind::Output))
        .flat_map(|section| section.variables.iter().flat_map(|each| &each.names).map(|name| (section.kind, name)))
        .collect();
    let handed = |(at, argument): (usize, &'c Argument)| match argument {
        Argument::Positional(value) => parameters.get(at).map(|(kind, _)| (*kind, value)),
        Argument::Input(name, value) => {
            let parameter = parameters.iter().find(|(_, parameter)| parameter.key() == name.key());
            parameter.map(|(kind, _)| (*kind, value))
        }
        Argument::Output { target, .. } => target.as_ref().map(|target| (SectionKind::Output, target)),
    };
    call.arguments.iter().enumerate().filter_map(handed).collect()
}

struct Reader<'w, 'a> {
    page: &'w Page<'a>,
    edits: &'w mut Edits,
    is_function: bool,
    /// Types of values that nobody reads.
    types: BTreeSet<String>,
    findings: Vec<Finding>,
}

impl<'a> Reader<'_, 'a> {
    fn function(&self, call: &Call) -> Option<&'a Pou> {
        let ExprKind::Name(callee) = &call.callee.kind else { return None };
        let pou = self.page.names.units.get(&callee.key()).copied();
        pou.filter(|pou| pou.kind == PouKind::Function)
    }

    /// The type of a result, which may be a function of the library.
    fn text(&self, result: &TypeSpec) -> &'a str {
        let file = self.page.names.sources.get(result.span.file);
        let text = file.and_then(|file| file.text().get(result.span.start as usize..result.span.end as usize));
        text.unwrap_or("BOOL")
    }

    /// Places that MatIEC writes wrong C for.
    fn refuse(&mut self, call: &Call) {
        for (kind, place) in handed_over(self.page, call) {
            if kind == SectionKind::InOut && is_chosen(place, self.is_function) {
                let what = "an element of an array as VAR_IN_OUT of a function";
                let help = "copy it to a variable, hand that over, and copy it back";
                self.findings.push(Finding::new(place.span, what, help));
            }
            let inner = inner_call(place).filter(|_| kind == SectionKind::Input && !self.is_function);
            let writes =
                |inner: &Call| handed_over(self.page, inner).iter().any(|(kind, _)| *kind != SectionKind::Input);
            if inner.as_ref().is_some_and(writes) && self.function(call).is_some() {
                let what = "a call with VAR_IN_OUT or VAR_OUTPUT inside of another";
                self.findings.push(Finding::new(place.span, what, "give its value to a variable first"));
            }
        }
    }

    fn empty(&mut self, call: &Call, pou: &Pou) {
        if !has_no_parameters(pou) {
            let help = "give its first input a value";
            self.findings.push(Finding::new(call.callee.span, "a call of a function without arguments", help));
            return;
        }
        let from = call.callee.span.end;
        let rest = self.page.file.text().get(from as usize..).unwrap_or("");
        if let Some(bracket) = rest.find('(') {
            self.edits.insert(from + bracket as u32 + 1, format!("{UNUSED} := FALSE"));
        }
    }
}

impl Visitor for Reader<'_, '_> {
    fn statement(&mut self, statement: &Statement) {
        let StatementKind::Call(call) = &statement.kind else { return };
        if let Some(pou) = self.function(call) {
            let ty = pou.result.as_ref().map_or("BOOL", |result| self.text(result));
            self.edits.insert(statement.span.start, format!("{} := ", unread(ty)));
            self.types.insert(ty.to_owned());
        }
    }

    fn call(&mut self, call: &Call) {
        if let Some(pou) = self.function(call) {
            self.refuse(call);
            if call.arguments.is_empty() {
                self.empty(call, pou);
            }
        }
    }
}

/// True for a place with an index; in a function only for one that is chosen while it runs.
fn is_chosen(place: &Expr, in_function: bool) -> bool {
    match &place.kind {
        ExprKind::Index(base, list) => {
            let is_number = |index: &Expr| matches!(index.kind, ExprKind::Literal(Literal::Integer(_)));
            !in_function || !list.iter().all(is_number) || is_chosen(base, in_function)
        }
        ExprKind::Member(inner, _) | ExprKind::Part(inner, _) | ExprKind::Paren(inner) => is_chosen(inner, in_function),
        _ => false,
    }
}

/// A call anywhere in a value.
fn inner_call(value: &Expr) -> Option<Call> {
    struct Inner(Option<Call>);
    impl Visitor for Inner {
        fn call(&mut self, call: &Call) {
            self.0.get_or_insert_with(|| call.clone());
        }
    }
    let mut inner = Inner(None);
    walk::expression(value, &mut inner);
    inner.0
}
