//! Names with a range, as in `arm[0..9].hold`: an array written as one name.
//!
//! A range is two whole numbers in brackets, both ends included. In a table that its name makes an
//! array, `[i]` in any other text is the index of each copy.

use std::ops::Range;

use thiserror::Error;

/// Most names that one text stands for.
pub const NAMES_MAX: usize = 10_000;

/// Why a text with a range names nothing.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum ArrayError {
    /// The second number is below the first.
    #[error("`{0}` counts down: write the lower index first")]
    Order(String),
    /// More names than anybody means.
    #[error("`{0}` stands for more than {NAMES_MAX} names")]
    Size(String),
    /// More ranges than one where only one can be counted.
    #[error("`{0}` has two ranges, where `[i]` could mean either")]
    Ranges(String),
}

/// A range in a text: the bytes with the brackets, and the indices.
struct Found {
    bytes: Range<usize>,
    first: usize,
    last: usize,
}

impl Found {
    fn count(&self) -> usize {
        (self.last - self.first).saturating_add(1)
    }
}

/// The first range in a text.
fn find(text: &str) -> Option<Found> {
    let mut at = 0;
    while let Some(open) = text[at..].find('[').map(|open| at + open) {
        let close = open + text[open..].find(']')?;
        let ends = text[open + 1..close].split_once("..");
        if let Some((Ok(first), Ok(last))) = ends.map(|(first, last)| (first.parse(), last.parse())) {
            return Some(Found { bytes: open..close + 1, first, last });
        }
        at = open + 1;
    }
    None
}

fn checked(text: &str) -> Result<Option<Found>, ArrayError> {
    match find(text) {
        Some(found) if found.last < found.first => Err(ArrayError::Order(text.to_owned())),
        Some(found) if found.count() > NAMES_MAX => Err(ArrayError::Size(text.to_owned())),
        found => Ok(found),
    }
}

/// All names that a text stands for: itself, if it has no range. Several ranges are gone through
/// like digits, the last one fastest.
///
/// # Errors
/// See [`ArrayError`].
pub fn names(text: &str) -> Result<Vec<String>, ArrayError> {
    let mut done = vec![text.to_owned()];
    while let Some(found) = checked(&done[0])? {
        if done.len().saturating_mul(found.count()) > NAMES_MAX {
            return Err(ArrayError::Size(text.to_owned()));
        }
        let mut longer = Vec::with_capacity(done.len() * found.count());
        for name in &done {
            // every name has its range where the first has it, except for the digits before it
            let Some(found) = find(name) else { continue };
            longer.extend((found.first..=found.last).map(|index| indexed(name, &found.bytes, index)));
        }
        done = longer;
    }
    Ok(done)
}

/// The indices of a table's name, none if it is one thing and no array.
///
/// # Errors
/// See [`ArrayError`]; two ranges are one too many here.
pub fn indices(name: &str) -> Result<Option<std::ops::RangeInclusive<usize>>, ArrayError> {
    let Some(found) = checked(name)? else { return Ok(None) };
    if find(&name[found.bytes.end..]).is_some() {
        return Err(ArrayError::Ranges(name.to_owned()));
    }
    Ok(Some(found.first..=found.last))
}

/// A text of the copy with this index: its own range and each `[i]` become the index.
pub fn at_index(text: &str, index: usize) -> String {
    text.replace("[i]", &format!("[{index}]"))
}

/// The name of the copy with this index.
pub fn name_at(name: &str, index: usize) -> String {
    find(name).map_or_else(|| name.to_owned(), |found| indexed(name, &found.bytes, index))
}

fn indexed(name: &str, bytes: &Range<usize>, index: usize) -> String {
    format!("{}[{index}]{}", &name[..bytes.start], &name[bytes.end..])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_stands_for_its_names() {
        assert_eq!(names("arm[2..4].hold").unwrap(), ["arm[2].hold", "arm[3].hold", "arm[4].hold"]);
        assert_eq!(names("plain.name[3]").unwrap(), ["plain.name[3]"]);
        assert_eq!(names("a[0..1].b[9..10]").unwrap(), ["a[0].b[9]", "a[0].b[10]", "a[1].b[9]", "a[1].b[10]"]);
        assert_eq!(names("a[9..10].b[0..0]").unwrap(), ["a[9].b[0]", "a[10].b[0]"]);
    }

    #[test]
    fn a_table_has_one_range() {
        assert_eq!(indices("arm[0..9]").unwrap(), Some(0..=9));
        assert_eq!(indices("arm").unwrap(), None);
        assert!(matches!(indices("a[0..1][0..1]"), Err(ArrayError::Ranges(_))));
        assert_eq!((name_at("arm[0..9]", 4), at_index("wheel[i].on", 4)), ("arm[4]".into(), "wheel[4].on".into()));
    }

    #[test]
    fn no_text_is_too_much() {
        assert!(matches!(names("a[3..1]"), Err(ArrayError::Order(_))));
        assert!(matches!(names("a[0..999][0..999]"), Err(ArrayError::Size(_))));
        assert!(matches!(names("a[0..18446744073709551615]"), Err(ArrayError::Size(_))));
        for odd in ["a[", "a[..]", "a[1..]", "a]0..1[", "[[0..1]"] {
            assert!(names(odd).is_ok(), "{odd}");
        }
    }
}
