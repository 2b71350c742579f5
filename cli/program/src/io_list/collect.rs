//! Points in the order of a list, and what was left out.

use std::path::Path;
use std::sync::Arc;

use super::error::ListError;
use super::flatten::{Declared, flatten};
use super::point::{Direction, IoPoint, LeftOut, Place};
use super::{IoList, ListKind, ListLink};

/// More points than any PLC has, and few enough for any machine to hold.
pub const POINTS_MAX: usize = 1 << 17;

/// A variable as a list has it.
#[derive(Clone, Copy, Debug)]
pub struct Entry<'a> {
    pub name: &'a str,
    /// Its type, as written.
    pub ty: &'a str,
    /// Which way it goes.
    pub direction: Direction,
    /// Its address in the I/O image.
    pub address: Option<&'a str>,
    /// What is said about it.
    pub comment: Option<&'a str>,
    /// Its line or row.
    pub line: Option<u32>,
}

/// A list while it is read.
#[derive(Debug)]
pub struct Collected {
    file: Arc<str>,
    points: Vec<IoPoint>,
    left_out: Vec<LeftOut>,
}

impl Collected {
    /// Nothing yet, of the list in this file.
    pub fn of(path: &Path) -> Self {
        Self { file: path.display().to_string().into(), points: Vec::new(), left_out: Vec::new() }
    }

    /// What follows is in another file.
    pub fn goes_on_in(&mut self, path: &Path) {
        self.file = path.display().to_string().into();
    }

    /// Takes a variable, in parts if it is an array or a structure.
    ///
    /// # Errors
    /// There are too many of them.
    pub fn take(&mut self, entry: &Entry, declared: &dyn Declared) -> Result<(), ListError> {
        let at = self.place(entry.line);
        if entry.name.trim().is_empty() {
            self.left_out.push(LeftOut { name: String::new(), why: "it has no name".to_owned(), at });
            return Ok(());
        }
        let parts = match flatten(entry.ty, declared, POINTS_MAX) {
            Ok(parts) => parts,
            Err(why) => {
                self.left_out.push(LeftOut { name: entry.name.to_owned(), why, at });
                return Ok(());
            }
        };
        if self.points.len() + parts.len() > POINTS_MAX {
            return Err(ListError::TooMany { file: self.file.to_string(), limit: POINTS_MAX });
        }
        for (path, ty) in parts {
            let (name, at) = (format!("{}{path}", entry.name.trim()), at.clone());
            let ty = match ty {
                Ok(ty) => ty,
                Err(why) => {
                    self.left_out.push(LeftOut { name, why, at });
                    continue;
                }
            };
            // The address is that of the whole; where its parts lie is the PLC's affair.
            let address = entry.address.filter(|_| path.is_empty()).map(str::to_owned);
            let comment = entry.comment.map(str::trim).filter(|comment| !comment.is_empty()).map(str::to_owned);
            let direction = entry.direction;
            self.points.push(IoPoint { name, ty, direction, address, symbol: None, comment, at });
        }
        Ok(())
    }

    /// Notes what cannot be a signal.
    pub fn leave_out(&mut self, name: &str, why: impl Into<String>, line: Option<u32>) {
        let at = self.place(line);
        self.left_out.push(LeftOut { name: name.trim().to_owned(), why: why.into(), at });
    }

    fn place(&self, line: Option<u32>) -> Place {
        Place { file: Arc::clone(&self.file), line }
    }

    /// The list.
    pub fn list(self, kind: ListKind) -> IoList {
        let Self { file, points, left_out } = self;
        IoList { kind, from: file.to_string(), points, left_out, link: None, cycle: None, sources: None }
    }

    /// The list of a PLC whose variables are reached by their names.
    pub fn list_of_symbols(mut self, kind: ListKind, link: ListLink) -> IoList {
        for point in &mut self.points {
            point.symbol = Some(point.name.clone());
        }
        IoList { link: Some(link), ..self.list(kind) }
    }
}
