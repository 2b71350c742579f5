//! Vendors' functions on bytes at addresses: of TwinCAT's `Tc2_System` and CODESYS' `SysMem`.

use crate::ir::MemoryFunction;

/// Names in capitals, what they do, and their parameters in their order.
pub(in crate::check) const FUNCTIONS: [(&str, MemoryFunction, [&str; 3]); 7] = [
    ("MEMCPY", MemoryFunction::Copy, ["DESTADDR", "SRCADDR", "N"]),
    ("MEMMOVE", MemoryFunction::Copy, ["DESTADDR", "SRCADDR", "N"]),
    ("MEMSET", MemoryFunction::Fill, ["DESTADDR", "FILLBYTE", "N"]),
    ("MEMCMP", MemoryFunction::Compare, ["PBUF1", "PBUF2", "N"]),
    ("SYSMEMCPY", MemoryFunction::Copy, ["PDEST", "PSRC", "ULCOUNT"]),
    ("SYSMEMSET", MemoryFunction::Fill, ["PDEST", "IVALUE", "ULCOUNT"]),
    ("SYSMEMCMP", MemoryFunction::Compare, ["PBUFFER1", "PBUFFER2", "ULCOUNT"]),
];

/// True for the name of one, in capitals. A user's own function goes before.
pub(crate) fn exists(key: &str) -> bool {
    FUNCTIONS.iter().any(|(name, ..)| *name == key)
}
