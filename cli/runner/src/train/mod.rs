//! `onescan train`: somebody takes a lesson, at the panels of a page or by a recording, and is measured on virtual time.
//!
//! | module | subject |
//! |---|---|
//! | [`config`] | what is asked for |
//! | `starts` | prepared states, kept as checkpoints |
//! | `examination` | watches an attempt and measures it |
//! | [`score`] | what is measured |
//! | `moments` | moments to go back to |
//! | `attempt` | one attempt, from a moment to its end |
//! | `real_plc` | real PLCs, from attempt to attempt |
//! | `course` | a session: attempt after attempt, live or repeated |
//! | [`record`] | the record of a session |
//! | `report` | what came of it, for people |
//! | `table` | many sessions beside each other |
//! | [`error`] | why nothing came of it |

mod attempt;
pub mod config;
mod course;
pub mod error;
mod examination;
mod moments;
mod real_plc;
pub mod record;
mod report;
pub mod score;
mod starts;
mod table;

use std::io::Write;
use std::path::Path;

use onescan_report::lines::{WIDTH, broken};
use onescan_report::number::counted;
use onescan_report::{OutputError, file};
use onescan_scenario::Scenario;
use onescan_scenario::lesson::Book;

pub use config::TrainConfig;
pub use error::TrainError;
pub(crate) use starts::usual_folder;

use crate::error::{ExitCode, Usage};
use crate::format::Format;
use crate::interrupt::Interrupt;
use course::{Classroom, Held};
use real_plc::RealPlcs;

/// Lets somebody take a lesson, and reports to `out` what came of it.
///
/// # Errors
/// See [`TrainError`]. A lesson that is not passed is not an error.
pub fn run(config: &TrainConfig, interrupt: &Interrupt, out: &mut dyn Write) -> Result<ExitCode, TrainError> {
    let scenario = Scenario::load(&config.scenario)?;
    let book = Book::load(&scenario)?;
    let Some(name) = &config.lesson else {
        list(&book, config.format, out).map_err(OutputError)?;
        return Ok(ExitCode::Ok);
    };
    let Some(lesson) = book.lessons().iter().find(|lesson| lesson.name == *name) else {
        let names = book.lessons().iter().map(|lesson| lesson.name.as_str());
        let help = onescan_base::did_you_mean(name, names);
        return Err(Usage::new(format!("scenario `{}` has no lesson `{name}`", scenario.name()), help).into());
    };
    if let Some(folder) = &config.record {
        record::begin(folder, config.overwrite)?;
    }
    let mut commissioned = scenario.clone();
    for (client, url) in &config.gateways {
        commissioned.commission(client, url.clone())?;
    }
    let real = RealPlcs::connect(&commissioned)?;
    let classroom = Classroom { config, scenario: &commissioned, book: &book, lesson, interrupt, real: &real };
    let Held { record, unequal, broken_off } = classroom.hold(&scenario)?;
    if let Some(folder) = &config.record {
        record.write(folder)?;
    }
    if let Some(path) = &config.html {
        file::write_output(path, report::page(&record, lesson).to_html().as_bytes())?;
    }
    match config.format {
        Format::Json => {
            serde_json::to_writer(&mut *out, &record).map_err(|error| OutputError(error.into()))?;
            writeln!(out).map_err(OutputError)?;
        }
        Format::Human => report::write(&record, &unequal, out).map_err(OutputError)?,
    }
    if let Some(error) = broken_off {
        return Err(error);
    }
    let failed = record.last().is_some_and(|attempt| attempt.failure.is_some());
    Ok(match (failed, record.passed && unequal.is_empty()) {
        (true, _) => ExitCode::Fault,
        (false, true) => ExitCode::Ok,
        (false, false) => ExitCode::Unmet,
    })
}

/// Sets the sessions in the folders below `folder` side by side.
///
/// # Errors
/// See [`TrainError`].
pub fn table(scenario: &Path, folder: &Path, format: Format, out: &mut dyn Write) -> Result<ExitCode, TrainError> {
    let scenario = Scenario::load(scenario)?;
    table::write(scenario.name(), folder, format, out)?;
    Ok(ExitCode::Ok)
}

/// What can be learnt.
fn list(book: &Book, format: Format, out: &mut dyn Write) -> std::io::Result<()> {
    if format == Format::Json {
        for lesson in book.lessons() {
            let (name, about, start) = (&lesson.name, &lesson.about, &lesson.start);
            writeln!(out, "{}", serde_json::json!({ "lesson": name, "about": about, "start": start }))?;
        }
        return Ok(());
    }
    for lesson in book.lessons() {
        writeln!(out, "{}", lesson.name)?;
        for line in broken(lesson.about.as_deref().unwrap_or("a lesson"), WIDTH - 2) {
            writeln!(out, "  {line}")?;
        }
        let malfunctions = counted(lesson.malfunctions.len() as u64, "malfunction");
        writeln!(out, "  from `{}`, {malfunctions}, at most {}", lesson.start, lesson.lasts)?;
    }
    for start in book.starts() {
        let about = start.about.as_deref().unwrap_or("a prepared state");
        let lines = broken(&format!("start `{}` at {}: {about}", start.name, start.at), WIDTH - 2);
        writeln!(out, "{}", lines.join("\n  "))?;
    }
    Ok(())
}
