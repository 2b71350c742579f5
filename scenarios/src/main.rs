//! The `onescan` program.
fn main() {}
