//! Which bytes survive a warm start (2nd ed. 2.4.2, 2.4.3).

use std::collections::BTreeMap;
use std::ops::Range;

use crate::check::Checked;
use crate::ir::{Storage, Type, TypeId, Variable};

/// Ranges of memory in ascending order, neighbours joined.
pub(super) fn ranges(checked: &Checked) -> Vec<Range<u32>> {
    let mut collector = Collector { checked, found: Vec::new(), known: BTreeMap::new() };
    collector.variables(&checked.globals, 0);
    for program in &checked.programs {
        if let Some(variables) = checked.interfaces.get(&program.pou) {
            collector.variables(variables, program.offset);
        }
    }
    let mut found = collector.found;
    found.sort_by_key(|range| (range.start, range.end));
    let mut joined: Vec<Range<u32>> = Vec::new();
    for range in found {
        match joined.last_mut() {
            Some(last) if range.start <= last.end => last.end = last.end.max(range.end),
            _ => joined.push(range),
        }
    }
    joined
}

struct Collector<'c> {
    checked: &'c Checked,
    found: Vec<Range<u32>>,
    /// Which types hold something retained, as far as known.
    known: BTreeMap<TypeId, bool>,
}

impl Collector<'_> {
    fn variables(&mut self, variables: &[Variable], base: u32) {
        for variable in variables {
            let offset = match variable.storage {
                Storage::Instance(offset) => base + offset,
                Storage::Absolute(offset) if base == 0 => offset,
                Storage::Located(location) => self.checked.areas.offset(location),
                _ => continue,
            };
            if variable.retain {
                self.found.push(offset..offset + self.checked.types.size(variable.ty));
            } else if self.has_retained(variable.ty) {
                self.inside(variable.ty, offset);
            }
        }
    }

    /// Instances keep what their own type declares RETAIN.
    fn inside(&mut self, ty: TypeId, offset: u32) {
        match self.checked.types.get(ty) {
            Type::FunctionBlock { pou, .. } => {
                if let Some(variables) = self.checked.interfaces.get(pou) {
                    self.variables(variables, offset);
                }
            }
            Type::Array { element, .. } => {
                let stride = self.checked.types.size(*element).max(1);
                let count = self.checked.types.size(ty) / stride;
                for index in 0..count {
                    self.inside(*element, offset + index * stride);
                }
            }
            Type::Struct { fields, .. } => {
                for field in fields {
                    self.inside(field.ty, offset + field.offset);
                }
            }
            Type::Elementary(_)
            | Type::Interface { .. }
            | Type::Enumeration { .. }
            | Type::Subrange { .. }
            | Type::Text(_)
            | Type::Nothing => {}
        }
    }

    fn has_retained(&mut self, ty: TypeId) -> bool {
        if let Some(known) = self.known.get(&ty) {
            return *known;
        }
        let found = self.find_retained(ty);
        self.known.insert(ty, found);
        found
    }

    fn find_retained(&mut self, ty: TypeId) -> bool {
        match self.checked.types.get(ty) {
            Type::FunctionBlock { pou, .. } => {
                let variables = self.checked.interfaces.get(pou).map_or(&[][..], Vec::as_slice);
                variables.iter().any(|variable| {
                    let held = matches!(variable.storage, Storage::Instance(_));
                    variable.retain || held && self.has_retained(variable.ty)
                })
            }
            Type::Array { element, .. } => self.has_retained(*element),
            Type::Struct { fields, .. } => fields.iter().any(|field| self.has_retained(field.ty)),
            Type::Elementary(_)
            | Type::Interface { .. }
            | Type::Enumeration { .. }
            | Type::Subrange { .. }
            | Type::Text(_)
            | Type::Nothing => false,
        }
    }
}
