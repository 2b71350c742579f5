//! Program text to something that can run: parse, check, compile.

mod builder;
mod declaration;
pub(crate) mod identity;
mod inner_inputs;
mod instance_path;
mod leaves;
mod memory_set;
mod namespace;
mod open_inputs;
mod part;
mod retain;
mod root;
mod value;
mod variable;
mod zero_terminated;

use std::collections::BTreeSet;
use std::ops::Range;
use std::sync::{Arc, OnceLock};

use crate::compile::fault::FaultTable;
use crate::compile::points::{Point, PointKind};
use crate::compile::{Compiled, Noted, compile};
use onescan_iec::check::Checked;
use onescan_iec::diagnostic::Diagnostics;
use onescan_iec::front::{Constants, Front, Setting, with_room};
use onescan_iec::input::Input;
use onescan_iec::input::kind::SourceKind;
use onescan_iec::ir::{Configuration, Retention};
use onescan_iec::lint::add_warnings;
use onescan_iec::syntax::Span;
use onescan_iec::syntax::{FileId, SourceMap};

use builder::Inspection;
pub use builder::{BuildError, Builder};
pub use declaration::Declaration;
use identity::code::Code;
use identity::layout::Layout;
pub use identity::{CodeDifference, VariableDifference};
pub use instance_path::without_home;
pub use memory_set::MemorySet;
pub use open_inputs::OpenInput;
pub(crate) use value::text;
pub use value::{Radix, WriteError, literal};
pub use variable::{Program, UnknownVariable, Variable, VariableAccess};
pub use zero_terminated::ZeroTerminated;

/// A compiled program: what it declares, its code, its memory at a cold start. Cheap to clone.
#[derive(Debug, Clone)]
pub struct Application {
    inner: Arc<Inner>,
}

/// What the program says of its execution while it runs; what it computes does not depend on it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
enum Purpose {
    #[default]
    Run,
    Coverage,
    Trace,
}

#[derive(Debug)]
struct Inner {
    sources: SourceMap,
    /// The files of the standard library.
    library: BTreeSet<FileId>,
    /// Constants whose values are not those of the sources.
    constants: Vec<Setting>,
    checked: Checked,
    wasm: Vec<u8>,
    faults: FaultTable,
    guards: Vec<Range<u32>>,
    points: Vec<Point>,
    purpose: Purpose,
    retained: Vec<Range<u32>>,
    persistent: Vec<Range<u32>>,
    warnings: Diagnostics,
    /// Both made when a state is saved or restored first.
    layout: OnceLock<Layout>,
    code: OnceLock<Code>,
    /// Machine code, made when the first PLC runs.
    module: OnceLock<Result<wasmtime::Module, String>>,
}

impl Application {
    /// Compiles files given as name and text, together with the standard function blocks.
    ///
    /// # Errors
    /// All that is wrong with the text, and the warnings too.
    pub fn from_sources<N, T>(files: impl IntoIterator<Item = (N, T)>) -> Result<Self, Diagnostics>
    where
        N: Into<String>,
        T: Into<Arc<str>>,
    {
        let text = |(name, text): (N, T)| Input::from_text(&name.into(), SourceKind::Text, text);
        Self::from_inputs(files.into_iter().map(text))
    }

    /// Compiles files as they are found, together with the standard function blocks.
    ///
    /// # Errors
    /// All that is wrong with them, and the warnings too.
    pub fn from_inputs(inputs: impl IntoIterator<Item = Input>) -> Result<Self, Diagnostics> {
        Self::without_constants(Self::builder().inputs(inputs))
    }

    /// Like [`Self::from_inputs`], to be run with [`SoftPlc::coverage`](crate::SoftPlc::coverage).
    /// It computes the same, and takes saved states of the other builds.
    ///
    /// # Errors
    /// All that is wrong with the files, and the warnings too.
    pub fn from_inputs_with_coverage(inputs: impl IntoIterator<Item = Input>) -> Result<Self, Diagnostics> {
        Self::without_constants(Self::builder().inputs(inputs).covered())
    }

    /// Begins an application whose constants can be set, or that reports what it executes.
    pub fn builder() -> Builder {
        Builder::default()
    }

    fn without_constants(Builder { inputs, purpose, memory_limit, .. }: Builder) -> Result<Self, Diagnostics> {
        with_room(|| Self::compiled(Front::within(memory_limit, inputs), &Constants::default(), purpose))
    }

    fn built(builder: Builder) -> Result<Self, BuildError> {
        let Builder { inputs, constants, purpose, memory_limit, inspection } = builder;
        with_room(|| {
            let (mut front, constants) = Front::with_constants(memory_limit, inputs, &constants)?;
            if let Inspection::Of(plan) = inspection {
                add_warnings(&mut front, plan.as_ref());
            }
            match constants.wrong_value(&front.findings, &front.sources) {
                Some(error) => Err(error.into()),
                None => Ok(Self::compiled(front, &constants, purpose)?),
            }
        })
    }

    fn compiled(front: Front, constants: &Constants, purpose: Purpose) -> Result<Self, Diagnostics> {
        let Front { sources, mut checked, findings, library, .. } = front;
        let warnings = Diagnostics::new(findings, &sources);
        if warnings.has_errors() {
            return Err(warnings);
        }
        instance_path::write(&mut checked, &sources);
        let noted = match purpose {
            Purpose::Run => Noted::Nothing,
            Purpose::Coverage => Noted::AllBut(&library),
            Purpose::Trace => Noted::Traced(&library),
        };
        let Compiled { wasm, faults, guards, points } = compile(&checked, noted);
        let retained = retain::ranges(&checked, Retention::Retain);
        let persistent = retain::ranges(&checked, Retention::Persistent);
        let constants = constants.settings.clone();
        let (layout, code, module) = (OnceLock::new(), OnceLock::new(), OnceLock::new());
        Ok(Self {
            inner: Arc::new(Inner {
                sources,
                library,
                constants,
                checked,
                wasm,
                faults,
                guards,
                points,
                purpose,
                retained,
                persistent,
                warnings,
                layout,
                code,
                module,
            }),
        })
    }

    /// What is questionable in the text.
    pub fn warnings(&self) -> &Diagnostics {
        &self.inner.warnings
    }

    /// The files, those of the standard function blocks too.
    pub fn sources(&self) -> &SourceMap {
        &self.inner.sources
    }

    /// The WebAssembly module.
    pub fn wasm(&self) -> &[u8] {
        &self.inner.wasm
    }

    /// The whole memory at a cold start.
    pub fn initial_memory(&self) -> &[u8] {
        &self.inner.checked.image
    }

    /// What survives a warm start (2nd ed. 2.4.2), as ranges of memory in ascending order.
    pub fn retained(&self) -> &[Range<u32>] {
        &self.inner.retained
    }

    /// What survives a cold start too (`PERSISTENT`), as ranges of memory in ascending order.
    pub fn persistent(&self) -> &[Range<u32>] {
        &self.inner.persistent
    }

    /// File and line, from 1, of each place that notes whether it has been executed, in the order of
    /// [`SoftPlc::executed`](crate::SoftPlc::executed); nothing for one that is not a statement.
    pub fn noted_places(&self) -> impl Iterator<Item = Option<(&str, u32)>> {
        self.points().iter().map(|point| {
            let (file, place) = self.sources().locate(point.span);
            (point.kind == PointKind::Statement).then_some((file, place.line))
        })
    }

    /// What is noted while the program runs; nothing unless it was compiled for that.
    pub(crate) fn points(&self) -> &[Point] {
        &self.inner.points
    }

    /// True if its statements report when they run.
    pub(crate) fn is_traced(&self) -> bool {
        self.inner.purpose == Purpose::Trace
    }

    /// Which variables there are, of which types, and where they lie.
    pub(crate) fn layout(&self) -> &Layout {
        self.inner.layout.get_or_init(|| Layout::new(&self.inner.checked, self.entry_names()))
    }

    /// What it was compiled from.
    pub(crate) fn code(&self) -> &Code {
        let Inner { code, sources, library, constants, .. } = &*self.inner;
        code.get_or_init(|| {
            // The values of constants are not files of the project.
            let is_value = |file| constants.iter().any(|constant| constant.file == file);
            let is_library = |file| (!is_value(file)).then(|| library.contains(&file));
            let constants = constants.iter().map(|Setting { path, literal, .. }| (path.clone(), literal.clone()));
            Code::new(sources, is_library, constants.collect())
        })
    }

    /// Memory that says which units run.
    pub(crate) fn guards(&self) -> &[Range<u32>] {
        &self.inner.guards
    }

    pub(crate) fn faults(&self) -> &FaultTable {
        &self.inner.faults
    }

    /// The application's own configuration.
    pub(crate) fn configuration(&self) -> Option<&Configuration> {
        self.inner.checked.configuration.as_ref()
    }

    /// How many functions there are in a row for each thing that tasks can run.
    pub(crate) fn entry_parts(&self) -> impl Iterator<Item = usize> {
        self.inner.checked.entries.iter().map(|entry| entry.units.len())
    }

    /// The names of what tasks can run.
    pub(crate) fn entry_names(&self) -> impl Iterator<Item = &str> {
        self.inner.checked.entries.iter().map(|entry| entry.name.as_str())
    }

    pub(crate) fn entry_name(&self, index: usize) -> Option<&str> {
        self.inner.checked.entries.get(index).map(|entry| entry.name.as_str())
    }

    /// Position of what a task can run by its name.
    pub(crate) fn entry_index(&self, name: &str) -> Option<usize> {
        self.entry_names().position(|entry| entry.eq_ignore_ascii_case(name))
    }

    /// True for a program that the start calls, by its position. Those of programs come first.
    pub(crate) fn runs_at_start(&self, index: usize) -> bool {
        self.inner.checked.programs.get(index).is_some_and(|program| program.runs_at_start)
    }

    /// The part of a chart that a place is in.
    pub(crate) fn chart_part(&self, at: Span) -> Option<&str> {
        let holds = |span: &Span| span.file == at.file && (span.start..=span.end).contains(&at.start);
        let parts = self.inner.checked.chart_parts.iter();
        parts.filter(|(span, _)| holds(span)).min_by_key(|(span, _)| span.len()).map(|(_, name)| name.as_str())
    }

    /// The machine code, made once by `make`.
    pub(crate) fn module(
        &self,
        make: impl FnOnce(&[u8]) -> Result<wasmtime::Module, String>,
    ) -> Result<wasmtime::Module, String> {
        self.inner.module.get_or_init(|| make(&self.inner.wasm)).clone()
    }
}
