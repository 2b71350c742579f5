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
mod rest;
mod security;
mod shim;
mod streams;
mod streams_of_vendors;
mod targets;
mod wire;
