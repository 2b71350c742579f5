//! Plants without a session: what a scene is made of, what the library has.
//!
//! | module | subject |
//! |---|---|
//! | `alike` | bodies as lines; those of an array that are alike in one |
//! | `attached` | what is attached to joints, in words: fittings, couplings |
//! | [`components`] | the kinds of component |
//! | [`describe`] | a scene as a tree: bodies, joints, what moves and senses, signals |
//! | `page_text` | a page in Markdown as a terminal shows it |

mod alike;
mod attached;
pub mod components;
pub mod describe;
mod error;
mod page_text;

pub use error::PlantError;
