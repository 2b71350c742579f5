//! What a typed word means, for options of several commands.

use clap::ValueEnum;
use onescan_server::signal::{ClientName, SignalName};

use crate::format::Format;

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

/// Two signals, as in `axis.x,axis.z`.
///
/// # Errors
/// Why they are not two names.
pub fn plane(text: &str) -> Result<[SignalName; 2], String> {
    let (across, up) = text.split_once(',').ok_or("write two signals with a comma between them")?;
    Ok([signal_name(across.trim())?, signal_name(up.trim())?])
}
