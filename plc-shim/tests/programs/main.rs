//! Programs in, traces out: the whole way from text to a scanning PLC.

mod configurations;
mod conversions;
mod dates;
mod diagnostics;
mod dialects;
mod direct_addresses;
mod expressions;
mod faults;
mod inputs;
mod language;
mod lints;
mod namespaces;
mod object_inputs;
mod objects;
mod partial_access;
mod rig;
mod robustness;
mod scheduling;
mod scl;
mod shear;
mod standard_blocks;
mod standard_functions;
mod states;
mod string_expressions;
mod strings;
mod subranges;
