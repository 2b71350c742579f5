//! PLC sources checked without being run.
//!
//! | module | subject |
//! |---|---|
//! | [`collect`] | which files are meant, and what is in them |
//! | `listed` | where the files of a project are |
//! | [`passed_over`] | which files of folders are left out |
//! | [`report`] | how the findings are shown |
//! | [`human`] | for people |
//! | [`json`] | a JSON object a finding |
//! | [`sarif`] | SARIF 2.1.0, which code hosts and editors read |
//! | [`stubs`] | declarations of libraries that are not there |
//! | [`explain`] | the page behind a code |

pub mod collect;
mod error;
pub mod explain;
pub mod human;
pub mod json;
mod listed;
pub mod passed_over;
pub mod report;
pub mod sarif;
pub mod stubs;

use std::io::Write;
use std::path::PathBuf;

use onescan_iec::{Dialect, MemoryLimit, WordSize, inspect_within};
use onescan_iec_run::{Application, BuildError};
use onescan_report::OutputError;
use onescan_runner::error::Usage;

pub use error::CheckError;

use collect::{Collected, Program, Reading};
use onescan_runner::error::ExitCode;
use report::Report;

/// For whom the findings are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CheckFormat {
    #[default]
    Human,
    /// Machines: one JSON object a finding and line.
    Json,
    /// Machines: one SARIF log.
    Sarif,
}

/// What is asked for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CheckConfig {
    /// Files, folders and scenarios.
    pub paths: Vec<PathBuf>,
    /// The dialect of all files, if not the one that each file's name says.
    pub dialect: Option<Dialect>,
    /// Bits of the registers of the target, if not those that scenarios and files say.
    pub word_size: Option<WordSize>,
    /// How much memory variables may take, if not what a scenario says or the default.
    pub memory_limit: Option<MemoryLimit>,
    /// Sources of libraries that the files use.
    pub libraries: Vec<PathBuf>,
    /// For whom the findings are.
    pub format: CheckFormat,
    /// Whether warnings alone make the check fail.
    pub warnings: Warnings,
    /// Whether calls of stubs make it fail, as errors do.
    pub stubs: Warnings,
}

impl CheckConfig {
    fn reading(&self) -> Reading<'_> {
        let Self { dialect, word_size, memory_limit, .. } = *self;
        Reading { dialect, word_size, memory_limit, libraries: &self.libraries }
    }
}

/// What becomes of a check that has found nothing but warnings.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Warnings {
    /// They are reported, and the exit code is 0.
    #[default]
    Allowed,
    /// They make it fail.
    Denied,
}

/// Checks the sources and writes what is found to `out`.
///
/// # Errors
/// A file cannot be read, or the report not be written. What is wrong with the sources is not an error
/// here but an exit code.
pub fn check(config: &CheckConfig, out: &mut dyn Write) -> Result<ExitCode, CheckError> {
    let Collected { programs, passed_over } = collect::collect(&config.paths, config.reading())?;
    let files = programs.iter().map(|program| program.inputs.len()).sum();
    let mut findings = Vec::new();
    for program in programs {
        let Program { inputs, client, scenario, plan, memory_limit } = program;
        let Some((scenario, client)) = scenario.zip(client) else {
            findings.push(inspect_within(memory_limit, inputs, plan.as_ref()));
            continue;
        };
        match Application::builder().inputs(inputs).memory_limit(memory_limit).inspected(plan).build() {
            Ok(application) => {
                scenario.tasks_suit(&client, &application)?;
                findings.push(application.warnings().clone());
                findings.extend(scenario.undriven_in(&client, application)?);
            }
            Err(BuildError::Sources(found)) => findings.push(found),
            Err(BuildError::Constant(error)) => return Err(Usage::new(error.to_string(), None).into()),
        }
    }
    let report = Report { files, findings, passed_over };
    let written = match config.format {
        CheckFormat::Human => human::write(&report, out),
        CheckFormat::Json => json::write(&report, out),
        CheckFormat::Sarif => sarif::write(&report, out),
    };
    written.map_err(OutputError)?;
    Ok(report.exit_code(config.warnings, config.stubs))
}
