//! What the user is to read in any case.

/// The target of events that are for the user, also without `--verbose`: the program's log shows it by this name.
pub const NOTICE: &str = "onescan::notice";
