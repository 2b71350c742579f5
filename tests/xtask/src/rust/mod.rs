//! Rust sources, read as far as measures need them: tokens, the items of tests, functions, blocks of docs.

pub(crate) mod doc;
pub(crate) mod function;
pub(crate) mod package;
pub(crate) mod source;
pub(crate) mod token;
