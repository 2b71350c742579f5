//! What vendors call the inputs of the standard's function blocks (CODESYS: library Standard; TwinCAT:
//! `Tc2_Standard`): `RESET` of a counter is `R` of the standard (2nd ed. Tables 34 and 36).

use super::Declarations;
use super::scope::Scope;
use crate::dialect::Feature;
use crate::ir::{PouId, Variable};
use crate::syntax::ast::Ident;

/// Block, vendor's name, the standard's. Counters of other types than INT bear their type behind the name.
const NAMES: [(&str, &str, &str); 8] = [
    ("SR", "SET1", "S1"),
    ("SR", "RESET", "R"),
    ("RS", "SET", "S"),
    ("RS", "RESET1", "R1"),
    ("CTU", "RESET", "R"),
    ("CTD", "LOAD", "LD"),
    ("CTUD", "RESET", "R"),
    ("CTUD", "LOAD", "LD"),
];

fn names_of(block: &str) -> impl Iterator<Item = &'static (&'static str, &'static str, &'static str)> {
    let block = block.split('_').next().unwrap_or(block);
    NAMES.iter().filter(move |(unit, ..)| unit.eq_ignore_ascii_case(block))
}

impl Declarations<'_> {
    /// Lets vendors' names of a library's block find its variables, too.
    pub(super) fn add_vendor_names(&self, id: PouId, scope: &mut Scope) {
        if !self.is_library(id) {
            return;
        }
        for (_, vendor, standard) in names_of(&self.pou(id).ast.name.text) {
            scope.add_alias(vendor, standard);
        }
    }

    /// True if the variable may be called so here: by its name, or as the dialect's library calls it.
    pub(in crate::check) fn is_called_so(&self, variable: &Variable, name: &Ident) -> bool {
        let vendors = || self.dialect(name.span).has(Feature::VendorParameters);
        variable.name.eq_ignore_ascii_case(&name.text) || vendors()
    }
}
