//! Which bytes survive a start (2nd ed. 2.4.2, 2.4.3; 3rd ed. 6.5.6).
//!
//! What a section says of an instance goes for the instance's own variables, unless their sections
//! say otherwise; instances among those follow their own type (3rd ed. 6.5.6.2).

use std::collections::BTreeMap;
use std::ops::Range;

use onescan_iec::check::Checked;
use onescan_iec::ir::{Retention, Storage, Type, TypeId, Variable};

/// Ranges of memory in ascending order, neighbours joined, of what lives as long as `least`.
pub(super) fn ranges(checked: &Checked, least: Retention) -> Vec<Range<u32>> {
    let mut collector = Collector { checked, least, found: Vec::new(), known: BTreeMap::new() };
    let resources = checked.configuration.iter().flat_map(|configuration| &configuration.resources);
    collector.variables(&checked.globals, 0, None);
    for resource in resources {
        collector.variables(&resource.globals, 0, None);
    }
    for program in &checked.programs {
        if let Some(variables) = checked.interfaces.get(&program.pou) {
            collector.variables(variables, program.offset, program.retention);
        }
    }
    joined(collector.found)
}

fn joined(mut found: Vec<Range<u32>>) -> Vec<Range<u32>> {
    found.sort_by_key(|range| (range.start, range.end));
    let mut joined: Vec<Range<u32>> = Vec::new();
    for range in found {
        match joined.last_mut() {
            Some(last) if range.start <= last.end => last.end = last.end.max(range.end),
            _ => joined.push(range),
        }
    }
    debug_assert!(joined.windows(2).all(|pair| pair[0].end < pair[1].start), "ranges ascend with gaps between them");
    joined
}

struct Collector<'c> {
    checked: &'c Checked,
    least: Retention,
    found: Vec<Range<u32>>,
    /// Which types hold something that is kept of its own, as far as known.
    known: BTreeMap<TypeId, bool>,
}

impl Collector<'_> {
    /// Variables of an instance at `base` whose own declaration says `outer`.
    fn variables(&mut self, variables: &[Variable], base: u32, outer: Option<Retention>) {
        for variable in variables {
            let offset = match variable.storage {
                Storage::Instance(offset) => base + offset,
                Storage::Absolute(offset) if base == 0 => offset,
                Storage::Located(location) => self.checked.areas.offset(location),
                _ => continue,
            };
            if variable.of_chart {
                // A chart is kept as a whole: steps without their stored actions would be none.
                if outer.is_some_and(|outer| outer >= self.least) {
                    self.found.push(offset..offset + self.checked.types.size(variable.ty));
                }
                continue;
            }
            self.variable(variable.ty, offset, variable.retention, variable.retention.or(outer));
        }
    }

    /// `said` is what its own section says, `retention` what that comes to for plain data.
    fn variable(&mut self, ty: TypeId, offset: u32, said: Option<Retention>, retention: Option<Retention>) {
        let kept = retention.is_some_and(|retention| retention >= self.least);
        match self.checked.types.get(ty) {
            Type::FunctionBlock { pou, .. } => {
                let kept = said.is_some_and(|said| said >= self.least);
                if let Some(variables) = self.checked.interfaces.get(pou)
                    && (kept || self.holds_kept(ty))
                {
                    self.variables(variables, offset, said);
                }
            }
            Type::Array { element, .. } if self.holds_instances(*element) => {
                let stride = self.checked.types.size(*element).max(1);
                let count = self.checked.types.size(ty) / stride;
                if kept || self.holds_kept(*element) {
                    (0..count).for_each(|index| self.variable(*element, offset + index * stride, said, retention));
                }
            }
            Type::Struct { fields, .. } if self.holds_instances(ty) => {
                for field in fields {
                    self.variable(field.ty, offset + field.offset, said, retention);
                }
            }
            _ if kept => self.found.push(offset..offset + self.checked.types.size(ty)),
            _ => {}
        }
    }

    fn holds_instances(&self, ty: TypeId) -> bool {
        match self.checked.types.get(ty) {
            Type::FunctionBlock { .. } => true,
            Type::Array { element, .. } => self.holds_instances(*element),
            Type::Struct { fields, .. } => fields.iter().any(|field| self.holds_instances(field.ty)),
            _ => false,
        }
    }

    fn holds_kept(&mut self, ty: TypeId) -> bool {
        if let Some(known) = self.known.get(&ty) {
            return *known;
        }
        let found = self.find_kept(ty);
        self.known.insert(ty, found);
        found
    }

    fn find_kept(&mut self, ty: TypeId) -> bool {
        match self.checked.types.get(ty) {
            Type::FunctionBlock { pou, .. } => {
                let variables = self.checked.interfaces.get(pou).map_or(&[][..], Vec::as_slice);
                variables.iter().any(|variable| {
                    let held = matches!(variable.storage, Storage::Instance(_));
                    let kept = variable.retention.is_some_and(|retention| retention >= self.least);
                    held && (kept || self.holds_kept(variable.ty))
                })
            }
            Type::Array { element, .. } => self.holds_kept(*element),
            Type::Struct { fields, .. } => fields.iter().any(|field| self.holds_kept(field.ty)),
            _ => false,
        }
    }
}
