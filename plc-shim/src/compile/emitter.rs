//! Instructions of one function, with its labels and marks.

use std::collections::BTreeMap;
use std::sync::Arc;

use wasm_encoder::{BlockType, Function, Instruction, ValType};

use super::address::{Extent, Roots};
use super::cost::Costs;
use super::dispatch::RowPlace;
use super::effect::Effects;
use super::fault::{Callee, FaultKind, Mark, MarkKind, Unit};
use super::frame::Frame;
use super::interval::Facts;
use super::known::{Entry, Known};
use super::points::Points;
pub(super) use super::registers::Register;
use super::registers::Registers;
use crate::ir::elementary::Kind;
use crate::ir::{Areas, ElementaryType, LocalId, Pou, PouId, TypeId, TypeTable};
use crate::syntax::Span;

/// How a value of the type is held.
pub(super) fn value_type(ty: ElementaryType) -> ValType {
    match (ty.kind(), ty.size()) {
        (Kind::Real, 4) => ValType::F32,
        (Kind::Real, _) => ValType::F64,
        (_, 8) => ValType::I64,
        _ => ValType::I32,
    }
}

/// A place to branch to.
#[derive(Debug, Clone, Copy)]
pub(super) struct Label(u32);

/// What all functions of the module share.
pub(super) struct Shared<'p> {
    pub(super) types: &'p TypeTable,
    pub(super) pous: &'p BTreeMap<PouId, Pou>,
    pub(super) costs: Costs,
    pub(super) functions: BTreeMap<PouId, u32>,
    pub(super) rows: Vec<RowPlace>,
    pub(super) areas: Areas,
    /// Bytes of memory in use.
    pub(super) memory_size: u32,
    /// What is noted while the program runs, if anything.
    pub(super) points: Option<Points>,
    /// Initial bytes of temporary aggregates, by data segment.
    pub(super) data: Vec<Arc<[u8]>>,
}

pub(super) struct Emitter<'s, 'p> {
    pub(super) shared: &'s mut Shared<'p>,
    pub(super) code: Vec<Instruction<'static>>,
    pub(super) marks: Vec<(usize, Mark)>,
    /// The units that marks tell of: the function's own, then those inlined.
    pub(super) units: Vec<Unit>,
    pub(super) registers: Registers,
    /// Registers that only [`Self::known`] uses.
    pub(super) caches: Vec<Register>,
    pub(super) depth: u32,
    /// The units that are being compiled, the function's own first.
    pub(super) frames: Vec<Frame>,
    pub(super) known: Known,
    /// Values that a register has through all turns of the loops around: every store goes there
    /// too.
    pub(super) pins: Vec<Entry>,
    /// How many branches are around that leave the unit.
    pub(super) leaving: u32,
    /// How many copies of [`Self::known`] are held for later.
    pub(super) held: u32,
    pub(super) roots: Roots,
    pub(super) facts: Facts,
    /// What a trial has found so far.
    pub(super) trial: Option<Effects>,
    /// What the code so far costs to run at most, loops that pay for themselves left out.
    pub(super) cost: u64,
    /// Holds the budget inside of loops that pay for their turns.
    pub(super) budget: Option<Register>,
    /// True if the code uses the budget.
    pub(super) metered: bool,
    /// True if EXIT or RETURN has been seen since this was last taken.
    pub(super) leaves: bool,
}

impl<'s, 'p> Emitter<'s, 'p> {
    pub(super) fn new(shared: &'s mut Shared<'p>, parameters: Vec<ValType>) -> Self {
        Self {
            shared,
            code: Vec::new(),
            marks: Vec::new(),
            units: Vec::new(),
            registers: Registers::new(parameters),
            caches: Vec::new(),
            depth: 0,
            frames: Vec::new(),
            known: Known::default(),
            pins: Vec::new(),
            leaving: 0,
            held: 0,
            roots: Roots::default(),
            facts: Facts::default(),
            trial: None,
            cost: 0,
            budget: None,
            metered: false,
            leaves: false,
        }
    }

    pub(super) fn emit(&mut self, instruction: Instruction<'static>) {
        self.cost = self.cost.saturating_add(1);
        self.code.push(instruction);
    }

    /// The unit that marks belong to.
    pub(super) fn unit(&self) -> u32 {
        self.frames.last().map_or(0, |frame| frame.unit)
    }

    fn mark(&mut self, kind: MarkKind, span: Span) {
        self.marks.push((self.code.len(), Mark { span, kind, unit: self.unit() }));
    }

    /// Says that a statement begins here.
    pub(super) fn mark_statement(&mut self, span: Span) {
        self.mark(MarkKind::Statement, span);
    }

    /// Says what it means if the next instruction traps.
    pub(super) fn mark_fault(&mut self, fault: FaultKind, span: Span) {
        self.mark(MarkKind::Fault(fault), span);
    }

    /// Says what the next instruction calls.
    pub(super) fn mark_call(&mut self, callee: Callee, span: Span) {
        self.mark(MarkKind::Call(callee), span);
    }

    /// Says that the next instruction is a branch that is taken as a rule: what lies behind it goes out of the way.
    pub(super) fn mark_likely(&mut self, span: Span) {
        self.mark(MarkKind::Likely, span);
    }

    /// Stops the PLC if the value on the stack is not 0.
    /// The branch traps by itself where the machine can do so.
    pub(super) fn fault_if(&mut self, fault: FaultKind, span: Span) {
        self.mark_fault(fault, span);
        self.emit(Instruction::If(BlockType::Empty));
        self.mark_fault(fault, span);
        self.emit(Instruction::Unreachable);
        self.emit(Instruction::End);
    }

    /// The elementary type that holds values of `ty`; an address is held like UDINT.
    pub(super) fn held_as(&self, ty: TypeId) -> ElementaryType {
        self.shared.types.elementary(ty).unwrap_or(ElementaryType::Udint)
    }

    /// A free register; [`Self::release`] gives it back.
    pub(super) fn scratch(&mut self, ty: ValType) -> Register {
        self.registers.take(ty)
    }

    pub(super) fn release(&mut self, register: Register) {
        self.registers.release(register);
    }

    /// The register that the running unit calls `local`.
    pub(super) fn register(&self, local: LocalId) -> Register {
        self.frames.last().map_or(Register(local.0), |frame| frame.register(local))
    }

    pub(super) fn get(&mut self, register: Register) {
        self.emit(Instruction::LocalGet(register.0));
    }

    pub(super) fn set(&mut self, register: Register) {
        self.note_set(register);
        self.emit(Instruction::LocalSet(register.0));
    }

    pub(super) fn tee(&mut self, register: Register) {
        self.note_set(register);
        self.emit(Instruction::LocalTee(register.0));
    }

    fn note_set(&mut self, register: Register) {
        self.known.ranges.forget_register(register);
        if let Some(trial) = &mut self.trial {
            trial.set(register);
        }
    }

    /// Memory there is changed by other means than an elementary store; anywhere if nothing is
    /// known of it.
    pub(super) fn changed(&mut self, extent: Option<Extent>) {
        match extent {
            Some(extent) => self.known.forget(extent, &self.roots),
            None => self.known.forget_all(),
        }
        if let Some(trial) = &mut self.trial {
            let extent = extent.map(|extent| self.roots.settled(extent, |register| trial.sets(register)));
            trial.change(extent);
        }
    }

    /// Opens a block; branches to its label leave it.
    pub(super) fn open_block(&mut self) -> Label {
        self.emit(Instruction::Block(BlockType::Empty));
        self.depth += 1;
        Label(self.depth)
    }

    /// Opens a loop; branches to its label begin the next turn.
    pub(super) fn open_loop(&mut self) -> Label {
        self.emit(Instruction::Loop(BlockType::Empty));
        self.depth += 1;
        Label(self.depth)
    }

    pub(super) fn close(&mut self) {
        self.emit(Instruction::End);
        self.depth -= 1;
    }

    pub(super) fn branch(&mut self, label: Label) {
        self.emit(Instruction::Br(self.depth - label.0));
    }

    /// Branches if the value on the stack is not 0.
    pub(super) fn branch_if(&mut self, label: Label) {
        self.emit(Instruction::BrIf(self.depth - label.0));
    }

    /// Branches to the label at the position that the value on the stack says, else to the last.
    pub(super) fn branch_table(&mut self, labels: &[Label], otherwise: Label) {
        let depth = self.depth;
        let targets: Vec<u32> = labels.iter().map(|label| depth - label.0).collect();
        self.emit(Instruction::BrTable(targets.into(), depth - otherwise.0));
    }

    /// The function's body and its marks by byte offset.
    pub(super) fn finish(mut self, id: PouId) -> (Function, Vec<(u32, Mark)>, Vec<Unit>) {
        self.emit(Instruction::End);
        let call = self.pay_at_entry();
        self.shared.costs.found(id, call, self.metered);
        let mut function = Function::new_with_locals_types(self.registers.locals().iter().copied());
        let mut marks = Vec::with_capacity(self.marks.len());
        let mut pending = self.marks.iter().peekable();
        for (index, instruction) in self.code.iter().enumerate() {
            while let Some((_, mark)) = pending.next_if(|(at, _)| *at <= index) {
                marks.push((function.byte_len() as u32, *mark));
            }
            function.instruction(instruction);
        }
        (function, marks, self.units)
    }
}
