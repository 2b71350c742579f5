//! Signals written as arrays and patterns.
//!
//! In `[signals]` and in a plot's list, a name with a range, as `"SW_ARM[0..2].IN_ARM_AT_INPUT"`, stands for
//! all of its names. Under `bind`, on the left:
//!
//! | left | right | meaning |
//! |---|---|---|
//! | `"a[0..2].x"` | `"P.b[3..5].y"` | one to one, as many on both sides |
//! | `ready` | `"P.arm[0..9].ready"` | one signal for many variables that are read |
//! | `"SW_*"` | `"P.*"` | every declared signal of that form; what `*` stands for goes to the right |
//!
//! A gateway's `reads` takes names, ranges and patterns.
//!
//! A name goes before a range, and a range before a pattern.

use std::collections::{BTreeMap, BTreeSet};

use onescan_base::array;
use onescan_server::signal::{SignalName, did_you_mean};
use toml::Spanned;

use super::file::ScenarioFile;

/// What is wrong, where in the file if that is known, and what to do.
#[derive(Debug)]
pub(crate) struct Wrong {
    pub(crate) message: String,
    pub(crate) place: Option<std::ops::Range<usize>>,
    pub(crate) help: Option<String>,
}

impl Wrong {
    fn new(message: impl Into<String>, place: Option<std::ops::Range<usize>>) -> Self {
        Self { message: message.into(), place, help: None }
    }

    /// Wrong at a place of the file.
    pub(crate) fn at(message: impl Into<String>, place: std::ops::Range<usize>) -> Self {
        Self::new(message, Some(place))
    }
}

/// Expands the arrays among the signals of the plot.
pub(crate) fn expand_plot(file: &mut ScenarioFile) -> Result<(), Wrong> {
    let mut shown = Vec::new();
    for signal in &file.plot.signals {
        let names = names(signal.get_ref().as_str(), signal.span())?;
        shown.extend(names.into_iter().map(|name| Spanned::new(signal.span(), name)));
    }
    file.plot.signals = shown;
    Ok(())
}

pub(crate) fn names(text: &str, place: std::ops::Range<usize>) -> Result<Vec<SignalName>, Wrong> {
    let names = array::names(text).map_err(|error| Wrong::new(error.to_string(), Some(place.clone())))?;
    let named = |name: String| SignalName::new(name).map_err(|bad| Wrong::new(bad.to_string(), Some(place.clone())));
    names.into_iter().map(named).collect()
}

/// The variables of each signal that a PLC's `bind` names.
pub(crate) fn bound(
    bind: &BTreeMap<String, String>,
    declared: &[&SignalName],
) -> Result<BTreeMap<SignalName, Vec<String>>, Wrong> {
    let mut found: BTreeMap<SignalName, (Rank, Vec<String>)> = BTreeMap::new();
    for (left, right) in bind {
        for (signal, rank, paths) in pairs(left, right, declared)? {
            match found.get(&signal) {
                Some((before, _)) if *before < rank => {}
                Some((before, _)) if *before == rank => {
                    let message = format!("`bind` names signal `{signal}` twice; the second time by `{left}`");
                    return Err(Wrong::new(message, None));
                }
                _ => {
                    found.insert(signal, (rank, paths));
                }
            }
        }
    }
    Ok(found.into_iter().map(|(signal, (_, paths))| (signal, paths)).collect())
}

/// What goes before what.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Rank {
    Name,
    Range,
    Pattern,
}

fn pairs(left: &str, right: &str, declared: &[&SignalName]) -> Result<Vec<(SignalName, Rank, Vec<String>)>, Wrong> {
    if left.contains('*') {
        return by_pattern(left, right, declared);
    }
    let signals = array::names(left).map_err(|error| Wrong::new(error.to_string(), None))?;
    let paths = array::names(right).map_err(|error| Wrong::new(error.to_string(), None))?;
    for signal in &signals {
        if !declared.iter().any(|known| known.as_str() == signal) {
            let help = did_you_mean(signal, declared.iter().map(|known| known.as_str()));
            return Err(Wrong {
                help,
                ..Wrong::new(format!("`bind` names a signal `{signal}` that is not declared"), None)
            });
        }
    }
    let (count, others) = (signals.len(), paths.len());
    if let [only] = &signals[..] {
        return Ok(vec![(name(only)?, Rank::Name, paths)]);
    }
    if count != others {
        let message = format!("`bind` has {count} signals `{left}` for {others} variables `{right}`");
        return Err(Wrong::new(message, None));
    }
    let paired = signals.iter().zip(paths);
    paired.map(|(signal, path)| Ok((name(signal)?, Rank::Range, vec![path]))).collect()
}

fn name(text: &str) -> Result<SignalName, Wrong> {
    SignalName::new(text).map_err(|bad| Wrong::new(bad.to_string(), None))
}

fn by_pattern(
    left: &str,
    right: &str,
    declared: &[&SignalName],
) -> Result<Vec<(SignalName, Rank, Vec<String>)>, Wrong> {
    let (stars, wanted) = (left.matches('*').count(), right.matches('*').count());
    if wanted != stars {
        let message = format!("`bind` has {stars} `*` in `{left}` and {wanted} in `{right}`");
        return Err(Wrong::new(message, None));
    }
    let matching = declared.iter().filter_map(|signal| {
        let parts = matched(left, signal.as_str())?;
        let mut path = String::with_capacity(right.len());
        for (k, piece) in right.split('*').enumerate() {
            path.push_str(if k == 0 { "" } else { parts[k - 1] });
            path.push_str(piece);
        }
        Some(((*signal).clone(), Rank::Pattern, vec![path]))
    });
    let found: Vec<_> = matching.collect();
    if found.is_empty() {
        return Err(Wrong::new(format!("`bind` has a pattern `{left}`, but no signal is of that form"), None));
    }
    Ok(found)
}

/// The declared signals that a list under `key` names by name, range or pattern, in the order of the list, each once.
///
/// # Errors
/// A name that is not declared, a pattern of which no signal is.
pub(crate) fn chosen(key: &str, list: &[String], declared: &[&SignalName]) -> Result<Vec<SignalName>, Wrong> {
    let (mut found, mut seen) = (Vec::new(), BTreeSet::new());
    for text in list {
        if text.contains('*') {
            let before = found.len();
            let matching = declared.iter().filter(|signal| matched(text, signal.as_str()).is_some());
            found.extend(matching.filter(|signal| seen.insert(**signal)).map(|signal| (*signal).clone()));
            if found.len() == before {
                let message = format!("`{key}` has a pattern `{text}`, but no other signal is of that form");
                return Err(Wrong::new(message, None));
            }
            continue;
        }
        for signal in array::names(text).map_err(|error| Wrong::new(error.to_string(), None))? {
            let Some(known) = declared.iter().find(|known| known.as_str() == signal) else {
                let help = did_you_mean(&signal, declared.iter().map(|known| known.as_str()));
                let message = format!("`{key}` names a signal `{signal}` that is not declared");
                return Err(Wrong { help, ..Wrong::new(message, None) });
            };
            if seen.insert(known) {
                found.push((*known).clone());
            }
        }
    }
    Ok(found)
}

/// What each `*` of a pattern stands for in a text, each as short as can be; none if it does not match.
fn matched<'t>(pattern: &str, text: &'t str) -> Option<Vec<&'t str>> {
    let mut pieces = pattern.split('*');
    let mut rest = text.strip_prefix(pieces.next()?)?;
    let mut pieces: Vec<&str> = pieces.collect();
    let last = pieces.pop()?;
    let mut parts = Vec::new();
    for piece in pieces {
        let (part, behind) = rest.split_once(piece)?;
        parts.push(part);
        rest = behind;
    }
    parts.push(rest.strip_suffix(last)?);
    Some(parts)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bind(entries: &[(&str, &str)], declared: &[&str]) -> Result<Vec<(String, Vec<String>)>, String> {
        let entries = entries.iter().map(|(l, r)| ((*l).to_owned(), (*r).to_owned())).collect();
        let declared: Vec<_> = declared.iter().map(|name| SignalName::new(*name).unwrap()).collect();
        let found = bound(&entries, &declared.iter().collect::<Vec<_>>()).map_err(|wrong| wrong.message)?;
        Ok(found.into_iter().map(|(signal, paths)| (signal.to_string(), paths)).collect())
    }

    fn texts(pairs: &[(&str, &[&str])]) -> Vec<(String, Vec<String>)> {
        pairs.iter().map(|(a, b)| ((*a).to_owned(), b.iter().map(|b| (*b).to_owned()).collect())).collect()
    }

    #[test]
    fn ranges_go_one_to_one_or_to_many() {
        let found = bind(&[("a[0..1].x", "P.b[3..4]"), ("r", "P.c[0..2].r")], &["a[0].x", "a[1].x", "r"]).unwrap();
        let all: &[&str] = &["P.c[0].r", "P.c[1].r", "P.c[2].r"];
        assert_eq!(found, texts(&[("a[0].x", &["P.b[3]"]), ("a[1].x", &["P.b[4]"]), ("r", all)]));
        assert!(bind(&[("a[0..1]", "P.b[0..2]")], &["a[0]", "a[1]"]).unwrap_err().contains("2 signals"));
        assert!(bind(&[("a[0..2]", "P.b[0..2]")], &["a[0]", "a[1]"]).unwrap_err().contains("`a[2]` that is not"));
    }

    #[test]
    fn a_list_chooses_by_name_range_and_pattern() {
        let declared = ["a[0].x", "a[1].x", "b", "c"].map(|name| SignalName::new(name).unwrap());
        let of = |list: &[&str]| {
            let list: Vec<_> = list.iter().map(|text| (*text).to_owned()).collect();
            let found = chosen("reads", &list, &declared.iter().collect::<Vec<_>>());
            found.map_or_else(
                |wrong| wrong.message,
                |found| found.iter().map(SignalName::as_str).collect::<Vec<_>>().join(" "),
            )
        };
        assert_eq!(of(&["b", "a[0..1].x", "b"]), "b a[0].x a[1].x");
        assert_eq!(of(&["a[*", "c"]), "a[0].x a[1].x c");
        assert_eq!(of(&["a[0..2].x"]), "`reads` names a signal `a[2].x` that is not declared");
        assert_eq!(of(&["d*"]), "`reads` has a pattern `d*`, but no other signal is of that form");
    }

    #[test]
    fn a_pattern_takes_what_it_stands_for_along() {
        let found = bind(&[("SW_*.*", "P.*.in_*"), ("SW_b.x", "Q.x")], &["SW_a.x", "SW_b.x", "other"]).unwrap();
        assert_eq!(found, texts(&[("SW_a.x", &["P.a.in_x"]), ("SW_b.x", &["Q.x"])]));
        assert!(bind(&[("L*", "P.*")], &["SW_a"]).unwrap_err().contains("no signal is of that form"));
        assert!(bind(&[("S*", "P.a")], &["SW_a"]).unwrap_err().contains("1 `*`"));
        assert!(bind(&[("S*", "P.*"), ("*a", "Q.*")], &["Sa"]).unwrap_err().contains("twice"));
    }
}
