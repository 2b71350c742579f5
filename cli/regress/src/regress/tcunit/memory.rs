//! Values of variables by path, out of a PLC's memory.

use onescan_iec_run::{Application, Variable};

use super::super::memory_text::characters;

/// The memory of a PLC, by the names of its application.
#[derive(Clone, Copy)]
pub(super) struct View<'a> {
    pub(super) application: &'a Application,
    memory: &'a [u8],
    /// What an instance that is read lies behind the one that is named.
    shift: i64,
}

impl<'a> View<'a> {
    pub(super) fn new(application: &'a Application, memory: &'a [u8]) -> Self {
        Self { application, memory, shift: 0 }
    }

    /// The same names for the instance at `address`, of the one that is named and begins at `named`.
    pub(super) fn moved(self, named: u32, address: u64) -> Self {
        Self { shift: i64::try_from(address).unwrap_or(i64::MAX).saturating_sub(i64::from(named)), ..self }
    }

    /// The bytes of a variable; nothing if it is not there.
    fn bytes(&self, path: &str) -> Option<(Variable, &'a [u8])> {
        let variable = self.application.variable(path).ok()?;
        let start = usize::try_from(i64::from(variable.offset).checked_add(self.shift)?).ok()?;
        let bytes = self.memory.get(start..start.checked_add(variable.size as usize)?)?;
        Some((variable, bytes))
    }

    pub(super) fn number(&self, path: &str) -> Option<u64> {
        self.bytes(path).map(|(_, bytes)| number(bytes))
    }

    pub(super) fn is_true(&self, path: &str) -> bool {
        self.number(path).is_some_and(|value| value != 0)
    }

    pub(super) fn real(&self, path: &str) -> Option<f64> {
        self.bytes(path).and_then(|(_, bytes)| bytes.try_into().ok()).map(f64::from_le_bytes)
    }

    pub(super) fn text(&self, path: &str) -> Option<String> {
        self.bytes(path).and_then(|(variable, bytes)| characters(&variable, bytes))
    }

    /// The value of an enumeration by its name.
    pub(super) fn name(&self, path: &str) -> Option<String> {
        let (mut variable, bytes) = self.bytes(path)?;
        variable.offset = 0;
        Some(self.application.value_text(&variable, bytes))
    }
}

/// A number in memory, the low byte first.
pub(super) fn number(bytes: &[u8]) -> u64 {
    bytes.iter().rev().take(8).fold(0, |value, byte| value << 8 | u64::from(*byte))
}
