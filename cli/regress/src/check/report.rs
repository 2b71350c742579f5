//! What was found in all programs.

use std::collections::BTreeSet;

use onescan_iec::{Diagnostics, Finding, Severity};

use super::Warnings;
use super::passed_over::PassedOver;
use super::stubs::is_stub;
use onescan_runner::error::ExitCode;

/// The reports' word for how grave a finding is.
pub fn severity(severity: Severity) -> onescan_report::Severity {
    match severity {
        Severity::Warning => onescan_report::Severity::Warning,
        Severity::Error => onescan_report::Severity::Error,
    }
}

#[derive(Debug)]
pub struct Report {
    /// How many files were read.
    pub files: usize,
    /// The findings of each program.
    pub findings: Vec<Diagnostics>,
    /// Files of folders that were left out.
    pub passed_over: PassedOver,
}

impl Report {
    /// Every finding, in order of programs, files and places.
    pub fn iter(&self) -> impl Iterator<Item = &Finding> {
        self.findings.iter().flat_map(Diagnostics::findings)
    }

    /// How many findings are this grave.
    pub fn count(&self, severity: Severity) -> usize {
        self.iter().filter(|finding| finding.diagnostic().severity == severity).count()
    }

    /// How many files have findings.
    pub fn concerned(&self) -> usize {
        self.iter().map(Finding::file).collect::<BTreeSet<_>>().len()
    }

    /// 2 with errors, or with calls of stubs where these are denied, 1 with warnings where these are, else 0.
    pub fn exit_code(&self, warnings: Warnings, stubs: Warnings) -> ExitCode {
        let denied = stubs == Warnings::Denied && self.iter().any(is_stub);
        if denied || self.count(Severity::Error) > 0 {
            ExitCode::WrongInput
        } else if warnings == Warnings::Denied && self.count(Severity::Warning) > 0 {
            ExitCode::Unmet
        } else {
            ExitCode::Ok
        }
    }
}
