//! Instructions of one function, with its labels and marks.

use wasm_encoder::{BlockType, Function, Instruction, ValType};

use super::Emitter;
use crate::compile::fault::{Callee, FaultKind, Mark, MarkKind};
use onescan_iec::syntax::Span;

/// A place to branch to.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Label(u32);

#[derive(Default)]
pub(super) struct Code {
    instructions: Vec<Instruction<'static>>,
    /// In the order of the instructions that they stand before.
    marks: Vec<(usize, Mark)>,
    /// How many blocks are open.
    depth: u32,
    /// What the code so far costs to run at most, loops that pay for themselves left out.
    cost: u64,
}

impl Code {
    pub(super) fn cost(&self) -> u64 {
        self.cost
    }

    pub(super) fn set_cost(&mut self, cost: u64) {
        self.cost = cost;
    }

    /// Where the last mark of a unit before `unit` stands in the source.
    pub(super) fn last_span_before(&self, unit: u32) -> Option<Span> {
        self.marks.iter().rev().find(|(_, mark)| mark.unit < unit).map(|(_, mark)| mark.span)
    }

    /// Puts instructions before all others, of which the last `trapping` stand for a fault of the whole unit.
    pub(super) fn begin_with(&mut self, entry: Vec<Instruction<'static>>, trapping: [usize; 2], fault: FaultKind) {
        let count = entry.len();
        debug_assert!(trapping.is_sorted() && trapping.iter().all(|at| *at < count), "what traps is part of the entry");
        self.instructions.splice(0..0, entry);
        for (at, _) in &mut self.marks {
            *at += count;
        }
        // The unit itself is the first that a mark belongs to.
        if let Some((_, Mark { span, unit, .. })) = self.marks.first().copied() {
            let mark = Mark { span, unit, kind: MarkKind::Fault(fault) };
            self.marks.splice(0..0, trapping.map(|at| (at, mark)));
        }
    }

    /// The body, and its marks by byte offset.
    pub(super) fn finish(self, locals: &[ValType]) -> (Function, Vec<(u32, Mark)>) {
        debug_assert_eq!(self.depth, 0, "every block of a function is closed");
        debug_assert!(self.marks.is_sorted_by_key(|(at, _)| *at), "marks lie in the order of their instructions");
        let mut function = Function::new_with_locals_types(locals.iter().copied());
        let mut marks = Vec::with_capacity(self.marks.len());
        let mut pending = self.marks.iter().peekable();
        for (index, instruction) in self.instructions.iter().enumerate() {
            while let Some((_, mark)) = pending.next_if(|(at, _)| *at <= index) {
                marks.push((function.byte_len() as u32, *mark));
            }
            function.instruction(instruction);
        }
        debug_assert!(pending.next().is_none(), "every mark stands before an instruction");
        (function, marks)
    }
}

impl Emitter<'_, '_> {
    pub(crate) fn emit(&mut self, instruction: Instruction<'static>) {
        self.charge(1);
        self.code.instructions.push(instruction);
    }

    fn mark(&mut self, kind: MarkKind, span: Span) {
        let mark = Mark { span, kind, unit: self.unit() };
        self.code.marks.push((self.code.instructions.len(), mark));
    }

    /// Says that a statement begins here.
    pub(crate) fn mark_statement(&mut self, span: Span) {
        self.mark(MarkKind::Statement, span);
    }

    /// Says what it means if the next instruction traps.
    pub(crate) fn mark_fault(&mut self, fault: FaultKind, span: Span) {
        self.mark(MarkKind::Fault(fault), span);
    }

    /// Says what the next instruction calls.
    pub(crate) fn mark_call(&mut self, callee: Callee, span: Span) {
        self.mark(MarkKind::Call(callee), span);
    }

    /// Says that the next instruction is a branch that is taken as a rule: what lies behind it goes out of the way.
    pub(crate) fn mark_likely(&mut self, span: Span) {
        self.mark(MarkKind::Likely, span);
    }

    /// Stops the PLC if the value on the stack is not 0.
    /// The branch is marked too: machines trap there, without one, where they can.
    pub(crate) fn fault_if(&mut self, fault: FaultKind, span: Span) {
        self.mark_fault(fault, span);
        self.emit(Instruction::If(BlockType::Empty));
        self.mark_fault(fault, span);
        self.emit(Instruction::Unreachable);
        self.emit(Instruction::End);
    }

    /// Opens a block; branches to its label leave it.
    pub(crate) fn open_block(&mut self) -> Label {
        self.emit(Instruction::Block(BlockType::Empty));
        self.code.depth += 1;
        Label(self.code.depth)
    }

    /// Opens a loop; branches to its label begin the next turn.
    pub(crate) fn open_loop(&mut self) -> Label {
        self.emit(Instruction::Loop(BlockType::Empty));
        self.code.depth += 1;
        Label(self.code.depth)
    }

    pub(crate) fn close(&mut self) {
        debug_assert!(self.code.depth > 0, "only an open block can be closed");
        self.emit(Instruction::End);
        self.code.depth -= 1;
    }

    pub(crate) fn branch(&mut self, label: Label) {
        debug_assert!((1..=self.code.depth).contains(&label.0), "a branch leads out of a block that is open");
        self.emit(Instruction::Br(self.code.depth - label.0));
    }

    /// Branches if the value on the stack is not 0.
    pub(crate) fn branch_if(&mut self, label: Label) {
        debug_assert!((1..=self.code.depth).contains(&label.0), "a branch leads out of a block that is open");
        self.emit(Instruction::BrIf(self.code.depth - label.0));
    }

    /// Branches to the label at the position that the value on the stack says, else to the last.
    pub(crate) fn branch_table(&mut self, labels: &[Label], otherwise: Label) {
        let depth = self.code.depth;
        let is_open = |label: &Label| (1..=depth).contains(&label.0);
        debug_assert!(labels.iter().chain([&otherwise]).all(is_open), "a table of jumps leads out of open blocks");
        let targets: Vec<u32> = labels.iter().map(|label| depth - label.0).collect();
        self.emit(Instruction::BrTable(targets.into(), depth - otherwise.0));
    }
}
