//! What a PLC says it has, over OPC UA or ADS.

use std::sync::Arc;

use onescan_links::gateway::Settings;
use onescan_links::gateway::exchange::{START, is_word};

use super::collect::POINTS_MAX;
use super::error::ListError;
use super::point::{Direction, IoPoint, LeftOut, Place};
use super::{IoList, ListKind, ListLink};

/// Browses a PLC, whose variables come in the order of their names; the words of the handshake and of the PLC's system are
/// no signals. What may be written is taken for an input of the PLC,
/// everything else for an output: an address space does not know what is which.
///
/// # Errors
/// The server cannot be reached or has too many variables.
pub fn read(url: &str) -> Result<IoList, ListError> {
    let mut found = Settings { url: url.to_owned(), ..Settings::default() }.browse()?;
    if found.len() > POINTS_MAX {
        return Err(ListError::TooMany { file: url.to_owned(), limit: POINTS_MAX });
    }
    // A server has its variables in no order that it would keep.
    found.sort_by(|one, other| one.name.cmp(&other.name));
    let file: Arc<str> = url.into();
    let mut system_words = false;
    let (mut points, mut left_out) = (Vec::new(), Vec::new());
    for variable in found {
        let last = variable.name.rsplit(['.', '/']).next().unwrap_or_default();
        if is_word(last) {
            system_words |= last == START.0;
            continue;
        }
        let at = Place { file: Arc::clone(&file), line: None };
        let Some(ty) = variable.ty else {
            let why = "its type is none that a signal can have".to_owned();
            left_out.push(LeftOut { name: variable.name, why, at });
            continue;
        };
        let direction = if variable.is_writable { Direction::Input } else { Direction::Output };
        let (name, symbol) = (variable.name, Some(variable.address));
        points.push(IoPoint { name, ty, direction, address: None, symbol, comment: None, at });
    }
    if points.is_empty() {
        let title = ListKind::Server.title();
        let help = super::error::help_for_empty(ListKind::Server);
        return Err(ListError::Empty { file: url.to_owned(), title, left_out: left_out.len(), help });
    }
    let link = Some(ListLink::Server { url: url.to_owned(), system_words });
    Ok(IoList { kind: ListKind::Server, from: url.to_owned(), points, left_out, link, cycle: None, sources: None })
}
