//! `onescan shot`.

use std::path::PathBuf;

use clap::{Args as ClapArgs, ValueEnum};
use onescan_server::signal::ClientName;
use onescan_server::time::VirtualTime;

use super::error::CommandError;
use super::value::client_name;
use onescan_runner::error::ExitCode;
use onescan_runner::shot::{self, Film, ShotConfig, Size, Theme};

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
    /// The picture, a PNG; or the film, an animated WebP
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Its size in pixels
    #[arg(long, default_value = "1280x720", value_name = "WIDTHxHEIGHT")]
    pub size: Size,
    /// Its colours
    #[arg(long, value_enum, default_value_t)]
    pub theme: ThemeArg,
    /// A film from `--at` to `--until` in place of a picture
    #[arg(long, requires = "until")]
    pub film: bool,
    /// The virtual time at which the film ends
    #[arg(long, value_name = "TIME", requires = "film")]
    pub until: Option<VirtualTime>,
    /// Pictures a second of the film
    #[arg(long, default_value_t = 10, value_name = "N", requires = "film", value_parser = clap::value_parser!(u8).range(1..=50))]
    pub rate: u8,
    /// Seconds of virtual time in a second of the film
    #[arg(long, default_value_t = 1.0, value_name = "FACTOR", requires = "film", value_parser = speed)]
    pub speed: f64,
    /// How well the film's pictures are kept: from 0, small, to 100
    #[arg(long, default_value_t = 60, value_name = "N", requires = "film", value_parser = clap::value_parser!(u8).range(0..=100))]
    pub quality: u8,
    /// Draw a run without lockstep, on clocks that are computed from this seed (`docs/freewheel.md`)
    #[arg(long, value_name = "SEED")]
    pub freewheel: Option<u64>,
}

fn speed(text: &str) -> Result<f64, String> {
    let speed = text.parse().ok().filter(|speed: &f64| (1e-4..=1e4).contains(speed));
    speed.ok_or_else(|| format!("`{text}` is not a factor from 0.0001 to 10000"))
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
    let ShotArgs { scenario, case, operators, at, view, output, size, theme, .. } = args;
    let ShotArgs { film, until, rate, speed, quality, freewheel, .. } = args;
    let film = until.filter(|_| film).map(|until| Film { until, rate, speed, quality });
    let theme = match theme {
        ThemeArg::Light => Theme::Light,
        ThemeArg::Dark => Theme::Dark,
    };
    let config =
        ShotConfig { scenario, case, operated: operators, at, view, out: output, size, theme, film, freewheel };
    Ok(shot::run(&config, &mut std::io::stdout().lock())?)
}
