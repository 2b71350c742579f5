//! Expressions and statements inside of a scope, and the bodies of units.

pub(in crate::check) mod call;
pub(in crate::check) mod chart;
pub(in crate::check) mod expression;
pub(in crate::check) mod object;
pub(in crate::check) mod place;
pub(in crate::check) mod reference;
pub(in crate::check) mod start;
pub(in crate::check) mod statement;
pub(in crate::check) mod text;
pub(in crate::check) mod unit;

use std::collections::BTreeMap;

use self::statement::jump::Labels;
use crate::check::declare::Declarations;
use crate::check::declare::scope::Scope;
use crate::diagnostic::Diagnostic;
use crate::ir::{ElementaryType, Place, PouId};

/// Checks expressions and statements inside a scope.
pub(in crate::check) struct Body<'c, 'a> {
    declarations: &'c mut Declarations<'a>,
    scope: Scope,
    /// The unit; nothing for declarations outside of any.
    pou: Option<PouId>,
    /// The type that the place of the expression wants, for constants that no operand types.
    context: Option<ElementaryType>,
    /// Loops around the statement.
    loops: u32,
    result_assigned: bool,
    /// Key of the transition whose network is being checked.
    network: Option<String>,
    /// What jumps may lead to from here, the innermost last.
    labels: Vec<Labels>,
    /// How many labels the unit has so far.
    label_count: u32,
    /// Values that elements of a network hand on.
    wires: BTreeMap<String, Place>,
    /// How many wires lists of instructions have so far.
    instruction_wires: u32,
}

impl<'c, 'a> Body<'c, 'a> {
    /// For declarations outside of any unit.
    pub(in crate::check) fn outside(declarations: &'c mut Declarations<'a>) -> Self {
        Self::new(declarations, Scope::default(), None)
    }

    pub(in crate::check) fn new(declarations: &'c mut Declarations<'a>, scope: Scope, pou: Option<PouId>) -> Self {
        Self {
            declarations,
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

    pub(in crate::check) fn declarations(&self) -> &Declarations<'a> {
        self.declarations
    }

    pub(in crate::check) fn declarations_mut(&mut self) -> &mut Declarations<'a> {
        self.declarations
    }

    pub(in crate::check) fn scope(&self) -> &Scope {
        &self.scope
    }

    pub(in crate::check) fn scope_mut(&mut self) -> &mut Scope {
        &mut self.scope
    }

    /// The names and registers, when all is checked.
    pub(in crate::check) fn into_scope(self) -> Scope {
        self.scope
    }

    /// The unit; nothing for declarations outside of any.
    pub(in crate::check) fn unit(&self) -> Option<PouId> {
        self.pou
    }

    pub(in crate::check) fn report(&mut self, diagnostic: Diagnostic) {
        self.declarations.report(diagnostic);
    }

    pub(in crate::check) fn type_name(&self, ty: impl Into<crate::ir::TypeId>) -> String {
        self.declarations.types().name(ty.into())
    }

    pub(in crate::check) fn elementary(&self, ty: crate::ir::TypeId) -> Option<ElementaryType> {
        self.declarations.types().elementary(ty)
    }
}

/// What something written means: nothing if it is not of the kind asked for, else what it is, if it is right.
pub(in crate::check) type Meant<T> = Option<Option<T>>;
