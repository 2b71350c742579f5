//! The folder of those who are let in: what lies where, read for a session.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use onescan_base::regular::{self, Limit};
use onescan_report::file;
use onescan_server::access::{Pass, Register};
use onescan_server::transport::tls::Identity;
use serde::{Deserialize, Serialize};

use super::AccessError;
use crate::error::Unreadable;

/// Tokens, as their hashes.
pub const TOKENS: &str = "tokens.toml";
/// The certificate of sessions.
pub const CERTIFICATE: &str = "server.pem";
/// Its key, which nobody else may read.
pub const KEY: &str = "server-key.pem";
/// The authority that has signed it: what those who take part are given.
pub const AUTHORITY: &str = "ca.pem";

/// The authorities of certificates that let in, too; nobody's certificate does without this file.
pub const CLIENTS: &str = "clients-ca.pem";

/// Certificates of clients and operators that are no longer good.
pub const REVOKED: &str = "revoked.toml";

/// A folder of those who are let in.
#[derive(Clone, Copy, Debug)]
pub struct Folder<'f>(pub &'f Path);

#[derive(Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct TokensFile {
    #[serde(default, rename = "token")]
    tokens: Vec<TokenEntry>,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct TokenEntry {
    name: String,
    role: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    expires: Option<String>,
    hash: String,
}

impl Folder<'_> {
    /// A file of it.
    pub fn file(self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    /// Its tokens; none if it has no file of them.
    ///
    /// # Errors
    /// The file cannot be read, or is none.
    pub fn register(self) -> Result<Register, AccessError> {
        let path = self.file(TOKENS);
        let Some(bytes) = read_if_there(&path)? else { return Ok(Register::default()) };
        let malformed = |why: String| AccessError::Malformed { path: path.clone(), why };
        let text = String::from_utf8(bytes).map_err(|error| malformed(error.to_string()))?;
        let file: TokensFile = toml::from_str(&text).map_err(|error| malformed(error.message().to_owned()))?;
        let mut register = Register::default();
        for entry in file.tokens {
            let in_entry = |why: &dyn ToString| malformed(format!("token `{}`: {}", entry.name, why.to_string()));
            let role = entry.role.parse().map_err(|error| in_entry(&error))?;
            let expires = entry.expires.as_deref().map(str::parse).transpose().map_err(|error| in_entry(&error))?;
            let hash = entry.hash.parse().map_err(|error| in_entry(&error))?;
            register.add(Pass { name: entry.name.clone(), role, expires, hash })?;
        }
        Ok(register)
    }

    /// Writes its tokens.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn write_register(self, register: &Register) -> Result<(), AccessError> {
        let entry = |pass: &Pass| TokenEntry {
            name: pass.name.clone(),
            role: pass.role.to_string(),
            expires: pass.expires.map(|day| day.to_string()),
            hash: pass.hash.to_string(),
        };
        let file = TokensFile { tokens: register.passes().iter().map(entry).collect() };
        let path = self.file(TOKENS);
        let text = toml::to_string(&file)
            .map_err(|error| AccessError::Malformed { path: path.clone(), why: error.to_string() })?;
        file::write_all_whole(&[file::Write { path, bytes: Some(text.into_bytes()) }])?;
        Ok(())
    }

    /// Its certificate, if it has one.
    ///
    /// # Errors
    /// A file cannot be read, is none, or is missing.
    pub fn identity(self) -> Result<Option<Identity>, AccessError> {
        let (certificate, key) = (self.file(CERTIFICATE), self.file(KEY));
        match (read_if_there(&certificate)?, read_if_there(&key)?) {
            (None, None) => Ok(None),
            (Some(chain), Some(secret)) => {
                let wrong = |path: PathBuf| move |source| AccessError::Certificate { path, source };
                // First without the authorities, so that a fault of the certificate is not reported as one of theirs.
                let identity = Identity::from_pem(&chain, &secret, None).map_err(wrong(certificate))?;
                let path = self.file(CLIENTS);
                match read_if_there(&path)? {
                    None => Ok(Some(identity)),
                    Some(clients) => Identity::from_pem(&chain, &secret, Some(&clients)).map(Some).map_err(wrong(path)),
                }
            }
            (None, Some(_)) => Err(AccessError::Incomplete(certificate)),
            (Some(_), None) => Err(AccessError::Incomplete(key)),
        }
    }
}

pub(super) fn read_if_there(path: &Path) -> Result<Option<Vec<u8>>, AccessError> {
    match regular::read(path, Limit::TEXT) {
        Ok(bytes) => Ok(Some(bytes)),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
        Err(error) => Err(Unreadable::at(path)(error).into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_register_comes_back_and_a_wrong_one_is_named() {
        let place = tempfile::tempdir().unwrap();
        let folder = Folder(place.path());
        assert!(folder.register().unwrap().passes().is_empty() && folder.identity().unwrap().is_none());
        let hash = onescan_server::access::TokenHash::of("x");
        let pass = Pass { name: "anna".into(), role: "client:plant".parse().unwrap(), expires: None, hash };
        let dated = Pass { name: "wall".into(), expires: Some("2030-01-31".parse().unwrap()), ..pass.clone() };
        let mut register = Register::default();
        register.add(pass).unwrap();
        register.add(dated).unwrap();
        folder.write_register(&register).unwrap();
        assert_eq!(folder.register().unwrap(), register);
        for (text, why) in [
            ("[[token]]\nname = \"a\"\nrole = \"king\"\nhash = \"x\"", "token `a`: a role is"),
            ("[[token]]\nname = \"a\"\nrole = \"viewer\"\nhash = \"x\"", "token `a`: not the hash of a token"),
            (
                "[[token]]\nname = \"a\"\nrole = \"viewer\"\nhash = \"x\"\nexpires = \"soon\"",
                "token `a`: `soon` is not a day",
            ),
            ("token = 3", "invalid type"),
        ] {
            std::fs::write(folder.file(TOKENS), text).unwrap();
            let error = folder.register().unwrap_err().to_string();
            assert!(error.contains(why), "{error}");
        }
        std::fs::write(folder.file(KEY), "").unwrap();
        assert!(matches!(folder.identity(), Err(AccessError::Incomplete(_))));
    }
}
