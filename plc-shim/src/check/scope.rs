//! What a name means inside a unit, and the unit's registers.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::Checker;
use crate::diagnostic::Diagnostic;
use crate::ir::{ElementaryType, LocalId, Place, PouId, Variable};
use crate::syntax::ast::SectionKind;

/// The variables and registers of a unit.
#[derive(Debug, Clone, Default)]
pub(super) struct Scope {
    pub(super) variables: Vec<Variable>,
    pub(super) by_name: BTreeMap<String, usize>,
    pub(super) registers: Vec<ElementaryType>,
    pub(super) parameters: u32,
    pub(super) result: Option<Place>,
    /// The variables of the instance that a method works on.
    pub(super) outer: Option<Arc<Scope>>,
    /// True if the unit has fixed memory, which two activations would share.
    pub(super) has_memory: bool,
}

impl Scope {
    pub(super) fn find(&self, key: &str) -> Option<&Variable> {
        match self.by_name.get(key) {
            Some(index) => self.variables.get(*index),
            None => self.outer.as_ref()?.find(key),
        }
    }

    /// The unit's own variable, as a caller sees it.
    pub(super) fn own(&self, key: &str) -> Option<&Variable> {
        self.by_name.get(key).and_then(|index| self.variables.get(*index))
    }

    /// The names by which variables are found, by their positions; those of a base may have none.
    pub(super) fn keys(&self) -> BTreeMap<usize, &str> {
        self.by_name.iter().map(|(key, index)| (*index, key.as_str())).collect()
    }

    /// True for a name that a variable has, be its declaration right or wrong.
    pub(super) fn declares(&self, key: &str) -> bool {
        self.by_name.contains_key(key) || self.outer.as_ref().is_some_and(|outer| outer.declares(key))
    }

    /// True for a name whose declaration is wrong, which has been reported.
    pub(super) fn is_broken(&self, key: &str) -> bool {
        match self.by_name.get(key) {
            Some(index) => *index >= self.variables.len(),
            None => self.outer.as_ref().is_some_and(|outer| outer.is_broken(key)),
        }
    }

    /// True if any declaration is wrong.
    pub(super) fn has_broken(&self) -> bool {
        self.by_name.values().any(|index| *index >= self.variables.len())
    }

    /// What a caller can set: inputs and in-outs in their order.
    pub(super) fn inputs(&self) -> impl Iterator<Item = &Variable> {
        let accepts = |section| matches!(section, SectionKind::Input | SectionKind::InOut);
        self.variables.iter().filter(move |variable| accepts(variable.section))
    }

    /// What a caller can take: outputs in their order.
    pub(super) fn outputs(&self) -> impl Iterator<Item = &Variable> {
        self.variables.iter().filter(|variable| variable.section == SectionKind::Output)
    }

    /// What stands in a list without names, which EN never does.
    pub(super) fn positional(&self) -> impl Iterator<Item = &Variable> {
        self.inputs().filter(|variable| !super::enable::is_control(variable))
    }

    pub(super) fn register(&mut self, ty: ElementaryType) -> LocalId {
        self.registers.push(ty);
        LocalId(self.registers.len() as u32 - 1)
    }
}

/// Checks expressions and statements inside a scope.
pub(super) struct Body<'c, 'a> {
    pub(super) checker: &'c mut Checker<'a>,
    pub(super) scope: Scope,
    /// The unit; nothing for declarations outside of any.
    pub(super) pou: Option<PouId>,
    /// The type that the place of the expression wants, for constants that no operand types.
    pub(super) context: Option<ElementaryType>,
    /// Loops around the statement.
    pub(super) loops: u32,
    pub(super) result_assigned: bool,
    /// Key of the transition whose network is being checked.
    pub(super) network: Option<String>,
    /// What jumps may lead to from here, the innermost last.
    pub(super) labels: Vec<super::jump::Labels>,
    /// How many labels the unit has so far.
    pub(super) label_count: u32,
    /// Values that elements of a network hand on.
    pub(super) wires: BTreeMap<String, Place>,
    /// How many wires lists of instructions have so far.
    pub(super) instruction_wires: u32,
}

impl<'c, 'a> Body<'c, 'a> {
    /// For declarations outside of any unit.
    pub(super) fn outside(checker: &'c mut Checker<'a>) -> Self {
        Self::new(checker, Scope::default(), None)
    }

    pub(super) fn new(checker: &'c mut Checker<'a>, scope: Scope, pou: Option<PouId>) -> Self {
        Self {
            checker,
            scope,
            pou,
            context: None,
            loops: 0,
            result_assigned: false,
            labels: Vec::new(),
            label_count: 0,
            wires: BTreeMap::new(),
            instruction_wires: 0,
            network: None,
        }
    }

    pub(super) fn report(&mut self, diagnostic: Diagnostic) {
        self.checker.report(diagnostic);
    }

    pub(super) fn type_name(&self, ty: impl Into<crate::ir::TypeId>) -> String {
        self.checker.types.name(ty.into())
    }

    pub(super) fn elementary(&self, ty: crate::ir::TypeId) -> Option<ElementaryType> {
        self.checker.types.elementary(ty)
    }
}
