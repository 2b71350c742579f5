//! A page in Markdown as a terminal shows it: headings without marks, tables in columns.

use std::fmt::Write as _;

use onescan_report::lines::{WIDTH, broken};

/// Between two columns of a table.
const GAP: usize = 2;
/// A column before the last is not wider than this: what follows a wider cell begins on the next line.
const COLUMN_MAX: usize = 24;
/// A last column that is narrower than this is not broken.
const NARROW: usize = 24;

/// The text of the page.
pub(super) fn of_markdown(page: &str) -> String {
    let mut text = String::new();
    let mut rows: Vec<Vec<String>> = Vec::new();
    for line in page.lines() {
        match cells(line) {
            Some(row) if row.iter().all(|cell| cell.starts_with("---")) => {}
            Some(row) => rows.push(row),
            None => {
                write_table(&std::mem::take(&mut rows), &mut text);
                let heading = line.trim_start_matches('#');
                let shown = if heading.len() < line.len() { heading.trim_start() } else { line };
                writeln!(text, "{}", plain(shown)).expect("a string takes all");
            }
        }
    }
    write_table(&rows, &mut text);
    text
}

/// The cells of a row of a table; nothing for any other line.
fn cells(line: &str) -> Option<Vec<String>> {
    let row = line.strip_prefix('|')?.strip_suffix('|')?;
    // A bar that belongs to a text is escaped.
    let parted = row.replace("\\|", "\u{1}");
    Some(parted.split('|').map(|cell| plain(&cell.replace('\u{1}', "|")).trim().to_owned()).collect())
}

/// Without the marks of code, and with the words of a link in its place.
fn plain(text: &str) -> String {
    let mut plain = String::new();
    let mut rest = text;
    while let Some(at) = rest.find(['`', '[']) {
        plain.push_str(&rest[..at]);
        let found = &rest[at..];
        let link =
            found.strip_prefix('[').and_then(|link| link.split_once("](")).filter(|(words, _)| !words.contains(']'));
        rest = match link.and_then(|(words, target)| Some((words, target.split_once(')')?.1))) {
            Some((words, behind)) => {
                plain.push_str(&words.replace('`', ""));
                behind
            }
            None if found.starts_with('[') => {
                plain.push('[');
                &found[1..]
            }
            None => &found[1..],
        };
    }
    plain + rest
}

/// Columns as wide as their cells, of which the last is broken at the edge.
fn write_table(rows: &[Vec<String>], text: &mut String) {
    let count = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width = |column: usize| rows.iter().filter_map(|row| row.get(column)).map(|cell| cell.chars().count()).max();
    // A column without a word takes no room.
    let columns: Vec<(usize, usize)> = (0..count)
        .filter_map(|column| Some((column, width(column)?)))
        .filter(|(_, width)| *width > 0)
        .map(|(column, width)| (column, width.min(COLUMN_MAX)))
        .collect();
    let Some(((last, _), before)) = columns.split_last() else { return };
    let start: usize = 2 + before.iter().map(|(_, width)| width + GAP).sum::<usize>();
    let room = WIDTH.saturating_sub(start).max(NARROW);
    for row in rows {
        let cell = |column: usize| row.get(column).map_or("", String::as_str);
        let mut line = "  ".to_owned();
        let mut column_start = 2;
        for (column, width) in before {
            let own_start = column_start;
            column_start += width + GAP;
            if cell(*column).chars().count() > *width {
                // What follows begins on the next line.
                write_hanging(&line, cell(*column), WIDTH.saturating_sub(own_start).max(COLUMN_MAX), text);
                line = " ".repeat(column_start);
            } else {
                write!(line, "{:<1$}", cell(*column), width + GAP).expect("a string takes all");
            }
        }
        write_hanging(&line, cell(*last), room, text);
    }
}

/// A cell behind what stands before it in its row; its further lines begin beneath its first one.
fn write_hanging(before: &str, cell: &str, room: usize, text: &mut String) {
    let indent = before.chars().count();
    for (number, part) in broken(cell, room).iter().enumerate() {
        let line = if number == 0 { format!("{before}{part}") } else { format!("{:indent$}{part}", "") };
        writeln!(text, "{}", line.trim_end()).expect("a string takes all");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_reads_well_on_a_terminal() {
        let page = "## kind\n\na `belt`, see [plant](plant.md#x): a[1]\n\n    v = w r\n\n| parameter | | unit |\n|---|---|---|\n\
                    | `speed_m_s` | a \\| b | m/s, along the direction of the belt, which is that of its x axis in the scene |\n\
                    | `x` | | |\n";
        insta::assert_snapshot!(of_markdown(page), @r"
        kind

        a belt, see plant: a[1]

            v = w r

          parameter         unit
          speed_m_s  a | b  m/s, along the direction of the belt, which is that of its x
                            axis in the scene
          x
        ");
    }

    #[test]
    fn no_row_of_a_kind_of_the_library_is_wider_than_a_terminal() {
        for kind in onescan_plant::component::kinds() {
            let text = of_markdown(&onescan_plant::component::page::page(kind));
            let is_row = |line: &&str| line.starts_with("  ") && !line.starts_with("    ");
            let widest = text.lines().filter(is_row).map(|line| line.chars().count()).max().unwrap_or(0);
            assert!(widest <= 100 && !text.contains("|---"), "{}: {widest}\n{text}", kind.name);
        }
    }
}
