//! An LTIME that is given to `TON`, `TOF` or `TP` where these take TIME and LTIME (3rd ed. Table 46): the shim's block
//! takes a TIME, so a conversion is written around it.

use std::collections::BTreeSet;

use super::marks;
use super::survey::Survey;
use super::target::Target;
use onescan_iec::dialect::Feature;
use onescan_iec::front::{Front, with_room};
use onescan_iec::input::Input;
use onescan_iec::source::edits::Edits;
use onescan_iec::syntax::{SourceFile, Span};

/// Where an LTIME is given in a project of these texts. Only checked text says what is one, so a project without timers is not
/// checked for it.
pub(super) fn given(texts: Vec<Input>, target: Target, survey: &Survey<'_>) -> BTreeSet<Span> {
    let takes_both = texts.iter().any(|text| text.file().dialect().has(Feature::LongTimers));
    if target != Target::Iec || !takes_both || survey.renames.is_empty() {
        return BTreeSet::new();
    }
    with_room(|| Front::new(texts).checked.long_durations)
}

/// Converts what stands at `span`.
pub(super) fn convert(span: Span, file: &SourceFile, edits: &mut Edits) {
    let (text, at) = (file.shown_text(), file.shown_range(span.start, span.end));
    edits.insert(at.start, marks::within(text, at.start, "LTIME_TO_TIME("));
    edits.insert(at.end, marks::within(text, at.end, ")"));
}
