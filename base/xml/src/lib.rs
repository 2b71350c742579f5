//! XML as a tree whose elements, attributes and texts know where they stand in the file.
//!
//! | module | subject |
//! |---|---|
//! | [`element`] | elements, their attributes, and what is in them |
//! | [`lines`] | the line of a place |
//! | [`error`] | why a text is not XML, and where |
//! | [`parse`](mod@parse) | text to a tree |
//!
//! Files come from many tools, and some are meant to do harm. So depth and number of nodes have limits, and a DTD is
//! refused: without one there are no entities to expand. Names keep what is behind their prefix; whoever needs a
//! namespace finds its declarations among the attributes. A comment or blanks may stand before the XML declaration.
//!
//! Invariant: no text makes it panic, and a file that ends too early is an error.

pub mod element;
pub mod error;
pub mod lines;
pub mod parse;

pub use element::{Attribute, Element, Node};
pub use error::{XmlError, XmlFault};
pub use lines::Lines;
pub use parse::{DEPTH_MAX, parse, parse_within};
