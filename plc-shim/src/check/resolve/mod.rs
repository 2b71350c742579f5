//! Declarations as written to what they mean: types, initial values, variables with their places.
//!
//! [`Resolver`] is the interface: the declarations ask it when something is needed for the first time. What takes an
//! expression asks [`Body`](super::body::Body) for its value.
//!
//! | module | subject |
//! |---|---|
//! | [`written`], [`subrange`], [`structure`], [`union`], [`text`] | types as written to types |
//! | [`initial`], [`start`] | initial values to bytes, and to what a start adds |
//! | [`instance_arguments`] | instances with arguments for their `FB_init` |
//! | [`generic`] | inputs of generic types |
//! | [`global`] | global variables |
//! | [`interface`], [`storage`] | the sections of a unit to placed variables |
//! | [`inherit`], [`keep`], [`chart`] | what a unit has from its base, for its methods, for its charts |
//! | [`enable`], [`referred`] | EN and ENO, variables whose addresses are taken |

pub(in crate::check) mod chart;
pub(in crate::check) mod enable;
pub(in crate::check) mod generic;
pub(in crate::check) mod global;
pub(in crate::check) mod inherit;
pub(in crate::check) mod initial;
pub(in crate::check) mod instance_arguments;
pub(in crate::check) mod interface;
pub(in crate::check) mod keep;
pub(in crate::check) mod referred;
pub(in crate::check) mod start;
pub(in crate::check) mod storage;
pub(in crate::check) mod structure;
pub(in crate::check) mod subrange;
pub(in crate::check) mod text;
pub(in crate::check) mod union;
pub(in crate::check) mod written;

use crate::check::body::Body;
use crate::check::declare::Declarations;
use crate::check::declare::demand::{Need, Resolve};
use crate::check::declare::entry::{Declared, TypedImage};
use crate::check::declare::scope::Scope;
use crate::diagnostic::Diagnostic;
use crate::ir::{PouId, TypeId, Variable};
use crate::syntax::ast::{self, Ident, Qualifier};

/// Resolves declarations by their text.
pub(in crate::check) struct Resolver;

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

    fn unit<'a>(&self, declarations: &mut Declarations<'a>, id: PouId) -> Declared<'a> {
        interface::declared(declarations, id)
    }
}

/// What is written in a declaration, with the names that its expressions see.
pub(in crate::check) struct Written<'c, 'a> {
    body: Body<'c, 'a>,
}

impl<'c, 'a> Written<'c, 'a> {
    /// For declarations outside of any unit.
    pub(in crate::check) fn outside(declarations: &'c mut Declarations<'a>) -> Self {
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
