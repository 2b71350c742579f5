//! Files to trees and the checked program, with all that is wrong with them.
//!
//! | module | subject |
//! |---|---|
//! | `constant` | constants set from outside, as initial values |
//! | `library` | the standard's and vendors' blocks that a program needs |
//! | `motion_library` | motion control as program text, and whose of it a program has |
//! | `twincat_motion` | TwinCAT's names for motion blocks |
//! | `vendor_library` | libraries of vendors, by their names |
//! | `unused` | what no task uses and nobody compiles |
//! | `room` | the stack that deep trees need |

mod constant;
pub mod library;
mod motion_library;
mod room;
mod twincat_motion;
mod unused;
mod vendor_library;

use std::collections::BTreeSet;

use crate::check::{Checked, check};
use crate::diagnostic::{Diagnostic, Severity};
use crate::dialect::Feature;
use crate::input::Input;
use crate::ir::MemoryLimit;
use crate::syntax::ast::{CompilationUnit, Configuration, Declaration};
use crate::syntax::{FileId, SourceFile, SourceMap, parse_source};

use constant::is_declared;
pub use constant::{ConstantError, Constants, Setting};
pub use room::with_room;
use unused::Unused;

/// What is known of files once they have been checked.
pub struct Front {
    pub sources: SourceMap,
    /// The trees of the user's files and of the standard function blocks.
    pub units: Vec<(FileId, CompilationUnit)>,
    /// The files of the standard function blocks.
    pub library: BTreeSet<FileId>,
    pub checked: Checked,
    pub findings: Vec<Diagnostic>,
}

impl Front {
    /// Reads and checks files with the usual memory for variables.
    pub fn new(inputs: impl IntoIterator<Item = Input>) -> Self {
        Self::within(MemoryLimit::default(), inputs)
    }

    /// The same, with so much memory for variables.
    pub fn within(limit: MemoryLimit, inputs: impl IntoIterator<Item = Input>) -> Self {
        Parsed::new(inputs).checked(&Constants::default(), limit)
    }

    /// Beside it the constants, which have other initial values: path and literal each.
    ///
    /// # Errors
    /// See [`ConstantError`].
    pub fn with_constants(
        limit: MemoryLimit,
        inputs: impl IntoIterator<Item = Input>,
        constants: &[(String, String)],
    ) -> Result<(Self, Constants), ConstantError> {
        let mut parsed = Parsed::new(inputs);
        let constants = Constants::new(constants, &parsed.units, &mut parsed.sources)?;
        Ok((parsed.checked(&constants, limit), constants))
    }

    /// True if a path is that of a constant, whether or not the files are right.
    pub fn has_constant(inputs: impl IntoIterator<Item = Input>, path: &str) -> bool {
        is_declared(&Parsed::new(inputs).units, path)
    }

    /// True if a finding is an error, so that there is no program to compile.
    pub fn has_errors(&self) -> bool {
        self.findings.iter().any(|found| found.severity == Severity::Error)
    }
}

/// Files as trees, with what is wrong with their text.
pub struct Parsed {
    pub sources: SourceMap,
    pub units: Vec<(FileId, CompilationUnit)>,
    pub library: BTreeSet<FileId>,
    /// The files whose declarations are used whatever the tasks run.
    used: BTreeSet<FileId>,
    findings: Vec<Diagnostic>,
}

impl Parsed {
    /// Parses files; each keeps its tree, also where its text is wrong.
    pub fn new(inputs: impl IntoIterator<Item = Input>) -> Self {
        let mut sources = SourceMap::default();
        let mut findings = Vec::new();
        let (mut library, mut used) = (BTreeSet::new(), BTreeSet::new());
        for input in inputs {
            let is_used = input.is_used();
            let (file, found) = input.add_to(&mut sources);
            findings.extend(found);
            if is_used {
                used.insert(file);
            }
        }
        let needed = library::for_program(sources.iter().map(|(_, file)| file));
        for file in needed {
            library.insert(sources.add(file));
        }
        let mut units = Vec::new();
        for (id, file) in sources.iter() {
            let parsed = parse_source(id, file);
            findings.extend(parsed.diagnostics);
            units.push((id, parsed.unit));
        }
        join_configurations(&mut units, &sources);
        Self { sources, units, library, used, findings }
    }

    /// Checks what there is; what no task uses is left out if it has errors, and then the rest is checked once more.
    fn checked(self, constants: &Constants, limit: MemoryLimit) -> Front {
        let Self { sources, mut units, library, used, findings: mut of_text } = self;
        let mut unused: Option<Unused> = None;
        loop {
            let trees: Vec<_> = units.iter().chain(&constants.units).map(|(id, unit)| (*id, unit)).collect();
            let (checked, found) = check(&trees, &library, &constants.overrides, limit);
            let mut findings = of_text.clone();
            findings.extend(constants.findings.iter().cloned().chain(found));
            if findings.iter().any(|found| found.severity == Severity::Error) {
                let unused = unused.get_or_insert_with(|| Unused::of(&units, &library, &used, &sources));
                if unused.leave_out(&mut units, &mut of_text, &findings) {
                    continue;
                }
            }
            findings.extend(unused.into_iter().flat_map(Unused::into_warnings));
            return Front { sources, units, library, checked, findings };
        }
    }
}

/// True for another part of a configuration of which there are these.
fn is_part(next: &Configuration, parts: &[Configuration], takes_globals: bool) -> bool {
    let Some(first) = parts.first() else { return true };
    let is_elsewhere = parts.iter().all(|part| part.name.span.file != next.name.span.file);
    let is_globals = next.has_only_globals() || parts.iter().all(Configuration::has_only_globals);
    is_elsewhere && next.name.key() == first.name.key() || takes_globals && is_globals
}

/// Makes one of the parts of a configuration that stand in several files: TwinCAT has a file a task, SIMATIC AX files of
/// global variables with names of their own.
fn join_configurations(units: &mut [(FileId, CompilationUnit)], sources: &SourceMap) {
    let mut parts: Vec<Configuration> = Vec::new();
    for (file, unit) in &mut *units {
        let dialect = sources.get(*file).map(SourceFile::dialect);
        let takes_globals = dialect.is_some_and(|dialect| dialect.has(Feature::GlobalConfigurations));
        let next = |unit: &CompilationUnit, parts: &[Configuration]| {
            let is_next = |it: &Configuration| is_part(it, parts, takes_globals);
            unit.declarations.iter().position(|each| matches!(each, Declaration::Configuration(it) if is_next(it)))
        };
        while let Some(at) = next(unit, &parts) {
            let Declaration::Configuration(part) = unit.declarations.remove(at) else { break };
            parts.push(part);
        }
    }
    if parts.is_empty() {
        return;
    }
    // What has the tasks gives the name.
    let first = parts.iter().position(|part| !part.has_only_globals()).unwrap_or(0);
    let mut whole = parts.remove(first);
    for part in parts {
        whole.absorb(part);
    }
    let home = units.iter_mut().find(|(file, _)| *file == whole.name.span.file);
    if let Some((_, unit)) = home {
        unit.declarations.insert(0, Declaration::Configuration(whole));
    }
}
