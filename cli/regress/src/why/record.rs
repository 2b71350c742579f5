//! What is known of a difference inside a PLC: where it arose, and from which earlier one.

use onescan_iec_run::{Declaration, Statement};
use onescan_server::signal::ClientName;
use onescan_server::time::VirtualTime;

/// A statement of one run, as it stands in the sources.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    pub file: String,
    /// Its line, from 1.
    pub line: u32,
    /// The instance that ran, as in `P1.axis[2] (Axis)`; the unit where it is not known.
    pub unit: String,
    pub text: String,
}

impl Place {
    /// A statement; where its partner in the other program reads otherwise, the first line that does.
    pub(super) fn of(statement: &Statement, partner: Option<&Statement>) -> Self {
        let Statement { unit, file, line, text, rows, .. } = statement;
        let other = partner.filter(|other| own_text(other) != own_text(statement)).and_then(|other| {
            let texts = |rows: &[(u32, String)]| rows.iter().map(|(_, row)| row.clone()).collect::<Vec<_>>();
            rows.get(first_other(&texts(rows), &texts(&other.rows)))
        });
        Self {
            file: file.clone(),
            line: other.map_or(*line, |(line, _)| *line),
            unit: unit.clone(),
            text: text.clone(),
        }
    }

    /// A declaration, at the first line that reads otherwise than in the other program.
    pub(super) fn declared(declaration: &Declaration, other: &Declaration) -> Self {
        let Declaration { unit, file, line, rows, .. } = declaration;
        let unit = if unit.is_empty() { "global variables".to_owned() } else { unit.clone() };
        let at = first_other(rows, &other.rows);
        let text = rows.get(at).cloned().unwrap_or_default();
        Self { file: file.clone(), line: line + at as u32, unit, text }
    }
}

/// The first of `rows` that is another in `others`; the last if there are just more of them there.
fn first_other(rows: &[String], others: &[String]) -> usize {
    let same = rows.iter().zip(others).take_while(|(row, other)| row == other).count();
    same.min(rows.len().saturating_sub(1))
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum What {
    /// A variable, and its value in each run.
    Value { path: String, values: [String; 2] },
    /// The way of a decision.
    Way([String; 2]),
    /// A statement runs in one of them only.
    Run,
    /// A statement that says something else, in a unit that was called.
    Text,
    /// The declaration of a variable that a statement uses, by its name.
    Declared(String),
}

/// Where a difference comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// From an earlier one, by its number: a value that was read, or a decision that went another way.
    Earlier(usize),
    /// From nothing that differed before: here the runs part.
    Here,
    /// From the values that variables begin with.
    Initial,
    Input,
    /// From an input, which is another since an output was.
    Feedback(usize),
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Record {
    pub client: ClientName,
    /// The scan in which it arose.
    pub t_v: VirtualTime,
    /// The statement in each run; nothing where there is none.
    pub at: [Option<Place>; 2],
    pub what: What,
    /// Where it comes from.
    pub origin: Origin,
}

/// All that a statement says itself, wherever its lines are broken.
pub(super) fn own_text(statement: &Statement) -> String {
    statement.rows.iter().map(|(_, row)| row.as_str()).collect::<Vec<_>>().join(" ")
}
