//! Inputs of which a unit sees the edges, `R_EDGE` and `F_EDGE` (2nd ed. 2.5.2.2, Table 33).
//!
//! The unit behaves as if it had an instance of `R_TRIG` or `F_TRIG` for the input, called once at its
//! beginning, and used its Q instead of the input.

use super::build::{assign, load, not, operation};
use super::scope::Body;
use crate::ir::{Binary, EdgeDetection, ElementaryType, Place, Statement, Storage, Variable};
use crate::syntax::ast::Edge;

impl Body<'_, '_> {
    /// Looks for the edge once in every call of the unit.
    pub(super) fn detected(variable: &Variable, detection: EdgeDetection) -> [Statement; 2] {
        let place = |storage| Place::whole(storage, ElementaryType::Bool.into(), variable.span);
        let level = match detection.edge {
            Edge::Rising => load(&place(variable.storage)),
            Edge::Falling => not(load(&place(variable.storage))),
        };
        let memory = place(detection.memory);
        let edge = operation(Binary::And, level.clone(), not(load(&memory)));
        [assign(&place(Storage::Register(detection.seen)), edge), assign(&memory, level)]
    }
}
