//! The members of classes, structures and enumerations, those of their bases included.

use super::collect::Collector;
use super::ty::Ty;
use super::world::{Home, Part, VALUE, has_value};
use onescan_iec::syntax::ast::{Pou, PouKind, TypeSpecKind};

impl<'a> Collector<'a> {
    /// The members of a class by the unit that declares them, its bases last.
    pub(super) fn find(&mut self, class: &str, name: &str) -> Option<Found<'a>> {
        let key = name.to_ascii_uppercase();
        let mut open = std::collections::VecDeque::from([class.to_owned()]);
        let mut seen = std::collections::BTreeSet::new();
        let mut foreign = None;
        while let Some(next) = open.pop_front() {
            if !seen.insert(next.clone()) {
                continue;
            }
            if let Some(unit) = self.world.units.get(&next) {
                if let Some((spec, _)) = unit.variables.get(&key) {
                    return Some(Found::Variable(self.type_of(spec, &unit.home, 0)));
                }
                let variables = unit.pou.sections.iter().flat_map(|section| &section.variables);
                if variables.into_iter().any(|variable| has_value(&variable.spec, &key)) {
                    return Some(Found::Variable(VALUE));
                }
                if let Some(method) = unit.members.get(&(Part::Method, key.clone())) {
                    return Some(Found::Method(method, unit.home.clone()));
                }
                if let Some(property) = unit.members.get(&(Part::Property, key.clone())) {
                    let ty = property.result.as_ref().map_or(Ty::Unknown, |spec| self.type_of(spec, &unit.home, 0));
                    return Some(Found::Variable(ty));
                }
                if unit.pou.external && !unit.library && unit.pou.kind != PouKind::Function {
                    foreign = foreign.or_else(|| Some(next.clone()));
                    let (name, found) = (unit.pou.name.text.clone(), self.foreign(&next));
                    found.name = name;
                    found.extends_stub = true;
                }
                for base in &unit.pou.object.extends {
                    match self.named(base, &unit.home, 0) {
                        Ty::Declared(base) => open.push_back(base),
                        Ty::Foreign(key) => foreign = foreign.or(Some(key)),
                        _ => {}
                    }
                }
            } else if let Some(named) = self.world.types.get(&next) {
                if let TypeSpecKind::Struct(fields) | TypeSpecKind::Union(fields) | TypeSpecKind::Overlapping(fields) =
                    &named.ast.spec.kind
                    && let Some(field) = fields.iter().find(|field| field.name.key() == key)
                {
                    return Some(Found::Variable(self.type_of(&field.spec, &named.home, 0)));
                }
                if let TypeSpecKind::Enumeration(values, _) = &named.ast.spec.kind
                    && values.iter().any(|value| value.name.key() == key)
                {
                    return Some(Found::Variable(Ty::Declared(next)));
                }
                if named.ast.external {
                    foreign = foreign.or_else(|| Some(next.clone()));
                    let (name, found) = (named.ast.name.text.clone(), self.foreign(&next));
                    found.name = name;
                    found.extends_stub = true;
                }
                if let Some(base) = &named.ast.extends {
                    match self.named(base, &named.home, 0) {
                        Ty::Declared(base) => open.push_back(base),
                        Ty::Foreign(key) => foreign = foreign.or(Some(key)),
                        _ => {}
                    }
                }
            }
        }
        foreign.map(Found::Foreign)
    }

    /// The base of a class that nobody declares, if it has one.
    pub(super) fn foreign_base(&mut self, class: &str) -> Option<String> {
        // No unit has a member of this name.
        match self.find(class, "\u{0}") {
            Some(Found::Foreign(key)) => Some(key),
            _ => None,
        }
    }
}

/// What a name of a class means.
pub(super) enum Found<'a> {
    /// A variable or property.
    Variable(Ty),
    Method(&'a Pou, Home),
    /// A base that nobody declares may have it.
    Foreign(String),
}
