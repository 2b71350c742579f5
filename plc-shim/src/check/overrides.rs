//! Initial values of constants that are set from outside, in place of those of their declarations.

use std::collections::BTreeMap;

use crate::syntax::Span;
use crate::syntax::ast::{Ident, Initialiser};

/// Initial values by the place of the name that they are for: names declared together have one declaration
/// and different values.
#[derive(Debug, Default)]
pub(crate) struct Overrides {
    by_name: BTreeMap<(u32, u32), Initialiser>,
}

impl Overrides {
    /// Gives the constant declared as `name` another initial value, in place of one given before.
    pub(crate) fn set(&mut self, name: Span, initial: Initialiser) {
        self.by_name.insert((name.file.0, name.start), initial);
    }

    pub(super) fn get(&self, name: &Ident) -> Option<&Initialiser> {
        self.by_name.get(&(name.span.file.0, name.span.start))
    }
}
