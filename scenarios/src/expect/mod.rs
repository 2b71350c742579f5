//! What a run must show: signal temporal logic over the session's signals.
//!
//! `always (Grip_Closed implies within 200ms Pressure > 5 bar)` says what a machine has to do and
//! until when, in virtual time, so that the verdict is as reproducible as the run.
//!
//! Modules in the order in which data flows through them:
//!
//! | module | subject |
//! |---|---|
//! | [`token`] | a formula's text as words, numbers and signs |
//! | [`parser`] | words to a formula as written |
//! | [`formula`] | formulas and terms |
//! | [`unit`] | units of measurement, and numbers carried from one to another |
//! | [`bind`] | names to signals, units to factors |
//! | [`condition`] | formulas of the present, which a running session can judge |
//! | [`trace`] | the signals a formula needs, sample by sample |
//! | [`truth`] | three-valued truth, and the margin by which a formula holds |
//! | [`window`] | greatest and least values in windows of time |
//! | [`evaluate`] | a formula over a trace |
//! | [`verdict`] | met, violated and when, or still open at the end |
//!
//! Semantics. A signal holds its value from one sample to the next. Windows that reach beyond the
//! end of a run leave a formula open, unless what was seen decides it; an operator without a window
//! reaches to the end of the run and no further, or, if the run was cut off, as far as it would have
//! gone. Before the start there is nothing: `once` is false
//! there, `historically` true. Margins are the robustness of Donzé and Maler (FORMATS 2010); a BOOL
//! that holds does so by an infinite margin.

mod bind;
mod condition;
mod error;
mod evaluate;
mod formula;
mod parser;
mod token;
mod trace;
mod truth;
mod unit;
mod verdict;
mod window;

pub use bind::{Expectation, KnownSignal};
pub use condition::condition;
pub use error::FormulaError;
pub use trace::{Trace, TraceEnd};
pub use truth::Margin;
pub use verdict::{Outcome, Verdict};
