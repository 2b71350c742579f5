//! Initial values of constants that are set from outside, in place of those of their declarations.

use std::collections::BTreeMap;

use super::Declarations;
use crate::syntax::Span;
use crate::syntax::ast::{Ident, Initialiser};

/// Initial values by the place of the name that they are for: names declared together have one declaration
/// and different values.
#[derive(Debug, Default)]
pub struct Overrides {
    by_name: BTreeMap<(u32, u32), Initialiser>,
}

impl Overrides {
    /// Gives the constant declared as `name` another initial value, in place of one given before.
    pub(crate) fn set(&mut self, name: Span, initial: Initialiser) {
        self.by_name.insert((name.file.0, name.start), initial);
    }

    fn get(&self, name: &Ident) -> Option<&Initialiser> {
        self.by_name.get(&(name.span.file.0, name.span.start))
    }
}

impl<'a> Declarations<'a> {
    /// The initial value that a constant has from outside, if it has one.
    pub(in crate::check) fn set_from_outside(&self, name: &Ident) -> Option<&'a Initialiser> {
        self.overrides.get(name)
    }
}
