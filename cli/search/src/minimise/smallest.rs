//! Entries made smaller, one after the other: shorter first, then less, then earlier.
//!
//! Each is found by halves between a size that fails and one that holds, so that the next smaller one of what is left was
//! tried and holds. A smaller one beyond that which fails again is not looked for. What fails later than the smallest so far
//! is no better than that, and counts as holding.

use onescan_scenario::case::written::{Entry, List, to_text};
use onescan_server::time::{TimeSpan, VirtualTime};
use toml::Value;

use super::trial::Trials;
use onescan_runner::run::SearchError;

/// Trials for a number that may have any fraction.
const HALVINGS: u32 = 7;

/// What can be less of an entry, in whole steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Size {
    /// How long it lasts.
    Length,
    /// By how much values are late.
    Late,
    /// When it begins.
    Begin,
}

/// Makes each of `entries`, which fail together, as small as it can be.
///
/// # Errors
/// A session cannot be formed or go on.
pub(super) fn smallest(trials: &mut Trials<'_>, mut entries: Vec<Entry>) -> Result<Vec<Entry>, SearchError> {
    // What happens earlier may do with less, so all is tried again until nothing changes.
    loop {
        let before = entries.clone();
        for size in [Size::Length, Size::Late] {
            for number in 0..entries.len() {
                shrink(trials, &mut entries, number, size)?;
            }
        }
        for number in 0..entries.len() {
            lessen(trials, &mut entries, number)?;
        }
        // The last one first: if all can happen early, what is tried after it takes no time.
        for number in (0..entries.len()).rev() {
            shrink(trials, &mut entries, number, Size::Begin)?;
        }
        if entries == before {
            return Ok(entries);
        }
    }
}

fn shrink(trials: &mut Trials<'_>, entries: &mut [Entry], number: usize, size: Size) -> Result<(), SearchError> {
    let (step, by) = (trials.step(), trials.by());
    let Some(mut fails) = size.steps(&entries[number], by, step) else { return Ok(()) };
    trials.fork_before(entries);
    let is_less = |trials: &mut Trials<'_>, entries: &mut [Entry], steps: u64| -> Result<bool, SearchError> {
        let Some(smaller) = size.with(&entries[number], steps, step) else { return Ok(false) };
        let before = std::mem::replace(&mut entries[number], smaller);
        let failed = trials.fails(entries)?;
        match failed {
            Some(at) => trials.fail_by(at),
            None => entries[number] = before,
        }
        Ok(failed.is_some())
    };
    // Without any length or lateness it is as if the entry were left out, which holds.
    let mut holds = 0;
    if size == Size::Begin && (fails == 0 || is_less(trials, entries, 0)?) {
        return Ok(());
    }
    while fails - holds > 1 {
        let middle = u64::midpoint(holds, fails);
        if is_less(trials, entries, middle)? { fails = middle } else { holds = middle }
    }
    Ok(())
}

/// Makes the number of a disturbance less, with three digits.
fn lessen(trials: &mut Trials<'_>, entries: &mut [Entry], number: usize) -> Result<(), SearchError> {
    if entries[number].list != List::Disturbance {
        return Ok(());
    }
    for key in ["by", "sigma", "rate"] {
        let whole = matches!(entries[number].keys.get(key), Some(Value::Integer(_)));
        let Some(mut fails) = entries[number].keys.get(key).and_then(as_number) else { continue };
        let mut holds = 0.0;
        for _ in 0..HALVINGS {
            let middle =
                if whole { f64::midpoint(holds, fails).round() } else { three_digits(f64::midpoint(holds, fails)) };
            if middle == fails || middle == holds {
                break;
            }
            let value = if whole { Value::Integer(middle as i64) } else { Value::Float(middle) };
            let before = entries[number].clone();
            entries[number].keys.insert(key.to_owned(), value);
            if let Some(at) = trials.fails(entries)? {
                trials.fail_by(at);
                fails = middle;
            } else {
                entries[number] = before;
                holds = middle;
            }
        }
    }
    Ok(())
}

fn as_number(value: &Value) -> Option<f64> {
    match value {
        Value::Integer(whole) => Some(*whole as f64),
        Value::Float(number) => Some(*number),
        _ => None,
    }
}

fn three_digits(number: f64) -> f64 {
    // What is written with an exponent is read again.
    format!("{number:.2e}").parse().unwrap_or(number)
}

impl Size {
    /// How many steps it is now; nothing if the entry has no such size. What has no end ends when it has failed.
    fn steps(self, entry: &Entry, by: VirtualTime, step: TimeSpan) -> Option<u64> {
        let in_steps = |time: VirtualTime| time.as_nanos().div_ceil(step.as_nanos());
        let is_conditional = entry.keys.contains_key("when");
        match self {
            Self::Length => {
                let lasts =
                    !matches!(entry.list, List::Set | List::Code | List::Input) && !entry.keys.contains_key("at");
                let length = match (entry.time("for"), entry.time("until")) {
                    (Some(length), _) => length.as_nanos(),
                    (None, Some(until)) => until.as_nanos().saturating_sub(entry.begin().as_nanos()),
                    (None, None) => by.as_nanos().saturating_sub(entry.begin().as_nanos()) + step.as_nanos(),
                };
                lasts.then(|| in_steps(VirtualTime::from_nanos(length)))
            }
            Self::Late => {
                matches!(entry.list, List::Disturbance | List::Task).then(|| entry.time("by").map(in_steps)).flatten()
            }
            Self::Begin => {
                (!matches!(entry.list, List::Set | List::Code) && !is_conditional).then(|| in_steps(entry.begin()))
            }
        }
    }

    /// The entry with so many.
    fn with(self, entry: &Entry, steps: u64, step: TimeSpan) -> Option<Entry> {
        let span = VirtualTime::from_nanos(step.as_nanos().checked_mul(steps)?);
        let mut changed = entry.clone();
        let mut put = |key: &str, time: VirtualTime| changed.keys.insert(key.to_owned(), Value::from(to_text(time)));
        match self {
            Self::Length if entry.keys.contains_key("when") || entry.keys.contains_key("for") => {
                put("for", span);
            }
            Self::Length => {
                put("until", VirtualTime::from_nanos(entry.begin().as_nanos().checked_add(span.as_nanos())?));
            }
            Self::Late => {
                put("by", span);
            }
            Self::Begin => {
                let earlier = entry.begin().as_nanos().checked_sub(span.as_nanos())?;
                if let Some(until) = entry.time("until") {
                    put("until", VirtualTime::from_nanos(until.as_nanos().checked_sub(earlier)?));
                }
                put(if entry.keys.contains_key("at") { "at" } else { "from" }, span);
            }
        }
        Some(changed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entry(list: List, keys: &str) -> Entry {
        Entry { list, keys: toml::from_str(keys).unwrap() }
    }

    #[test]
    fn sizes_are_whole_steps() {
        let (step, by): (TimeSpan, VirtualTime) = ("10ms".parse().unwrap(), "1s".parse().unwrap());
        let force = entry(List::Force, "signal = \"a\"\nfrom = \"200ms\"\nuntil = \"250ms\"");
        let ends = entry(List::Fault, "from = \"200ms\"\nfor = \"45ms\"");
        let endless = entry(List::Fault, "component = \"ram\"\nfrom = \"900ms\"");
        let input = entry(List::Input, "at = \"200ms\"");
        let waits = entry(List::Force, "when = \"rose(a)\"");
        let steps = |size: Size, entry: &Entry| size.steps(entry, by, step);
        let sizes = [&force, &ends, &endless, &input, &waits]
            .map(|entry| (steps(Size::Length, entry), steps(Size::Begin, entry)));
        assert_eq!(
            sizes,
            [(Some(5), Some(20)), (Some(5), Some(20)), (Some(11), Some(90)), (None, Some(20)), (Some(101), None)]
        );
        let late = entry(List::Disturbance, "kind = \"late\"\nby = \"30ms\"");
        assert_eq!(steps(Size::Late, &late), Some(3));
        let text = |size: Size, entry: &Entry, steps| {
            let changed = size.with(entry, steps, step).unwrap();
            ["at", "from", "until", "for"]
                .iter()
                .filter_map(|key| changed.keys.get(*key))
                .map(ToString::to_string)
                .collect::<String>()
        };
        assert_eq!(text(Size::Length, &force, 2), r#""200ms""220ms""#);
        assert_eq!(text(Size::Begin, &force, 3), r#""30ms""80ms""#);
        assert_eq!(text(Size::Length, &ends, 1), r#""200ms""10ms""#);
        assert_eq!(text(Size::Length, &endless, 1), r#""900ms""910ms""#);
        assert_eq!(text(Size::Begin, &input, 0), r#""0ms""#);
        assert_eq!(text(Size::Length, &waits, 7), r#""70ms""#);
        assert_eq!([0.012_345, 123.4].map(three_digits), [0.0123, 123.0]);
    }
}
