//! A project in program text for TIA Portal: written in SCL, and the shim attached to that. What comes of it is one
//! file, which is wholly the shim's own; the project's files stay as they are.
//!
//! Initial values that a declaration in SCL cannot have become start values of data blocks: they are what the memory of
//! the project has at a cold start and that of the translation has not.

use std::collections::BTreeMap;

use super::plain::Plain;
use super::scl_exchange;
use super::survey::survey;
use super::target::{Source as Own, Target};
use super::tasks::{Line, TaskTable};
use super::{Exchanged, File, InstrumentError, Options, Project, entries, instrument, marks, motion_use};
use crate::output::scl::{self, Source, StartValues};
use onescan_iec::diagnostic::{Code, Diagnostic, Diagnostics, Severity};
use onescan_iec::dialect::Dialect;
use onescan_iec::front::Front;
use onescan_iec::input::Input;
use onescan_iec::input::kind::SourceKind;
use onescan_iec::syntax::{FileId, Span};
use onescan_iec::task_plan::Task;
use onescan_iec_run::application::Application;

/// The file that TIA Portal imports.
const NAME: &str = "sdsp.scl";

/// The project in SCL with the shim attached.
pub(super) fn ported(plain: &Plain, options: &Options) -> Result<Project, InstrumentError> {
    let inputs: Vec<Input> = plain.texts().collect();
    let wrong = |findings| InstrumentError::Text(plain.diagnostics(findings));
    if plain.findings.iter().any(|found| found.severity == Severity::Error) {
        return Err(wrong(plain.findings.clone()));
    }
    let (original, front) = onescan_iec::front::with_room(|| {
        (Application::from_inputs(inputs.iter().cloned()), Front::new(inputs.iter().cloned()))
    });
    let original = original.map_err(InstrumentError::Text)?;
    let source = Source { sources: &front.sources, units: &front.units, library: &front.library };
    let (tasks, warnings) = asked(plain, options, source)?;
    let homes = scl::homes(source);
    let mut values = StartValues::new();
    let mut last = None;
    // The second time with the start values that the first has not.
    for _ in 0..2 {
        let text = scl::project(source, &tasks, &values).map_err(wrong)?;
        let text = attached(&text, &tasks, &homes, options).map_err(|wrong| match wrong {
            InstrumentError::Text(found) => refused(plain, &found),
            other => other,
        })?;
        let translated = Application::from_inputs([in_scl(NAME, &text)]).map_err(|found| refused(plain, &found))?;
        let missing = start_values(&homes, &original, &translated);
        last = Some(text);
        if missing.is_empty() {
            break;
        }
        values = if values.is_empty() { missing } else { return Err(no_start_values(plain, &missing)) };
    }
    let mut files = plain.unchanged();
    plain.add_own(Own { name: NAME.to_owned(), text: last.unwrap_or_default() }, &mut files);
    let whole = files.last().map(|file| file.name.clone());
    plain.delete_stale(&mut files);
    let warnings = plain.diagnostics(warnings);
    Ok(Project { whole, tasks: Some(called(&tasks)), homes, ..Project::of(files, warnings) })
}

fn in_scl(name: &str, text: &str) -> Input {
    Input::from_text(name, SourceKind::Text, text).in_dialect(Dialect::SiemensScl)
}

/// The tasks and their programs as the project names them, and what of the project is reported.
fn asked(
    plain: &Plain,
    options: &Options,
    source: Source<'_>,
) -> Result<(Vec<Task>, Vec<Diagnostic>), InstrumentError> {
    let own = source.units.iter().filter(|(id, _)| !source.library.contains(id));
    let trees: Vec<_> = own.map(|(id, unit)| (*id, unit)).collect();
    let mut survey = survey(&trees, Target::Scl);
    let mut findings = plain.findings.clone();
    findings.append(&mut survey.findings);
    findings.extend(scl_exchange::refused(&options.exchanged));
    let motion = motion_use::motion(Target::Scl, &trees, &survey.motion).findings;
    // There is nothing in TIA Portal that it could be left to.
    findings.extend(motion.into_iter().map(|found| Diagnostic { severity: Severity::Error, ..found }));
    if findings.iter().any(|found| found.severity == Severity::Error) {
        return Err(InstrumentError::Text(plain.diagnostics(findings)));
    }
    let in_text = Options { target: Target::Iec, ..options.clone() };
    plain.refuse_singles(&survey)?;
    let mut tasks = plain.tasks(&survey, &in_text)?;
    let table = TaskTable::new(&tasks, &entries(&survey), Line::InPlace)?;
    for name in tasks.iter_mut().flat_map(|task| &mut task.programs) {
        let entry = table.programs.iter().find(|entry| entry.name.eq_ignore_ascii_case(name));
        *name = entry.map_or_else(|| name.clone(), |entry| entry.name.clone());
    }
    Ok((tasks, findings))
}

/// The tasks with the organization blocks that call their programs.
fn called(tasks: &[Task]) -> Vec<Task> {
    tasks.iter().map(|task| Task { programs: vec![scl::block_of_task(&task.name)], ..task.clone() }).collect()
}

/// The translation with the shim, in one text.
fn attached(text: &str, tasks: &[Task], homes: &Homes, options: &Options) -> Result<String, InstrumentError> {
    let moved = |each: &Exchanged| Exchanged { variable: path(homes, &each.variable), ..each.clone() };
    let exchanged = options.exchanged.iter().map(moved).collect();
    let options = Options { target: Target::Scl, tasks: Some(called(tasks)), exchanged, ..options.clone() };
    let project = instrument(&[in_scl("project.scl", text)], &options)?;
    let (own, others): (Vec<&File>, Vec<&File>) = project.files.iter().partition(|file| file.before.is_none());
    let texts = |files: Vec<&File>| -> Vec<String> {
        files.into_iter().filter_map(|file| file.text.as_deref().map(marks::plain_text)).collect()
    };
    let (own, others) = in_order(texts(own).join("\n"), texts(others).join("\n"));
    Ok(format!("{}\n{}\n{others}", marks::WHOLE, own.trim_start()))
}

/// What copies between blocks stands behind the blocks of the project and before those that are called by nobody: a
/// block is read when those that it uses are known.
fn in_order(mut own: String, others: String) -> (String, String) {
    let mut cut = |from: &str, to: &str| -> Option<String> {
        let start = own.find(from)?;
        let end = start + own.get(start..)?.find(to)? + to.len();
        Some(own.drain(start..end).collect())
    };
    let functions = [scl_exchange::TAKE, scl_exchange::GIVE];
    let copies: Vec<String> = functions.iter().filter_map(|from| cut(from, "END_FUNCTION\n")).collect();
    if copies.is_empty() {
        return (own, others);
    }
    let scheduler = cut("ORGANIZATION_BLOCK \"SDSP_Scheduler\"", "END_ORGANIZATION_BLOCK\n").unwrap_or_default();
    let called = others.find("// Task ").unwrap_or(others.len());
    let (blocks, organization) = others.split_at(called);
    (own, format!("{blocks}\n{}\n{scheduler}\n{organization}", copies.join("\n")))
}

/// The translation is not right: its own words do not help, but say what SCL has not.
fn refused(plain: &Plain, found: &Diagnostics) -> InstrumentError {
    let errors = found.iter().filter(|found| found.severity == Severity::Error);
    let findings = errors.map(|found| {
        let message = format!("what this becomes in SCL is wrong: {}", found.message);
        let help = "write it in another way; the translation is not stored";
        Diagnostic::error(Code::UnsupportedFeature, Span::new(FileId(0), 0, 0), message).with_help(help)
    });
    InstrumentError::Text(plain.diagnostics(findings.collect()))
}

/// The data blocks that global variables are members of, by the variables' names in capitals.
pub(super) type Homes = BTreeMap<String, &'static str>;

/// The path that a variable of the project has in the translation.
pub(super) fn path(homes: &Homes, path: &str) -> String {
    let end = path.find(['.', '[']).unwrap_or(path.len());
    let root = path.get(..end).unwrap_or("").to_ascii_uppercase();
    homes.get(&root).map_or_else(|| path.to_owned(), |home| format!("{home}.{path}"))
}

/// Values that a data block of TIA Portal cannot begin with.
fn no_start_values(plain: &Plain, missing: &StartValues) -> InstrumentError {
    let all = missing.iter().flat_map(|(block, values)| values.iter().map(move |(path, value)| (block, path, value)));
    let findings = all.map(|(block, path, value)| {
        let message = format!("`{block}.{path}` cannot begin with {value} in SCL of TIA Portal");
        let found = Diagnostic::error(Code::UnsupportedFeature, Span::new(FileId(0), 0, 0), message);
        found.with_help("a TIME counts milliseconds there; assign other values in the first scan")
    });
    InstrumentError::Text(plain.diagnostics(findings.collect()))
}

/// What the project begins with and the translation does not.
fn start_values(homes: &Homes, original: &Application, translated: &Application) -> StartValues {
    let mut values: StartValues = BTreeMap::new();
    let mut memory = translated.initial_memory().to_vec();
    for leaf in original.leaves() {
        let path = path(homes, &leaf.path);
        // What SCL has as a constant has no place.
        let Ok(place) = translated.variable(&path) else { continue };
        let wanted = leaf.bytes(original.initial_memory());
        if place.bytes(&memory) == wanted || place.size != leaf.size {
            continue;
        }
        place.store(&wanted, &mut memory);
        let end = path.find(['.', '[']).unwrap_or(path.len());
        let (block, rest) = path.split_at(end);
        let value = translated.value_text(&place, &memory);
        values.entry(block.to_owned()).or_default().push((scl::members(rest.trim_start_matches('.')), value));
    }
    values
}
