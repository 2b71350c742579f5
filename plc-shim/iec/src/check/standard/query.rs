//! `__QUERYINTERFACE` and `__QUERYPOINTER` (CODESYS, TwinCAT).

/// What is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::check) enum Query {
    Interface,
    Pointer,
}

impl Query {
    /// The query of this name, in capitals.
    pub(in crate::check) fn find(key: &str) -> Option<Self> {
        match key {
            "__QUERYINTERFACE" => Some(Self::Interface),
            "__QUERYPOINTER" => Some(Self::Pointer),
            _ => None,
        }
    }
}
