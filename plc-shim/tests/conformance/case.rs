//! The trace that a program is to have, as its comment says it.

use onescan_iec::TimeSpan;
use onescan_iec::dialect::Dialect;

use super::cell;

/// What is to happen to a program, scan by scan.
#[derive(Debug, Default)]
pub(crate) struct Case {
    pub(crate) scans: usize,
    interval: Option<TimeSpan>,
    pub(crate) dialect: Option<Dialect>,
    pub(crate) restarts: Vec<String>,
    pub(crate) given: Vec<Row>,
    pub(crate) wanted: Vec<Row>,
    pub(crate) fault: Option<String>,
    /// Codes; nothing if only the absence of errors matters.
    pub(crate) findings: Option<Vec<String>>,
}

/// A variable's values by scan.
#[derive(Debug)]
pub(crate) struct Row {
    pub(crate) path: String,
    cells: Vec<String>,
}

/// What a line shows where nothing is said.
const NOTHING: &str = "-";

impl Row {
    fn new(path: &str, text: &str) -> Self {
        Self { path: path.trim().to_owned(), cells: cells(text) }
    }

    /// What is given before a scan. A value alone is given once.
    pub(crate) fn given(&self, scan: usize) -> Option<&str> {
        self.cells.get(scan).map(String::as_str).filter(|cell| *cell != NOTHING)
    }

    /// What is wanted after a scan. A value alone is wanted always.
    pub(crate) fn wanted(&self, scan: usize) -> Option<&str> {
        let scan = if self.cells.len() == 1 { 0 } else { scan };
        self.given(scan)
    }
}

impl Case {
    /// The comment `(* TRACE .. *)` of a program.
    pub(crate) fn parse(text: &str) -> Result<Self, String> {
        let (_, block) = text.split_once("(* TRACE").ok_or("there is no `(* TRACE` comment")?;
        let (block, _) = block.split_once("*)").ok_or("the trace has no end")?;
        let mut case = Self::default();
        for line in block.lines().map(str::trim).filter(|line| !line.is_empty()) {
            case.line(line).map_err(|why| format!("{why}: `{line}`"))?;
        }
        let rows = || case.given.iter().chain(&case.wanted);
        let longest = rows().map(|row| row.cells.len()).max().unwrap_or(1).max(case.restarts.len());
        case.scans = case.scans.max(longest);
        if let Some(row) = rows().find(|row| row.cells.len() > 1 && row.cells.len() != case.scans) {
            return Err(format!("`{}` has {} values for {} scans", row.path, row.cells.len(), case.scans));
        }
        if case.wanted.is_empty() && case.fault.is_none() && case.findings.is_none() {
            return Err("the trace wants nothing".to_owned());
        }
        Ok(case)
    }

    fn line(&mut self, line: &str) -> Result<(), String> {
        if let Some((path, values)) = line.split_once(" := ") {
            self.given.push(Row::new(path, values));
        } else if let Some((path, values)) = line.split_once(" = ") {
            self.wanted.push(Row::new(path, values));
        } else {
            let (word, value) = line.split_once(':').ok_or("this is not a line of a trace")?;
            self.setting(word.trim(), value.trim())?;
        }
        Ok(())
    }

    /// Interval of the only task, unless a configuration says otherwise.
    pub(crate) fn interval(&self) -> TimeSpan {
        self.interval.unwrap_or(TimeSpan::millis::<10>())
    }

    fn setting(&mut self, word: &str, value: &str) -> Result<(), String> {
        match word {
            "scans" => self.scans = value.parse().map_err(|_| "this is not a number")?,
            "interval" => {
                let ns = cell::duration_ns(value).ok_or("this is not a duration")?;
                let interval = u64::try_from(ns).ok().and_then(TimeSpan::from_nanos);
                self.interval = Some(interval.ok_or("this is not an interval")?);
            }
            "dialect" => self.dialect = Some(Dialect::find(value).ok_or("this is not a dialect")?),
            "restart" => self.restarts = value.split_whitespace().map(str::to_owned).collect(),
            "fault" => self.fault = Some(value.to_owned()),
            "findings" => self.findings = Some(value.split_whitespace().map(str::to_owned).collect()),
            _ => return Err("this word is not known".to_owned()),
        }
        Ok(())
    }
}

/// Values between blanks; quotes keep blanks, and levels are a value each.
fn cells(text: &str) -> Vec<String> {
    let mut cells = Vec::new();
    let mut rest = text.trim();
    while !rest.is_empty() {
        let end = match rest.strip_prefix('\'') {
            Some(inside) => inside.find('\'').map_or(rest.len(), |end| end + 2),
            None => rest.find(char::is_whitespace).unwrap_or(rest.len()),
        };
        let (cell, tail) = rest.split_at(end);
        if cell.chars().all(|level| matches!(level, '.' | '#')) {
            cells.extend(cell.chars().map(String::from));
        } else {
            cells.push(cell.to_owned());
        }
        rest = tail.trim_start();
    }
    cells
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_trace_is_read() {
        let case = Case::parse("(* TRACE\n a := .#. \n s = 'x y' - ''\n n = 5\n interval: 20ms\n*)").expect("a trace");
        assert_eq!((case.scans, case.interval()), (3, TimeSpan::millis::<20>()));
        assert_eq!(case.given[0].given(1), Some("#"));
        assert_eq!(
            (0..3).map(|scan| case.wanted[0].wanted(scan)).collect::<Vec<_>>(),
            [Some("'x y'"), None, Some("''")]
        );
        assert_eq!(case.wanted[1].wanted(2), Some("5"));
    }

    #[test]
    fn slips_are_reported() {
        for (text, why) in [
            ("PROGRAM P", "no `(* TRACE`"),
            ("(* TRACE a = 1", "no end"),
            ("(* TRACE\n a := 1 2 3\n b = 1 2 *)", "`b` has 2 values for 3 scans"),
            ("(* TRACE\n speed: 5 *)", "not known"),
            ("(* TRACE\n a := 1 *)", "wants nothing"),
        ] {
            let error = Case::parse(text).expect_err(text);
            assert!(error.contains(why), "{error}");
        }
    }
}
