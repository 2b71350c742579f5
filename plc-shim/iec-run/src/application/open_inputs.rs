//! The inputs that nothing in the application gives a value: somebody outside has to, or they stay as they are.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use onescan_iec::check::Checked;
use onescan_iec::ir::{
    ElementaryType, Location, Part, Place, PlaceUse, Pou, Statement, Step, Storage, Variable as Declared, place_uses,
};
use onescan_iec::syntax::Span;
use onescan_iec::syntax::ast::SectionKind;
use onescan_iec::syntax::direct_address::Area;

use super::inner_inputs::{InnerInputs, is_at_input};
use super::memory_set::MemorySet;
use super::variable::{Spot, spot};
use super::{Application, Variable};

/// An input of a program, or what it reads of the input area.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct OpenInput {
    /// The whole variable.
    pub variable: Variable,
    /// Where it is declared; where a direct address is read that no variable is located at.
    pub span: Span,
    /// Its elementary parts and strings that nothing in the application writes, in the order of memory; itself if it
    /// has no parts.
    pub parts: Vec<Variable>,
    /// How many such parts the variable has, written or not.
    pub part_count: usize,
    /// Where its own program assigns to it, although it is an input.
    pub assigned: Option<Span>,
}

/// Bytes of memory, or one bit of a byte.
type Bits = (Range<u32>, Option<u8>);

impl MemorySet {
    /// True if one of its places has bits in common with a variable.
    pub fn meets_variable(&self, variable: &Variable) -> bool {
        let (bytes, bit) = bits(variable);
        self.meets(bytes, bit)
    }

    /// Adds all of a variable.
    pub fn insert_variable(&mut self, variable: &Variable) {
        let (bytes, bit) = bits(variable);
        self.insert(bytes, bit);
    }
}

impl Application {
    /// Every `VAR_INPUT` of a program that no connection, call or assignment of the application gives a value, then
    /// every located variable or direct address of the input area that it reads and does not write.
    pub fn open_inputs(&self) -> Vec<OpenInput> {
        let checked = &self.inner.checked;
        let uses = Uses::of(checked);
        let mut open = Vec::new();
        for (program, name) in checked.programs.iter().zip(self.entry_names()) {
            let variables = checked.interfaces.get(&program.pou).map_or(&[][..], Vec::as_slice);
            let inputs = variables.iter().filter(|variable| variable.section == SectionKind::Input);
            let assigned = checked.pous.get(&program.pou).map(|unit| assigned(checked, unit)).unwrap_or_default();
            for variable in inputs.filter(|variable| !matches!(variable.storage, Storage::Located(_))) {
                let found = spot(checked, name, variable, program.offset);
                let found = found.and_then(|spot| self.open_input(spot, variable.span, &uses));
                let assigned = assigned.get(&variable.storage).copied();
                open.extend(found.map(|found| OpenInput { assigned, ..found }));
            }
        }
        self.add_located(&uses, &mut open);
        open
    }

    /// What is read of the input area: by the names of the variables located there, else by the address.
    fn add_located(&self, uses: &Uses, open: &mut Vec<OpenInput>) {
        let checked = &self.inner.checked;
        let mut named = Named::default();
        for (home, base, variable) in self.all_variables().filter(|(.., variable)| is_at_input(variable)) {
            let Some(found) = spot(checked, home, variable, base) else { continue };
            let taken = bits(&self.describe(found.clone()));
            // Who reads what lies in an instance, as behind `AT %I*`, is not looked at.
            let is_read = !matches!(variable.storage, Storage::Located(_)) || uses.is_read(&taken);
            named.add(taken);
            let is_own = match variable.section {
                SectionKind::External => false,
                // One of a program's inputs is open as such.
                SectionKind::Input => matches!(variable.storage, Storage::Located(_)),
                _ => true,
            };
            if is_read && is_own {
                open.extend(self.open_input(found, variable.span, uses));
            }
        }
        self.add_inner(uses, &mut named, open);
        let mut seen = BTreeSet::new();
        for (read, span) in &uses.read_inputs {
            if !seen.insert(exactly(read)) || named.bits.meets(read.0.clone(), read.1) {
                continue;
            }
            let path = self.sources().text(*span);
            open.extend(self.direct(path).and_then(|spot| self.open_input(spot, *span, uses)));
        }
    }

    /// The same of what lies inside of instances and structures; at one address once, however many instances name it.
    fn add_inner(&self, uses: &Uses, named: &mut Named, open: &mut Vec<OpenInput>) {
        let mut inner = InnerInputs::of(self);
        for (home, base, variable) in self.all_variables().filter(|(.., variable)| is_whole(variable)) {
            if let Some(whole) = spot(&self.inner.checked, home, variable, base) {
                inner.add(&whole, variable.span);
            }
        }
        for (found, declared) in inner.found {
            let taken = bits(&self.describe(found.clone()));
            let is_at_address = found.address.as_deref().is_some_and(|address| !address.contains('*'));
            let is_read = uses.is_read(&taken);
            if !named.add(taken) {
                continue;
            }
            if is_read || !is_at_address {
                open.extend(self.open_input(found, declared, uses));
            }
        }
    }

    /// The global variables and those of programs, each with its home and where that begins.
    fn all_variables(&self) -> impl Iterator<Item = (&str, u32, &Declared)> {
        let checked = &self.inner.checked;
        let programs = checked.programs.iter().zip(self.entry_names()).flat_map(|(program, name)| {
            let variables = checked.interfaces.get(&program.pou).map_or(&[][..], Vec::as_slice);
            variables.iter().map(move |variable| (name, program.offset, variable))
        });
        self.globals().map(|(home, global)| (home, 0, global)).chain(programs)
    }

    fn open_input(&self, spot: Spot, span: Span, uses: &Uses) -> Option<OpenInput> {
        let variable = self.describe(spot.clone());
        let mut parts: Vec<Variable> = self.leaves_of(spot).collect();
        let part_count = parts.len();
        parts.retain(|leaf| !uses.written.meets_variable(leaf));
        (!parts.is_empty()).then_some(OpenInput { variable, span, parts, part_count, assigned: None })
    }
}

/// Where a unit first assigns to what begins in its memory.
fn assigned(checked: &Checked, unit: &Pou) -> BTreeMap<Storage, Span> {
    let mut first = BTreeMap::new();
    place_uses(&unit.body, &checked.types, &mut |place, how| {
        if how == PlaceUse::Write {
            first.entry(place.storage).or_insert(place.span);
        }
    });
    first
}

/// True for a variable of its own that is not an input as a whole.
fn is_whole(variable: &Declared) -> bool {
    let is_own = !matches!(variable.section, SectionKind::External | SectionKind::Input | SectionKind::InOut);
    is_own && !is_at_input(variable)
}

fn bits(variable: &Variable) -> Bits {
    (variable.offset..variable.offset + variable.size, variable.bit)
}

fn exactly((bytes, bit): &Bits) -> (u32, u32, Option<u8>) {
    (bytes.start, bytes.end, *bit)
}

/// Places of the input area that variables name.
#[derive(Default)]
struct Named {
    bits: MemorySet,
    exactly: BTreeSet<(u32, u32, Option<u8>)>,
}

impl Named {
    /// False if the same place has a name already.
    fn add(&mut self, taken: Bits) -> bool {
        let is_new = self.exactly.insert(exactly(&taken));
        self.bits.insert(taken.0, taken.1);
        is_new
    }
}

/// What the application does with memory that those outside may write as well.
#[derive(Default)]
struct Uses {
    written: MemorySet,
    /// What is read of the input area, with the place where it is.
    read_inputs: Vec<(Bits, Span)>,
    read: MemorySet,
}

impl Uses {
    fn of(checked: &Checked) -> Self {
        let mut uses = Self::default();
        let bodies = checked.pous.values().chain(checked.entries.iter().flat_map(|entry| &entry.units));
        for unit in bodies.chain(&checked.start) {
            uses.note(checked, &unit.body);
        }
        uses
    }

    fn is_read(&self, (bytes, bit): &Bits) -> bool {
        self.read.meets(bytes.clone(), *bit)
    }

    fn note(&mut self, checked: &Checked, statements: &[Statement]) {
        place_uses(statements, &checked.types, &mut |place, how| {
            let Some(bits) = bits_of(checked, place) else { return };
            let is_input = matches!(place.storage, Storage::Located(Location { area: Area::Input, .. }));
            if is_input && how != PlaceUse::Write {
                self.read.insert(bits.0.clone(), bits.1);
                self.read_inputs.push((bits.clone(), place.span));
            }
            if how != PlaceUse::Read {
                self.written.insert(bits.0, bits.1);
            }
        });
    }
}

/// The memory of a place at a fixed address; of an element by an index, the whole array.
fn bits_of(checked: &Checked, place: &Place) -> Option<Bits> {
    let (start, bit) = match place.storage {
        Storage::Absolute(offset) => (offset, None),
        Storage::Located(location) => (checked.areas.offset(location), location.bit),
        // Parts of an instance that is running; a program's own inputs are not driven by what it does itself.
        Storage::AbsolutePointer(_)
        | Storage::Instance(_)
        | Storage::InstancePointer(_)
        | Storage::Register(_)
        | Storage::RegisterPointer(_)
        | Storage::Referred => return None,
    };
    let mut at = start;
    for step in &place.steps {
        match step {
            Step::Offset(further) => at += further,
            Step::Index { count, stride, .. } => {
                return Some((at..at.saturating_add(count.saturating_mul(*stride)), None));
            }
            // It leads elsewhere.
            Step::Pointer { .. } | Step::Open { .. } => return None,
        }
    }
    let (size, part) = match place.part {
        Some(Part { whole: ElementaryType::Byte, shift }) if is_bit(checked, place) => (1, u8::try_from(shift).ok()),
        Some(Part { whole, .. }) => (whole.size(), None),
        None => (checked.types.size(place.ty), None),
    };
    Some((at..at + size, bit.or(part)))
}

fn is_bit(checked: &Checked, place: &Place) -> bool {
    checked.types.elementary(place.ty) == Some(ElementaryType::Bool)
}
