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
//! | [`condition`] | formulas without a future, which a running session can judge |
//! | [`present`] | the same with arithmetic, for who has the values at hand |
//! | [`truth`] | three-valued truth, and the margin by which a formula holds |
//! | [`verdict`] | met, violated and when, or still open at the end |
//! | `reach` | how far around a sample a formula looks |
//! | [`sample`] | what a formula is worth at a sample, and blocks of samples |
//! | [`term`] | terms, sample by sample |
//! | [`sliding`] | what is joined over windows that move, in a time that does not depend on their lengths |
//! | [`ahead`], [`back`] | operators on the future and on the past |
//! | [`monitor`] | a formula as the run goes |
//! | [`reaction`] | how long it takes until something holds |
//! | [`judge`] | all expectations of a run, and the samples that a verdict may still name |
//!
//! A run is judged as it goes. What is kept of it is what windows reach over, times the signals that are named.
//! Operators without an end keep a number each where they stand outermost, also under `and`, `or`, `not`,
//! `implies`; within other windows they keep what they have seen, because each of its samples may matter until
//! the end. The tests hold all of it against `offline`, which looks at a whole run.
//!
//! Semantics. A signal holds its value from one sample to the next. Windows that reach beyond the
//! end of a run leave a formula open, unless what was seen decides it; an operator without a window
//! reaches to the end of the run and no further, or, if the run was cut off, as far as it would have
//! gone. Before the start there is nothing: `once` is false
//! there, `historically` true. Margins are the robustness of Donzé and Maler (FORMATS 2010); a BOOL
//! that holds does so by an infinite margin.

mod ahead;
mod back;
mod bind;
mod condition;
mod error;
mod formula;
mod judge;
mod monitor;
#[cfg(test)]
mod offline;
mod parser;
mod present;
mod reach;
mod reaction;
mod sample;
mod sliding;
mod term;
mod token;
mod truth;
mod unit;
mod verdict;

pub use bind::{Expectation, KnownSignal};
pub use condition::condition;
pub use error::FormulaError;
pub use judge::Judge;
pub use present::Present;
pub use reaction::Reaction;
pub use sample::TraceEnd;
pub use truth::Margin;
pub(crate) use unit::Carrying;
pub use verdict::{Outcome, Verdict};
