//! The meaning of formulas over a whole trace at once: what the monitor is held against in tests.

mod evaluate;
mod trace;
mod verdict;
mod window;

pub(super) use trace::Trace;
