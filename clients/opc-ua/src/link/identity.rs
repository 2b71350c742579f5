//! Who the client says it is, and how its connection is secured.

use onescan_links::gateway::fault::LinkFault;
use onescan_links::opcua::Options;
use opcua::client::IdentityToken;
use opcua::crypto::SecurityPolicy;
use opcua::types::MessageSecurityMode;

/// How the names of variables begin that hold passwords.
const PASSWORD_PREFIX: &str = "ONESCAN_OPCUA_";

/// Policy and mode of the connection.
///
/// # Errors
/// A name that is none.
pub(super) fn security(options: &Options) -> Result<(SecurityPolicy, MessageSecurityMode), LinkFault> {
    let policy = match options.policy.as_str() {
        "None" => return Ok((SecurityPolicy::None, MessageSecurityMode::None)),
        "Basic256Sha256" => SecurityPolicy::Basic256Sha256,
        "Aes128-Sha256-RsaOaep" => SecurityPolicy::Aes128Sha256RsaOaep,
        "Aes256-Sha256-RsaPss" => SecurityPolicy::Aes256Sha256RsaPss,
        other => {
            let known = "None, Basic256Sha256, Aes128-Sha256-RsaOaep and Aes256-Sha256-RsaPss";
            return Err(LinkFault::Setting(format!("`{other}` is not a security policy; known are {known}")));
        }
    };
    match options.mode.as_str() {
        "Sign" => Ok((policy, MessageSecurityMode::Sign)),
        "SignAndEncrypt" => Ok((policy, MessageSecurityMode::SignAndEncrypt)),
        other => Err(LinkFault::Setting(format!("`{other}` is not a mode; write `Sign` or `SignAndEncrypt`"))),
    }
}

/// Who the client says it is.
///
/// # Errors
/// A password or a certificate that is not there; a password that would go in plain text.
pub(super) fn identity(options: &Options) -> Result<IdentityToken, LinkFault> {
    match (&options.user_certificate, &options.user_key, &options.user) {
        (Some(certificate), Some(key), _) => IdentityToken::new_x509_path(certificate, key)
            .map_err(|error| LinkFault::Setting(format!("the user's certificate: {error}"))),
        (Some(_), None, _) | (None, Some(_), _) => {
            Err(LinkFault::Setting("`user_certificate` and `user_key` go together".to_owned()))
        }
        (None, None, Some(user)) if options.policy == "None" && !options.plain_password => {
            Err(LinkFault::Setting(format!(
                "the password of user `{user}` would go over the network in plain text: set `policy`, or permit it \
                 with `plain_password = true`"
            )))
        }
        (None, None, Some(user)) => {
            let name = &options.password_env;
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_other_variable_of_the_environment_is_a_password() {
        // A variable that every process has.
        let user = Some("operator".to_owned());
        let options = Options { user, password_env: "PATH".to_owned(), plain_password: true, ..Options::default() };
        let refused = identity(&options).map(|_| ()).expect_err("it is not a password");
        assert!(refused.to_string().contains("begins with `ONESCAN_OPCUA_`"), "{refused}");
    }
}
