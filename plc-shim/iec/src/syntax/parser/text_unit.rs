//! The unit whose text is being read.

/// The unit around, and from where its lines are counted.
#[derive(Debug, Clone, Default)]
pub(super) struct TextUnit {
    /// The name of the unit, behind that of what it belongs to.
    pub(super) name: String,
    /// True within a unit, whose name namespaces do not begin.
    pub(super) in_unit: bool,
    /// Where the declaration begins or, in a body, ends.
    pub(super) from: u32,
    pub(super) in_body: bool,
}
