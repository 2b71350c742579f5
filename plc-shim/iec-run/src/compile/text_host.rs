//! The functions on character strings that the host gives.
//!
//! A string goes as two numbers: its address and its [`TextShape::code`](onescan_iec::ir::text::TextShape).

use wasm_encoder::ValType;

use super::host;

/// Module name of the imports.
pub(crate) const MODULE: &str = "text";

/// Stands for no type except an LTIME without sign, where a value becomes text.
pub(crate) const LONG_TIME: i32 = i32::MAX;

/// An import. Its position follows those of the mathematical functions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum TextImport {
    /// A string to its characters in use.
    Length,
    /// Two strings to their order.
    Compare,
    /// Two strings to a position.
    Find,
    /// Form, two strings, length, position, target to the target's address.
    Edit,
    /// Type, a value's bits, target to the target's address.
    Format,
    /// Type and string to a value's bits.
    Parse,
}

/// All imports in their order.
pub(crate) const IMPORTS: [TextImport; 6] = [
    TextImport::Length,
    TextImport::Compare,
    TextImport::Find,
    TextImport::Edit,
    TextImport::Format,
    TextImport::Parse,
];

const _: () = {
    let mut at = 0;
    while at < IMPORTS.len() {
        assert!(IMPORTS[at] as usize == at, "an import's position is its number, which its function index counts on");
        at += 1;
    }
};

impl TextImport {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Length => "length",
            Self::Compare => "compare",
            Self::Find => "find",
            Self::Edit => "edit",
            Self::Format => "format",
            Self::Parse => "parse",
        }
    }

    /// Its function index.
    pub(crate) fn index(self) -> u32 {
        host::IMPORTS.len() as u32 + self as u32
    }

    /// Parameters and result.
    pub(crate) fn signature(self) -> (Vec<ValType>, ValType) {
        let (word, long) = (ValType::I32, ValType::I64);
        match self {
            Self::Length => (vec![word; 2], word),
            Self::Compare | Self::Find => (vec![word; 4], word),
            Self::Edit => (vec![word, word, word, word, word, long, long, word, word], word),
            Self::Format => (vec![word, long, word, word], word),
            Self::Parse => (vec![word; 3], long),
        }
    }
}
