//! As plain rows, to be carried from one process to another.

use super::Coverage;

#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Row {
    pub file: String,
    pub line: u32,
    /// What is counted there.
    pub of: Counted,
    /// In how many runs it was executed.
    pub count: u64,
}

/// What a row counts.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Counted {
    /// A unit, by its name.
    Unit(String),
    /// The statements of a line.
    Line,
    /// An outcome of the decision at a column.
    Outcome {
        /// The column, from 1.
        column: u32,
        outcome: u32,
    },
}

impl Coverage {
    /// Everything that is counted.
    pub fn rows(&self) -> Vec<Row> {
        let mut rows = Vec::new();
        for (name, file) in &self.files {
            let mut row = |line: u32, of, count: u64| rows.push(Row { file: name.clone(), line, of, count });
            for ((line, unit), count) in &file.units {
                row(*line, Counted::Unit(unit.clone()), *count);
            }
            for (line, count) in &file.lines {
                row(*line, Counted::Line, *count);
            }
            for ((line, column), outcomes) in &file.decisions {
                for (outcome, count) in outcomes {
                    row(*line, Counted::Outcome { column: *column, outcome: *outcome }, *count);
                }
            }
        }
        rows
    }

    /// Adds a row to what is counted.
    pub fn add(&mut self, row: &Row) {
        let file = self.files.entry(row.file.clone()).or_default();
        let slot = match &row.of {
            Counted::Unit(unit) => file.units.entry((row.line, unit.clone())).or_default(),
            Counted::Line => file.lines.entry(row.line).or_default(),
            Counted::Outcome { column, outcome } => {
                file.decisions.entry((row.line, *column)).or_default().entry(*outcome).or_default()
            }
        };
        *slot = slot.saturating_add(row.count);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_the_whole() {
        let row = |line, of, count| Row { file: "a.st".to_owned(), line, of, count };
        let rows = [
            row(1, Counted::Unit("Main".to_owned()), 1),
            row(2, Counted::Line, 3),
            row(2, Counted::Outcome { column: 4, outcome: 0 }, 0),
            row(2, Counted::Outcome { column: 4, outcome: 1 }, 3),
        ];
        let mut coverage = Coverage::default();
        for row in &rows {
            coverage.add(row);
        }
        assert_eq!(coverage.rows(), rows);
        for row in &rows {
            coverage.add(row);
        }
        assert_eq!(coverage.rows()[1].count, 6);
    }
}
