//! Programs in, traces out: the whole way from text to a scanning PLC.

mod dates;
mod diagnostics;
mod direct_addresses;
mod expressions;
mod faults;
mod inputs;
mod language;
mod lints;
mod partial_access;
