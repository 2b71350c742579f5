//! What is known of a program before code is made of it: functions over [`ir`](onescan_iec::ir) that give plain
//! results. Nothing here knows WebAssembly.
//!
//! | module | subject |
//! |---|---|
//! | [`size`], [`reach`], [`cost`] | of units: how large they are, whom they call, what a call may change and costs |
//! | [`program`] | the whole program, and which units go in the place of a call |
//! | [`address`], [`scope`] | where variables and pointers lead; what names mean at a place |
//! | [`range`], [`interval`], [`refine`] | between what integers lie: variables, expressions, behind conditions |
//! | [`survey`], [`effect`], [`price`] | what the turns of a loop read, change and cost |
//! | [`counting`], [`step`], [`drift`] | how loops count |
//! | [`known`] | what registers hold already of what is in memory |
//! | [`choice`], [`nan`] | forms of statements and values |
//!
//! Units are analysed and compiled in one order, callees first. Within a unit, code goes from statement to
//! statement and takes [`Ranges`] and [`Known`] along; before a loop it asks [`Survey`] what the turns do. Results are not
//! kept by expression: the same expression means something else wherever its unit is put in the place of a call.

mod address;
mod choice;
mod cost;
mod counting;
mod drift;
mod effect;
mod interval;
mod known;
mod nan;
mod price;
mod program;
mod range;
mod reach;
mod refine;
mod scope;
mod size;
mod step;
mod survey;

pub(super) use address::{Address, Base, Extent, Register};
pub(super) use choice::Choice;
pub(super) use cost::SMALL;
pub(super) use counting::Count;
pub(super) use drift::{Driven, driven};
pub(super) use effect::Effects;
pub(super) use interval::{assigned, fits, interval};
pub(super) use known::{Entry, Known};
pub(super) use nan::may_be_any_nan;
pub(super) use program::Program;
pub(super) use range::{Ranges, Slot};
pub(super) use reach::RunsOn;
pub(super) use refine::assume;
pub(super) use scope::{INSTANCE, Scope, constant_index};
pub(super) use size::leaves;
pub(super) use survey::Survey;
