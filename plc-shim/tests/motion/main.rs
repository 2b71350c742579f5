//! Motion blocks (PLCopen, Function blocks for motion control, 2.0) on axes without a drive, one scan at a time.

mod bench;
mod blending;
mod coupling;
mod drive;
mod group;
mod laws;
mod outputs;
mod profiles;
mod states;
mod superimposing;
