//! Lessons: what operators are trained in. They stand in `lessons.toml` beside `scenario.toml`, and in files of the folder `lessons`.
//!
//! | module | subject |
//! |---|---|
//! | [`file`] | `lessons.toml` as it is written |
//! | `sheet` | one such file, read |
//! | [`book`] | all of them, checked: prepared states, lessons |
//! | [`bind`] | the formulas and costs of a lesson, bound to signals |
//! | [`start`] | prepared states |
//! | `put` | a lesson put on its scenario |
//! | `shift` | what a lesson does, moved to where it begins |
//!
//! A lesson is a case that begins somewhere: its malfunctions are the faults, disturbances and forces of a case.

pub mod bind;
pub mod book;
pub mod file;
mod put;
mod sheet;
mod shift;
pub mod start;

pub use bind::{Cost, Lesson, Malfunction, Mistake, Sought};
pub use book::Book;
pub use start::Start;

/// The file beside `scenario.toml`.
pub const FILE_NAME: &str = "lessons.toml";
/// The folder with more files of the same form.
pub const FOLDER_NAME: &str = "lessons";
