//! W0726: two variables lie at one output, and both are written; or two programs write one output in each call.

use std::collections::{BTreeMap, BTreeSet};

use super::Unit;
use super::bodies::{Bodies, Body};
use super::index::Index;
use crate::diagnostic::{Code, Diagnostic};
use crate::dialect::AddressUnit;
use crate::ir::{ElementaryType, Location, Place, Statement, StatementKind, Storage};
use crate::syntax::SourceMap;
use crate::syntax::Span;
use crate::syntax::ast::{Ident, PouKind, SectionKind, Variable};
use crate::syntax::direct_address::{Area, DirectAddress};

/// A variable at an output that somebody writes.
struct Written<'a> {
    name: &'a Ident,
    address: &'a str,
    at: At,
    place: Span,
}

/// What an address takes of the outputs.
#[derive(PartialEq, Eq)]
enum At {
    /// So many bits from this one on.
    Bits(u64, u64),
    /// An address whose parts only the machine knows, in capitals.
    Named(String),
}

impl At {
    /// `%Q*` is given its place later.
    fn of(address: &str, unit: AddressUnit) -> Option<Self> {
        let key = address.to_ascii_uppercase();
        if !key.starts_with("%Q") || key.contains('*') {
            return None;
        }
        // Without X a bit is meant, too.
        let has_no_width = key.as_bytes().get(2).is_some_and(u8::is_ascii_digit);
        let written = if has_no_width { key.replacen("%Q", "%QX", 1) } else { key.clone() };
        let Some((byte, bit, width)) = DirectAddress::parse(&written).ok().and_then(|parsed| {
            let (byte, bit) = parsed.place(unit).ok()??;
            Some((byte, bit, parsed.width))
        }) else {
            return Some(Self::Named(key));
        };
        Some(Self::Bits(u64::from(byte) * 8 + u64::from(bit.unwrap_or(0)), u64::from(width.bits().max(1))))
    }
}

/// Who takes which bit of the outputs first, by their numbers.
#[derive(Default)]
struct Taken {
    bits: BTreeMap<u64, usize>,
    named: BTreeMap<String, usize>,
}

impl Taken {
    /// Takes what an address takes, and gives the first who has some of it already.
    fn take(&mut self, at: &At, number: usize) -> Option<usize> {
        let before = match at {
            // The widest address has 64 bits.
            At::Bits(from, count) => {
                let taken = (*from..from.saturating_add(*count)).map(|bit| *self.bits.entry(bit).or_insert(number));
                taken.min()
            }
            At::Named(name) => Some(*self.named.entry(name.clone()).or_insert(number)),
        };
        before.filter(|before| *before < number)
    }
}

pub(super) fn lint(units: &[Unit<'_>], index: &Index<'_>, sources: &SourceMap, findings: &mut Vec<Diagnostic>) {
    let mut written: Vec<Written<'_>> = Vec::new();
    for section in index.globals() {
        for (address, at, name) in located(&section.variables, sources) {
            let writer = units.iter().find_map(|unit| unit.usage.get(&name.key()).written);
            written.extend(writer.map(|place| Written { name, address, at, place }));
        }
    }
    for unit in units {
        for section in unit.pou.sections.iter().filter(|section| section.kind != SectionKind::External) {
            for (address, at, name) in located(&section.variables, sources) {
                let writer = unit.usage.get(&name.key()).written;
                written.extend(writer.map(|place| Written { name, address, at, place }));
            }
        }
    }
    let mut taken = Taken::default();
    for (number, other) in written.iter().enumerate() {
        let Some(first) = taken.take(&other.at, number).and_then(|before| written.get(before)) else { continue };
        let (one, two, address) = (&first.name.text, &other.name.text, other.address);
        let message = if first.at == other.at {
            format!("`{two}` lies at {address} as `{one}` does, and both are written: the last one wins")
        } else {
            let place = first.address;
            format!("`{two}` at {address} has bits of `{one}` at {place}, and both are written: the last one wins")
        };
        let found = Diagnostic::warning(Code::OutputWithTwoNames, other.name.span, message)
            .with_label(first.place, format!("`{one}` is written here"))
            .with_label(other.place, format!("`{two}` is written here"))
            .with_help("give one of them another address, or let one variable have the output");
        findings.push(found);
    }
}

/// The names at outputs, with the address of each and what it takes.
fn located<'a>(
    variables: &'a [Variable],
    sources: &'a SourceMap,
) -> impl Iterator<Item = (&'a str, At, &'a Ident)> + 'a {
    variables.iter().flat_map(move |variable| {
        let address = variable.address.as_ref().map(|address| address.text.as_str());
        let unit = |name: &Ident| Some(sources.get(name.span.file)?.dialect().address_unit());
        variable.names.iter().filter_map(move |name| Some((address?, At::of(address?, unit(name)?)?, name)))
    })
}

/// Outputs that one program writes in each call, and another one as well.
pub(super) fn lint_programs(bodies: &Bodies<'_>, findings: &mut Vec<Diagnostic>) {
    let mut writers: BTreeMap<Output, (&Place, Body<'_>)> = BTreeMap::new();
    // Two names of one output, and two tasks, have been reported.
    let mut known: BTreeSet<(Span, Span)> = BTreeSet::new();
    let is_of_two = |found: &&Diagnostic| matches!(found.code, Code::OutputWithTwoNames | Code::WrittenByTwoTasks);
    for found in findings.iter().filter(is_of_two) {
        let labels = || found.labels.iter().map(|label| label.span);
        known.extend(labels().flat_map(|one| labels().map(move |other| (one, other))));
    }
    for body in bodies.iter().filter(|body| body.pou.kind == PouKind::Program && body.pou.chart.is_empty()) {
        for (output, place) in body.checked.body.iter().filter_map(written_always) {
            let (first, other) = *writers.entry(output).or_insert((place, body));
            if other.pou.name.key() != body.pou.name.key() && !known.contains(&(first.span, place.span)) {
                report(bodies, (first, other), (place, body), findings);
            }
        }
    }
}

/// Offset and bit of a place in the output area, and the lowest bit and the type of what of it is meant.
type Output = (u32, Option<u8>, Option<(u32, ElementaryType)>);

/// A part of the output area that a statement writes, whatever else there is.
fn written_always(statement: &Statement) -> Option<(Output, &Place)> {
    let StatementKind::Assign(place, _) = &statement.kind else { return None };
    let Storage::Located(Location { area: Area::Output, offset, bit }) = place.storage else { return None };
    let part = place.part.map(|part| (part.shift, part.whole));
    place.steps.is_empty().then_some(((offset, bit, part), place))
}

fn report(
    bodies: &Bodies<'_>,
    (first, one): (&Place, Body<'_>),
    (again, other): (&Place, Body<'_>),
    findings: &mut Vec<Diagnostic>,
) {
    let (name, one, other) = (bodies.text(again.span), &one.pou.name.text, &other.pou.name.text);
    let message = format!("output `{name}` is written by each call of `{other}` and of `{one}`: the last one wins");
    let found = Diagnostic::warning(Code::OutputWithTwoNames, again.span, message)
        .with_label(first.span, format!("written here by `{one}`"))
        .with_help("let one of them write it, and the others ask that one by variables of their own");
    findings.push(found);
}
