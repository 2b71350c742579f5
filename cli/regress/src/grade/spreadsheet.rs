//! The class as CSV: a row a submission, a column an expectation.

use super::marks::{Graded, percent};
use super::task::Task;

/// The table, with a head; ends of lines are those of RFC 4180.
pub(super) fn csv(task: &Task, all: &[Graded]) -> String {
    let mut head: Vec<String> =
        ["submission", "marks", "of", "percent", "safety violations", "status"].map(str::to_owned).to_vec();
    head.extend(task.items.iter().map(|item| format!("{} ({})", item.title(), item.worth.marks)));
    let mut text = row(&head);
    for graded in all {
        let (given, of) = (graded.given(), task.marks());
        let mut cells = vec![graded.submission.name.clone(), given.to_string(), of.to_string(), percent(given, of)];
        cells.extend([graded.safety_violations(task).to_string(), graded.standing.word().to_owned()]);
        cells.extend(graded.marked.iter().map(|marked| marked.given.to_string()));
        text.push_str(&row(&cells));
    }
    text
}

fn row(cells: &[String]) -> String {
    let cells: Vec<String> = cells.iter().map(|cell| written(cell)).collect();
    format!("{}\r\n", cells.join(","))
}

/// A cell. Names come from others: one that begins as a formula does is made a text, so that a spreadsheet computes nothing.
fn written(cell: &str) -> String {
    let cell = if cell.starts_with(['=', '+', '-', '@', '\t']) { format!("'{cell}") } else { cell.to_owned() };
    if cell.contains(['"', ',', '\r', '\n']) { format!("\"{}\"", cell.replace('"', "\"\"")) } else { cell }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_are_texts_and_no_formulas() {
        let cells = ["a", "b, c", "say \"d\"", "=1+1", ""].map(str::to_owned);
        assert_eq!(row(&cells), "a,\"b, c\",\"say \"\"d\"\"\",'=1+1,\r\n");
    }
}
