//! What is shown to a session that another process serves.

use std::net::SocketAddr;
use std::path::Path;

use onescan_base::regular::{self, Limit};
use onescan_server::access::Token;
use onescan_server::transport::tcp::Entrance;
use onescan_server::transport::tls::Trust;

use super::AccessError;
use crate::error::Unreadable;

/// The files of TLS.
#[derive(Clone, Copy, Debug)]
pub struct TlsFiles<'f> {
    /// The authority that must have signed the server's certificate.
    pub authority: &'f Path,
    /// A certificate of one's own, and its key.
    pub own: Option<(&'f Path, &'f Path)>,
}

/// The way into the session at `address`: with a token, if one is given, and under TLS, if its files are.
///
/// # Errors
/// The token is none, or a file cannot be used.
pub fn entrance(address: SocketAddr, token: Option<&str>, tls: Option<TlsFiles<'_>>) -> Result<Entrance, AccessError> {
    let token = token.map(str::parse::<Token>).transpose()?;
    let trust = tls.map(trust).transpose()?;
    Ok(Entrance { address, token, trust })
}

fn trust(files: TlsFiles<'_>) -> Result<Trust, AccessError> {
    let read = |path: &Path| regular::read(path, Limit::TEXT).map_err(Unreadable::at(path));
    let wrong = |path: &Path| {
        let path = path.to_owned();
        move |source| AccessError::Certificate { path, source }
    };
    let authority = read(files.authority)?;
    let trust = Trust::from_pem(&authority).map_err(wrong(files.authority))?;
    match files.own {
        None => Ok(trust),
        Some((certificate, key)) => {
            Trust::showing(&authority, &read(certificate)?, &read(key)?).map_err(wrong(certificate))
        }
    }
}
