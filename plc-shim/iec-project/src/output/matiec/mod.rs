//! A project in text to one text that MatIEC compiles: it reads the second edition of the standard, not all of it, and
//! some of it wrongly. What it cannot read is written in another way; what has no other way is refused with its place.
//!
//! | module | in the text | becomes |
//! |---|---|---|
//! | [`comment`] | `//`, nested comments, pragmas, which MatIEC takes for C | one comment each, or nothing |
//! | [`list`] | `a, b, c : R_TRIG;` | one declaration each |
//! | [`value`] | enumerations, their values, `TO_DINT(x)` | INT, numbers, `INT_TO_DINT(x)` |
//! | [`convert`] | conversions of durations, and of bits to BOOL, which MatIEC does otherwise | what they mean |
//! | [`instance`] | arrays of function blocks, loops over them | one instance each, the loop's rounds one by one |
//! | [`repeat`] | FOR, which MatIEC passes over where its first value is its last | WHILE |
//! | [`empty`] | branches without statements | a loop that never runs |
//! | [`evolution`] | transitions in the first call of a chart, several that leave one step | conditions that are FALSE then |
//! | [`start`] | initial values of arrays of structures | assignments in the first scan |
//! | [`reserved`] | variables with names that MatIEC keeps for itself | the same by other names |
//! | [`through`] | global variables that a function uses | parameters of it |
//! | [`function`] | functions called as statements, without inputs or without a value | assignments, with both |
//! | [`external`] | global variables that a unit uses | their `VAR_EXTERNAL` |
//! | [`refuse`] | what there is no way for | nothing: it is refused |
//! | [`assemble`] | types, functions, blocks, programs, global variables | the same in that order, and a CONFIGURATION |
//!
//! Each step reads the text that the step before has written, so that none has to know of another.

mod assemble;
mod comment;
mod convert;
mod empty;
mod evolution;
mod external;
mod function;
mod instance;
mod list;
mod refuse;
mod repeat;
mod reserved;
mod start;
mod through;
mod value;

use std::collections::BTreeMap;

use super::Refused;
use super::scl::names::Names;
use onescan_iec::dialect::Dialect;
use onescan_iec::input::Input;
use onescan_iec::input::kind::SourceKind;
use onescan_iec::source::edits::{Edits, LineMap};
use onescan_iec::syntax::ast::{CompilationUnit, Declaration, Pou, Section};
use onescan_iec::syntax::{FileId, SourceFile, Span};

pub(crate) use assemble::{Cycle, Globals};

/// What the text of a project becomes, and the line that each of its lines comes from.
pub(crate) struct Lowered {
    pub(crate) text: String,
}

/// Something that MatIEC has no form for.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Unsaid {
    /// The line of the text that was given; nothing if no line of it is to blame.
    pub(crate) line: Option<u32>,
    pub(crate) message: String,
    pub(crate) help: &'static str,
}

/// A step's findings: where in the text that it was given.
pub(super) struct Finding {
    span: Span,
    message: String,
    help: &'static str,
}

impl Finding {
    pub(super) fn new(span: Span, what: &str, help: &'static str) -> Self {
        Self { span, message: format!("{what} cannot be had in MatIEC"), help }
    }
}

impl From<Finding> for Refused {
    fn from(finding: Finding) -> Self {
        Self { span: finding.span, message: finding.message }
    }
}

/// A text as a step reads it.
pub(super) struct Page<'a> {
    pub(super) file: &'a SourceFile,
    pub(super) unit: &'a CompilationUnit,
    pub(super) names: &'a Names<'a>,
}

impl<'a> Page<'a> {
    pub(super) fn text(&self, span: Span) -> &'a str {
        self.file.text().get(span.start as usize..span.end as usize).unwrap_or("")
    }

    pub(super) fn pous(&self) -> impl Iterator<Item = &'a Pou> {
        self.unit.declarations.iter().filter_map(|declaration| match declaration {
            Declaration::Pou(pou) => Some(pou),
            _ => None,
        })
    }

    /// Each section of variables, with the unit that declares it.
    pub(super) fn sections(&self) -> Vec<(Option<&'a Pou>, &'a Section)> {
        let mut sections = Vec::new();
        for declaration in &self.unit.declarations {
            match declaration {
                Declaration::Pou(pou) => {
                    sections.extend(pou.sections.iter().map(|section| (Some(pou), section)));
                    let members = pou.object.members.iter().flat_map(|member| &member.pou.sections);
                    sections.extend(members.map(|section| (Some(pou), section)));
                }
                Declaration::Globals(section) => sections.push((None, section)),
                Declaration::Configuration(configuration) => {
                    sections.extend(configuration.all_sections().map(|section| (None, section)));
                }
                _ => {}
            }
        }
        sections
    }
}

/// One step: the changes it makes, and what it cannot say.
type Step = fn(&Page<'_>, &mut Edits) -> Vec<Finding>;

/// Until nothing is left for them to do: each lets one more thing be seen.
const ROUNDS: usize = 16;

/// The text as MatIEC can read it, still without a configuration of its own.
///
/// # Errors
/// What MatIEC has no form for.
pub(crate) fn lowered(text: &str, dialect: Dialect) -> Result<Lowered, Vec<Unsaid>> {
    let mut text = Text { current: text.to_owned(), dialect, origins: None };
    text.step(refuse::find)?;
    text.replace(comment::plain);
    text.step(list::split)?;
    text.step(reserved::rename)?;
    text.step(value::lower)?;
    text.step(convert::lower)?;
    for _ in 0..ROUNDS {
        if !text.step(instance::unroll)? {
            break;
        }
    }
    text.step(instance::name)?;
    for _ in 0..ROUNDS {
        if !text.step(repeat::lower)? {
            break;
        }
    }
    text.step(empty::fill)?;
    text.step(start::lower)?;
    text.step(evolution::lower)?;
    for _ in 0..ROUNDS {
        if !text.step(through::hand)? {
            break;
        }
    }
    text.step(function::lower)?;
    text.step(external::declare)?;
    Ok(Lowered { text: text.current })
}

/// The whole file: what `text` declares in MatIEC's order, with a configuration.
pub(crate) fn assembled(text: &str, dialect: Dialect, addresses: &BTreeMap<String, String>, cycle: &Cycle) -> String {
    let mut whole = String::new();
    let text = Text { current: text.to_owned(), dialect, origins: None };
    text.read(|page| whole = assemble::whole(page, addresses, cycle));
    whole
}

/// The global variables that a text declares, and the addresses that it gives them.
pub(crate) fn globals(text: &str, dialect: Dialect) -> Globals {
    let mut found = Globals::default();
    let text = Text { current: text.to_owned(), dialect, origins: None };
    text.read(|page| found = assemble::globals(page));
    found
}

/// A text between two steps.
struct Text {
    current: String,
    dialect: Dialect,
    /// For each line the line of the text that was given; nothing while it is that text itself.
    origins: Option<LineMap>,
}

impl Text {
    fn read(&self, look: impl FnOnce(&Page<'_>) + Send) {
        let input = Input::from_text("project.st", SourceKind::Text, self.current.as_str()).in_dialect(self.dialect);
        onescan_iec::front::with_room(|| {
            let parsed = onescan_iec::front::Parsed::new([input]);
            let rename = |_: &str| None;
            let names = Names::new(&parsed.sources, &parsed.units, &parsed.library, &rename);
            let own = parsed.units.iter().find(|(id, _)| *id == FileId(0));
            if let (Some(file), Some((_, unit))) = (parsed.sources.get(FileId(0)), own) {
                look(&Page { file, unit, names: &names });
            }
        });
    }

    /// True if the step changed something.
    fn step(&mut self, step: Step) -> Result<bool, Vec<Unsaid>> {
        let mut edits = Edits::default();
        let mut findings = Vec::new();
        self.read(|page| findings = step(page, &mut edits));
        if !findings.is_empty() {
            return Err(findings.into_iter().map(|finding| self.unsaid(finding)).collect());
        }
        if edits.is_empty() {
            return Ok(false);
        }
        let edited = edits.apply(&self.current).map_err(|conflict| {
            let span = Span::new(FileId(0), conflict.at, conflict.at);
            vec![self.unsaid(Finding::new(span, "what stands here", "write it in simpler statements"))]
        })?;
        self.now(edited.text, edited.lines);
        Ok(true)
    }

    fn replace(&mut self, change: fn(&str, Dialect) -> Edits) {
        if let Ok(edited) = change(&self.current, self.dialect).apply(&self.current) {
            self.now(edited.text, edited.lines);
        }
    }

    fn now(&mut self, text: String, lines: LineMap) {
        self.current = text;
        self.origins = Some(match self.origins.take() {
            None => lines,
            Some(before) => {
                LineMap::of(lines.lines().iter().map(|line| line.and_then(|line| before.original(line))).collect())
            }
        });
    }

    fn unsaid(&self, finding: Finding) -> Unsaid {
        let before = self.current.get(..finding.span.start as usize).unwrap_or("");
        let line = before.matches('\n').count() as u32 + 1;
        let line = self.origins.as_ref().map_or(Some(line), |origins| origins.original(line));
        Unsaid { line, message: finding.message, help: finding.help }
    }
}

#[cfg(test)]
mod tests;
