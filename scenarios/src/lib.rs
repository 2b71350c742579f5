//! onescan

pub mod plot;
