//! Source text to tokens to syntax tree, without loss.
//!
//! | module | in | out |
//! |---|---|---|
//! | [`token`] | | the kinds of token, keywords |
//! | [`lexer`] | text | every token, blanks and comments too |
//! | [`literal`], [`text_literal`], [`calendar`] | a literal's text | its value |
//! | [`direct_address`] | a direct address' text | its area, width and place |
//! | [`part`] | the text of a part of a bit string | its width and number |
//! | [`ast`] | | the tree's nodes |
//! | [`parser`] | tokens | a tree and a list of diagnostics |
//! | [`printer`] | a tree | text that parses to the same tree |
//! | `pragma` | tokens | those that a pragma stands before |
//! | `constant` | an expression of literals and constants | its value |
//! | [`remark`] | a file | the comments beside its declarations |
//! | `walk` | a body | each of its statements and expressions |
//!
//! Invariants: the texts of a file's tokens concatenated are the file; parsing never fails, it
//! returns a tree and a list of diagnostics; a tree knows names and spans only, never meanings.

pub mod ast;
pub mod calendar;
pub mod constant;
pub mod direct_address;
pub mod lexer;
pub mod literal;
pub mod parser;
pub mod part;
pub mod pragma;
pub mod printer;
pub mod remark;
pub mod text_literal;
pub mod token;
pub mod walk;
pub(crate) mod windows_1252;

pub use crate::source::{FileId, SourceFile, SourceMap, Span};
pub use lexer::{tokenize, tokenize_in};
pub use parser::{Parsed, parse, parse_in, parse_source};
