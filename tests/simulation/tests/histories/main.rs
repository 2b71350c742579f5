//! Histories by a seed of what stands between a session and the world: the lobby, the other listeners, recordings, files of lines.
//! What runs is the product's own code, moved by what a seed draws: visitors who are silent, late, hasty or hostile, connections
//! that break, descriptors that run out, a disk that is full or fails, a kill at any call.
//!
//! `tests/simulation/mutants` looks whether these laws notice small mistakes in that code.

mod lines;
mod listeners;
mod lobby;
mod recordings;
