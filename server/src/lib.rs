//! onescan
