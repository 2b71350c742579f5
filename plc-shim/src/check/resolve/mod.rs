//! Declarations as written to what they mean: types, initial values, variables with their places.

pub(in crate::check) mod chart;
pub(in crate::check) mod enable;
pub(in crate::check) mod generic;
pub(in crate::check) mod global;
pub(in crate::check) mod inherit;
pub(in crate::check) mod initial;
pub(in crate::check) mod instance_arguments;
pub(in crate::check) mod interface;
pub(in crate::check) mod keep;
pub(in crate::check) mod referred;
pub(in crate::check) mod start;
pub(in crate::check) mod storage;
pub(in crate::check) mod structure;
pub(in crate::check) mod subrange;
pub(in crate::check) mod text;
pub(in crate::check) mod union;
pub(in crate::check) mod written;
