//! Generic types of inputs (CODESYS, TwinCAT: `ANY`, `ANY_NUM` and the like; Siemens: `VARIANT`): their names, and what
//! they take.

use crate::ir::ElementaryType;
use crate::ir::elementary::Kind;

/// A generic type that an input may have.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(in crate::check) enum Generic {
    Any,
    AnyBit,
    AnyDate,
    AnyNum,
    AnyReal,
    AnyInt,
    AnyString,
    /// `VARIANT` of Siemens.
    Variant,
}

impl Generic {
    const ALL: [Self; 8] = [
        Self::Any,
        Self::AnyBit,
        Self::AnyDate,
        Self::AnyNum,
        Self::AnyReal,
        Self::AnyInt,
        Self::AnyString,
        Self::Variant,
    ];

    pub(in crate::check) fn name(self) -> &'static str {
        match self {
            Self::Any => "ANY",
            Self::AnyBit => "ANY_BIT",
            Self::AnyDate => "ANY_DATE",
            Self::AnyNum => "ANY_NUM",
            Self::AnyReal => "ANY_REAL",
            Self::AnyInt => "ANY_INT",
            Self::AnyString => "ANY_STRING",
            Self::Variant => "VARIANT",
        }
    }

    /// The generic type of this name, in capitals.
    pub(in crate::check) fn find(key: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|generic| generic.name() == key)
    }

    /// True if variables of elementary types of the kind are taken.
    pub(in crate::check) fn takes(self, kind: Kind) -> bool {
        let integer = matches!(kind, Kind::Signed | Kind::Unsigned);
        match self {
            Self::Any | Self::Variant => true,
            Self::AnyBit => matches!(kind, Kind::Bool | Kind::Bits),
            Self::AnyDate => matches!(kind, Kind::Date | Kind::TimeOfDay | Kind::DateTime),
            Self::AnyNum => integer || kind == Kind::Real,
            Self::AnyReal => kind == Kind::Real,
            Self::AnyInt => integer,
            Self::AnyString => false,
        }
    }
}

/// Numbers of `__SYSTEM.TYPE_CLASS` (CODESYS, Base Interfaces: `TypeClass`).
pub(in crate::check) fn class_of(ty: ElementaryType) -> i128 {
    use ElementaryType as E;
    match ty {
        E::Bool => 0,
        E::Byte => 2,
        E::Word => 3,
        E::Dword => 4,
        E::Lword => 5,
        E::Sint => 6,
        E::Int => 7,
        E::Dint => 8,
        E::Lint => 9,
        E::Usint => 10,
        E::Uint => 11,
        E::Udint => 12,
        E::Ulint => 13,
        E::Real => 14,
        E::Lreal => 15,
        E::Time => 18,
        E::Date => 19,
        E::Dt => 20,
        E::Tod => 21,
        E::Ltime => 37,
        E::Ldate => 46,
        E::Ldt => 47,
        E::Ltod => 48,
        // Vendors have no single characters.
        E::Char | E::Wchar => NO_CLASS,
    }
}

pub(in crate::check) const NO_CLASS: i128 = 29;
