//! What is done with one element after the other.

/// What is done with an element.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::input::plcopen_network) enum Step {
    /// It is evaluated.
    Evaluate(usize),
    /// Its value is taken for those that come next: a variable is read again, and nothing is written.
    Take(usize),
}

impl Step {
    pub(in crate::input::plcopen_network) fn index(self) -> usize {
        match self {
            Self::Evaluate(index) | Self::Take(index) => index,
        }
    }
}
