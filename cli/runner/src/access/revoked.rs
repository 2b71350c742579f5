//! Certificates of clients and operators that a folder's sessions let in no more.

use std::io::{self, Write};
use std::path::Path;

use onescan_base::regular::{self, Limit};
use onescan_report::{OutputError, file};
use onescan_server::access::{BadFingerprint, Fingerprint, Holder, RevocationList, Revoked};
use onescan_server::transport::tls::first_certificate;
use serde::{Deserialize, Serialize};

use super::AccessError;
use super::folder::{CLIENTS, Folder, REVOKED, read_if_there};
use super::tokens::today;
use crate::error::Unreadable;
use crate::format::Format;

/// The file of revoked certificates.
#[derive(Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct RevokedFile {
    #[serde(default, rename = "certificate")]
    certificates: Vec<Entry>,
}

/// A certificate that has been revoked.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Entry {
    /// Whose it is; nothing where only the fingerprint was known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    name: Option<String>,
    /// SHA-256 of its DER.
    sha256: String,
    /// The day on which it was revoked.
    revoked: String,
}

/// The certificates that a folder has revoked, read again whenever a session asks; nothing where no certificate lets anybody in.
///
/// # Errors
/// The list cannot be read, or is none.
pub fn of_session(folder: Folder<'_>) -> Result<Option<RevocationList>, AccessError> {
    if !folder.file(CLIENTS).exists() {
        return Ok(None);
    }
    fingerprints(folder)?;
    let kept = folder.0.to_owned();
    let read = move || fingerprints(Folder(&kept)).map_err(|error| error.to_string());
    Ok(Some(RevocationList::new(read)))
}

/// All fingerprints of a folder's file; none if it has no such file.
fn fingerprints(folder: Folder<'_>) -> Result<Revoked, AccessError> {
    read(folder)?.certificates.iter().map(|entry| fingerprint(folder, entry)).collect()
}

fn fingerprint(folder: Folder<'_>, entry: &Entry) -> Result<Fingerprint, AccessError> {
    let why = |why: BadFingerprint| format!("`{}`: {why}", entry.sha256);
    entry.sha256.parse().map_err(|error| malformed(folder, why(error)))
}

fn malformed(folder: Folder<'_>, why: String) -> AccessError {
    AccessError::NotRevocations { path: folder.file(REVOKED), why }
}

fn read(folder: Folder<'_>) -> Result<RevokedFile, AccessError> {
    let Some(bytes) = read_if_there(&folder.file(REVOKED))? else { return Ok(RevokedFile::default()) };
    let text = String::from_utf8(bytes).map_err(|error| malformed(folder, error.to_string()))?;
    toml::from_str(&text).map_err(|error| malformed(folder, error.message().to_owned()))
}

/// Revokes a certificate, given by its file in PEM or by its fingerprint, and says on `out` whose it was. Sessions of the folder
/// that run read it within a second.
///
/// # Errors
/// There is no such file and it is not a fingerprint, or the list cannot be read or written.
pub fn revoke(folder: Folder<'_>, certificate: &str, out: &mut dyn Write) -> Result<(), AccessError> {
    let (fingerprint, name) = match certificate.parse::<Fingerprint>() {
        Ok(fingerprint) => (fingerprint, None),
        Err(_) => named(Path::new(certificate))?,
    };
    let mut file = read(folder)?;
    let whose = name.clone().map(|name| format!(" of `{name}`")).unwrap_or_default();
    for entry in &file.certificates {
        if self::fingerprint(folder, entry)? == fingerprint {
            let said = writeln!(out, "the certificate{whose} was revoked on {}: {fingerprint}", entry.revoked);
            return Ok(said.map_err(OutputError)?);
        }
    }
    file.certificates.push(Entry { name, sha256: fingerprint.to_string(), revoked: today().to_string() });
    let text = toml::to_string(&file).map_err(|error| malformed(folder, error.to_string()))?;
    file::write_all_whole(&[file::Write { path: folder.file(REVOKED), bytes: Some(text.into_bytes()) }])?;
    writeln!(out, "revoked the certificate{whose}: {fingerprint}").map_err(OutputError)?;
    Ok(())
}

/// Fingerprint and name of a certificate in a file.
fn named(path: &Path) -> Result<(Fingerprint, Option<String>), AccessError> {
    let pem = regular::read(path, Limit::TEXT).map_err(Unreadable::at(path))?;
    let wrong = |source| AccessError::Certificate { path: path.to_owned(), source };
    let der = first_certificate(&pem).map_err(wrong)?;
    // One that names nobody lets nobody in; it can be revoked all the same.
    let name = Holder::of_certificate(&der).ok().map(|holder| holder.name);
    Ok((Fingerprint::of(&der), name))
}

/// Lists the revoked certificates.
///
/// # Errors
/// The file cannot be read, or the list not be written.
pub fn list(folder: Folder<'_>, format: Format, out: &mut dyn Write) -> Result<(), AccessError> {
    let file = read(folder)?;
    let written = match format {
        Format::Json => {
            serde_json::to_writer(&mut *out, &file.certificates).map_err(io::Error::from).and_then(|()| writeln!(out))
        }
        Format::Human => file.certificates.iter().try_for_each(|Entry { name, sha256, revoked }| {
            writeln!(out, "{:24} revoked on {revoked}  {sha256}", name.as_deref().unwrap_or("-"))
        }),
    };
    Ok(written.map_err(OutputError)?)
}
