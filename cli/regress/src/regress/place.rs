//! Where a byte of a source stands, as reports name it.

use onescan_iec::Input;
use onescan_server::client::SourcePlace;

/// The file, line and column of a byte of a source.
pub(super) fn place(input: &Input, offset: u32) -> SourcePlace {
    let at = input.file().line_column(offset);
    SourcePlace { file: input.file().name().to_owned(), line: at.line, column: at.column }
}
