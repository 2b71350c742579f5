//! A scenario as a drawing: its wiring listed and drawn, wired and built in a browser.
//!
//! | module | subject |
//! |---|---|
//! | [`edit`] | a scenario wired and built in a browser |
//! | [`wiring`] | signals between clients, listed and drawn |

pub mod edit;
pub mod wiring;
