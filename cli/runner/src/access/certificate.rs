//! The certificate of a folder: made, with an authority of its own that has signed nothing else, and whose key is not
//! kept.

use std::fs::OpenOptions;
use std::io::Write as _;
use std::net::IpAddr;
use std::path::Path;

use onescan_report::{FileError, file};
use onescan_server::access::Day;
use rcgen::{
    BasicConstraints, CertificateParams, DnType, ExtendedKeyUsagePurpose, IsCa, Issuer, KeyPair, KeyUsagePurpose,
};

use super::AccessError;
use super::folder::{AUTHORITY, CERTIFICATE, Folder, KEY};

/// Makes a certificate for sessions that are reached at `hosts`, and at this machine itself, good for `days` from
/// `today` on.
///
/// # Errors
/// There is one already, or a file cannot be written.
pub fn new(folder: Folder<'_>, hosts: &[IpAddr], today: Day, days: u32) -> Result<(), AccessError> {
    for name in [AUTHORITY, CERTIFICATE, KEY] {
        if folder.file(name).exists() {
            return Err(AccessError::Exists(folder.file(name)));
        }
    }
    let made = make(hosts, today, days).map_err(AccessError::Making)?;
    std::fs::create_dir_all(folder.0).map_err(|source| FileError { path: folder.0.to_owned(), source })?;
    write_secret(&folder.file(KEY), made.key.as_bytes())?;
    file::write_whole(&folder.file(CERTIFICATE), made.certificate.as_bytes())?;
    file::write_whole(&folder.file(AUTHORITY), made.authority.as_bytes())?;
    Ok(())
}

/// What was made, each as PEM.
struct Made {
    authority: String,
    certificate: String,
    key: String,
}

fn make(hosts: &[IpAddr], today: Day, days: u32) -> Result<Made, rcgen::Error> {
    let signing = KeyPair::generate()?;
    let mut authority = params("onescan authority", Vec::new(), today, days)?;
    authority.is_ca = IsCa::Ca(BasicConstraints::Constrained(0));
    authority.key_usages = vec![KeyUsagePurpose::KeyCertSign, KeyUsagePurpose::CrlSign];
    let signed = authority.self_signed(&signing)?;

    let local = ["127.0.0.1", "::1"].map(str::to_owned);
    let mut names: Vec<String> = hosts.iter().map(IpAddr::to_string).chain(local).collect();
    names.push("localhost".to_owned());
    names.dedup();
    let key = KeyPair::generate()?;
    let mut server = params("onescan session", names, today, days)?;
    server.key_usages = vec![KeyUsagePurpose::DigitalSignature];
    server.extended_key_usages = vec![ExtendedKeyUsagePurpose::ServerAuth];
    server.use_authority_key_identifier_extension = true;
    let certificate = server.signed_by(&key, &Issuer::new(authority, signing))?;
    Ok(Made { authority: signed.pem(), certificate: certificate.pem(), key: key.serialize_pem() })
}

fn params(name: &str, hosts: Vec<String>, today: Day, days: u32) -> Result<CertificateParams, rcgen::Error> {
    let mut params = CertificateParams::new(hosts)?;
    params.distinguished_name.push(DnType::CommonName, name);
    let at = |day: Day| {
        let (year, month, day) = day.parts();
        rcgen::date_time_ymd(year as i32, month as u8, day as u8)
    };
    // Clocks of other machines may be a little behind.
    params.not_before = at(today.earlier(1));
    params.not_after = at(today.later(days));
    Ok(params)
}

/// A file that nobody else may read.
fn write_secret(path: &Path, bytes: &[u8]) -> Result<(), FileError> {
    let mut options = OpenOptions::new();
    options.write(true).create_new(true);
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
    let written = options.open(path).and_then(|mut file| file.write_all(bytes));
    written.map_err(|source| FileError { path: path.to_owned(), source })
}
