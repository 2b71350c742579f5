//! Coverage of a page: a line for each file.

use maud::{Markup, html};

use super::LINE;

/// What was executed of a file.
#[derive(Clone, Debug)]
pub struct CoveredFile {
    pub file: String,
    /// How many of its lines, in words.
    pub lines: String,
    /// How many outcomes of its decisions, in words.
    pub branches: String,
    /// The lines that never were.
    pub missed: Vec<u32>,
}

pub(super) fn markup(files: &[CoveredFile]) -> Markup {
    let missed = |file: &CoveredFile| file.missed.iter().map(u32::to_string).collect::<Vec<_>>().join(" ");
    html! {
        section id="coverage" {
            h2 { "coverage of the PLC's code" } (LINE)
            table {
                thead { tr { th { "file" } th { "lines" } th { "branches" } th { "lines never executed" } } } (LINE)
                @for file in files {
                    tr {
                        td { (file.file) } td { (file.lines) } td { (file.branches) }
                        td class="value" { (missed(file)) }
                    } (LINE)
                }
            }
        }
    }
}
