//! Program text to something that can run: parse, check, compile.

mod front;
mod leaves;
pub(crate) mod library;
mod namespace;
mod part;
mod retain;
mod room;
mod root;
mod value;
mod variable;
mod vendor_library;

use std::collections::BTreeSet;
use std::ops::Range;
use std::sync::{Arc, OnceLock};

use crate::check::Checked;
use crate::compile::fault::FaultTable;
use crate::compile::points::Point;
use crate::compile::{Compiled, Noted, compile};
use crate::diagnostic::Diagnostics;
use crate::input::Input;
use crate::input::kind::SourceKind;
use crate::ir::{Configuration, Retention};
use crate::syntax::Span;
use crate::syntax::{FileId, SourceMap};

pub(crate) use front::Front;
pub(crate) use room::with_room;
pub(crate) use value::text;
pub use value::{Radix, WriteError};
pub use variable::{Program, UnknownVariable, Variable, VariableAccess};

/// A compiled program: what it declares, its code, its memory at a cold start. Cheap to clone.
#[derive(Debug, Clone)]
pub struct Application {
    inner: Arc<Inner>,
}

#[derive(Debug)]
struct Inner {
    sources: SourceMap,
    checked: Checked,
    wasm: Vec<u8>,
    faults: FaultTable,
    points: Vec<Point>,
    is_traced: bool,
    retained: Vec<Range<u32>>,
    persistent: Vec<Range<u32>>,
    warnings: Diagnostics,
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
        Self::made(inputs.into_iter().collect(), |_| Noted::Nothing)
    }

    /// Like [`Self::from_inputs`], to be run with [`SoftPlc::coverage`](crate::SoftPlc::coverage).
    /// It computes the same; its saved states are its own.
    ///
    /// # Errors
    /// All that is wrong with the files, and the warnings too.
    pub fn from_inputs_with_coverage(inputs: impl IntoIterator<Item = Input>) -> Result<Self, Diagnostics> {
        Self::made(inputs.into_iter().collect(), |library| Noted::AllBut(library))
    }

    /// Like [`Self::from_inputs`], to be run with [`SoftPlc::watch`](crate::SoftPlc::watch). It
    /// computes the same, slowly; its saved states are its own.
    ///
    /// # Errors
    /// All that is wrong with the files, and the warnings too.
    pub fn from_inputs_traced(inputs: impl IntoIterator<Item = Input>) -> Result<Self, Diagnostics> {
        Self::made(inputs.into_iter().collect(), |library| Noted::Traced(library))
    }

    fn made(inputs: Vec<Input>, noted: fn(&BTreeSet<FileId>) -> Noted<'_>) -> Result<Self, Diagnostics> {
        with_room(|| {
            let Front { sources, checked, findings, library, .. } = Front::new(inputs);
            let findings = Diagnostics::new(findings, &sources);
            if findings.has_errors() {
                Err(findings)
            } else {
                Ok(Self::compiled(sources, checked, findings, noted(&library)))
            }
        })
    }

    fn compiled(sources: SourceMap, checked: Checked, warnings: Diagnostics, noted: Noted<'_>) -> Self {
        let is_traced = matches!(noted, Noted::Traced(_));
        let Compiled { wasm, faults, points } = compile(&checked, noted);
        let retained = retain::ranges(&checked, Retention::Retain);
        let persistent = retain::ranges(&checked, Retention::Persistent);
        let module = OnceLock::new();
        let inner = Inner { sources, checked, wasm, faults, points, is_traced, retained, persistent, warnings, module };
        Self { inner: Arc::new(inner) }
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

    /// What is noted while the program runs; nothing unless it was compiled for that.
    pub(crate) fn points(&self) -> &[Point] {
        &self.inner.points
    }

    /// True if its statements tell when they run.
    pub(crate) fn is_traced(&self) -> bool {
        self.inner.is_traced
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
