//! Which statements and branches of the soft PLCs were executed, as a file.

use std::path::PathBuf;

use onescan_iec_run::Coverage;
use onescan_report::{OutputError, file};
use onescan_soft_plc::CoverageSink;

use super::error::RunError;

/// How coverage is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CoverageFormat {
    Lcov,
    Cobertura,
}

/// A coverage report to write.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CoverageRequest {
    pub path: PathBuf,
    pub format: CoverageFormat,
}

impl CoverageRequest {
    /// A report in `format`; if there is none, in that of the file's extension.
    pub fn new(path: PathBuf, format: Option<CoverageFormat>) -> Self {
        let xml = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("xml"));
        let usual = if xml { CoverageFormat::Cobertura } else { CoverageFormat::Lcov };
        Self { path, format: format.unwrap_or(usual) }
    }

    /// Writes what the runs have executed; their clients are gone.
    pub(super) fn write(&self, sink: &CoverageSink) -> Result<(), RunError> {
        // A client that panicked has given nothing; the rest still counts.
        self.write_report(&sink.lock().unwrap_or_else(std::sync::PoisonError::into_inner))
    }

    /// Writes a report of this coverage.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn write_report(&self, coverage: &Coverage) -> Result<(), RunError> {
        let text = match self.format {
            CoverageFormat::Lcov => coverage.to_lcov(),
            CoverageFormat::Cobertura => coverage.to_cobertura().map_err(OutputError)?,
        };
        Ok(file::write_output(&self.path, text.as_bytes())?)
    }
}

/// How much of something was executed, in words.
pub fn share((all, some): (usize, usize)) -> String {
    let percent = (100 * some).checked_div(all);
    percent.map_or_else(|| "none".to_owned(), |percent| format!("{percent}% ({some} of {all})"))
}
