//! Changes of a text: spans and what comes in their place; all else stays byte for byte.

use std::ops::Range;

use thiserror::Error;

#[derive(Debug, Clone, PartialEq, Eq)]
struct Edit {
    at: Range<u32>,
    text: String,
    /// The original's line of each line of `text`, where that has been moved.
    origins: Vec<Option<u32>>,
}

/// Changes of one text, in any order.
#[derive(Debug, Clone, Default)]
pub struct Edits {
    edits: Vec<Edit>,
}

/// Two changes want the same part of a text.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("two changes overlap at byte {at}")]
pub struct Conflict {
    /// Where the second begins.
    pub at: u32,
}

/// A piece of a changed text.
#[derive(Debug, Clone, PartialEq, Eq)]
enum Piece {
    /// A range of the original.
    Kept(Range<u32>),
    /// Text that was put in, and where its lines come from.
    New(String, Vec<Option<u32>>),
}

impl Edits {
    /// Puts `text` in front of the byte at `at`; of several at one place the first comes first.
    pub fn insert(&mut self, at: u32, text: impl Into<String>) {
        self.replace(at..at, text);
    }

    /// The same with lines that come from others of the original; lines count from 1.
    pub fn insert_moved(&mut self, at: u32, text: String, origins: Vec<Option<u32>>) {
        self.edits.push(Edit { at: at..at, text, origins });
    }

    /// Puts `text` in the place of `at`.
    pub fn replace(&mut self, at: Range<u32>, text: impl Into<String>) {
        self.edits.push(Edit { at, text: text.into(), origins: Vec::new() });
    }

    /// Takes out what changes within `place`, as changes of that part alone.
    pub fn take_within(&mut self, place: &Range<u32>) -> Self {
        let is_inside = |edit: &Edit| place.start <= edit.at.start && edit.at.end <= place.end;
        let (inside, others) = std::mem::take(&mut self.edits).into_iter().partition(is_inside);
        self.edits = others;
        let mut taken = Self { edits: inside };
        for edit in &mut taken.edits {
            edit.at = edit.at.start - place.start..edit.at.end - place.start;
        }
        taken
    }

    /// Where the first change is.
    pub fn first(&self) -> Option<u32> {
        self.edits.iter().map(|edit| edit.at.start).min()
    }

    /// True if nothing changes.
    pub fn is_empty(&self) -> bool {
        self.edits.is_empty()
    }

    /// The changed text.
    ///
    /// # Errors
    /// Two changes overlap, or one lies outside of the text.
    pub fn apply(mut self, original: &str) -> Result<Edited, Conflict> {
        self.edits.sort_by_key(|edit| (edit.at.start, edit.at.end));
        let mut pieces = Vec::new();
        let mut text = String::with_capacity(original.len() + 64 * self.edits.len());
        let mut done = 0;
        for Edit { at, text: new, origins } in self.edits {
            let kept = if at.start < done { None } else { original.get(done as usize..at.start as usize) };
            let (Some(kept), true) = (kept, original.is_char_boundary(at.end as usize)) else {
                return Err(Conflict { at: at.start });
            };
            text.push_str(kept);
            text.push_str(&new);
            pieces.push(Piece::Kept(done..at.start));
            pieces.push(Piece::New(new, origins));
            done = at.end;
        }
        text.push_str(original.get(done as usize..).unwrap_or(""));
        pieces.push(Piece::Kept(done..original.len() as u32));
        Ok(Edited { lines: line_map(original, &pieces), text })
    }
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Edited {
    pub text: String,
    /// Where its lines come from.
    pub lines: LineMap,
}

/// For each line of a changed text the line of the original it holds something of; lines count
/// from 1.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct LineMap {
    origins: Vec<Option<u32>>,
}

impl LineMap {
    /// From the line of the original for each line of the text, `None` for lines that were added.
    pub fn of(origins: Vec<Option<u32>>) -> Self {
        Self { origins }
    }

    /// Every line of `text` comes from itself.
    pub fn same(text: &str) -> Self {
        Self::of((1..=breaks(text) + 1).map(Some).collect())
    }

    /// The original's line that `line` comes from; nothing for a line that was put in.
    pub fn original(&self, line: u32) -> Option<u32> {
        let at = (line as usize).checked_sub(1)?;
        self.origins.get(at).copied().flatten()
    }

    /// The original's line of each line.
    pub fn lines(&self) -> &[Option<u32>] {
        &self.origins
    }
}

fn line_map(original: &str, pieces: &[Piece]) -> LineMap {
    let mut origins = vec![None];
    let mut line = 1;
    let mut at = 0;
    for piece in pieces {
        match piece {
            Piece::Kept(range) => {
                let passed = original.get(at as usize..range.start as usize).unwrap_or("");
                line += breaks(passed);
                at = range.end;
                for part in original.get(range.start as usize..range.end as usize).unwrap_or("").split_inclusive('\n') {
                    // A blank alone says nothing of where a line comes from, unless nothing else does.
                    if let Some(last) = origins.last_mut() {
                        *last = last.or(Some(line));
                    }
                    if part.ends_with('\n') {
                        line += 1;
                        origins.push(None);
                    }
                }
            }
            Piece::New(text, moved) => {
                let from = |line: u32| moved.get(line as usize).copied().flatten();
                if let Some(last) = origins.last_mut() {
                    *last = last.or(from(0));
                }
                origins.extend((1..=breaks(text)).map(from));
            }
        }
    }
    LineMap { origins }
}

fn breaks(text: &str) -> u32 {
    text.bytes().filter(|byte| *byte == b'\n').count() as u32
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn changes_are_made_and_nothing_else() {
        let mut edits = Edits::default();
        edits.replace(10..13, "SDSP_TON");
        edits.insert(0, "first\n");
        edits.insert(0, "second\n");
        let edited = edits.apply("Dwell\r\n : TON;\r\nä").expect("no conflict");
        assert_eq!(edited.text, "first\nsecond\nDwell\r\n : SDSP_TON;\r\nä");
        assert_eq!(edited.lines.lines(), [None, None, Some(1), Some(2), Some(3)]);
        assert_eq!(
            (edited.lines.original(3), edited.lines.original(0), edited.lines.original(9)),
            (Some(1), None, None)
        );
    }

    #[test]
    fn what_overlaps_is_reported() {
        let apply = |ranges: &[Range<u32>]| {
            let mut edits = Edits::default();
            for range in ranges {
                edits.replace(range.clone(), "x");
            }
            edits.apply("abcdäf")
        };
        assert_eq!(apply(&[0..2, 1..3]), Err(Conflict { at: 1 }));
        assert_eq!(apply(std::slice::from_ref(&(0..9))), Err(Conflict { at: 0 }));
        assert_eq!(apply(std::slice::from_ref(&(0..5))), Err(Conflict { at: 0 }));
        assert_eq!(apply(&[0..2, 2..2, 2..3]).map(|edited| edited.text), Ok("xxxdäf".to_owned()));
    }

    proptest! {
        #[test]
        fn what_is_not_changed_is_kept(text in "[a-c\n]{0,30}", places in proptest::collection::vec(0_u32..30, 0..5)) {
            let mut edits = Edits::default();
            for place in &places {
                edits.insert((*place).min(text.len() as u32), "<X\n>");
            }
            let edited = edits.apply(&text).expect("no conflict");
            prop_assert_eq!(edited.text.replace("<X\n>", ""), text);
            prop_assert_eq!(edited.lines.lines().len(), edited.text.matches('\n').count() + 1);
        }
    }
}
