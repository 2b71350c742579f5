//! The areas that direct addresses lie in (2nd ed. 2.4.1.1).

use crate::syntax::direct_address::Area;

/// A place in an area. Where the area begins is known once all units have been checked.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Location {
    pub area: Area,
    pub offset: u32,
    /// The bit of the byte there; nothing for what takes whole bytes.
    pub bit: Option<u8>,
}

/// How large the areas are and where they begin. Each is as large as what is used of it.
#[derive(Debug, Clone, Copy, Default)]
pub struct Areas {
    sizes: [u32; 3],
    bases: [u32; 3],
}

/// Areas begin where every type may lie.
const ALIGN: u32 = 8;

impl Areas {
    /// Makes room for `size` bytes at `location`.
    pub fn extend(&mut self, location: Location, size: u32) {
        let end = location.offset.saturating_add(size);
        let known = &mut self.sizes[location.area as usize];
        *known = (*known).max(end);
    }

    /// Puts the areas behind `next`, one after the other; gives the byte behind the last.
    pub fn place(&mut self, mut next: u32) -> u32 {
        for (base, size) in self.bases.iter_mut().zip(self.sizes) {
            if size > 0 {
                *base = next.next_multiple_of(ALIGN);
                next = *base + size;
            }
        }
        next
    }

    /// Where in memory a location is.
    pub fn offset(&self, location: Location) -> u32 {
        self.bases[location.area as usize] + location.offset
    }

    /// What of memory an area takes.
    pub fn range(&self, area: Area) -> std::ops::Range<u32> {
        let base = self.bases[area as usize];
        base..base + self.sizes[area as usize]
    }

    /// True if `size` bytes at `location` are in use.
    pub fn has(&self, location: Location, size: u32) -> bool {
        location.offset.checked_add(size).is_some_and(|end| end <= self.sizes[location.area as usize])
    }
}
