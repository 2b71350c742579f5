//! Coverage of a page: a line for each file.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use onescan_plc_shim::Coverage;
use onescan_plc_shim::coverage::{Counted, Row};

use super::markup::escaped;
use crate::regress::summary::share;

/// All of something, how much of it was executed.
type Part = (usize, usize);

/// Writes the table; nothing where nothing was noted.
///
/// # Errors
/// None: a string takes everything.
pub(super) fn write(coverage: &Coverage, text: &mut String) -> std::fmt::Result {
    let rows = coverage.rows();
    if rows.is_empty() {
        return Ok(());
    }
    let mut files: BTreeMap<&str, (Part, Part, Vec<u32>)> = BTreeMap::new();
    for Row { file, line, of, count } in &rows {
        let (lines, branches, missed) = files.entry(file).or_default();
        let part = match of {
            Counted::Unit(_) => continue,
            Counted::Line => lines,
            Counted::Outcome { .. } => branches,
        };
        *part = (part.0 + 1, part.1 + usize::from(*count > 0));
        if matches!(of, Counted::Line) && *count == 0 {
            missed.push(*line);
        }
    }
    text.push_str("<section id=\"coverage\"><h2>coverage of the PLC's code</h2>\n<table><thead><tr><th>file<th>lines<th>branches<th>lines never executed</thead>\n");
    for (file, (lines, branches, missed)) in files {
        let missed: Vec<String> = missed.iter().map(u32::to_string).collect();
        let (lines, branches) = (share(lines), share(branches));
        writeln!(text, "<tr><td>{}<td>{lines}<td>{branches}<td class=\"value\">{}", escaped(file), missed.join(" "))?;
    }
    writeln!(text, "</table></section>")
}
