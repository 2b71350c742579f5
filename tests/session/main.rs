//! Sessions of toy clients, through the public API of the server.

mod checkpoint;
mod control;
mod digest;
mod failure;
mod granted;
mod joining;
mod leaving;
mod lobby;
mod peer;
mod recorded;
mod security;
mod shim;
mod streams;
mod targets;
mod wire;
