//! What the process of a submission says, a line of JSON at a time: what it had said before it was ended counts.

use onescan_base::foreign::one_line;
use onescan_iec::Finding;
use onescan_server::client::SourcePlace;
use serde::{Deserialize, Serialize};

use crate::regress::ran::{Covered, Ran};

/// Findings that are said of a submission; nobody reads more.
const REMARKS_MAX: usize = 50;

/// What a line says, in the order in which they come.
#[derive(Debug, Serialize, Deserialize)]
pub(super) enum Line {
    /// The sources compile, and the cases come next.
    Read(Read),
    /// Nothing can be run, and no line follows.
    Refused(Refused),
    /// A case was run, by its number.
    Ran(usize, Box<Ran>),
    /// The statements that have to do with an expectation that was violated.
    Found(Found),
    /// The lines to be looked at first.
    Suspects(Vec<Suspect>),
    /// What was executed in all cases.
    Covered(Vec<Covered>),
    /// The last line: without it the process was ended before its time.
    Done,
}

/// A program that compiles.
#[derive(Debug, Default, Serialize, Deserialize)]
pub(super) struct Read {
    /// A hash of what it is like.
    pub(super) structure: String,
    /// True if it is like the task's own, which is to be completed.
    pub(super) is_as_handed_out: bool,
    /// What the compiler warns of, which costs no marks.
    pub(super) warnings: Remarks,
}

/// Why nothing can be run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Refused {
    pub(super) why: String,
    /// What is wrong in its sources.
    pub(super) errors: Remarks,
}

/// What the compiler found, at most [`REMARKS_MAX`] of it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Remarks {
    /// The first of them.
    pub(super) shown: Vec<Remark>,
    /// How many there are.
    pub(super) all: usize,
}

/// A finding in a source.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Remark {
    pub(super) code: String,
    pub(super) place: SourcePlace,
    /// What was found, and what to do about it.
    pub(super) text: String,
}

/// What statements have to do with a violated expectation.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Found {
    /// The case and the expectation, by their numbers.
    pub(super) case: usize,
    pub(super) item: usize,
    /// The statement that is most likely the mistake: where the run parts from a solution's, else what wrote a signal.
    pub(super) place: Option<SourcePlace>,
    /// In words, a line each.
    pub(super) lines: Vec<String>,
}

/// A line of the submission that may well be the mistake.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Suspect {
    pub(super) file: String,
    pub(super) line: u32,
    /// What is known against it, in words.
    pub(super) why: String,
}

impl Remarks {
    /// The first of these findings.
    pub(super) fn of<'f>(findings: impl Iterator<Item = &'f Finding>) -> Self {
        let mut remarks = Self::default();
        for finding in findings {
            remarks.all += 1;
            if remarks.shown.len() < REMARKS_MAX {
                remarks.shown.push(Remark::from(finding));
            }
        }
        remarks
    }

    /// As they are shown, a line each, at most so many of them.
    pub(super) fn lines(&self, most: usize) -> Vec<String> {
        let shown = self.shown.iter().take(most);
        let mut lines: Vec<String> =
            shown.map(|Remark { code, place, text }| format!("{place}: {code}: {text}")).collect();
        if let Some(more @ 1..) = self.all.checked_sub(lines.len()) {
            lines.push(format!("... and {more} more: see `onescan check`"));
        }
        lines
    }
}

impl From<&Finding> for Remark {
    fn from(finding: &Finding) -> Self {
        let (found, start) = (finding.diagnostic(), finding.start());
        let place = SourcePlace { file: finding.file().to_owned(), line: start.line, column: start.column };
        Self { code: found.code.text().to_owned(), place, text: one_line(&found.with_its_help()).into_owned() }
    }
}

impl Refused {
    pub(super) fn because(why: &str) -> Self {
        Self { why: one_line(why).into_owned(), errors: Remarks::default() }
    }
}

/// An error with its help, as one line.
pub(super) fn text_of(error: &dyn miette::Diagnostic) -> String {
    let help = error.help().map(|help| format!(" ({help})")).unwrap_or_default();
    one_line(&format!("{error}{help}")).into_owned()
}
