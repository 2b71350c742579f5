//! A tag table as text: `.sdf` of TIA Portal and of STEP 7, and CSV with headings.

use std::path::Path;

use onescan_base::foreign::one_line;

use super::collect::Collected;
use super::error::ListError;
use super::flatten::elementary;
use super::tia::Tag;
use super::xml::text;
use super::{IoList, ListKind};

/// Reads the tags.
///
/// # Errors
/// It is no such text.
pub fn read(path: &Path, bytes: &[u8]) -> Result<IoList, ListError> {
    let text = text(path, bytes)?;
    let first = text.lines().find(|line| !line.trim().is_empty()).unwrap_or_default();
    let delimiter =
        [b';', b'\t', b','].into_iter().max_by_key(|mark| first.bytes().filter(|byte| byte == mark).count());
    let mut collected = Collected::of(path);
    let mut headings = None;
    for (line, record) in records(path, &text, delimiter.unwrap_or(b','))? {
        let fields: Vec<_> = record.iter().map(str::trim).collect();
        if headings.is_none() {
            headings = Some(Headings::of(&fields));
            if headings.is_some_and(|headings| headings.is_some()) {
                continue;
            }
            refuse_without_headings(path, &record)?;
        }
        let tag = match headings.flatten() {
            Some(headings) => headings.tag(&fields),
            None => without_headings(&fields),
        };
        Tag { line: Some(line), ..tag }.into_list(&mut collected)?;
    }
    Ok(collected.list(ListKind::TiaText))
}

/// A CSV of TIA Portal has headings; one without is somebody else's, whatever its fields look like. Other texts have none.
fn refuse_without_headings(path: &Path, first: &csv::StringRecord) -> Result<(), ListError> {
    if path.extension().is_none_or(|extension| !extension.eq_ignore_ascii_case("csv")) {
        return Ok(());
    }
    let first: Vec<&str> = first.iter().collect();
    Err(ListError::Other {
        file: path.display().to_string(),
        what: format!("its first line is `{}`, which does not have the headings of a tag table", one_line(&first.join(";"))),
        help: Some(
            "TIA Portal writes `Name`, `Data Type` and `Logical Address`; of CODESYS, onescan reads what `Export mappings \
             to CSV` in the context menu of a device writes"
                .to_owned(),
        ),
    })
}

/// The records of a text with separated fields, each with its line.
pub(super) fn records(path: &Path, text: &str, delimiter: u8) -> Result<Vec<(u32, csv::StringRecord)>, ListError> {
    let reader =
        csv::ReaderBuilder::new().has_headers(false).flexible(true).delimiter(delimiter).from_reader(text.as_bytes());
    let records = reader.into_records().map(|record| {
        let record = record.map_err(|error| ListError::Other {
            file: path.display().to_string(),
            what: error.to_string(),
            help: Some("this is not text with separated fields".to_owned()),
        })?;
        Ok((record.position().map_or(1, |position| position.line() as u32), record))
    });
    records.collect()
}

/// Which field is what.
#[derive(Clone, Copy, Debug)]
struct Headings {
    name: usize,
    ty: usize,
    address: usize,
    comment: Option<usize>,
}

impl Headings {
    fn of(fields: &[&str]) -> Option<Self> {
        let at =
            |names: &[&str]| fields.iter().position(|field| names.iter().any(|name| field.eq_ignore_ascii_case(name)));
        Some(Self {
            name: at(&["Name"])?,
            ty: at(&["Data Type", "DataType", "Datentyp"])?,
            address: at(&["Logical Address", "Address", "Adresse", "Logische Adresse"])?,
            comment: at(&["Comment", "Kommentar"]),
        })
    }

    fn tag<'a>(self, fields: &[&'a str]) -> Tag<'a> {
        let field = |at: usize| fields.get(at).copied().unwrap_or_default();
        let comment = self.comment.map_or("", field);
        Tag { name: field(self.name), ty: field(self.ty), address: field(self.address), comment, line: None }
    }
}

/// A tag of an `.sdf`: the name first, then address and type in either order, the comment behind them.
fn without_headings<'a>(fields: &[&'a str]) -> Tag<'a> {
    let name = fields.first().copied().unwrap_or_default();
    let rest = fields.get(1..).unwrap_or_default();
    let is_switch = |field: &&&str| matches!(field.to_ascii_lowercase().as_str(), "" | "true" | "false");
    let ty = rest.iter().position(|field| elementary(field).is_some());
    let is_address = |field: &&str| field.starts_with('%') || field.split_whitespace().count() == 2;
    let address = rest.iter().position(is_address).filter(|at| Some(*at) != ty);
    let known = ty.max(address).map_or(0, |at| at + 1);
    Tag {
        name,
        ty: ty.map_or("", |at| rest[at]),
        address: address.map_or("", |at| rest[at]),
        comment: rest[known..].iter().find(|field| !is_switch(field)).copied().unwrap_or_default(),
        line: None,
    }
}
