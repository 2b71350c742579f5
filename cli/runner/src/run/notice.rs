//! What a run reports to whoever started it, on a target of its own.

/// What is said here is for the user, also without `--verbose`.
pub const NOTICE: &str = "onescan::notice";

/// The line with which a session says where its page is, up to the address.
pub(crate) const PAGE_AT: &str = "the session is at ";
