//! What classes of the project show of bases and interfaces that nobody declares: the members that they override, and
//! the interfaces that they are given for.

use super::class::Found;
use super::collect::Collector;
use super::ty::Ty;
use super::world::{Home, INIT, INIT_INPUTS, Part, Unit};
use onescan_iec::syntax::ast::{Ident, Modifier, Pou, PouKind, SectionKind, TypeSpec};

impl<'a> Collector<'a> {
    /// The types of an override's parameters and result are those of what it overrides.
    pub(super) fn overrides(&mut self, key: &str, unit: &'a Unit<'a>) {
        let foreign_base = self.foreign_base(key);
        let mut above: Vec<String> = foreign_base.iter().cloned().collect();
        for (name, home) in self.interfaces_of(unit) {
            match self.named(&name, &home, 0) {
                Ty::Foreign(interface) => above.push(interface),
                Ty::Declared(interface) => above.extend(self.foreign_base(&interface)),
                _ => {}
            }
        }
        above.sort();
        above.dedup();
        for base in above {
            for ((part, name), member) in &unit.members {
                if name.eq_ignore_ascii_case(INIT) {
                    self.override_of(&format!("{base}.{INIT}"), member, unit, INIT_INPUTS.len());
                    continue;
                }
                let shown = self.foreign(&base).name.clone();
                let path = format!("{shown}.{name}");
                // What is overridden is a base's; an interface's is implemented.
                let overrides = *part == Part::Method && member.object.modifiers.contains(&Modifier::Override);
                if overrides && foreign_base.as_ref() == Some(&base) && !self.has_method(&base, name) {
                    self.foreign(&base).member(&member.name.text);
                }
                match part {
                    Part::Method => self.override_of(&format!("{path}()"), member, unit, 0),
                    Part::Property => self.record(&path, member.result.as_ref(), unit),
                }
            }
        }
    }

    /// True for a stub of an earlier pass that has the method.
    fn has_method(&self, class: &str, name: &str) -> bool {
        let stub = self.world.units.get(class);
        stub.is_some_and(|stub| stub.members.contains_key(&(Part::Method, name.to_ascii_uppercase())))
    }

    /// What a unit and the bases that are declared implement, with from where each name is seen.
    fn interfaces_of(&mut self, unit: &'a Unit<'a>) -> Vec<(Ident, Home)> {
        let mut found = Vec::new();
        let mut seen = std::collections::BTreeSet::new();
        let mut open = vec![unit];
        while let Some(next) = open.pop() {
            found.extend(next.pou.object.implements.iter().map(|name| (name.clone(), next.home.clone())));
            for base in &next.pou.object.extends {
                let Ty::Declared(base) = self.named(base, &next.home, 0) else { continue };
                open.extend(self.world.units.get(&base).filter(|_| seen.insert(base.clone())));
            }
        }
        found
    }

    fn override_of(&mut self, path: &str, member: &Pou, unit: &Unit<'_>, skipped: usize) {
        for (index, (name, spec)) in inputs(member).into_iter().skip(skipped).enumerate() {
            self.record(&format!("{path}.p{}", index + 1), Some(spec), unit);
            self.record(&format!("{path}.{name}"), Some(spec), unit);
        }
        self.record(path, member.result.as_ref(), unit);
    }

    fn record(&mut self, path: &str, spec: Option<&TypeSpec>, unit: &Unit<'_>) {
        let Some(spec) = spec else { return };
        let ty = self.type_of(spec, &unit.home, 0);
        let slot = self.slots.of(path);
        self.slots.taken(slot, &ty);
    }

    /// What a class is given for it must implement: where it does not, its base does that nobody declares.
    pub(super) fn stands_for(&mut self, from: &Ty, to: &Ty) {
        let interface = match to {
            Ty::Foreign(key) => key.clone(),
            Ty::Declared(key) if self.kind_of(key) == Some(PouKind::Interface) => key.clone(),
            _ => return,
        };
        let base = match from {
            Ty::Foreign(key) => Some(key.clone()),
            Ty::Declared(key) if self.kind_of(key).is_some_and(PouKind::has_instances) => {
                if self.is_a(key, &interface) { None } else { self.foreign_base(key) }
            }
            _ => None,
        };
        if let Some(base) = base.filter(|base| *base != interface) {
            self.foreign(&base).stands_for.insert(interface);
        }
    }

    fn kind_of(&self, key: &str) -> Option<PouKind> {
        self.world.units.get(key).map(|unit| unit.pou.kind)
    }

    /// A type by its key.
    pub(super) fn ty_of(&self, key: &str) -> Ty {
        let is_declared = self.world.units.contains_key(key) || self.world.types.contains_key(key);
        if is_declared { Ty::Declared(key.to_owned()) } else { Ty::Foreign(key.to_owned()) }
    }

    /// True if what is declared shows that a class implements an interface.
    fn is_a(&mut self, class: &str, interface: &str) -> bool {
        let mut open = vec![class.to_owned()];
        let mut seen = std::collections::BTreeSet::new();
        while let Some(next) = open.pop() {
            let Some(unit) = self.world.units.get(&next) else { continue };
            for above in unit.pou.object.extends.iter().chain(&unit.pou.object.implements) {
                let (Ty::Declared(found) | Ty::Foreign(found)) = self.named(above, &unit.home, 0) else { continue };
                if found == interface {
                    return true;
                }
                if seen.insert(found.clone()) {
                    open.push(found);
                }
            }
        }
        false
    }

    /// The types that `FB_init` of a class wants, if the project declares it.
    pub(super) fn declared_init(&mut self, class: &str) -> Option<Vec<(String, Ty)>> {
        let Some(Found::Method(method, home)) = self.find(class, INIT) else { return None };
        let wanted = inputs(method).into_iter().skip(INIT_INPUTS.len());
        Some(wanted.map(|(name, spec)| (name, self.type_of(spec, &home, 0))).collect())
    }
}

/// Inputs in their order, by their names.
pub(super) fn inputs(pou: &Pou) -> Vec<(String, &TypeSpec)> {
    let accepts = |kind| matches!(kind, SectionKind::Input | SectionKind::InOut);
    let inputs = pou.sections.iter().filter(|section| accepts(section.kind)).flat_map(|section| &section.variables);
    inputs.flat_map(|each| each.names.iter().map(move |name| (name.key(), &each.spec))).collect()
}
