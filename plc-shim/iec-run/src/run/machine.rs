//! The compiled module with its memory, in wasmtime.

use std::num::NonZeroUsize;

use wasmtime::{Config, Engine, Global, Instance, Linker, Memory, Module, Store, TypedFunc, Val};

use super::frames::{MAX_CALLERS, Trapped};
use super::host_state::HostState;
use super::journal::Journal;
use super::plan::RunError;
use super::row;
use super::text::link::link;
use super::trace::Trace;
use super::{trace_link, tried};
use crate::application::Application;
use crate::compile::{BUDGET_EXPORT, END_EXPORT, MEMORY_EXPORT, NOTES_EXPORT, START_EXPORT, entry_export, host};

/// One instance of the module.
pub(super) struct Machine {
    store: Store<HostState>,
    memory: Memory,
    budget: Global,
    /// Where the program notes what it executes, if it was compiled for that.
    notes: Option<Memory>,
    /// Bytes of `memory` in use, never more than it has: memory comes in pages, and does not shrink.
    size: usize,
    /// The functions in a row of each thing that tasks can run.
    entries: Vec<Vec<TypedFunc<(), ()>>>,
    /// All that each task runs, as one function.
    rows: Vec<Option<TypedFunc<(), ()>>>,
    /// What runs before the first scan, if anything does.
    start: Option<TypedFunc<(), ()>>,
    /// What runs before another start.
    end: Option<TypedFunc<(), ()>>,
}

/// What runs besides tasks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Occasion {
    /// Before the first scan.
    Start,
    End,
}

fn engine() -> Result<Engine, String> {
    let mut config = Config::new();
    config.wasm_backtrace_max_frames(NonZeroUsize::new(MAX_CALLERS));
    // The module counts its instructions itself and makes every NaN that it stores the same one:
    // both are needed at few places only.
    config.cranelift_nan_canonicalization(false);
    config.relaxed_simd_deterministic(true);
    // Advice to the layout of code, nothing that could be seen but by a clock.
    config.wasm_branch_hinting(true);
    Engine::new(&config).map_err(|error| error.to_string())
}

fn module_error(error: &wasmtime::Error) -> RunError {
    RunError::Module(format!("{error:#}"))
}

impl Machine {
    /// `tasks` are the entries that each task runs.
    pub(super) fn new(application: &Application, tasks: &[Vec<usize>]) -> Result<Self, RunError> {
        let module = application.module(|wasm| Module::new(&engine()?, wasm).map_err(|error| format!("{error:#}")));
        let module = module.map_err(RunError::Module)?;
        let mut store = Store::new(module.engine(), HostState::default());
        let linker = linker(module.engine()).map_err(|error| module_error(&error))?;
        let instance = linker.instantiate(&mut store, &module);
        // The linker has all that the module wants, so only memory can be missing.
        let instance = instance.map_err(|error| RunError::Memory(format!("{error:#}")))?;
        let memory = instance.get_memory(&mut store, MEMORY_EXPORT);
        let memory = memory.ok_or_else(|| RunError::Module("memory is missing".to_owned()))?;
        let notes = instance.get_memory(&mut store, NOTES_EXPORT);
        let budget = instance.get_global(&mut store, BUDGET_EXPORT);
        let budget = budget.ok_or_else(|| RunError::Module("the budget is missing".to_owned()))?;
        *store.data_mut() = HostState {
            memory: Some(memory),
            budget: Some(budget),
            application: Some(application.clone()),
            trace: None,
        };
        let size = application.initial_memory().len();
        if memory.data_size(&store) < size {
            return Err(RunError::Module("memory is smaller than the variables".to_owned()));
        }
        let parts = application.entry_parts().enumerate();
        let entries = parts.map(|(index, count)| entry(&instance, &mut store, index, count));
        let entries: Vec<Vec<_>> = entries.collect::<Result<_, _>>()?;
        let functions = |task: &Vec<usize>| task.iter().filter_map(|at| entries.get(*at)).flatten().cloned().collect();
        let functions: Vec<Vec<_>> = tasks.iter().map(functions).collect();
        let rows = row::link(&mut store, &functions).map_err(|error| module_error(&error))?;
        debug_assert_eq!(rows.len(), tasks.len(), "every task has its row, be it empty");
        let start = optional(&instance, &mut store, START_EXPORT)?;
        let end = optional(&instance, &mut store, END_EXPORT)?;
        Ok(Self { store, memory, budget, notes, size, entries, rows, start, end })
    }

    pub(super) fn memory(&self) -> &[u8] {
        &self.memory.data(&self.store)[..self.size]
    }

    pub(super) fn memory_mut(&mut self) -> &mut [u8] {
        &mut self.memory.data_mut(&mut self.store)[..self.size]
    }

    /// A byte for each point of the program, not 0 once it was executed; none unless it was compiled for that.
    pub(super) fn notes(&self) -> &[u8] {
        self.notes.map_or(&[], |notes| notes.data(&self.store))
    }

    /// Gives the budget for the calls up to the next refill.
    ///
    /// # Errors
    /// The module's budget is not what it was compiled to be.
    pub(super) fn refuel(&mut self, fuel: u64) -> Result<(), Trapped> {
        // No PLC lives long enough to use up the rest.
        let budget = Val::I64(i64::try_from(fuel).unwrap_or(i64::MAX));
        self.budget.set(&mut self.store, budget).map_err(|error| Trapped::of(&error))
    }

    /// What statements are held against; nothing unless that was asked for.
    pub(super) fn trace(&self) -> Option<&Trace> {
        self.store.data().trace.as_deref()
    }

    pub(super) fn set_trace(&mut self, trace: Trace) {
        self.store.data_mut().trace = Some(Box::new(trace));
    }

    /// A scan begins.
    pub(super) fn begin_trace(&mut self) {
        if let Some(mut trace) = self.store.data_mut().trace.take() {
            trace.begin_scan(&self.memory.data(&self.store)[..self.size]);
            self.store.data_mut().trace = Some(trace);
        }
    }

    /// A scan is over.
    pub(super) fn end_trace(&mut self) {
        if let Some(mut trace) = self.store.data_mut().trace.take() {
            trace.end_scan(&self.memory.data(&self.store)[..self.size]);
            self.store.data_mut().trace = Some(trace);
        }
    }

    /// Keeps a journal of what a traced scan does, or no longer.
    pub(super) fn keep_journal(&mut self, is_kept: bool) {
        if let Some(trace) = &mut self.store.data_mut().trace {
            trace.journal = is_kept.then(Journal::default);
        }
    }

    /// A unit that a task runs begins.
    pub(super) fn begin_traced_unit(&mut self) {
        if let Some(trace) = &mut self.store.data_mut().trace {
            trace.begin_unit();
        }
    }

    /// True if the host has something to do between the parts of what a task runs.
    pub(super) fn is_traced(&self) -> bool {
        self.store.data().trace.is_some()
    }

    pub(super) fn parts(&self, entry: usize) -> usize {
        self.entries.get(entry).map_or(0, Vec::len)
    }

    /// True if something runs at the occasion.
    pub(super) fn has(&self, occasion: Occasion) -> bool {
        self.occasion(occasion).is_some()
    }

    fn occasion(&self, occasion: Occasion) -> Option<&TypedFunc<(), ()>> {
        match occasion {
            Occasion::Start => self.start.as_ref(),
            Occasion::End => self.end.as_ref(),
        }
    }

    /// Runs what there is for the occasion.
    pub(super) fn run_occasion(&mut self, occasion: Occasion) -> Result<(), Trapped> {
        let Some(function) = self.occasion(occasion).cloned() else { return Ok(()) };
        function.call(&mut self.store, ()).map_err(|error| Trapped::of(&error))
    }

    /// Runs all of a task, without a halt between its parts.
    pub(super) fn run_row(&mut self, task: usize) -> Result<(), Trapped> {
        let row = self.rows.get(task).ok_or(Trapped::NOWHERE)?;
        // A task need not have programs.
        let Some(function) = row else { return Ok(()) };
        function.call(&mut self.store, ()).map_err(|error| Trapped::of(&error))
    }

    pub(super) fn run(&mut self, entry: usize, part: usize) -> Result<(), Trapped> {
        let function = self.entries.get(entry).and_then(|parts| parts.get(part)).ok_or(Trapped::NOWHERE)?;
        function.call(&mut self.store, ()).map_err(|error| Trapped::of(&error))
    }
}

fn entry(
    instance: &Instance,
    store: &mut Store<HostState>,
    index: usize,
    count: usize,
) -> Result<Vec<TypedFunc<(), ()>>, RunError> {
    let mut part = |part| instance.get_typed_func(&mut *store, &entry_export(index, part));
    (0..count).map(|at| part(at).map_err(|error| module_error(&error))).collect()
}

/// The function of this name; nothing if the module has none.
fn optional(
    instance: &Instance,
    store: &mut Store<HostState>,
    name: &str,
) -> Result<Option<TypedFunc<(), ()>>, RunError> {
    let function = instance.get_func(&mut *store, name);
    function.map(|function| function.typed(&*store)).transpose().map_err(|error| module_error(&error))
}

fn linker(engine: &Engine) -> Result<Linker<HostState>, wasmtime::Error> {
    let mut linker = Linker::new(engine);
    for import in &host::IMPORTS {
        let (module, name) = (host::MODULE, import.name);
        match import.function {
            host::Function::Single(function) => {
                linker.func_wrap(module, name, move |x: f32| canonical_single(function(x)))?
            }
            host::Function::Double(function) => {
                linker.func_wrap(module, name, move |x: f64| canonical_double(function(x)))?
            }
            host::Function::SinglePair(function) => {
                linker.func_wrap(module, name, move |x: f32, y: f32| canonical_single(function(x, y)))?
            }
            host::Function::DoublePair(function) => {
                linker.func_wrap(module, name, move |x: f64, y: f64| canonical_double(function(x, y)))?
            }
        };
    }
    link(&mut linker)?;
    tried::link(&mut linker)?;
    trace_link::link(&mut linker)?;
    Ok(linker)
}

/// A NaN's bits would depend on the machine.
fn canonical_single(value: f32) -> f32 {
    if value.is_nan() { f32::from_bits(0x7fc0_0000) } else { value }
}

fn canonical_double(value: f64) -> f64 {
    if value.is_nan() { f64::from_bits(0x7ff8_0000_0000_0000) } else { value }
}
