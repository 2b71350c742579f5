//! Where instances go that are not copied: what takes several kinds of blocks, a block or 0, or the block that holds it,
//! is an interface.

use std::collections::BTreeSet;

use super::collect::Collector;
use super::shape::Shape;
use super::ty::{Slot, Ty};
use super::world::INIT;
use onescan_iec::syntax::ast::ReferenceKind;

impl Collector<'_> {
    /// Decides slots that instances go to, each for good; true if there was one.
    pub(super) fn settle_instances(&mut self) -> bool {
        let found: Vec<(Slot, String, BTreeSet<String>, bool)> = self
            .slots
            .unsettled()
            .filter(|(.., to)| !to.iter().any(|ty| matches!(ty, Ty::Declared(_) | Ty::Foreign(_) | Ty::Pointer(..))))
            .filter_map(|(slot, path, from, _)| {
                let instances: BTreeSet<String> = from.iter().filter_map(|ty| self.instance(ty)).collect();
                let is_null = from.contains(&Ty::Integer);
                let is_kept = path.contains(INIT) || !path.contains("()");
                let is_other = from.iter().any(|ty| matches!(ty, Ty::Pointer(..) | Ty::Text(_) | Ty::Elementary(_)));
                let is_held = is_kept && from.iter().any(|ty| self.is_certain(ty));
                let is_interface = instances.len() > 1 || !instances.is_empty() && (is_null || is_held);
                let is_plain = path.starts_with("global:") || path.starts_with("type:");
                (is_interface && !is_other && !is_plain).then(|| (slot, path.to_owned(), instances, is_null))
            })
            .collect();
        for (slot, path, instances, is_null) in &found {
            let ty = if let Some(block) = self.only_own(instances).filter(|_| !is_null) {
                Ty::Pointer(ReferenceKind::Reference, Box::new(Ty::Declared(block)))
            } else {
                let interface = self.common_interface(instances).unwrap_or_else(|| self.new_interface(path));
                self.ty_of(&interface)
            };
            self.slots.settle(*slot, ty);
        }
        !found.is_empty()
    }

    /// The one block, if it is the project's own and stands for no interface of a library.
    fn only_own(&mut self, instances: &BTreeSet<String>) -> Option<String> {
        let mut all = instances.iter();
        let only = all.next().filter(|_| all.next().is_none())?;
        let is_own = self.world.units.contains_key(only) && self.foreign_base(only).is_none();
        is_own.then(|| only.clone())
    }

    /// The key of a block that a type is.
    fn instance(&self, ty: &Ty) -> Option<String> {
        match ty {
            Ty::Declared(key) => {
                let unit = self.world.units.get(key)?;
                (unit.pou.kind.has_instances() && !unit.pou.object.extends.is_empty()).then(|| key.clone())
            }
            Ty::Foreign(key) => {
                let found = self.needs.types.get(key)?;
                (self.shape(found) == Shape::Block).then(|| key.clone())
            }
            _ => None,
        }
    }

    /// True for a block by more than its name.
    fn is_certain(&self, ty: &Ty) -> bool {
        match ty {
            Ty::Declared(_) => self.instance(ty).is_some(),
            Ty::Foreign(key) => {
                let found = self.needs.types.get(key);
                found.is_some_and(|found| found.base_of_block || found.called || found.init.is_some() || found.is_held)
            }
            _ => false,
        }
    }

    /// An interface that all of them are known to stand for.
    fn common_interface(&mut self, instances: &BTreeSet<String>) -> Option<String> {
        let mut common: Option<BTreeSet<String>> = None;
        for key in instances {
            let base = if self.world.units.contains_key(key) { self.foreign_base(key) } else { Some(key.clone()) };
            let known = base.and_then(|base| self.needs.types.get(&base)).map(|found| found.stands_for.clone());
            let known = known.unwrap_or_default();
            common = Some(match common {
                Some(found) => found.intersection(&known).cloned().collect(),
                None => known,
            });
        }
        common?.into_iter().next()
    }

    /// What is asked for an interface is one itself.
    pub(super) fn asked(&mut self, ty: &Ty) {
        if let Ty::Slot(slot) = ty
            && self.slots.decided(*slot).is_none()
        {
            let path = self.slots.path(*slot);
            let interface = self.new_interface(&path);
            self.slots.settle(*slot, Ty::Foreign(interface));
        }
    }

    fn new_interface(&mut self, path: &str) -> String {
        let name = super::anonymous_name(path);
        let name = format!("I_{}", name.trim_start_matches("T_"));
        let key = name.to_ascii_uppercase();
        let found = self.foreign(&key);
        found.name = name;
        found.is_anonymous = true;
        found.is_value = true;
        found.implemented = true;
        key
    }
}
