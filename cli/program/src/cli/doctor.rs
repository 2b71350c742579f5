//! `onescan doctor`.

use clap::Args as ClapArgs;
use onescan_runner::doctor::{self, Build};
use onescan_runner::error::ExitCode;

use super::error::CommandError;
use super::value::FormatArg;
use super::verdict_output::VerdictOutput;

/// Options of `doctor`.
#[derive(Debug, ClapArgs)]
pub struct DoctorArgs {
    /// For people, or one JSON array for machines
    #[arg(long, value_enum, default_value_t)]
    pub format: FormatArg,
}

/// Reports what the program has, and what it finds on this machine.
///
/// # Errors
/// The report cannot be written.
pub fn doctor(args: &DoctorArgs) -> Result<ExitCode, CommandError> {
    let build = Build { version: env!("CARGO_PKG_VERSION"), has_opcua: cfg!(feature = "opcua") };
    Ok(doctor::run(build, args.format.into(), &mut VerdictOutput::lock())?)
}
