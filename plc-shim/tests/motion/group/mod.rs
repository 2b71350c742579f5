//! Coordinated motion (PLCopen, Function blocks for motion control, part 4, 1.0): a group of six axes without drives.

mod bench;
mod blending;
mod halting;
mod kinematics;
mod laws;
mod paths;
mod states;
