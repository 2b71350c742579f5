//! TLS, versions 1.2 and 1.3: the certificate of a session, and whom those who take part trust.

use std::io;
use std::sync::Arc;

use rustls::client::WantsClientCert;
use rustls::crypto::ring::default_provider;
use rustls::pki_types::pem::PemObject as _;
use rustls::pki_types::{CertificateDer, PrivateKeyDer};
use rustls::server::danger::ClientCertVerifier;
use rustls::server::{VerifierBuilderError, WebPkiClientVerifier};
use rustls::{
    AlertDescription, CertificateError, ClientConfig, ConfigBuilder, InvalidMessage, RootCertStore, ServerConfig,
};
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
    /// The certificate, with those of its issuers behind it, and its key. Whoever comes may show a certificate that one
    /// of `clients`, authorities if they are given, has signed.
    ///
    /// # Errors
    /// See [`CertificateFault`].
    pub fn from_pem(certificates: &[u8], key: &[u8], clients: Option<&[u8]>) -> Result<Self, CertificateFault> {
        let chain = certificates_of(certificates)?;
        let key = PrivateKeyDer::from_pem_slice(key).map_err(|_| CertificateFault::NoKey)?;
        let builder = ServerConfig::builder_with_provider(Arc::new(default_provider()));
        let builder = builder.with_safe_default_protocol_versions().map_err(CertificateFault::Unusable)?;
        let builder = match clients {
            None => builder.with_no_client_auth(),
            Some(authorities) => builder.with_client_cert_verifier(verifier(authorities)?),
        };
        Ok(Self(Arc::new(builder.with_single_cert(chain, key).map_err(CertificateFault::Unusable)?)))
    }
}

impl Identity {
    /// For those who speak something else under TLS.
    pub fn server_config(&self) -> Arc<ServerConfig> {
        Arc::clone(&self.0)
    }
}

impl Trust {
    /// Believes what these authorities have signed, and nobody else.
    ///
    /// # Errors
    /// See [`CertificateFault`].
    pub fn from_pem(authorities: &[u8]) -> Result<Self, CertificateFault> {
        Ok(Self(Arc::new(believing(authorities)?.with_no_client_auth())))
    }

    /// The same, and shows a certificate of its own, with its key, to servers that ask for one.
    ///
    /// # Errors
    /// See [`CertificateFault`].
    pub fn showing(authorities: &[u8], certificates: &[u8], key: &[u8]) -> Result<Self, CertificateFault> {
        let chain = certificates_of(certificates)?;
        let key = PrivateKeyDer::from_pem_slice(key).map_err(|_| CertificateFault::NoKey)?;
        let config = believing(authorities)?.with_client_auth_cert(chain, key).map_err(CertificateFault::Unusable)?;
        Ok(Self(Arc::new(config)))
    }
}

fn believing(authorities: &[u8]) -> Result<ConfigBuilder<ClientConfig, WantsClientCert>, CertificateFault> {
    let builder = ClientConfig::builder_with_provider(Arc::new(default_provider()));
    let builder = builder.with_safe_default_protocol_versions().map_err(CertificateFault::Unusable)?;
    Ok(builder.with_root_certificates(roots(authorities)?))
}

fn roots(authorities: &[u8]) -> Result<RootCertStore, CertificateFault> {
    let mut roots = RootCertStore::empty();
    for authority in certificates_of(authorities)? {
        roots.add(authority).map_err(CertificateFault::Unusable)?;
    }
    Ok(roots)
}

/// Lets in who shows no certificate, as a token may do instead, and nobody whose certificate is not good.
fn verifier(authorities: &[u8]) -> Result<Arc<dyn ClientCertVerifier>, CertificateFault> {
    let roots = Arc::new(roots(authorities)?);
    let builder = WebPkiClientVerifier::builder_with_provider(roots, Arc::new(default_provider()));
    let unusable = |error: VerifierBuilderError| CertificateFault::Unusable(rustls::Error::General(error.to_string()));
    builder.allow_unauthenticated().build().map_err(unusable)
}

/// The first certificate of a file in PEM, as DER.
///
/// # Errors
/// There is none.
pub fn first_certificate(pem: &[u8]) -> Result<Vec<u8>, CertificateFault> {
    let first = certificates_of(pem)?.into_iter().next().ok_or(CertificateFault::NoCertificate)?;
    Ok(first.to_vec())
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
        rustls::Error::InvalidCertificate(
            CertificateError::NotValidYet | CertificateError::NotValidYetContext { .. },
        ) => "its certificate is not good yet".to_owned(),
        rustls::Error::InvalidCertificate(
            CertificateError::InvalidPurpose | CertificateError::InvalidPurposeContext { .. },
        ) => "its certificate is not made for this: a client needs the purpose `clientAuth`, a server `serverAuth`"
            .to_owned(),
        rustls::Error::AlertReceived(
            AlertDescription::UnknownCA | AlertDescription::BadCertificate | AlertDescription::DecryptError,
        ) => "the other side does not trust this certificate".to_owned(),
        rustls::Error::AlertReceived(AlertDescription::CertificateExpired) => {
            "this certificate has expired, or is not good yet".to_owned()
        }
        rustls::Error::AlertReceived(
            AlertDescription::UnsupportedCertificate | AlertDescription::CertificateUnknown,
        ) => "the other side cannot use this certificate: it may be made for something else".to_owned(),
        rustls::Error::PeerIncompatible(why) => {
            format!(
                "the other side speaks no version of TLS from 1.2 on, or no way of encryption that is good: {why:?}"
            )
        }
        other => other.to_string(),
    }
}
