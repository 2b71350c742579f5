//! For whom the output is.

/// For whom the output is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Format {
    #[default]
    Human,
    /// Machines: one JSON object a run and line.
    Json,
}
