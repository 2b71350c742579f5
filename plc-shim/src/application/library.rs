//! The standard function blocks (2nd ed. 2.5.2.3) and some functions, as program text like any other.

/// File names and texts.
pub(crate) const FILES: [(&str, &str); 10] = [
    ("iec/bcd.st", include_str!("../../iec/bcd.st")),
    ("iec/bistable.st", include_str!("../../iec/bistable.st")),
    ("iec/clock_and_semaphore.st", include_str!("../../iec/clock_and_semaphore.st")),
    ("iec/counters.st", include_str!("../../iec/counters.st")),
    ("iec/counters_by_type.st", include_str!("../../iec/counters_by_type.st")),
    ("iec/date_and_time.st", include_str!("../../iec/date_and_time.st")),
    ("iec/edge_detection.st", include_str!("../../iec/edge_detection.st")),
    ("iec/long_date_and_time.st", include_str!("../../iec/long_date_and_time.st")),
    ("iec/timers.st", include_str!("../../iec/timers.st")),
    ("iec/timers_by_type.st", include_str!("../../iec/timers_by_type.st")),
];

/// Asserts of test programs. They have memory of their own and so are there only for those that use them.
pub(crate) const ASSERTS: (&str, &str) = ("iec/test/assert.st", include_str!("../../iec/test/assert.st"));

/// Whether a source may mean an assert; one that does not has no use for [`ASSERTS`].
pub(crate) fn mentions_assert(text: &str) -> bool {
    text.as_bytes().windows(6).any(|word| word.eq_ignore_ascii_case(b"ASSERT"))
}
