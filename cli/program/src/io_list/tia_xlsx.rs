//! A tag table of TIA Portal as a workbook: the sheet `PLC Tags`, a tag a row.

use std::io::{Cursor, Read};
use std::path::Path;

use calamine::{DataRef, Reader, Xlsx, XlsxError};

use super::collect::Collected;
use super::error::ListError;
use super::tia::Tag;
use super::{IoList, ListKind};

/// The sheet that TIA Portal writes.
const SHEET: &str = "PLC Tags";

/// Columns beyond this one are nobody's tags.
const COLUMNS_MAX: u32 = 64;

/// Bytes that a workbook may have when it is unpacked.
const UNPACKED_MAX: u64 = 512 << 20;

/// The columns by their headings.
#[derive(Clone, Copy, Debug, Default)]
struct Columns {
    name: Option<u32>,
    ty: Option<u32>,
    address: Option<u32>,
    comment: Option<u32>,
}

impl Columns {
    fn take(&mut self, heading: &str, column: u32) {
        let place = match heading.trim().to_ascii_lowercase().as_str() {
            "name" => &mut self.name,
            "data type" | "datatype" | "datentyp" => &mut self.ty,
            "logical address" | "address" | "logische adresse" | "adresse" => &mut self.address,
            "comment" | "kommentar" => &mut self.comment,
            _ => return,
        };
        place.get_or_insert(column);
    }
}

/// Reads the tags.
///
/// # Errors
/// It is not a workbook with such a sheet.
pub fn read(path: &Path, bytes: Vec<u8>) -> Result<IoList, ListError> {
    let wrong = |cause: String| ListError::NotWorkbook { file: path.display().to_string(), cause };
    bounded(&bytes).map_err(wrong)?;
    let broken = |error: XlsxError| wrong(format!("it is no XLSX workbook: {error}"));
    let mut book: Xlsx<_> = Xlsx::new(Cursor::new(bytes)).map_err(broken)?;
    let sheets = book.sheet_names();
    let Some(sheet) = sheets.iter().find(|name| name.trim().eq_ignore_ascii_case(SHEET)).cloned() else {
        return Err(wrong(format!("it has no sheet `{SHEET}`, but {}", sheets.join(", "))));
    };
    let mut cells = book.worksheet_cells_reader(&sheet).map_err(broken)?;
    let mut rows = Rows { collected: Collected::of(path), columns: Columns::default(), cells: Vec::new(), row: 0 };
    // Cells come one by one: a sheet that claims to be a million columns wide takes no room.
    while let Some(cell) = cells.next_cell().map_err(broken)? {
        let (row, column) = cell.get_position();
        if row != rows.row {
            rows.end()?;
            rows.row = row;
        }
        if column < COLUMNS_MAX {
            rows.cells.push((column, shown(cell.get_value())));
        }
    }
    rows.end()?;
    let Columns { name: Some(_), ty: Some(_), address: Some(_), .. } = rows.columns else {
        return Err(wrong(format!("sheet `{SHEET}` has no columns `Name`, `Data Type` and `Logical Address`")));
    };
    Ok(rows.collected.list(ListKind::TiaXlsx))
}

/// A sheet while its cells come in.
struct Rows {
    collected: Collected,
    columns: Columns,
    cells: Vec<(u32, String)>,
    row: u32,
}

impl Rows {
    /// Takes what has come of a row.
    fn end(&mut self) -> Result<(), ListError> {
        let cells = std::mem::take(&mut self.cells);
        if self.columns.name.is_none() {
            for (column, text) in &cells {
                self.columns.take(text, *column);
            }
            return Ok(());
        }
        let cell = |wanted: Option<u32>| {
            let found = cells.iter().find(|(column, _)| Some(*column) == wanted);
            found.map_or("", |(_, text)| text.as_str())
        };
        let Columns { name, ty, address, comment } = self.columns;
        let line = Some(self.row.saturating_add(1));
        let tag = Tag { name: cell(name), ty: cell(ty), address: cell(address), comment: cell(comment), line };
        if tag.name.is_empty() && tag.address.is_empty() {
            return Ok(());
        }
        tag.into_list(&mut self.collected)
    }
}

fn shown(value: &DataRef) -> String {
    match value {
        DataRef::String(text) => text.trim().to_owned(),
        DataRef::SharedString(text) => text.trim().to_owned(),
        DataRef::Int(number) => number.to_string(),
        DataRef::Float(number) => number.to_string(),
        DataRef::Bool(value) => value.to_string(),
        _ => String::new(),
    }
}

/// Unpacks everything once, to refuse what is made to fill the memory.
fn bounded(bytes: &[u8]) -> Result<(), String> {
    let broken = |error: zip::result::ZipError| format!("it is no XLSX workbook: {error}");
    let mut archive = zip::ZipArchive::new(Cursor::new(bytes)).map_err(broken)?;
    let mut left = UNPACKED_MAX;
    for index in 0..archive.len() {
        let entry = archive.by_index(index).map_err(broken)?;
        let read = std::io::copy(&mut entry.take(left + 1), &mut std::io::sink());
        let read = read.map_err(|error| format!("it is no XLSX workbook: {error}"))?;
        left = left.checked_sub(read).ok_or_else(|| format!("it unpacks to more than {} MiB", UNPACKED_MAX >> 20))?;
    }
    Ok(())
}
