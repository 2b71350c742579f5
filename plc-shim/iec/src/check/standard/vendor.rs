//! Functions of vendors' controllers that have no equal here, and enumerations that vendors know their own way.

use crate::diagnostic::Code;
use crate::dialect::WordSize;
use crate::ir::ElementaryType;

/// Functions of vendors' controllers that have no equal here, by how their names begin, and what to use.
pub(in crate::check) const VENDOR_FUNCTIONS: [(&str, Code, &str); 17] = [
    ("S_PULSE", Code::ClassicTimer, "use TP"),
    ("S_PEXT", Code::ClassicTimer, "use TP"),
    ("S_ODTS", Code::ClassicTimer, "use TON"),
    ("S_ODT", Code::ClassicTimer, "use TON"),
    ("S_OFFDT", Code::ClassicTimer, "use TOF"),
    ("S_CUD", Code::ClassicTimer, "use CTUD"),
    ("S_CU", Code::ClassicTimer, "use CTU"),
    ("S_CD", Code::ClassicTimer, "use CTD"),
    ("PEEK", Code::VendorRuntime, "declare a variable and use that"),
    ("POKE", Code::VendorRuntime, "declare a variable and use that"),
    ("SYSTIME", Code::VendorRuntime, "TIME() gives virtual time"),
    ("TIME_TCK", Code::VendorRuntime, "use a timer: it counts virtual time"),
    (
        "__VARINFO",
        Code::VendorRuntime,
        "write what you need of the variable as text: its name, its type, SIZEOF(variable)",
    ),
    ("__XADD", Code::VendorRuntime, "add without it: tasks do not interrupt one another here"),
    ("__COMPARE_AND_SWAP", Code::VendorRuntime, "write IF: tasks do not interrupt one another here"),
    ("__NEW", Code::VendorRuntime, "CODESYS and TwinCAT have it: --dialect chooses"),
    ("__DELETE", Code::VendorRuntime, "CODESYS and TwinCAT have it: --dialect chooses"),
];

/// Enumerations of vendors' libraries (`{attribute 'qualified_only'}`).
const QUALIFIED_ONLY: [&str; 2] = ["TcEventSeverity", "TcEventConfirmationState"];

/// True for an enumeration of a library whose values are known behind its name only.
pub fn is_qualified_only(name: &str) -> bool {
    QUALIFIED_ONLY.iter().any(|known| known.eq_ignore_ascii_case(name))
}

/// Vendors' names of the types that are as wide as a register of the target, which is as wide as its pointers. One that
/// holds a pointer keeps the address.
pub fn of_pointer_width(key: &str, target: WordSize) -> Option<ElementaryType> {
    let is_long = target == WordSize::Bits64;
    Some(match key {
        "__XWORD" | "XWORD" if is_long => ElementaryType::Lword,
        "__XWORD" | "XWORD" => ElementaryType::Dword,
        "__UXINT" | "UXINT" | "PVOID" if is_long => ElementaryType::Ulint,
        "__UXINT" | "UXINT" | "PVOID" => ElementaryType::Udint,
        "__XINT" | "XINT" if is_long => ElementaryType::Lint,
        "__XINT" | "XINT" => ElementaryType::Dint,
        _ => return None,
    })
}
