//! What names mean at one place of a function: where variables and pointers lead, in the unit that
//! the function is made for and in those put in the place of calls.

use std::collections::BTreeMap;

use super::address::{Address, Extent, Register, Roots};
use super::range::{Interval, Slot};
use super::size::leaves;
use onescan_iec::ir::{
    Areas, Argument, ElementaryType, Expr, ExprKind, LocalId, Place, PouId, Statement, Step, Storage, TypeId,
    TypeTable, Value,
};

/// Register of the running instance's address.
pub(crate) const INSTANCE: LocalId = LocalId(0);

/// A constant index, if it lies inside of its array.
pub(crate) fn constant_index(index: &Expr, low: i64, count: u32) -> Option<u32> {
    match index.kind {
        ExprKind::Constant(Value::Int(value)) => {
            u32::try_from(value - i128::from(low)).ok().filter(|position| *position < count)
        }
        _ => None,
    }
}

/// The terms of one unit.
#[derive(Debug, Clone)]
struct Terms {
    pou: PouId,
    /// The unit's registers, by its own names for them.
    registers: Vec<Register>,
    /// Pointers whose address is known without their register.
    pointers: BTreeMap<LocalId, Address>,
}

/// The units around a place, the function's own first, and what is known of their variables whatever
/// the way to that place was.
#[derive(Debug, Clone)]
pub(crate) struct Scope<'p> {
    types: &'p TypeTable,
    areas: Areas,
    units: Vec<Terms>,
    roots: Roots,
    /// Control variables of the loops around, which their bodies do not change, with their ranges.
    counters: Vec<(Slot, Interval)>,
    /// How many branches are around that leave their unit.
    leaving: u32,
}

impl<'p> Scope<'p> {
    pub(crate) fn new(types: &'p TypeTable, areas: Areas) -> Self {
        Self { types, areas, units: Vec::new(), roots: Roots::default(), counters: Vec::new(), leaving: 0 }
    }

    /// Names are from here on those of this unit.
    pub(crate) fn enter(&mut self, pou: PouId, registers: Vec<Register>) {
        self.units.push(Terms { pou, registers, pointers: BTreeMap::new() });
    }

    /// Names are again those of the unit around. Gives back the registers of the one that was left:
    /// nothing is known of them any more.
    pub(crate) fn leave(&mut self) -> Vec<Register> {
        debug_assert!(!self.units.is_empty(), "only a unit that was entered is left");
        let registers = self.units.pop().map_or_else(Vec::new, |terms| terms.registers);
        for register in &registers {
            self.roots.lead(*register, None);
        }
        registers
    }

    /// The unit that names belong to.
    pub(crate) fn unit(&self) -> Option<PouId> {
        self.units.last().map(|terms| terms.pou)
    }

    /// All units around, the function's own first.
    pub(crate) fn units(&self) -> impl Iterator<Item = PouId> {
        self.units.iter().map(|terms| terms.pou)
    }

    pub(crate) fn types(&self) -> &'p TypeTable {
        self.types
    }

    /// The elementary type that holds values of `ty`; an address is held like UDINT.
    pub(crate) fn held_as(&self, ty: TypeId) -> ElementaryType {
        self.types.elementary(ty).unwrap_or(ElementaryType::Udint)
    }

    /// The register that the unit calls `local`. The checker makes no names without one; a function that
    /// has no registers at all is never asked.
    pub(crate) fn register(&self, local: LocalId) -> Register {
        let known = self.units.last().and_then(|terms| terms.registers.get(local.0 as usize));
        known.copied().unwrap_or(Register::new(local.0))
    }

    /// The pointer leads to this address from here on, whatever its register holds.
    pub(crate) fn point(&mut self, pointer: LocalId, address: Address) {
        if let Some(terms) = self.units.last_mut() {
            terms.pointers.insert(pointer, address);
        }
    }

    /// Only its register says from here on where the pointer leads.
    pub(crate) fn unpoint(&mut self, pointer: LocalId) {
        if let Some(terms) = self.units.last_mut() {
            terms.pointers.remove(&pointer);
        }
    }

    /// The address of a pointer's target, as far as it is known.
    pub(crate) fn pointer(&self, local: LocalId) -> Address {
        let known = self.units.last().and_then(|terms| terms.pointers.get(&local)).copied();
        known.unwrap_or_else(|| Address::of_register(self.register(local)))
    }

    pub(crate) fn roots(&self) -> &Roots {
        &self.roots
    }

    /// The register points into `extent`, and whatever is reached through it lies there; nothing is known of
    /// it without one.
    pub(crate) fn lead(&mut self, register: Register, extent: Option<Extent>) {
        self.roots.lead(register, extent);
    }

    /// A loop's body begins that leaves this variable alone, in which it lies between these.
    pub(crate) fn open_counter(&mut self, slot: Slot, interval: Interval) {
        self.counters.push((slot, interval));
    }

    pub(crate) fn close_counter(&mut self) {
        debug_assert!(!self.counters.is_empty(), "only a loop that was opened ends");
        self.counters.pop();
    }

    /// Between what the control variable of a loop around lies, if it is one.
    pub(crate) fn counter(&self, slot: Slot) -> Option<Interval> {
        self.counters.iter().rev().find(|(known, _)| *known == slot).map(|(_, interval)| *interval)
    }

    /// A branch begins.
    pub(crate) fn open_branch(&mut self, body: &[Statement]) {
        self.leaving += u32::from(leaves(body));
    }

    pub(crate) fn close_branch(&mut self, body: &[Statement]) {
        debug_assert!(self.leaving >= u32::from(leaves(body)), "only a branch that was opened ends");
        self.leaving -= u32::from(leaves(body));
    }

    /// True in a branch that leaves its unit: it is for the exception.
    pub(crate) fn is_leaving(&self) -> bool {
        self.leaving > 0
    }

    /// Where the variable begins; nothing if its address stands in memory or it has none.
    pub(crate) fn beginning(&self, storage: Storage) -> Option<Address> {
        match storage {
            Storage::Absolute(offset) => Some(Address::absolute(offset)),
            Storage::Located(location) => Some(Address::absolute(self.areas.offset(location))),
            Storage::Instance(offset) => Some(self.pointer(INSTANCE).further(offset)),
            Storage::RegisterPointer(register) => Some(self.pointer(register)),
            Storage::InstancePointer(_) | Storage::AbsolutePointer(_) | Storage::Register(_) | Storage::Referred => {
                None
            }
        }
    }

    /// The address of a place without indices that are only known at run time.
    pub(crate) fn fixed_address(&self, place: &Place) -> Option<Address> {
        let mut address = self.beginning(place.storage)?;
        for step in &place.steps {
            address = match step {
                Step::Offset(further) => address.further(*further),
                Step::Index { index, low, count, stride } => {
                    address.further(constant_index(index, *low, *count)? * stride)
                }
                Step::Pointer { .. } | Step::Open { .. } => return None,
            };
        }
        Some(address)
    }

    /// All bytes that the place may stand for, whatever its indices are; nothing if they may be anywhere.
    pub(crate) fn extent(&self, place: &Place) -> Option<Extent> {
        let mut address = self.beginning(place.storage)?;
        let mut size = self.types.size(place.ty);
        for step in &place.steps {
            match step {
                Step::Offset(further) => address = address.further(*further),
                Step::Index { index, low, count, stride } => match constant_index(index, *low, *count) {
                    Some(position) => address = address.further(position * stride),
                    None => size = size.saturating_add(count.saturating_sub(1).saturating_mul(*stride)),
                },
                Step::Pointer { .. } | Step::Open { .. } => return None,
            }
        }
        Some(Extent::new(address, size))
    }

    /// The variable, if its place is known and it shares its bytes with no other.
    pub(crate) fn slot(&self, place: &Place) -> Option<Slot> {
        match place.storage {
            _ if place.part.is_some() => None,
            Storage::Register(local) => Some(Slot::Register(self.register(local))),
            _ => self.fixed_address(place).map(Slot::Memory),
        }
    }

    /// Where what a function is given leads, if it is given an address: the address itself, if it is known, and the
    /// bytes that it lies in.
    pub(crate) fn argument(&self, argument: &Argument) -> (Option<Address>, Option<Extent>) {
        match argument {
            Argument::Reference(place) => (self.fixed_address(place), self.extent(place)),
            Argument::Value(Expr { kind: ExprKind::Load(place), ty, .. }) if self.types.elementary(*ty).is_none() => {
                (self.fixed_address(place), self.extent(place))
            }
            Argument::Value(_) => (None, None),
        }
    }
}
