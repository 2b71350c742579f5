//! The types of what a direct address names without a declaration (2nd ed. 2.4.1.1).

use crate::ir::ElementaryType;
use crate::syntax::direct_address::Width;

impl Width {
    /// The type of what has no declaration.
    pub fn bit_string(self) -> ElementaryType {
        match self {
            Self::Bit => ElementaryType::Bool,
            Self::Byte => ElementaryType::Byte,
            Self::Word => ElementaryType::Word,
            Self::Dword => ElementaryType::Dword,
            Self::Lword => ElementaryType::Lword,
        }
    }
}
