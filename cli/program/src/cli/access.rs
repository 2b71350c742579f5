//! Who may take part: `onescan token` and `onescan certificate`, and what commands show to a session.

use std::net::{IpAddr, SocketAddr};
use std::path::PathBuf;

use clap::{Args as ClapArgs, Subcommand};
use onescan_server::access::{Day, Role};
use onescan_server::transport::tcp::Entrance;

use super::error::CommandError;
use super::value::FormatArg;
use onescan_runner::access::entrance::{TlsFiles, entrance};
use onescan_runner::access::folder::Folder;
use onescan_runner::access::tokens::Lifetime;
use onescan_runner::access::{certificate, revoked, tokens};
use onescan_runner::error::ExitCode;

/// What a command shows to a session.
#[derive(Debug, ClapArgs)]
pub struct EntranceArgs {
    /// The token to show, if the session asks for one; better in the environment, where no list of processes shows it
    #[arg(long, env = "ONESCAN_TOKEN", hide_env_values = true, value_name = "TOKEN")]
    pub token: Option<String>,
    /// Speak TLS, and trust sessions whose certificate this authority has signed: the `ca.pem` of the session's
    /// `--access` folder
    #[arg(long, env = "ONESCAN_TLS_CA", hide_env_values = true, value_name = "FILE")]
    pub tls_ca: Option<PathBuf>,
    /// Show this certificate under TLS, in place of a token, to a session that lets certificates in; its key is in
    /// `--tls-key`
    #[arg(
        long,
        env = "ONESCAN_TLS_CERT",
        hide_env_values = true,
        value_name = "FILE",
        requires = "tls_key",
        requires = "tls_ca"
    )]
    pub tls_cert: Option<PathBuf>,
    /// The private key of `--tls-cert`
    #[arg(long, env = "ONESCAN_TLS_KEY", hide_env_values = true, value_name = "FILE", requires = "tls_cert")]
    pub tls_key: Option<PathBuf>,
}

impl EntranceArgs {
    /// The way into the session at `server`.
    ///
    /// # Errors
    /// The token is none, or a file cannot be used.
    pub fn entrance(&self, server: SocketAddr) -> Result<Entrance, CommandError> {
        let own = self.tls_cert.as_deref().zip(self.tls_key.as_deref());
        let files = self.tls_ca.as_deref().map(|authority| TlsFiles { authority, own });
        Ok(entrance(server, self.token.as_deref(), files)?)
    }
}

/// Options of `token`.
#[derive(Debug, ClapArgs)]
pub struct TokenArgs {
    /// What to do
    #[command(subcommand)]
    pub wish: TokenWish,
}

/// What can be done with tokens.
#[derive(Debug, Subcommand)]
pub enum TokenWish {
    /// Make a token and print it; it is not seen again
    New(NewTokenArgs),
    /// List all tokens: names, roles, when they end
    List {
        /// The folder of those who are let in
        #[arg(long, value_name = "DIR")]
        access: PathBuf,
        /// For people, or JSON for machines
        #[arg(long, value_enum, default_value_t)]
        format: FormatArg,
    },
    /// Take a token back; sessions that run go on knowing it
    Revoke {
        /// Its name
        name: String,
        /// The folder of those who are let in
        #[arg(long, value_name = "DIR")]
        access: PathBuf,
    },
}

/// Options of `token new`.
#[derive(Debug, ClapArgs)]
pub struct NewTokenArgs {
    /// Its name, for lists and messages: who or what is to hold it
    pub name: String,
    /// What it is good for: `operator`, `trainer` (an operator who sits at the panels of trainers, too), `viewer` (an operator who changes nothing), or `client:NAME`, to take part as this client
    #[arg(long, value_name = "ROLE")]
    pub role: Role,
    /// The folder of those who are let in; it is made if it is not there
    #[arg(long, value_name = "DIR")]
    pub access: PathBuf,
    /// How many days it is good
    #[arg(long, default_value_t = 90, value_name = "N")]
    pub days: u32,
    /// The last day on which it is good, as in `2027-03-31`
    #[arg(long, value_name = "DAY", conflicts_with_all = ["days", "unlimited"])]
    pub until: Option<Day>,
    /// It is good until it is revoked
    #[arg(long, conflicts_with = "days")]
    pub unlimited: bool,
}

impl NewTokenArgs {
    fn lifetime(&self) -> Lifetime {
        match self.until {
            Some(day) => Lifetime::Until(day),
            None if self.unlimited => Lifetime::Unlimited,
            None => Lifetime::Days(self.days),
        }
    }
}

/// Makes, lists or revokes tokens.
///
/// # Errors
/// See [`CommandError`].
pub fn token(args: TokenArgs) -> Result<ExitCode, CommandError> {
    let mut out = std::io::stdout().lock();
    match args.wish {
        TokenWish::New(new) => {
            let lifetime = new.lifetime();
            tokens::new(Folder(&new.access), &new.name, new.role, lifetime, &mut out)?;
        }
        TokenWish::List { access, format } => tokens::list(Folder(&access), format.into(), &mut out)?,
        TokenWish::Revoke { name, access } => tokens::revoke(Folder(&access), &name)?,
    }
    Ok(ExitCode::Ok)
}

/// Options of `certificate`.
#[derive(Debug, ClapArgs)]
pub struct CertificateArgs {
    /// What to do
    #[command(subcommand)]
    pub wish: CertificateWish,
}

/// What can be done with certificates.
#[derive(Debug, Subcommand)]
pub enum CertificateWish {
    /// Make a certificate for sessions, and `ca.pem`, by which those who take part know it
    New {
        /// The folder of those who are let in; it is made if it is not there
        #[arg(long, value_name = "DIR")]
        access: PathBuf,
        /// An address at which sessions are reached; may be given several times. This machine itself always is one
        #[arg(long = "host", value_name = "ADDRESS")]
        hosts: Vec<IpAddr>,
        /// How many days it is good
        #[arg(long, default_value_t = 365, value_name = "N")]
        days: u32,
    },
    /// Revoke the certificate of a client or operator: sessions let it in no more, and end its connections if they run
    Revoke {
        /// Its file, as PEM; or its fingerprint, as `openssl x509 -noout -fingerprint -sha256` prints it
        #[arg(value_name = "FILE|FINGERPRINT")]
        certificate: String,
        /// The folder of those who are let in
        #[arg(long, value_name = "DIR")]
        access: PathBuf,
    },
    /// List the certificates that have been revoked: names, days, fingerprints
    Revoked {
        /// The folder of those who are let in
        #[arg(long, value_name = "DIR")]
        access: PathBuf,
        /// For people, or JSON for machines
        #[arg(long, value_enum, default_value_t)]
        format: FormatArg,
    },
}

/// Makes or revokes a certificate, or lists those that have been revoked.
///
/// # Errors
/// See [`CommandError`].
pub fn certificate(args: CertificateArgs) -> Result<ExitCode, CommandError> {
    let mut out = std::io::stdout().lock();
    match args.wish {
        CertificateWish::New { access, hosts, days } => {
            certificate::new(Folder(&access), &hosts, tokens::today(), days)?;
        }
        CertificateWish::Revoke { certificate, access } => revoked::revoke(Folder(&access), &certificate, &mut out)?,
        CertificateWish::Revoked { access, format } => revoked::list(Folder(&access), format.into(), &mut out)?,
    }
    Ok(ExitCode::Ok)
}
