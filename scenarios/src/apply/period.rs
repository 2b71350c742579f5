//! When something of a case begins and ends, by the keys that are written.

use std::num::NonZeroU32;
use std::ops::Range;

use onescan_server::time::VirtualTime;
use onescan_server::timeline::When;

use crate::case::Catalogue;
use crate::error::ScenarioError;
use crate::expect::{KnownSignal, condition};
use crate::timed::Times;

/// When something of a case begins and ends.
#[derive(Clone)]
pub(super) struct Period {
    pub(super) begin: When,
    pub(super) end: Option<When>,
}

/// When something begins and ends.
pub(super) fn period(
    catalogue: &Catalogue,
    known: &[KnownSignal],
    times: &Times,
    place: Range<usize>,
) -> Result<Period, ScenarioError> {
    let nth = nth(catalogue, times)?;
    let Times { from, until, when, lasting, .. } = times.clone();
    // without `from` it begins with the run
    let start = from.unwrap_or_default();
    if let (Some(_), Some(_)) = (until, lasting) {
        let message = "`until` and `for` both say when it ends".to_owned();
        return Err(catalogue.wrong(message, Some(place), Some("keep one of them".to_owned())));
    }
    if let Some(written) = when {
        let condition = condition(written.get_ref(), known).map_err(|error| {
            let place = catalogue.place_within(&written, &error.place);
            catalogue.wrong(error.to_string(), Some(place), error.help)
        })?;
        let end = match (until, lasting) {
            (Some(until), _) => {
                let message = format!("it begins with `when`, so that it may begin after {until}");
                let help = "say how long it lasts, as in `for = \"200ms\"`".to_owned();
                return Err(catalogue.wrong(message, Some(place), Some(help)));
            }
            (None, delay @ Some(_)) => Some(When::Once { condition: condition.clone(), from: start, nth, delay }),
            (None, None) => None,
        };
        return Ok(Period { begin: When::Once { condition, from: start, nth, delay: None }, end });
    }
    let until = match lasting {
        None => until,
        Some(lasting) => Some(start.checked_add(lasting).unwrap_or(VirtualTime::MAX)),
    };
    if let Some(until) = until.filter(|until| *until <= start) {
        let message = format!("`until`, {until}, is not after `from`, {start}");
        return Err(catalogue.wrong(message, Some(place), None));
    }
    Ok(Period { begin: When::At(start), end: until.map(When::At) })
}

/// Which time that the condition comes true.
fn nth(catalogue: &Catalogue, times: &Times) -> Result<NonZeroU32, ScenarioError> {
    let Some(written) = &times.nth else { return Ok(NonZeroU32::MIN) };
    let wrong = |message: &str, help: &str| {
        Err(catalogue.wrong(message.to_owned(), Some(written.span()), Some(help.to_owned())))
    };
    match (&times.when, NonZeroU32::new(*written.get_ref())) {
        (None, _) => wrong(
            "`nth` counts how often a condition comes true",
            "write the condition, as in `when = \"rose(Start)\"`",
        ),
        (Some(_), None) => {
            wrong("`nth` counts from 1", "the first time is `nth = 1`, which is also meant without `nth`")
        }
        (Some(_), Some(nth)) => Ok(nth),
    }
}
