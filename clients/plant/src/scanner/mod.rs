//! An infrared line scanner as a device: what it hears, what it answers, what its optics see. It knows no plant and no
//! link, so each rule is tried byte by byte, whatever carries the bytes.
//!
//! | module | subject |
//! |---|---|
//! | [`settings`] | what commands set and queries return |
//! | [`protocol`] | commands and answers, a byte at a time |
//! | [`optics`] | where the points of a line lie, and a temperature as a byte |
//!
//! # Source
//! [Jacket], ch. 13, and the manufacturer's protocol of the MP50 and MP150. The thesis has the check byte as the sum of
//! the others; by the manufacturer 80H is set in it as well. Its example, `AR` with 98H, holds for both.

pub mod optics;
pub mod protocol;
pub mod settings;

pub use optics::{Optics, quantised, temperature_degc};
pub use protocol::{Answer, Device, check_byte, command};
pub use settings::{Mode, Settings};
