//! Where places lie, as far as it is known while compiling.

use std::collections::BTreeMap;

use super::registers::Register;

/// What an offset counts from. Every use of a base agrees on what it means.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Base {
    /// The beginning of memory.
    Memory,
    /// The address in a register.
    Register(Register),
}

/// An address known but for its base.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Address {
    pub(super) base: Base,
    pub(super) offset: u32,
}

impl Address {
    pub(super) fn absolute(offset: u32) -> Self {
        Self { base: Base::Memory, offset }
    }

    pub(super) fn of_register(register: Register) -> Self {
        Self { base: Base::Register(register), offset: 0 }
    }

    /// So many bytes further.
    pub(super) fn further(self, bytes: u32) -> Self {
        Self { offset: self.offset.saturating_add(bytes), ..self }
    }
}

/// Bytes that an access touches at most: from the address up to `end`, which counts from the
/// same base.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Extent {
    pub(super) base: Base,
    pub(super) start: u32,
    pub(super) end: u32,
}

impl Extent {
    pub(super) fn new(address: Address, size: u32) -> Self {
        let Address { base, offset } = address;
        Self { base, start: offset, end: offset.saturating_add(size) }
    }
}

/// Where the addresses in registers lead, for those of which it is known.
#[derive(Debug, Clone, Default)]
pub(super) struct Roots {
    known: BTreeMap<Register, Extent>,
}

impl Roots {
    /// The register points into `extent`, and whatever is reached through it lies there.
    pub(super) fn lead(&mut self, register: Register, extent: Option<Extent>) {
        match extent.map(|extent| self.widest(extent)) {
            Some(extent) if extent.base != Base::Register(register) => self.known.insert(register, extent),
            _ => self.known.remove(&register),
        };
    }

    fn widest(&self, extent: Extent) -> Extent {
        match extent.base {
            Base::Register(register) => self.known.get(&register).copied().unwrap_or(extent),
            Base::Memory => extent,
        }
    }

    /// The extent counted from a base that stays, if the register it counts from is one `set`
    /// anew.
    pub(super) fn settled(&self, extent: Extent, set: impl Fn(Register) -> bool) -> Extent {
        match extent.base {
            Base::Register(register) if set(register) => self.widest(extent),
            _ => extent,
        }
    }

    /// True unless the two have no byte in common for sure. Of two bases nothing is known, as a
    /// block's instance may lie in any other unit's memory.
    pub(super) fn overlap(&self, left: Extent, right: Extent) -> bool {
        let (left, right) =
            if left.base == right.base { (left, right) } else { (self.widest(left), self.widest(right)) };
        left.base != right.base || (left.start < right.end && right.start < left.end)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_may_overlap() {
        let extent = |base, start, end| Extent { base, start, end };
        let (one, two) = (Base::Register(Register(1)), Base::Register(Register(2)));
        let mut roots = Roots::default();
        assert!(roots.overlap(extent(Base::Memory, 0, 4), extent(Base::Memory, 3, 5)));
        assert!(!roots.overlap(extent(Base::Memory, 0, 4), extent(Base::Memory, 4, 5)));
        assert!(roots.overlap(extent(Base::Memory, 0, 4), extent(one, 400, 500)), "nothing is known of 1");
        roots.lead(Register(1), Some(extent(Base::Memory, 100, 200)));
        assert!(!roots.overlap(extent(Base::Memory, 0, 4), extent(one, 0, 4)));
        assert!(roots.overlap(extent(Base::Memory, 196, 204), extent(one, 0, 4)));
        roots.lead(Register(2), Some(extent(one, 0, 50)));
        assert!(roots.overlap(extent(two, 0, 4), extent(one, 8, 12)), "2 points anywhere into what 1 does");
        roots.lead(Register(1), None);
        assert!(roots.overlap(extent(Base::Memory, 0, 4), extent(one, 0, 4)));
    }
}
