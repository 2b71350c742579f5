//! What a name means inside a unit, and the unit's registers.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::check::types::parameter;
use crate::ir::{ElementaryType, Guard, LocalId, Place, Pou, Statement, Variable};
use crate::syntax::Span;
use crate::syntax::ast::SectionKind;

/// Stands for the position of a variable whose declaration is wrong.
const BROKEN: usize = usize::MAX;

/// The variables and registers of a unit.
#[derive(Debug, Clone, Default)]
pub(in crate::check) struct Scope {
    variables: Vec<Variable>,
    by_name: BTreeMap<String, usize>,
    registers: Vec<ElementaryType>,
    parameters: u32,
    result: Option<Place>,
    /// The variables of the instance that a method works on.
    outer: Option<Arc<Scope>>,
    /// True if the unit has fixed memory, which two activations would share.
    has_memory: bool,
    /// True if the unit may have variables that nobody knows: those of a base that is not there.
    lacks_names: bool,
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

    /// True for a name of the unit's own, be its declaration right or wrong.
    pub(in crate::check) fn own_name(&self, key: &str) -> bool {
        self.by_name.contains_key(key)
    }

    /// The unit's own names whose declarations are wrong.
    pub(in crate::check) fn broken(&self) -> impl Iterator<Item = &str> {
        self.by_name.keys().map(String::as_str).filter(|key| self.is_broken(key))
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
        self.lacks_names || self.by_name.values().any(|index| *index >= self.variables.len())
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
        self.inputs().filter(|variable| !parameter::is_control(variable))
    }

    /// True if a variable of the name may be there, for all that is known.
    pub(in crate::check) fn may_have(&self, key: &str) -> bool {
        self.lacks_names || self.is_broken(key)
    }

    /// Notes that the unit may have variables that nobody knows.
    pub(in crate::check) fn lack_names(&mut self) {
        self.lacks_names = true;
    }

    /// Adds a variable under a name's key.
    pub(in crate::check) fn add(&mut self, key: String, variable: Variable) {
        self.by_name.insert(key, self.variables.len());
        self.variables.push(variable);
    }

    /// Adds a variable that no name finds.
    pub(in crate::check) fn add_hidden(&mut self, variable: Variable) {
        self.variables.push(variable);
    }

    /// Makes a name known whose declaration is wrong, so that its uses are not reported.
    pub(in crate::check) fn add_broken(&mut self, key: String) {
        self.by_name.insert(key, BROKEN);
    }

    /// Lets another name find a variable, too.
    pub(super) fn add_alias(&mut self, key: &str, known: &str) {
        if let Some(index) = self.by_name.get(known).copied() {
            self.by_name.insert(key.to_owned(), index);
        }
    }

    /// Lets what is not found here be looked for among the variables of the instance.
    pub(in crate::check) fn set_outer(&mut self, outer: Option<Arc<Scope>>) {
        self.outer = outer;
    }

    pub(in crate::check) fn set_result(&mut self, place: Place) {
        self.result = Some(place);
    }

    /// All registers so far are parameters, and those to come are not.
    pub(in crate::check) fn end_parameters(&mut self) {
        self.parameters = self.registers.len() as u32;
    }

    /// Notes that the unit has fixed memory.
    pub(in crate::check) fn keep_memory(&mut self) {
        self.has_memory = true;
    }

    pub(in crate::check) fn variables(&self) -> &[Variable] {
        &self.variables
    }

    /// Where the unit's result is; nothing if it has none.
    pub(in crate::check) fn result(&self) -> Option<&Place> {
        self.result.as_ref()
    }

    /// The variables of the instance that a method works on.
    pub(in crate::check) fn outer(&self) -> Option<&Scope> {
        self.outer.as_deref()
    }

    /// The types of the registers that a caller fills.
    pub(super) fn parameter_types(&self) -> &[ElementaryType] {
        debug_assert!(self.parameters as usize <= self.registers.len(), "parameters are the first registers");
        self.registers.get(..self.parameters as usize).unwrap_or_default()
    }

    /// The unit with these variables. Which guard one with fixed memory needs is known when all calls are.
    pub(in crate::check) fn into_pou(self, name: String, span: Span, body: Vec<Statement>) -> Pou {
        Pou {
            name,
            span,
            variables: self.variables,
            registers: self.registers,
            parameters: self.parameters,
            result: self.result,
            guard: if self.has_memory { Guard::Once(0) } else { Guard::Depth },
            body,
        }
    }

    /// The types of all registers.
    pub(in crate::check) fn into_registers(self) -> Vec<ElementaryType> {
        self.registers
    }

    /// Runs `action` with the registers of this scope and no names: those of a text that stands elsewhere.
    pub(in crate::check) fn without_names(&mut self) -> Scope {
        let registers = std::mem::take(&mut self.registers);
        std::mem::replace(self, Scope { registers, ..Scope::default() })
    }

    /// Takes back the names that [`Self::without_names`] has put aside.
    pub(in crate::check) fn with_names_of(&mut self, named: Scope) {
        let registers = std::mem::take(&mut self.registers);
        let has_memory = named.has_memory || self.has_memory;
        *self = Scope { registers, has_memory, ..named };
    }

    pub(in crate::check) fn register(&mut self, ty: ElementaryType) -> LocalId {
        self.registers.push(ty);
        LocalId(self.registers.len() as u32 - 1)
    }
}
