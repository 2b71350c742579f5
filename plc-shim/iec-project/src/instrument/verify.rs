//! What has been written is checked: a project that was right is right with the shim.

use std::path::Path;
use std::sync::Arc;

use super::target::Target;
use super::{InstrumentError, Project};
use onescan_iec::diagnostic::{Diagnostics, Severity};
use onescan_iec::dialect::Dialect;
use onescan_iec::input::Input;
use onescan_iec::input::kind::{FileKind, SourceKind};
use onescan_iec::lint::inspect;

/// The project, unless it has errors and its sources have none. Sources that do not check by themselves, because a
/// library of theirs is not there, are taken as they are.
pub(super) fn verified(inputs: &[Input], project: Project, target: Target) -> Result<Project, InstrumentError> {
    let emitted = inspect(emitted(inputs, &project, target), None);
    let were_right = || !has_errors(&inspect(sources(inputs).cloned(), None));
    if has_errors(&emitted) && were_right() { Err(InstrumentError::Emitted(emitted)) } else { Ok(project) }
}

fn has_errors(findings: &Diagnostics) -> bool {
    findings.iter().any(|found| found.severity == Severity::Error)
}

/// Lists of files declare nothing.
fn sources(inputs: &[Input]) -> impl Iterator<Item = &Input> {
    inputs.iter().filter(|input| kind_of(input.file().name()).is_some())
}

fn kind_of(name: &str) -> Option<SourceKind> {
    match FileKind::of(Path::new(name)) {
        Some(FileKind::Source(kind)) => Some(kind),
        _ => None,
    }
}

/// The files of the project as whoever takes it reads them.
fn emitted(inputs: &[Input], project: &Project, target: Target) -> Vec<Input> {
    let read = |name: &str, text: Arc<str>| {
        let input = Input::from_text(name, kind_of(name)?, text);
        let before = inputs.iter().find(|input| input.file().name() == name);
        let dialect = match (before, target) {
            (Some(before), _) => before.file().dialect(),
            (None, Target::TwinCat) => Dialect::TwinCat,
            (None, Target::Codesys) => Dialect::Codesys,
            (None, Target::Scl) => Dialect::SiemensScl,
            (None, Target::Iec | Target::OpenPlc | Target::Beremiz) => return Some(input),
        };
        Some(input.in_dialect(dialect))
    };
    project.program().filter_map(|file| read(&file.name, file.text.clone()?)).collect()
}
