//! A string in memory.

use onescan_iec::dialect::StringMemory;
use onescan_iec::ir::text::TextShape;

/// An address outside of memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Outside;

/// Where a string lies and how many characters it has.
#[derive(Debug, Clone, Copy)]
pub(super) struct View {
    /// Offset of the first character.
    start: usize,
    shape: TextShape,
    pub(super) used: usize,
}

impl View {
    /// The string at `address`. More characters than there is room for are not seen.
    pub(super) fn new(memory: &[u8], address: i32, code: i32) -> Result<Self, Outside> {
        let shape = TextShape::from_code(code);
        if shape.capacity == 0 {
            return Ok(Self { start: 0, shape, used: 0 });
        }
        let address = address.cast_unsigned() as usize;
        let end = address.checked_add(shape.size() as usize).ok_or(Outside)?;
        let bytes = memory.get(address..end).ok_or(Outside)?;
        Ok(Self { start: address + shape.first() as usize, shape, used: shape.used(bytes) })
    }

    /// The characters in use of a STRING; nothing of a WSTRING.
    pub(super) fn narrow<'m>(&self, memory: &'m [u8]) -> Option<&'m [u8]> {
        if self.shape.wide { None } else { memory.get(self.start..self.start + self.used) }
    }

    /// The character at a position from 0.
    pub(super) fn get(&self, memory: &[u8], index: usize) -> u16 {
        let byte = |at: usize| memory.get(at).copied().map_or(0, u16::from);
        if self.shape.wide {
            let at = self.start + 2 * index;
            byte(at) | byte(at + 1) << 8
        } else {
            byte(self.start + index)
        }
    }
}

/// A string that is being written.
pub(super) struct Target {
    address: usize,
    shape: TextShape,
    used: usize,
}

impl Target {
    pub(super) fn new(memory: &[u8], address: i32, code: i32) -> Result<Self, Outside> {
        let shape = TextShape::from_code(code);
        let address = address.cast_unsigned() as usize;
        let end = address.checked_add(shape.size() as usize).ok_or(Outside)?;
        if memory.len() < end {
            return Err(Outside);
        }
        Ok(Self { address, shape, used: 0 })
    }

    fn offset(&self, index: usize) -> usize {
        self.address + self.shape.first() as usize + index * self.shape.unit() as usize
    }

    /// Adds a character if there is room. One beyond 8 bits becomes `?` in a STRING.
    pub(super) fn push(&mut self, memory: &mut [u8], unit: u16) {
        debug_assert!(self.used <= self.shape.capacity as usize, "a string never has more than there is room for");
        if self.used == self.shape.capacity as usize {
            return;
        }
        let at = self.offset(self.used);
        self.used += 1;
        let unit = if !self.shape.wide && unit > 0xff { u16::from(b'?') } else { unit };
        for (target, source) in memory.iter_mut().skip(at).zip(unit.to_le_bytes()).take(self.shape.unit() as usize) {
            *target = source;
        }
    }

    /// Adds ASCII characters.
    pub(super) fn append(&mut self, memory: &mut [u8], text: &[u8]) {
        if self.shape.wide {
            return text.iter().for_each(|byte| self.push(memory, u16::from(*byte)));
        }
        let count = text.len().min(self.shape.capacity as usize - self.used);
        let at = self.offset(self.used);
        if let (Some(room), Some(text)) = (memory.get_mut(at..at + count), text.get(..count)) {
            room.copy_from_slice(text);
            self.used += count;
        }
    }

    /// Adds characters of another string.
    pub(super) fn extend(&mut self, memory: &mut [u8], source: &View, range: std::ops::Range<usize>) {
        let count = range.len().min(self.shape.capacity as usize - self.used);
        if source.shape.wide == self.shape.wide {
            let unit = self.shape.unit() as usize;
            let from = source.start + range.start * unit;
            let to = self.offset(self.used);
            let bytes = count * unit;
            if from + bytes <= memory.len() && to + bytes <= memory.len() {
                memory.copy_within(from..from + bytes, to);
            }
            self.used += count;
            return;
        }
        for index in range.take(count) {
            let unit = source.get(memory, index);
            self.push(memory, unit);
        }
    }

    /// Writes the count, if there is one, and clears what lies behind the last character.
    pub(super) fn finish(self, memory: &mut [u8]) {
        debug_assert!(self.used <= self.shape.capacity as usize, "a string never has more than there is room for");
        let (first, end) = (self.offset(self.used), self.address + self.shape.size() as usize);
        if let Some(rest) = memory.get_mut(first..end) {
            rest.fill(0);
        }
        if self.shape.memory == StringMemory::ZeroTerminated {
            return;
        }
        if let Some(count) = memory.get_mut(self.address..self.address + 2) {
            count.copy_from_slice(&(self.used as u16).to_le_bytes());
        }
    }
}
