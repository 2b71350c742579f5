//! What a run says to an expectation.

use onescan_server::time::VirtualTime;

use super::truth::Margin;

/// What came of an expectation.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// Whether it was met.
    pub verdict: Verdict,
    /// By how much, as far as the run shows.
    pub margin: Margin,
}

/// Whether an expectation was met.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    /// It holds, whatever would have come next.
    Met,
    /// The run ended before it could be decided.
    Open,
    /// It does not hold.
    Violated {
        /// When that became certain: the first sample that an `always` forbids, the end of the window in which
        /// an `eventually` waited in vain.
        at: VirtualTime,
        /// What its signals were then, by name.
        values: Vec<(String, f64)>,
    },
}
