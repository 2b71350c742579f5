//! A place in a file that a scene names: of a robot, of a kind of the user's own.

use std::ops::Range;
use std::sync::Arc;

use onescan_server::client::SourcePlace;

/// A file that a scene names.
#[derive(Debug, PartialEq, Eq)]
pub struct Source {
    /// What it is called in faults.
    pub file: String,
    /// Its text, shared: a file may have many faults.
    pub text: Arc<str>,
}

/// A place in a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    pub source: Arc<Source>,
    /// Bytes of its text.
    pub span: Range<usize>,
}

impl Place {
    /// Line and column, from 1.
    pub fn start(&self) -> SourcePlace {
        let before = self.source.text.get(..self.span.start).unwrap_or(&self.source.text);
        let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
        SourcePlace {
            file: self.source.file.clone(),
            line: before.matches('\n').count() as u32 + 1,
            column: before[line_start..].chars().count() as u32 + 1,
        }
    }
}
