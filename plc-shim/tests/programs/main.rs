//! Programs in, traces out: the whole way from text to a scanning PLC.

mod configurations;
mod dates;
mod diagnostics;
mod dialects;
mod direct_addresses;
mod expressions;
mod faults;
mod forcing;
mod inputs;
mod language;
mod lints;
mod partial_access;
mod restarts;
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
