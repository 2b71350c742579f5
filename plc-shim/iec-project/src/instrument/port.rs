//! A project in program text, also with PLCopen XML beside it, for a tool that takes another form: with the shim attached
//! it becomes one file, which is wholly the shim's own. The project's files stay as they are.
//!
//! The shim is attached to the files, as for a tool that takes them; what comes of it is written in the other form.

use super::plain::Plain;
use super::target::Target;
use super::{InstrumentError, Options, Project, attach, codesys, matiec, scl_port};
use crate::output::Refused;
use crate::output::width::{self, Fronts, Way};
use onescan_iec::diagnostic::{Code, Diagnostic};
use onescan_iec::dialect::{Dialect, IntegerWidth, WordSize};
use onescan_iec::front::{Front, with_room};
use onescan_iec::input::Input;
use onescan_iec::syntax::lexer::tokenize_in;
use onescan_iec::syntax::token::TokenKind;
use onescan_iec::syntax::{FileId, SourceFile, Span};

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

/// Takes the program text out of PLCopen XML for a target that has nothing to draw in: networks become statements.
///
/// # Errors
/// A network hands on what has no name.
pub(super) fn in_text(plain: &mut Plain, target: Target) -> Result<(), InstrumentError> {
    let takes_text = matches!(target, Target::Scl | Target::OpenPlc | Target::Beremiz);
    if !takes_text || !plain.is_portable() || !plain.has_xml() {
        return Ok(());
    }
    let wires: Vec<Diagnostic> = plain.sources.iter().filter_map(|(id, file)| unnamed(id, file)).collect();
    if !wires.is_empty() {
        return Err(InstrumentError::Text(plain.diagnostics(wires)));
    }
    plain.take_text();
    Ok(())
}

/// The first place at which an element of a network hands on what no variable takes: text would need a variable there.
fn unnamed(id: FileId, file: &SourceFile) -> Option<Diagnostic> {
    let tokens = tokenize_in(file.dialect(), file.text());
    let wire = tokens.iter().find(|token| token.kind == TokenKind::Wire)?;
    let message = "this target takes text, where what this box hands on would need a variable";
    let found = Diagnostic::error(Code::UnsupportedFeature, Span::new(id, wire.start, wire.end), message);
    Some(found.with_help("connect the box's output to a variable, or choose the target iec, codesys or twincat"))
}

/// Writes the conversions that a port needs whose target computes integers in other bits than the dialect of a file.
/// `inputs` are the files as their author has them.
pub(super) fn with_conversions(plain: &mut Plain, inputs: &[Input], target: Target) -> Result<(), InstrumentError> {
    let (way, from) = match target {
        Target::Codesys => (Way::ToRegisters, IntegerWidth::Own),
        Target::Scl | Target::OpenPlc | Target::Beremiz => (Way::ToOperands, IntegerWidth::Register),
        // Files are the author's, and stay in the tool that they are of.
        Target::Iec | Target::TwinCat => return Ok(()),
    };
    let own = |name: &str| inputs.iter().find(|input| input.file().name() == name).map(|input| input.file().dialect());
    let names: Vec<_> = plain.sources.iter().map(|(_, file)| file.name().to_owned()).collect();
    let is_concerned = |id: FileId| {
        let dialect = names.get(id.0 as usize).and_then(|name| own(name));
        dialect.is_some_and(|dialect| dialect.integers() == from)
    };
    if !plain.is_portable() || plain.is_one_xml() || !(0..names.len() as u32).any(|id| is_concerned(FileId(id))) {
        return Ok(());
    }
    let as_read = |input: Input| match way {
        // What is cut for wide registers is right in narrow ones.
        Way::ToRegisters => input.for_words(WordSize::Bits64),
        Way::ToOperands => input,
    };
    let reader = match target {
        Target::Scl => Dialect::SiemensScl,
        Target::OpenPlc | Target::Beremiz => Dialect::Matiec,
        Target::Codesys | Target::Iec | Target::TwinCat => Dialect::Codesys,
    };
    let texts: Vec<Input> = plain.texts().map(as_read).collect();
    let owns = texts.iter().cloned().map(|text| {
        let dialect = own(text.file().name());
        text.read_as(dialect, None)
    });
    let owns: Vec<Input> = owns.collect();
    let found = with_room(|| {
        let theirs = texts.into_iter().map(|text| text.in_dialect(reader));
        let fronts = Fronts { own: Front::new(owns), theirs: Front::new(theirs) };
        // What is wrong with it is reported where it is translated.
        (!fronts.of_registers(way).has_errors()).then(|| width::explicit(&fronts, way, &is_concerned))
    });
    let Some(found) = found else { return Ok(()) };
    let found = found.map_err(|refused| refused_widths(plain, refused))?;
    let drawn = found.iter().filter(|(id, _)| plain.is_xml(**id));
    let drawn = drawn.filter_map(|(id, edits)| Some(Span::new(*id, edits.first()?, edits.first()?)));
    let drawn: Vec<Refused> =
        drawn.map(|span| Refused { span, message: "what is computed here in PLCopen XML".to_owned() }).collect();
    if !drawn.is_empty() {
        return Err(refused_widths(plain, drawn));
    }
    plain.change(found)
}

fn refused_widths(plain: &Plain, refused: Vec<Refused>) -> InstrumentError {
    let reported = |each: Refused| {
        let message = format!("{} cannot be written for a target that computes in other bits", each.message);
        let help = "convert the operands yourself, and all targets agree";
        Diagnostic::error(Code::UnsupportedFeature, each.span, message).with_help(help)
    };
    InstrumentError::Text(plain.diagnostics(refused.into_iter().map(reported).collect()))
}

/// The project in the form of a target that does not take its text; nothing for any other.
pub(super) fn ported(plain: &Plain, options: &Options) -> Option<Result<Project, InstrumentError>> {
    // What is in PLCopen XML as a whole stays the file that it is.
    if !plain.is_portable() || plain.is_one_xml() {
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
        let mut files = plain.unchanged();
        plain.add_own(source, &mut files);
        let whole = files.last().map(|file| file.name.clone());
        plain.delete_stale(&mut files);
        Ok(Project { whole, ..Project::of(files, attached.project.warnings) })
    };
    Some(whole())
}
