//! What a PLC says it has, over OPC UA or ADS.

use std::sync::Arc;

use onescan_clients::gateway::Settings;
use onescan_clients::gateway::exchange::{WORDS_FROM_PLC, WORDS_TO_PLC};

use super::collect::POINTS_MAX;
use super::error::ListError;
use super::point::{Direction, IoPoint, LeftOut, Place};
use super::{IoList, ListKind, ListLink};

/// Browses a PLC; the words of the handshake are no signals. What may be written is taken for an input of the PLC,
/// everything else for an output: an address space does not know what is which.
///
/// # Errors
/// The server cannot be reached or has too many variables.
pub fn read(url: &str) -> Result<IoList, ListError> {
    let found = Settings { url: url.to_owned(), ..Settings::default() }.browse()?;
    if found.len() > POINTS_MAX {
        return Err(ListError::TooMany { file: url.to_owned(), limit: POINTS_MAX });
    }
    let file: Arc<str> = url.into();
    let (mut points, mut left_out) = (Vec::new(), Vec::new());
    for variable in found {
        let last = variable.name.rsplit(['.', '/']).next().unwrap_or_default();
        if WORDS_TO_PLC.iter().chain(&WORDS_FROM_PLC).any(|(word, _)| word.eq_ignore_ascii_case(last)) {
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
        return Err(ListError::Empty { file: url.to_owned(), title, left_out: left_out.len() });
    }
    let link = Some(ListLink::Server(url.to_owned()));
    Ok(IoList { kind: ListKind::Server, from: url.to_owned(), points, left_out, link, cycle: None, sources: None })
}
