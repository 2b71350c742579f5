//! What operators did in a run, as a case: shown, and written into the scenario's file of cases where the run allows it.
//!
//! The case is that of the run with their inputs beside what it did, and ends where the session has come to. Run by
//! itself it has the digest of the session.

use std::path::Path;
use std::sync::Arc;

use onescan_base::regular;
use onescan_report::file;
use onescan_scenario::case::written::Written;
use onescan_scenario::case::{self, Catalogue};
use onescan_scenario::{Scenario, ScenarioError};
use onescan_server::operation::OperatorInput;
use onescan_server::signal::ClientName;
use thiserror::Error;

use super::config::{RunConfig, Subject};
use crate::error::Usage;
use crate::operated;
use crate::past::Kept;
use crate::web::{CaseWanted, KeepCase, KeptCase};

/// What stands before the first case of a scenario that had none: itself, which is a case no longer by itself.
const PLAIN: &str = "[[case]]\nname = \"default\"\n";

/// Why what operators did does not become a case, and what to do.
#[derive(Debug, Error)]
enum NoCase {
    #[error(
        "the session no longer keeps its beginning, or it went on from a checkpoint: run it from its beginning, with more `--past-memory`"
    )]
    NoBeginning,
    #[error("the run does not let cases be written: begin it with `--save-cases`")]
    Forbidden,
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    #[error(transparent)]
    Inputs(#[from] Usage),
    #[error(transparent)]
    Read(std::io::Error),
    #[error(transparent)]
    Write(#[from] file::FileError),
}

/// Makes cases of what operators did in a run of `config`, which is kept there.
pub(super) fn keeper(config: &RunConfig, kept: Kept) -> KeepCase {
    let (subject, operated) = (config.subject.clone(), config.reach.operated.clone());
    let may_save = config.doors.saves_cases;
    Arc::new(move |wanted| {
        let inputs = kept.lock().inputs();
        let inputs = inputs.ok_or(NoCase::NoBeginning);
        let made = inputs.and_then(|inputs| keep(wanted, &inputs, &subject, &operated, may_save));
        made.map_err(|why| why.to_string())
    })
}

fn keep(
    wanted: &CaseWanted,
    inputs: &[OperatorInput],
    subject: &Subject,
    operated: &[ClientName],
    may_save: bool,
) -> Result<KeptCase, NoCase> {
    if wanted.save && !may_save {
        return Err(NoCase::Forbidden);
    }
    let mut scenario = Scenario::load(&subject.scenario)?;
    for client in operated {
        scenario.operate(client)?;
    }
    let path = case::beside(&subject.scenario)?;
    let before = written_before(&path)?;
    let text = text(wanted, inputs, subject, operated, &scenario)?;
    let whole = joined(before.as_deref(), &text, &scenario)?;
    // Whoever takes it finds that it can be read and run.
    let catalogue = Catalogue::parse(path.clone(), whole.clone())?;
    let case = catalogue.named(&scenario, &wanted.name)?;
    scenario.with_case(&catalogue, case)?;
    if wanted.save {
        file::write_whole(&path, whole.as_bytes())?;
    }
    let path = path.display().to_string();
    Ok(KeptCase { name: wanted.name.clone(), text, path, saved: wanted.save, may_save })
}

/// The case by itself.
fn text(
    wanted: &CaseWanted,
    inputs: &[OperatorInput],
    subject: &Subject,
    operated: &[ClientName],
    scenario: &Scenario,
) -> Result<String, NoCase> {
    let mut written = match &subject.case {
        Some(name) => {
            let catalogue = scenario.catalogue()?;
            catalogue.written(catalogue.named(scenario, name)?)
        }
        None => Written::default(),
    };
    written.entries.extend(operated::entries(inputs, scenario)?);
    written.until = Some(wanted.until).filter(|until| *until != scenario.until());
    if !operated.is_empty() {
        let words: Vec<String> = operated.iter().map(|client| format!("--operator {client}")).collect();
        written.about = Some(format!("what an operator did; run with {}", words.join(" ")));
    }
    Ok(written.to_toml(&wanted.name, &written.entries))
}

/// The file of cases as it is; nothing if the scenario has none.
fn written_before(path: &Path) -> Result<Option<String>, NoCase> {
    match regular::read_text(path) {
        Ok(text) => Ok(Some(text)),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(None),
        Err(error) => Err(NoCase::Read(error)),
    }
}

/// The file of cases with one more.
fn joined(before: Option<&str>, case: &str, scenario: &Scenario) -> Result<String, NoCase> {
    let before = before.map_or("version = 1", str::trim_end);
    // A scenario that names no case is one itself, and stays one.
    let is_first = scenario.catalogue()?.cases().iter().all(|case| case.entry.is_none());
    let plain = if is_first { format!("{PLAIN}\n") } else { String::new() };
    Ok(format!("{before}\n\n{plain}{case}"))
}
