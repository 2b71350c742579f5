//! Lessons: what operators are trained in. They stand in `lessons.toml` beside `scenario.toml`.
//!
//! | module | subject |
//! |---|---|
//! | [`file`] | `lessons.toml` as it is written |
//! | [`book`] | the file read and checked: prepared states, lessons |
//! | [`bind`] | the formulas and costs of a lesson, bound to signals |
//! | `shift` | what a lesson does, moved to where it begins |
//!
//! A lesson is a case that begins somewhere: its malfunctions are the faults, disturbances and forces of a case.

pub mod bind;
pub mod book;
pub mod file;
mod shift;

pub use bind::{Cost, Lesson, Malfunction, Sought};
pub use book::{Book, Start};

/// The file beside `scenario.toml`.
pub const FILE_NAME: &str = "lessons.toml";
