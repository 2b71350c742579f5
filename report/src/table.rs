//! Tables, for terminals and pages.

use std::borrow::Cow;
use std::io::{self, Write};

/// A table with a head.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Table {
    /// What it is about; the head of its first column.
    pub title: &'static str,
    /// The heads of the other columns.
    pub head: Vec<Cow<'static, str>>,
    /// Its rows; the first cell is a name, the others are numbers with their units.
    pub rows: Vec<Vec<String>>,
    /// What there is to say about all of it, a line each.
    pub remarks: Vec<String>,
    /// True if a page shows it only to who asks for it.
    pub is_folded: bool,
}

impl Table {
    /// Writes it with columns as wide as their widest cell.
    ///
    /// # Errors
    /// Those of the output.
    pub fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        let head = std::iter::once(self.title).chain(self.head.iter().map(AsRef::as_ref)).map(str::to_owned).collect();
        let rows: Vec<Vec<String>> = std::iter::once(head).chain(self.rows.iter().cloned()).collect();
        write(&rows, out)?;
        self.remarks.iter().try_for_each(|remark| writeln!(out, "  {remark}"))
    }
}

/// Writes rows with columns as wide as their widest cell.
///
/// # Errors
/// Those of the output.
pub fn write(rows: &[Vec<String>], out: &mut dyn Write) -> io::Result<()> {
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width = |column: usize| rows.iter().filter_map(|row| row.get(column)).map(|cell| cell.chars().count()).max();
    let widths: Vec<usize> = (0..columns).map(|column| width(column).unwrap_or(0)).collect();
    for row in rows {
        let cells: Vec<String> = row.iter().zip(&widths).map(|(cell, width)| format!("{cell:width$}")).collect();
        writeln!(out, "  {}", cells.join("  ").trim_end())?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_as_wide_as_their_widest_cell() {
        let table = Table {
            title: "cause",
            head: ["times", "total"].map(Into::into).into(),
            rows: vec![vec!["stopped".to_owned(), "2".to_owned(), "10 s".to_owned()]],
            remarks: vec!["availability 90 %".to_owned()],
            is_folded: false,
        };
        let mut written = Vec::new();
        table.write(&mut written).unwrap();
        let expected = "  cause    times  total\n  stopped  2      10 s\n  availability 90 %\n";
        assert_eq!(String::from_utf8(written).unwrap(), expected);
    }
}
