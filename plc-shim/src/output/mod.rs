//! Program text to the files that other tools import: the way back of [`crate::input`].
//!
//! | module | in | out |
//! |---|---|---|
//! | [`scl`] | a project in text | an external source of TIA Portal |

pub(crate) mod scl;
