//! Sessions of toy clients, through the public API of the server.

mod checkpoint;
mod control;
mod digest;
mod failure;
mod joining;
mod peer;
mod shim;
mod wire;
