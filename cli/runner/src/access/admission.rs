//! Whether a session may listen where it is to, and whom it lets in.

use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr};
use std::path::{Path, PathBuf};

use onescan_server::access::{Register, Token};
use onescan_server::signal::ClientName;
use onescan_server::transport::tcp::House;

use super::AccessError;
use super::folder::{AUTHORITY, Folder};
use super::revoked;

/// Who is let in.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Admission {
    /// Whoever reaches the address, which must be of this machine.
    #[default]
    ThisMachine,
    /// Whoever reaches the address, wherever that is.
    Anybody,
    /// Whoever shows a token of this folder, under TLS if it has a certificate.
    Holders(PathBuf),
}

/// What a session lets in, and what its own programs are given to get in.
#[derive(Debug, Default)]
pub struct GuardedListener {
    house: House,
    authority: Option<PathBuf>,
}

/// What a program of the session shows to get in: variables of its environment.
pub type Shown = Vec<(&'static str, String)>;

/// The variable of a token.
pub const TOKEN_VARIABLE: &str = "ONESCAN_TOKEN";
/// The variable of the file with the trusted authority.
pub const AUTHORITY_VARIABLE: &str = "ONESCAN_TLS_CA";

impl GuardedListener {
    /// What `admission` means for a session that listens at `address`.
    ///
    /// # Errors
    /// Anybody in the network could take part, or the folder cannot be used.
    pub fn open(admission: &Admission, address: SocketAddr) -> Result<Self, AccessError> {
        let is_local = address.ip().is_loopback();
        let folder = match admission {
            Admission::ThisMachine if is_local => return Ok(Self::default()),
            Admission::ThisMachine => {
                return Err(AccessError::OpenToAll { address, missing: "nobody has to show a token" });
            }
            Admission::Anybody => return Ok(Self::default()),
            Admission::Holders(folder) => Folder(folder),
        };
        let (register, identity, revocations) = (folder.register()?, folder.identity()?, revoked::of_session(folder)?);
        if !is_local && identity.is_none() {
            return Err(AccessError::OpenToAll { address, missing: "there is no certificate: tokens could be read" });
        }
        let authority = if identity.is_some() { Some(absolute(&folder.file(AUTHORITY))?) } else { None };
        Ok(Self { house: House { register: Some(register), identity, revocations }, authority })
    }

    /// What the program of client `name` shows: a token that is good for this session only.
    ///
    /// # Errors
    /// The operating system gives no random numbers.
    pub fn shown_by(&mut self, name: &ClientName) -> Result<Shown, AccessError> {
        let mut shown = Shown::new();
        if let Some(register) = &mut self.house.register {
            shown.push((TOKEN_VARIABLE, issue(register, name)?.reveal().to_owned()));
        }
        if let Some(authority) = &self.authority {
            shown.push((AUTHORITY_VARIABLE, authority.to_string_lossy().into_owned()));
        }
        Ok(shown)
    }

    /// For the lobby.
    pub fn into_house(self) -> House {
        self.house
    }
}

fn issue(register: &mut Register, name: &ClientName) -> Result<Token, AccessError> {
    let token = Token::generate()?;
    register.issue(name, token.hash());
    Ok(token)
}

fn absolute(path: &Path) -> Result<PathBuf, AccessError> {
    Ok(std::path::absolute(path).map_err(crate::error::Unreadable::at(path))?)
}

/// Where programs of this machine find a session that listens at `address`.
pub fn from_here(address: SocketAddr) -> SocketAddr {
    let here = match address.ip() {
        IpAddr::V4(ip) if ip.is_unspecified() => IpAddr::V4(Ipv4Addr::LOCALHOST),
        IpAddr::V6(ip) if ip.is_unspecified() => IpAddr::V6(Ipv6Addr::LOCALHOST),
        ip => ip,
    };
    SocketAddr::new(here, address.port())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn beyond_this_machine_a_certificate_and_tokens_are_needed() {
        let (here, there) = ("127.0.0.1:0".parse().unwrap(), "0.0.0.0:4850".parse().unwrap());
        assert!(GuardedListener::open(&Admission::ThisMachine, here).is_ok());
        let error = GuardedListener::open(&Admission::ThisMachine, there).unwrap_err().to_string();
        assert!(error.contains("nobody has to show a token"), "{error}");
        assert!(GuardedListener::open(&Admission::Anybody, there).is_ok());
        let folder = tempfile::tempdir().unwrap();
        let holders = Admission::Holders(folder.path().to_owned());
        let error = GuardedListener::open(&holders, there).unwrap_err().to_string();
        assert!(error.contains("there is no certificate"), "{error}");
        super::super::certificate::new(Folder(folder.path()), &[], "2026-01-01".parse().unwrap(), 30).unwrap();
        let mut listener = GuardedListener::open(&holders, there).unwrap();
        let shown = listener.shown_by(&ClientName::new("plant").unwrap()).unwrap();
        let names: Vec<_> = shown.iter().map(|(name, _)| *name).collect();
        assert_eq!(names, [TOKEN_VARIABLE, AUTHORITY_VARIABLE]);
    }

    #[test]
    fn programs_of_this_machine_find_a_session_that_listens_everywhere() {
        assert_eq!(from_here("0.0.0.0:7".parse().unwrap()), "127.0.0.1:7".parse().unwrap());
        assert_eq!(from_here("[::]:7".parse().unwrap()), "[::1]:7".parse().unwrap());
        assert_eq!(from_here("10.0.0.1:7".parse().unwrap()), "10.0.0.1:7".parse().unwrap());
    }
}
