//! A project in program text, also with PLCopen XML beside it, for CODESYS: one file of PLCopen XML that holds all of it
//! (`Project > Import PLCopenXML`).

use super::plain::Plain;
use super::target::Source;
use super::tasks::shortest;
use super::{Attached, File, InstrumentError, marks};
use crate::output::plcopen::Form;
use crate::output::plcopen::configuration::Cycle;
use crate::output::{Refused, plcopen};
use onescan_iec::diagnostic::{Code, Diagnostic};
use onescan_iec::input::Input;
use onescan_iec::input::kind::SourceKind;
use onescan_iec::syntax::ast::CompilationUnit;
use onescan_iec::syntax::parser::parse_source;
use onescan_iec::syntax::{FileId, SourceFile, Span};
use onescan_iec::task_plan::Task;

/// The whole project with its shim, from its text with the shim attached.
pub(super) fn port(plain: &Plain, attached: &Attached) -> Result<Source, InstrumentError> {
    let refused = |found: Vec<Refused>| {
        let reported = |each: Refused| {
            let help = "write it in another way, or choose another target";
            Diagnostic::error(Code::UnsupportedFeature, each.span, each.message).with_help(help)
        };
        InstrumentError::Text(plain.diagnostics(found.into_iter().map(reported).collect()))
    };
    // What has no form is found in the project as it is, where it has a place that its author knows.
    let parts: Vec<_> = plain.sources.iter().map(|(id, file)| Part::of(id, file)).collect();
    written(&parts, &[]).map_err(refused)?;
    let behind: Vec<_> = attached.project.files.iter().filter_map(|file| with_shim(file, plain)).collect();
    let behind: Vec<_> = behind.iter().map(|file| Part::of(FileId(0), file)).collect();
    let cycles = attached.tasks.as_deref().map(cycles).unwrap_or_default();
    let own = |found: Vec<Refused>| {
        let beginning = |each: Refused| Refused { span: Span::new(FileId(0), 0, 0), ..each };
        refused(found.into_iter().map(beginning).collect())
    };
    let text = written(&behind, &cycles).map_err(own)?;
    let text = text.replacen("?>\n", &format!("?>\n{}\n", marks::XML_WHOLE), 1);
    Ok(Source { name: "sdsp.xml".to_owned(), text })
}

/// A file, and what is declared in it.
struct Part<'f> {
    id: FileId,
    file: &'f SourceFile,
    unit: CompilationUnit,
}

impl<'f> Part<'f> {
    fn of(id: FileId, file: &'f SourceFile) -> Self {
        Self { id, file, unit: parse_source(id, file).unit }
    }
}

fn written(parts: &[Part<'_>], cycles: &[Cycle]) -> Result<String, Vec<Refused>> {
    // Only PLCopen XML has an origin among the forms that are ported.
    let form = |part: &Part<'_>| if part.file.origin().is_some() { Form::Xml } else { Form::Text };
    let files: Vec<_> = parts.iter().map(|part| (form(part), part.id, part.file, &part.unit)).collect();
    plcopen::project(&files, "sdsp", cycles)
}

/// A file of the project with the shim, whose marks are of no use in a file that is the shim's own.
fn with_shim(file: &File, plain: &Plain) -> Option<SourceFile> {
    let given = plain.sources.iter().find(|(_, given)| given.name() == file.name);
    let text = marks::unmarked(file.text.as_deref()?);
    Some(match given {
        Some((id, given)) if plain.is_xml(id) => {
            Input::from_text(&file.name, SourceKind::PlcOpen, text).read_like(given).file().clone()
        }
        Some((_, given)) => SourceFile::new(file.name.as_str(), text).in_dialect(given.dialect()),
        None => SourceFile::new(file.name.as_str(), text),
    })
}

/// The tasks of the application: the scheduler's comes first, the others keep their order behind it.
fn cycles(tasks: &[Task]) -> Vec<Cycle> {
    let shortest = shortest(tasks);
    let own = Cycle {
        name: "SDSP_Cycle".to_owned(),
        interval: shortest,
        priority: 0,
        programs: vec!["SDSP_Scheduler".to_owned()],
    };
    let cycle = |task: &Task| Cycle {
        name: task.name.clone(),
        // It is the scheduler that sees the edge of a task with SINGLE: the PLC is to come by whenever it may run.
        interval: task.interval.filter(|_| task.single.is_none()).unwrap_or(shortest),
        priority: task.priority.saturating_add(1),
        programs: task.programs.clone(),
    };
    std::iter::once(own).chain(tasks.iter().map(cycle)).collect()
}
