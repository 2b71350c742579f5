//! What the asserts of a test program have found (`iec/test/assert.st`).

use super::SoftPlc;
use crate::check::asserts::place;
use crate::source::LineColumn;

/// The variable in which asserts keep what they find.
const LOG: &str = "ONESCAN_ASSERTS";

/// What the asserts of one scan have found.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Asserts {
    /// How many were looked at.
    pub made: u64,
    /// Those that did not hold, in their order.
    pub failed: Vec<FailedAssert>,
    /// How many more did not hold; a scan keeps 64.
    pub lost: u32,
}

/// An assert that did not hold.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FailedAssert {
    /// What was asserted.
    pub text: String,
    /// The file.
    pub file: String,
    /// Line and column of the call.
    pub at: LineColumn,
}

impl SoftPlc {
    /// What asserts have found since this was last called; nothing in a program that has none.
    pub fn take_asserts(&mut self) -> Asserts {
        let Some((made, failed)) = self.number("made").zip(self.number("failed")) else { return Asserts::default() };
        let mut found = Asserts { made, ..Asserts::default() };
        for index in 0..failed {
            let site = self.number(&format!("sites[{index}]"));
            match site.zip(self.text(&format!("texts[{index}]"))) {
                Some((site, text)) => found.failed.push(self.failed(site, text)),
                None => found.lost += 1,
            }
        }
        for counter in ["made", "failed"] {
            // Both are there, as they were read.
            let _ = self.write(&format!("{LOG}.{counter}"), "0");
        }
        found
    }

    fn failed(&self, site: u64, text: String) -> FailedAssert {
        let (file, at) = self.application().sources().locate(place(site));
        FailedAssert { text, file: file.to_owned(), at }
    }

    fn number(&self, member: &str) -> Option<u64> {
        let variable = self.variable(&format!("{LOG}.{member}")).ok()?;
        let bytes = self.memory().get(variable.offset as usize..)?.get(..variable.size as usize)?;
        Some(bytes.iter().rev().fold(0, |value, byte| value << 8 | u64::from(*byte)))
    }

    /// A STRING: its length in two bytes, then its characters.
    fn text(&self, member: &str) -> Option<String> {
        let variable = self.variable(&format!("{LOG}.{member}")).ok()?;
        let bytes = self.memory().get(variable.offset as usize..)?.get(..variable.size as usize)?;
        let (length, characters) = bytes.split_first_chunk::<2>()?;
        let used = usize::from(u16::from_le_bytes(*length)).min(characters.len());
        Some(characters[..used].iter().copied().map(char::from).collect())
    }
}
