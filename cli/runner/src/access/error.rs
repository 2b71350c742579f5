//! Why nobody can be let in, or nothing can be shown.

use std::net::SocketAddr;
use std::path::PathBuf;

use onescan_base::foreign::one_line;
use onescan_report::{FileError, OutputError};
use onescan_server::access::{BadToken, RegisterError};
use onescan_server::transport::tls::CertificateFault;
use thiserror::Error;

use crate::error::{Exit, ExitCode, Unreadable};

/// Why nobody can be let in, or nothing can be shown.
#[derive(Debug, Error, miette::Diagnostic)]
pub enum AccessError {
    /// A file cannot be read.
    #[error(transparent)]
    Unreadable(#[from] Unreadable),
    /// A file cannot be written.
    #[error(transparent)]
    File(#[from] FileError),
    /// The report cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// The file of tokens is none.
    #[error("{}: {}", path.display(), one_line(why))]
    #[diagnostic(help("make it with `onescan token new`"))]
    Malformed { path: PathBuf, why: String },
    /// The file of revoked certificates is none. What cannot be read could let a revoked one in.
    #[error("{}: {}", path.display(), one_line(why))]
    #[diagnostic(help("write it with `onescan certificate revoke`"))]
    NotRevocations { path: PathBuf, why: String },
    /// Tokens do not go together.
    #[error(transparent)]
    Register(#[from] RegisterError),
    #[error(transparent)]
    Token(#[from] BadToken),
    /// There is no such token.
    #[error("{} has no token `{}`", path.display(), one_line(name))]
    #[diagnostic(help("`onescan token list` shows all"))]
    NoSuchToken { path: PathBuf, name: String },
    /// A certificate cannot be used.
    #[error("{}: {source}", path.display())]
    Certificate { path: PathBuf, source: CertificateFault },
    /// A certificate cannot be made.
    #[error("cannot make a certificate: {0}")]
    Making(rcgen::Error),
    /// A file is there that would be lost.
    #[error("{} exists", .0.display())]
    #[diagnostic(help("those who trust it would not trust another; remove it first if that is meant"))]
    Exists(PathBuf),
    /// A key without its certificate, or the other way round.
    #[error("{} is missing: a certificate and its key go together", .0.display())]
    #[diagnostic(help("make both with `onescan certificate new`"))]
    Incomplete(PathBuf),
    /// Anybody in the network could take part.
    #[error("{address} can be reached from other machines, and {missing}: anybody there could control the session")]
    #[diagnostic(help(
        "make a certificate (`onescan certificate new`) and tokens (`onescan token new`), and name their folder with \
         `--access DIR`; in a network where nobody else is, `--listen-insecure` does without (docs/security.md)"
    ))]
    OpenToAll { address: SocketAddr, missing: &'static str },
}

impl Exit for AccessError {
    fn exit_code(&self) -> ExitCode {
        match self {
            Self::File(error) => error.exit_code(),
            Self::Output(error) => error.exit_code(),
            Self::Unreadable(error) => error.exit_code(),
            Self::Token(BadToken::NoRandomness(_)) | Self::Making(_) => ExitCode::Fault,
            Self::Malformed { .. }
            | Self::NotRevocations { .. }
            | Self::Register(_)
            | Self::Token(_)
            | Self::NoSuchToken { .. }
            | Self::Certificate { .. }
            | Self::Exists(_)
            | Self::Incomplete(_)
            | Self::OpenToAll { .. } => ExitCode::WrongInput,
        }
    }
}
