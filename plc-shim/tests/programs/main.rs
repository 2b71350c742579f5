//! Programs in, traces out: the whole way from text to a scanning PLC.

mod configurations;
mod conversions;
mod dates;
mod diagnostics;
mod dialects;
mod direct_addresses;
mod expressions;
mod faults;
mod field;
mod inputs;
mod language;
mod lints;
mod lockstep;
mod partial_access;
mod recovery;
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
