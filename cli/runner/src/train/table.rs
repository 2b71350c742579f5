//! Many sessions beside each other.

use std::io::Write;
use std::path::{Path, PathBuf};

use onescan_report::{OutputError, Table};
use serde_json::json;

use super::error::TrainError;
use super::record::{FILE_NAME, SessionRecord, to_text};
use super::score::{Handled, Response, Score};
use crate::error::{Unreadable, Usage};
use crate::format::Format;

/// The records of `scenario` in `folder` and in the folders below it, in the order of their names.
fn records(scenario: &str, folder: &Path) -> Result<Vec<(String, SessionRecord)>, TrainError> {
    let mut folders: Vec<PathBuf> = vec![folder.to_owned()];
    for entry in std::fs::read_dir(folder).map_err(Unreadable::at(folder))? {
        folders.push(entry.map_err(Unreadable::at(folder))?.path());
    }
    folders.sort();
    let mut found = Vec::new();
    for one in folders.into_iter().filter(|one| one.join(FILE_NAME).is_file()) {
        let record = SessionRecord::read(&one)?;
        if record.scenario == scenario {
            let name = one.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
            found.push((name, record));
        }
    }
    if found.is_empty() {
        let message = format!("there is no session with {scenario} in {}", folder.display());
        let help = "a session is recorded with `onescan train SCENARIO LESSON --record FOLDER`".to_owned();
        return Err(Usage::new(message, Some(help)).into());
    }
    Ok(found)
}

/// The mean of what was done, of all malfunctions that came; nothing if nothing was.
fn mean(score: &Score, of: impl Fn(&Handled) -> Option<Response>) -> Option<u64> {
    let times: Vec<u64> = score.malfunctions.iter().filter_map(|handled| of(handled)?.after_ns).collect();
    let count = u64::try_from(times.len()).ok().filter(|count| *count > 0)?;
    Some(times.iter().sum::<u64>() / count)
}

/// A session in numbers.
struct Row<'r> {
    folder: &'r str,
    record: &'r SessionRecord,
    attempts: usize,
    mastered: (usize, usize),
    identify_ns: Option<u64>,
    act_ns: Option<u64>,
    violated: usize,
    costs: Vec<(String, f64, String)>,
}

impl<'r> Row<'r> {
    fn of(folder: &'r str, record: &'r SessionRecord) -> Option<Self> {
        let score = &record.last()?.score;
        let came = score.malfunctions.iter().filter(|handled| handled.begun_ns.is_some());
        Some(Self {
            folder,
            record,
            attempts: record.attempts.len(),
            mastered: (came.clone().filter(|handled| handled.is_mastered()).count(), came.count()),
            identify_ns: mean(score, |handled| handled.identified),
            act_ns: mean(score, |handled| handled.acted),
            violated: score.expectations.iter().filter(|one| one.at_ns.is_some()).count(),
            costs: score
                .costs
                .iter()
                .map(|cost| (cost.name.clone(), cost.value, cost.unit.clone().unwrap_or_default()))
                .collect(),
        })
    }

    fn cells(&self) -> Vec<String> {
        let time = |time: Option<u64>| time.map_or_else(|| "–".to_owned(), to_text);
        let cost = |(name, value, unit): &(String, f64, String)| {
            format!("{name} {} {unit}", onescan_report::number::short(*value)).trim_end().to_owned()
        };
        vec![
            self.folder.to_owned(),
            self.record.lesson.clone(),
            self.record.trainee.clone(),
            if self.record.passed { "passed" } else { "not passed" }.to_owned(),
            self.attempts.to_string(),
            format!("{} of {}", self.mastered.0, self.mastered.1),
            time(self.identify_ns),
            time(self.act_ns),
            self.violated.to_string(),
            self.costs.iter().map(cost).collect::<Vec<String>>().join(", "),
        ]
    }

    fn json(&self) -> serde_json::Value {
        let costs: serde_json::Map<String, serde_json::Value> =
            self.costs.iter().map(|(name, value, _)| (name.clone(), json!(value))).collect();
        json!({
            "session": self.folder,
            "lesson": self.record.lesson,
            "trainee": self.record.trainee,
            "passed": self.record.passed,
            "attempts": self.attempts,
            "mastered": self.mastered.0,
            "malfunctions": self.mastered.1,
            "identify_ns": self.identify_ns,
            "act_ns": self.act_ns,
            "violated": self.violated,
            "costs": costs,
        })
    }
}

/// Writes the table of the sessions in `folder`.
pub(super) fn write(scenario: &str, folder: &Path, format: Format, out: &mut dyn Write) -> Result<(), TrainError> {
    let records = records(scenario, folder)?;
    let rows: Vec<Row<'_>> = records.iter().filter_map(|(folder, record)| Row::of(folder, record)).collect();
    if format == Format::Json {
        for row in &rows {
            writeln!(out, "{}", row.json()).map_err(OutputError)?;
        }
        return Ok(());
    }
    let head = ["lesson", "trainee", "", "attempts", "mastered", "identified", "acted", "violated", "cost"];
    let table = Table {
        title: "session",
        head: head.into_iter().map(Into::into).collect(),
        rows: rows.iter().map(Row::cells).collect(),
        remarks: vec!["identified, acted: the mean of what was done; the last attempt counts".to_owned()],
        is_folded: false,
    };
    Ok(table.write(out).map_err(OutputError)?)
}
