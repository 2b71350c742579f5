//! Strings out of a PLC's memory.

use onescan_iec::SignalType;
use onescan_iec_run::Variable;

/// The characters of a string, whose code is that of Latin-1; nothing if the variable is none.
pub(super) fn text(variable: &Variable, memory: &[u8]) -> Option<String> {
    characters(variable, bytes(variable, memory)?)
}

/// The bytes of a variable; nothing if it does not lie in the memory.
pub(super) fn bytes<'m>(variable: &Variable, memory: &'m [u8]) -> Option<&'m [u8]> {
    let start = variable.offset as usize;
    memory.get(start..start.checked_add(variable.size as usize)?)
}

/// The same, of the bytes where the variable lies.
pub(super) fn characters(variable: &Variable, bytes: &[u8]) -> Option<String> {
    if !matches!(variable.signal_type, Some(SignalType::String(_))) {
        return None;
    }
    let mut counted = vec![0; bytes.len() + 2];
    match variable.zero_terminated {
        Some(form) => form.take(bytes, &mut counted),
        None => counted.get_mut(..bytes.len())?.copy_from_slice(bytes),
    }
    let (count, characters) = counted.split_at_checked(2)?;
    let count = usize::from(u16::from_le_bytes(count.try_into().ok()?));
    Some(characters.iter().take(count).copied().map(char::from).collect())
}
