//! What a scenario says of an OPC UA link.

use std::path::PathBuf;

#[cfg(feature = "opcua")]
use opcua::client::IdentityToken;
#[cfg(feature = "opcua")]
use opcua::crypto::SecurityPolicy;
#[cfg(feature = "opcua")]
use opcua::types::MessageSecurityMode;
use schemars::JsonSchema;
use serde::Deserialize;

#[cfg(feature = "opcua")]
use crate::gateway::fault::LinkFault;

/// The namespace in which `onescan plc` has its variables.
pub const NAMESPACE: &str = "urn:onescan:plc:variables";

/// How the names of variables begin that hold passwords.
#[cfg(feature = "opcua")]
const PASSWORD_PREFIX: &str = "ONESCAN_OPCUA_";

/// How a client presents itself, and where its variables are.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Options {
    /// The namespace of points without an address: each is there under its name.
    pub namespace: String,
    /// `None`, `Basic256Sha256`, `Aes128-Sha256-RsaOaep` or `Aes256-Sha256-RsaPss`.
    #[schemars(extend("enum" = ["None", "Basic256Sha256", "Aes128-Sha256-RsaOaep", "Aes256-Sha256-RsaPss"]))]
    pub policy: String,
    /// With a policy: `Sign` or `SignAndEncrypt`.
    #[schemars(extend("enum" = ["Sign", "SignAndEncrypt"]))]
    pub mode: String,
    /// The user; anonymous if absent.
    pub user: Option<String>,
    /// Name of the environment variable that holds the user's password: it has no place in a file. It begins with
    /// `ONESCAN_OPCUA_`, so that a link cannot send other secrets of the environment to an address of its choice.
    pub password_env: String,
    /// The user's certificate, in place of a password.
    pub user_certificate: Option<PathBuf>,
    /// The private key of `user_certificate`; both or neither.
    pub user_key: Option<PathBuf>,
    /// The folder with the certificates of this program (`own`, `private`) and those it trusts (`trusted`);
    /// made when it is not there. Without it nothing is kept.
    pub pki: Option<PathBuf>,
    /// Send the user's password over a connection without security, where everybody on the way can read it.
    pub plain_password: bool,
    /// Trust any server; otherwise its certificate must lie in `trusted` of the folder.
    pub trust_server: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            namespace: NAMESPACE.to_owned(),
            policy: "None".to_owned(),
            mode: "SignAndEncrypt".to_owned(),
            user: None,
            password_env: "ONESCAN_OPCUA_PASSWORD".to_owned(),
            user_certificate: None,
            user_key: None,
            pki: None,
            plain_password: false,
            trust_server: false,
        }
    }
}

#[cfg(feature = "opcua")]
impl Options {
    /// Policy and mode of the connection.
    ///
    /// # Errors
    /// A name that is none.
    pub fn security(&self) -> Result<(SecurityPolicy, MessageSecurityMode), LinkFault> {
        let policy = match self.policy.as_str() {
            "None" => return Ok((SecurityPolicy::None, MessageSecurityMode::None)),
            "Basic256Sha256" => SecurityPolicy::Basic256Sha256,
            "Aes128-Sha256-RsaOaep" => SecurityPolicy::Aes128Sha256RsaOaep,
            "Aes256-Sha256-RsaPss" => SecurityPolicy::Aes256Sha256RsaPss,
            other => {
                let known = "None, Basic256Sha256, Aes128-Sha256-RsaOaep and Aes256-Sha256-RsaPss";
                return Err(LinkFault::Setting(format!("`{other}` is no security policy; known are {known}")));
            }
        };
        match self.mode.as_str() {
            "Sign" => Ok((policy, MessageSecurityMode::Sign)),
            "SignAndEncrypt" => Ok((policy, MessageSecurityMode::SignAndEncrypt)),
            other => Err(LinkFault::Setting(format!("`{other}` is no mode; write `Sign` or `SignAndEncrypt`"))),
        }
    }

    /// Who the client says it is.
    ///
    /// # Errors
    /// A password or a certificate that is not there; a password that would go in plain text.
    pub fn identity(&self) -> Result<IdentityToken, LinkFault> {
        match (&self.user_certificate, &self.user_key, &self.user) {
            (Some(certificate), Some(key), _) => IdentityToken::new_x509_path(certificate, key)
                .map_err(|error| LinkFault::Setting(format!("the user's certificate: {error}"))),
            (Some(_), None, _) | (None, Some(_), _) => {
                Err(LinkFault::Setting("`user_certificate` and `user_key` go together".to_owned()))
            }
            (None, None, Some(user)) if self.policy == "None" && !self.plain_password => {
                Err(LinkFault::Setting(format!(
                    "the password of user `{user}` would go over the network in plain text: set `policy`, or permit it \
                     with `plain_password = true`"
                )))
            }
            (None, None, Some(user)) => {
                let name = &self.password_env;
                if !name.starts_with(PASSWORD_PREFIX) {
                    return Err(LinkFault::Setting(format!(
                        "`password_env` is `{name}`: a name that begins with `{PASSWORD_PREFIX}` is wanted, so that no \
                         other variable of the environment leaves this machine"
                    )));
                }
                let password = std::env::var(name).map_err(|_| {
                    LinkFault::Setting(format!("the environment variable `{name}` has no password for user `{user}`"))
                })?;
                Ok(IdentityToken::UserName(user.clone(), password.into()))
            }
            (None, None, None) => Ok(IdentityToken::Anonymous),
        }
    }

    /// True if certificates are needed at all.
    pub fn is_secured(&self) -> bool {
        self.policy != "None" || self.user_certificate.is_some()
    }
}

#[cfg(all(test, feature = "opcua"))]
mod tests {
    use super::*;

    #[test]
    fn no_other_variable_of_the_environment_is_a_password() {
        // A variable that every process has.
        let user = Some("operator".to_owned());
        let options = Options { user, password_env: "PATH".to_owned(), plain_password: true, ..Options::default() };
        let refused = options.identity().map(|_| ()).expect_err("it is no password");
        assert!(refused.to_string().contains("begins with `ONESCAN_OPCUA_`"), "{refused}");
    }
}
