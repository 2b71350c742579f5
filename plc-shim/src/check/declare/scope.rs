//! What a name means inside a unit, and the unit's registers.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::check::body::call::enable;
use crate::ir::{ElementaryType, LocalId, Place, Variable};
use crate::syntax::ast::SectionKind;

/// The variables and registers of a unit.
#[derive(Debug, Clone, Default)]
pub(in crate::check) struct Scope {
    pub(in crate::check) variables: Vec<Variable>,
    pub(in crate::check) by_name: BTreeMap<String, usize>,
    pub(in crate::check) registers: Vec<ElementaryType>,
    pub(in crate::check) parameters: u32,
    pub(in crate::check) result: Option<Place>,
    /// The variables of the instance that a method works on.
    pub(in crate::check) outer: Option<Arc<Scope>>,
    /// True if the unit has fixed memory, which two activations would share.
    pub(in crate::check) has_memory: bool,
}

impl Scope {
    pub(in crate::check) fn find(&self, key: &str) -> Option<&Variable> {
        match self.by_name.get(key) {
            Some(index) => self.variables.get(*index),
            None => self.outer.as_ref()?.find(key),
        }
    }

    /// The unit's own variable, as a caller sees it.
    pub(in crate::check) fn own(&self, key: &str) -> Option<&Variable> {
        self.by_name.get(key).and_then(|index| self.variables.get(*index))
    }

    /// The names by which variables are found, by their positions; those of a base may have none.
    pub(in crate::check) fn keys(&self) -> BTreeMap<usize, &str> {
        self.by_name.iter().map(|(key, index)| (*index, key.as_str())).collect()
    }

    /// True for a name that a variable has, be its declaration right or wrong.
    pub(in crate::check) fn declares(&self, key: &str) -> bool {
        self.by_name.contains_key(key) || self.outer.as_ref().is_some_and(|outer| outer.declares(key))
    }

    /// True for a name whose declaration is wrong, which has been reported.
    pub(in crate::check) fn is_broken(&self, key: &str) -> bool {
        match self.by_name.get(key) {
            Some(index) => *index >= self.variables.len(),
            None => self.outer.as_ref().is_some_and(|outer| outer.is_broken(key)),
        }
    }

    /// True if any declaration is wrong.
    pub(in crate::check) fn has_broken(&self) -> bool {
        self.by_name.values().any(|index| *index >= self.variables.len())
    }

    /// What a caller can set: inputs and in-outs in their order.
    pub(in crate::check) fn inputs(&self) -> impl Iterator<Item = &Variable> {
        let accepts = |section| matches!(section, SectionKind::Input | SectionKind::InOut);
        self.variables.iter().filter(move |variable| accepts(variable.section))
    }

    /// What a caller can take: outputs in their order.
    pub(in crate::check) fn outputs(&self) -> impl Iterator<Item = &Variable> {
        self.variables.iter().filter(|variable| variable.section == SectionKind::Output)
    }

    /// What stands in a list without names, which EN never does.
    pub(in crate::check) fn positional(&self) -> impl Iterator<Item = &Variable> {
        self.inputs().filter(|variable| !enable::is_control(variable))
    }

    pub(in crate::check) fn register(&mut self, ty: ElementaryType) -> LocalId {
        self.registers.push(ty);
        LocalId(self.registers.len() as u32 - 1)
    }
}
