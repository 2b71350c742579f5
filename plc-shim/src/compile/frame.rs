//! What a unit's own terms mean in the function that is being made, be it the unit's own function
//! or one that it is inlined into.

use std::collections::BTreeMap;

use super::address::Address;
use super::emitter::Label;
use super::known::Known;
use super::registers::Register;
use crate::ir::{LocalId, PouId};

/// Where EXIT and CONTINUE lead.
#[derive(Debug, Clone, Copy)]
pub(super) struct LoopLabels {
    pub(super) exit: Label,
    pub(super) next: Label,
}

#[derive(Debug, Clone)]
pub(super) struct Frame {
    pub(super) pou: PouId,
    /// The unit's registers.
    pub(super) registers: Vec<Register>,
    /// Pointers whose address is known without their register.
    pub(super) pointers: BTreeMap<LocalId, Address>,
    pub(super) loops: Vec<LoopLabels>,
    /// Where jumps lead, the innermost labels last.
    pub(super) jumps: Vec<super::jump::Targets>,
    /// Where RETURN leads.
    pub(super) end: Option<Label>,
    /// What is known wherever RETURN stands.
    pub(super) returned: Option<Known>,
    /// The unit's place among those that marks tell of.
    pub(super) unit: u32,
}

impl Frame {
    /// The register of the unit's own name for it. The checker makes no others.
    pub(super) fn register(&self, local: LocalId) -> Register {
        self.registers.get(local.0 as usize).copied().unwrap_or(Register(0))
    }
}
