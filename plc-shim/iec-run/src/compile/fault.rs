//! What stops the PLC, and where in the source.

use std::fmt;

use onescan_iec::syntax::Span;

/// Why the PLC stopped (2nd ed. Annex E lists the errors).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum FaultKind {
    /// An integer or real number was divided by zero.
    DivisionByZero,
    /// An index was outside of its array.
    IndexOutOfRange,
    /// The selector of MUX was outside of its inputs.
    SelectorOutOfRange,
    /// A FOR statement's step was 0.
    ZeroStep,
    /// A task used up its budget of instructions.
    EndlessLoop,
    /// Units called each other too deep.
    CallTooDeep,
    /// The runtime itself failed; a defect, not the program's fault.
    Internal,
    /// A value was assigned that its subrange type does not have.
    OutOfSubrange,
    /// What a reference refers to was used, and it refers to nothing (3rd ed. 6.4.4.10.4).
    NullReference,
    /// A pointer led out of memory.
    InvalidPointer,
    /// A unit with fixed memory was called while it ran, in a way that only the run decides.
    Reentered,
}

impl FaultKind {
    /// Every kind; the position of a kind is its number in a saved state.
    pub const ALL: [Self; 11] = [
        Self::DivisionByZero,
        Self::IndexOutOfRange,
        Self::SelectorOutOfRange,
        Self::ZeroStep,
        Self::EndlessLoop,
        Self::CallTooDeep,
        Self::Internal,
        Self::OutOfSubrange,
        Self::NullReference,
        Self::InvalidPointer,
        Self::Reentered,
    ];
}

const _: () = {
    let mut at = 0;
    while at < FaultKind::ALL.len() {
        assert!(FaultKind::ALL[at] as usize == at, "the position of a kind is its number in a saved state");
        at += 1;
    }
};

impl fmt::Display for FaultKind {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::DivisionByZero => "division by zero",
            Self::IndexOutOfRange => "array index out of range",
            Self::SelectorOutOfRange => "selector out of range",
            Self::ZeroStep => "FOR with a step of 0",
            Self::EndlessLoop => "endless or very long loop",
            Self::CallTooDeep => "calls nested too deep",
            Self::Internal => "internal error",
            Self::OutOfSubrange => "value out of subrange",
            Self::NullReference => "use of a NULL reference",
            Self::InvalidPointer => "pointer out of memory",
            Self::Reentered => "a unit was called while it ran",
        })
    }
}

/// What an instruction stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Mark {
    pub(crate) span: Span,
    pub(crate) kind: MarkKind,
    /// The unit that the instruction belongs to, by its place in [`FunctionMarks::units`].
    pub(crate) unit: u32,
}

/// A unit that a function is made of: its own, or one put in the place of a call.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Unit {
    pub(crate) name: String,
    /// The call, of the unit that contains it.
    pub(crate) caller: Option<(u32, Callee, Span)>,
}

/// What the instruction at a mark does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum MarkKind {
    /// A statement begins here.
    Statement,
    /// The fault if this very instruction traps.
    Fault(FaultKind),
    Call(Callee),
    /// It is a branch that is taken as a rule.
    Likely,
}

/// What is called, for the path to where a fault is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Callee {
    Function,
    /// An instance inside of the running one; the mark's span is its name.
    Inner,
    /// An instance that is a global variable; the mark's span is its name.
    Global,
    /// Statements of the calling unit itself, which a fault ends.
    Itself,
}

/// The marks of one function by offset in its body, in order.
#[derive(Debug, Clone, Default)]
pub(crate) struct FunctionMarks {
    /// The function's own unit, then those inlined.
    pub(crate) units: Vec<Unit>,
    /// It is what a task runs; its unit's name is that of an instance.
    pub(crate) is_entry: bool,
    pub(crate) marks: Vec<(u32, Mark)>,
}

impl FunctionMarks {
    /// The fault of the trapping instruction at `offset`.
    pub(crate) fn fault_at(&self, offset: u32) -> Option<(FaultKind, Mark)> {
        self.marks_at(offset).find_map(|mark| match mark.kind {
            MarkKind::Fault(fault) => Some((fault, mark)),
            _ => None,
        })
    }

    /// What the instruction at `offset` calls.
    pub(crate) fn call_at(&self, offset: u32) -> Option<(Callee, Mark)> {
        self.marks_at(offset).find_map(|mark| match mark.kind {
            MarkKind::Call(callee) => Some((callee, mark)),
            _ => None,
        })
    }

    /// Where branches are that are taken as a rule.
    pub(crate) fn likely(&self) -> impl Iterator<Item = u32> {
        self.marks.iter().filter(|(_, mark)| mark.kind == MarkKind::Likely).map(|(at, _)| *at)
    }

    fn marks_at(&self, offset: u32) -> impl Iterator<Item = Mark> {
        debug_assert!(self.marks.is_sorted_by_key(|(at, _)| *at), "marks lie in the order of their offsets");
        let first = self.marks.partition_point(|(at, _)| *at < offset);
        let here = self.marks.iter().skip(first).take_while(move |(at, _)| *at == offset);
        here.map(|(_, mark)| *mark)
    }

    /// The last statement that begins at or before `offset`.
    pub(crate) fn statement_before(&self, offset: u32) -> Option<Mark> {
        debug_assert!(self.marks.is_sorted_by_key(|(at, _)| *at), "marks lie in the order of their offsets");
        let end = self.marks.partition_point(|(at, _)| *at <= offset);
        let before = self.marks.iter().take(end).rev();
        before.map(|(_, mark)| *mark).find(|mark| mark.kind == MarkKind::Statement)
    }
}

/// The marks of all functions by their index.
#[derive(Debug, Clone, Default)]
pub(crate) struct FaultTable {
    pub(crate) first_function: u32,
    pub(crate) functions: Vec<FunctionMarks>,
}

impl FaultTable {
    pub(crate) fn function(&self, index: u32) -> Option<&FunctionMarks> {
        let index = index.checked_sub(self.first_function)?;
        self.functions.get(index as usize)
    }
}
