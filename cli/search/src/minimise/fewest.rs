//! Which entries are needed.
//!
//! Entries stand in the order in which they begin. The last one that is needed is the first without which those before it
//! do not fail; it is found by halves, in runs that fork from the whole case. Then the next one is looked for among those
//! before it, until what is needed fails by itself: at both ends first, because what fails at the end of a long run often
//! needs what began it, and what came just before. One entry that does it alone among `n` takes `2 + log2(n)` trials. At the
//! end each is left out by itself, because two that were each needed with a third need not be needed without it.

use onescan_scenario::case::written::Entry;

use super::trial::Trials;
use onescan_runner::run::SearchError;

/// Entries at either end that are tried before all are halved.
const ENDS: [usize; 3] = [1, 2, 4];

/// The fewest of `entries`, which fail all together, with which it still fails: none of them can be left out.
///
/// # Errors
/// A session cannot be formed or go on.
pub(super) fn fewest(trials: &mut Trials<'_>, entries: &[Entry]) -> Result<Vec<Entry>, SearchError> {
    let mut needed: Vec<Entry> = Vec::new();
    let mut rest = entries;
    while !rest.is_empty() && (needed.is_empty() || !fails(trials, &[], &needed)?) {
        let within = if needed.is_empty() { rest } else { narrowed(trials, rest, &needed)? };
        // With all before `enough` it fails, with those before `few` it does not.
        let (mut few, mut enough) = (0, within.len());
        while enough - few > 1 {
            let middle = usize::midpoint(few, enough);
            if fails(trials, &within[..middle], &needed)? { enough = middle } else { few = middle }
        }
        if trials.is_spent() {
            return Ok([&within[..enough], &needed].concat());
        }
        needed.insert(0, within[few].clone());
        rest = &within[..few];
    }
    let mut number = needed.len();
    while number > 0 {
        number -= 1;
        let mut without = needed.clone();
        without.remove(number);
        if fails(trials, &[], &without)? {
            needed = without;
            // What was needed with it may not be without it.
            number = needed.len();
        }
    }
    Ok(needed)
}

/// A few of `rest` at one of its ends, if these with what is `needed` fail; all of it if not.
fn narrowed<'e>(trials: &mut Trials<'_>, rest: &'e [Entry], needed: &[Entry]) -> Result<&'e [Entry], SearchError> {
    for few in ENDS {
        if 2 * few >= rest.len() {
            break;
        }
        for end in [&rest[rest.len() - few..], &rest[..few]] {
            if fails(trials, end, needed)? {
                return Ok(end);
            }
        }
    }
    Ok(rest)
}

/// Whether entries fail with those that are needed, which begin after them.
fn fails(trials: &mut Trials<'_>, entries: &[Entry], needed: &[Entry]) -> Result<bool, SearchError> {
    Ok(trials.fails(&[entries, needed].concat())?.is_some())
}
