//! PLC projects made to run in lockstep, and back.
//!
//! | module | subject |
//! |---|---|
//! | [`blocks`] | the mapping that goes with data blocks |
//! | [`project`] | which files are meant, and where the result goes |
//! | [`gateway`] | the gateway's mapping that goes with it |
//! | [`report`] | what was changed, for people and machines |
//! | [`symbols`] | the mapping that goes with symbols |

pub mod blocks;
mod error;
pub mod gateway;
mod mapping_file;
pub mod project;
pub mod report;
mod symbols;

use std::io::Write;
use std::path::{Path, PathBuf};

use onescan_iec::input::kind::FileKind;
use onescan_iec::{Diagnostics, Input, Task, TaskPlan, TimeSpan};
use onescan_iec_project::instrument::{self, Inputs, InstrumentError as Refusal, Options, Target};
use onescan_report::file::write_all_whole;
use onescan_scenario::Scenario;
use onescan_scenario::gateway::Agreement;
use onescan_scenario::load;
use onescan_server::signal::ClientName;

pub use error::InstrumentError;

use onescan_regress::check::Warnings;
use onescan_regress::check::collect::Program;
use onescan_runner::error::ExitCode;
use onescan_runner::error::Usage;
use onescan_runner::format::Format;

/// What is asked for.
#[derive(Clone, Debug)]
pub struct InstrumentConfig {
    /// A folder, a file or a scenario.
    pub project: PathBuf,
    /// The PLC of a scenario with several.
    pub client: Option<ClientName>,
    /// Whether the shim is put on or taken off.
    pub direction: Direction,
    /// For whom the shim's own sources are written.
    pub target: Target,
    /// The tasks, if they are not those of a scenario.
    pub tasks: Vec<Task>,
    /// What becomes of inputs that the PLC's I/O image writes.
    pub inputs: Inputs,
    /// The interval of the task that is written for the PLC, if it is not the shortest of the tasks.
    pub cycle: Option<TimeSpan>,
    /// Where the words of the handshake begin.
    pub words_at: Option<String>,
    /// Where the result goes.
    pub destination: Destination,
    /// Whether the changes are shown.
    pub diff: Diff,
    /// For whom the report is.
    pub format: Format,
    /// Whether what cannot be replaced makes it fail.
    pub warnings: Warnings,
}

/// Whether the shim is put on or taken off.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    Attach,
    Remove,
}

/// Where the result goes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Destination {
    /// Nowhere: it is only shown.
    Nowhere,
    /// Into the project's own files.
    InPlace,
    /// Into this folder, under the project's names.
    Folder(PathBuf),
}

/// Whether the changes are shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Diff {
    /// As a unified diff.
    Shown,
    Hidden,
}

/// Instruments a project, or takes the shim off; writes what was done to `out` and findings to `err`.
///
/// # Errors
/// A file cannot be read or written, or the tasks are wrong. What is wrong with the sources is not an error
/// here but an exit code.
pub fn instrument(
    config: &InstrumentConfig,
    out: &mut dyn Write,
    err: &mut dyn Write,
) -> Result<ExitCode, InstrumentError> {
    let program = project::program(&config.project, config.client.as_ref())?;
    let mut mapping = None;
    let project = match config.direction {
        Direction::Remove => instrument::remove(&program.inputs),
        Direction::Attach => {
            let agreed = agreed(config, &program)?;
            mapping = agreed.as_ref().filter(|_| config.target == Target::Scl).and_then(blocks::mapping);
            let exchanged = agreed.as_ref().map(Agreement::exchanged).unwrap_or_default();
            let layout = agreed.as_ref().and_then(|agreed| agreed.layout);
            let tasks = tasks(config, program.plan);
            let (cycle, words_at, inputs) = (config.cycle, config.words_at.clone(), config.inputs);
            let options = Options { target: config.target, tasks, exchanged, layout, words_at, cycle, inputs };
            let project = instrument::instrument(&program.inputs, &options);
            match project {
                Ok(project) if !project.located.is_empty() => {
                    // What lies where is known now, and so is the number of the mapping.
                    let found =
                        gateway::mapping(scenario(config)?.as_ref().zip(program.client.as_ref()), &project.located)?;
                    mapping = Some(found.text);
                    instrument::instrument(&program.inputs, &Options { layout: found.layout, ..options })
                }
                Ok(project) => {
                    let symbols = agreed.and_then(|agreed| symbols::mapping(config.target, &agreed, &project));
                    mapping = mapping.or(symbols);
                    Ok(project)
                }
                refused => refused,
            }
        }
    };
    let project = match project {
        Ok(project) => project,
        Err(Refusal::Text(findings)) => {
            report::findings(&findings, program.inputs.len(), config.format, out)?;
            return Ok(ExitCode::WrongInput);
        }
        Err(Refusal::Emitted(findings)) => {
            report::findings(&findings, program.inputs.len(), config.format, out)?;
            let help = "nothing was written; report it, with these lines".to_owned();
            return Err(Usage::new("the instrumented project would not check", Some(help)).into());
        }
        Err(error) => return Err(Usage::new(error.to_string(), None).into()),
    };
    if !project.warnings.is_empty() && config.warnings == Warnings::Denied {
        report::findings(&project.warnings, program.inputs.len(), config.format, out)?;
        return Ok(ExitCode::Unmet);
    }
    let mut writes = project::writes(config, &project)?;
    let mapped = mapping.and_then(|text| Some((mapping_file::place(config, &project)?, text)));
    match &mapped {
        Some((path, text)) => writes.push(mapping_file::written(path, text)?),
        None => writes.extend(mapping_file::deleted(config, &project)?),
    }
    write_all_whole(&writes)?;
    let client = program.client.as_ref().map_or("plc", ClientName::as_str);
    let mapped = mapped.as_ref().map(|(path, _)| report::Mapped { path, client });
    report::write(config, &project, mapped, out)?;
    print_warnings(&project.warnings, program.inputs.len(), config, err)?;
    Ok(ExitCode::Ok)
}

/// What the scenario's gateway and the program must agree on; nothing if there is no scenario, or if its program is
/// wrong, which is reported for the program itself.
fn agreed(config: &InstrumentConfig, program: &Program) -> Result<Option<Agreement>, InstrumentError> {
    let inputs = program.inputs.as_slice();
    let (Some(scenario), Some(client)) = (scenario(config)?, &program.client) else { return Ok(None) };
    let Ok(plain) = instrument::remove(inputs) else { return Ok(None) };
    let own_of = |name: &str| inputs.iter().find(|input| input.file().name() == name).map(Input::file);
    let own = plain.files.iter().filter_map(|file| {
        let Some(FileKind::Source(kind)) = FileKind::of(Path::new(&file.name)) else { return None };
        let input = Input::from_text(&file.name, kind, file.text.clone()?);
        Some(match own_of(&file.name) {
            Some(own) => input.read_like(own),
            None => input,
        })
    });
    Ok(match config.target {
        Target::Scl => scenario.agreement_of(client, own.collect(), blocks::settings)?,
        target => scenario.agreement_of(client, own.collect(), |declared| symbols::settings(target, declared))?,
    })
}

/// The scenario, if that is what is instrumented.
fn scenario(config: &InstrumentConfig) -> Result<Option<Scenario>, InstrumentError> {
    let path = &config.project;
    Ok(if load::is_scenario(path) { Some(Scenario::load(path)?) } else { None })
}

fn tasks(config: &InstrumentConfig, plan: Option<TaskPlan>) -> Option<Vec<Task>> {
    if config.tasks.is_empty() { plan.map(|plan| plan.tasks) } else { Some(config.tasks.clone()) }
}

/// Findings for people go where they do not mix with the result; for machines they are in it.
fn print_warnings(
    warnings: &Diagnostics,
    files: usize,
    config: &InstrumentConfig,
    err: &mut dyn Write,
) -> Result<(), InstrumentError> {
    if warnings.is_empty() || config.format == Format::Json {
        return Ok(());
    }
    report::findings(warnings, files, Format::Human, err)
}
