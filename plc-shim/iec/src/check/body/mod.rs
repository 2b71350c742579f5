//! Expressions and statements inside of a scope, and the bodies of units.
//!
//! [`Body`] is the room's own structure: each module adds what it checks as methods, and calls those of the others.
//! From outside a body is asked for the value of an expression; [`check_unit`] checks a whole one.
//!
//! | module | subject |
//! |---|---|
//! | [`unit`] | the body of a unit, and what surrounds its statements |
//! | [`statement`] | statements, assignments, jumps, wires, lists of instructions |
//! | [`expression`] | literals, operators, conversions in context, constants |
//! | [`place`] | names, members, indices, direct addresses to places |
//! | [`call`] | functions, function blocks, arguments, EN and ENO |
//! | [`object`] | `THIS`, methods, properties, interfaces |
//! | [`reference`] | references and pointers |
//! | [`text`] | character strings |
//! | [`chart`] | Sequential Function Charts |
//! | [`start`] | what runs before the first scan |
//! | [`view`] | the memory of a variable seen as another type |

mod call;
mod chart;
mod expression;
mod object;
mod place;
mod reference;
mod start;
mod statement;
mod text;
mod unit;
mod view;
mod wire;

use std::collections::BTreeMap;

use self::call::overload::Meanings;
use self::statement::exception::Tried;
use self::statement::jump::Labels;
use self::view::View;
use crate::check::declare::{Declarations, Scope};
use crate::diagnostic::Diagnostic;
use crate::ir::{ElementaryType, Place, PouId, TypeId};

pub(super) use self::expression::dtl::is_literal as is_dtl_literal;
pub(super) use self::start::Surrounding;
pub(super) use self::unit::check_unit;

/// Checks expressions and statements inside a scope.
pub(super) struct Body<'c, 'a> {
    declarations: &'c mut Declarations<'a>,
    scope: Scope,
    /// The unit; nothing for declarations outside of any.
    pou: Option<PouId>,
    /// The type that the place of the expression wants, for constants that no operand types.
    context: Option<ElementaryType>,
    /// The enumeration that it wants, for values that several have.
    enumeration: Option<TypeId>,
    /// Loops around the statement.
    loops: u32,
    result_assigned: bool,
    /// Key of the transition whose network is being checked.
    network: Option<String>,
    /// What jumps may lead to from here, the innermost last.
    labels: Vec<Labels>,
    /// How many labels the unit has so far.
    label_count: u32,
    /// The parts of `__TRY` around the statement, the innermost last.
    tried: Vec<Tried>,
    /// Values that elements of a network hand on.
    wires: BTreeMap<String, Place>,
    /// Statements are checked, not declarations: what a caller gives has the value that it is given. A bound of an
    /// array has that of its declaration, as an input CONSTANT may be one.
    is_running: bool,
    /// Constants of later sections whose values are being worked out.
    later: Vec<(PouId, String)>,
    /// How many wires lists of instructions have so far.
    instruction_wires: u32,
    /// Which of several functions or methods of one name calls mean.
    meanings: Meanings,
    /// The structure in one of whose initial values the expression stands.
    surrounding: Option<Surrounding>,
    /// Views of the unit's variables.
    views: Vec<View>,
}

impl<'c, 'a> Body<'c, 'a> {
    /// For declarations outside of any unit.
    pub(super) fn outside(declarations: &'c mut Declarations<'a>) -> Self {
        Self::new(declarations, Scope::default(), None)
    }

    pub(super) fn new(declarations: &'c mut Declarations<'a>, scope: Scope, pou: Option<PouId>) -> Self {
        Self {
            declarations,
            scope,
            pou,
            context: None,
            enumeration: None,
            loops: 0,
            result_assigned: false,
            labels: Vec::new(),
            label_count: 0,
            tried: Vec::new(),
            wires: BTreeMap::new(),
            later: Vec::new(),
            is_running: false,
            instruction_wires: 0,
            meanings: Meanings::new(),
            network: None,
            surrounding: None,
            views: Vec::new(),
        }
    }

    pub(super) fn declarations(&self) -> &Declarations<'a> {
        self.declarations
    }

    pub(super) fn declarations_mut(&mut self) -> &mut Declarations<'a> {
        self.declarations
    }

    pub(super) fn scope(&self) -> &Scope {
        &self.scope
    }

    pub(super) fn scope_mut(&mut self) -> &mut Scope {
        &mut self.scope
    }

    /// The names and registers, when all is checked.
    pub(super) fn into_scope(self) -> Scope {
        self.scope
    }

    /// The unit; nothing for declarations outside of any.
    pub(super) fn unit(&self) -> Option<PouId> {
        self.pou
    }

    pub(super) fn report(&mut self, diagnostic: Diagnostic) {
        self.declarations.report(diagnostic);
    }

    pub(super) fn type_name(&self, ty: impl Into<crate::ir::TypeId>) -> String {
        self.declarations.types().name(ty.into())
    }

    pub(super) fn elementary(&self, ty: crate::ir::TypeId) -> Option<ElementaryType> {
        self.declarations.types().elementary(ty)
    }
}

/// What something written means: nothing if it is not of the kind asked for, else what it is, if it is right.
pub(super) type Meant<T> = Option<Option<T>>;
