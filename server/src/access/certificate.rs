//! Who a client's certificate is for: its subject says it. TLS has verified the certificate before; here it is only read.
//!
//! | of the subject | means |
//! |---|---|
//! | common name (CN) | the name: of a client of the session, or of whoever operates it |
//! | organisational unit (OU) | `operator` or `viewer`; `client`, or none, for a client |
//!
//! DER as of X.690, certificates as of RFC 5280, 4.1.

use thiserror::Error;

use super::register::{Holder, Proof};
use super::role::Role;
use crate::signal::ClientName;

const SEQUENCE: u8 = 0x30;
const SET: u8 = 0x31;
const INTEGER: u8 = 0x02;
const OBJECT: u8 = 0x06;
/// The version of a certificate, which the oldest do not have.
const VERSION: u8 = 0xa0;
/// `UTF8String`, `PrintableString` and `IA5String`: of what names are made, and what is UTF-8 as it is.
const TEXTS: [u8; 3] = [0x0c, 0x13, 0x16];
const COMMON_NAME: [u8; 3] = [0x55, 4, 3];
const UNIT: [u8; 3] = [0x55, 4, 11];

/// Why a certificate is nobody's.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum BadSubject {
    /// It cannot be read.
    #[error("its subject cannot be read")]
    Unreadable,
    /// Nobody is named, or two are.
    #[error("its subject must have one common name (CN), the client's name")]
    NoName,
    /// Not the name of a client.
    #[error("the common name (CN) of its subject is not a client's name: {0}")]
    Name(String),
    /// A role that is none.
    #[error("the organisational unit (OU) of its subject must be `client`, `operator` or `viewer`, or absent")]
    Role,
}

impl Holder {
    /// Whom a certificate in DER is for.
    ///
    /// # Errors
    /// See [`BadSubject`].
    pub fn of_certificate(der: &[u8]) -> Result<Self, BadSubject> {
        let names = subject(der).ok_or(BadSubject::Unreadable)?;
        let of =
            |wanted: &[u8]| names.iter().filter(|(kind, _)| *kind == wanted).map(|(_, text)| *text).collect::<Vec<_>>();
        let [name] = of(&COMMON_NAME)[..] else { return Err(BadSubject::NoName) };
        // What a client may be called, others may.
        let client = ClientName::new(name).map_err(|error| BadSubject::Name(error.to_string()))?;
        let role = match of(&UNIT)[..] {
            [] | ["client"] => Role::Client(client),
            ["operator"] => Role::Operator,
            ["trainer"] => Role::Trainer,
            ["viewer"] => Role::Viewer,
            _ => return Err(BadSubject::Role),
        };
        Ok(Self { name: name.to_owned(), role, proof: Proof::Certificate })
    }
}

/// The parts of the subject that are text, each with its kind; nothing if this is not a certificate.
fn subject(der: &[u8]) -> Option<Vec<(&[u8], &str)>> {
    let mut certificate = inside(&mut { der }, SEQUENCE)?;
    let mut signed = inside(&mut certificate, SEQUENCE)?;
    if signed.first() == Some(&VERSION) {
        inside(&mut signed, VERSION)?;
    }
    // Serial number, algorithm, issuer and validity come before.
    for tag in [INTEGER, SEQUENCE, SEQUENCE, SEQUENCE] {
        inside(&mut signed, tag)?;
    }
    let mut subject = inside(&mut signed, SEQUENCE)?;
    let mut names = Vec::new();
    while !subject.is_empty() {
        let mut set = inside(&mut subject, SET)?;
        while !set.is_empty() {
            let mut part = inside(&mut set, SEQUENCE)?;
            let kind = inside(&mut part, OBJECT)?;
            let (tag, text) = element(&mut part)?;
            if TEXTS.contains(&tag) {
                names.push((kind, std::str::from_utf8(text).ok()?));
            }
        }
    }
    Some(names)
}

/// What is inside of the next element, which must have this tag.
fn inside<'d>(rest: &mut &'d [u8], wanted: u8) -> Option<&'d [u8]> {
    element(rest).filter(|(tag, _)| *tag == wanted).map(|(_, content)| content)
}

/// The next element: its tag and what is inside.
fn element<'d>(rest: &mut &'d [u8]) -> Option<(u8, &'d [u8])> {
    let (tag, after) = rest.split_first()?;
    let (first, mut after) = after.split_first()?;
    let length = match first {
        short if *short < 0x80 => usize::from(*short),
        long @ 0x81..=0x84 => {
            let (bytes, behind) = after.split_at_checked(usize::from(long & 0x7f))?;
            after = behind;
            bytes.iter().fold(0, |length, byte| length << 8 | usize::from(*byte))
        }
        _ => return None,
    };
    let (content, behind) = after.split_at_checked(length)?;
    *rest = behind;
    Some((*tag, content))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tagged(tag: u8, inner: &[&[u8]]) -> Vec<u8> {
        let inner = inner.concat();
        let length = inner.len();
        let head =
            if length < 0x80 { vec![tag, length as u8] } else { vec![tag, 0x82, (length >> 8) as u8, length as u8] };
        [head, inner].concat()
    }

    fn certificate(names: &[([u8; 3], u8, &str)]) -> Vec<u8> {
        let part = |(kind, tag, text): &([u8; 3], u8, &str)| {
            let pair = [tagged(OBJECT, &[kind]), tagged(*tag, &[text.as_bytes()])].concat();
            tagged(SET, &[&tagged(SEQUENCE, &[&pair])])
        };
        let subject = tagged(SEQUENCE, &[&names.iter().map(part).collect::<Vec<_>>().concat()]);
        let before = [tagged(VERSION, &[&[2, 1, 2]]), tagged(INTEGER, &[&[1]])].concat();
        let others = tagged(SEQUENCE, &[]).repeat(3);
        tagged(SEQUENCE, &[&tagged(SEQUENCE, &[&before, &others, &subject])])
    }

    fn whose(names: &[([u8; 3], u8, &str)]) -> Result<(String, String), BadSubject> {
        Holder::of_certificate(&certificate(names)).map(|holder| (holder.name, holder.role.to_string()))
    }

    #[test]
    fn the_subject_says_who_it_is_and_what_for() {
        let named = |name: &str, role: &str| Ok((name.to_owned(), role.to_owned()));
        assert_eq!(whose(&[(COMMON_NAME, 0x0c, "plant")]), named("plant", "client:plant"));
        assert_eq!(whose(&[(UNIT, 0x13, "client"), (COMMON_NAME, 0x13, "plant")]), named("plant", "client:plant"));
        assert_eq!(whose(&[(COMMON_NAME, 0x0c, "anna"), (UNIT, 0x0c, "operator")]), named("anna", "operator"));
        assert_eq!(whose(&[(COMMON_NAME, 0x0c, "wall"), (UNIT, 0x0c, "viewer")]), named("wall", "viewer"));
    }

    #[test]
    fn who_is_nobody_learns_why() {
        assert_eq!(whose(&[]), Err(BadSubject::NoName));
        assert_eq!(whose(&[(COMMON_NAME, 0x0c, "a"), (COMMON_NAME, 0x0c, "b")]), Err(BadSubject::NoName));
        assert!(matches!(whose(&[(COMMON_NAME, 0x0c, "a b")]), Err(BadSubject::Name(_))));
        assert_eq!(whose(&[(COMMON_NAME, 0x0c, "a"), (UNIT, 0x0c, "king")]), Err(BadSubject::Role));
    }

    /// Whatever is cut or changed, nothing is read beyond the end.
    #[test]
    fn what_is_not_a_certificate_is_nobodys() {
        let good = certificate(&[(COMMON_NAME, 0x0c, "plant"), (UNIT, 0x0c, "viewer")]);
        for end in 0..good.len() {
            assert_eq!(Holder::of_certificate(&good[..end]), Err(BadSubject::Unreadable), "{end}");
        }
        for at in 0..good.len() {
            for value in [0, 0x7f, 0x80, 0x84, 0xff] {
                let mut bad = good.clone();
                bad[at] = value;
                // Whoever it is then, it is read.
                let _ = Holder::of_certificate(&bad);
            }
        }
    }
}
