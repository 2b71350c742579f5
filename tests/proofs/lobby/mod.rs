//! The lobby: who comes, who may stay, and for how long. The acceptor and the seats are the very machines that run.
//!
//! `model` moves them through every order of what two clients, an operator and strangers may do: say a message in pieces,
//! be silent, hang up, come again. `simulation` puts a network around them, with more of all, on virtual time, by a seed.
//!
//! | module | subject |
//! |---|---|
//! | `hall` | acceptor and seats with connections around them, and what must never be |
//! | `model` | every order, for few |
//! | `simulation` | histories by a seed, for many |

mod hall;
mod model;
mod simulation;
