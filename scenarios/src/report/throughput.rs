//! Throughput: how many in each of equal windows of virtual time.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::windows::Windows;

/// How many in each of equal windows.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Throughput {
    /// Width of a window in nanoseconds of virtual time. The last one ends with the run.
    pub window_ns: u64,
    /// How many in each window, from the beginning of the report on.
    pub counts: Vec<u64>,
}

impl Throughput {
    /// What there is at the end of a run.
    pub(super) fn until(windows: &Windows<u64>, end_ns: u64) -> Self {
        let all = windows.until(end_ns);
        Self { window_ns: all.width_ns(), counts: all.contents().to_vec() }
    }
}
