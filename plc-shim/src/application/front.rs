//! Files to trees and the checked program, with all that is wrong with them.

use std::collections::BTreeSet;

use super::library;
use crate::check::{Checked, check};
use crate::diagnostic::{Diagnostic, Severity};
use crate::input::Input;
use crate::syntax::ast::CompilationUnit;
use crate::syntax::{FileId, SourceFile, SourceMap, parse_in};

/// What is known of files once they have been checked.
pub(crate) struct Front {
    pub(crate) sources: SourceMap,
    /// The trees of the user's files and of the standard function blocks.
    pub(crate) units: Vec<(FileId, CompilationUnit)>,
    /// The files of the standard function blocks.
    pub(crate) library: BTreeSet<FileId>,
    pub(crate) checked: Checked,
    pub(crate) findings: Vec<Diagnostic>,
}

impl Front {
    pub(crate) fn new(inputs: impl IntoIterator<Item = Input>) -> Self {
        let mut sources = SourceMap::default();
        let mut findings = Vec::new();
        let mut library = BTreeSet::new();
        for input in inputs {
            findings.extend(input.add_to(&mut sources));
        }
        for (name, text) in library::FILES {
            library.insert(sources.add(SourceFile::new(name, text)));
        }
        let mut units = Vec::new();
        for (id, file) in sources.iter() {
            let parsed = parse_in(file.dialect(), id, file.text());
            findings.extend(parsed.diagnostics);
            units.push((id, parsed.unit));
        }
        let trees: Vec<_> = units.iter().map(|(id, unit)| (*id, unit)).collect();
        let (checked, found) = check(&trees, &library);
        findings.extend(found);
        Self { sources, units, library, checked, findings }
    }

    pub(crate) fn has_errors(&self) -> bool {
        self.findings.iter().any(|found| found.severity == Severity::Error)
    }
}
