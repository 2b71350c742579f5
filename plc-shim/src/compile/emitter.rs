//! Instructions of one function, with its registers, labels and marks.

use std::collections::BTreeMap;
use std::sync::Arc;

use wasm_encoder::{BlockType, Function, Instruction, ValType};

use super::dispatch::RowPlace;
use super::fault::{Callee, FaultKind, Mark, MarkKind};
use crate::ir::elementary::Kind;
use crate::ir::{Areas, ElementaryType, LocalId, PouId, TypeId, TypeTable};
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

/// Where EXIT and CONTINUE lead.
#[derive(Debug, Clone, Copy)]
pub(super) struct LoopLabels {
    pub(super) exit: Label,
    pub(super) next: Label,
}

/// What all functions of the module share.
pub(super) struct Shared<'p> {
    pub(super) types: &'p TypeTable,
    pub(super) functions: BTreeMap<PouId, u32>,
    pub(super) rows: Vec<RowPlace>,
    pub(super) areas: Areas,
    /// Bytes of memory in use.
    pub(super) memory_size: u32,
    /// Initial bytes of temporary aggregates, by data segment.
    pub(super) data: Vec<Arc<[u8]>>,
}

pub(super) struct Emitter<'s, 'p> {
    pub(super) shared: &'s mut Shared<'p>,
    code: Vec<Instruction<'static>>,
    marks: Vec<(usize, Mark)>,
    parameters: usize,
    locals: Vec<ValType>,
    free: Vec<LocalId>,
    depth: u32,
    pub(super) loops: Vec<LoopLabels>,
    pub(super) end: Option<Label>,
}

impl<'s, 'p> Emitter<'s, 'p> {
    pub(super) fn new(shared: &'s mut Shared<'p>, registers: &[ElementaryType], parameters: u32) -> Self {
        Self {
            shared,
            code: Vec::new(),
            marks: Vec::new(),
            parameters: parameters as usize,
            locals: registers.iter().map(|ty| value_type(*ty)).collect(),
            free: Vec::new(),
            depth: 0,
            loops: Vec::new(),
            end: None,
        }
    }

    pub(super) fn emit(&mut self, instruction: Instruction<'static>) {
        self.code.push(instruction);
    }

    /// Says that a statement begins here.
    pub(super) fn mark_statement(&mut self, span: Span) {
        self.marks.push((self.code.len(), Mark { span, kind: MarkKind::Statement }));
    }

    /// Says what it means if the next instruction traps.
    pub(super) fn mark_fault(&mut self, fault: FaultKind, span: Span) {
        self.marks.push((self.code.len(), Mark { span, kind: MarkKind::Fault(fault) }));
    }

    /// Says what the next instruction calls.
    pub(super) fn mark_call(&mut self, callee: Callee, span: Span) {
        self.marks.push((self.code.len(), Mark { span, kind: MarkKind::Call(callee) }));
    }

    /// Stops the PLC if the value on the stack is not 0.
    pub(super) fn fault_if(&mut self, fault: FaultKind, span: Span) {
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
    pub(super) fn scratch(&mut self, ty: ValType) -> LocalId {
        let fits = |local: &LocalId| self.locals.get(local.0 as usize) == Some(&ty);
        if let Some(index) = self.free.iter().position(fits) {
            return self.free.swap_remove(index);
        }
        self.locals.push(ty);
        LocalId(self.locals.len() as u32 - 1)
    }

    pub(super) fn release(&mut self, local: LocalId) {
        self.free.push(local);
    }

    pub(super) fn get(&mut self, local: LocalId) {
        self.emit(Instruction::LocalGet(local.0));
    }

    pub(super) fn set(&mut self, local: LocalId) {
        self.emit(Instruction::LocalSet(local.0));
    }

    pub(super) fn tee(&mut self, local: LocalId) {
        self.emit(Instruction::LocalTee(local.0));
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

    /// The function's body and its marks by byte offset.
    pub(super) fn finish(mut self) -> (Function, Vec<(u32, Mark)>) {
        self.emit(Instruction::End);
        let locals = self.locals.get(self.parameters..).unwrap_or(&[]);
        let mut function = Function::new_with_locals_types(locals.iter().copied());
        let mut marks = Vec::with_capacity(self.marks.len());
        let mut pending = self.marks.iter().peekable();
        for (index, instruction) in self.code.iter().enumerate() {
            while let Some((_, mark)) = pending.next_if(|(at, _)| *at <= index) {
                marks.push((function.byte_len() as u32, *mark));
            }
            function.instruction(instruction);
        }
        (function, marks)
    }
}
