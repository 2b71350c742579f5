//! What the asserts of a test program have found (`iec/test/assert.st`).

use super::SoftPlc;
use crate::application::Variable;
use onescan_iec::check::asserts::place;
use onescan_iec::source::LineColumn;

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
    pub text: String,
    pub file: String,
    /// Line and column of the call.
    pub at: LineColumn,
}

impl SoftPlc {
    /// What asserts have found since this was last called; nothing in a program that has none.
    pub fn take_asserts(&mut self) -> Asserts {
        let [Some(made), Some(failed)] = ["made", "failed"].map(|counter| self.logged(counter)) else {
            return Asserts::default();
        };
        let mut found = Asserts { made: number(self.bytes(&made)), ..Asserts::default() };
        for index in 0..number(self.bytes(&failed)) {
            let site = self.logged(&format!("sites[{index}]"));
            match site.zip(self.logged(&format!("texts[{index}]"))) {
                Some((site, text)) => {
                    found.failed.push(self.failed(number(self.bytes(&site)), text_of(self.bytes(&text))));
                }
                // Counted, but beyond what the log has room for.
                None => found.lost += 1,
            }
        }
        for counter in [made, failed] {
            counter.store(&vec![0; counter.size as usize], self.memory_mut());
        }
        found
    }

    fn failed(&self, site: u64, text: String) -> FailedAssert {
        let (file, at) = self.application().sources().locate(place(site));
        FailedAssert { text, file: file.to_owned(), at }
    }

    /// A member of the log.
    fn logged(&self, member: &str) -> Option<Variable> {
        self.variable(&format!("{LOG}.{member}")).ok()
    }

    fn bytes(&self, variable: &Variable) -> &[u8] {
        let start = variable.offset as usize;
        &self.memory()[start..start + variable.size as usize]
    }
}

fn number(bytes: &[u8]) -> u64 {
    bytes.iter().rev().fold(0, |value, byte| value << 8 | u64::from(*byte))
}

/// A STRING: its length in two bytes, then its characters. The program may have written any length.
fn text_of(bytes: &[u8]) -> String {
    let (length, characters) = bytes.split_at(bytes.len().min(2));
    characters.iter().take(number(length) as usize).copied().map(char::from).collect()
}
