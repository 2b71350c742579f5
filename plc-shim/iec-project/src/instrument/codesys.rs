//! A project in program text for CODESYS: one PLCopen XML file that holds all of it (`Project > Import PLCopenXML`).

use super::plain::Plain;
use super::target::Source;
use super::tasks::shortest;
use super::{Attached, File, InstrumentError, marks};
use crate::output::plcopen::configuration::Cycle;
use crate::output::{Refused, plcopen};
use onescan_iec::diagnostic::{Code, Diagnostic, Diagnostics};
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
        InstrumentError::Text(Diagnostics::new(found.into_iter().map(reported).collect(), &plain.sources))
    };
    // What has no form is found in the project as it is, where it has a place that its author knows.
    let before: Vec<_> = plain.sources.iter().map(|(id, file)| (file, parse_source(id, file).unit)).collect();
    written(&before, &[]).map_err(refused)?;
    let behind: Vec<_> = attached.project.files.iter().filter_map(|file| with_shim(file, plain)).collect();
    let behind: Vec<_> = behind.iter().map(|file| (file, parse_source(FileId(0), file).unit)).collect();
    let cycles = attached.tasks.as_deref().map(cycles).unwrap_or_default();
    let own = |found: Vec<Refused>| {
        let beginning = |each: Refused| Refused { span: Span::new(FileId(0), 0, 0), ..each };
        refused(found.into_iter().map(beginning).collect())
    };
    let text = written(&behind, &cycles).map_err(own)?;
    let text = text.replacen("?>\n", &format!("?>\n{}\n", marks::XML_WHOLE), 1);
    Ok(Source { name: "sdsp.xml".to_owned(), text })
}

fn written(files: &[(&SourceFile, CompilationUnit)], cycles: &[Cycle]) -> Result<String, Vec<Refused>> {
    let files: Vec<_> = files.iter().map(|(file, unit)| (*file, unit)).collect();
    plcopen::project(&files, "sdsp", cycles)
}

/// A file of the project in text with the shim, whose marks are of no use in a file that is the shim's own.
fn with_shim(file: &File, plain: &Plain) -> Option<SourceFile> {
    let given = plain.sources.iter().find(|(_, given)| given.name() == file.name);
    let dialect = given.map_or_else(Default::default, |(_, given)| given.dialect());
    Some(SourceFile::new(file.name.as_str(), marks::unmarked(file.text.as_deref()?)).in_dialect(dialect))
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
