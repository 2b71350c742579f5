//! One function while it is made: its instructions, registers and budget, and what is known at the place
//! that has been reached. Its files alone see the state; all that emits goes through their methods.
//!
//! | module | subject |
//! |---|---|
//! | [`code`] | instructions, labels, marks |
//! | [`registers`] | locals of WebAssembly, given out and taken back |
//! | [`frame`] | a unit's own terms: where its names, loops and jumps lead |
//! | [`flow`] | what is known, where ways part and come together |
//! | [`held`] | values that registers hold for memory, through loops too |
//! | [`access`] | loads and stores |
//! | [`budget`] | what code costs, and how endless loops end |
//! | [`handed`] | globals that hand a unit's registers on |

mod access;
mod budget;
mod code;
mod flow;
mod frame;
mod handed;
mod held;
mod registers;

use std::collections::BTreeMap;
use std::sync::Arc;

use wasm_encoder::{Function, Instruction, ValType};

use self::code::Code;
use self::frame::Frame;
use self::handed::Handed;
use self::registers::Registers;
use crate::compile::analyse::{Address, Effects, Entry, Extent, Known, Program, Register, Scope};
use crate::compile::fault::{FaultKind, Mark, Unit};
use crate::compile::points::Points;
use onescan_iec::ir::elementary::Kind;
use onescan_iec::ir::{ElementaryType, Guard, LocalId, Place, Pou, PouId, TypeId};
use onescan_iec::syntax::Span;

pub(crate) use self::budget::globals;
pub(crate) use self::code::Label;
pub(crate) use self::frame::{Back, JumpTo, LoopLabels};

/// Where a row stands in the table, and its signature.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RowPlace {
    pub(crate) start: u32,
    pub(crate) first: u32,
    pub(crate) signature: u32,
}

/// How a value of the type is held.
pub(crate) fn value_type(ty: ElementaryType) -> ValType {
    match (ty.kind(), ty.size()) {
        (Kind::Real, 4) => ValType::F32,
        (Kind::Real, _) => ValType::F64,
        (_, 8) => ValType::I64,
        _ => ValType::I32,
    }
}

/// A function's code and what its instructions stand for.
pub(crate) struct Made {
    pub(crate) body: Function,
    pub(crate) marks: Vec<(u32, Mark)>,
    pub(crate) units: Vec<Unit>,
}

/// What all functions of the module share.
pub(crate) struct Shared<'p> {
    program: Program<'p>,
    functions: BTreeMap<PouId, u32>,
    rows: Vec<RowPlace>,
    memory_size: u32,
    points: Option<Points>,
    data: Vec<Arc<[u8]>>,
    handed: Handed,
    /// The functions of statements that a fault ends.
    tries: Vec<Made>,
}

impl<'p> Shared<'p> {
    /// `functions` are the units' indices in the module, `memory_size` is in bytes.
    pub(crate) fn new(
        program: Program<'p>,
        functions: BTreeMap<PouId, u32>,
        rows: Vec<RowPlace>,
        memory_size: u32,
        points: Option<Points>,
    ) -> Self {
        Self {
            program,
            functions,
            rows,
            memory_size,
            points,
            data: Vec::new(),
            handed: Handed::default(),
            tries: Vec::new(),
        }
    }

    /// The index of a unit's function.
    pub(crate) fn function(&self, pou: PouId) -> Option<u32> {
        self.functions.get(&pou).copied()
    }

    /// Where a row of methods stands in the table.
    pub(crate) fn row(&self, row: usize) -> Option<RowPlace> {
        self.rows.get(row).copied()
    }

    /// Bytes of memory in use.
    pub(crate) fn memory_size(&self) -> u32 {
        self.memory_size
    }

    /// What is noted while the program runs, if anything.
    pub(crate) fn points(&self) -> Option<&Points> {
        self.points.as_ref()
    }

    pub(crate) fn points_mut(&mut self) -> Option<&mut Points> {
        self.points.as_mut()
    }

    pub(crate) fn into_points(self) -> Option<Points> {
        self.points
    }

    /// Initial bytes of temporary aggregates, by data segment.
    pub(crate) fn data(&self) -> &[Arc<[u8]>] {
        &self.data
    }

    /// The functions of statements that a fault ends, by their numbers.
    pub(crate) fn take_tries(&mut self) -> Vec<Made> {
        std::mem::take(&mut self.tries)
    }

    /// The number of the function of statements that a fault ends.
    pub(crate) fn add_try(&mut self, made: Made) -> u32 {
        self.tries.push(made);
        self.tries.len() as u32 - 1
    }

    /// The number of a new data segment with these bytes.
    pub(crate) fn add_data(&mut self, bytes: &Arc<[u8]>) -> u32 {
        self.data.push(bytes.clone());
        self.data.len() as u32 - 1
    }
}

/// A function that is being made.
pub(crate) struct Emitter<'s, 'p> {
    shared: &'s mut Shared<'p>,
    code: Code,
    /// The units that marks belong to: the function's own, then those inlined.
    units: Vec<Unit>,
    registers: Registers,
    /// Registers that only [`Self::known`] uses.
    caches: Vec<Register>,
    /// Registers of what was known where the loops around were entered.
    entered: Vec<Register>,
    /// The units that are being compiled, the function's own first.
    frames: Vec<Frame>,
    /// What those units' names mean.
    scope: Scope<'p>,
    known: Known,
    /// Values that a register has through all turns of the loops around: every store goes there
    /// too.
    pins: Vec<Entry>,
    /// What the turns of the loops around were found to do, before they were made.
    foreseen: Vec<Effects>,
    /// True if the code does what was not.
    unforeseen: bool,
    /// How many copies of [`Self::known`] are held for later.
    held: u32,
    /// Holds the budget inside of loops that pay for their turns.
    budget: Option<Register>,
    /// True if the code uses the budget.
    metered: bool,
    /// Holds how the statements end, in the function of some that a fault ends.
    outcome: Option<Register>,
}

impl<'s, 'p> Emitter<'s, 'p> {
    pub(crate) fn new(shared: &'s mut Shared<'p>, parameters: Vec<ValType>) -> Self {
        let scope = shared.program.scope();
        Self {
            shared,
            code: Code::default(),
            units: Vec::new(),
            registers: Registers::new(parameters),
            caches: Vec::new(),
            entered: Vec::new(),
            frames: Vec::new(),
            scope,
            known: Known::default(),
            pins: Vec::new(),
            foreseen: Vec::new(),
            unforeseen: false,
            held: 0,
            budget: None,
            metered: false,
            outcome: None,
        }
    }

    pub(crate) fn shared(&self) -> &Shared<'p> {
        self.shared
    }

    pub(crate) fn shared_mut(&mut self) -> &mut Shared<'p> {
        self.shared
    }

    pub(crate) fn program(&self) -> &Program<'p> {
        &self.shared.program
    }

    /// The checker lets nothing come here: if it does after all, the PLC stops at `span`, and says so.
    pub(crate) fn impossible(&mut self, span: Span) {
        self.mark_fault(FaultKind::Internal, span);
        self.emit(Instruction::Unreachable);
    }

    /// What names mean here.
    pub(crate) fn scope(&self) -> &Scope<'p> {
        &self.scope
    }

    /// The elementary type that holds values of `ty`; an address is held like UDINT.
    pub(crate) fn held_as(&self, ty: TypeId) -> ElementaryType {
        self.scope.held_as(ty)
    }

    /// Bytes of a value of the type.
    pub(crate) fn size_of(&self, ty: TypeId) -> u32 {
        self.scope.types().size(ty)
    }

    /// The address of a place without indices that are only known at run time.
    pub(crate) fn fixed_address(&self, place: &Place) -> Option<Address> {
        self.scope.fixed_address(place)
    }

    /// All bytes that the place may stand for; nothing if they may be anywhere.
    pub(crate) fn extent(&self, place: &Place) -> Option<Extent> {
        self.scope.extent(place)
    }

    /// The register that the running unit calls `local`.
    pub(crate) fn register(&self, local: LocalId) -> Register {
        self.scope.register(local)
    }

    /// The unit, if its body goes in the place of a call.
    pub(crate) fn inlinable(&self, pou: PouId) -> Option<&'p Pou> {
        self.program().inlined(pou, &self.scope)
    }

    /// The function of a unit.
    pub(crate) fn finish(mut self, id: PouId) -> Made {
        let is_guarded = self.program().pou(id).is_some_and(|pou| pou.guard != Guard::None);
        let call = self.finish_code(is_guarded);
        self.shared.program.found(id, call, self.metered);
        self.made()
    }

    /// The function of statements that a fault ends: the host calls it, so it pays for itself.
    pub(crate) fn finish_try(mut self) -> Made {
        self.finish_code(true);
        self.made()
    }

    /// Ends the code; returns what is left to pay for callers.
    fn finish_code(&mut self, pays_itself: bool) -> u64 {
        debug_assert_eq!(self.frames.len(), 1, "units that were put in the place of calls have been left");
        debug_assert_eq!(self.held, 0, "all ways have come together");
        debug_assert!(self.foreseen.is_empty() && self.pins.is_empty(), "all loops have ended");
        debug_assert!(self.budget.is_none(), "the budget stands in its global between two functions");
        self.emit(Instruction::End);
        self.pay_at_entry(pays_itself)
    }

    fn made(self) -> Made {
        let (body, marks) = self.code.finish(self.registers.locals());
        Made { body, marks, units: self.units }
    }
}
