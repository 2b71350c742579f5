//! Tokens of a folder: made, listed, revoked.

use std::io::{self, Write};
use std::time::{SystemTime, UNIX_EPOCH};

use onescan_report::OutputError;
use onescan_server::access::{Day, Pass, Role, Token};
use serde::Serialize;

use super::AccessError;
use super::folder::{Folder, TOKENS};
use crate::format::Format;

/// When a token ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lifetime {
    /// After so many days.
    Days(u32),
    Until(Day),
    /// When it is revoked.
    Unlimited,
}

/// A token in a list for machines.
#[derive(Serialize)]
struct Listed<'p> {
    name: &'p str,
    role: String,
    expires: Option<String>,
    expired: bool,
}

/// The day of the calendar. Sessions do not know it; tokens and certificates end by it.
///
/// A clock before 1970 was never set: it counts as the first day, on which tokens have not ended, but no certificate is
/// good yet, so that nobody comes in from elsewhere.
pub fn today() -> Day {
    Day::of(SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default())
}

/// Makes a token, and writes it to `out`: the only time that it is seen.
///
/// # Errors
/// The name is taken, or a file cannot be written.
pub fn new(
    folder: Folder<'_>,
    name: &str,
    role: Role,
    lifetime: Lifetime,
    out: &mut dyn Write,
) -> Result<(), AccessError> {
    let mut register = folder.register()?;
    let token = Token::generate()?;
    let expires = match lifetime {
        Lifetime::Days(days) => Some(today().later(days)),
        Lifetime::Until(day) => Some(day),
        Lifetime::Unlimited => None,
    };
    register.add(Pass { name: name.to_owned(), role, expires, hash: token.hash() })?;
    folder.write_register(&register)?;
    writeln!(out, "{}", token.reveal()).map_err(OutputError)?;
    Ok(())
}

/// Lists the tokens.
///
/// # Errors
/// A file cannot be read, or the list not be written.
pub fn list(folder: Folder<'_>, format: Format, out: &mut dyn Write) -> Result<(), AccessError> {
    let (register, today) = (folder.register()?, today());
    let listed = register.passes().iter().map(|pass| Listed {
        name: &pass.name,
        role: pass.role.to_string(),
        expires: pass.expires.map(|day| day.to_string()),
        expired: pass.expires.is_some_and(|last| today > last),
    });
    let written = match format {
        Format::Json => {
            let all: Vec<Listed<'_>> = listed.collect();
            serde_json::to_writer(&mut *out, &all).map_err(io::Error::from).and_then(|()| writeln!(out))
        }
        Format::Human => listed.into_iter().try_for_each(|each| {
            let until = match (&each.expires, each.expired) {
                (None, _) => "until it is revoked".to_owned(),
                (Some(day), false) => format!("until {day}"),
                (Some(day), true) => format!("expired on {day}"),
            };
            writeln!(out, "{:24} {:24} {until}", each.name, each.role)
        }),
    };
    Ok(written.map_err(OutputError)?)
}

/// Revokes a token. Sessions that begin from now on do not know it any more.
///
/// # Errors
/// There is none of that name, or a file cannot be written.
pub fn revoke(folder: Folder<'_>, name: &str) -> Result<(), AccessError> {
    let mut register = folder.register()?;
    if !register.revoke(name) {
        return Err(AccessError::NoSuchToken { path: folder.file(TOKENS), name: name.to_owned() });
    }
    folder.write_register(&register)
}
