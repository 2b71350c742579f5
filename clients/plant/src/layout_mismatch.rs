//! Why a saved state does not belong to this plant.

use thiserror::Error;

/// Why a state does not fit in a machine, in words that follow "it" or name a part.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{0}")]
pub(crate) struct LayoutMismatch(pub(crate) String);
