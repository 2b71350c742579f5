//! What holds for any bytes in a source file of any kind: the front end neither panics nor hangs, and what parses is
//! printed so that it parses to the same text again.

use onescan_iec::Input;
use onescan_iec::input::kind::SourceKind;
use onescan_iec::inspect;
use onescan_iec::syntax::printer::print_unit;
use onescan_iec::syntax::{FileId, parse};

/// What came of a source.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Outcome {
    /// It was program text without an error of syntax.
    pub(crate) parsed: bool,
    /// No error was found at all.
    pub(crate) sound: bool,
}

/// Reads, parses and checks a source.
///
/// # Panics
/// If what is printed is not what was parsed.
pub(crate) fn examine(kind: SourceKind, bytes: &[u8]) -> Outcome {
    let parsed = kind == SourceKind::Text && prints_what_it_parses(&String::from_utf8_lossy(bytes));
    let findings = inspect([Input::read("source", kind, bytes)], None);
    Outcome { parsed, sound: !findings.has_errors() }
}

/// False if the text does not parse.
fn prints_what_it_parses(text: &str) -> bool {
    let parsed = parse(FileId(0), text);
    if !parsed.diagnostics.is_empty() {
        return false;
    }
    let printed = print_unit(&parsed.unit);
    let again = parse(FileId(0), &printed);
    assert!(again.diagnostics.is_empty(), "what is printed parses: {printed}");
    assert_eq!(print_unit(&again.unit), printed, "what is printed is stable");
    true
}
