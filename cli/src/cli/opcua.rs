//! Who is let in to an OPC UA server of this program, for commands that serve one.

use std::path::PathBuf;

use clap::Args as ClapArgs;
use onescan_clients::opcua_server::Access;

use super::error::CommandError;
use crate::error::Usage;

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
}

impl AccessArgs {
    /// Who is let in.
    ///
    /// # Errors
    /// The user has no password.
    pub fn access(self) -> Result<Access, CommandError> {
        const PASSWORD: &str = "ONESCAN_OPCUA_PASSWORD";
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
        Ok(Access { user, pki: self.opcua_pki, trust_clients: self.opcua_trust })
    }
}
