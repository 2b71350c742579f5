//! Functions on places instead of values: `REF` (3rd ed. 6.4.4.10.3), bounds of arrays, and those of vendors.

/// Functions on places instead of values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::check) enum PlaceFunction {
    Ref,
    Adr,
    SizeOf,
    IsValidRef,
    LowerBound,
    UpperBound,
}

impl PlaceFunction {
    /// The function of this name, in capitals. A user's own goes before.
    pub(in crate::check) fn find(key: &str) -> Option<Self> {
        Some(match key {
            "REF" => Self::Ref,
            "ADR" => Self::Adr,
            "SIZEOF" | "XSIZEOF" => Self::SizeOf,
            "__ISVALIDREF" => Self::IsValidRef,
            "LOWER_BOUND" => Self::LowerBound,
            "UPPER_BOUND" => Self::UpperBound,
            _ => return None,
        })
    }
}
