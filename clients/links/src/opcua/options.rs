//! What a scenario says of an OPC UA link.

use std::path::PathBuf;

use schemars::JsonSchema;
use serde::Deserialize;

/// The namespace in which `onescan plc` has its variables.
pub const NAMESPACE: &str = "urn:onescan:plc:variables";

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

impl Options {
    /// True if certificates are needed at all.
    pub fn is_secured(&self) -> bool {
        self.policy != "None" || self.user_certificate.is_some()
    }
}
