//! What a typed word means, for options of several commands.

use clap::ValueEnum;
use onescan_server::signal::{ClientName, SignalName};

use crate::run::Format;

/// See [`Format`].
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
pub enum FormatArg {
    /// For people
    #[default]
    Human,
    /// For machines
    Json,
}

impl From<FormatArg> for Format {
    fn from(arg: FormatArg) -> Self {
        match arg {
            FormatArg::Human => Self::Human,
            FormatArg::Json => Self::Json,
        }
    }
}

/// A signal, as in `axis.x`.
///
/// # Errors
/// Why it is no name.
pub fn signal_name(text: &str) -> Result<SignalName, String> {
    SignalName::new(text).map_err(|error| error.to_string())
}

/// A client of a session.
///
/// # Errors
/// Why it is no name.
pub fn client_name(text: &str) -> Result<ClientName, String> {
    ClientName::new(text).map_err(|error| error.to_string())
}
