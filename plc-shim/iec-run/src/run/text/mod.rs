//! Functions on character strings in the PLC's memory.
//!
//! | module | subject |
//! |---|---|
//! | [`view`] | a string in memory |
//! | [`edit`] | order, search, pieces of strings |
//! | [`parse`] | text to values |
//! | [`link`] | what the module imports |
//!
//! They allocate nothing and give the same bytes on every machine. Whatever stands in memory, the
//! only failure is an address outside of it. Their work is paid for from the budget.

mod edit;
pub(super) mod link;
mod parse;
mod view;
