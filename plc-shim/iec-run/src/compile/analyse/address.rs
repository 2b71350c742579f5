//! Where places lie, as far as it is known while compiling.

use std::collections::BTreeMap;

/// A local of the function that is being made. Who makes the function numbers them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Register(u32);

impl Register {
    pub(crate) fn new(number: u32) -> Self {
        Self(number)
    }

    pub(crate) fn number(self) -> u32 {
        self.0
    }
}

/// What an offset counts from. Every use of a base agrees on what it means.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Base {
    /// The beginning of memory.
    Memory,
    /// The address in a register.
    Register(Register),
}

/// An address, known except for where its base is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Address {
    pub(crate) base: Base,
    pub(crate) offset: u32,
}

impl Address {
    pub(crate) fn absolute(offset: u32) -> Self {
        Self { base: Base::Memory, offset }
    }

    pub(crate) fn of_register(register: Register) -> Self {
        Self { base: Base::Register(register), offset: 0 }
    }

    /// So many bytes further.
    pub(crate) fn further(self, bytes: u32) -> Self {
        Self { offset: self.offset.saturating_add(bytes), ..self }
    }
}

/// Bytes that an access touches at most: from the address up to `end`, which counts from the
/// same base.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Extent {
    pub(crate) base: Base,
    pub(crate) start: u32,
    pub(crate) end: u32,
}

impl Extent {
    pub(crate) fn new(address: Address, size: u32) -> Self {
        let Address { base, offset } = address;
        Self { base, start: offset, end: offset.saturating_add(size) }
    }
}

/// Where the addresses in registers lead, for those of which it is known.
#[derive(Debug, Clone, Default)]
pub(crate) struct Roots {
    known: BTreeMap<Register, Extent>,
}

impl Roots {
    /// The register points into `extent`, and whatever is reached through it lies there.
    pub(crate) fn lead(&mut self, register: Register, extent: Option<Extent>) {
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
    /// again.
    pub(crate) fn settled(&self, extent: Extent, set: impl Fn(Register) -> bool) -> Extent {
        match extent.base {
            Base::Register(register) if set(register) => self.widest(extent),
            _ => extent,
        }
    }

    /// True unless the two have no byte in common for sure. Of two bases nothing is known, as a
    /// block's instance may lie in any other unit's memory.
    pub(crate) fn overlap(&self, left: Extent, right: Extent) -> bool {
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
