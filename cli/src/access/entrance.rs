//! What is shown to a session that another process serves.

use std::net::SocketAddr;
use std::path::Path;

use onescan_base::regular::{self, Limit};
use onescan_server::access::Token;
use onescan_server::transport::tcp::Entrance;
use onescan_server::transport::tls::Trust;

use super::AccessError;
use crate::error::Unreadable;

/// The way into the session at `address`: with a token, if one is given, and under TLS, if an authority is.
///
/// # Errors
/// The token is none, or the file of the authority cannot be used.
pub fn entrance(address: SocketAddr, token: Option<&str>, authority: Option<&Path>) -> Result<Entrance, AccessError> {
    let token = token.map(str::parse::<Token>).transpose()?;
    let trust = authority.map(trust).transpose()?;
    Ok(Entrance { address, token, trust })
}

fn trust(path: &Path) -> Result<Trust, AccessError> {
    let bytes = regular::read(path, Limit::TEXT).map_err(Unreadable::at(path))?;
    Trust::from_pem(&bytes).map_err(|source| AccessError::Certificate { path: path.to_owned(), source })
}
