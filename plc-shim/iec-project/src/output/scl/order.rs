//! The order of blocks in a source: what others use comes first, since TIA Portal reads from top to bottom.

use std::collections::{BTreeMap, BTreeSet};

use onescan_iec::diagnostic::Diagnostic;

/// Something that is written, and the names that its text mentions.
pub(super) struct Part {
    /// Its name in capitals.
    pub(super) key: String,
    pub(super) text: String,
    /// True if it is written whether others use it or not.
    pub(super) is_wanted: bool,
    /// The names that it uses, in capitals.
    pub(super) uses: BTreeSet<String>,
    /// What of it SCL has not.
    pub(super) findings: Vec<Diagnostic>,
}

/// The wanted parts and what they use, each behind what it uses itself, else in their order.
pub(super) fn ordered(parts: Vec<Part>) -> Vec<Part> {
    let by_key: BTreeMap<&str, usize> = parts.iter().enumerate().map(|(at, part)| (part.key.as_str(), at)).collect();
    let mut state = vec![State::New; parts.len()];
    let mut order = Vec::new();
    for (at, _) in parts.iter().enumerate().filter(|(_, part)| part.is_wanted) {
        // Ends, since every part is opened once.
        let mut open = vec![at];
        while let Some(top) = open.last().copied() {
            let Some((part, now)) = parts.get(top).zip(state.get_mut(top)) else { break };
            if *now == State::New {
                *now = State::Open;
                let used = part.uses.iter().filter_map(|name| by_key.get(name.as_str()).copied());
                let mut used: Vec<usize> = used.filter(|used| state.get(*used) == Some(&State::New)).collect();
                used.sort_unstable();
                open.extend(used.into_iter().rev());
                continue;
            }
            open.pop();
            if *now == State::Open {
                *now = State::Done;
                order.push(top);
            }
        }
    }
    let mut parts: Vec<Option<Part>> = parts.into_iter().map(Some).collect();
    order.into_iter().filter_map(|at| parts.get_mut(at)?.take()).collect()
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum State {
    New,
    Open,
    Done,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_used_comes_first() {
        let part = |key: &str, uses: &[&str], is_wanted| Part {
            key: key.to_owned(),
            text: key.to_owned(),
            is_wanted,
            uses: uses.iter().map(|name| (*name).to_owned()).collect(),
            findings: Vec::new(),
        };
        let parts = vec![
            part("A", &["C", "X", "A"], true),
            part("B", &[], true),
            part("C", &["D", "B"], false),
            part("D", &["A"], false),
            part("E", &[], false),
        ];
        let keys: Vec<String> = ordered(parts).into_iter().map(|part| part.key).collect();
        assert_eq!(keys, ["B", "D", "C", "A"]);
    }
}
