//! Who is let in to an OPC UA server of this program, for commands that serve one.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use clap::Args as ClapArgs;
use onescan_links::opcua::Access;

use super::error::CommandError;
use onescan_runner::access::folder::Folder;
use onescan_runner::error::Usage;

/// Options of commands that serve OPC UA.
#[derive(Debug, ClapArgs)]
pub struct AccessArgs {
    /// The only OPC UA user, whose password is in the environment variable `ONESCAN_OPCUA_PASSWORD` [default:
    /// anybody]
    #[arg(long, value_name = "NAME")]
    pub opcua_user: Option<String>,
    /// Folder with the OPC UA server's certificates and those it trusts; with it nobody is let in without
    /// security
    #[arg(long, value_name = "DIR")]
    pub opcua_pki: Option<PathBuf>,
    /// Trust the certificate of any OPC UA client
    #[arg(long, requires = "opcua_pki")]
    pub opcua_trust: bool,
    /// Let in OPC UA clients whose certificate was made for an application of another URI
    #[arg(long, requires = "opcua_pki")]
    pub opcua_foreign_uri: bool,
    /// Let a user's password come over a connection without security, where everybody on the way can read it
    #[arg(long)]
    pub opcua_plain_password: bool,
}

impl AccessArgs {
    /// Who is let in where tokens of `folder` count: their holders, with the token as password.
    ///
    /// # Errors
    /// Tokens would come in plain text, or the folder cannot be used.
    pub fn access_with_tokens(self, folder: &Path) -> Result<Access, CommandError> {
        if self.opcua_user.is_some() {
            let help = Some("make a token for this user: `onescan token new NAME --role operator`".to_owned());
            return Err(Usage::new("with `--access` users over OPC UA are those of its tokens", help).into());
        }
        if self.opcua_pki.is_none() && !self.opcua_plain_password {
            let help = "encrypt them with certificates, `--opcua-pki DIR`, or permit it with `--opcua-plain-password`";
            return Err(Usage::new("tokens would come over OPC UA in plain text", Some(help.to_owned())).into());
        }
        let register = Some(Arc::new(Folder(folder).register()?));
        Ok(Access { register, ..self.access()? })
    }

    /// Who is let in.
    ///
    /// # Errors
    /// The user has no password, or it would come in plain text.
    pub fn access(self) -> Result<Access, CommandError> {
        const PASSWORD: &str = "ONESCAN_OPCUA_PASSWORD";
        if let (Some(user), None, false) = (&self.opcua_user, &self.opcua_pki, self.opcua_plain_password) {
            let help = "encrypt it with certificates, `--opcua-pki DIR`, or permit it with `--opcua-plain-password`";
            let message = format!("the password of user `{user}` would come over the network in plain text");
            return Err(Usage::new(message, Some(help.to_owned())).into());
        }
        let user = match self.opcua_user {
            None => None,
            Some(user) => {
                let Ok(password) = std::env::var(PASSWORD) else {
                    let help = Some(format!("set the environment variable {PASSWORD}"));
                    return Err(Usage::new(format!("there is no password for user `{user}`"), help).into());
                };
                Some((user, password))
            }
        };
        Ok(Access {
            user,
            register: None,
            pki: self.opcua_pki,
            trust_clients: self.opcua_trust,
            foreign_uris: self.opcua_foreign_uri,
        })
    }
}
