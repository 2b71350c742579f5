//! Patterns of signal names: `*` stands for any characters, `?` for one. Case counts, as it does in a
//! signal's name.

use std::fmt;
use std::str::FromStr;

use onescan_base::did_you_mean;
use thiserror::Error;

use super::SignalName;

/// A name, or what many names have in common: `Position_*`, `axis[?].torque`.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct SignalPattern(String);

/// A pattern without a character.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("a pattern of signal names is not empty: write `*` for all")]
pub struct EmptyPattern;

/// A pattern that no signal has a name for.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("no signal is called `{pattern}`{}", nearest.as_ref().map(|n| format!("; {n}")).unwrap_or_default())]
pub struct Unmatched {
    pub pattern: SignalPattern,
    /// The name that may have been meant.
    pub nearest: Option<String>,
}

impl SignalPattern {
    /// True if the whole of `name` is as the pattern says.
    pub fn matches(&self, name: &str) -> bool {
        let (pattern, name) = (self.0.as_bytes(), name.as_bytes());
        let (mut p, mut n) = (0, 0);
        // Where to go on if the characters behind the last star do not fit.
        let mut star: Option<(usize, usize)> = None;
        while n < name.len() {
            match pattern.get(p) {
                Some(b'*') => {
                    star = Some((p + 1, n));
                    p += 1;
                }
                Some(byte) if *byte == b'?' || *byte == name[n] => (p, n) = (p + 1, n + 1),
                _ => match star {
                    Some((behind, from)) => {
                        (p, n) = (behind, from + 1);
                        star = Some((behind, from + 1));
                    }
                    None => return false,
                },
            }
        }
        pattern[p..].iter().all(|byte| *byte == b'*')
    }
}

/// The positions of all `names` that one of `patterns` matches, in the order of the names; of all of
/// them if there are no patterns.
///
/// # Errors
/// A pattern that matches nothing.
pub fn choose<'a>(
    patterns: &[SignalPattern],
    names: impl Iterator<Item = &'a SignalName> + Clone,
) -> Result<Vec<usize>, Unmatched> {
    for pattern in patterns {
        if !names.clone().any(|name| pattern.matches(name.as_str())) {
            let nearest = did_you_mean(&pattern.0, names.map(SignalName::as_str));
            return Err(Unmatched { pattern: pattern.clone(), nearest });
        }
    }
    let chosen = |name: &SignalName| patterns.is_empty() || patterns.iter().any(|p| p.matches(name.as_str()));
    Ok(names.enumerate().filter(|(_, name)| chosen(name)).map(|(index, _)| index).collect())
}

impl FromStr for SignalPattern {
    type Err = EmptyPattern;

    fn from_str(text: &str) -> Result<Self, EmptyPattern> {
        if text.is_empty() { Err(EmptyPattern) } else { Ok(Self(text.to_owned())) }
    }
}

/// The pattern that matches this name alone: a name has neither star nor question mark.
impl From<&SignalName> for SignalPattern {
    fn from(name: &SignalName) -> Self {
        Self(name.as_str().to_owned())
    }
}

impl fmt::Display for SignalPattern {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn matches(pattern: &str, name: &str) -> bool {
        pattern.parse::<SignalPattern>().unwrap().matches(name)
    }

    #[test]
    fn stars_and_question_marks() {
        for (pattern, name) in
            [("*", "x"), ("*", ""), ("a*", "a"), ("a*b*c", "aXbYbZc"), ("?x", "ax"), ("a[?].p*", "a[3].pos")]
        {
            assert!(matches(pattern, name), "{pattern} {name}");
        }
        for (pattern, name) in [("a", "A"), ("a*b", "abc"), ("?", ""), ("?", "ab"), ("a", "ab"), ("ab", "a")] {
            assert!(!matches(pattern, name), "{pattern} {name}");
        }
    }

    #[test]
    fn many_stars_do_not_take_for_ever() {
        assert!(!matches(&"*a".repeat(60), &"a".repeat(59)));
        assert!(!matches(&format!("{}b", "*a".repeat(40)), &"a".repeat(128)));
    }

    #[test]
    fn what_matches_nothing_is_reported() {
        let names = ["Position_1", "Position_2", "Drive"].map(|name| SignalName::new(name).unwrap());
        let pattern = |text: &str| text.parse::<SignalPattern>().unwrap();
        assert_eq!(choose(&[pattern("P*")], names.iter()), Ok(vec![0, 1]));
        assert_eq!(choose(&[], names.iter()), Ok(vec![0, 1, 2]));
        let error = choose(&[pattern("Drvie")], names.iter()).unwrap_err();
        assert_eq!(error.to_string(), "no signal is called `Drvie`; did you mean `Drive`?");
    }
}
