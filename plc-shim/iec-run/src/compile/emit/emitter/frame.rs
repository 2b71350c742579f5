//! What a unit's own terms mean in the function that is being made, be it the unit's own function
//! or one that it is inlined into.

use wasm_encoder::{Instruction, ValType};

use super::code::Label;
use super::{Emitter, value_type};
use crate::compile::analyse::{Address, Extent, INSTANCE, Known, Register};
use crate::compile::fault::{Callee, Unit};
use onescan_iec::ir::{LabelId, LocalId, Pou, PouId};
use onescan_iec::syntax::Span;

/// Where EXIT and CONTINUE lead.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LoopLabels {
    pub(crate) exit: Label,
    pub(crate) next: Label,
}

/// Where the labels of one list of statements are.
#[derive(Debug, Clone)]
pub(crate) struct Targets {
    /// Each label in its order, and the block whose end it stands behind.
    labels: Vec<(LabelId, Label)>,
    /// The part that is being compiled; 0 is what stands before the first label.
    at: usize,
    back: Option<Back>,
    /// True if the budget is in a register.
    budget: bool,
}

/// What a jump backwards needs.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Back {
    pub(crate) top: Label,
    /// Holds the part that the next turn begins with.
    pub(crate) register: Register,
    /// Cost of the code before the loop.
    pub(crate) cost: u64,
}

/// How a jump gets to its label.
#[derive(Debug, Clone, Copy)]
pub(crate) enum JumpTo {
    /// Out of this block; the budget is in a register there, or not.
    Behind { block: Label, has_budget: bool },
    /// By another turn, which begins with this part.
    Back { back: Back, part: usize },
}

#[derive(Debug)]
pub(super) struct Frame {
    loops: Vec<LoopLabels>,
    /// Where jumps lead, the innermost labels last.
    jumps: Vec<Targets>,
    end: Option<Label>,
    /// What is known wherever RETURN stands.
    returned: Option<Known>,
    /// The unit's place among those that marks belong to.
    unit: u32,
}

impl Frame {
    /// True if what is known somewhere in the unit is kept for its end.
    pub(super) fn has_returned(&self) -> bool {
        self.returned.is_some()
    }
}

impl Emitter<'_, '_> {
    /// The unit that marks belong to.
    pub(super) fn unit(&self) -> u32 {
        self.frames.last().map_or(0, |frame| frame.unit)
    }

    /// Opens a frame for the unit; registers beyond the `parameters`, which are the function's own, are new.
    pub(crate) fn enter(&mut self, id: PouId, pou: &Pou, parameters: u32, call: Option<(Callee, Span)>) {
        debug_assert!(parameters as usize <= pou.registers.len(), "parameters of `{}` are registers of it", pou.name);
        let caller = call.map(|(callee, span)| (self.unit(), callee, span));
        let mut registers: Vec<_> = (0..parameters).map(Register::new).collect();
        for ty in pou.registers.iter().skip(parameters as usize) {
            registers.push(self.scratch(value_type(*ty)));
        }
        self.units.push(Unit { name: pou.name.clone(), caller });
        let unit = self.units.len() as u32 - 1;
        self.frames.push(Frame { loops: Vec::new(), jumps: Vec::new(), end: None, returned: None, unit });
        self.scope.enter(id, registers);
    }

    /// Closes an inlined unit's frame.
    pub(crate) fn leave(&mut self) {
        let unit = self.unit();
        debug_assert!(self.frames.len() > 1, "the function's own unit is never left");
        self.frames.pop();
        for register in self.scope.leave() {
            self.known.forget_base(register);
            self.release(register);
        }
        // What follows belongs to the statement with the call again.
        if let Some(span) = self.code.last_span_before(unit) {
            self.mark_statement(span);
        }
    }

    /// The running instance is the one at this address, whatever its register holds.
    pub(crate) fn runs_on(&mut self, instance: Address) {
        self.scope.point(INSTANCE, instance);
    }

    /// A pointer leads to this address from here on.
    pub(crate) fn point(&mut self, pointer: LocalId, address: Address) {
        self.scope.point(pointer, address);
    }

    /// The pointer's register has been given another address, which lies in `extent`, or anywhere.
    pub(crate) fn repoint(&mut self, pointer: LocalId, extent: Option<Extent>) -> Register {
        let register = self.scope.register(pointer);
        self.known.forget_base(register);
        self.scope.lead(register, extent);
        register
    }

    /// Only its register says from here on where the pointer leads, and it may be anywhere.
    pub(crate) fn unpoint(&mut self, pointer: LocalId) -> Register {
        self.scope.unpoint(pointer);
        self.repoint(pointer, None)
    }

    /// What `emit` makes lies in a loop whose EXIT and CONTINUE lead there.
    pub(crate) fn in_loop(&mut self, labels: LoopLabels, emit: impl FnOnce(&mut Self)) {
        if let Some(frame) = self.frames.last_mut() {
            frame.loops.push(labels);
        }
        emit(self);
        if let Some(frame) = self.frames.last_mut() {
            frame.loops.pop();
        }
    }

    /// Where EXIT and CONTINUE lead; nothing outside of loops, where the checker lets none stand.
    pub(crate) fn innermost_loop(&self) -> Option<LoopLabels> {
        self.frames.last().and_then(|frame| frame.loops.last()).copied()
    }

    /// What `emit` makes are the parts between these labels.
    pub(crate) fn among_labels(
        &mut self,
        labels: Vec<(LabelId, Label)>,
        back: Option<Back>,
        emit: impl FnOnce(&mut Self),
    ) {
        let targets = Targets { labels, at: 0, back, budget: self.budget.is_some() };
        if let Some(frame) = self.frames.last_mut() {
            frame.jumps.push(targets);
        }
        emit(self);
        if let Some(frame) = self.frames.last_mut() {
            frame.jumps.pop();
        }
    }

    /// The part at this position, from 1 on, begins.
    pub(crate) fn begin_part(&mut self, at: usize) {
        if let Some(targets) = self.frames.last_mut().and_then(|frame| frame.jumps.last_mut()) {
            debug_assert!((1..=targets.labels.len()).contains(&at), "part {at} begins behind a label");
            debug_assert!(at > targets.at, "parts begin in the order of their labels");
            targets.at = at;
        }
    }

    /// How a jump gets to a label; nothing if there is none, to which the checker makes no jumps.
    pub(crate) fn way_to(&self, label: LabelId) -> Option<JumpTo> {
        let targets = self.frames.last()?.jumps.iter().rev();
        let mut found = targets.filter_map(|targets| {
            let at = targets.labels.iter().position(|(id, _)| *id == label)?;
            let block = targets.labels.get(at).filter(|_| at >= targets.at).map(|(_, block)| *block);
            Some(match (block, targets.back) {
                (Some(block), _) => Some(JumpTo::Behind { block, has_budget: targets.budget }),
                (None, Some(back)) => Some(JumpTo::Back { back, part: at + 1 }),
                (None, None) => None,
            })
        });
        found.next().flatten()
    }

    /// RETURN leads from here on behind this block.
    pub(crate) fn returns_to(&mut self, end: Label) {
        if let Some(frame) = self.frames.last_mut() {
            frame.end = Some(end);
        }
    }

    /// Where RETURN leads. What is known here is known at the unit's end, as far as it is at its other ends.
    pub(crate) fn begin_return(&mut self) -> Option<Label> {
        let frame = self.frames.last_mut()?;
        match &mut frame.returned {
            Some(returned) => returned.meet(&self.known),
            None => frame.returned = Some(self.known.clone()),
        }
        frame.end
    }

    /// The function is one of statements that a fault ends: the register says from here on how they have.
    pub(crate) fn begin_outcome(&mut self, first: i32) -> Register {
        let register = self.scratch(ValType::I32);
        self.outcome = Some(register);
        self.set_outcome(first);
        register
    }

    /// Says how statements end that a fault may end; nothing anywhere else, nor in a unit that they call.
    pub(crate) fn set_outcome(&mut self, outcome: i32) {
        if let Some(register) = self.outcome.filter(|_| self.frames.len() == 1) {
            self.emit(Instruction::I32Const(outcome));
            self.set(register);
        }
    }

    /// All RETURNs of the unit come together here.
    pub(crate) fn meet_returns(&mut self) {
        if let Some(returned) = self.frames.last_mut().and_then(|frame| frame.returned.take()) {
            self.known.meet(&returned);
        }
    }
}
