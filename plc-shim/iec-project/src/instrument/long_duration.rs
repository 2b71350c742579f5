//! An LTIME that is given to `TON`, `TOF` or `TP` where these take TIME and LTIME (3rd ed. Table 46): the shim's block
//! takes a TIME, so a conversion is written around it.

use std::collections::BTreeSet;

use super::marks;
use super::plain::Plain;
use super::survey::Survey;
use super::target::Target;
use onescan_iec::dialect::Feature;
use onescan_iec::front::{Front, with_room};
use onescan_iec::source::edits::Edits;
use onescan_iec::syntax::{SourceFile, Span};

/// Where an LTIME is given. Only checked text says what is one, so a project without timers is not checked for it.
pub(super) fn given(plain: &Plain, target: Target, survey: &Survey<'_>) -> BTreeSet<Span> {
    let takes_both = plain.sources.iter().any(|(_, file)| file.dialect().has(Feature::LongTimers));
    if target != Target::Iec || !plain.is_text() || !takes_both || survey.renames.is_empty() {
        return BTreeSet::new();
    }
    let texts: Vec<_> = plain.texts().collect();
    with_room(|| Front::new(texts).checked.long_durations)
}

/// Converts what stands at `span`.
pub(super) fn convert(span: Span, file: &SourceFile, edits: &mut Edits) {
    let (text, at) = (file.shown_text(), file.shown_range(span.start, span.end));
    edits.insert(at.start, marks::within(text, at.start, "LTIME_TO_TIME("));
    edits.insert(at.end, marks::within(text, at.end, ")"));
}
