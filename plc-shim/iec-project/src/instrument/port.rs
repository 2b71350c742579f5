//! A project in program text for a tool that takes another form: with the shim attached it becomes one file, which is
//! wholly the shim's own. The project's files stay as they are.
//!
//! The shim is attached to the text, as for a tool that takes text; what comes of it is written in the other form.

use super::plain::Plain;
use super::target::Target;
use super::{InstrumentError, Options, Project, attach, codesys, matiec, scl_port};
use onescan_iec::dialect::Dialect;
use onescan_iec::input::Input;

/// The project's text as the tool reads it that takes its port: what is not of its dialect is reported.
pub(super) fn read_by(target: Target, inputs: &[Input]) -> Vec<Input> {
    let read = |input: &Input| {
        let is_text = input.file().origin().is_none() && input.file().dialect() != Dialect::SiemensScl;
        match target {
            Target::Codesys if is_text => input.clone().in_dialect(Dialect::Codesys),
            _ => input.clone(),
        }
    };
    inputs.iter().map(read).collect()
}

/// The project in the form of a target that does not take its text; nothing for any other.
pub(super) fn ported(plain: &Plain, options: &Options) -> Option<Result<Project, InstrumentError>> {
    if !plain.is_text() {
        return None;
    }
    let port = match options.target {
        Target::Codesys => codesys::port,
        // SCL is another language: the shim is attached to what is written in it.
        Target::Scl => return Some(scl_port::ported(plain, options)),
        Target::OpenPlc | Target::Beremiz => return Some(matiec::ported(plain, options)),
        Target::Iec | Target::TwinCat => return None,
    };
    let whole = || {
        let attached = attach(plain, options)?;
        let source = port(plain, &attached)?;
        let mut files = plain.unchanged()?;
        plain.add_own(source, &mut files);
        let whole = files.last().map(|file| file.name.clone());
        plain.delete_stale(&mut files);
        Ok(Project { whole, ..Project::of(files, attached.project.warnings) })
    };
    Some(whole())
}
