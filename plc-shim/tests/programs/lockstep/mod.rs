//! Instrumented programs (`[SDSP]` sec. V): the same outputs at the same virtual times,
//! whatever becomes of the grants.

mod abreast;
mod beside;
mod charts;
mod configurations;
mod corpus;
mod drawn;
mod driver;
mod equivalence;
mod grants;
mod plcopen_charts;
mod plcopen_motion;
mod plcopen_xml;
mod ported;
pub(crate) mod random;
mod random_single;
mod real_inputs;
mod rewriting;
mod scl;
mod scl_port;
mod single;
mod verified;
mod widths;
