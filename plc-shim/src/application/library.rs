//! The standard function blocks (2nd ed. 2.5.2.3), as program text like any other.

/// File names and texts.
pub(super) const FILES: [(&str, &str); 5] = [
    ("iec/edge_detection.st", include_str!("../../iec/edge_detection.st")),
    ("iec/bistable.st", include_str!("../../iec/bistable.st")),
    ("iec/counters.st", include_str!("../../iec/counters.st")),
    ("iec/date_and_time.st", include_str!("../../iec/date_and_time.st")),
    ("iec/timers.st", include_str!("../../iec/timers.st")),
];
