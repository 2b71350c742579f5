//! Which entries are needed.
//!
//! The latest entry without which those after it do not fail is needed. It is found by halves; then the next one is
//! looked for among those after it, until what is needed fails by itself. One entry that does it alone among `n` takes
//! `2 + log2(n)` trials. At the end each is left out by itself, because two that were each needed with a third need not be
//! needed without it.

use onescan_scenario::case::written::Entry;

use super::MinimiseError;
use super::trial::Trials;

/// The fewest of `entries`, which fail all together, with which it still fails: none of them can be left out.
///
/// # Errors
/// A session cannot be formed or go on.
pub(super) fn fewest(trials: &mut Trials<'_>, entries: &[Entry]) -> Result<Vec<Entry>, MinimiseError> {
    trials.fork_before(entries);
    let mut needed: Vec<Entry> = Vec::new();
    let mut rest = entries;
    while !rest.is_empty() && trials.fails(&needed)?.is_none() {
        // `needed` with all from `fails` on does, with those from `holds` on does not.
        let (mut fails, mut holds) = (0, rest.len());
        while holds - fails > 1 {
            let middle = usize::midpoint(fails, holds);
            if trials.fails(&[&needed, &rest[middle..]].concat())?.is_some() {
                fails = middle;
            } else {
                holds = middle;
            }
            if trials.is_spent() {
                return Ok([&needed, &rest[fails..]].concat());
            }
        }
        needed.push(rest[fails].clone());
        rest = &rest[fails + 1..];
    }
    let mut number = needed.len();
    while number > 0 {
        number -= 1;
        let mut without = needed.clone();
        without.remove(number);
        if trials.fails(&without)?.is_some() {
            needed = without;
            // What was needed with it may not be without it.
            number = needed.len();
        }
    }
    Ok(needed)
}
