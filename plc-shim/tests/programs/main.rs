//! Programs in, traces out: the whole way from text to a scanning PLC.

mod dates;
mod diagnostics;
mod direct_addresses;
mod expressions;
mod faults;
mod inputs;
mod language;
mod lints;
mod namespaces;
mod objects;
mod partial_access;
mod rig;
mod robustness;
mod scheduling;
mod shear;
mod standard_blocks;
mod standard_functions;
mod states;
mod string_expressions;
mod strings;
mod subranges;
