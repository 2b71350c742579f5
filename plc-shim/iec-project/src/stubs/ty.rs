//! Types as an inference sees them.

use onescan_iec::ElementaryType;
use onescan_iec::syntax::FileId;
use onescan_iec::syntax::ast::ReferenceKind;

/// What is known of the type of a value or place.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Ty {
    /// Nothing is known of it, and nothing can be learned.
    Unknown,
    /// An integer without a type of its own.
    Integer,
    /// The same, one that needs at least this type.
    Wide(ElementaryType),
    /// A real number without a type of its own.
    Real,
    Elementary(ElementaryType),
    /// A string, or one of wide characters.
    Text(bool),
    /// What the project declares, by its full key.
    Declared(String),
    /// What nobody declares, by its key.
    Foreign(String),
    /// Dimensions as they are written, and the elements.
    Array(Vec<String>, Box<Ty>),
    /// A structure without a name, by the place where it stands: its members are known, and it goes to a generic input.
    Nameless(FileId, u32),
    /// A generic input of vendors: what it is given for is one, too.
    Any,
    /// A pointer or reference.
    Pointer(ReferenceKind, Box<Ty>),
    /// The type of something that nobody declares.
    Slot(Slot),
}

impl Ty {
    /// True for a structure without a name, and for arrays of such: a parameter of it can only be generic.
    pub(super) fn is_nameless(&self) -> bool {
        match self {
            Self::Nameless(..) => true,
            Self::Array(_, element) => element.is_nameless(),
            _ => false,
        }
    }
}

/// The type of a variable, member, parameter or result that nobody declares.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Slot(pub(super) usize);
