//! Declarations as written to what they mean: types, initial values, variables with their places.
//!
//! [`Resolver`] is the interface: the declarations ask it when something is needed for the first time. What takes an
//! expression asks [`Body`](super::body::Body) for its value.
//!
//! | module | subject |
//! |---|---|
//! | [`written`], [`subrange`], [`structure`], [`union`] | types as written to types |
//! | [`initial`], [`start`] | initial values to bytes, and to what a start adds |
//! | [`instance_arguments`] | instances with arguments for their `FB_init` |
//! | [`generic`], [`bit`] | inputs of generic types, where BIT may stand |
//! | [`global`] | global variables |
//! | [`interface`], [`storage`] | the sections of a unit to placed variables |
//! | [`inherit`], [`keep`], [`chart`] | what a unit has from its base, for its methods, for its charts |
//! | [`enable`], [`referred`] | EN and ENO, variables whose addresses are taken |

mod bit;
mod chart;
mod enable;
mod generic;
mod global;
mod inherit;
mod initial;
mod instance_arguments;
mod interface;
mod keep;
mod referred;
mod start;
mod storage;
mod structure;
mod subrange;
mod union;
mod written;

use crate::check::body::Body;
use crate::check::declare::{Declarations, Declared, Need, Resolve, Scope, TypedImage};
use crate::diagnostic::Diagnostic;
use crate::ir::{PouId, TypeId, Variable};
use crate::syntax::ast::{self, Ident, Qualifier};

/// Resolves declarations by their text.
pub(super) struct Resolver;

impl Resolve for Resolver {
    fn type_declaration<'a>(
        &self,
        declarations: &mut Declarations<'a>,
        ast: &'a ast::TypeDeclaration,
    ) -> Option<TypedImage<'a>> {
        Written::outside(declarations).declared_type(ast)
    }

    fn type_meant(&self, declarations: &mut Declarations<'_>, name: &Ident) -> Option<TypeId> {
        Written::outside(declarations).type_by_name(name, Need::Size).map(|found| found.ty)
    }

    fn global_variable<'a>(
        &self,
        declarations: &mut Declarations<'a>,
        name: &Ident,
        ast: &'a ast::Variable,
        qualifiers: &[Qualifier],
    ) -> Option<Variable> {
        Written::outside(declarations).global_variable(name, ast, qualifiers)
    }

    fn template_argument(
        &self,
        declarations: &mut Declarations<'_>,
        unit: Option<PouId>,
        argument: &ast::Expr,
    ) -> Option<i128> {
        match unit {
            Some(id) => interface::template_argument(declarations, id, argument),
            None => Body::outside(declarations).constant_integer(argument),
        }
    }

    fn unit<'a>(&self, declarations: &mut Declarations<'a>, id: PouId) -> Declared<'a> {
        interface::declared(declarations, id)
    }
}

/// What is written in a declaration, with the names that its expressions see.
pub(super) struct Written<'c, 'a> {
    body: Body<'c, 'a>,
}

impl<'c, 'a> Written<'c, 'a> {
    /// For declarations outside of any unit.
    pub(super) fn outside(declarations: &'c mut Declarations<'a>) -> Self {
        Self { body: Body::outside(declarations) }
    }

    /// For the declarations of a unit, of which none is known yet.
    fn of_unit(declarations: &'c mut Declarations<'a>, id: PouId) -> Self {
        Self { body: Body::new(declarations, Scope::default(), Some(id)) }
    }

    fn declarations(&self) -> &Declarations<'a> {
        self.body.declarations()
    }

    fn declarations_mut(&mut self) -> &mut Declarations<'a> {
        self.body.declarations_mut()
    }

    fn report(&mut self, diagnostic: Diagnostic) {
        self.body.report(diagnostic);
    }
}
