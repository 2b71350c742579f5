//! The session, model-checked with `stateright`: the very code that runs, in every order of what its
//! clients may do.
//!
//! Two models. `barrier` holds the session alone: 1 to 4 clients, each free to sleep 0 to 5 steps
//! after a turn, ready in any order, failing in any state. `network` puts endpoints and FIFO
//! connections around it: messages in flight, faults, lost connections.
//!
//! A third, `shim`, holds what runs on a PLC that is not a client itself: the scheduler POU and the execution
//! controllers that `onescan instrument` emits, against a gateway whose messages come as they like.
//!
//! A fourth, `nusmv`, is the text that `onescan model --nusmv` writes: it is read back, explored, and reaches the
//! same states as `barrier`.
//!
//! Time grows for ever, behaviour does not: two states that differ only in `t_v` behave alike, and so
//! do two that differ only in the values clients wrote. The barrier model therefore compares and
//! hashes states with all times relative to `t_v` and with each value only as right or wrong, which
//! makes it finite and the search complete. The network model is bounded in virtual time instead.

mod barrier;
mod graph;
mod lobby;
mod network;
mod nusmv;
mod shim;
mod stamped;
