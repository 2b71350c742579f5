//! TLS, versions 1.2 and 1.3: the certificate of a session, and whom those who take part trust.

use std::io;
use std::sync::Arc;

use rustls::crypto::ring::default_provider;
use rustls::pki_types::pem::PemObject as _;
use rustls::pki_types::{CertificateDer, PrivateKeyDer};
use rustls::{CertificateError, ClientConfig, InvalidMessage, RootCertStore, ServerConfig};
use thiserror::Error;

/// The certificate with which a session shows who it is, and its key.
#[derive(Clone, Debug)]
pub struct Identity(pub(super) Arc<ServerConfig>);

/// The authorities whose certificates are believed.
#[derive(Clone, Debug)]
pub struct Trust(pub(super) Arc<ClientConfig>);

/// Why certificates cannot be used.
#[derive(Debug, Error)]
pub enum CertificateFault {
    /// No certificate in the file.
    #[error("there is no certificate in it: a block `BEGIN CERTIFICATE` is due")]
    NoCertificate,
    /// No key in the file.
    #[error("there is no private key in it: a block `BEGIN PRIVATE KEY` is due")]
    NoKey,
    /// The two do not go together, or one is of a kind that is not known.
    #[error("the certificate cannot be used: {0}")]
    Unusable(rustls::Error),
}

impl Identity {
    /// The certificate, with those of its issuers behind it, and its key.
    ///
    /// # Errors
    /// See [`CertificateFault`].
    pub fn from_pem(certificates: &[u8], key: &[u8]) -> Result<Self, CertificateFault> {
        let chain = certificates_of(certificates)?;
        let key = PrivateKeyDer::from_pem_slice(key).map_err(|_| CertificateFault::NoKey)?;
        let builder = ServerConfig::builder_with_provider(Arc::new(default_provider()));
        let config = builder
            .with_safe_default_protocol_versions()
            .and_then(|builder| builder.with_no_client_auth().with_single_cert(chain, key))
            .map_err(CertificateFault::Unusable)?;
        Ok(Self(Arc::new(config)))
    }
}

impl Trust {
    /// Believes what these authorities have signed, and nobody else.
    ///
    /// # Errors
    /// See [`CertificateFault`].
    pub fn from_pem(authorities: &[u8]) -> Result<Self, CertificateFault> {
        let mut roots = RootCertStore::empty();
        for authority in certificates_of(authorities)? {
            roots.add(authority).map_err(CertificateFault::Unusable)?;
        }
        let builder = ClientConfig::builder_with_provider(Arc::new(default_provider()));
        let builder = builder.with_safe_default_protocol_versions().map_err(CertificateFault::Unusable)?;
        Ok(Self(Arc::new(builder.with_root_certificates(roots).with_no_client_auth())))
    }
}

fn certificates_of(pem: &[u8]) -> Result<Vec<CertificateDer<'static>>, CertificateFault> {
    let found: Result<Vec<_>, _> = CertificateDer::pem_slice_iter(pem).collect();
    found.ok().filter(|found| !found.is_empty()).ok_or(CertificateFault::NoCertificate)
}

/// Why no TLS came of a connection, in words for whoever began or took it.
pub(super) fn reason(error: &io::Error) -> String {
    let Some(error) = error.get_ref().and_then(|inner| inner.downcast_ref::<rustls::Error>()) else {
        return error.to_string();
    };
    match error {
        rustls::Error::InvalidMessage(InvalidMessage::InvalidContentType | InvalidMessage::MessageTooLarge) => {
            "the other side does not speak TLS".to_owned()
        }
        rustls::Error::InvalidCertificate(CertificateError::UnknownIssuer | CertificateError::BadSignature) => {
            "its certificate is a stranger's: no trusted authority has signed it".to_owned()
        }
        rustls::Error::InvalidCertificate(
            CertificateError::NotValidForName | CertificateError::NotValidForNameContext { .. },
        ) => "its certificate is for another address: make it again with the address as `--host`".to_owned(),
        rustls::Error::InvalidCertificate(CertificateError::Expired | CertificateError::ExpiredContext { .. }) => {
            "its certificate has expired".to_owned()
        }
        rustls::Error::AlertReceived(rustls::AlertDescription::UnknownCA) => {
            "the other side does not trust this certificate".to_owned()
        }
        rustls::Error::PeerIncompatible(why) => {
            format!(
                "the other side speaks no version of TLS from 1.2 on, or no way of encryption that is good: {why:?}"
            )
        }
        other => other.to_string(),
    }
}
