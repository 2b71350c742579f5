//! `onescan shot`.

use std::path::PathBuf;

use clap::{Args as ClapArgs, ValueEnum};
use onescan_server::signal::ClientName;
use onescan_server::time::VirtualTime;

use super::error::CommandError;
use super::value::client_name;
use onescan_runner::error::ExitCode;
use onescan_runner::shot::{self, ShotConfig, Size, Theme};

/// Options of `shot`.
#[derive(Debug, ClapArgs)]
pub struct ShotArgs {
    /// The scenario: a folder with a scenario.toml
    #[arg(default_value = ".")]
    pub scenario: PathBuf,
    /// A case of its cases.toml
    #[arg(long, value_name = "NAME")]
    pub case: Option<String>,
    /// Operators stand in for this client; may be given several times
    #[arg(long = "operator", value_name = "CLIENT", value_parser = client_name)]
    pub operators: Vec<ClientName>,
    /// The virtual time that is drawn
    #[arg(long, default_value = "0s", value_name = "TIME")]
    pub at: VirtualTime,
    /// The `[[view]]` that it is drawn from [default: all of the machine]
    #[arg(long, value_name = "NAME")]
    pub view: Option<String>,
    /// The picture, a PNG
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Its size in pixels
    #[arg(long, default_value = "1280x720", value_name = "WIDTHxHEIGHT")]
    pub size: Size,
    /// Its colours
    #[arg(long, value_enum, default_value_t)]
    pub theme: ThemeArg,
}

/// Colours of a picture.
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
pub enum ThemeArg {
    /// As paper
    #[default]
    Light,
    /// As a control room at night
    Dark,
}

/// Draws a session at one time.
///
/// # Errors
/// See [`CommandError`].
pub fn shot(args: ShotArgs) -> Result<ExitCode, CommandError> {
    let ShotArgs { scenario, case, operators, at, view, output, size, theme } = args;
    let theme = match theme {
        ThemeArg::Light => Theme::Light,
        ThemeArg::Dark => Theme::Dark,
    };
    let config = ShotConfig { scenario, case, operated: operators, at, view, out: output, size, theme };
    Ok(shot::run(&config, &mut std::io::stdout().lock())?)
}
