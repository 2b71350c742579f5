//! `onescan model`.

use std::path::PathBuf;

use clap::Args as ClapArgs;
use onescan_server::nusmv::Size;

use super::error::CommandError;
use crate::model::{self, ModelConfig};
use onescan_runner::error::{ExitCode, Usage};

/// Options of `model`.
#[derive(Debug, ClapArgs)]
pub struct ModelArgs {
    /// Write server and clients as a model for the model checker NuSMV, with its specifications [default: the
    /// table of states]
    #[arg(long)]
    pub nusmv: bool,
    /// How many clients the model has
    #[arg(long, default_value_t = 2, value_name = "N", requires = "nusmv")]
    pub clients: u32,
    /// How many steps a client may sleep through after a turn
    #[arg(long, default_value_t = 5, value_name = "N", requires = "nusmv")]
    pub delay_max: u32,
    /// After how many steps virtual time restarts
    #[arg(long, default_value_t = 1000, value_name = "N", requires = "nusmv")]
    pub tv_max: u32,
    /// Write it into this file [default: standard output]
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
}

/// Writes the states of a session.
///
/// # Errors
/// See [`CommandError`].
pub fn model(args: ModelArgs) -> Result<ExitCode, CommandError> {
    let size = Size::new(args.clients, args.delay_max, args.tv_max);
    let size = size.map_err(|error| Usage::new(error.to_string(), None))?;
    let config = ModelConfig { nusmv: args.nusmv.then_some(size), output: args.output };
    model::write(&config, &mut std::io::stdout().lock())?;
    Ok(ExitCode::Ok)
}
