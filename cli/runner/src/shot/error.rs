//! Why there is no picture.

use std::io;
use std::process::ExitStatus;
use std::time::Duration;

use miette::Diagnostic;
use onescan_server::time::VirtualTime;
use thiserror::Error;

use super::webp::NoFilm;
use crate::error::{Exit, ExitCode};
use crate::run::RunError;

/// Why there is no picture.
#[derive(Debug, Error, Diagnostic)]
pub enum ShotError {
    /// The session cannot be run or shown, or the picture not be written: as with any run.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Run(RunError),
    /// The session ended before its time.
    #[error("the session did not come to {at}: {why}")]
    Ended {
        /// The time that was asked for.
        at: VirtualTime,
        why: String,
    },
    /// There is nothing that draws.
    #[error("{}", match named {
        Some(named) => format!("there is no browser `{named}`, as `CHROMIUM` has it"),
        None => "there is no Chromium here, which draws the picture".to_owned(),
    })]
    #[diagnostic(help(
        "install it (Debian: `apt install chromium`; Fedora: `dnf install chromium`), or name a Chrome or an Edge in the variable `CHROMIUM`"
    ))]
    NoBrowser { named: Option<String> },
    /// The browser cannot be started.
    #[error("`{program}` cannot draw: {source}")]
    Browser { program: String, source: io::Error },
    /// The browser went before it had drawn.
    #[error("`{program}` ended without a picture: {status}")]
    Gone { program: String, status: ExitStatus },
    /// The browser takes too long.
    #[error("there is no picture after {} s", .0.as_secs())]
    Late(Duration),
    /// What the page has drawn is not a film.
    #[error(transparent)]
    Film(NoFilm),
    /// The page says why.
    #[error("the page does not draw: {0}")]
    Page(String),
}

impl<E> From<E> for ShotError
where
    RunError: From<E>,
{
    fn from(error: E) -> Self {
        Self::Run(error.into())
    }
}

impl Exit for ShotError {
    fn exit_code(&self) -> ExitCode {
        match self {
            Self::Run(error) => error.exit_code(),
            Self::NoBrowser { .. } => ExitCode::WrongInput,
            Self::Ended { .. }
            | Self::Browser { .. }
            | Self::Gone { .. }
            | Self::Late(_)
            | Self::Film(_)
            | Self::Page(_) => ExitCode::Fault,
        }
    }
}
