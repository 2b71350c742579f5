//! What the files declare, by name, and what is known of it: the room that bodies ask.
//!
//! [`Declarations`] is the whole interface. Nothing here knows an expression: what takes one to resolve is left to the
//! [`Resolve`] that the declarations are made with.

pub(in crate::check) mod calls;
pub(in crate::check) mod chart;
pub(in crate::check) mod class;
pub(in crate::check) mod declarations;
pub(in crate::check) mod demand;
pub(in crate::check) mod entry;
pub(in crate::check) mod global;
pub(in crate::check) mod hook;
pub(in crate::check) mod inheritance;
pub(in crate::check) mod kept;
pub(in crate::check) mod layout;
pub(in crate::check) mod located;
pub(in crate::check) mod names;
pub(in crate::check) mod namespace;
pub(in crate::check) mod recursion;
pub(in crate::check) mod scope;
pub(in crate::check) mod start;
pub(in crate::check) mod vendor_parameter;
pub(in crate::check) mod visibility;
