//! Strings that end with a 0 in the PLC's memory, and have a count in front as the value of a signal.

use onescan_iec::dialect::StringMemory;
use onescan_iec::ir::text::TextShape;

/// A string in memory as CODESYS and TwinCAT have it: its characters, then a 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ZeroTerminated {
    shape: TextShape,
}

impl ZeroTerminated {
    pub(super) fn of(shape: TextShape) -> Option<Self> {
        (shape.memory == StringMemory::ZeroTerminated).then_some(Self { shape })
    }

    /// Bytes that it takes in memory, the 0 at its end among them.
    pub fn size(self) -> usize {
        self.shape.size() as usize
    }

    /// Writes the value of a signal into memory; more than there is room for is left out.
    pub fn give(self, signal: &[u8], memory: &mut [u8]) {
        let counted = TextShape { memory: StringMemory::Counted, ..self.shape };
        let used = counted.used(signal) * self.shape.unit() as usize;
        memory.fill(0);
        // A value without characters ends with its count.
        let characters = signal.get(counted.first() as usize..).unwrap_or_default();
        for (target, source) in memory.iter_mut().zip(characters.iter().take(used)) {
            *target = *source;
        }
    }

    /// Reads the value of a signal out of memory.
    pub fn take(self, memory: &[u8], signal: &mut [u8]) {
        let used = self.shape.used(memory);
        signal.fill(0);
        let (count, characters) = signal.split_at_mut(signal.len().min(2));
        count.iter_mut().zip((used as u16).to_le_bytes()).for_each(|(target, byte)| *target = byte);
        let bytes = memory.iter().take(used * self.shape.unit() as usize);
        characters.iter_mut().zip(bytes).for_each(|(target, byte)| *target = *byte);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_goes_there_and_back() {
        for wide in [false, true] {
            let shape = TextShape { wide, capacity: 3, memory: StringMemory::ZeroTerminated };
            let counted = TextShape { memory: StringMemory::Counted, ..shape };
            let text = ZeroTerminated::of(shape).expect("it ends with a 0");
            assert_eq!(ZeroTerminated::of(counted), None);
            for units in [&[][..], &[0x41], &[0x41, 0x42, 0x43]] {
                let (signal, memory) = (counted.encode(units), shape.encode(units));
                let (mut back, mut there) = (vec![9; signal.len()], vec![9; text.size()]);
                text.take(&memory, &mut back);
                text.give(&signal, &mut there);
                assert_eq!((back, there), (signal, memory));
            }
        }
    }
}
