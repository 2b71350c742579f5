//! The standard function blocks (2nd ed. 2.5.2.3) and some functions, as program text like any other.

/// File names and texts.
pub(crate) const FILES: [(&str, &str); 11] = [
    ("iec/bcd.st", include_str!("../../iec/bcd.st")),
    ("iec/bistable.st", include_str!("../../iec/bistable.st")),
    ("iec/clock_and_semaphore.st", include_str!("../../iec/clock_and_semaphore.st")),
    ("iec/counters.st", include_str!("../../iec/counters.st")),
    ("iec/counters_by_type.st", include_str!("../../iec/counters_by_type.st")),
    ("iec/date_and_time.st", include_str!("../../iec/date_and_time.st")),
    ("iec/edge_detection.st", include_str!("../../iec/edge_detection.st")),
    ("iec/long_date_and_time.st", include_str!("../../iec/long_date_and_time.st")),
    ("iec/sequential_function_chart.st", include_str!("../../iec/sequential_function_chart.st")),
    ("iec/timers.st", include_str!("../../iec/timers.st")),
    ("iec/timers_by_type.st", include_str!("../../iec/timers_by_type.st")),
];
